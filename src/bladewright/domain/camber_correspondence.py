"""Which point of the camber line belongs to which point of the sides, so that periodic boundaries follow the blade."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.numerics.elementary import frozen
from bladewright.nurbs.basis import Reals

if TYPE_CHECKING:
    from bladewright.domain.camber_lines import CamberLines


TERMS = 6
"""terms besides the cubic that the edges decide"""
SITES = np.linspace(0.02, 0.98, 97)
"""places along the sides at which the camber is to be abreast of them, by least squares"""
STEP = 1e-3
"""share of the sides by which their speed at the edges is measured"""
SLOWEST = 0.2
"""least speed of a periodic boundary, of its mean"""


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberCorrespondence:
    """The camber's parameter at t along the sides, from 0 to 1."""

    slopes: tuple[float, float] = (1.0, 1.0)
    """at the leading and at the trailing edge"""
    terms: Reals = ()  # type: ignore[assignment]
    """what t^2 (1 - t)^2 times Chebyshev polynomials of 2 t - 1 are multiplied by"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "terms", frozen(np.asarray(self.terms, dtype=np.float64)))

    def __call__(self, t: Reals) -> Reals:
        """The camber's parameters (k,) at t (k,)."""
        first, last = self.slopes
        cubic = t * t * (3.0 - 2.0 * t) + first * t * (1.0 - t) ** 2 - last * t * t * (1.0 - t)
        return cubic + _rows(t, len(self.terms)) @ self.terms


def camber_correspondence(ends: "CamberLines", quick: float) -> CamberCorrespondence:
    """The way on which cross-lines run across the flow as nearly as they can, amid hub and shroud, and both sides.

    It passes round edges `quick` faster than on average, and others as the sides do. Cross-lines that lag or lead meet
    the joints of the walls' meridians aslant, and so need many knots both along and across.
    """
    sites, fine = np.concatenate([[STEP], SITES, [1.0 - STEP]]), np.linspace(0.0, 1.0, 801)
    camber = _abscissas(ends.in_plane(ends.stations.camber(fine)))
    sides = 0.5 * (_abscissas(ends.side(sites, 1)) + _abscissas(ends.side(sites, -1)))
    shares = [np.interp(side, np.maximum.accumulate(line), fine) for side, line in zip(sides, camber, strict=True)]
    wanted = np.mean(shares, axis=0)
    own = wanted[0] / STEP, (1.0 - wanted[-1]) / STEP
    start = CamberCorrespondence(
        slopes=(
            own[0] if ends.stations.kinds[0] != "round" and own[0] > SLOWEST else 1.0 + quick,
            own[1] if ends.stations.kinds[1] != "round" and own[1] > SLOWEST else 1.0 + quick,
        )
    )
    terms = np.linalg.lstsq(_rows(SITES, TERMS), wanted[1:-1] - start(SITES), rcond=None)[0]  # real: a real choice
    for share in (1.0, 0.8, 0.6, 0.4, 0.2):
        found = CamberCorrespondence(slopes=start.slopes, terms=share * terms)
        if np.min(np.diff(found(fine))) * (len(fine) - 1) > min(SLOWEST, *start.slopes):
            return found
    return start


def _abscissas(points: Reals) -> Reals:
    """Real abscissas (m, k) of points (..., m, k, 2)."""
    found = np.real(points[..., 0])
    return np.asarray(found.reshape(-1, *found.shape[-2:])[0])


def _rows(t: Reals, count: int) -> Reals:
    if count == 0:
        return np.zeros((len(t), 0))
    return np.asarray(((t * (1.0 - t)) ** 2)[:, None] * chebyshev.chebvander(2.0 * t - 1.0, count - 1))
