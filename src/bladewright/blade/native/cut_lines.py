"""Where lines of a blade's faces meet the meridian that cuts it, by Newton's method; and that meridian."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from bladewright.numerics.elementary import Array, cross2, dot, length, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended
from bladewright.nurbs.surface import Surface

STEPS = 20
"""Newton steps after which no crossing is expected any more; mostly four suffice."""
IN_A_SPAN = 4
"""Places in a knot span of a line at which its side of the cut is looked at."""
ON_THE_CUT = 8
"""Straight pieces by which a knot span of the cut is searched."""

ASIDE = 0.382
"""Where such a place or piece begins in its share of a span: not at a knot, where a cut through points of the blade may
meet a line, and neither of two straight pieces, or both, would seem to."""


class Crossing(NamedTuple):
    """Where lines meet the cut."""

    place: Array
    """(k,) parameter along each line"""
    t: Array
    """(k,) parameter of the meridian"""


Found = tuple[Reals, Crossing]
"""Places of lines, and where they meet a cut there."""
Near = Mapping[str, Mapping[str, Found]]
"""The same by cut and by face."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Lines:
    """Lines of a face along one of its parameters, at places of the other, in the meridional plane."""

    face: Surface
    along: Literal["u", "v"]
    at: Reals
    """(k,)"""
    revolved: bool

    def real(self) -> "Lines":
        """The same without imaginary parts."""
        return replace(self, face=real_face(self.face))

    def points(self, place: Array, along: int = 0, across: int = 0) -> Array:
        """Points, or derivatives (k, 3), at places (k,) along the lines."""
        if self.along == "u":
            return self.face.derivative(place, self.at, along, across)
        return self.face.derivative(self.at, place, across, along)

    def meridional(self, place: Array) -> tuple[Array, Array]:
        """(x, r) (k, 2) at places (k,) along the lines, and the derivative by the place."""
        point, slope = self.points(place), self.points(place, 1)
        return in_meridian(point, self.revolved), _slopes(point, slope, self.revolved)

    def sampled(self) -> tuple[Reals, Reals]:
        """Places (n,) along all lines, and (x, r) (k, n, 2) there, of the real face."""
        spans = np.unique(self.face.knots_u if self.along == "u" else self.face.knots_v)
        places = _divided(spans, IN_A_SPAN)
        both = (places, self.at) if self.along == "u" else (self.at, places)
        found = np.real(self.face.grid(*both))
        return places, in_meridian(np.swapaxes(found, 0, 1) if self.along == "u" else found, self.revolved)


def searched(lines: Lines, meridian: Curve) -> list[list[tuple[float, float]]]:
    """All (place, t) at which each line meets the meridian, roughly: where straight pieces of both cross."""
    places, points = lines.sampled()
    t = _divided(np.unique(meridian.knots), ON_THE_CUT if meridian.degree > 1 else 1)
    cut = np.real(meridian(t))
    found = []
    for line in points:
        side = cross2(np.diff(cut, axis=0), line[:, None] - cut[:-1]) > 0.0
        other = cross2(np.diff(line, axis=0)[:, None], cut - line[:-1, None]) > 0.0
        which, piece = np.nonzero((side[1:] != side[:-1]) & (other[:, 1:] != other[:, :-1]))
        start, step, leg = line[which], np.diff(line, axis=0)[which], np.diff(cut, axis=0)[piece]
        area, gap = cross2(step, leg), cut[piece] - start
        own, cuts = cross2(gap, leg) / area, cross2(gap, step) / area
        at_place = places[which] + own * np.diff(places)[which]
        found.append(list(zip(at_place.tolist(), (t[piece] + cuts * np.diff(t)[piece]).tolist(), strict=True)))
    return found


def crossing(lines: Lines, meridian: Curve, near: Crossing) -> Crossing | None:
    """Where lines meet the meridian, by Newton's method from `near`; None where one is not found inside its face.

    Of complex lines or meridians one more step carries the imaginary part, the derivative of the root.
    """
    real, cut = lines.real(), real_curve(meridian)
    place, t = np.real(near.place), np.real(near.t)
    steps = _steps(real, cut, place, t)
    for _ in range(STEPS):
        place, t = np.clip(place - steps.place, 0.0, 1.0), np.clip(t - steps.t, *cut.domain)
        steps = _steps(real, cut, place, t)
        if np.max(np.square(steps.place)) < 1e-30:
            break
    if not np.max(np.square(steps.place)) < 1e-22:
        return None
    if np.iscomplexobj(lines.face.control_points) or np.iscomplexobj(meridian.control_points):
        steps = _steps(lines, meridian, place, t)
        return Crossing(place - 1j * np.imag(steps.place), t - 1j * np.imag(steps.t))
    return Crossing(place, t)


