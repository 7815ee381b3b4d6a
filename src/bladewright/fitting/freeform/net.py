"""A NURBS curve or surface as a function of its unknowns, and its match with knots where they are needed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from bladewright.errors import FitError
from bladewright.fitting.checks import reals
from bladewright.fitting.freeform.fits import Request
from bladewright.fitting.freeform.search import (
    STIFFNESSES,
    Shape,
    ShapeMatch,
    matched_by_stages,
    matched_within,
    placed,
)
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, basis, breaks
from bladewright.nurbs.blossom import knot_change
from bladewright.nurbs.closest import Descents, Places
from bladewright.nurbs.collocation import collocation
from bladewright.nurbs.curve import Curve, checked_weights
from bladewright.nurbs.refine import Direction, direction_of, inserted
from bladewright.nurbs.surface import Surface

TENSION = 0.01
"""weight of squared first derivatives, of that of squared second ones (design/freeform.md)"""
LAST_STEP = 1e-10
"""last step of a descent, in the parameters of a patch: exact points are met to it (design/freeform.md)"""
DIRECTIONS: tuple[Direction, Direction] = ("u", "v")
"""of a surface; a curve has the first"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Net(Shape):
    """Control points and weights of a curve or surface, some of them unknown."""

    pattern: Curve | Surface
    """whose knots and degrees it has; the inner knots of a closed curve are distinct"""
    points: Reals
    """(N, d) control points, the last direction fastest; of a closed curve each once"""
    log_weights: Reals
    """(N,) logarithms of the weights"""
    weighted: bool = False
    """whether the weights are unknown"""
    boundary: Literal["free", "corners", "fixed"] = "free"
    """which of the outer control points do not move: none, the corners, or all"""
    closed: bool = False

    @property
    def axes(self) -> list[tuple[Reals, int]]:
        """Knots and degree along each direction."""
        return [direction_of(self.pattern, each) for each in DIRECTIONS[: self.pattern.control_points.ndim - 1]]

    @property
    def counts(self) -> tuple[int, ...]:
        """Numbers of control points along each direction."""
        if self.closed:
            return (len(self.points),)
        return self.pattern.control_points.shape[:-1]

    @cached_property
    def spread(self) -> Reals:
        """(m, N) matrix from the control points to those of the clamped shape, which a closed curve has more of."""
        if not self.closed:
            return np.eye(len(self.points))
        ((knots, degree),), (count,) = self.axes, self.counts
        period = breaks(knots)
        turn, place = np.divmod(np.arange(-degree, count + degree + 1), count)
        around = period[place] + turn * (period[-1] - period[0])
        return np.asarray(knot_change(around, degree, knots) @ np.eye(count)[np.arange(count + degree) % count])

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """(N,) which control points move."""
        if self.boundary == "free":
            return np.ones(len(self.points), dtype=bool)
        places = zip(np.indices(self.counts), self.counts, strict=True)
        outer = np.stack([np.isin(place, (0, count - 1)).ravel() for place, count in places])
        return np.asarray(~(np.all if self.boundary == "corners" else np.any)(outer, axis=0))

    @cached_property
    def gauge(self) -> Reals:
        """(N, k) orthonormal changes of the logarithms that change the shape; a common factor does not.

        Along a direction without inner knots, neither do w_i c^i (Piegl and Tiller 1997, section 6.2).
        """
        if not self.weighted:
            return np.zeros((len(self.points), 0))
        trends = [
            along.ravel()
            for along, (knots, _) in zip(np.indices(self.counts), self.axes, strict=True)
            if len(breaks(knots)) == 2 and not self.closed
        ]
        return np.asarray(null_space(np.array([np.ones(len(self.points)), *trends])))

    @cached_property
    def bending_root(self) -> Reals:
        """(b, N) matrix whose product with the control points has the bending as its sum of squares.

        Of squared second and some first derivatives: a thin plate under tension (Duchon 1977, Franke 1985).
        """
        of = [_products(knots, degree) for knots, degree in self.axes]
        energy, *across = (bend + TENSION * slope for _, slope, bend in of)
        for other in across:
            (mass_u, slope_u, _), (mass_v, slope_v, _) = of
            energy = np.kron(energy, mass_v) + 2.0 * np.kron(slope_u, slope_v) + np.kron(mass_u, other)
        values, vectors = np.linalg.eigh(self.spread.T @ energy @ self.spread)
        return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T)

    @property
    def unknowns(self) -> Reals:
        """Control points that move, then what changes the shape of the logarithms of the weights."""
        return np.concatenate([self.points[self.free].ravel(), self.gauge.T @ self.log_weights])

    @property
    def freed(self) -> Net:
        return replace(self, weighted=True)

    def changed(self, unknowns: Reals) -> Net:
        points, moved = self.points.astype(unknowns.dtype), self.points[self.free].size
        points[self.free] = unknowns[:moved].reshape(-1, points.shape[1])
        logs = self.log_weights + self.gauge @ (unknowns[moved:] - self.gauge.T @ self.log_weights)
        return replace(self, points=points, log_weights=logs)

    @cached_property
    def shape(self) -> Any:
        """The `Curve` or `Surface`."""
        own = np.exp(self.log_weights)
        weights = self.spread @ own
        points = (self.spread @ (own[:, None] * self.points)) / weights[:, None]
        shape = self.pattern.control_points.shape
        given = weights.reshape(shape[:-1]) if self.log_weights.any() else None
        return replace(self.pattern, control_points=points.reshape(shape), weights=given)

    @property
    def domain(self) -> Reals:
        """(2, k) lowest and highest parameters."""
        return np.array([knots[[0, -1]] for knots, _ in self.axes]).T

    def nearest(self, points: Reals, near: Reals | None = None) -> Reals:
        """Parameters (m, k) of the nearest places of points (m, d); a closed curve has no ends to be held at."""
        search = Descents((self.shape,))

        def places(rows: Reals) -> Places:
            return Places(shape=np.zeros(len(rows), dtype=np.intp), u=rows[:, 0], v=rows[:, -1])

        found = search.nearest(points, None if near is None else places(near), converged=LAST_STEP)
        parameters = np.stack([found.u, found.v], axis=-1)[:, : len(self.axes)]
        if self.closed:
            low, high = self.domain
            seam = np.flatnonzero((found.u <= low) | (found.u >= high))
            past = search.nearest(points[seam], places(low + high - parameters[seam]), converged=LAST_STEP)
            parameters[seam, 0] = np.where(past.square < found.square[seam], past.u, found.u[seam])
        return parameters

    def tangents(self, parameters: Reals) -> tuple[Reals, Reals, NDArray[np.bool_]]:
        low, high = self.domain
        free = (parameters > low) & (parameters < high) | self.closed
        if isinstance(self.shape, Curve):
            places, tangent = self.shape.derivatives(parameters[:, 0], 1)
            return places, tangent[:, None], free
        of = self.shape.derivatives(parameters[:, 0], parameters[:, 1], 1)
        return of[0, 0], np.stack([of[1, 0], of[0, 1]], axis=1), free

    def basis(self, parameters: Reals) -> Reals:
        """(m, N) matrix whose product with the control points are the places at parameters (m, k)."""
        matrix = collocation(self.shape, *parameters.T).toarray()
        if self.closed:
            matrix = matrix @ self.spread
        scaled = matrix * np.exp(self.log_weights)
        return np.asarray(scaled / scaled.sum(axis=1)[:, None])

    def slopes(self, parameters: Reals, directions: Reals) -> Reals:
        matrix = self.basis(parameters)
        moved = matrix[:, None, self.free, None] * directions[:, :, None]
        moved = moved.reshape(matrix.shape[0] * directions.shape[1], -1)
        if not self.weighted:
            return moved
        # dC / d log w_i = R_i (P_i - C)
        away = matrix[..., None] * (self.points - (matrix @ self.points)[:, None])
        turned = np.einsum("mrd,mnd->mrn", directions, away).reshape(len(moved), -1)
        return np.concatenate([moved, turned @ self.gauge], axis=1)

    @property
    def bending(self) -> tuple[Reals, Reals]:
        root = self.bending_root
        slopes = np.kron(root[:, self.free], np.eye(self.points.shape[1]))
        return (root @ self.points).ravel(), np.pad(slopes, ((0, 0), (0, self.gauge.shape[1])))

    def refined(self, knots: Sequence[float], direction: Direction) -> Net:
        """The same shape with further knots."""
        net = net_of(inserted(self.shape, knots, direction), closed=self.closed)
        return replace(net, boundary=self.boundary, weighted=self.weighted)


