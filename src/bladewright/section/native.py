"""Sections of any family as native curves: B-splines that interpolate the exact outline, edges built in."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array, angle, concatenated, dot, frozen
from bladewright.numerics.solving import banded_solved
from bladewright.nurbs.basis import Reals, basis, breaks, greville, knots_with_joints
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.transform import transformed
from bladewright.section.arc_length import ArcLength
from bladewright.section.meanline import Meanline
from bladewright.section.outline import EdgeDerivatives, Outline
from bladewright.section.section import Section

DEGREE = 5
"""degree of the native curves: the lowest whose single span, of six control points, meets point and two derivatives at
both of its ends"""
MAX_POLES = 400
"""poles of a curve above which a section is refused: the built-in examples and families need 16 to 189 at the default
tolerance (design/section_constants.py), so more mean a corner that no joint states"""
SHARES = (0.1, 0.3, 0.5, 0.7, 0.9)
"""where in each knot span a curve is compared with the outline: by these five the tolerance is missed by a factor of
1.04 at most, by one or two places by 1.8 (design/section_constants.py) [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionKnots(FrozenRecord):
    """Knots and interpolation sites of a section's curves, held fixed while it is differentiated."""

    sides: Reals
    """clamped knots over [0, 1] of both sides, by s"""
    camber: Reals
    """clamped knots over [0, 1] of the camber line, by its arc length"""
    camber_places: Reals
    """s (n,) of the camber's interpolation sites"""

    def __post_init__(self) -> None:
        for name in ("sides", "camber", "camber_places"):
            object.__setattr__(self, name, frozen(getattr(self, name)))


def native_curves(
    outline: Outline, tolerance: float = 1e-10, knots: SectionKnots | None = None
) -> tuple[Curve, Curve, Curve]:
    """Upper side, lower side and camber line of one section, an outline of shape () or (1,), in chords.

    The sides are by the outline's s, the camber line by its arc length; `knots` are those to hold, where None they are
    refined until every point lies within `tolerance` [chords] of the outline's at the same parameter. Both sides have
    the edges' point and two derivatives in their first three control points, so a round edge is G2. Raises DesignError
    where the tolerance is not reached within 400 poles.
    """
    knots = knots_for(outline, tolerance) if knots is None else knots
    sides = _sides(outline, knots.sides)
    camber = _interpolated(_single(outline.camber(knots.camber_places)), knots.camber)
    return _curve(sides[:, 0], knots.sides), _curve(sides[:, 1], knots.sides), _curve(camber, knots.camber)


def knots_for(outline: Outline, tolerance: float) -> SectionKnots:
    """Knots on which the native curves of one section reach the tolerance; raises as `native_curves` does."""
    joints = [(joint.s, joint.derivatives) for joint in outline.joints]
    sides = side_knots_for(outline, tolerance)
    arc = ArcLength(lambda s: np.real(_single(outline.camber(s))), [0.0, *(s for s, _ in joints), 1.0])

    def camber_error(knots: Reals, w: Reals) -> Reals:
        line = _single(outline.camber(arc.places(np.concatenate([greville(knots, DEGREE), w]))))
        controls = _interpolated(line[: -len(w)], knots)
        return _distance(_curve(controls, knots)(w), line[-len(w) :])

    lengths = arc.lengths(np.array([s for s, _ in joints]))
    camber = _refined(
        _initial_knots([(float(w), each[1]) for w, each in zip(lengths, joints, strict=True)]), camber_error, tolerance
    )
    return SectionKnots(sides=sides, camber=camber, camber_places=arc.places(greville(camber, DEGREE)))


def side_knots_for(outline: Outline, tolerance: float) -> Reals:
    """The knots of both sides alone on which they reach the tolerance; raises as `native_curves` does."""

    def side_error(knots: Reals, s: Reals) -> Reals:
        exact = np.stack([_single(points) for points in outline.points(s)], axis=1)
        return np.asarray(np.max(_distance(_curve(_sides(outline, knots), knots)(s), exact), axis=1))

    return _refined(_initial_knots([(joint.s, joint.derivatives) for joint in outline.joints]), side_error, tolerance)


def interpolated_along_u(lines: Array, start: EdgeDerivatives, end: EdgeDerivatives, knots_u: Reals) -> Array:
    """Control points (..., n_u, m, d) of m curves of degree five through points, with their edges built in.

    `lines` (..., n_u - 6, m, d) are the points at the inner Greville sites. The first and last three control points are
    decided by point and two derivatives (..., m, d) at the edges.
    """
    sites = greville(knots_u, DEGREE)[3:-3]
    first = _end_rows(start, 1.0, knots_u[DEGREE + 1], knots_u[DEGREE + 2])
    last = _end_rows(end, -1.0, 1.0 - knots_u[-DEGREE - 2], 1.0 - knots_u[-DEGREE - 3])[::-1]
    known = np.stack([*first, *last], axis=-3)
    matrix = basis(knots_u, DEGREE, sites)
    outer = np.concatenate([matrix[:, :3], matrix[:, -3:]], axis=1)
    right = lines - (outer @ known.reshape(*known.shape[:-2], -1)).reshape(*known.shape[:-3], *lines.shape[-3:])
    shape = right.shape
    inner = banded_solved(matrix[:, 3:-3], right.reshape(*shape[:-2], -1), DEGREE).reshape(shape)
    return concatenated([known[..., :3, :, :], inner, known[..., 3:, :, :]], axis=-3)


def _end_rows(row: EdgeDerivatives, sign: float, near: float, far: float) -> list[Array]:
    """The three control points at a clamped end, whose first two inner knots are `near` and `far` from it."""
    step = sign * row.first * (near / DEGREE)
    second = row.point + step
    third = second + far * (row.second * (near / (DEGREE * (DEGREE - 1))) + step / near)
    return [row.point, second, third]


def _sides(outline: Outline, knots: Reals) -> Array:
    """Control points (n, 2, 2) of the upper and the lower side."""
    points = np.stack([_single(side) for side in outline.points(greville(knots, DEGREE)[3:-3])], axis=1)
    first, last = (
        EdgeDerivatives(*(np.stack([a.reshape(2), b.reshape(2)]) for a, b in zip(edge.upper, edge.lower, strict=True)))
        for edge in (outline.leading_edge, outline.trailing_edge)
    )
    return interpolated_along_u(points, first, last, knots)


def _interpolated(points: Array, knots: Reals) -> Array:
    """Control points (n, 2) of a line through points (n, 2) at its Greville sites."""
    return banded_solved(basis(knots, DEGREE, greville(knots, DEGREE)), points, DEGREE)


def _initial_knots(joints: list[tuple[float, int]]) -> Reals:
    """Initial knots: about eight spans, each joint as often as its lost derivatives ask for."""
    ends = np.array([0.0, *(place for place, _ in joints), 1.0])
    # an end's three control points and the other's must not be the same ones
    counts = np.maximum(1 if len(ends) > 2 else 2, np.rint(8.0 * np.diff(ends)).astype(int))
    inner = [np.linspace(a, b, n + 1)[1:-1] for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)]
    knots = np.concatenate([np.zeros(DEGREE + 1), *inner, np.ones(DEGREE + 1)])
    return knots_with_joints(knots, DEGREE, joints)


