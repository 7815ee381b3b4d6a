"""What a search sees of a design: its sides, their derivatives by the parameters, and what is refused.

A model refuses nothing that a step of a search may pass on its way, and holds the knots of the native surfaces. Sides
have their halves of the faces of blunt edges, which close the outline: a side and half a face are one curve, or
surface, with a corner, so that a point's nearest place may lie on either.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import singledispatch
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import comb

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.knots import DEGREE, Knots, clamped
from bladewright.derivatives.complex_step import STEP, step_tangents, steps_of
from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.free_parameters import EDGES
from bladewright.fitting.matching.footpoints import Footpoints, Side, footpoints_at
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, cross2
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.collocation import collocation
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.section.section import Section

FOLD_GRID = (41, 21)
"""places along and across a channel at which it is checked for folding: those of `build` (design/matching.md)"""
SMALLEST_JACOBIAN = 0.02
"""smallest Jacobian to which a channel may come, of its median (design/matching_constants.md)"""
FACE_SHARE = 0.02
"""share of a side's parameter that half a face takes, which changes no shape (design/matching_constants.md)"""
BluntEdges = tuple[bool, bool]
"""whether the leading and the trailing edge are blunt"""
WITHOUT_WARNINGS = np.errstate(invalid="ignore", divide="ignore", over="ignore")
"""of numpy about what is not finite, which the shape itself tells"""


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelShape:
    """What a model builds from one design."""

    design: Any
    sides: tuple[Side, Side]
    edge_excess: Reals = field(default_factory=lambda: np.empty(0))
    """(e,) by how much a control point that sets an edge's radius stands higher than the thickness beside it, of the
    section's extent: for each edge of each side, along the span"""
    edge_heights: Reals = field(default_factory=lambda: np.empty(0))
    """(h,) the heights of these control points, of that thickness, where a blade is surveyed"""
    constraints: Reals = field(default_factory=lambda: np.empty(0))
    """(c,) values that may not be positive: how near a channel is to folding over, or sections are to a refusal"""
    exact: Any = None
    """the exact blade; None for sections"""

    @property
    def finite(self) -> bool:
        """Whether the shape exists at all."""
        return all(bool(np.isfinite(side.homogeneous).all()) for side in self.sides)

    def places(self, side: ArrayLike, u: ArrayLike, v: ArrayLike) -> Reals:
        """Places (n, d) on the sides at parameters, each (n,) or one for all."""
        return footpoints_at(None, self.sides, side, u, v).points

    def thickness(self, u: Reals, v: float) -> float:
        """Largest distance [m] between the sides at places u (n,) along them."""
        return float(np.sqrt(np.max(np.sum((self.places(0, u, v) - self.places(1, u, v)) ** 2, axis=-1))))


class Model(ABC):
    """A kind of design as a search sees it."""

    chord: float
    """mean chord of the design [m]"""
    rounded: bool = False
    """whether all sections end in rounded edges, whose arcs the two sides share"""

    @abstractmethod
    def shape(self, design: Any) -> ModelShape:
        """The sides of a design, not finite after invalid operations; raises DesignError where there are none."""

    @abstractmethod
    def along(self, shape: ModelShape, footpoints: Footpoints, directions: Reals, paths: Sequence[str]) -> Reals:
        """Derivatives (n, k) of the footpoints along directions (n, d) by parameters, at held surface parameters."""

    def edge_rates(self, shape: ModelShape, paths: Sequence[str]) -> tuple[Reals, Reals]:
        """Derivatives (k, e) of `shape.edge_excess` and (k, h) of `shape.edge_heights`."""
        return np.zeros((len(paths), len(shape.edge_excess))), np.zeros((len(paths), len(shape.edge_heights)))

    @abstractmethod
    def constraint_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """Derivatives (k, c) of `shape.constraints`."""


@singledispatch
def model_of(design: Design, tolerance: float | None = None) -> Model:  # noqa: ARG001 - the contract's
    """The model of a kind of design, with the knots that the design needs for a tolerance, of the chord."""
    raise FitError(f"a {type(design).__name__} cannot be fitted: give a section or a blade of a family")


def moved_along(sides: Sequence[Side], rates: Sequence[Array], footpoints: Footpoints, directions: Reals) -> Reals:
    """Derivatives (n, k) of footpoints along directions (n, d) by those (k, ..., d) of both sides' control points."""
    found = np.empty((len(footpoints.u), len(rates[0])))
    for number, (side, own) in enumerate(zip(sides, rates, strict=True)):
        rows = np.flatnonzero(footpoints.side == number)
        if len(rows) == 0:
            continue
        matrix = collocation(side, footpoints.u[rows], footpoints.v[rows])
        columns = np.moveaxis(own, 0, -2).reshape(matrix.shape[1], -1)
        moved = np.asarray(matrix @ columns).reshape(len(rows), len(own), own.shape[-1])
        if side.weights is not None:
            weight = np.asarray(matrix @ side.weights.reshape(-1, 1))[..., None]
            moved = (moved[..., :-1] - footpoints.points[rows, None] * moved[..., -1:]) / weight
        found[rows] = np.einsum("nkd,nd->nk", moved, directions[rows])
    return found