def net_of(shape: Curve | Surface, *, closed: bool = False) -> Net:
    """A curve or surface as a net; of a closed curve the nearest on its distinct knots."""
    points = shape.control_points.reshape(-1, shape.control_points.shape[-1])
    weights = np.ones(len(points)) if shape.weights is None else shape.weights.ravel()
    net = Net(pattern=shape, points=points, log_weights=np.log(weights), closed=closed)
    if closed:
        (knots, degree), given = net.axes[0], shape.weights is not None
        own = np.pad(breaks(knots), degree, "edge")
        pattern = Curve(control_points=np.zeros((len(own) - degree - 1, points.shape[1])), knots=own, degree=degree)
        net = replace(net, pattern=pattern, points=pattern.control_points[degree:])
        both = np.linalg.lstsq(net.spread, np.column_stack([weights[:, None] * points, weights]), rcond=None)[0]
        logs = np.log(both[:, -1]) if given else np.zeros(len(both))
        net = replace(net, points=both[:, :-1] / both[:, -1:], log_weights=logs)
    return net


def laid(net: Net, points: Reals, shares: Reals, weights: object) -> Net:
    """The net, a little stiff, nearest to points (m, d) at shares (m, k) of its domain; with weights, if any are given.

    Raises FitError and GeometryError where these are not one positive number for each control point.
    """
    if not isinstance(weights, str):
        given = reals("weights", weights, "give a positive one for each control point")
        net = replace(net, log_weights=np.log(np.real(checked_weights(given, net.counts))).ravel())
    low, high = net.domain
    root = np.sqrt(STIFFNESSES[1] * len(points)) * net.bending_root
    rows = np.concatenate([net.basis(low + (high - low) * shares), root])
    return replace(net, points=np.linalg.lstsq(rows, np.concatenate([points, 0.0 * net.points]), rcond=None)[0])


