"""The search for a shape near points: its unknowns by Levenberg-Marquardt on true distances, from stiff to soft.

A shape is what curves, surfaces and profiles are here: a vector of unknowns, the nearest places of points on it, and
what the unknowns do to places at held parameters. A place that is free to move along the shape takes no part of a miss
along its tangents (tangent distance minimisation: Wang, Pottmann and Liu 2006).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Generic, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.freeform.fits import Request
from bladewright.numerics.least_squares import ConstrainedProblem, constrained_minimum
from bladewright.numerics.robust import median_deviation
from bladewright.nurbs.basis import Reals

STIFFNESSES = (1e-4, 1e-6, 1e-8, 1e-10)
"""weights of the bending, in extents of the points squared, in turn (design/freeform.md)"""
STEPS, MIN_REDUCTION = 200, 1e-5
"""evaluations and predicted gain with which a descent ends (design/freeform.md)"""
OUTLYING_NOISE = 4.5
"""standard deviations of the noise from which a point is an outlier: 1 good one of 150,000 is (design/freeform.md)"""
REWEIGHTINGS = 5
"""times that the weights of least distances are found anew (design/freeform.md)"""
NOISE_RATIO = 1.25
"""root mean square of distances, of the noise, up to which they are noise (design/freeform.md)"""
ROUNDS = 12
"""times that a shape gets more control points at most; it bounds the time (design/matching_constants.md)"""
EXACT = 1e-10
"""distance, of the extent, that is rounding of the places (design/freeform.md)"""
DETERMINED = 1e-6
"""singular value, of the largest, above which the points determine its direction (design/freeform.md)"""


class Shape(ABC):
    """A shape as a function of n unknowns: control points that may move, in extents, and logarithms of weights."""

    @property
    @abstractmethod
    def unknowns(self) -> Reals:
        """Values (n,) of the unknowns."""

    @property
    def freed(self) -> Self:
        """The shape with its weights among the unknowns; itself where they are."""
        return self

    @abstractmethod
    def changed(self, unknowns: Reals) -> Self:
        """The shape with other values of its unknowns."""

    @abstractmethod
    def nearest(self, points: Reals, near: Reals | None = None) -> Reals:
        """Parameters (m, k) of the nearest places of points (m, d): of all, or where descents from `near` end."""

    @abstractmethod
    def tangents(self, parameters: Reals) -> tuple[Reals, Reals, NDArray[np.bool_]]:
        """Places (m, d), tangents (m, k, d), and along which of them (m, k) a place is free to move."""

    @abstractmethod
    def slopes(self, parameters: Reals, directions: Reals) -> Reals:
        """Derivatives (m r, n) by the unknowns of places at held parameters (m, k), along directions (m, r, d)."""

    @property
    @abstractmethod
    def bending(self) -> tuple[Reals, Reals]:
        """Residuals (b,) whose squares are the bending, and their derivatives (b, n)."""


S = TypeVar("S", bound=Shape)


@dataclass(frozen=True, kw_only=True, eq=False)
class ShapeMatch(Generic[S]):
    """A shape beside points (m, d) of unit extent."""

    shape: S
    points: Reals
    weights: Reals
    """(m,) how much each point counts: 0 of outliers"""
    parameters: Reals
    """(m, k) of the nearest places"""
    power: float = 2.0
    """power of a distance that is its cost"""
    scale: float = 1.0
    """distance that costs 1"""
    evaluations: int = 0
    converged: bool = False

    def on(self, shape: S, *, follow: bool = False) -> ShapeMatch[S]:
        """Another shape beside the same points, whose places are sought everywhere or `follow` from these."""
        return replace(self, shape=shape, parameters=shape.nearest(self.points, self.parameters if follow else None))

    @cached_property
    def _touching(self) -> tuple[Reals, Reals, NDArray[np.bool_]]:
        return self.shape.tangents(self.parameters)

    @cached_property
    def misses(self) -> Reals:
        """(m, d) from the points to their places."""
        return self._touching[0] - self.points

    @cached_property
    def distances(self) -> Reals:
        """Distances (m,) of the points."""
        return np.asarray(np.sqrt(np.sum(self.misses**2, axis=-1)))

    @property
    def inliers(self) -> NDArray[np.bool_]:
        """(m,) whether a point counts."""
        return self.weights > 0.0

    @property
    def largest(self) -> float:
        """Largest distance of an inlier."""
        return float(self.distances[self.inliers].max())

    @property
    def _factors(self) -> Reals:
        return np.sqrt(self.weights) * (self.distances / self.scale) ** (0.5 * self.power - 1.0)

    @property
    def residuals(self) -> Reals:
        """(m d,) whose squares sum to the cost of the distances."""
        return np.asarray((self._factors[:, None] * self.misses).ravel())

    @cached_property
    def jacobian(self) -> Reals:
        """(m d, n) derivatives of the residuals by the unknowns, less what lies along tangents that a place follows."""
        _, tangents, free = self._touching
        moving = np.swapaxes(np.where(free[..., None], tangents, 0.0), 1, 2)
        across = np.eye(self.points.shape[1]) - moving @ np.linalg.pinv(moving)
        unit = (self.misses / np.maximum(self.distances, EXACT)[:, None])[:, :, None]
        across = across + (0.5 * self.power - 1.0) * unit @ (np.swapaxes(unit, 1, 2) @ across)
        return self.shape.slopes(self.parameters, self._factors[:, None, None] * across)

    @cached_property
    def singular_values(self) -> Reals:
        """Of the distances by the unknowns, each scaled to length one; largest first."""
        slopes = np.asarray(np.linalg.qr(self.jacobian, mode="r"))
        size = np.sqrt(np.sum(slopes**2, axis=0))
        return np.asarray(np.linalg.svd(slopes / np.where(size > 0.0, size, 1.0), compute_uv=False))

    @property
    def rank(self) -> int:
        """Directions of the unknowns that the points determine."""
        return int(np.sum(self.singular_values > DETERMINED * self.singular_values.max(initial=0.0)))

    @property
    def softest(self) -> float:
        """The least stiffness: none where the points determine the shape."""
        return 0.0 if self.rank == len(self.shape.unknowns) else STIFFNESSES[-1]

    @cached_property
    def noise(self) -> float:
        """Standard deviation across the shape, by what planes through neighbours leave (Gasser et al. 1986)."""
        parameters, misses = self.parameters[self.inliers], self.misses[self.inliers]
        count = 2 * parameters.shape[1]
        if len(parameters) <= count:
            return 0.0
        near = cKDTree(parameters).query(parameters, k=count + 1)[1][:, 1:]
        offset = parameters[near] - parameters[:, None]
        shares = np.linalg.pinv(np.concatenate([np.ones_like(offset[..., :1]), offset], axis=-1))[:, 0]
        left = misses - np.einsum("mp,mpd->md", shares, misses[near])
        square = np.sum(left**2, axis=-1) / (1.0 + np.sum(shares**2, axis=-1))
        return float(np.sqrt(np.mean(square) / self.codimension))

    @property
    def codimension(self) -> int:
        """Number of directions across the shape."""
        return self.points.shape[1] - self.parameters.shape[1]

    def is_noise(self, rows: NDArray[np.bool_]) -> bool:
        """Whether the distances of some inliers are those of the noise."""
        square = self.distances[rows & self.inliers] ** 2
        return bool(square.sum() <= len(square) * self.codimension * (NOISE_RATIO * self.noise) ** 2)

    def figures(self, request: Request, *notes: str) -> dict[str, Any]:
        """The figures of a fit, in the unit of the points that were given."""
        rank, unknowns = self.rank, len(self.singular_values)
        if rank < unknowns:
            known = f"the points determine {rank} of {unknowns} directions of the unknowns"
            notes = (*notes, f"{known}: the others bend the shape as little as they can")
        return {
            "distances": self.distances * request.extent,
            "inliers": self.inliers,
            "iterations": self.evaluations,
            "converged": self.converged,
            "singular_values": self.singular_values,
            "rank": rank,
            "noise": self.noise * request.extent,
            "tolerance": request.tolerance,
            "notes": notes,
        }


class Problem(ConstrainedProblem, Generic[S]):
    """The residuals of a shape's distances and bending; places follow the shape by descent."""

    def __init__(self, match: ShapeMatch[S], stiffness: float) -> None:
        self.match, self.evaluations = match, 0
        self.z = self.start = match.shape.unknowns
        self.root = np.sqrt(stiffness * match.weights.sum())

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        every = np.full(len(self.start), np.inf)
        return -every, every

    def at(self, z: Reals) -> ShapeMatch[S]:
        """The shape at unknowns (n,), with its nearest places."""
        if not np.array_equal(z, self.z):
            self.z, self.match = z.copy(), self.match.on(self.match.shape.changed(z), follow=True)
        return self.match

    def values(self, z: Reals) -> tuple[Reals, Reals]:
        self.evaluations += 1
        found = self.at(z)
        return np.concatenate([found.residuals, self.root * found.shape.bending[0]]), np.zeros(0)

    def derivatives(self, z: Reals) -> tuple[Reals, Reals]:
        found = self.at(z)
        return np.concatenate([found.jacobian, self.root * found.shape.bending[1]]), np.zeros((0, len(z)))


