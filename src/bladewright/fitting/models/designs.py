"""Sections and blades of every family, as a search sees them."""

from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch
from typing import Any, final

import numpy as np

from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.cut_sectioned import ExactCutBlade, exact_blade_of_sections
from bladewright.blade.exact.prescribed_edges import PrescribedEdges
from bladewright.blade.exact.sectioned import ENDS, PLACING
from bladewright.blade.exact.unified import SURVEY, ExactUnifiedBlade, exact_unified_blade
from bladewright.blade.flow_path.channel import TransfiniteChannel
from bladewright.blade.flow_path.intersections import EXTENSION
from bladewright.blade.flow_path.stream_surfaces import KEPT
from bladewright.blade.native.blade import side_surface
from bladewright.blade.native.interpolation import edge_faces, native_sides
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.refinement import mean_chord, refined_knots
from bladewright.derivatives.complex_step import STEP, stepped_design, steps_of
from bladewright.fitting.models.model import (
    FOLD_GRID,
    WITHOUT_WARNINGS,
    BluntEdges,
    ModelShape,
    SectionModel,
    SpatialModel,
    closed_knots,
    closed_nets,
    closed_with,
    fold_margins,
    model_of,
    stepped_rates,
)
from bladewright.numerics.elementary import Array, concatenated, length, radians
from bladewright.nurbs.basis import Reals, greville
from bladewright.nurbs.curve import Curve
from bladewright.section.camber import camber_points
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.camber_angle_outline import STEEPEST
from bladewright.section.checks import UNITS
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import Span
from bladewright.section.native import interpolated_along_u, side_knots_for
from bladewright.section.outline import EdgeDerivatives
from bladewright.section.planar import PlanarSection
from bladewright.section.segmented.part import Segmented
from bladewright.section.suction_pressure.edges import MAX_OPENING, opening
from bladewright.section.suction_pressure.limits import CHECKED_AT, gaps
from bladewright.section.suction_pressure.part import SuctionPressure, edge_points, sides
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_sides import sample_places, side_curve

SINGLE_SECTION = Span(np.zeros(1))
"""the one place along the span of a section that stands alone"""
FEASIBILITY_SPAN = Span(SURVEY)
"""places along the span at which sections must stay feasible: those by which a blade is judged before it is built"""
SLOWEST_PACE = 0.003
"""least speed of a side's parameter by s beside an edge, of its mean; refused at 0 (design/matching_constants.md)"""
SMALLEST_GAP = 1e-4
"""smallest distance between the two sides, in chords; refused at 0 (design/matching_constants.md)"""
STEEP_MARGIN = 0.01
"""share kept free of the steepest half thickness allowed beside a round edge (design/matching_constants.md)"""
MET_MARGIN = 0.01
"""how far before its end, in its parameter, a continued edge must meet hub and shroud (design/matching_constants.md)"""
OPENING_MARGIN = 0.003
"""smallest distance of an edge's opening from the largest one allowed (design/matching_constants.md)"""


