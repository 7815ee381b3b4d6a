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
from bladewright.derivatives.complex_step import STEP, stepped_design, steps_of
from bladewright.fitting.models.model import (
    FOLD_GRID,
    WITHOUT_WARNINGS,
    ModelShape,
    SectionModel,
    SpatialModel,
    fold_margins,
    model_of,
    stepped_rates,
)
from bladewright.numerics.elementary import Array, concatenated, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.section.camber import camber_points
from bladewright.section.checks import UNITS
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_sides import sample_places, side_curve

PLACES_ALONG_SPAN: Reals = np.linspace(0.0, 1.0, 65)
"""places along the span at which edges' radii are compared with the thickness: five for each joint of the longest law
(`MOST_SPAN` control points)"""
COARSE_SEARCH, KNOT_SLACK = 3.0, 100.0
"""tolerance of a search, of the design's own, from which knots may miss walls and edges by so many times what `build`
promises: it saves half of the derivatives' time (design/matching.md)"""


@model_of.register(UnifiedSection)
@final
class UnifiedSectionModel(SectionModel):
    """Sections of the unified family."""

    rounded = True

    def __init__(self, design: UnifiedSection, tolerance: float | None = None) -> None:  # noqa: ARG002 - the contract's
        slope = np.cos(np.radians(design.stagger))
        self.chord = float(design.axial_chord * UNITS[design.length_unit] / slope)

    def _parts(self, design: Any) -> tuple[Array, Array, Array, Array]:
        shift = np.asarray(design.leading_edge_x)[..., None, None, None] * UNITS[design.length_unit]
        # homogeneous places move by their weight as far
        line, upper, lower = (
            part + shift * (part[..., 2:] if part.shape[-1] == 3 else 1.0) * np.eye(1, part.shape[-1])
            for part in design.outline(tentative=True)
        )
        margins = np.moveaxis(_edge_radius_margins(design, line, upper, lower)[..., 0], 0, -2)
        return upper[..., 0, :, :], lower[..., 0, :, :], margins, np.zeros(0)

    def _side(self, net: Reals) -> Curve:
        return side_curve(net)


@model_of.register(UnifiedBlade)
@final
class UnifiedBladeModel(SpatialModel):
    """Blades of the unified family, at the knots that one of them needs."""

    rounded = True

    @WITHOUT_WARNINGS
    def __init__(self, design: UnifiedBlade, tolerance: float | None = None) -> None:
        self.tolerance = design.tolerance if tolerance is None else tolerance
        exact = exact_unified_blade(design.changed("tolerance", self.tolerance), tentative=True)
        self.chord = mean_chord(exact)
        slack = KNOT_SLACK if self.tolerance > COARSE_SEARCH * design.tolerance else 1.0
        self.knots: Knots = refined_knots(exact, self.chord, slack=slack)
        self.stations = np.union1d(SURVEY, _narrowest_places(design, exact))
        """places along the span at which the thickness must hold the edges' radii"""

    @WITHOUT_WARNINGS
    def shape(self, design: Any) -> ModelShape:
        exact = exact_unified_blade(design, self.knots.tip, tentative=True)
        upper, lower = native_sides(exact.sections(self.knots.sites_v), self.knots)
        return ModelShape(
            design=design,
            sides=(side_surface(upper, self.knots, DEGREE), side_surface(lower, self.knots, DEGREE)),
            edge_radius_margins=np.real(_margins_at(design, exact, self.stations)),
            constraints=np.real(_fold_margins(exact, exact.channel)),
            exact=exact,
        )

    def edge_radius_margin_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """By the laws only: by the channel they vanish but for the walls' slopes, which are left out."""
        found = np.zeros((len(paths), *shape.edge_radius_margins.shape))
        design, own = shape.design, [place for place, path in enumerate(paths) if not path.startswith("channel.")]
        steps, sources = steps_of(design, [paths[place] for place in own])
        moved = shape.exact.moved_to(stepped_design(design, steps))
        rates = np.imag(_margins_at(design, moved, self.stations)) / STEP
        weights = [step.weights(self.stations) for step in steps]
        for place, (step, number) in zip(own, sources, strict=True):
            found[place] = rates[:, step] * weights[step][:, number]
        return found

    def constraint_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """From one channel with a complex step on each of its parameters in a batch."""
        exact, count = shape.exact, len(shape.constraints)
        return stepped_rates(
            shape, paths, "channel.", count, lambda design: _fold_margins(exact, exact.moved_to(design).channel)
        )


def _narrowest_places(design: UnifiedBlade, exact: ExactUnifiedBlade) -> Reals:
    """Where along the span edge radii come nearest to what the thickness holds, or exceed it most.

    Searches hold the radii there and where the blade is surveyed: the exchange method of semi-infinite constraints
    (Hettich and Kortanek 1993, section 7), an exchange a round.
    """
    excess = np.real(_margins_at(design, exact, PLACES_ALONG_SPAN))[0]
    higher = np.pad(excess, ((0, 0), (1, 1)), constant_values=-np.inf)
    return PLACES_ALONG_SPAN[np.any((excess >= higher[:, :-2]) & (excess >= higher[:, 2:]), axis=0)]


def _fold_margins(exact: ExactUnifiedBlade, channel: TransfiniteChannel) -> Array:
    """By how much a channel (...) comes nearer to folding over than it may (..., c), of its median Jacobian."""
    u, v = np.linspace(-exact.before, 1.0 + exact.after, FOLD_GRID[0]), np.linspace(0.0, 1.0, FOLD_GRID[1])
    return fold_margins(exact.channel.slopes(u, v), channel.slopes(u, v))


def _margins_at(design: Any, exact: ExactUnifiedBlade, v: Reals) -> Array:
    """The edge radius margins (2, ..., 4, m) of an exact blade's sections at v (m,)."""
    plane = exact.sections(v).plane
    return _edge_radius_margins(design, plane.camber, plane.upper, plane.lower)


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