def placed(shape: S, points: Reals) -> ShapeMatch[S]:
    """A shape beside points (m, d), which count alike."""
    return ShapeMatch(shape=shape, points=points, weights=np.ones(len(points)), parameters=shape.nearest(points))


def matched(match: ShapeMatch[S], stiffness: float) -> ShapeMatch[S]:
    """The shape at which the cost of the distances, and `stiffness` times its bending, are least."""
    if len(match.shape.unknowns) == 0:
        return replace(match, converged=True)
    problem = Problem(match, stiffness)
    found = constrained_minimum(problem, problem.start, steps=STEPS, min_reduction=MIN_REDUCTION, accelerated=False)
    last = problem.at(found.z)
    # places follow the shape by descent while it moves, and are sought everywhere at the end (design/freeform.md)
    everywhere = last.on(last.shape)
    nearer = (everywhere.distances < last.distances)[:, None]
    return replace(
        last,
        parameters=np.where(nearer, everywhere.parameters, last.parameters),
        evaluations=match.evaluations + problem.evaluations,
        converged=found.converged,
    )


def matched_by_stages(match: ShapeMatch[S], request: Request, *, warm: bool = False) -> ShapeMatch[S]:
    """The match of a shape while it softens, unless it is near (`warm`), then with free weights, then another power."""
    stiffnesses = () if warm else STIFFNESSES
    if request.robust:
        request.report("without outliers")
        match = _without_outliers(match, (*stiffnesses[:2], *[STIFFNESSES[2]] * REWEIGHTINGS))
    for stiffness in stiffnesses:
        request.report(f"{len(match.shape.unknowns)} unknowns, stiffness {stiffness:g}")
        match = matched(match, stiffness)
    match = matched(match, match.softest)
    if request.weights_free:
        request.report("free weights")
        match = replace(match, shape=match.shape.freed)
        match = matched(match, match.softest)
    if request.power != 2.0:
        request.report(f"power {request.power:g}")
        costly = replace(match, power=request.power, scale=max(match.largest, EXACT))
        match = replace(matched(costly, match.softest), power=2.0, scale=1.0)
    return match


