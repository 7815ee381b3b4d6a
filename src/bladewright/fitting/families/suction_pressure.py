"""Where a section by its suction and pressure side begins, and which control points may be added."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from scipy.optimize import lsq_linear

from bladewright.designs import ChordwiseLaw
from bladewright.errors import DesignError
from bladewright.fitting.families.polyline import nearest_on
from bladewright.fitting.families.rounded_edge import edge_through
from bladewright.fitting.families.section_samples import SampledSection
from bladewright.fitting.models.planar import SINGLE_SECTION
from bladewright.nurbs.basis import Reals, basis
from bladewright.section.laws import law_points
from bladewright.section.suction_pressure.part import SuctionPressure, edge_points, skeleton_of
from bladewright.section.suction_pressure.side import DEGREE, default_places, points_off_line, side_knots

HEIGHTS = 2
"""free control points of each side to begin with"""
WITHOUT_HEIGHTS = 18
"""free parameters of a section besides those"""
MOST_CONTROL_POINTS = 12
"""free control points of each side at most; it bounds the time of growth."""
TEMPLATE_TANGENT = 0.08
"""distance of the control points on the end tangents in a template, of the chord"""
LEAST_TANGENT, MOST_TANGENT = 0.25, 0.9
"""smallest of these distances to begin with, of that of evenly spread control points, and largest (`MOST_TANGENT`), of
the chord."""
TRIAL_WEDGES = tuple(np.radians([25.0, 50.0, 75.0]).tolist())
"""wedge angles [rad] of the leading edge that are tried besides the section's own"""
WEDGE_RANGE = (np.radians(2.0), np.radians(40.0))
"""range [rad] to which the section's own wedge angles are limited"""
SAMPLES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 121)[1:-1])) / 2.0
"""parameters at which a side is compared with the section"""
STIFFNESS = 1e-3
"""weight that holds a control point where it was, of the weight of all samples."""
PROJECTIONS = 8
"""times that the samples of a side are projected onto the section anew"""
_PLAIN = SuctionPressure(
    stagger_angle=0.0,
    metal_angle_in=0.0,
    metal_angle_out=0.0,
    leading_edge_radius=0.01,
    leading_edge_wedge=10.0,
    trailing_edge_radius=0.01,
    trailing_edge_wedge=6.0,
    suction_tangent_in=TEMPLATE_TANGENT,
    suction_tangent_out=TEMPLATE_TANGENT,
    suction_heights=(0.1,) * HEIGHTS,
    pressure_tangent_in=TEMPLATE_TANGENT,
    pressure_tangent_out=TEMPLATE_TANGENT,
    pressure_heights=(0.0,) * HEIGHTS,
)


