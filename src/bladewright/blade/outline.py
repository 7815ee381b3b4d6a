"""Outlines on a wall: plane curves that a surface of revolution, or a cylinder along y, maps on curves in space."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, dot, length
from bladewright.numerics.roots import crossings
from bladewright.nurbs.basis import Reals, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.joints import jointed
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface

FOLLOWED = 1e-9
"""distance of an outline's image from the curve it follows, of the chord, besides what that lies off the wall"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Wall:
    """A meridian turned about the x axis over theta from `low` to `high`, or drawn along y in a cascade."""

    meridian: Curve
    """(x, r), or (x, z) in a cascade"""
    inner: Reals
    """the meridian's inner knots where it loses derivatives, each as often as it occurs"""
    revolved: bool
    low: float
    high: float

    @cached_property
    def revolution(self) -> Revolution | None:
        """How the wall is revolved."""
        return Revolution(meridian=self.meridian, start=self.low, end=self.high) if self.revolved else None

    @cached_property
    def surface(self) -> Surface:
        """The whole wall: u along the meridian, v across."""
        return _drawn(self.meridian, self.low, self.high) if self.revolution is None else self.revolution.surface()

    def parameters(self, u: Array, across: Array) -> Array:
        """(u, v) on the surface at the meridian's u and theta or y."""
        v = (across - self.low) / (self.high - self.low) if self.revolution is None else self.revolution.v(across)
        return np.stack([u, v], axis=-1)

    def stretch(self, uv: Reals) -> Reals:
        """Lengths (k, 2) of the surface's derivatives by u and v."""
        line = _real(self.meridian)
        around = np.full(len(uv), self.high - self.low)
        if self.revolution is not None:
            around = line(uv[:, 0])[:, 1] * self.revolution.slope(uv[:, 1])
        return np.stack([length(line.derivative(uv[:, 0])), around], axis=-1)

    @property
    def seams(self) -> Reals:
        """theta between the rational arcs, where the surface has one continuous derivative."""
        return (
            np.empty(0) if self.revolution is None else np.linspace(self.low, self.high, self.revolution.arcs + 1)[1:-1]
        )


class Trace:
    """A curve in space on its wall: the meridian's u and theta, or y in a cascade, by the curve's parameter."""

    def __init__(self, end: Curve, meridian: Curve, revolved: bool, places: Reals, u: Reals, across: Reals) -> None:
        """`u` and `across` (k,) are near the curve's own at increasing `places` (k,), linear between."""
        self.end, self.meridian, self.revolved = end, meridian, revolved
        self.across, self._places, self._u = across, places, u

    def __call__(self, s: Reals) -> tuple[Array, Array]:
        """u and theta or y (len(s),) of the feet of the end's points on the wall's meridian."""
        points = self.end(s)
        if self.revolved:
            radius = length(points[..., 1:])
            across = angle(points[..., 1], points[..., 2])
            near = np.interp(s, self._places, self.across)
            across = across + 2.0 * np.pi * np.round((near - np.real(across)) / (2.0 * np.pi))
        else:
            radius, across = points[..., 2], points[..., 1]
        target = np.stack([points[..., 0], radius], axis=-1)
        u = np.interp(s, self._places, self._u)
        # the second brings rounding, without which the derivative would be as far off as the first left the place
        for _ in range(2):
            u = u + _foot_step(self.meridian, u, np.real(target))
        return u + _foot_step(self.meridian, u, target), across

    def joints(self, wall: Wall) -> list[tuple[float, int]]:
        """Where the curve passes inner places of the wall, each with the derivatives that the wall's parameters keep.

        Between rational arcs, which are symmetric, that is one.
        """

        def passed(which: int, values: Reals, levels: Reals) -> list[float]:
            return list(map(float, crossings(lambda s: np.real(self(s)[which]), self._places, values, levels)))

        levels, counts = np.unique(wall.inner, return_counts=True)
        own = [
            (place, self.meridian.degree - int(times))
            for times in np.unique(counts)
            for place in passed(0, self._u, levels[counts == times])
        ]
        return [*own, *((place, 1) for place in passed(1, self.across, wall.seams))]


def _foot_step(meridian: Curve, u: Reals, target: Array) -> Array:
    """Newton's step towards the nearest point of the meridian."""
    miss, slope, bend = target - meridian(u), meridian.derivative(u), meridian.derivative(u, 2)
    return dot(miss, slope) / (dot(slope, slope) - dot(miss, bend))


def followed(wall: Wall, trace: Trace, chord: float, knots: Reals | None = None) -> Curve:
    """A plane B-spline that the wall maps on the traced curve, as smooth as that, its knots cut until it follows.

    Or on given knots, as they are. Raises DesignError where it does not come within FOLLOWED of the chord.
    """
    end = trace.end
    if knots is not None:
        sites = greville(knots, end.degree)
        return interpolated(wall.parameters(*trace(sites)), sites, degree=end.degree, knots=knots)
    own = jointed(end.knots, end.degree, trace.joints(wall))
    spans = np.unique(own)
    for pieces in (2, 3, 4, 6, 8):
        added = [spans[:-1] + np.diff(spans) * k / pieces for k in range(1, pieces)]
        knots = np.sort(np.concatenate([own, *added]))
        sites = greville(knots, end.degree)
        curve = interpolated(wall.parameters(*trace(sites)), sites, degree=end.degree, knots=knots)
        between = (sites[1:] + sites[:-1]) / 2.0
        exact, found = np.real(wall.parameters(*trace(between))), np.real(curve(between))
        miss = length((found - exact) * wall.stretch(exact))
        if np.max(miss) < FOLLOWED * chord:
            return curve
    raise DesignError(
        f"channel: an end of the blade cannot be followed on its wall within {FOLLOWED:g} of the chord, "
        f"{np.max(miss) / chord:.2g} is reached: smooth the wall by a higher channel.degree or fewer inner control "
        "points, or lower the tolerance"
    )


def _real(curve: Curve) -> Curve:
    if not np.iscomplexobj(curve.control_points):
        return curve
    return Curve(control_points=np.real(curve.control_points), knots=curve.knots, degree=curve.degree)


def _drawn(meridian: Curve, low: float, high: float) -> Surface:
    """The meridian (x, z) drawn along y from low to high."""
    x, z = meridian.control_points[:, 0], meridian.control_points[:, 1]
    rows = [np.stack([x, np.full_like(x, y), z], axis=-1) for y in (low, high)]
    return Surface(
        control_points=np.stack(rows, axis=1),
        knots_u=meridian.knots,
        knots_v=np.array([0.0, 0.0, 1.0, 1.0]),
        degree_u=meridian.degree,
        degree_v=1,
    )