def _without_outliers(match: ShapeMatch[S], stiffnesses: tuple[float, ...]) -> ShapeMatch[S]:
    """The match in which points further away than noise explains have no weight.

    They are told apart beside the shape of least distances, which leaves no part of the points behind, by iteratively
    reweighted least squares (Holland and Welsch 1977).
    """
    for stiffness in stiffnesses:
        spread = max(median_deviation(match.distances), EXACT)
        match = matched(replace(match, weights=spread / np.maximum(match.distances, spread)), stiffness)
    inliers = match.distances <= max(OUTLYING_NOISE * median_deviation(match.distances), EXACT)
    return replace(match, weights=inliers.astype(np.float64))


def matched_within(
    match: ShapeMatch[S], request: Request, richer: Callable[[ShapeMatch[S], float], ShapeMatch[S] | str]
) -> tuple[ShapeMatch[S], tuple[str, ...]]:
    """The match within the largest distance that is asked for, and a note why it is not reached.

    `richer` gives the match of a shape with more control points, or says why there is none; it is handed the distance.
    """
    limit = np.inf if request.tolerance is None else request.tolerance / request.extent
    reason = f"{ROUNDS} rounds of control points do not reach it"
    for _ in range(ROUNDS):
        found = richer(match, limit) if match.largest > limit else match
        if isinstance(found, str):
            reason = found
            break
        match = found
    if match.largest <= limit:
        return match, ()
    far = match.largest * request.extent
    return match, (f"the largest distance is {far:.3g} where {request.tolerance:.3g} was asked for: {reason}",)