def stepped(design: Design, paths: Sequence[str]) -> Any:
    """The design with a batch of complex steps, one on each parameter."""
    values, kicks = design.parameters(), 1j * STEP * np.eye(len(paths))
    return design.changed({path: values[path] + kick for path, kick in zip(paths, kicks, strict=True)})


def fold_margins(own: tuple[Array, Array], moved: tuple[Array, Array]) -> Array:
    """By how much a channel that has moved comes nearer to folding over than it may (..., c), of its median Jacobian.

    Both are given by derivatives (..., k, m, 2) of (x, r) along and across.
    """
    size = np.median(np.sqrt(np.prod([np.sum(np.real(each) ** 2, axis=-1) for each in own], axis=0)))
    share = cross2(*moved) / size
    return np.asarray(SMALLEST_JACOBIAN - share.reshape(*share.shape[:-2], -1))


def stepped_rates(
    shape: ModelShape, paths: Sequence[str], moving: str | tuple[str, ...], count: int, values: Callable[[Any], Array]
) -> Reals:
    """Derivatives (k, count) of what a design gives by those parameters whose paths begin with `moving`; else zero."""
    found = np.zeros((len(paths), count))
    own = [place for place, path in enumerate(paths) if path.startswith(moving)]
    if count and own:
        found[own] = np.imag(values(stepped(shape.design, [paths[place] for place in own]))) / STEP
    return found


class SectionModel(Model):
    """A kind of section: all that a search sees of it comes from one rebuild, with a complex step on each parameter."""

    _last: tuple[ModelShape | None, tuple[str, ...], Sequence[Reals]] = (None, (), ())

    @abstractmethod
    def _parts(self, design: Any) -> tuple[Array, Array, Array, Array, Array]:
        """Homogeneous control points (..., n, d) of both sides, edge excess and heights (..., 4) and constraints."""

    @abstractmethod
    def _side(self, net: Reals) -> Curve:
        """The side with these control points."""

    @WITHOUT_WARNINGS
    def shape(self, design: Any) -> ModelShape:
        upper, lower, excess, heights, constraints = map(np.real, self._parts(design))
        sides = self._side(upper), self._side(lower)
        return ModelShape(design=design, sides=sides, edge_excess=excess, edge_heights=heights, constraints=constraints)

    def along(self, shape: ModelShape, footpoints: Footpoints, directions: Reals, paths: Sequence[str]) -> Reals:
        return moved_along(shape.sides, self.rates(shape, paths)[:2], footpoints, directions)

    def edge_rates(self, shape: ModelShape, paths: Sequence[str]) -> tuple[Reals, Reals]:
        return self.rates(shape, paths)[2], self.rates(shape, paths)[3]

    def constraint_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        return self.rates(shape, paths)[4]

    def rates(self, shape: ModelShape, paths: Sequence[str]) -> Sequence[Reals]:
        """Derivatives (k, ...) of all parts by parameters, kept for the next that asks for them."""
        known, asked, rates = self._last
        if known is not shape or asked != tuple(paths):
            parts = self._parts(stepped(shape.design, paths))
            own = [part.shape[-axes:] for part, axes in zip(parts, (2, 2, 1, 1, 1), strict=True)]
            rates = [np.imag(np.broadcast_to(p, (len(paths), *one))) / STEP for p, one in zip(parts, own, strict=True)]
            self._last = shape, tuple(paths), rates
        return rates


class SpatialModel(Model):
    """A kind of blade, at the knots that one design needs for a tolerance."""

    knots: Knots
    blunt: BluntEdges = (False, False)

    def along(self, shape: ModelShape, footpoints: Footpoints, directions: Reals, paths: Sequence[str]) -> Reals:
        """By the weights at the footpoints themselves, times what a common step of several parameters does there.

        That changes along the span as laws' values do, so that it is interpolated between a knot for each control point
        of the longest law. The face of a blunt edge moves as the straight one between its edges.
        """
        steps, sources = steps_of(shape.design, paths)
        spans = max(len(step.paths) for step in steps)
        knots = replace(self.knots, v=clamped(np.linspace(0.0, 1.0, spans + 1)[1:-1]), sections=None)
        blade = Blade(design=shape.design, surfaces=FrozenMapping({}), knots=knots, chord=self.chord, exact=shape.exact)
        nets: Sequence[Array] = step_tangents(blade, steps)
        if any(self.blunt):
            upper, lower = (np.moveaxis(net, 1, -2) for net in nets)
            nets = tuple(np.moveaxis(net, -2, 1) for net in closed_nets(upper, lower, DEGREE, self.blunt))
        sides = [
            replace(cast(Surface, side), control_points=net[0], knots_v=knots.v)
            for side, net in zip(shape.sides, nets, strict=True)
        ]
        rates = moved_along(sides, nets, footpoints, directions)
        weights = [step.weights(footpoints.v) for step in steps]
        return np.stack([rates[:, step] * weights[step][:, place] for step, place in sources], axis=1)