def templates(section: SampledSection, parameters: int | None) -> Sequence[SuctionPressure]:
    """Structures that are tried where none is given, with about so many free parameters of a section."""
    free = 0 if parameters is None else parameters - WITHOUT_HEIGHTS
    counts = max(HEIGHTS, min(MOST_CONTROL_POINTS, -(-free // 2))), max(HEIGHTS, min(MOST_CONTROL_POINTS, free // 2))
    side: Literal["upper", "lower"] = "upper" if section.most_cambered[0] > 0.0 else "lower"
    sized = replace(_PLAIN, suction_side=side, suction_heights=(0.1,) * counts[0], pressure_heights=(0.0,) * counts[1])
    return [replace(sized, skeleton="pseudo"), sized]


def starts(section: SampledSection, like: SuctionPressure) -> Sequence[SuctionPressure]:
    """Parts of a structure near to a section, nearest first: edges by the section's ends, sides by least squares.

    How far an edge extends is ambiguous, as its sides may be taken for parts of it: there is one start for each of
    several wedge angles. Raises DesignError where none has a shape.
    """
    own, last = (float(np.clip(section.wedge(end), *WEDGE_RANGE)) for end in (0, 1))
    tried, refusal = [], DesignError("no wedge of the leading edge was tried")
    for first in (own, *TRIAL_WEDGES):
        try:
            part = _with_edges(section, like, (first, last))
            tried.append((_misfit(part, section), part))
        except DesignError as error:
            refusal = error
    if not tried:
        raise refusal
    return [part for _, part in sorted(tried, key=lambda pair: pair[0])]


def _with_edges(section: SampledSection, like: SuctionPressure, wedges: tuple[float, float]) -> SuctionPressure:
    """The part of a structure with about these wedge angles [rad], its sides through a section's."""
    upward = 1.0 if like.suction_side == "upper" else -1.0
    values: dict[str, Any] = {"stagger_angle": float(np.degrees(section.stagger))}
    for end, (edge, angle) in enumerate((("leading_edge", "metal_angle_in"), ("trailing_edge", "metal_angle_out"))):
        found = edge_through(section, end, wedges[end], like.edges)
        values |= {
            angle: float(np.degrees(np.clip(section.stagger + found.angle, -1.5, 1.5))),
            f"{edge}_radius": found.radius,
            f"{edge}_stretch": found.stretch,
            f"{edge}_skew": upward * found.skew,
            f"{edge}_wedge": float(np.degrees(found.wedge)),
        }
    return through(replace(like, **values), section)


def _misfit(part: SuctionPressure, section: SampledSection) -> float:
    """Root mean square distance of the part's sides and edges from the section's, in chords."""
    places = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 81))) / 2.0
    upper, lower = (np.real(side[0]) for side in part.outline(SINGLE_SECTION).points(places))
    around = np.concatenate([section.upper[:0:-1], section.lower])
    return float(np.sqrt(np.mean(nearest_on(around, np.concatenate([upper, lower])).heights ** 2)))


def extensions(part: SuctionPressure, section: SampledSection) -> Sequence[SuctionPressure]:
    """The part with one free control point more on the suction or the pressure side, or with free places on one."""
    found = []
    for name in ("suction", "pressure"):
        heights, places = getattr(part, f"{name}_heights"), _numbers(getattr(part, f"{name}_places"))
        if 0 < len(heights) < MOST_CONTROL_POINTS:
            wider: dict[str, Any] = {
                f"{name}_heights": (*heights, 0.0),
                f"{name}_knots": (),
                f"{name}_places": _wider(places),
            }
            found.append(through(replace(part, **wider), section))
    for name in ("suction", "pressure"):
        count = len(getattr(part, f"{name}_heights"))
        if count and not getattr(part, f"{name}_places"):
            places = default_places(side_knots(count, getattr(part, f"{name}_knots"))).tolist()
            found.append(part.changed({f"{name}_places": tuple(places)}))
    return found


def _wider(places: list[float]) -> tuple[float, ...]:
    """The places with one more in the middle of the widest gap; none where none are given."""
    if not places:
        return ()
    ends = np.array([0.0, *places, 1.0])
    at = int(np.argmax(np.diff(ends)))
    return (*places[:at], float(0.5 * (ends[at] + ends[at + 1])), *places[at:])


def through(part: SuctionPressure, section: SampledSection) -> SuctionPressure:
    """The part with its edges kept and with side control points nearest to the section's sides."""
    suction_name, pressure_name = ("upper", "lower") if part.suction_side == "upper" else ("lower", "upper")
    found = part.changed(_side_through(part, getattr(section, suction_name), "suction"))
    if part.pressure_heights:
        return found.changed(_side_through(found, getattr(section, pressure_name), "pressure"))
    count = len(part.pressure_thickness)
    places = _numbers(part.pressure_places) or default_places(side_knots(count, part.pressure_knots)).tolist()
    return replace(found, pressure_thickness=tuple(max(2.0 * section.half_at(each), 1e-3) for each in places))


