"""Fits of plain curves, surfaces and profiles: what is asked of them, and the figures that they hand back."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bladewright.errors import FitError
from bladewright.fitting.checks import check_positive, check_progress, checked_points, is_number, reals
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class FreeformFit:
    """Figures of a fit to n points, in their order and unit; base of the fits of curves, surfaces and profiles."""

    distances: Reals
    """(n,) true distances"""
    inliers: NDArray[np.bool_]
    """(n,) whether a point took part; the others are outliers, which only `robust` fits have"""
    iterations: int
    """evaluations of all distances while fitting"""
    converged: bool
    """whether the last descent converged"""
    singular_values: Reals
    """of the distances by the unknowns, each scaled to length one; largest first"""
    rank: int
    """directions of the unknowns that the points determine"""
    noise: float
    """standard deviation across the shape by which neighbouring points differ"""
    tolerance: float | None
    """largest distance of an inlier that was asked for"""
    notes: tuple[str, ...]
    """what else there is to know, each a sentence"""

    def __repr__(self) -> str:
        state = "converged" if self.converged else "not converged"
        off = f"mean {self.mean:.3g}, largest {self.maximum:.3g}"
        return f"<{type(self).__name__}: {state}; {len(self.distances)} points, {off}>"

    @property
    def unknowns(self) -> int:
        """Number of coordinates and weights that were free."""
        return len(self.singular_values)

    @property
    def condition(self) -> float:
        """Ratio of the largest to the smallest singular value; infinite where the points leave a direction open."""
        if self.unknowns == 0:
            return 1.0
        if self.rank < self.unknowns:
            return float("inf")
        return float(self.singular_values[0] / self.singular_values[-1])

    @property
    def mean(self) -> float:
        """Mean distance of the inliers."""
        return float(np.mean(self.distances[self.inliers]))

    @property
    def rms(self) -> float:
        """Root mean square of the inliers' distances."""
        return float(np.sqrt(np.mean(self.distances[self.inliers] ** 2)))

    @property
    def maximum(self) -> float:
        """Largest distance of an inlier."""
        return float(np.max(self.distances[self.inliers]))

    @property
    def passed(self) -> bool:
        """Whether the fit converged, within its tolerance where there is one."""
        return self.converged and (self.tolerance is None or self.maximum <= self.tolerance)


@dataclass(frozen=True, eq=False)
class Request:
    """What is asked of a fit to points (n, d), which works about their mean in their largest extent; or a refusal."""

    what: str
    """that is fitted, for messages"""
    given: ArrayLike
    """points, in their own unit"""
    power: float
    tolerance: float | None
    """largest distance, in the unit of the points"""
    progress: Callable[[str], None] | None
    """is handed a few words on what is done"""
    _: KW_ONLY
    dimension: int | None = None
    """of the points; None where any does"""
    weights: object = "fixed"
    robust: bool = False

    def __post_init__(self) -> None:
        if len(self._own) < 2 or not self.extent > 0.0:
            raise FitError(f"{len(self._own)} points at one place were given for {self.what}: it needs different ones")
        if isinstance(self.weights, str) and self.weights not in ("fixed", "free"):
            raise FitError(f"weights {self.weights!r} are unknown: `fixed` (all one), `free`, or positive numbers")
        if not is_number(self.power) or not 2.0 <= self.power <= 16.0:
            raise FitError(
                f"power {self.power!r} was asked for: 2 is least squares, higher ones up to 16 weigh large distances "
                "more"
            )
        if self.tolerance is not None:
            check_positive("tolerance", self.tolerance, "a positive length in the unit of the points is needed")
        check_progress(self.progress)

    @cached_property
    def _own(self) -> Reals:
        dimensions = range(2, sys.maxsize) if self.dimension is None else (self.dimension,)
        needed = f"give (n, d) with d = {self.dimension or '2, 3 or more'} coordinates"
        return checked_points(f"the points of {self.what}", self.given, dimensions, needed)

    @cached_property
    def centre(self) -> Reals:
        """Mean (d,) of the points."""
        return np.asarray(np.mean(self._own, axis=0))

    @cached_property
    def extent(self) -> float:
        """Largest extent of the points along an axis."""
        return float(np.ptp(self._own, axis=0).max(initial=0.0))

    @cached_property
    def points(self) -> Reals:
        """(n, d) in extents about the centre."""
        return self.scaled(self._own)

    @property
    def weights_free(self) -> bool:
        """Whether weights are unknown."""
        return isinstance(self.weights, str) and self.weights == "free"

    def report(self, words: str) -> None:
        """Tell what is done, where that was asked for."""
        if self.progress is not None:
            self.progress(words)

    def scaled(self, points: Reals) -> Reals:
        """Points (..., d) in extents about the centre."""
        return np.asarray((points - self.centre) / self.extent)

    def restored(self, shape: Any) -> Any:
        """A curve or surface in the unit of the points."""
        return replace(shape, control_points=shape.control_points * self.extent + self.centre)

    def ends(self, ends: Any) -> Reals | None:
        """Two ends (2, d) that are given, in extents about the centre; None for a word."""
        if isinstance(ends, str):
            if ends in ("fixed", "free"):
                return None
            raise FitError(f"ends {ends!r} are unknown: `fixed`, `free`, or the first and the last point")
        pair, count = reals("the ends", ends, "give the first and the last point"), len(self.centre)
        if pair.shape != (2, count) or not np.isfinite(pair).all():
            raise FitError(f"ends of shape {pair.shape} were given: two finite points of {count} coordinates")
        return self.scaled(pair)
