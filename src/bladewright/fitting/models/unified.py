"""Sections and blades of the unified family, as a search sees them."""

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.unified import SURVEY, ExactUnifiedBlade, exact_unified_blade
from bladewright.blade.flow_path.channel import TransfiniteChannel
from bladewright.blade.native.blade import side_surface
from bladewright.blade.native.interpolation import native_sides
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.refinement import mean_chord, refined_knots
from bladewright.derivatives.complex_step import STEP, Nets, stepped_design, steps_of
from bladewright.fitting.models.model import (
    FOLD_GRID,
    Model,
    ModelShape,
    SpatialModel,
    complex_steps,
    fold_margins,
    model_of,
)
from bladewright.numerics.elementary import Array, concatenated, length
from bladewright.nurbs.basis import Reals
from bladewright.section.camber import camber_points
from bladewright.section.checks import UNITS
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_sides import sample_places, side_curve

PLACES_ALONG_SPAN: Reals = np.linspace(0.0, 1.0, 65)
"""places along the span among which those are sought where an edge's radius is nearest to what the thickness holds:
five for each joint of the longest law (`MOST_SPAN` control points)."""
COARSE_SEARCH, KNOT_SLACK = 3.0, 100.0
"""tolerance of a search, of the design's own, from which knots may miss walls and edges by the factor `KNOT_SLACK` of
what `build` promises. On Rotor 67 it saves half of the derivatives' time and changes distances by 1e-5 mm
(design/matching.md)."""


@final
class SectionModel(Model):
    """Sections of the unified family."""

    rounded = True

    def __init__(self, design: UnifiedSection) -> None:
        slope = np.cos(np.radians(design.stagger))
        self.chord = float(design.axial_chord * UNITS[design.length_unit] / slope)
        self._last: tuple[ModelShape | None, tuple[str, ...], list[Array]] = (None, (), [])

    def _shape(self, design: Any) -> ModelShape:
        line, upper, lower = _outline(design)
        sides = side_curve(upper[0]), side_curve(lower[0])
        return ModelShape(
            design=design,
            sides=sides,
            edge_radius_margins=np.real(_edge_radius_margins(design, line, upper, lower))[..., 0],
        )

    def tangents(self, shape: ModelShape, paths: Sequence[str]) -> tuple[Reals, Reals]:
        """From one rebuild with a complex step on each parameter in a batch; the edges' rates come from the same."""
        _, *sides = self._stepped(shape, paths)
        upper, lower = (np.imag(side)[:, 0] / STEP for side in sides)
        return upper, lower

    def edge_radius_margin_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """From the same rebuild as the tangents."""
        found = np.imag(_edge_radius_margins(shape.design, *self._stepped(shape, paths)))[..., 0] / STEP
        return np.moveaxis(found, 1, 0)

    def _stepped(self, shape: ModelShape, paths: Sequence[str]) -> list[Array]:
        known, asked, parts = self._last
        if known is not shape or asked != tuple(paths):
            found = _outline(shape.design.changed(complex_steps(shape.design, paths)))
            parts = [np.broadcast_to(part, (len(paths), *part.shape[-3:])) for part in found]
            self._last = shape, tuple(paths), parts
        return parts


