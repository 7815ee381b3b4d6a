"""A smooth camber line of any outline: a polynomial over the chord line with the directions of both edges."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import Edge, Outline

TERMS = 4
"""terms of the polynomial besides the cubic that the edges decide: it is within 8e-4 chords of the own camber line of
standard profiles and within 7e-5 of meanlines (design/section_constants.py); more terms come closer, and follow the
kinks that this line is to smooth"""
SITES = np.linspace(0.1, 0.9, 33)
"""s at which the outline's own camber line is met by least squares: eight for each term, and none near the edges, where
a camber line may bend sharply"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SmoothCamber:
    """Camber lines (...) in chords from (0, 0) to (1, 0), with the chord fraction as parameter."""

    slopes: tuple[Array, Array]
    """(...) at both edges"""
    terms: Array
    """(..., TERMS) coefficients of x^2 (1 - x)^2 times Chebyshev polynomials of 2 x - 1"""

    def points(self, x: Reals) -> Array:
        """Points (..., k, 2) at chord fractions x (k,)."""
        height = _cubic(self.slopes, x) + (_rows(x) @ self.terms[..., None])[..., 0]
        return np.stack(np.broadcast_arrays(x, height), axis=-1)

    @property
    def first(self) -> Array:
        """Its direction (..., 2) at the leading edge."""
        return _along(self.slopes[0])

    @property
    def last(self) -> Array:
        """Its direction (..., 2) at the trailing edge."""
        return _along(self.slopes[1])


def smooth_camber(outline: Outline) -> SmoothCamber:
    """Smooth camber lines of sections, close to their own between the edges."""
    slopes = _slope(outline.leading_edge), _slope(outline.trailing_edge)
    own = outline.camber(SITES)
    x, height = own[..., 0], own[..., 1]
    rows = _rows(x)
    residual = height - _cubic(slopes, x)
    across = np.swapaxes(rows, -1, -2)
    terms = np.linalg.solve(across @ rows, across @ residual[..., None])[..., 0]
    return SmoothCamber(slopes=slopes, terms=terms)


def _slope(edge: Edge) -> Array:
    """Slope (...) of the direction in which an edge points: normal to a round nose, between the two sides elsewhere."""
    if edge.kind == "round":
        along = edge.upper.first
        return -along[..., 0] / along[..., 1]
    middle = unit(edge.upper.first) + unit(edge.lower.first)
    return middle[..., 1] / middle[..., 0]


def _cubic(slopes: tuple[Array, Array], x: Array) -> Array:
    """Heights (..., k) at x (..., k) or (k,) of the cubic with these slopes at 0 and 1, and no height there."""
    first, last = (each[..., None] for each in slopes)
    return first * x * (1.0 - x) ** 2 - last * x**2 * (1.0 - x)


def _rows(x: Array) -> Array:
    """The terms (..., k, TERMS) at x (..., k)."""
    bump = (x * (1.0 - x)) ** 2
    return bump[..., None] * chebyshev.chebvander(2.0 * x - 1.0, TERMS - 1)


def _along(slope: Array) -> Array:
    return np.stack([np.ones_like(slope), slope], axis=-1)