def _side_through(part: SuctionPressure, line: Reals, name: str) -> dict[str, float]:
    """Tangents and heights of a side by least squares of its distances from a line of points (n, 2)."""
    count = len(getattr(part, f"{name}_heights"))
    knots = side_knots(count, getattr(part, f"{name}_knots"))
    places = np.array(_numbers(getattr(part, f"{name}_places")) or default_places(knots).tolist())
    skeleton = skeleton_of(part, SINGLE_SECTION)
    low, high = (points_off_line(skeleton, places[None], np.full((1, count), each))[0] for each in (0.0, 1.0))
    suction_name = "upper" if (name == "suction") == (part.suction_side == "upper") else "lower"
    corners = [points[suction_name] for points in edge_points(part, SINGLE_SECTION)]
    points, directions = (np.real([getattr(each, of)[0] for each in corners]) for of in ("point", "direction"))
    rows = basis(knots, DEGREE, SAMPLES)
    # columns by tangent in, heights and tangent out: the control points are linear in these
    moves = np.concatenate(
        [
            (rows[:, 1:2] * directions[0])[:, None],
            rows[:, 2:-2, None] * (high - low),
            (rows[:, -2:-1] * directions[1])[:, None],
        ],
        axis=1,
    )
    fixed = rows[:, :2].sum(axis=1)[:, None] * points[0] + rows[:, -2:].sum(axis=1)[:, None] * points[1]
    fixed = fixed + rows[:, 2:-2] @ low
    own = [part.parameters().get(f"{name}_tangent_{way}") for way in ("in", "out")]
    width = np.array([knots[DEGREE + 1], 1.0 - knots[-DEGREE - 2]]) / DEGREE
    even_tangents = width * np.sqrt(np.sum((points[1] - points[0]) ** 2))
    ends = [even_tangents[i] if each is None else each for i, each in enumerate(own)]
    heights = _heights_above(line, low, high)
    unknowns = np.array([ends[0], *heights, ends[1]])
    least = np.array([LEAST_TANGENT * even_tangents[0], *np.full(count, -2.0), LEAST_TANGENT * even_tangents[1]])
    most = np.array([MOST_TANGENT, *np.full(count, 2.0), MOST_TANGENT])
    for _ in range(PROJECTIONS):
        footpoint = nearest_on(line, fixed + np.einsum("nkd,k->nd", moves, unknowns))
        slopes = np.einsum("nkd,nd->nk", moves, footpoint.normals)
        wanted = np.sum((footpoint.points - fixed) * footpoint.normals, axis=1)
        penalty = STIFFNESS * np.eye(len(unknowns))
        unknowns = lsq_linear(
            np.concatenate([slopes, penalty]), np.concatenate([wanted, penalty @ unknowns]), bounds=(least, most)
        ).x
    values = {f"{name}_heights[{i}]": float(each) for i, each in enumerate(unknowns[1:-1])}
    for way, value, old in zip(("in", "out"), unknowns[[0, -1]], own, strict=True):
        if old is not None:
            values[f"{name}_tangent_{way}"] = float(value)
    return values


def _heights_above(line: Reals, low: Reals, high: Reals) -> Reals:
    """Distances of a line from places (k, 2) in the directions to other places (k, 2)."""
    across = high - low
    along = np.stack([across[:, 1], -across[:, 0]], axis=-1)
    found = []
    for at, ahead, aside in zip(low, across, along, strict=True):
        way, height = (line - at) @ aside, (line - at) @ ahead
        crossing = np.flatnonzero(way[:-1] * way[1:] <= 0.0)
        between = [
            float(height[i] + (height[i + 1] - height[i]) * way[i] / (way[i] - way[i + 1] or 1.0)) for i in crossing
        ]
        found.append(min(between, key=lambda each: each**2) if between else float(height[np.argmin(way**2)]))
    return np.array(found)


def _numbers(laws: ChordwiseLaw) -> list[float]:
    return [float(np.mean(law_points(law))) for law in laws]