@final
class BladeModel(SpatialModel):
    """Blades of the unified family, at the knots that one of them needs."""

    rounded = True

    def __init__(self, design: UnifiedBlade, tolerance: float | None = None) -> None:
        self.tolerance = design.tolerance if tolerance is None else tolerance
        exact = exact_unified_blade(design.changed("tolerance", self.tolerance), tentative=True)
        self.chord = mean_chord(exact)
        slack = KNOT_SLACK if self.tolerance > COARSE_SEARCH * design.tolerance else 1.0
        self.knots: Knots = refined_knots(exact, self.chord, slack=slack)
        self.stations = np.union1d(SURVEY, _narrowest_places(design, exact))
        """places along the span at which the thickness must hold the edges' radii"""

    def _shape(self, design: Any) -> ModelShape:
        exact = exact_unified_blade(design, self.knots.tip, tentative=True)
        upper, lower = native_sides(exact.sections(self.knots.sites_v), self.knots)
        plane = exact.sections(self.stations).plane
        return ModelShape(
            design=design,
            sides=(side_surface(upper, self.knots, DEGREE), side_surface(lower, self.knots, DEGREE)),
            edge_radius_margins=np.real(_edge_radius_margins(design, plane.camber, plane.upper, plane.lower)),
            constraints=np.real(_fold_margins(exact, exact.channel)),
            exact=exact,
        )

    def _closed(self, upper: Reals, lower: Reals) -> Nets:
        return upper, lower

    def edge_radius_margin_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """By the laws only: by the channel they vanish but for the walls' slopes, which are left out."""
        found = np.zeros((len(paths), *shape.edge_radius_margins.shape))
        design, own = shape.design, [place for place, path in enumerate(paths) if not path.startswith("channel.")]
        steps, sources = steps_of(design, [paths[place] for place in own])
        plane = shape.exact.moved_to(stepped_design(design, steps)).sections(self.stations).plane
        rates = np.imag(_edge_radius_margins(design, plane.camber, plane.upper, plane.lower)) / STEP
        weights = [step.weights(self.stations) for step in steps]
        for place, (step, number) in zip(own, sources, strict=True):
            found[place] = rates[:, step] * weights[step][:, number]
        return found

    def constraint_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """From one channel with a complex step on each of its parameters in a batch."""
        found = np.zeros((len(paths), len(shape.constraints)))
        walls = [place for place, path in enumerate(paths) if path.startswith("channel.")]
        if walls and shape.exact is not None:
            steps = complex_steps(shape.design, [paths[place] for place in walls])
            found[walls] = (
                np.imag(_fold_margins(shape.exact, shape.exact.moved_to(shape.design.changed(steps)).channel)) / STEP
            )
        return found


def _narrowest_places(design: UnifiedBlade, exact: ExactUnifiedBlade) -> Reals:
    """Where along the span edge radii come nearest to what the thickness holds, or exceed it most.

    Searches hold the radii there and where the blade is surveyed: the exchange method of semi-infinite constraints
    (Hettich and Kortanek 1993, section 7), an exchange a round.
    """
    plane = exact.sections(PLACES_ALONG_SPAN).plane
    excess = np.real(_edge_radius_margins(design, plane.camber, plane.upper, plane.lower))[0]
    higher = np.pad(excess, ((0, 0), (1, 1)), constant_values=-np.inf)
    return PLACES_ALONG_SPAN[np.any((excess >= higher[:, :-2]) & (excess >= higher[:, 2:]), axis=0)]


def _fold_margins(exact: ExactUnifiedBlade, channel: TransfiniteChannel) -> Array:
    """By how much a channel (...) comes nearer to folding over than it may (..., c), of its median Jacobian."""
    u = np.linspace(-exact.before, 1.0 + exact.after, FOLD_GRID[0])
    v = np.linspace(0.0, 1.0, FOLD_GRID[1])
    return fold_margins(exact.channel.slopes(u, v), channel.slopes(u, v))


def _outline(design: UnifiedSection) -> tuple[Array, Array, Array]:
    """Control points (..., 1, n, 2) in the section's place; those of rational sides (..., 1, n, 3)."""
    line, upper, lower = design.outline(tentative=True)
    shift = np.asarray(design.leading_edge_x)[..., None, None] * UNITS[design.length_unit]
    parts = []
    for part in (line, upper, lower):
        weight = part[..., 2] if part.shape[-1] == 3 else 1.0
        abscissa = part[..., 0] + shift * weight
        others = [np.broadcast_to(part[..., i], abscissa.shape) for i in range(1, part.shape[-1])]
        parts.append(np.stack([abscissa, *others], axis=-1))
    return parts[0], parts[1], parts[2]


def _edge_radius_margins(design: Any, line: Array, upper: Array, lower: Array) -> Array:
    """The edge radius margins (2, ..., 4, m) of sections, as `ModelShape` defines them."""
    extent = line[..., 3, 0] - line[..., 0, 0]
    places = sample_places(design.samples, design.clustering)[[2, -3]]
    camber = camber_points(line, places)
    rows = []
    for side in (upper, lower):
        plain = side if side.shape[-1] == 2 else side[..., :2] / side[..., 2:]
        for end, (first, second, third) in enumerate(((0, 1, 2), (-1, -2, -3))):
            height = length(plain[..., second, :] - plain[..., first, :])
            next_thickness = length(plain[..., third, :] - camber[..., end, :])
            rows.append(np.stack([(height - next_thickness) / extent, height / next_thickness])[..., None, :])
    return concatenated(rows, axis=-2)


@model_of.register
def _(design: UnifiedSection, tolerance: float | None = None) -> Model:  # noqa: ARG001 - the contract's
    return SectionModel(design)


@model_of.register
def _(design: UnifiedBlade, tolerance: float | None = None) -> Model:
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        return BladeModel(design, tolerance)
