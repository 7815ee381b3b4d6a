"""Bezier patches of curves and surfaces, and the algebra of polynomials in Bernstein form."""

from dataclasses import dataclass
from functools import cache, lru_cache
from math import comb

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.blossom import knot_change
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface


@dataclass(frozen=True, kw_only=True)
class Patches:
    """The Bezier patches of a real surface in one array; a real curve counts as a surface of degree 0 in v."""

    nets: Reals
    """(k, p + 1, q + 1, d + 1) homogeneous control points (w P, w)"""
    low: Reals
    """(k, 2) u and v at which a patch starts"""
    high: Reals
    """(k, 2) u and v at which it ends"""
    shape: tuple[int, int]
    """number of patches along u and v: patch i, j has index i shape[1] + j"""
    rational: bool
    """whether there are weights: all are one otherwise"""

    @property
    def degrees(self) -> tuple[int, int]:
        """Degrees along u and v."""
        return self.nets.shape[1] - 1, self.nets.shape[2] - 1

    def neighbours(
        self, patch: NDArray[np.intp], steps: NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Indices (m,) of the patches `steps` (m, 2) away along u and v, and whether there is one each way (m, 2)."""
        place = np.stack(np.divmod(patch, self.shape[1]), axis=-1)
        exists = (place + steps >= 0) & (place + steps < np.array(self.shape))
        place = place + np.where(exists, steps, 0)
        return place[:, 0] * self.shape[1] + place[:, 1], exists

    def at(self, u: Reals, v: Reals) -> tuple[NDArray[np.intp], Reals]:
        """Indices (m,) of the patches that contain the parameters u and v (m,), and local parameters (m, 2) on them."""
        starts = self.low[:: self.shape[1], 0], self.low[: self.shape[1], 1]
        i, j = (
            np.clip(np.searchsorted(start, at, side="right") - 1, 0, len(start) - 1)
            for start, at in zip(starts, (u, v), strict=True)
        )
        patch = i * self.shape[1] + j
        width = self.high[patch] - self.low[patch]
        local = (np.stack([u, v], axis=-1) - self.low[patch]) / np.where(width > 0.0, width, 1.0)
        return patch, np.clip(local, 0.0, 1.0)


def patches(shape: Curve | Surface) -> Patches:
    """The Bezier patches of a curve or surface, of real parts; weights are one where it has none."""
    net = shape.homogeneous.real
    rational = shape.weights is not None
    if not rational:
        net = np.concatenate([net, np.ones((*net.shape[:-1], 1))], axis=-1)
    if isinstance(shape, Curve):
        ends = breaks(shape.knots)
        pieces = _pieces(shape.knots, shape.degree, net)[:, :, None]
        flat = np.zeros(len(pieces))
        low, high = np.stack([ends[:-1], flat], axis=-1), np.stack([ends[1:], flat], axis=-1)
        return Patches(nets=pieces, low=low, high=high, shape=(len(pieces), 1), rational=rational)
    rows = _pieces(shape.knots_u, shape.degree_u, net)
    both = np.moveaxis(_pieces(shape.knots_v, shape.degree_v, np.moveaxis(rows, 2, 0)), (0, 1), (1, 3))
    u, v = breaks(shape.knots_u), breaks(shape.knots_v)
    low = np.stack(np.meshgrid(u[:-1], v[:-1], indexing="ij"), axis=-1).reshape(-1, 2)
    high = np.stack(np.meshgrid(u[1:], v[1:], indexing="ij"), axis=-1).reshape(-1, 2)
    flat_nets = both.reshape(-1, *both.shape[2:])
    return Patches(nets=flat_nets, low=low, high=high, shape=(len(u) - 1, len(v) - 1), rational=rational)


def bernstein(degree: int, s: Reals, order: int = 0) -> Reals:
    """Bernstein polynomials' `order`-th derivatives (m, degree + 1) at s (m,) in [0, 1]."""
    if order > degree:
        return np.zeros((len(s), degree + 1))
    if order:
        lower = bernstein(degree - 1, s, order - 1)
        found = np.zeros((len(s), degree + 1))
        found[:, :-1] -= lower
        found[:, 1:] += lower
        return degree * found
    k = np.arange(degree + 1)
    return np.asarray(_binomials(degree) * s[:, None] ** k * (1.0 - s[:, None]) ** (degree - k))


def bernsteins(degree: int, s: Reals) -> Reals:
    """Bernstein polynomials and their first two derivatives (m, 3, degree + 1) at s (m,) in [0, 1].

    By powers of 2 s - 1, of which they are sums as exact as their blends: up to degree 11 within 5e-16.
    """
    rows = np.vander(2.0 * s - 1.0, degree + 1, increasing=True) @ _centred(degree)
    return np.asarray(rows.reshape(len(s), 3, degree + 1))


@cache
def _centred(degree: int) -> Reals:
    """Coefficients (degree + 1, 3 (degree + 1)) of powers of 2 s - 1, of the polynomials and two derivatives by s."""
    found = np.zeros((degree + 1, 3, degree + 1))
    rising, falling = Polynomial([0.5, 0.5]), Polynomial([0.5, -0.5])
    for i in range(degree + 1):
        polynomial = comb(degree, i) * rising**i * falling ** (degree - i)
        for order in range(3):
            row = 2.0**order * np.real(polynomial.deriv(order).coef)
            found[: len(row), order, i] = row
    return found.reshape(degree + 1, -1)


@dataclass(frozen=True, kw_only=True)
class Samples:
    """Points on patches, a grid on each, from which a search for closest points starts."""

    points: Reals
    """(n, d)"""
    patch: NDArray[np.intp]
    """(n,) index"""
    local: Reals
    """(n, 2) parameters in [0, 1] of the patch"""


def sampled(on: Patches, along: int, across: int) -> Samples:
    """`along` x `across` samples of each patch, its borders included; only one across a curve."""
    s, t = (
        np.linspace(0.0, 1.0, count) if degree else np.zeros(1)
        for degree, count in zip(on.degrees, (along, across), strict=True)
    )
    local = np.stack(np.meshgrid(s, t, indexing="ij"), axis=-1).reshape(-1, 2)
    rows = np.einsum(
        "ai,aj,kijd->kad", bernstein(on.degrees[0], local[:, 0]), bernstein(on.degrees[1], local[:, 1]), on.nets,
        optimize=True,
    )  # fmt: skip
    return Samples(
        points=(rows[..., :-1] / rows[..., -1:]).reshape(-1, rows.shape[-1] - 1),
        patch=np.repeat(np.arange(len(on.nets)), len(local)),
        local=np.tile(local, (len(on.nets), 1)),
    )


def products(a: Reals, b: Reals) -> Reals:
    """Coefficients (k, 2p + 1, 2q + 1, d) of the products of polynomials in Bernstein form (k, p + 1, q + 1, d).

    Farin 2002, section 6.4: c_k = sum over i + j = k of C(p, i) C(p, j) / C(2p, k) a_i b_j.
    """
    p, q = a.shape[1] - 1, a.shape[2] - 1
    scale = _binomials(p)[:, None, None] * _binomials(q)[:, None]
    left, right = scale * a, scale * b
    total = np.zeros((len(a), 2 * p + 1, 2 * q + 1, max(a.shape[3], b.shape[3])))
    for i in range(p + 1):
        for j in range(q + 1):
            total[:, i : i + p + 1, j : j + q + 1] += left[:, i : i + 1, j : j + 1] * right
    return np.asarray(total / (_binomials(2 * p)[:, None, None] * _binomials(2 * q)[:, None]))


@cache
def halving(degree: int) -> tuple[Reals, Reals]:
    """Matrices (degree + 1, degree + 1) from Bernstein coefficients to those of the left and the right half."""
    left = np.array([[comb(i, j) / 2.0**i if j <= i else 0.0 for j in range(degree + 1)] for i in range(degree + 1)])
    return left, left[::-1, ::-1].copy()


@cache
def _binomials(degree: int) -> Reals:
    return np.array([comb(degree, i) for i in range(degree + 1)], dtype=np.float64)


def _pieces(knots: Reals, degree: int, net: Reals) -> Reals:
    """Control points (k, degree + 1, ...) of the Bezier pieces of a spline with control points (n, ...)."""
    control = np.tensordot(_extraction(np.asarray(knots, dtype=np.float64).tobytes(), degree), net, axes=1)
    starts = np.arange((len(control) - 1) // degree) * degree
    return np.asarray(control[starts[:, None] + np.arange(degree + 1)])


@lru_cache(maxsize=32)
def _extraction(knots: bytes, degree: int) -> Reals:
    """The Bezier extraction matrix; pieces share control points at the breaks. `knots` are the array's bytes."""
    plain = np.frombuffer(knots)
    full = np.concatenate([plain[:1], np.repeat(breaks(plain), degree), plain[-1:]])
    return knot_change(plain, degree, full)
