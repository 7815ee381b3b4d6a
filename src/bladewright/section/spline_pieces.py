"""B-spline functions piece by piece, for parameters that differ from section to section and may be complex."""

from dataclasses import dataclass
from functools import cached_property
from math import factorial

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, basis, breaks, uniform_knots
from bladewright.section.thickness.series import Series, polynomial


@dataclass(frozen=True, kw_only=True, eq=False)
class SplinePieces:
    """Clamped uniform B-splines over [0, 1] of degree 3, or one less than their number of control points."""

    controls: Array
    """(..., n): each section's control points"""

    @cached_property
    def ends(self) -> Reals:
        """Ends (k + 1,) of the k pieces."""
        return breaks(self._knots)

    @cached_property
    def _degree(self) -> int:
        return min(self.controls.shape[-1] - 1, 3)

    @cached_property
    def _knots(self) -> Reals:
        count = self.controls.shape[-1]
        return uniform_knots(count, self._degree) if count > 1 else np.array([0.0, 1.0])

    @cached_property
    def _powers(self) -> list[Array]:
        """Coefficients (..., k) of the powers of the distance from each piece's start."""
        starts, orders = self.ends[:-1], range(self._degree + 1)
        rows = [basis(self._knots, self._degree, starts, order) / factorial(order) for order in orders]
        return [self.controls @ row.T for row in rows]

    def piece(self, at: Array) -> Array:
        """Which piece (...) real parts belong to; those past an end to the end's."""
        return np.clip(np.searchsorted(self.ends, np.real(at), side="right") - 1, 0, len(self.ends) - 2)

    def values(self, at: Series, piece: Array) -> Series:
        """Values at parameters (..., k) that belong to given pieces, (k,) or (..., k)."""
        if piece.ndim == 1:
            taken = [each[..., piece] for each in self._powers]
        else:
            shape = np.broadcast_shapes(piece.shape[:-1], self.controls.shape[:-1])
            index = np.broadcast_to(piece, (*shape, piece.shape[-1]))
            wide = [np.broadcast_to(each, (*shape, each.shape[-1])) for each in self._powers]
            taken = [np.take_along_axis(each, index, axis=-1) for each in wide]
        return polynomial(taken, at - self.ends[piece])