def crossing_rates(lines: Lines, meridian: Curve, met: Crossing) -> tuple[Array, Array]:
    """First and second derivatives (k,) of the place, as the line's own parameter changes.

    By differentiating P(s, C(s)) = M(t(s)) in (x, r) twice.
    """
    place, t = met
    point, across, along = lines.points(place), lines.points(place, 0, 1), lines.points(place, 1)
    slope, turn = (meridian.derivative(t, order) for order in (1, 2))
    towards = _slopes(point, along, lines.revolved)
    rate, t_rate = _solved(towards, slope, -_slopes(point, across, lines.revolved))
    path = across + along * rate[:, None]
    bend = lines.points(place, 0, 2) + 2.0 * lines.points(place, 1, 1) * rate[:, None]
    bend = bend + lines.points(place, 2) * rate[:, None] ** 2
    second = _bends(point, path, bend, lines.revolved)
    return rate, _solved(towards, slope, turn * t_rate[:, None] ** 2 - second)[0]


def in_meridian(points: Array, revolved: bool) -> Array:
    """(x, r) (..., 2) of points (..., 3), or (x, z) in a cascade."""
    return np.stack([points[..., 0], length(points[..., 1:]) if revolved else points[..., 2]], axis=-1)


def _slopes(points: Array, slopes: Array, revolved: bool) -> Array:
    """Derivatives of (x, r) (k, 2) from points and their derivatives (k, 3)."""
    last = dot(unit(points[..., 1:]), slopes[..., 1:]) if revolved else slopes[..., 2]
    return np.stack([slopes[..., 0], last], axis=-1)


def _bends(points: Array, slopes: Array, bends: Array, revolved: bool) -> Array:
    """Second derivatives of (x, r): r r'' = y y'' + z z'' + y'^2 + z'^2 - r'^2."""
    found = _slopes(points, bends, revolved)
    if not revolved:
        return found
    rate = _slopes(points, slopes, revolved)[..., 1]
    more = (dot(slopes[..., 1:], slopes[..., 1:]) - rate**2) / length(points[..., 1:])
    return found + np.stack([np.zeros_like(more), more], axis=-1)


def _steps(lines: Lines, meridian: Curve, place: Reals, t: Reals) -> Crossing:
    point, slope = lines.meridional(place)
    return Crossing(*_solved(slope, meridian.derivative(t), point - meridian(t)))


def _solved(along: Array, cut: Array, miss: Array) -> tuple[Array, Array]:
    """a and b (k,) of a `along` - b `cut` = `miss`, (k, 2) each."""
    area = cross2(along, cut)
    with np.errstate(all="ignore"):
        return cross2(miss, cut) / area, cross2(miss, along) / area


def _divided(spans: Reals, count: int) -> Reals:
    inner = [spans[:-1] + np.diff(spans) * (k + ASIDE) / count for k in range(count)]
    return np.concatenate([spans[:1], np.stack(inner, axis=-1).ravel(), spans[-1:]])


def continued(curve: Curve, reach: Callable[[Reals], float], *, revolved: bool) -> Curve:
    """A meridian continued straight past both ends, as far as `reach` says of its end point [m], but not past the axis.

    A straight one stays one piece; else the continuations are pieces of their own, tangent to the curve.
    """
    low, high = curve.domain
    slopes = curve.derivative(np.array([low, high]))
    speed = length(np.real(slopes))
    ends = np.real(curve(np.array([low, high])))
    away = []
    for point, slope, sign in zip(ends, np.real(slopes) / speed[:, None], (-1.0, 1.0), strict=True):
        towards_axis = -sign * slope[1]
        to_axis = 0.999 * point[1] / towards_axis if revolved and towards_axis > 0.0 else np.inf
        away.append(min(reach(point), to_axis))
    start, end = low - away[0] / float(speed[0]), high + away[1] / float(speed[1])
    if len(curve.control_points) == 2:
        return extended(curve, start, end)
    degree, shares = curve.degree, (np.arange(curve.degree) + 1.0) / curve.degree
    before = curve.control_points[0] + (start - low) * shares[::-1, None] * slopes[0]
    after = curve.control_points[-1] + (end - high) * shares[:, None] * slopes[1]
    knots = np.concatenate([np.full(degree + 1, start), curve.knots[1:-1], np.full(degree + 1, end)])
    return Curve(control_points=np.concatenate([before, curve.control_points, after]), knots=knots, degree=degree)


def real_curve(curve: Curve) -> Curve:
    """The curve without imaginary parts."""
    if not np.iscomplexobj(curve.control_points):
        return curve
    return Curve(control_points=np.real(curve.control_points), knots=curve.knots, degree=curve.degree)


def real_face(face: Surface) -> Surface:
    """The surface without imaginary parts."""
    if not np.iscomplexobj(face.control_points):
        return face
    return replace(face, control_points=np.real(face.control_points))
