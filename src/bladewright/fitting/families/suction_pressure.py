"""Where a section by its suction and its pressure side begins, and what may grow in it."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bladewright.errors import DesignError
from bladewright.fitting.families.planar import ALONE
from bladewright.fitting.families.sampled import Sampled
from bladewright.nurbs.basis import Reals, basis
from bladewright.section.suction_pressure.assembly import characteristic, sides, skeleton_of
from bladewright.section.suction_pressure.part import SuctionPressure
from bladewright.section.suction_pressure.side import DEGREE, side_knots, spread

HEIGHTS = 2
"""free control points of each side to begin with"""
MOST = 12
"""of each side"""
TURNING = np.radians(60.0)
"""turning from which the pseudo skeleton line is taken"""
TANGENT = 0.08
"""distance of the control points on the tangents to begin with, of the chord"""
SAMPLES: Reals = np.linspace(0.0, 1.0, 101)[1:-1]
TURNS = 8
"""times that the places of a side's samples are found anew"""
TEMPLATES = tuple(
    SuctionPressure(
        stagger_angle=0.0,
        metal_angle_in=0.0,
        metal_angle_out=0.0,
        leading_edge_radius=0.01,
        leading_edge_wedge=10.0,
        trailing_edge_radius=0.01,
        trailing_edge_wedge=6.0,
        suction_tangent_in=TANGENT,
        suction_tangent_out=TANGENT,
        suction_heights=(0.1,) * HEIGHTS,
        pressure_tangent_in=TANGENT,
        pressure_tangent_out=TANGENT,
        pressure_heights=(0.0,) * HEIGHTS,
        skeleton=skeleton,
    )
    for skeleton in ("chord", "pseudo")
)
"""structures that are tried where none is given"""


def started(section: Sampled, like: SuctionPressure) -> SuctionPressure:
    """The part of a structure nearest to a section: edges by their radii and the sides' directions, sides by points."""
    angles = [float(np.degrees(np.clip(section.stagger + each, -1.5, 1.5))) for each in section.angles]
    radii = [float(np.clip(each, 8e-4, 0.15)) for each in section.radii]
    wedges = [float(np.clip(np.degrees(section.wedge(end)), 2.0, 80.0)) for end in (0, 1)]
    cambered = section.most_cambered[0] > 0.0
    found = replace(
        like,
        stagger_angle=float(np.degrees(section.stagger)),
        metal_angle_in=angles[0],
        metal_angle_out=angles[1],
        leading_edge_radius=radii[0],
        leading_edge_wedge=wedges[0],
        trailing_edge_radius=radii[1],
        trailing_edge_wedge=wedges[1],
        suction_side=("upper" if cambered else "lower") if like in TEMPLATES else like.suction_side,
        suction_tangent_in=TANGENT,
        suction_tangent_out=TANGENT,
        pressure_tangent_in=None if like.pressure_tangent_in is None else TANGENT,
        pressure_tangent_out=None if like.pressure_tangent_out is None else TANGENT,
    )
    return _through(found, section)


def grown(part: SuctionPressure, section: Sampled) -> Sequence[SuctionPressure]:
    """The same with one free control point more on the suction or the pressure side, or with free places on one."""
    found = []
    for name in ("suction", "pressure"):
        heights, places = getattr(part, f"{name}_heights"), _numbers(getattr(part, f"{name}_places"))
        if 0 < len(heights) < MOST:
            wider: dict[str, Any] = {
                f"{name}_heights": (*heights, 0.0),
                f"{name}_knots": (),
                f"{name}_places": _wider(places),
            }
            found.append(_through(replace(part, **wider), section))
    for name in ("suction", "pressure"):
        count = len(getattr(part, f"{name}_heights"))
        if count and not getattr(part, f"{name}_places"):
            places = spread(side_knots(count, getattr(part, f"{name}_knots"))).tolist()
            found.append(part.changed({f"{name}_places": tuple(places)}))
    return found


def _wider(places: list[float]) -> tuple[float, ...]:
    """The places with one more in the middle of the widest gap; none where none are given."""
    if not places:
        return ()
    ends = np.array([0.0, *places, 1.0])
    at = int(np.argmax(np.diff(ends)))
    return (*places[:at], float(0.5 * (ends[at] + ends[at + 1])), *places[at:])


def _through(part: SuctionPressure, section: Sampled) -> SuctionPressure:
    """The part with control points of its sides that lie nearest to the section's, its edges as they are."""
    on, off = ("upper", "lower") if part.suction_side == "upper" else ("lower", "upper")
    suction, other = (getattr(section, name) for name in (on, off))
    heights = _heights(part, suction, "suction")
    found = replace(part, suction_heights=heights)
    if part.pressure_heights:
        return replace(found, pressure_heights=_heights(found, other, "pressure"))
    count = len(part.pressure_thickness)
    places = _numbers(part.pressure_places) or spread(side_knots(count, part.pressure_knots)).tolist()
    return replace(found, pressure_thickness=tuple(max(2.0 * section.half_at(each), 1e-3) for each in places))


def _heights(part: SuctionPressure, points: Reals, name: str) -> tuple[float, ...]:
    """Heights of a side's free control points by least squares of the distances from points (n, 2) along them."""
    inner = getattr(part, f"{name}_knots")
    count = len(getattr(part, f"{name}_heights"))
    knots = side_knots(count, inner)
    places = np.array(_numbers(getattr(part, f"{name}_places")) or spread(knots).tolist())
    plain = part.changed({f"{name}_heights": (0.0,) * count})
    skeleton = skeleton_of(plain, ALONE)
    low, high = (skeleton.placed(places[None], np.full((1, count), each))[0] for each in (0.0, 1.0))
    try:
        pair = sides(_harmless(plain), ALONE, *characteristic(plain, ALONE))
    except DesignError:
        pair = None
    heights = np.interp(places, points[:, 0], points[:, 1]) - low[:, 1]
    if pair is None:
        return tuple(heights.tolist())
    controls = np.real(pair[0 if name == "suction" else 1].controls[0]).copy()
    controls[2:-2] = low
    rows = basis(knots, DEGREE, SAMPLES)
    for _ in range(TURNS):
        own = controls.copy()
        own[2:-2] = low + heights[:, None] * (high - low)
        at = rows @ own
        wanted = np.interp(at[:, 0], points[:, 0], points[:, 1])
        right = wanted - (rows @ controls)[:, 1]
        heights = np.linalg.lstsq(rows[:, 2:-2] * (high - low)[:, 1], right, rcond=None)[0]
    return tuple(heights.tolist())


def _harmless(part: SuctionPressure) -> SuctionPressure:
    """The part with sides of heights, which alone say where the corners and tangents are."""
    return (
        part
        if part.pressure_heights
        else replace(part, pressure_thickness=(), pressure_heights=(0.0,), pressure_places=(), pressure_knots=())
    )


def _numbers(laws: Sequence[float | tuple[float, ...]]) -> list[float]:
    return [float(np.mean(law)) for law in laws]
