"""Which point of the camber line belongs to which point of the sides, so that periodic boundaries follow the blade.

A periodic boundary is the camber surface turned by half a pitch. With equal shares of camber line and sides,
cross-lines between blade and boundary lagged or led by up to 0.4 of the blade's length and met the joints of the walls'
meridians aslant, which asks for many knots along and across: a backswept impeller's passage had 41,733 poles, and has
20,634 with this correspondence.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import frozen
from bladewright.nurbs.basis import Reals

TERMS = 6
"""Chebyshev terms besides the cubic that the slopes at the edges determine: it should follow how the sides run, and be
so smooth that it needs no knots of its own. With 3 or 12 passages have up to 0.8 % more control points
(design/passage_constants.md)."""
EDGE_STEP = 1e-3
"""Share of the sides next to an edge from which the slope there is taken, by a difference."""
SITES = np.linspace(0.02, 0.98, 97)
"""Shares of the sides at which the correspondence is fitted by least squares."""
SIDE_SHARES = np.concatenate([[EDGE_STEP], SITES, [1.0 - EDGE_STEP]])
"""Shares of the sides whose abscissae are needed."""
CAMBER_SHARES = np.linspace(0.0, 1.0, 801)
"""Shares of the camber line whose abscissae are needed, and at which the correspondence must increase."""
LEAST_SLOPE = 0.2
"""Least slope of a correspondence, over its mean of 1: a periodic boundary that nearly stops asks for knots itself. A
quarter of it or twice as much changes control points by 0.2 % (design/passage_constants.md)."""
ATTENUATIONS = (1.0, 0.8, 0.6, 0.4, 0.2)
"""Factors by which the terms are tried in turn, until the slope is nowhere too small."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberCorrespondence(FrozenRecord):
    """The share of the camber line as a function of the share t of the sides, both from 0 to 1."""

    slopes: tuple[float, float] = (1.0, 1.0)
    """at the leading and at the trailing edge"""
    terms: Reals = ()  # type: ignore[assignment]
    """coefficients of t^2 (1 - t)^2 times the Chebyshev polynomials of 2 t - 1"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "terms", frozen(np.asarray(self.terms, dtype=np.float64)))

    def __call__(self, t: Reals) -> Reals:
        """Shares (k,) of the camber line at shares t (k,) of the sides."""
        first, last = self.slopes
        cubic = t * t * (3.0 - 2.0 * t) + first * t * (1.0 - t) ** 2 - last * t * t * (1.0 - t)
        return cubic + _terms(t, len(self.terms)) @ self.terms


def fitted_correspondence(
    camber: Reals, sides: Reals, round_edges: tuple[bool, bool], edge_slope: float
) -> CamberCorrespondence:
    """The correspondence by which camber points lie at the same abscissa as the middle of the sides.

    `camber` (m, len(CAMBER_SHARES)) are abscissae along m camber lines, `sides` (m, len(SIDE_SHARES)) those of the
    middle of both sides; the m sections count equally. At round edges, where the sides turn and their abscissa stands
    still, the slope is `edge_slope`; at others it is that of the sides.
    """
    shares = [
        np.interp(side, np.maximum.accumulate(line), CAMBER_SHARES) for side, line in zip(sides, camber, strict=True)
    ]
    wanted = np.mean(shares, axis=0)
    own = wanted[0] / EDGE_STEP, (1.0 - wanted[-1]) / EDGE_STEP
    start = CamberCorrespondence(
        slopes=(
            own[0] if not round_edges[0] and own[0] > LEAST_SLOPE else edge_slope,
            own[1] if not round_edges[1] and own[1] > LEAST_SLOPE else edge_slope,
        )
    )
    terms = np.linalg.lstsq(_terms(SITES, TERMS), wanted[1:-1] - start(SITES), rcond=None)[0]  # real: a real choice
    for share in ATTENUATIONS:
        found = CamberCorrespondence(slopes=start.slopes, terms=share * terms)
        slopes = np.diff(found(CAMBER_SHARES)) * (len(CAMBER_SHARES) - 1)
        if np.min(slopes) > min(LEAST_SLOPE, *start.slopes):
            return found
    return start


def _terms(t: Reals, count: int) -> Reals:
    """t^2 (1 - t)^2 times Chebyshev polynomials (k, count): they vanish with their slopes at both edges."""
    if count == 0:
        return np.zeros((len(t), 0))
    return np.asarray(((t * (1.0 - t)) ** 2)[:, None] * chebyshev.chebvander(2.0 * t - 1.0, count - 1))
