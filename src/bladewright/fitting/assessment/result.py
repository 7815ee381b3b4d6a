"""What a fit hands back: the design, how well it matches the cloud, and its report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Design
from bladewright.display import Shown
from bladewright.fitting.assessment.report import Deviation, by_region, deviation_of, report, text
from bladewright.frozen import FrozenRecord
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A rigid motion: `points @ rotation.T + translation`."""

    rotation: Reals
    """(3, 3)"""
    translation: Reals
    """(3,) [m]"""

    def __call__(self, points: Reals) -> Reals:
        """Moved points (..., 3)."""
        return points @ self.rotation.T + self.translation


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A fitted parameter, in the unit of its field."""

    path: str
    value: float
    deviation: float
    """standard deviation that the cloud's noise gives it; infinite where the cloud does not determine it"""
    low: float
    """lower end of the 95 % interval"""
    high: float
    """upper end of the 95 % interval"""
    identified: bool
    """whether the cloud determines it"""
    at_bound: bool
    """whether it lies on one of its bounds"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit(FrozenRecord, Shown):
    """A design fitted to a cloud of n points, and what it reaches; points are in the order of the cloud."""

    shown_as: ClassVar[str] = "fit"

    design: Design
    """a `UnifiedBlade`, or a `UnifiedSection` for a cloud in the plane"""
    built: Any
    """what the design builds: a `Blade` or a `Section`"""
    cloud: Reals
    """(n, 2) or (n, 3) the points in the machine's axes, after `motion` where there is one [m]"""
    places: NDArray[np.str_]
    """(n,) name of the nearest curve or surface: `upper`, `lower`, or one of the blade's ends or faces"""
    u: Reals
    """(n,) parameter of the nearest place along the chord"""
    v: Reals
    """(n,) parameter of the nearest place along the span; 0 for a section"""
    deviations: Reals
    """(n,) distance from the nearest place, positive outside the blade [m]"""
    regions: NDArray[np.str_]
    """(n,) region of each point: `sides`, `leading edge`, `trailing edge` or `ends`"""
    inliers: NDArray[np.bool_]
    """(n,) whether a point took part; the others are outliers, or set aside"""
    set_aside: NDArray[np.str_]
    """(n,) what a point lies on that is none of the sides, such as `hub fillet`; empty where it took part"""
    estimates: tuple[Estimate, ...]
    """the free parameters"""
    covariance: Reals
    """(k, k) of the free parameters, in their order and the units of their fields"""
    rank: int
    """number of directions in the space of the parameters that the cloud determines"""
    condition: float
    """ratio of the largest to the smallest singular value of the scaled problem"""
    noise: float
    """standard deviation of the cloud's own noise, as neighbouring points show it [m]"""
    extrema: Mapping[str, int]
    """number of extrema of the curvature of each side, the most of any section; empty where sections cannot be made"""
    tolerance: float | None
    """largest distance of an inlier that was asked for [m]"""
    failures: tuple[str, ...]
    """why the fit does not pass, each a sentence"""
    notes: tuple[str, ...]
    """what else there is to know, each a sentence"""
    evaluations: int
    """of the surface during the fit"""
    motion: Motion | None = None
    """the rigid motion from the points as given to the machine's axes"""
    interrupted: bool = False

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return not self.failures

    @property
    def distances(self) -> Reals:
        """(n,) true distances from the surface [m]."""
        return np.sqrt(self.deviations**2)

    @cached_property
    def deviation(self) -> Deviation:
        """Of all inliers."""
        return deviation_of(self.distances[self.inliers])

    @cached_property
    def by_region(self) -> dict[str, Deviation]:
        """Of the inliers of each region."""
        return by_region(self.distances[self.inliers], self.regions[self.inliers])

    @cached_property
    def by_kind_set_aside(self) -> dict[str, Deviation]:
        """Of the points that are set aside, by what they lie on."""
        kinds = np.unique(self.set_aside[self.set_aside != ""])
        return {str(kind): deviation_of(self.distances[self.set_aside == kind]) for kind in kinds}

    @property
    def mean(self) -> float:
        """Mean distance of the inliers [m]."""
        return self.deviation.mean

    @property
    def maximum(self) -> float:
        """Largest distance of an inlier [m]."""
        return self.deviation.maximum

    @property
    def chord(self) -> float:
        """Chord of what was built, the mean over the span [m]."""
        return float(np.real(self.built.chord))

    @property
    def outliers(self) -> NDArray[np.intp]:
        """Indices of the points that are outliers."""
        return np.flatnonzero(~self.inliers & (self.set_aside == ""))

    @property
    def unidentified(self) -> tuple[str, ...]:
        """Parameters that the cloud does not determine."""
        return tuple(each.path for each in self.estimates if not each.identified)

    @property
    def at_bounds(self) -> tuple[str, ...]:
        """Parameters that lie on one of their bounds."""
        return tuple(each.path for each in self.estimates if each.at_bound)

    def to_dict(self) -> dict[str, Any]:
        """The report, for JSON; lengths in metres."""
        return report(self)

    def __repr__(self) -> str:
        verdict, points = "passed" if self.passed else "FAILED", f"{len(self.cloud)} points"
        off = f"mean {self.mean:.3g} m, largest {self.maximum:.3g} m"
        name = getattr(self.design, "name", "")
        return f"<Fit '{name}' of {type(self.design).__name__}: {verdict}; {points}, {off}>"

    def __str__(self) -> str:
        return text(self)