def _refined(knots: Reals, error: Callable[[Reals, Reals], Reals], tolerance: float) -> Reals:
    """Knots refined until the error is within the tolerance; spans are split as the order of convergence predicts."""
    before = np.inf
    while True:
        ends = breaks(knots)
        places = (ends[:-1, None] + np.diff(ends)[:, None] * np.array(SHARES)).ravel()
        worst = np.max(error(knots, places).reshape(len(ends) - 1, -1), axis=1)
        reached, poles = float(np.max(worst)), len(knots) - DEGREE - 1
        if reached <= tolerance:
            return knots
        if poles > MAX_POLES or (reached > 0.9 * before and reached < 1e-12):
            place = float(places[int(np.argmax(worst)) * len(SHARES) + len(SHARES) // 2])
            raise DesignError(
                f"tolerance is {tolerance:g} of the chord: the native curves of the section reach {reached:.2g} with "
                f"{poles} poles, at most {MAX_POLES} are allowed, the worst place is s = {place:.3f}: raise the "
                "tolerance, or make the section smoother there"
            )
        before = reached
        pieces = np.ones(len(worst), dtype=int)
        missing = worst > tolerance
        pieces[missing] = np.clip(np.ceil((2.0 * worst[missing] / tolerance) ** (1.0 / (DEGREE + 1))), 2, 4).astype(int)
        added = [np.linspace(a, b, n + 1)[1:-1] for a, b, n in zip(ends[:-1], ends[1:], pieces, strict=True) if n > 1]
        knots = np.sort(np.concatenate([knots, *added]))


def _curve(control_points: Array, knots: Reals) -> Curve:
    return Curve(control_points=control_points, knots=knots, degree=DEGREE)


def _single(points: Array) -> Array:
    """Points (k, 2) of shape (k, 2) or (1, k, 2)."""
    return points[0] if points.ndim == 3 else points


def _distance(a: Array, b: Array) -> Reals:
    difference: Reals = np.real(a) - np.real(b)
    return np.sqrt(dot(difference, difference))


def native_section(
    outline: Outline,
    knots: SectionKnots,
    *,
    turn: Array,
    chord: Array,
    shift: Array,
    span: float,
    plane: str,
    scale: Callable[[Array], Array],
    meanline: Meanline | None,
    **labels: Any,
) -> Section:
    """The section of an outline of shape () or (1,), turned by `turn` (), `chord` () long and moved by `shift` (2,).

    `plane`, `scale`, `meanline` and `labels` are the section's own.
    """
    matrix = chord * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    upper, lower, camber = native_curves(outline, knots=knots)
    sides = {"upper": upper, "lower": lower, **_faces(outline, upper, lower)}
    line = transformed(camber, matrix, shift)
    slope = line.derivative(np.array([0.0, 1.0]))
    metal = np.real(angle(slope[:, 1], slope[:, 0]))
    return Section(
        span=span,
        plane=plane,
        curves=FrozenMapping({name: transformed(curve, matrix, shift) for name, curve in sides.items()}),
        camber=line,
        stagger=float(np.real(turn)),
        metal_angle_in=float(metal[0]),
        metal_angle_out=float(metal[1]),
        scale=scale,
        edges=(outline.leading_edge.kind, outline.trailing_edge.kind),
        knots=knots,
        meanline=None if meanline is None else meanline.of_first_section,
        outline=outline,
        **labels,
    )


def _faces(outline: Outline, upper: Curve, lower: Curve) -> dict[str, Curve]:
    """The straight faces of blunt edges, each from the upper to the lower side."""
    faces = {}
    for i, edge in enumerate((outline.leading_edge, outline.trailing_edge)):
        if edge.kind == "blunt":
            ends = frozen(np.stack([upper.control_points[-i], lower.control_points[-i]]))
            knots = np.array([0.0, 0.0, 1.0, 1.0])
            faces[("leading_edge", "trailing_edge")[i]] = Curve(control_points=ends, knots=knots, degree=1)
    return faces