@model_of.register(PlanarSection)
@final
class PlanarModel(SectionModel):
    """A section of such a family, at the knots that one design needs for a tolerance, of the chord."""

    def __init__(self, design: PlanarSection, tolerance: float | None = None) -> None:
        self.chord = float(np.real(design.chord)) * UNITS[design.length_unit]
        outline = design.section.outline(SINGLE_SECTION)
        self.knots: Reals = side_knots_for(outline, design.tolerance if tolerance is None else tolerance)
        self.blunt: BluntEdges = outline.leading_edge.kind == "blunt", outline.trailing_edge.kind == "blunt"
        self.closed = closed_knots(self.knots, DEGREE, self.blunt)

    def _side(self, net: Reals) -> Curve:
        return Curve(control_points=net, knots=self.closed, degree=DEGREE)

    def _parts(self, design: Any) -> tuple[Array, Array, Array, Array, Array]:
        outline, turn = design.section.outline(SINGLE_SECTION), design.section.stagger(SINGLE_SECTION)
        lengths = design.chord, design.leading_edge_x, design.leading_edge_y
        chord, x, y = (np.asarray(value)[..., None] * UNITS[design.length_unit] for value in lengths)
        cosine, sine = np.cos(turn), np.sin(turn)
        nets, first, last = [], outline.leading_edge, outline.trailing_edge
        for name, points in zip(("upper", "lower"), outline.points(greville(self.knots, DEGREE)[3:-3]), strict=True):
            edges = np.broadcast_arrays(*getattr(first, name), *getattr(last, name))
            start, end = EdgeDerivatives(*edges[:3]), EdgeDerivatives(*edges[3:])
            net = interpolated_along_u(np.swapaxes(points, -3, -2), start, end, self.knots)[..., 0, :]
            a, b = net[..., 0], net[..., 1]
            placed = x + chord * (a * cosine - b * sine), y + chord * (a * sine + b * cosine)
            nets.append(np.stack(np.broadcast_arrays(*placed), axis=-1))
        closed = closed_nets(nets[0], nets[1], DEGREE, self.blunt)
        return *closed, np.empty(0), np.empty(0), infeasibility(design.section, SINGLE_SECTION)


@model_of.register(SectionedBlade)
@final
class SectionedModel(SpatialModel):
    """A blade from sections of any family, at the knots that one design needs for a tolerance, of the chord."""

    @WITHOUT_WARNINGS
    def __init__(self, design: SectionedBlade, tolerance: float | None = None) -> None:
        own = replace(design, tolerance=design.tolerance if tolerance is None else tolerance)
        exact = exact_blade_of_sections(own, checked=False)
        self.chord = mean_chord(exact)
        self.knots: Knots = refined_knots(exact, self.chord)
        kinds = exact.survey.edge_kinds
        self.blunt = kinds[0] == "blunt", kinds[1] == "blunt"

    @WITHOUT_WARNINGS
    def shape(self, design: Any) -> ModelShape:
        exact = exact_blade_of_sections(design, self.knots, checked=False)
        stations = exact.sections(self.knots.sites_v)
        sides = [side_surface(net, self.knots, DEGREE) for net in native_sides(stations, self.knots)]
        faces = edge_faces(stations, sides[0], sides[1], self.knots) if any(self.blunt) else {}
        upper, lower = closed_with(sides[0], sides[1], faces)
        rows = infeasibility(design.section, FEASIBILITY_SPAN), _flow_path_margins(exact, exact)
        constraints = np.concatenate([np.real(each) for each in rows])
        return ModelShape(design=design, sides=(upper, lower), exact=exact, constraints=constraints)

    def constraint_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """Derivatives of the sections' infeasibility, and of how near flow path and edges are to what is refused."""
        exact, count = shape.exact, len(_flow_path_margins(shape.exact, shape.exact))

        def sections(design: Any) -> Array:
            return infeasibility(design.section, FEASIBILITY_SPAN)

        def flow_path(design: Any) -> Array:
            return _flow_path_margins(exact, exact.moved_to(design))

        own = stepped_rates(shape, paths, "section.", len(shape.constraints) - count, sections)
        return np.concatenate([own, stepped_rates(shape, paths, PLACING[:3], count, flow_path)], axis=1)


def _flow_path_margins(exact: Any, moved: Any) -> Array:
    """By how much a blade that has moved comes nearer than it may to folding, or to edges that miss a wall (..., c)."""
    own = exact.meridional_channel(ENDS, ENDS)
    # paths that are matched at the edges end where they fold
    low, high = own.extent if exact.design.flow_path.matched == "ends" else (-KEPT, 1.0 + KEPT)
    t, v = np.linspace(low, high, FOLD_GRID[0]), np.linspace(0.0, 1.0, FOLD_GRID[1])
    rows = [fold_margins(own.grid(t, v)[1:], moved.meridional_channel(ENDS, ENDS).grid(t, v)[1:])]
    placement = (moved.whole if isinstance(moved, ExactCutBlade) else moved).placement
    if isinstance(placement, PrescribedEdges):
        for _, place in placement.intersections(ENDS):
            rows += [MET_MARGIN - EXTENSION - place, place - 1.0 - EXTENSION + MET_MARGIN]
    return concatenated(rows, axis=-1)


