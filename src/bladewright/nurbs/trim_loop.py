"""The loops of a trimmed surface as closed chains of plane curves, and which points they enclose."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import factorial

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, PPoly

from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

PIECES = 8
"""Pieces of a knot span at the least: a point in the box of a piece needs a root, and short pieces have small boxes."""


@dataclass(frozen=True, kw_only=True)
class TrimLoop:
    """Closed loops of plane curves cut into pieces on which u and v are monotone."""

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
    u_low: Reals
    """(k,) its smallest u"""
    u_high: Reals
    """(k,) its largest u"""
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
        spline = _polynomials(curve, points)
        found = spline.derivative().roots() if order else spline.solve(value)
    elif order:
        found = _rational_stationary(curve, coordinate)
    else:
        weights = curve.weights.real
        found = _polynomials(curve, weights * (points - value)).roots()
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
    """Closed loops of curves, of real parts, cut into short pieces on which u and v are monotone."""
    real = tuple(_real(curve) for loop in loops for curve in loop)
    cuts = [_cuts(curve) for curve in real]
    places = [curve(cut) for curve, cut in zip(real, cuts, strict=True)]
    u_start, u_end = (np.concatenate([place[part, 0] for place in places]) for part in (slice(-1), slice(1, None)))
    heights = [place[:-1, 1] for place in places]
    of_loops = np.cumsum([0, *map(len, loops)])
    around = [np.concatenate(heights[first:last]) for first, last in pairwise(of_loops)]
    points = np.concatenate([curve.control_points for curve in real])
    return TrimLoop(
        curves=real,
        curve=np.repeat(np.arange(len(real)), [len(cut) - 1 for cut in cuts]),
        start=np.concatenate([cut[:-1] for cut in cuts]),
        end=np.concatenate([cut[1:] for cut in cuts]),
        v_start=np.concatenate(around),
        v_end=np.concatenate([np.roll(loop, -1) for loop in around]),
        u_low=np.minimum(u_start, u_end),
        u_high=np.maximum(u_start, u_end),
        low=points.min(axis=0),
        high=points.max(axis=0),
    )


def contained(loop: TrimLoop, u: Reals, v: Reals) -> NDArray[np.bool_]:
    """Whether points (m,) lie inside: a ray towards greater u crosses the loops an odd number of times."""
    order = np.argsort(v)
    low, high = np.minimum(loop.v_start, loop.v_end), np.maximum(loop.v_start, loop.v_end)
    first, last = (np.searchsorted(v[order], bound) for bound in (low, high))
    # every piece with every point at its height
    counts = last - first
    piece = np.repeat(np.arange(len(counts)), counts)
    point = order[np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts - first, counts)]
    crossed = u[point] < loop.u_low[piece]
    doubtful = ~crossed & (u[point] <= loop.u_high[piece])
    for index, curve in enumerate(loop.curves):
        pair = np.flatnonzero(doubtful & (loop.curve[piece] == index))

        def height(t: Array, curve: Curve = curve, level: Reals = v[point[pair]]) -> tuple[Array, Array]:
            return curve(t)[:, 1] - level, curve.derivative(t)[:, 1]

        met = bracketed_root(height, loop.start[piece[pair]], loop.end[piece[pair]])
        crossed[pair] = curve(met)[:, 0] > u[point[pair]]
    return np.bincount(point[crossed], minlength=len(u)) % 2 == 1


def _cuts(curve: Curve) -> Reals:
    """Where a real curve is cut: at its knots, between them, and where u or v is stationary."""
    knots = np.unique(curve.knots)
    between = knots[:-1, None] + np.diff(knots)[:, None] * np.arange(PIECES) / PIECES
    stationary = [coordinate_roots(curve, coordinate, 0.0, order=1) for coordinate in (0, 1)]
    return np.unique(np.concatenate([knots, between.ravel(), *stationary]))


def _polynomials(curve: Curve, values: Reals) -> PPoly:
    """The polynomials of a spline on the curve's knots with coefficients (n,): one a span, of any degree.

    scipy's own conversion goes through FITPACK, which writes past its memory above degree 5.
    """
    spans = np.unique(curve.knots)
    spline = BSpline(curve.knots, values, curve.degree)
    taylor = [spline(spans[:-1], nu=order) / factorial(order) for order in range(curve.degree, -1, -1)]
    return PPoly(np.stack(taylor), spans)


def _rational_stationary(curve: Curve, coordinate: int) -> Reals:
    numerator = _polynomials(curve, curve.homogeneous.real[:, coordinate])
    weights = _polynomials(curve, curve.homogeneous.real[:, -1])
    found: list[Reals] = []
    for index in range(len(numerator.x) - 1):
        top, bottom = np.poly1d(numerator.c[:, index]), np.poly1d(weights.c[:, index])
        roots = (top.deriv() * bottom - top * bottom.deriv()).roots
        roots = roots.real[roots.imag**2 <= 1e-20]
        width = numerator.x[index + 1] - numerator.x[index]
        found.append(numerator.x[index] + roots[(roots >= 0.0) & (roots <= width)])
    return np.concatenate([np.zeros(0), *found])


def _real(curve: Curve) -> Curve:
    weights = None if curve.weights is None else curve.weights.real
    return Curve(control_points=curve.control_points.real, knots=curve.knots, degree=curve.degree, weights=weights)
