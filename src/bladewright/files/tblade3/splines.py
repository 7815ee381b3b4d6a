"""T-Blade3's cubic B-splines along the span, which meet their first and last control point."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bladewright.nurbs.basis import Reals

STEPS = 80
"""bisections of a segment's parameter: more than the digits of a number ask for"""
_BASIS = np.array([[1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]]) / 6.0
"""powers of t times control points, of a segment of a uniform cubic B-spline"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanSpline:
    """The uniform cubic B-spline of points (span, values), as a function of the span.

    Its control points are `span` (n,), increasing, and `values` (n,) or (n, k), continued at both ends by one point
    P0 = 2 P1 - P2, which brings the curve through the first and the last and takes its second derivative there; n - 1
    segments. Span and values are evaluated at one parameter, as span = f(t) is inverted (Nemnem et al. 2014, eq. 6).
    """

    span: Reals
    values: Reals

    def __call__(self, span: ArrayLike) -> Reals:
        """Values (m,) or (m, k) at spans (m,); those beyond the ends are taken at the ends."""
        at = np.clip(np.asarray(span, dtype=np.float64), self.span[0], self.span[-1])
        # span and value of each segment's polynomial, (n - 1, 4) and (n - 1, 4, ...)
        places, values = _polynomials(self.span), _polynomials(self.values)
        segment = np.clip(np.searchsorted(places[:, 0], at, side="right") - 1, 0, len(places) - 1)
        powers = _inverted(places[segment], at)[:, None] ** np.arange(4.0)
        found: Reals = np.einsum("mp,mp...->m...", powers, values[segment])
        for end in (0, -1):
            found[at == self.span[end]] = self.values[end]
        return found


def _polynomials(points: Reals) -> Reals:
    """Coefficients (n - 1, 4, ...) of the powers of t in [0, 1] in each segment of the spline of points (n, ...)."""
    points = np.asarray(points, dtype=np.float64)
    extended = np.concatenate([2.0 * points[:1] - points[1:2], points, 2.0 * points[-1:] - points[-2:-1]])
    windows = np.stack([extended[k : k + len(points) - 1] for k in range(4)], axis=1)
    found: Reals = np.einsum("pk,nk...->np...", _BASIS, windows)
    return found


def _inverted(polynomials: Reals, values: Reals) -> Reals:
    """Parameters t (m,) in [0, 1] where increasing cubics (m, 4) have values (m,)."""
    low, high = np.zeros_like(values), np.ones_like(values)
    for _ in range(STEPS):
        middle = (low + high) / 2.0
        below = _horner(polynomials, middle) < values
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return (low + high) / 2.0


def _horner(polynomials: Reals, t: Reals) -> Reals:
    found: Reals = ((polynomials[:, 3] * t + polynomials[:, 2]) * t + polynomials[:, 1]) * t + polynomials[:, 0]
    return found