@singledispatch
def infeasibility(part: Any, span: Span) -> Array:  # noqa: ARG001 - most parts are refused on their way by nothing
    """By how much sections at places along the span are nearer to a refusal than they may be (..., c).

    Values above 0 violate the margin. Raises DesignError where the sections are refused already.
    """
    return np.zeros(0)


@infeasibility.register
def _(part: Segmented, span: Span) -> Array:
    """By how much control points of segments lie ahead of the ones before them; those at the nose may."""
    rows = []
    for side in part.outline(span).sides:
        for number, controls in enumerate(side.controls):
            x = controls[..., 2 if number == 0 else 0 :, 0]
            rows.append(x[..., :-1] - x[..., 1:])
    found = concatenated(rows, axis=-1)
    return found.reshape(*found.shape[:-2], -1)


@infeasibility.register
def _(part: CurvatureMeanline, span: Span) -> Array:
    """No margins: a thickness is refused or it is not."""
    part.thickness.at(span)
    return np.zeros(0)


@infeasibility.register
def _(part: CamberAngle, span: Span) -> Array:
    steep = [each for each in part.outline(span).bends if each is not None]
    return concatenated(steep, axis=-1) / STEEPEST - (1.0 - STEEP_MARGIN)


@infeasibility.register
def _(part: SuctionPressure, span: Span) -> Array:
    edges = edge_points(part, span)
    rows = [_opening_excess(part, edge, span) for edge in ("leading_edge", "trailing_edge")]
    suction, pressure = sides(part, span, *edges)
    rows.append(SMALLEST_GAP - (gaps(suction, pressure) if part.suction_side == "upper" else gaps(pressure, suction)))
    for side in (suction, pressure):
        rows += [SLOWEST_PACE - side.own_parameter(end, CHECKED_AT, 1) for end in (0, 1)]
    return concatenated([each.reshape(*each.shape[:-2], -1) for each in rows], axis=-1)


def _opening_excess(part: SuctionPressure, edge: str, span: Span) -> Array:
    """By how much the opening of the two ellipses of an edge is larger than it may be (..., m, 2)."""
    stretch, skew, wedge = (span.values(getattr(part, f"{edge}_{each}")) for each in ("stretch", "skew", "wedge"))
    ratios = [opening(stretch * (1.0 + sign * skew), radians(wedge)) for sign in (1.0, -1.0)]
    return np.stack(np.broadcast_arrays(*ratios), axis=-1) - (MAX_OPENING[part.edges] - OPENING_MARGIN)