def closed_knots(knots: Reals, degree: int, blunt: BluntEdges) -> Reals:
    """Knots of a side with half a face at its blunt edges, from those of the side over [0, 1]."""
    low, high = side_bounds(blunt)
    inner = low + (high - low) * knots[degree + 1 : -degree - 1]
    corner = [np.full(degree, at) if is_blunt else np.empty(0) for at, is_blunt in zip((low, high), blunt, strict=True)]
    return np.concatenate([np.zeros(degree + 1), corner[0], inner, corner[1], np.ones(degree + 1)])


def closed_nets(upper: Array, lower: Array, degree: int, blunt: BluntEdges) -> tuple[Array, Array]:
    """Control points (..., n, d) of both sides with half a face at their blunt edges."""
    steps = (np.arange(1, degree + 1) / degree)[:, None]
    found = []
    for side, other in ((upper, lower), (lower, upper)):
        corners = [(side[..., [at], :], other[..., [at], :]) for at in (0, -1)]
        first, last = (corner + steps * (0.5 * (corner + across) - corner) for corner, across in corners)
        parts = [*[first[..., ::-1, :]] * blunt[0], side, *[last] * blunt[1]]
        found.append(np.concatenate(parts, axis=-2))
    return found[0], found[1]


def side_bounds(blunt: BluntEdges) -> tuple[float, float]:
    """Parameters at which the side itself begins and ends."""
    return (FACE_SHARE if blunt[0] else 0.0), (1.0 - FACE_SHARE if blunt[1] else 1.0)


def closed_with(upper: Surface, lower: Surface, faces: Mapping[str, Surface]) -> tuple[Surface, Surface]:
    """Two sides of a blade with the halves of the faces of its blunt edges, given by name."""
    if not faces:
        return upper, lower
    knots = closed_knots(upper.knots_u, upper.degree_u, ("leading_edge" in faces, "trailing_edge" in faces))
    found = []
    for side, step in ((upper, 1), (lower, -1)):
        net = side.control_points
        for name, face in faces.items():
            half = _first_half(face.control_points[::step])
            net = np.concatenate([half[:0:-1], net] if name == "leading_edge" else [net, half[1:]])
        found.append(replace(side, control_points=net, knots_u=knots))
    return found[0], found[1]


def _first_half(net: Reals) -> Reals:
    """The first half of a polynomial with control points (n, ...), by de Casteljau's construction."""
    number = np.arange(len(net))
    return np.tensordot(comb(number[:, None], number) / 2.0 ** number[:, None], net, axes=1)


def sides_of(built: Blade | Section) -> tuple[Curve, Curve] | tuple[Surface, Surface]:
    """The sides of what is built with the halves of the faces of its blunt edges."""
    if isinstance(built, Blade):
        faces = {name: face for name in EDGES if isinstance(face := built.surfaces.get(name), Surface)}
        return closed_with(*built.sides, faces)
    upper, lower, blunt = built.curves["upper"], built.curves["lower"], blunt_edges_of(built)
    if not any(blunt):
        return upper, lower
    knots = closed_knots(upper.knots, upper.degree, blunt)
    nets = closed_nets(upper.control_points, lower.control_points, upper.degree, blunt)
    first, last = (Curve(control_points=net, knots=knots, degree=upper.degree) for net in nets)
    return first, last


def blunt_edges_of(built: Blade | Section) -> BluntEdges:
    """Which edges of what is built are blunt."""
    if isinstance(built, Blade):
        return "leading_edge" in built.surfaces, "trailing_edge" in built.surfaces
    return built.edges[0] == "blunt", built.edges[1] == "blunt"


def on_sides(footpoints: Footpoints, blunt: BluntEdges) -> tuple[Footpoints, NDArray[np.intp]]:
    """Footpoints by the sides' own parameters, and -1 for those on the leading face, 1 on the trailing face, 0 else."""
    low, high = side_bounds(blunt)
    faces = np.where(footpoints.u < low, -1, np.where(footpoints.u > high, 1, 0))
    return replace(footpoints, u=np.clip((footpoints.u - low) / (high - low), 0.0, 1.0)), faces