def _products(knots: Reals, degree: int) -> list[Reals]:
    """Integrals (n, n) of products of the basis functions, of their first and of their second derivatives."""
    at, weight = panels(breaks(knots), degree + 1)
    orders = [basis(knots, degree, at, order) for order in range(3)]
    return [np.asarray(values.T @ (weight[:, None] * values)) for values in orders]


def matched_net(net: Net, request: Request, *, warm: bool) -> tuple[ShapeMatch[Net], tuple[str, ...]]:
    """The match of a net, with knots until its largest distance is what is asked for, and a note where it is not."""
    points, dimensions = request.points, len(net.axes)
    unknowns = int(net.free.sum()) * (points.shape[1] if dimensions == 1 else 1)
    unknowns += len(net.points) - 1 if request.weights_free else 0
    rows = len(np.unique(points, axis=0)) * (points.shape[1] - dimensions)
    if unknowns > rows:
        raise FitError(
            f"{len(points)} points, which give {rows} distances, were to determine {unknowns} unknowns of "
            f"{' x '.join(map(str, net.counts))} control points: take fewer control points, fixed weights, or more "
            "points"
        )

    def richer(match: ShapeMatch[Net], limit: float) -> ShapeMatch[Net] | str:
        finer = _finer(match, limit)
        if isinstance(finer, str):
            return finer
        request.report(f"{len(finer.points)} control points")
        return matched_by_stages(replace(match, shape=finer, weights=np.ones(len(points))), request, warm=True)

    return matched_within(matched_by_stages(placed(net, points), request, warm=warm), request, richer)


def _finer(match: ShapeMatch[Net], limit: float) -> Net | str:
    """The net with a knot in each span too far off, along the direction where it gains more; or why there is none."""
    found = []
    for direction, (own, _), at in zip(DIRECTIONS, match.shape.axes, match.parameters.T, strict=False):
        spans = [(low, high, match.inliers & (at >= low) & (at <= high)) for low, high in pairwise(breaks(own))]
        knots = [
            0.5 * (low + high)
            for low, high, rows in spans
            if match.distances[rows].max(initial=0.0) > limit and not match.is_noise(rows)
        ]
        if knots:
            found.append(match.shape.refined(knots, direction))
    if not found:
        return "the rest is the noise of the points"
    few = [net for net in found if 2 * len(net.points) <= len(match.points)]

    def gain(finer: Net) -> float:
        trial = replace(match, shape=finer)
        step = np.linalg.lstsq(trial.jacobian, trial.residuals, rcond=1e-6)[0]
        return float(np.sum((trial.jacobian @ step) ** 2)) / (len(finer.points) - len(match.shape.points))

    return max(few, key=gain) if few else "the points are too few for further knots"
