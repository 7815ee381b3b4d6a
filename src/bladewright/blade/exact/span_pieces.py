"""Polynomials along the span through Chebyshev nodes, piece by piece."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanPieces:
    """Polynomials along the span, each through its own Chebyshev nodes."""

    ends: Reals
    """(p + 1,) of the pieces"""
    count: int
    """nodes of a piece"""

    @cached_property
    def places(self) -> Reals:
        """(p count,) all nodes."""
        own = -np.cos(np.pi * (np.arange(self.count) + 0.5) / self.count)
        middles, halves = (self.ends[1:] + self.ends[:-1]) / 2.0, np.diff(self.ends) / 2.0
        return (middles[:, None] + halves[:, None] * own).ravel()

    def weights(self, v: Array, order: int = 0) -> Array:
        """Weights (..., k, p count) of the nodes in a value, or in a derivative by v, at v (..., k)."""
        real = real_first(v, 1)
        piece = np.clip(np.searchsorted(self.ends, real, side="right") - 1, 0, len(self.ends) - 2)
        low, high = self.ends[piece], self.ends[piece + 1]
        terms = chebyshev.chebvander((2.0 * real - low - high) / (high - low), self.count - 1)
        found = np.zeros((len(real), len(self.ends) - 1, self.count))
        found[np.arange(len(real)), piece] = terms @ self._series(order) * (2.0 / (high - low))[:, None] ** order
        flat = found.reshape(len(real), (len(self.ends) - 1) * self.count)
        return flat + 1j * np.imag(v)[..., None] * self.weights(real, order + 1) if np.iscomplexobj(v) else flat

    def _series(self, order: int) -> Reals:
        """(count, count) from values at a piece's nodes to the Chebyshev series of a derivative."""
        own = -np.cos(np.pi * (np.arange(self.count) + 0.5) / self.count)
        series = np.linalg.inv(chebyshev.chebvander(own, self.count - 1))
        for _ in range(order):
            series = np.vstack([chebyshev.chebder(series), np.zeros((1, self.count))])
        return np.asarray(series)
