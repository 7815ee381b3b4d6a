"""A NURBS curve or surface as a function of its unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import null_space
from scipy.sparse import csr_array

from bladewright.errors import FitError
from bladewright.fitting.freeform.search import Shape
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, basis, breaks
from bladewright.nurbs.blossom import knot_change
from bladewright.nurbs.closest import Descents, Places
from bladewright.nurbs.collocation import collocation
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.refine import Direction, inserted
from bladewright.nurbs.surface import Surface

TENSION = 0.01
"""weight of squared first derivatives, of that of squared second ones: it holds stretches that leave the points."""
WEIGHT_REGULARISATION = 1e-10
"""cost of a unit of a weight's logarithm, in extents of the points: it holds weights without effect."""
LAST_STEP = 1e-10
"""last step of a descent, in the parameters of a patch: distances of exact points are exact to it."""
DIRECTIONS: tuple[Direction, Direction] = ("u", "v")
"""names of the directions of a surface"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Net(Shape):
    """Control points and weights of a curve or surface, some of them unknown."""

    knots: tuple[Reals, ...]
    """clamped, one for each direction; of a closed curve the distinct knots of a period"""
    degrees: tuple[int, ...]
    points: Reals
    """(N, d) control points, the last direction fastest; of a closed curve each once"""
    log_weights: Reals | None = None
    """(N,) logarithms of the weights, or None where all are one"""
    weighted: bool = False
    """whether the weights are unknown"""
    held: Literal["none", "corners", "boundary"] = "none"
    """control points that do not move"""
    closed: bool = False

    @property
    def counts(self) -> tuple[int, ...]:
        """Numbers of control points along each direction."""
        if self.closed:
            return (len(self.points),)
        return tuple(len(knots) - degree - 1 for knots, degree in zip(self.knots, self.degrees, strict=True))

    @cached_property
    def clamped(self) -> tuple[Reals, ...]:
        """The clamped knots of the shape."""
        if not self.closed:
            return self.knots
        period, degree = self.knots[0], self.degrees[0]
        return (np.concatenate([np.full(degree, period[0]), period, np.full(degree, period[-1])]),)

    @cached_property
    def spread(self) -> Reals:
        """(m, N) matrix from the control points to those of the clamped shape, which a closed curve has more of."""
        if not self.closed:
            return np.eye(len(self.points))
        period, degree, count = self.knots[0], self.degrees[0], len(self.points)
        whole = period[-1] - period[0]
        around = np.concatenate([period[:-1] + turn * whole for turn in range(-degree - 1, degree + 2)])
        first = int(np.searchsorted(around, period[0])) - degree
        knots = around[first : first + count + 2 * degree + 1]
        return np.asarray(
            knot_change(knots, degree, self.clamped[0]) @ np.eye(count)[np.arange(count + degree) % count]
        )

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """(N,) which control points move."""
        if self.held == "none" or self.closed:
            return np.ones(len(self.points), dtype=bool)
        ends = np.meshgrid(*[np.isin(np.arange(count), (0, count - 1)) for count in self.counts], indexing="ij")
        return ~(np.logical_and if self.held == "corners" else np.logical_or).reduce(ends).ravel()

    @cached_property
    def gauge(self) -> Reals:
        """(N, k) orthonormal changes of the logarithms that change the shape.

        A common factor of all weights does not. Along a direction without inner knots, neither does a geometric
        progression: the weights w_i c^i are a projective change of its parameter (Piegl and Tiller 1997, section 6.2).
        """
        if not self.weighted:
            return np.zeros((len(self.points), 0))
        index = np.meshgrid(*[np.arange(count, dtype=float) for count in self.counts], indexing="ij")
        alike = [np.ones(len(self.points))]
        for along, knots in zip(index, self.knots, strict=True):
            if len(breaks(knots)) == 2 and not self.closed:
                alike.append(along.ravel())
        return np.asarray(null_space(np.array(alike)))

    @cached_property
    def bending_root(self) -> Reals:
        """(b, N) matrix whose product with the control points has the bending as its sum of squares.

        The bending is the integral of all squared second derivatives by the parameters (the thin-plate energy: Duchon
        1977), and some of the first: without it, a stretch that leaves the points would cost nothing.
        """
        mass, slope, bend = zip(
            *(_products(knots, degree) for knots, degree in zip(self.clamped, self.degrees, strict=True)), strict=True
        )
        if len(mass) == 1:
            energy = bend[0] + TENSION * slope[0]
        else:
            energy = np.kron(bend[0], mass[1]) + 2.0 * np.kron(slope[0], slope[1]) + np.kron(mass[0], bend[1])
            energy += TENSION * (np.kron(slope[0], mass[1]) + np.kron(mass[0], slope[1]))
        values, vectors = np.linalg.eigh(self.spread.T @ energy @ self.spread)
        return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T)

    @property
    def unknowns(self) -> Reals:
        """Control points that move, then what changes the shape of the logarithms of the weights."""
        logs = np.zeros(len(self.points)) if self.log_weights is None else self.log_weights
        return np.concatenate([self.points[self.free].ravel(), self.gauge.T @ logs])

    @property
    def freed(self) -> Net:
        """The net with unknown weights."""
        logs = np.zeros(len(self.points)) if self.log_weights is None else self.log_weights
        return replace(self, weighted=True, log_weights=logs)

    def changed(self, unknowns: Reals) -> Net:
        """The net with other values of its unknowns."""
        points, logs = self.points.copy(), self.log_weights
        moved = int(self.free.sum()) * points.shape[1]
        points[self.free] = unknowns[:moved].reshape(-1, points.shape[1])
        if logs is not None and self.weighted:
            logs = logs + self.gauge @ (unknowns[moved:] - self.gauge.T @ logs)
        return replace(self, points=points, log_weights=logs)

    @cached_property
    def shape(self) -> Curve | Surface:
        """The curve or surface."""
        points, weights = self.spread @ self.points, None
        if self.log_weights is not None:
            own = np.exp(self.log_weights)
            weights = self.spread @ own
            points = (self.spread @ (own[:, None] * self.points)) / weights[:, None]
        if len(self.knots) == 1:
            return Curve(control_points=points, knots=self.clamped[0], degree=self.degrees[0], weights=weights)
        return Surface(
            control_points=points.reshape(*self.counts, -1),
            weights=None if weights is None else weights.reshape(self.counts),
            knots_u=self.knots[0],
            knots_v=self.knots[1],
            degree_u=self.degrees[0],
            degree_v=self.degrees[1],
        )

    @property
    def domain(self) -> Reals:
        """(2, k) lowest and highest parameters."""
        return np.array([[knots[0] for knots in self.clamped], [knots[-1] for knots in self.clamped]])

    def nearest(self, points: Reals, near: Reals | None = None) -> Reals:
        """Parameters (m, k) of the nearest places of points (m, d); a closed curve has no ends to be held at."""
        search = Descents((self.shape,))

        def places(rows: Reals) -> Places:
            return Places(shape=np.zeros(len(rows), dtype=np.intp), u=rows[:, 0], v=rows[:, -1])

        found = search.nearest(points, None if near is None else places(near), converged=LAST_STEP)
        parameters = np.stack([found.u, found.v], axis=-1)[:, : len(self.knots)]
        if self.closed:
            low, high = self.domain
            seam = np.flatnonzero((found.u <= low) | (found.u >= high))
            past = search.nearest(points[seam], places(low + high - parameters[seam]), converged=LAST_STEP)
            parameters[seam, 0] = np.where(past.square < found.square[seam], past.u, found.u[seam])
        return parameters

    def tangents(self, parameters: Reals) -> tuple[Reals, Reals, NDArray[np.bool_]]:
        """Places (m, d), tangents (m, k, d), and along which of them (m, k) a place is free to move."""
        low, high = self.domain
        free = (parameters > low) & (parameters < high) | self.closed
        if isinstance(self.shape, Curve):
            places, tangent = self.shape.derivatives(parameters[:, 0], 1)
            return places, tangent[:, None], free
        of = self.shape.derivatives(parameters[:, 0], parameters[:, 1], 1)
        return of[0, 0], np.stack([of[1, 0], of[0, 1]], axis=1), free

    def basis(self, parameters: Reals) -> csr_array:
        """(m, N) matrix whose product with the control points are the places at parameters (m, k)."""
        matrix = collocation(self.shape, *parameters.T)
        if self.closed:
            matrix = csr_array(matrix @ csr_array(self.spread))
        if self.log_weights is None:
            return matrix
        scaled = csr_array(matrix * np.exp(self.log_weights)[None, :])
        return csr_array(scaled * (1.0 / scaled.sum(axis=1))[:, None])

    def slopes(self, parameters: Reals, directions: Reals) -> Reals:
        """Derivatives (r, n) by the unknowns of places at held parameters (r, k), along directions (r, d)."""
        matrix = self.basis(parameters).toarray()
        moved = (matrix[:, self.free, None] * directions[:, None]).reshape(len(matrix), -1)
        if not self.weighted:
            return moved
        # dC / d log w_i = R_i (P_i - C)
        away = directions @ self.points.T - np.sum(directions * (matrix @ self.points), axis=-1, keepdims=True)
        return np.concatenate([moved, (matrix * away) @ self.gauge], axis=1)

    def bending(self, stiffness: float) -> tuple[Reals, Reals]:
        """Residuals (b,) whose squares are the bending, times its weight, and their derivatives (b, n)."""
        root = np.sqrt(stiffness) * self.bending_root if stiffness else np.zeros((0, len(self.points)))
        logs, dimension = self.unknowns[int(self.free.sum()) * self.points.shape[1] :], self.points.shape[1]
        slopes = np.zeros((len(root) * dimension + len(logs), int(self.free.sum()) * dimension + len(logs)))
        slopes[: len(root) * dimension, : slopes.shape[1] - len(logs)] = np.kron(root[:, self.free], np.eye(dimension))
        slopes[len(root) * dimension :, slopes.shape[1] - len(logs) :] = WEIGHT_REGULARISATION * np.eye(len(logs))
        return np.concatenate([(root @ self.points).ravel(), WEIGHT_REGULARISATION * logs]), slopes

    def through(self, points: Reals, shares: Reals, stiffness: float) -> Net:
        """The net nearest to points (m, d) at shares (m, k) of the domain, with a weight of its bending."""
        low, high = self.domain
        matrix = self.basis(low + (high - low) * shares)
        normal = (matrix.T @ matrix).toarray() / len(points) + stiffness * self.bending_root.T @ self.bending_root
        # a trace of the identity holds control points that neither points nor bending determine
        normal += 1e-14 * np.eye(len(normal))
        return replace(self, points=np.linalg.solve(normal, np.asarray(matrix.T @ points) / len(points)))

    def refined(self, knots: Sequence[float], direction: int = 0) -> Net:
        """The same shape with further knots."""
        every = list(self.knots)
        every[direction] = np.sort(np.concatenate([every[direction], knots]))
        along = DIRECTIONS[direction]
        shape = inserted(self.shape, knots) if isinstance(self.shape, Curve) else inserted(self.shape, knots, along)
        finer = net_of(shape, closed=self.closed, knots=tuple(every))
        return replace(finer, held=self.held, weighted=self.weighted)


def net_of(shape: Curve | Surface, *, closed: bool = False, knots: tuple[Reals, ...] = ()) -> Net:
    """A curve or surface as a net; of a closed curve the nearest on its distinct knots."""
    homogeneous = shape.homogeneous.reshape(-1, shape.homogeneous.shape[-1])
    dimension, weighted = shape.control_points.shape[-1], shape.weights is not None
    degrees: tuple[int, ...]
    own: tuple[Reals, ...]
    if isinstance(shape, Curve):
        degrees, own = (shape.degree,), (breaks(shape.knots) if closed else shape.knots,)
    else:
        degrees, own = (shape.degree_u, shape.degree_v), (shape.knots_u, shape.knots_v)
    if closed:
        empty = Net(knots=knots or own, degrees=degrees, points=np.zeros((len(own[0]) - 1, dimension)), closed=True)
        homogeneous = np.linalg.lstsq(empty.spread, homogeneous, rcond=None)[0]
    points = homogeneous[:, :dimension] / (homogeneous[:, dimension:] if weighted else 1.0)
    logs = np.log(homogeneous[:, dimension]) if weighted else None
    return Net(knots=knots or own, degrees=degrees, points=points, log_weights=logs, closed=closed)


def log_weights(weights: str | ArrayLike, counts: tuple[int, ...]) -> Reals | None:
    """Logarithms of given weights of a shape (n,) or (n_u, n_v), flattened; None for a word."""
    if isinstance(weights, str):
        return None
    given = np.array(weights, dtype=np.float64)
    if given.shape != counts or not (given > 0.0).all():
        raise FitError(f"weights of shape {given.shape} were given: positive ones of shape {counts} are needed")
    return np.log(given).ravel()


def _products(knots: Reals, degree: int) -> tuple[Reals, Reals, Reals]:
    """Integrals (n, n) of products of the basis functions, of their first and of their second derivatives."""
    at, weight = panels(breaks(knots), degree + 1)
    found = []
    for order in range(3):
        values = basis(knots, degree, at, order) if order <= degree else np.zeros((len(at), len(knots) - degree - 1))
        found.append(np.asarray(values.T @ (weight[:, None] * values)))
    return found[0], found[1], found[2]
