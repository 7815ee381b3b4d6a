"""Figures of the distances of points from a blade, of all and by its regions."""

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals

REGIONS = ("sides", "leading edge", "trailing edge", "ends")
"""regions of a blade in which a point of a cloud may lie"""
FIGURES = ("mean", "rms", "percentile_99", "maximum")
"""figures of a deviation that are reported"""


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """Distances of some points of a cloud from the surface [m]."""

    count: int
    mean: float
    rms: float
    percentile_99: float
    maximum: float

    def to_dict(self) -> dict[str, float]:
        """The figures, for JSON."""
        return asdict(self)


def deviation_of(distances: Reals) -> Deviation:
    """The figures of distances (n,) [m]; all 0 where there are none."""
    if len(distances) == 0:
        return Deviation(count=0, mean=0.0, rms=0.0, percentile_99=0.0, maximum=0.0)
    return Deviation(
        count=len(distances),
        mean=float(np.mean(distances)),
        rms=float(np.sqrt(np.mean(distances**2))),
        percentile_99=float(np.percentile(distances, 99.0)),
        maximum=float(np.max(distances)),
    )


def by_region(distances: Reals, regions: NDArray[np.str_]) -> dict[str, Deviation]:
    """The figures of each region that has points."""
    return {name: deviation_of(distances[regions == name]) for name in REGIONS if np.any(regions == name)}