PLACES_ALONG_SPAN: Reals = np.linspace(0.0, 1.0, 65)
"""places along the span where edge radii are compared with thickness: five a joint of the longest law"""
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

    def _parts(self, design: Any) -> tuple[Array, Array, Array, Array, Array]:
        shift = np.asarray(design.leading_edge_x)[..., None, None, None] * UNITS[design.length_unit]
        # homogeneous places move by their weight as far
        line, upper, lower = (
            part + shift * (part[..., 2:] if part.shape[-1] == 3 else 1.0) * np.eye(1, part.shape[-1])
            for part in design.outline(tentative=True)
        )
        excess, heights = (each[..., 0] for each in _edge_control_points(design, line, upper, lower))
        return upper[..., 0, :, :], lower[..., 0, :, :], excess, heights, np.empty(0)

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
        self.stations = np.concatenate([SURVEY, np.setdiff1d(_narrowest_places(design, exact), SURVEY)])
        """places along the span at which the thickness must hold the edges' radii; those of the survey come first"""

    @WITHOUT_WARNINGS
    def shape(self, design: Any) -> ModelShape:
        exact = exact_unified_blade(design, self.knots.tip, tentative=True)
        upper, lower = native_sides(exact.sections(self.knots.sites_v), self.knots)
        excess, heights = map(np.real, _edges_at(design, exact, self.stations))
        return ModelShape(
            design=design,
            sides=(side_surface(upper, self.knots, DEGREE), side_surface(lower, self.knots, DEGREE)),
            edge_excess=excess.ravel(),
            edge_heights=heights[:, : len(SURVEY)].ravel(),
            constraints=np.real(_fold_margins(exact, exact.channel)),
            exact=exact,
        )

    def edge_rates(self, shape: ModelShape, paths: Sequence[str]) -> tuple[Reals, Reals]:
        """By the laws only: by the channel they vanish but for the walls' slopes, which are left out."""
        found = np.zeros((2, len(paths), 4, len(self.stations)))
        design, own = shape.design, [place for place, path in enumerate(paths) if not path.startswith("channel.")]
        steps, sources = steps_of(design, [paths[place] for place in own])
        moved = shape.exact.moved_to(stepped_design(design, steps))
        rates = np.imag(np.stack(_edges_at(design, moved, self.stations))) / STEP
        weights = [step.weights(self.stations) for step in steps]
        for place, (step, number) in zip(own, sources, strict=True):
            found[:, place] = rates[:, step] * weights[step][:, number]
        excess, heights = found[0], found[1, ..., : len(SURVEY)]
        return excess.reshape(len(paths), -1), heights.reshape(len(paths), -1)

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
    excess = np.real(_edges_at(design, exact, PLACES_ALONG_SPAN)[0])
    higher = np.pad(excess, ((0, 0), (1, 1)), constant_values=-np.inf)
    return PLACES_ALONG_SPAN[np.any((excess >= higher[:, :-2]) & (excess >= higher[:, 2:]), axis=0)]


def _fold_margins(exact: ExactUnifiedBlade, channel: TransfiniteChannel) -> Array:
    """By how much a channel (...) comes nearer to folding over than it may (..., c), of its median Jacobian."""
    u, v = np.linspace(-exact.before, 1.0 + exact.after, FOLD_GRID[0]), np.linspace(0.0, 1.0, FOLD_GRID[1])
    return fold_margins(exact.channel.slopes(u, v), channel.slopes(u, v))


def _edges_at(design: Any, exact: ExactUnifiedBlade, v: Reals) -> tuple[Array, Array]:
    """Excess and height (..., 4, m) of an exact blade's edges at v (m,)."""
    plane = exact.sections(v).plane
    return _edge_control_points(design, plane.camber, plane.upper, plane.lower)


def _edge_control_points(design: Any, line: Array, upper: Array, lower: Array) -> tuple[Array, Array]:
    """Excess and height (..., 4, m) of the control points that set edge radii, as `ModelShape` defines them."""
    extent = line[..., 3, 0] - line[..., 0, 0]
    places = sample_places(design.samples, design.clustering)[[2, -3]]
    camber = camber_points(line, places)
    excess, heights = [], []
    for side in (upper, lower):
        plain = side if side.shape[-1] == 2 else side[..., :2] / side[..., 2:]
        for end, (first, second, third) in enumerate(((0, 1, 2), (-1, -2, -3))):
            height = length(plain[..., second, :] - plain[..., first, :])
            next_thickness = length(plain[..., third, :] - camber[..., end, :])
            excess.append(((height - next_thickness) / extent)[..., None, :])
            heights.append((height / next_thickness)[..., None, :])
    return concatenated(excess, axis=-2), concatenated(heights, axis=-2)
