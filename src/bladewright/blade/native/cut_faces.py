"""The faces that close a cut blade: pieces of surfaces of revolution at its ends and at its cut edges."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.native.cut_lines import in_meridian, real_curve
from bladewright.blade.native.end_faces import EDGES, MARGIN, Near, WallSurface, end_row, followed
from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, angle, concatenated, dot, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import piece
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.revolution import segment
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade

SAMPLES = 201
"""Points of a meridian among which the nearest begins the search."""
BESIDE = 0.05
"""How far the surface of a cut reaches past the blade along its meridian, as a share of its stretch."""
Walls = Mapping[str, tuple[Curve, Reals]]
"""meridians by name of what lies on them, and their inner knots"""


def around(
    sides: tuple[Surface, Surface], faces: Mapping[str, Surface], cut: Mapping[str, tuple[Curve, ...]], row: int
) -> tuple[Curve, ...]:
    """The closed chain of space curves around the end at v = 0 (row 0) or v = 1 (row -1): lower side first.

    `faces` are the native ones of blunt edges, `cut` the arcs of edges that are cut, at both ends.
    """
    upper, lower = (end_row(side, row) for side in sides)
    leading, trailing = (
        [end_row(faces[edge], row)] if edge in faces else [cut[edge][row]] if edge in cut else [] for edge in EDGES
    )
    return (lower, *map(run_back, trailing), run_back(upper), *leading)


def arc_between(start: Array, end: Array, *, revolved: bool) -> Curve:
    """The arc about the x axis from a point (3,) to another, as the same x and r as both have; straight in a cascade.

    What the two differ by in x and r it takes up in proportion to the control points' numbers.
    """
    if not revolved:
        return segment(start, end)
    places = in_meridian(np.stack([start, end]), revolved=True)
    theta = angle(np.stack([start, end])[:, 1], np.stack([start, end])[:, 2])
    half = (theta[1] - theta[0] - 2.0 * np.pi * np.round(np.real(theta[1] - theta[0]) / (2.0 * np.pi))) / 2.0
    x, r = np.mean(places, axis=0)
    middle = theta[0] + half
    between = np.stack([x, r / np.cos(half) * np.sin(middle), r / np.cos(half) * np.cos(middle)])
    weights = np.array([1.0, np.cos(half), 1.0])
    return Curve(
        control_points=concatenated([start[None], between[None], end[None]], axis=-2),
        knots=np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]),
        degree=2,
        weights=weights,
    )


def arcs_of(sides: tuple[Surface, Surface], walls: Walls, *, revolved: bool) -> dict[str, tuple[Curve, ...]]:
    """The arcs at both ends of edges that are cut, by edge, from the upper to the lower side."""
    upper, lower = sides
    return {
        edge: tuple(
            arc_between(upper.control_points[at, row], lower.control_points[at, row], revolved=revolved)
            for row in (0, -1)
        )
        for edge, at in zip(EDGES, (0, -1), strict=True)
        if edge in walls
    }


def closing_faces(
    blade: "Blade",
    sides: tuple[Surface, Surface],
    arcs: Mapping[str, tuple[Curve, ...]],
    outlines: Mapping[str, tuple[Curve, ...]],
    walls: Walls,
) -> dict[str, TrimmedSurface]:
    """Trimmed faces of cut edges and of both ends, inside their outlines, of a blade cut from `blade`.

    `walls` are the meridians that cuts have made, by edge and end. Raises DesignError where an outline does not follow.
    """
    revolved, chord = blade.plain.exact.mapping.revolved, float(np.real(blade.chord))
    found = {}
    for edge, at in zip(EDGES, (0, -1), strict=True):
        if edge in walls:
            rows = [
                Curve(control_points=side.control_points[at], knots=side.knots_v, degree=side.degree_v)
                for side in sides
            ]
            first, last = arcs[edge]
            chain = (rows[1], run_back(last), run_back(rows[0]), first)
            found[edge] = face_inside(chain, *walls[edge], revolved=revolved, chord=chord)
    for old, (name, outline) in zip(blade.design.ends, outlines.items(), strict=True):
        wall = walls[name] if name in walls else blade.end_wall(old)
        found[name] = face_inside(outline, *wall, revolved=revolved, chord=chord)
    return found


def face_inside(
    chain: tuple[Curve, ...], meridian: Curve, inner: Reals, *, revolved: bool, chord: float
) -> TrimmedSurface:
    """The piece of the surface of a meridian inside a closed chain of space curves on it, along the meridian first.

    Arcs about the axis, or straight lines in a cascade, are those of constant meridian place, and have weights or
    degree 1; `inner` are the meridian's inner knots. Raises DesignError where another curve does not lie on the
    surface.
    """
    near = [near_on_wall(meridian, curve, revolved=revolved) for curve in chain]
    near = _one_after_another(near) if revolved else near
    own, across = (np.concatenate([each[i] for each in near]) for i in (1, 2))
    margin, low, high = BESIDE * np.ptp(own), *meridian.domain
    start, end = max(low, float(np.min(own) - margin)), min(high, float(np.max(own) + margin))
    inner = inner[(inner > start) & (inner < end)]
    beside = MARGIN * np.ptp(across)
    wall = WallSurface(
        meridian=piece(meridian, start, end),
        inner=inner,
        revolved=revolved,
        low=float(np.min(across) - beside),
        high=float(np.max(across) + beside),
    )
    drawn = [
        None if curve.degree < DRAWN else followed(wall, curve, each, chord)
        for curve, each in zip(chain, near, strict=True)
    ]
    boundary = [segment(*_ends_beside(drawn, index)) if curve is None else curve for index, curve in enumerate(drawn)]
    return TrimmedSurface(surface=wall.surface, boundary=tuple(boundary), revolution=wall.revolution)


DRAWN = 3
"""Degree from which a curve of a chain is one of a face, and not an arc or a line across the meridian."""


def _ends_beside(drawn: Sequence[Curve | None], index: int) -> tuple[Array, Array]:
    """The points of a closed chain between which the curve of this number is left out."""
    before, after = drawn[index - 1], drawn[(index + 1) % len(drawn)]
    if before is None or after is None:
        raise GeometryError("two arcs follow each other around a face: one of them must be drawn")
    return before.control_points[-1], after.control_points[0]


def near_on_wall(meridian: Curve, curve: Curve, *, revolved: bool) -> Near:
    """Places along a space curve on the wall of a meridian, and near them the meridian's u, and theta or y."""
    spans = np.unique(curve.knots)
    places = np.unique(np.concatenate([spans, (spans[1:] + spans[:-1]) / 2.0]))
    points = np.real(curve(places))
    u = nearest_on_meridian(meridian, in_meridian(points, revolved))
    if not revolved:
        return places, u, points[:, 1]
    return places, u, np.unwrap(np.real(angle(points[:, 1], points[:, 2])))


