"""A NURBS curve or surface as a vector of unknowns, and its match to points."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.sparse import csr_array, hstack

from bladewright.fitting.freeform.least_squares import Minimum, Penalty, Quadratic, minimised, quadratic_of_distances
from bladewright.fitting.freeform.projection import Projections, certified_parameters, projected
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, basis, breaks
from bladewright.nurbs.blossom import knot_change
from bladewright.nurbs.collocation import collocation
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.refine import Direction, inserted
from bladewright.nurbs.surface import Surface

LARGEST_LOG_WEIGHT = 30.0
"""magnitude of a weight's logarithm beyond which it changes nothing more."""
TENSION = 0.01
"""weight of squared first derivatives, of that of squared second ones: it holds stretches that leave the points."""
WEIGHT_REGULARISATION = 1e-10
"""cost of a unit of a weight's logarithm, in extents of the points: it holds weights without effect."""
DIRECTIONS: tuple[Direction, Direction] = ("u", "v")
"""names of the directions of a surface"""
AT_ONCE = 100_000
"""points whose rows are built at a time; it bounds the memory."""
GLOBAL_SEARCHES = 8
"""searches for places that are nearer than the ones descended to, at most"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Net:
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
    def spread(self) -> Reals | None:
        """(m, N) matrix from the control points of a closed curve to those of the clamped one; None for open shapes."""
        if not self.closed:
            return None
        period, degree, count = self.knots[0], self.degrees[0], len(self.points)
        whole = period[-1] - period[0]
        around = np.concatenate([period[:-1] + turn * whole for turn in range(-degree - 1, degree + 2)])
        first = int(np.searchsorted(around, period[0])) - degree
        knots = around[first : first + count + 2 * degree + 1]
        wrapped = np.eye(count)[np.arange(count + degree) % count]
        return np.asarray(knot_change(knots, degree, self.clamped[0]) @ wrapped)

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """(N,) which control points move."""
        ends = [np.isin(np.arange(count), (0, count - 1)) for count in self.counts]
        if self.held == "none" or self.closed:
            return np.ones(len(self.points), dtype=bool)
        grids = np.meshgrid(*ends, indexing="ij")
        return ~np.logical_and.reduce(grids).ravel() if self.held == "corners" else ~np.logical_or.reduce(grids).ravel()

    @cached_property
    def gauge(self) -> Reals:
        """(N, k) orthonormal changes of the logarithms that change the shape.

        A common factor of all weights does not. Along a direction without inner knots, neither does a geometric
        progression: the weights w_i c^i are a projective change of its parameter (Piegl and Tiller 1997, section 6.2).
        """
        if not self.weighted:
            return np.zeros((len(self.points), 0))
        index = np.meshgrid(*[np.arange(count, dtype=float) for count in self.counts], indexing="ij")
        null_rows = [np.ones(len(self.points))]
        for along, knots in zip(index, self.knots, strict=True):
            if len(breaks(knots)) == 2 and not self.closed:
                null_rows.append(along.ravel())
        return np.asarray(null_space(np.array(null_rows)))

    @cached_property
    def bending(self) -> Reals:
        """(N, N) matrix of the integral of all squared second derivatives by the parameters, and some of the first.

        The second are the bending; without the first, a stretch that leaves the points would cost nothing.
        """
        parts = [_products(knots, degree) for knots, degree in zip(self.clamped, self.degrees, strict=True)]
        if len(parts) == 1:
            found = TENSION * parts[0][1] + parts[0][2]
            return found if self.spread is None else np.asarray(self.spread.T @ found @ self.spread)
        (mass_u, slope_u, bend_u), (mass_v, slope_v, bend_v) = parts
        bending = np.kron(bend_u, mass_v) + 2.0 * np.kron(slope_u, slope_v) + np.kron(mass_u, bend_v)
        return np.asarray(bending + TENSION * (np.kron(slope_u, mass_v) + np.kron(mass_u, slope_v)))

    @property
    def unknowns(self) -> Reals:
        """Values of the unknowns: control points that move, then changes of the logarithms of the weights."""
        return np.concatenate([self.points[self.free].ravel(), np.zeros(self.gauge.shape[1])])

    @property
    def shape(self) -> Curve | Surface:
        """The curve or surface."""
        points, weights = self.points, None if self.log_weights is None else np.exp(self.log_weights)
        if self.spread is not None:
            if weights is None:
                points = self.spread @ points
            else:
                total = self.spread @ weights
                points, weights = (self.spread @ (weights[:, None] * points)) / total[:, None], total
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
    def curve(self) -> Curve:
        """The shape of one direction."""
        shape = self.shape
        assert isinstance(shape, Curve)  # noqa: S101 - one direction
        return shape

    @property
    def surface(self) -> Surface:
        """The shape of two directions."""
        shape = self.shape
        assert isinstance(shape, Surface)  # noqa: S101 - two directions
        return shape

    def changed(self, unknowns: Reals) -> "Net":
        """The net with other values of its unknowns."""
        points = self.points.copy()
        moved = int(self.free.sum()) * points.shape[1]
        points[self.free] = unknowns[:moved].reshape(-1, points.shape[1])
        log_weights = self.log_weights
        if self.weighted:
            log_weights = (0.0 if log_weights is None else log_weights) + self.gauge @ unknowns[moved:]
            log_weights = np.clip(log_weights, -LARGEST_LOG_WEIGHT, LARGEST_LOG_WEIGHT)
        return replace(self, points=points, log_weights=log_weights)

    def through(self, points: Reals, parameters: Reals, stiffness: float) -> "Net":
        """The net nearest to points (m, d) at parameters (m, k), with a weight of its bending."""
        matrix = self.basis(parameters)
        normal = (matrix.T @ matrix).toarray() / len(points)
        # a trace of the identity holds control points that neither points nor bending determine
        normal += stiffness * self.bending + 1e-14 * np.eye(len(normal))
        return replace(self, points=np.linalg.solve(normal, np.asarray(matrix.T @ points) / len(points)))

    def refined(self, knots: Sequence[float], direction: int = 0) -> "Net":
        """The same shape with further knots."""
        every = list(self.knots)
        every[direction] = np.sort(np.concatenate([every[direction], knots]))
        finer = replace(self, knots=tuple(every))
        if self.closed:
            return replace(periodic(finer, inserted(self.curve, knots)), weighted=self.weighted)
        shape = inserted(self.curve, knots) if len(every) == 1 else inserted(self.surface, knots, DIRECTIONS[direction])
        log_weights = None if shape.weights is None else np.log(shape.weights).ravel()
        return replace(finer, points=shape.control_points.reshape(-1, self.points.shape[1]), log_weights=log_weights)

    def basis(self, parameters: Reals) -> csr_array:
        """(m, N) matrix whose product with the control points are the places at parameters (m, k)."""
        matrix = collocation(self.shape, *parameters.T)
        if self.spread is not None:
            matrix = csr_array(matrix @ csr_array(self.spread))
        if self.log_weights is None:
            return matrix
        scaled = csr_array(matrix * np.exp(self.log_weights)[None, :])
        return csr_array(scaled * (1.0 / scaled.sum(axis=1))[:, None])

    def rows(self, matrix: csr_array, places: Reals, directions: Reals) -> csr_array:
        """(m, n) derivatives by the unknowns of places (m, d) along directions (m, d); `matrix` is their basis."""
        dimension = directions.shape[1]
        of = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        values = (matrix.data[:, None] * directions[of]).ravel()
        columns = (matrix.indices[:, None] * dimension + np.arange(dimension)).ravel()
        found = csr_array(
            (values, columns, matrix.indptr * dimension), shape=(matrix.shape[0], matrix.shape[1] * dimension)
        )
        if not self.free.all():
            found = csr_array(found[:, np.repeat(self.free, dimension)])
        if not self.weighted:
            return found
        # dC / d log w_i = R_i (P_i - C)
        away = np.einsum("kd,kd->k", directions[of], self.points[matrix.indices] - places[of])
        by_log = csr_array((matrix.data * away, matrix.indices, matrix.indptr), shape=matrix.shape)
        return csr_array(hstack([found, csr_array(by_log @ self.gauge)], format="csr"))


def periodic(net: Net, curve: Curve) -> Net:
    """The closed net nearest to a curve that closes, on the distinct knots of `net`."""
    dimension, knots = curve.control_points.shape[1], breaks(net.knots[0])
    empty = Net(knots=(knots,), degrees=net.degrees, points=np.zeros((len(knots) - 1, dimension)), closed=True)
    once: Reals = np.linalg.lstsq(np.asarray(empty.spread), curve.homogeneous, rcond=None)[0]
    if curve.weights is None:
        return replace(empty, points=once)
    return replace(empty, points=once[:, :dimension] / once[:, dimension:], log_weights=np.log(once[:, dimension]))


@dataclass(frozen=True, kw_only=True, eq=False)
class NetMatch:
    """A net matched to points."""

    net: Net
    footpoints: Projections
    data: Quadratic
    """objective of the distances alone, without bending"""
    evaluations: int
    converged: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class NetTarget:
    """Points (m, d) of unit extent, how much each counts (m,), and those whose parameters are held."""

    points: Reals
    weights: Reals
    held: tuple[NDArray[np.intp], Reals] | None = None


def matched_net(
    net: Net,
    target: NetTarget,
    *,
    penalty: Penalty,
    stiffness: float = 0.0,
    near: Reals | None = None,
    evaluations: int = 80,
    tolerance: float = 1e-8,
    certain: bool = False,
) -> NetMatch:
    """The net at which the penalties of true distances, and `stiffness` times its bending, are least.

    Places follow the shape by descent while it moves; after that they are searched for from samples everywhere, on a
    curve with `certain` by bounds as well (on a surface that takes milliseconds a point), and the whole is repeated
    where a nearer one is found.
    """
    places = projected(net.shape, target.points, closed=net.closed).parameters if near is None else near
    total, converged = 0, False
    for _ in range(GLOBAL_SEARCHES):
        search = NetObjective(net=net, target=target, penalty=penalty, stiffness=stiffness, near=places)
        found: Minimum = minimised(
            search.objective, net.unknowns, accepted=search.accept, evaluations=evaluations, tolerance=tolerance
        )
        total += found.evaluations
        net, converged = net.changed(found.x), found.converged
        footpoints = search.footpoints(net, search.near)
        everywhere = projected(net.shape, target.points, None, closed=net.closed, held=target.held)
        nearer = everywhere.distances < footpoints.distances - 1e-8
        places = np.where(nearer[:, None], everywhere.parameters, footpoints.parameters)
        if certain and not nearer.any() and len(net.knots) == 1:
            places = certified_parameters(net.curve, target.points, footpoints)
        if np.array_equal(places, footpoints.parameters):
            break
    footpoints = search.footpoints(net, footpoints.parameters)
    return NetMatch(
        net=net,
        footpoints=footpoints,
        data=quadratic_of(net, target, footpoints, penalty),
        evaluations=total,
        converged=converged,
    )


def quadratic_of(net: Net, target: NetTarget, footpoints: Projections, penalty: Penalty) -> Quadratic:
    """The objective of distances alone near the present unknowns."""
    total: Quadratic | None = None
    for first in range(0, len(footpoints.points), AT_ONCE):
        rows = slice(first, first + AT_ONCE)
        in_block = np.flatnonzero((footpoints.across_of >= first) & (footpoints.across_of < first + AT_ONCE))
        across_of = footpoints.across_of[in_block] - first
        matrix = net.basis(footpoints.parameters[rows])
        places = footpoints.points[rows]
        part = quadratic_of_distances(
            net.rows(matrix, places, footpoints.along[rows]),
            footpoints.distances[rows],
            net.rows(csr_array(matrix[across_of]), places[across_of], footpoints.across[in_block]),
            across_of,
            penalty,
            target.weights[rows],
        )
        total = part if total is None else total + part
    assert total is not None  # noqa: S101 - a target has points
    return total


class NetObjective:
    """The objective of one descent, which keeps the places of the current unknowns."""

    def __init__(self, *, net: Net, target: NetTarget, penalty: Penalty, stiffness: float, near: Reals) -> None:
        self.net, self.target, self.penalty, self.stiffness = net, target, penalty, stiffness
        self.near = self.tried = near

    def accept(self) -> None:
        self.near = self.tried

    def footpoints(self, net: Net, near: Reals) -> Projections:
        return projected(net.shape, self.target.points, near, closed=net.closed, held=self.target.held)

    def objective(self, unknowns: Reals) -> Quadratic:
        net = self.net.changed(unknowns)
        footpoints = self.footpoints(net, self.near)
        self.tried = footpoints.parameters
        return quadratic_of(net, self.target, footpoints, self.penalty) + self._of_net(net)

    def _of_net(self, net: Net) -> Quadratic:
        dimension, free = net.points.shape[1], net.free
        moved = int(free.sum()) * dimension
        size = moved + net.gauge.shape[1]
        value, gradient, curvature = 0.0, np.zeros(size), np.zeros((size, size))
        scale = float(self.target.weights.sum())
        if self.stiffness:
            pull = self.stiffness * scale * (net.bending @ net.points)
            value += float(np.sum(pull * net.points))
            gradient[:moved] = pull[free].ravel()
            block = self.stiffness * scale * net.bending[np.ix_(free, free)]
            curvature[:moved, :moved] = np.kron(block, np.eye(dimension))
        if net.weighted and net.log_weights is not None:
            own = net.gauge.T @ net.log_weights
            value += WEIGHT_REGULARISATION**2 * scale * float(own @ own)
            gradient[moved:] += WEIGHT_REGULARISATION**2 * scale * own
            curvature[moved:, moved:] += WEIGHT_REGULARISATION**2 * scale * np.eye(len(own))
        return Quadratic(value=value, gradient=gradient, curvature=curvature)


def _products(knots: Reals, degree: int) -> tuple[Reals, Reals, Reals]:
    """Integrals (n, n) of products of the basis functions, of their first and of their second derivatives."""
    at, weight = panels(breaks(knots), degree + 1)
    found = []
    for order in range(3):
        values = basis(knots, degree, at, order) if order <= degree else np.zeros((len(at), len(knots) - degree - 1))
        found.append(np.asarray(values.T @ (weight[:, None] * values)))
    return found[0], found[1], found[2]
