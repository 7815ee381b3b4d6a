"""Stream lines whose abscissa is their own parameter, as a counted m' is: asked for places, they need no panels."""

from dataclasses import dataclass

import numpy as np

from bladewright.blade.mapping import Mapping
from bladewright.blade.meridian_line import real_first
from bladewright.blade.stream_surfaces import StreamSurfaces
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class CountedStreamLines:
    """Stream lines (..., m) over [0, 1] of a stretch of a flow path; they answer as `StreamLines` do.

    Stream lines through hundreds of points, as flow solvers give them, have as many joints each; a blade asks for
    places on them alone.
    """

    mapping: Mapping
    surfaces: StreamSurfaces
    v: Reals
    """(m,) span fractions"""
    low: float
    """t at 0"""
    high: float
    """t at 1"""

    @property
    def starts(self) -> Reals:
        """(m, 2) the abscissa at both ends."""
        return np.tile([0.0, 1.0], (len(self.v), 1))

    def position(self, u: Array, order: int = 0) -> Array:
        """(x, r) or derivatives by u (..., m, k, 2) at u (..., m, k) or (k,)."""
        width = self.high - self.low
        places = np.broadcast_to(u, np.broadcast_shapes((len(self.v), 1), np.shape(u)))
        t = self.low + width * real_first(places, 2)
        found = self.surfaces.position(self.v, t, order) * width**order
        if not np.iscomplexobj(places):
            return found
        return found + 1j * np.imag(places)[..., None] * self.surfaces.position(self.v, t, order + 1) * width ** (
            order + 1
        )

    def abscissa(self, u: Array) -> Array:
        """The abscissa (..., m, k) at u (..., m, k) or (k,): u."""
        return np.broadcast_to(u, np.broadcast_shapes((len(self.v), 1), np.shape(u)))

    def u_at(self, abscissa: Array) -> Array:
        """u (..., m, k) at an abscissa (..., m, k): the same."""
        return abscissa

    def rows(self, which: list[int]) -> "CountedStreamLines":
        """Some of the stream lines, by their number along the span."""
        return CountedStreamLines(
            mapping=self.mapping, surfaces=self.surfaces, v=self.v[which], low=self.low, high=self.high
        )

    def real(self) -> "CountedStreamLines":
        """The same without imaginary parts and batch."""
        return CountedStreamLines(
            mapping=self.mapping, surfaces=self.surfaces.real(), v=self.v, low=self.low, high=self.high
        )
