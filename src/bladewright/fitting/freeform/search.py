"""The search for a shape near points: its unknowns by Levenberg-Marquardt on true distances, from stiff to soft.

A shape is what curves, surfaces and profiles are here: a vector of unknowns, the nearest places of points on it, and
what the unknowns do to places at held parameters. A place that is free to move along the shape takes no part of a miss
along its tangents, so that the derivative of a distance is that of the place along the miss (tangent distance
minimisation: Wang, Pottmann and Liu 2006).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Generic, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.numerics.elementary import turned_left
from bladewright.numerics.least_squares import FIRST_DAMPING, ConstrainedProblem, constrained_minimum
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation, tukey_weights
from bladewright.nurbs.basis import Reals

STIFFNESSES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-13)
"""weights of the bending, in extents of the points squared, in turn"""
STIFFNESS_COST = 1.002
"""rise of the root mean square that a stiffness may cost: a hundredth of what noise of 100 points leaves open"""
EVALUATIONS, ROUGH_EVALUATIONS = 100, 20
"""evaluations of a last descent and of one on the way, at most; they bound the time."""
LAST_REDUCTION, ROUGH_REDUCTION = 1e-5, 1e-3
"""predicted relative reduction of the cost at which a last descent ends, and one on the way: a root mean square is then
within 0.005 % of what the next step would leave."""
GLOBAL_SEARCHES = 4
"""descents after which places are sought everywhere anew, at most; it bounds the time."""
NEARER = 1e-8
"""by how much, in extents, a place must be nearer than the one descended to: the root of rounding"""
OUTLYING_NOISE = 4.5
"""standard deviations of the noise from which a point is an outlier: one good point in 150,000 is dropped."""
FIRST_WIDTH, WIDTH_FACTOR = 0.3, 2.0
"""first width of Tukey's weights, of the extent, and factor by which it shrinks to what the noise needs: so slowly that
the ends of a shape are reached before their points could be taken for outliers."""
EXACT = 1e-10
"""distance, of the extent, that is rounding of the places"""
LARGEST_UNKNOWN = 30.0
"""magnitude of an unknown: control points stand within a few extents of the points, and a weight of e^30 is all that
counts near it. What begins further off may go twice as far."""
SHORTEST_COLUMN = 1e-4
"""length of a column of the Jacobian, of the longest, below which its unknown is scaled no further: its step is left to
the damping."""
DETERMINED = 1e-6
"""singular value, of the largest, above which the points determine its direction: the root of rounding"""


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
        """Derivatives (r, n) by the unknowns of places at held parameters (r, k), along directions (r, d)."""

    @abstractmethod
    def bending(self, stiffness: float) -> tuple[Reals, Reals]:
        """Residuals (b,) whose squares are the bending, times its weight, and their derivatives (b, n)."""


S = TypeVar("S", bound=Shape)


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """Points (m, d) of unit extent, how much each counts, and those whose places are held."""

    points: Reals
    weights: Reals
    """(m,)"""
    held: tuple[NDArray[np.intp], Reals] = (np.zeros(0, dtype=np.intp), np.zeros((0, 1)))
    """indices (j,) of points, and the parameters (j, k) of their places"""
    power: float = 2.0
    """power of a distance that is its cost"""
    scale: float = 1.0
    """distance that costs 1"""

    def part(self, rows: NDArray[np.bool_]) -> Target:
        """The points in some rows (m,)."""
        kept = rows[self.held[0]]
        held = (np.cumsum(rows)[self.held[0][kept]] - 1, self.held[1][kept])
        return replace(self, points=self.points[rows], weights=self.weights[rows], held=held)


@dataclass(frozen=True, kw_only=True)
class Options:
    """What is asked of a fit."""

    power: float = 2.0
    weights_free: bool = False
    robust: bool = False
    tolerance: float | None = None
    """largest distance, in the unit of the points"""
    extent: float = 1.0
    """of the points in their own unit, for messages"""
    report: Callable[[str], None] = lambda _: None
    """is handed a few words on what is done"""


@dataclass(frozen=True, kw_only=True, eq=False)
class ShapeMatch(Generic[S]):
    """A shape beside points."""

    shape: S
    target: Target
    parameters: Reals
    """(m, k) of the nearest places"""
    evaluations: int = 0
    damping: float = FIRST_DAMPING
    """the last one of the descent, for one that goes on from here"""
    converged: bool = False

    @cached_property
    def _touching(self) -> tuple[Reals, Reals, NDArray[np.bool_]]:
        return self.shape.tangents(self.parameters)

    @property
    def misses(self) -> Reals:
        """(m, d) from the points to their places."""
        return self._touching[0] - self.target.points

    @cached_property
    def distances(self) -> Reals:
        """Distances (m,) of the points."""
        return np.asarray(np.sqrt(np.sum(self.misses**2, axis=-1)))

    @property
    def rms(self) -> float:
        """Root mean square of the distances."""
        return float(np.sqrt(np.mean(self.distances**2)))

    @cached_property
    def _across(self) -> tuple[Reals, Reals]:
        """Misses (m, c) that count, and the unit vectors (m, c, d) along which they do.

        Where the tangents leave one normal that is the direction of the miss, on the side of the normal; else every
        axis, less what lies along the tangents.
        """
        _, tangents, free = self._touching
        dimension = self.misses.shape[1]
        if tangents.shape[1] == dimension - 1:
            normal = turned_left(tangents[:, 0]) if dimension == len("xy") else np.cross(tangents[:, 0], tangents[:, 1])
            side = np.where(np.sum(normal * self.misses, axis=-1) < 0.0, -1.0, 1.0)
            found = np.where((self.distances > EXACT)[:, None], side[:, None] * self.misses, normal)
            size = np.maximum(np.sqrt(np.sum(found**2, axis=-1)), 1e-300)
            return (side * self.distances)[:, None], (found / size[:, None])[:, None]
        moving = np.where(free[..., None], tangents, 0.0)
        along = np.swapaxes(moving, 1, 2) @ np.linalg.pinv(np.swapaxes(moving, 1, 2))
        return self.misses, np.eye(dimension) - along

    @cached_property
    def _rows(self) -> tuple[NDArray[np.intp], Reals, Reals]:
        """For each residual (r,) its point, its miss, and the direction (r, d) along which that counts.

        Held places do not give way, so that they count along every axis.
        """
        misses, directions = self._across
        held, dimension = self.target.held[0], self.misses.shape[1]
        rest = np.setdiff1d(np.arange(len(misses)), held)
        return (
            np.concatenate([np.repeat(rest, misses.shape[1]), np.repeat(held, dimension)]),
            np.concatenate([misses[rest].ravel(), self.misses[held].ravel()]),
            np.concatenate([directions[rest].reshape(-1, dimension), np.tile(np.eye(dimension), (len(held), 1))]),
        )

    @property
    def residuals(self) -> Reals:
        """(r,) whose squares sum to the cost of the distances."""
        rows, misses, _ = self._rows
        return self._factors[rows] * misses

    @property
    def jacobian(self) -> Reals:
        """(r, n) derivatives of the residuals by the unknowns."""
        rows, _, directions = self._rows
        unit = self.misses / np.maximum(self.distances, EXACT)[:, None]
        stretch = (0.5 * self.target.power - 1.0) * np.sum(unit[rows] * directions, axis=-1)
        directions = directions + stretch[:, None] * unit[rows]
        return self.shape.slopes(self.parameters[rows], self._factors[rows, None] * directions)

    @property
    def _factors(self) -> Reals:
        return np.sqrt(self.target.weights) * (self.distances / self.target.scale) ** (0.5 * self.target.power - 1.0)

    @cached_property
    def singular_values(self) -> Reals:
        """Of the distances by the unknowns, each scaled to length one; largest first."""
        slopes = np.asarray(np.linalg.qr(replace(self, target=replace(self.target, power=2.0)).jacobian, mode="r"))
        size = np.sqrt(np.sum(slopes**2, axis=0))
        return np.asarray(np.linalg.svd(slopes / np.where(size > 0.0, size, 1.0), compute_uv=False))

    @property
    def rank(self) -> int:
        """Directions of the unknowns that the points determine."""
        return int(np.sum(self.singular_values > DETERMINED * self.singular_values.max(initial=0.0)))

    @property
    def determined(self) -> bool:
        """Whether the points determine all unknowns."""
        return self.rank == len(self.shape.unknowns)

    @cached_property
    def noise(self) -> float:
        """Standard deviation across the shape, by what planes through neighbours leave (Gasser et al. 1986)."""
        directions = self._touching[1].shape[1]
        count = 2 * directions
        if len(self.parameters) <= count:
            return 0.0
        near = cKDTree(self.parameters).query(self.parameters, k=count + 1)[1][:, 1:]
        offset = self.parameters[near] - self.parameters[:, None]
        shares = np.linalg.pinv(np.concatenate([np.ones_like(offset[..., :1]), offset], axis=-1))[:, 0]
        misses = self._across[0]
        left = misses - np.einsum("mp,mpc->mc", shares, misses[near])
        square = np.sum(left**2, axis=-1) / (1.0 + np.sum(shares**2, axis=-1))
        return float(np.sqrt(np.mean(square) / (self.misses.shape[1] - directions)))


class Problem(ConstrainedProblem, Generic[S]):
    """The residuals of a shape's distances and bending; it keeps the places of the unknowns that were accepted.

    Unknowns are scaled by the columns of the first Jacobian (More 1978).
    """

    def __init__(self, match: ShapeMatch[S], stiffness: float) -> None:
        self.accepted = self.tried = match
        self.stiffness = stiffness * float(match.target.weights.sum())
        self.evaluations = 0
        lengths = np.sqrt(np.sum(match.jacobian**2, axis=0))
        self.sizes = 1.0 / np.maximum(lengths, SHORTEST_COLUMN * lengths.max())
        self.z = self.start = match.shape.unknowns / self.sizes

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        every = np.maximum(LARGEST_UNKNOWN / self.sizes, 2.0 * np.abs(self.start))
        return -every, every

    def at(self, z: Reals) -> ShapeMatch[S]:
        """The shape at scaled unknowns (n,), with its nearest places."""
        if not np.array_equal(z, self.z):
            shape = self.accepted.shape.changed(z * self.sizes)
            self.z, self.tried = z.copy(), placed(shape, self.accepted.target, self.accepted.parameters)
        return self.tried

    def values(self, z: Reals) -> tuple[Reals, Reals]:
        self.evaluations += 1
        found = self.at(z)
        return np.concatenate([found.residuals, found.shape.bending(self.stiffness)[0]]), np.zeros(0)

    def derivatives(self, z: Reals) -> tuple[Reals, Reals]:
        self.accepted = self.at(z)
        slopes = np.concatenate([self.accepted.jacobian, self.accepted.shape.bending(self.stiffness)[1]])
        return slopes * self.sizes, np.zeros((0, len(z)))


def placed(shape: S, target: Target, near: Reals | None = None) -> ShapeMatch[S]:
    """A shape beside points, with their nearest places: of all, or where descents from `near` (m, k) end."""
    parameters = shape.nearest(target.points, near)
    parameters[target.held[0]] = target.held[1]
    return ShapeMatch(shape=shape, target=target, parameters=parameters)


def matched(
    match: ShapeMatch[S],
    *,
    stiffness: float = 0.0,
    evaluations: int = EVALUATIONS,
    reduction: float = LAST_REDUCTION,
) -> ShapeMatch[S]:
    """The shape at which the cost of the distances, and `stiffness` times its bending, are least.

    Places follow the shape by descent while it moves. After that they are sought everywhere, and the whole is repeated
    where a nearer one is found.
    """
    if len(match.shape.unknowns) == 0:
        return replace(match, converged=True)
    total = match.evaluations
    for _ in range(GLOBAL_SEARCHES):
        problem = Problem(match, stiffness)
        found = constrained_minimum(
            problem,
            problem.start,
            steps=evaluations,
            damping=match.damping,
            min_reduction=reduction,
            accelerated=False,
        )
        total += problem.evaluations
        match = problem.at(found.z)
        everywhere = placed(match.shape, match.target)
        nearer = everywhere.distances < match.distances - NEARER
        parameters = np.where(nearer[:, None], everywhere.parameters, match.parameters)
        match = replace(match, parameters=parameters, evaluations=total, damping=found.damping)
        match = replace(match, converged=found.converged)
        if not nearer.any():
            break
    return match


def matched_by_stages(
    shape: S, target: Target, options: Options, *, warm: bool = False, near: Reals | None = None
) -> tuple[ShapeMatch[S], NDArray[np.bool_]]:
    """The match of a shape to points, and the inliers (m,); of a `warm` one, near already, the last stage alone.

    Places are sought everywhere first, or by descent from `near` (m, k).
    """
    match, inliers = placed(shape, target, near), np.ones(len(target.points), dtype=bool)
    if options.robust:
        match, inliers = _without_outliers(match, options, warm=warm)
    match = _matched_by_stiffnesses(match, options, warm=warm)
    if options.weights_free:
        options.report("free weights")
        match = _matched_by_stiffnesses(replace(match, shape=match.shape.freed), options, warm=True)
    if options.power != 2.0:
        options.report(f"power {options.power:g}")
        costly = replace(match.target, power=options.power, scale=max(float(match.distances.max()), EXACT))
        match = matched(replace(match, target=costly), stiffness=0.0 if match.determined else STIFFNESSES[-1])
    return match, inliers


def _matched_by_stiffnesses(match: ShapeMatch[S], options: Options, *, warm: bool) -> ShapeMatch[S]:
    """The match with the largest stiffness that costs nothing to speak of."""
    tried: list[tuple[float, ShapeMatch[S]]] = []
    for stiffness in () if warm else STIFFNESSES:
        options.report(f"{len(match.shape.unknowns)} unknowns, stiffness {stiffness:g}")
        match = matched(match, stiffness=stiffness, evaluations=ROUGH_EVALUATIONS, reduction=ROUGH_REDUCTION)
        tried.append((stiffness, match))
    softest = matched(match, stiffness=0.0 if match.determined else STIFFNESSES[-1])
    enough = STIFFNESS_COST * max(softest.rms, EXACT)
    for stiffness, each in tried:
        if each.rms <= enough:
            return matched(replace(each, evaluations=softest.evaluations), stiffness=stiffness)
    return softest


def _without_outliers(match: ShapeMatch[S], options: Options, *, warm: bool) -> tuple[ShapeMatch[S], NDArray[np.bool_]]:
    """The match of the points that are no further away than noise explains, and which these are."""
    target, width = match.target, FIRST_WIDTH
    stiffnesses = list(STIFFNESSES[2:3] if warm else STIFFNESSES[:3])
    while True:
        least = max(TUKEY_WIDTH * median_deviation(match.distances), EXACT)
        width = max(width, least)
        options.report(f"without outliers, width {width:.2g}")
        weighed = replace(target, weights=target.weights * tukey_weights(match.distances, width))
        match = matched(
            replace(match, target=weighed),
            stiffness=stiffnesses[0],
            evaluations=ROUGH_EVALUATIONS,
            reduction=ROUGH_REDUCTION,
        )
        if width <= least and len(stiffnesses) == 1:
            break
        width, stiffnesses = width / WIDTH_FACTOR, stiffnesses[1:] or stiffnesses
    inliers = match.distances <= max(OUTLYING_NOISE * median_deviation(match.distances), EXACT)
    return replace(match, target=target.part(inliers), parameters=match.parameters[inliers]), inliers
