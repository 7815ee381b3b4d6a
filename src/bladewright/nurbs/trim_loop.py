"""The loops of a trimmed surface as closed chains of plane curves, and which points they enclose."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, PPoly

from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import piece as part


@dataclass(frozen=True, kw_only=True)
class TrimLoop:
    """Closed loops of plane curves cut into pieces on which v is monotone."""

    curves: tuple[Curve, ...]
    """the loops one after another, of real parts"""
    curve: NDArray[np.intp]
    """(k,) which curve a piece belongs to"""
    start: Reals
    """(k,) parameter at which a piece starts"""
    end: Reals
    """(k,) parameter at which it ends"""
    v_start: Reals
    """(k,) v at its start: to the bit the v at the end of the piece before"""
    v_end: Reals
    """(k,) v at its end"""
    low: Reals
    """(2,) smallest u and v of the control points"""
    high: Reals
    """(2,) largest u and v of the control points"""


def coordinate_roots(curve: Curve, coordinate: int, value: float, order: int = 0) -> Reals:
    """Parameters (k,), sorted and inside the domain, where a coordinate of a real curve has a value.

    With order 1, where a B-spline's coordinate or the numerator of a rational one's derivative is stationary.
    A stretch on which the coordinate is constant at the value gives none.
    """
    points = curve.control_points.real[:, coordinate]
    if curve.weights is None:
        spline = PPoly.from_spline(BSpline(curve.knots, points, curve.degree))
        found = spline.derivative().roots() if order else spline.solve(value)
    elif order:
        found = _rational_stationary(curve, coordinate)
    else:
        weights = curve.weights.real
        found = PPoly.from_spline(BSpline(curve.knots, weights * (points - value), curve.degree)).roots()
    found = np.asarray(found, dtype=np.float64)
    first, last = curve.domain
    return np.unique(found[np.isfinite(found) & (found >= first) & (found <= last)])


def meeting_parameters(curve: Curve, values_u: Reals, values_v: Reals) -> Reals:
    """Parameters (k,) where a plane curve crosses any of the lines u = values_u or v = values_v."""
    lines = [(0, value) for value in values_u] + [(1, value) for value in values_v]
    low, high = curve.control_points.real.min(axis=0), curve.control_points.real.max(axis=0)
    met = [coordinate_roots(curve, axis, value) for axis, value in lines if low[axis] < value < high[axis]]
    return np.concatenate([np.zeros(0), *met])


def trim_loop(loops: Sequence[Sequence[Curve]]) -> TrimLoop:
    """Closed loops of curves, of real parts, cut into pieces on which v is monotone."""
    real = tuple(_real(curve) for loop in loops for curve in loop)
    starts: list[Reals] = []
    ends: list[Reals] = []
    for curve in real:
        cuts = np.unique(np.concatenate([curve.domain, curve.knots, coordinate_roots(curve, 1, 0.0, order=1)]))
        starts.append(cuts[:-1])
        ends.append(cuts[1:])
    heights = [curve(start)[:, 1] for curve, start in zip(real, starts, strict=True)]
    of_loops = np.cumsum([0, *map(len, loops)])
    around = [np.concatenate(heights[first:last]) for first, last in pairwise(of_loops)]
    points = np.concatenate([curve.control_points for curve in real])
    return TrimLoop(
        curves=real,
        curve=np.repeat(np.arange(len(real)), list(map(len, starts))),
        start=np.concatenate(starts),
        end=np.concatenate(ends),
        v_start=np.concatenate(around),
        v_end=np.concatenate([np.roll(loop, -1) for loop in around]),
        low=points.min(axis=0),
        high=points.max(axis=0),
    )


def contained(loop: TrimLoop, u: Reals, v: Reals) -> NDArray[np.bool_]:
    """Whether points (m,) lie inside: a ray towards greater u crosses the loops an odd number of times."""
    inside = np.zeros(len(u), dtype=bool)
    for piece in range(len(loop.curve)):
        curve, start, end = loop.curves[loop.curve[piece]], loop.start[piece], loop.end[piece]
        v_start, v_end = loop.v_start[piece], loop.v_end[piece]
        level = np.flatnonzero((v >= min(v_start, v_end)) & (v < max(v_start, v_end)))
        if len(level) == 0:
            continue
        left, right = _range(curve, start, end)
        inside[level[u[level] < left]] ^= True
        doubtful = level[(u[level] >= left) & (u[level] <= right)]
        if len(doubtful) == 0:
            continue

        def height(t: Array, curve: Curve = curve, target: Reals = v[doubtful]) -> tuple[Array, Array]:
            return curve(t)[:, 1] - target, curve.derivative(t)[:, 1]

        met = bracketed_root(height, np.full(len(doubtful), start), np.full(len(doubtful), end))
        inside[doubtful[curve(met)[:, 0] > u[doubtful]]] ^= True
    return inside


def _range(curve: Curve, start: float, end: float) -> tuple[float, float]:
    control = part(curve, start, end).control_points[:, 0]
    return float(control.min()), float(control.max())


def _rational_stationary(curve: Curve, coordinate: int) -> Reals:
    numerator = PPoly.from_spline(BSpline(curve.knots, curve.homogeneous.real[:, coordinate], curve.degree))
    weights = PPoly.from_spline(BSpline(curve.knots, curve.homogeneous.real[:, -1], curve.degree))
    found: list[Reals] = []
    for index in range(len(numerator.x) - 1):
        if numerator.x[index + 1] > numerator.x[index]:
            top, bottom = np.poly1d(numerator.c[:, index]), np.poly1d(weights.c[:, index])
            roots = (top.deriv() * bottom - top * bottom.deriv()).roots
            roots = roots.real[roots.imag**2 <= 1e-20]
            width = numerator.x[index + 1] - numerator.x[index]
            found.append(numerator.x[index] + roots[(roots >= 0.0) & (roots <= width)])
    return np.concatenate([np.zeros(0), *found])


def _real(curve: Curve) -> Curve:
    weights = None if curve.weights is None else curve.weights.real
    return Curve(control_points=curve.control_points.real, knots=curve.knots, degree=curve.degree, weights=weights)
