"""Straight segments, exact circular arcs, and exact surfaces of revolution."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, pi

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import GeometryError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

FULL_TURN = 2.0 * pi
ROUNDING = 1e-9
"""Part of a full turn by which one may exceed it before it is refused: what rounding of angles may add."""


def segment(start: ArrayLike, end: ArrayLike) -> Curve:
    """The straight line from a point (d,) to another, of degree 1 over [0, 1]."""
    return Curve(
        control_points=np.stack([np.asarray(start), np.asarray(end)]), knots=np.array([0.0, 0, 1, 1]), degree=1
    )


def arc(
    centre: ArrayLike,
    radius: complex,
    start: complex,
    end: complex,
    *,
    axes: tuple[ArrayLike, ArrayLike] = ((1.0, 0.0), (0.0, 1.0)),
) -> Curve:
    """The exact circular arc centre + radius (cos(a) axes[0] + sin(a) axes[1]), a from start to end [rad].

    Rational quadratic over [0, 1], in the fewest equal pieces of at most 90 degrees. The axes (d,) are
    orthonormal. Centre, radius, angles and axes may be complex. Raises GeometryError where start = end, the sweep
    passes a full turn or the radius is not positive. Piegl and Tiller 1997, algorithm A7.1.
    """
    if not np.real(radius) > 0.0:
        raise GeometryError(f"an arc of radius {np.real(radius):g} was asked for: the radius must be positive")
    ring, weights, knots = _turn(start, end)
    points = np.asarray(centre) + radius * (ring @ np.stack([np.asarray(axis) for axis in axes]))
    return Curve(control_points=points, knots=knots, degree=2, weights=weights)


def circle(
    centre: ArrayLike, radius: complex, *, axes: tuple[ArrayLike, ArrayLike] = ((1.0, 0.0), (0.0, 1.0))
) -> Curve:
    """The exact full circle in the plane of two orthonormal axes (d,), from the first towards the second."""
    return arc(centre, radius, 0.0, 2.0 * pi, axes=axes)


def revolved(
    curve: Curve,
    start: complex = 0.0,
    end: complex = 2.0 * pi,
    *,
    origin: ArrayLike = (0.0, 0.0, 0.0),
    axis: ArrayLike = (1.0, 0.0, 0.0),
    smooth: bool = False,
) -> Surface:
    """The exact surface of a curve (n, 3) turned right-handed about an axis (3,) through `origin`, start to end [rad].

    u runs along the curve, v in [0, 1] with the turn, though not in proportion to the angle. Its arcs are quadratic, or
    where it is to be `smooth` quartic with the same parameter: their numerators and denominators join with a continuous
    derivative, as other programs ask of a face in one piece. Raises GeometryError where the curve is not in space or
    the turn is none or more than a full one. Piegl and Tiller 1997, algorithm A8.1.
    """
    if curve.control_points.shape[1:] != (3,):
        raise GeometryError(f"a curve of shape {curve.control_points.shape} was to be revolved: it must be (n, 3)")
    ring, weights, knots = _smooth(*_turn(start, end)) if smooth else _turn(start, end)
    direction = unit(np.asarray(axis, dtype=np.result_type(np.asarray(axis), np.float64)))
    offset = curve.control_points - np.asarray(origin)
    along = (offset @ direction)[:, None] * direction
    outward = offset - along
    sideways = np.cross(direction, outward)
    points = np.asarray(origin) + along[:, None] + ring[:, :1] * outward[:, None] + ring[:, 1:] * sideways[:, None]
    own = np.ones(len(points)) if curve.weights is None else curve.weights
    return Surface(
        control_points=points,
        weights=own[:, None] * weights,
        knots_u=curve.knots,
        knots_v=knots,
        degree_u=curve.degree,
        degree_v=4 if smooth else 2,
    )


def arc_count(turns: float) -> int:
    """Number of equal rational arcs of at most a right angle in a part of a full turn."""
    return max(1, ceil(4.0 * turns - ROUNDING))


def _turn(start: complex, end: complex) -> tuple[Array, Array, Reals]:
    """Control points (n, 2), weights (n,) and knots of the unit arc from start to end [rad]."""
    sweep = end - start
    turns = np.real(sweep) / FULL_TURN
    if not 0.0 < turns * np.copysign(1.0, turns) <= 1.0 + ROUNDING:
        raise GeometryError(
            f"a turn from {np.real(start):g} to {np.real(end):g} rad was asked for: it must be more than none "
            "and at most 2 pi; split a longer one"
        )
    pieces = arc_count(turns * np.copysign(1.0, turns))
    half = sweep / (2 * pieces)
    angles = start + half * np.arange(2 * pieces + 1)
    weights = np.where(np.arange(2 * pieces + 1) % 2 == 1, np.cos(half), 1.0)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=-1) / weights[:, None]
    if turns * turns > (1.0 - ROUNDING) ** 2:
        ring[-1] = ring[0]
    inner = np.repeat(np.arange(1, pieces) / pieces, 2)
    return ring, weights, np.concatenate([np.zeros(3), inner, np.ones(3)])


def _smooth(ring: Array, weights: Array, knots: Reals) -> tuple[Array, Array, Reals]:
    """The same arcs as quartic ones: numerator and denominator of each times 1 + 2 (1 - w) t (1 - t), w in its middle.

    So the denominator has no derivative at the joints, where the numerators' are equal by symmetry: one control point
    in the middle of its neighbours and one knot less are needed there.
    """
    net = np.concatenate([ring, np.ones_like(ring[:, :1])], axis=1) * weights[:, None]
    first, middle, last = net[:-2:2], net[1:-1:2], net[2::2]
    factor = 2.0 - weights[1]
    inner = [
        (factor * first + middle) / 2.0,
        (first + 4.0 * factor * middle + last) / 6.0,
        (middle + factor * last) / 2.0,
    ]
    product = np.concatenate([net[:1], np.stack(inner, axis=1).reshape(-1, 3), net[-1:]])
    joints = np.repeat(np.unique(knots)[1:-1], 3)
    return (
        product[:, :2] / product[:, 2:],
        product[:, 2],
        np.concatenate([np.zeros(5), joints, np.ones(5)]),
    )


LEFT_HANDED = (-1.0, 0.0, 0.0)
"""The axis about which theta, which turns z towards y, is right-handed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Revolution(FrozenRecord):
    """A meridian curve turned about the x axis from `start` to `end`, as rational quadratic arcs along v in [0, 1].

    On an arc of half angle h about its middle, with the arc's own parameter t in [0, 1], the angle from the middle is
    2 atan(tan(h / 2) (2 t - 1)).
    """

    meridian: Curve
    """(x, r) in metres"""
    start: float
    """theta at v = 0 [rad]"""
    end: float
    """theta at v = 1 [rad]"""

    @cached_property
    def arcs(self) -> int:
        """Number of rational arcs, each of at most a right angle."""
        return arc_count((self.end - self.start) / FULL_TURN)

    def theta(self, v: ArrayLike) -> Reals:
        """Angle [rad] at real v (...)."""
        v = np.asarray(v, dtype=np.float64)
        step = (self.end - self.start) / self.arcs
        arc = np.clip(np.floor(v * self.arcs), 0, self.arcs - 1)
        t = v * self.arcs - arc
        return self.start + (arc + 0.5) * step + 2.0 * np.arctan(np.tan(step / 4.0) * (2.0 * t - 1.0))

    def slope(self, v: ArrayLike) -> Reals:
        """d theta / dv [rad] at real v (...)."""
        v = np.asarray(v, dtype=np.float64)
        step = (self.end - self.start) / self.arcs
        t = v * self.arcs - np.clip(np.floor(v * self.arcs), 0, self.arcs - 1)
        height = np.tan(step / 4.0)
        return 4.0 * self.arcs * height / (1.0 + (height * (2.0 * t - 1.0)) ** 2)

    def v(self, theta: Array) -> Array:
        """v (...) at angles theta [rad], real or complex."""
        step = (self.end - self.start) / self.arcs
        arc = np.clip(np.floor((np.real(theta) - self.start) / step), 0, self.arcs - 1)
        away = theta - self.start - (arc + 0.5) * step
        return (arc + (1.0 + np.tan(away / 2.0) / np.tan(step / 4.0)) / 2.0) / self.arcs

    def surface(self, *, smooth: bool = False) -> Surface:
        """The rational surface: u along the meridian, v around the axis; `smooth` as in `revolved`."""
        x, r = self.meridian.control_points[:, 0], self.meridian.control_points[:, 1]
        in_space = Curve(
            control_points=np.stack([x, np.zeros_like(r), r], axis=-1),
            knots=self.meridian.knots,
            degree=self.meridian.degree,
            weights=self.meridian.weights,
        )
        return revolved(in_space, self.start, self.end, axis=LEFT_HANDED, smooth=smooth)
