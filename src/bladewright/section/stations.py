"""Laws of evolution by values at stations: natural cubic splines, monotone quintic splines, straight lines."""

from functools import lru_cache
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from bladewright.numerics.elementary import Array, concatenated
from bladewright.nurbs.basis import Reals

SLOPE = 2.5
"""Largest slope of a monotone spline at a station, of the chord's to either neighbour: the middle of a piece's six
Bernstein coefficients stays between the others up to there [-]"""
MIDDLE_SLOPE = 1.25
"""The same of the slope of the parabola through a station and its two neighbours: both pieces' limits of the second
derivative have a value in common up to there [-]"""


@lru_cache(maxsize=512)
def natural_spline(span: tuple[float, ...]) -> CubicSpline:
    """The natural cubic splines through 1 at one station and 0 at the others: values (m, n) of n stations."""
    return CubicSpline(np.array(span), np.eye(len(span)), bc_type="natural")


def natural_weights(span: tuple[float, ...], v: Reals) -> Reals:
    """Weights (m, n) of the values at n stations in the natural cubic spline at v (m,)."""
    return np.asarray(natural_spline(span)(v))


def linear_weights(span: tuple[float, ...], v: Reals) -> Reals:
    """Weights (m, n) of the values at n stations in straight lines between them, at v (m,)."""
    piece, t = _pieces(np.array(span), v)
    weights, row = np.zeros((len(v), len(span))), np.arange(len(v))
    weights[row, piece], weights[row, piece + 1] = 1.0 - t, t
    return weights


def monotone_values(span: tuple[float, ...], values: Array, v: Reals) -> Array:
    """Values (..., m) at v (m,) of the monotone quintic spline through values (..., n) at n stations.

    A piece is a quintic with value, slope and second derivative given at both ends, so that two derivatives are
    continuous. They are those of the natural cubic spline, brought into the limits within which the Bernstein
    coefficients of every piece lie in the order of its end values, and at or between them and their mean: it is
    monotone then. Where nothing is limited the two splines are the same.

    Reference: Dougherty, Edelman and Hyman 1989, Math. Comp. 52, section 4, with limits that each station has alone.
    """
    x = np.array(span)
    h, secant = np.diff(x), np.diff(values) / np.diff(x)
    slope = _limited_slope(values @ natural_spline(span)(x, 1).T, secant, h)
    bend = _limited_bend(values @ natural_spline(span)(x, 2).T, slope, secant, h)
    first, last = slice(None, -1), slice(1, None)
    start, end = values[..., first], values[..., last]
    rise = h * slope[..., first] / 5.0, h * slope[..., last] / 5.0
    curved = h**2 * bend[..., first] / 20.0, h**2 * bend[..., last] / 20.0
    inner = [start + rise[0], start + 2.0 * rise[0] + curved[0], end - 2.0 * rise[1] + curved[1], end - rise[1]]
    piece, t = _pieces(x, v)
    coefficients = np.stack([start, *inner, end])[..., piece]
    bernstein = np.stack([comb(5, k) * t**k * (1.0 - t) ** (5 - k) for k in range(6)])
    return np.asarray(np.einsum("k...m,km->...m", coefficients, bernstein))


def _pieces(x: Reals, v: Reals) -> tuple[NDArray[np.intp], Reals]:
    """Number (m,) of the piece of each v, and where in it v lies, 0 to 1."""
    piece = np.clip(np.searchsorted(x, v, side="right") - 1, 0, len(x) - 2)
    return piece, (v - x[piece]) / np.diff(x)[piece]


def _limited_slope(slope: Array, secant: Array, h: Reals) -> Array:
    """Slopes (..., n) between 0 and the least of their limits: 0 where the values turn."""
    before, after = secant[..., :-1], secant[..., 1:]
    parabola = (before * h[1:] + after * h[:-1]) / (h[1:] + h[:-1])
    most = _nearer_zero(_nearer_zero(SLOPE * before, SLOPE * after), MIDDLE_SLOPE * parabola)
    most = np.where(np.real(before) * np.real(after) > 0.0, most, 0.0)
    most = concatenated([SLOPE * secant[..., :1], most, SLOPE * secant[..., -1:]], axis=-1)
    return _within(slope, *_ordered(np.zeros_like(most), most))


def _limited_bend(bend: Array, slope: Array, secant: Array, h: Reals) -> Array:
    """Second derivatives (..., n) within the limits of both pieces that meet at a station."""
    start, end = slope[..., :-1], slope[..., 1:]
    behind = _ordered(-4.0 * start / h, (10.0 * secant - 8.0 * start) / h)
    ahead = _ordered(4.0 * end / h, (8.0 * end - 10.0 * secant) / h)
    low, high = (
        concatenated([one[..., :1], narrower(one[..., 1:], other[..., :-1]), other[..., -1:]], axis=-1)
        for one, other, narrower in zip(behind, ahead, (_larger, _smaller), strict=True)
    )
    return _within(bend, low, high)


def _smaller(a: Array, b: Array) -> Array:
    return np.where(np.real(a) < np.real(b), a, b)


def _larger(a: Array, b: Array) -> Array:
    return np.where(np.real(a) > np.real(b), a, b)


def _nearer_zero(a: Array, b: Array) -> Array:
    return np.where(np.real(a) ** 2 < np.real(b) ** 2, a, b)


def _ordered(a: Array, b: Array) -> tuple[Array, Array]:
    return _smaller(a, b), _larger(b, a)


def _within(value: Array, low: Array, high: Array) -> Array:
    return _larger(_smaller(value, high), low)