def nearest_on_meridian(meridian: Curve, points: Reals) -> Reals:
    """Parameters (k,) of the real meridian's points nearest to points (k, 2)."""
    line, (low, high) = real_curve(meridian), meridian.domain
    samples = np.linspace(low, high, SAMPLES)
    at = line(samples)
    square = np.square(points[:, :1] - at[:, 0]) + np.square(points[:, 1:] - at[:, 1])
    u = samples[np.argmin(square, axis=1)]
    for _ in range(8):
        gap, slope, bend = points - line(u), line.derivative(u), line.derivative(u, 2)
        size = dot(slope, slope)
        before, u = u, np.clip(u + dot(gap, slope) / np.maximum(size - dot(gap, bend), 0.1 * size), low, high)
        if np.max(np.square(u - before)) < (1e-9 * (high - low)) ** 2:
            break
    return u


def wall_normals(meridian: Curve, points: Array, *, revolved: bool) -> Reals:
    """Unit normals (k, 3) of the surface of a meridian at points (k, 3) near it, to its left."""
    real = np.real(points)
    slope = unit(real_curve(meridian).derivative(nearest_on_meridian(meridian, in_meridian(real, revolved))))
    if not revolved:
        return np.stack([-slope[:, 1], np.zeros(len(slope)), slope[:, 0]], axis=-1)
    outward = slope[:, :1] * unit(real[:, 1:])
    return np.concatenate([-slope[:, 1:], outward], axis=-1)


def _one_after_another(chain: Sequence[Near]) -> list[Near]:
    """The curves of a chain by whole turns to where each begins at the theta at which the one before ends."""
    found, last = [], chain[0][2][0]
    for places, u, across in chain:
        turned = across - 2.0 * np.pi * np.round((across[0] - last) / (2.0 * np.pi))
        found.append((places, u, turned))
        last = turned[-1]
    return found


def inner_knots(meridian: Curve) -> Reals:
    """The inner knots of a meridian."""
    return np.asarray(meridian.knots[meridian.degree + 1 : -meridian.degree - 1])


def along(meridian: Curve, start: Reals, end: Reals) -> Curve:
    """The meridian in the sense that goes from near a point (2,) towards another."""
    low, high = nearest_on_meridian(meridian, np.stack([start, end]))
    return meridian if low < high else run_back(meridian)
