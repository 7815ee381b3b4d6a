"""Sections of the families that are one part, as a search sees them."""

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from bladewright.derivatives.complex_step import STEP
from bladewright.fitting.models.blunt_edges import BluntEdges, closed_knots, closed_nets
from bladewright.fitting.models.model import Model, ModelShape, complex_steps, model_of
from bladewright.numerics.elementary import Array, radians
from bladewright.nurbs.basis import Reals, greville
from bladewright.nurbs.curve import Curve
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span
from bladewright.section.native import DEGREE, interpolated_along_u, side_knots_for
from bladewright.section.outline import Edge, EdgeDerivatives
from bladewright.section.planar import PlanarSection
from bladewright.section.segmented.outline import SegmentedOutline
from bladewright.section.segmented.part import Segmented
from bladewright.section.suction_pressure.edges import MAX_OPENING, opening
from bladewright.section.suction_pressure.limits import CHECKED_AT
from bladewright.section.suction_pressure.part import SuctionPressure, edge_points, sides

SINGLE_SECTION = Span(np.zeros(1))
"""the one place along the span of a section that stands alone"""


@final
class PlanarModel(Model):
    """A section of such a family, at the knots that one design needs for a tolerance, of the chord."""

    def __init__(self, design: PlanarSection, tolerance: float | None = None) -> None:
        self.chord = float(np.real(design.chord)) * UNITS[design.length_unit]
        outline = design.section.outline(SINGLE_SECTION)
        self.knots: Reals = side_knots_for(outline, design.tolerance if tolerance is None else tolerance)
        self.blunt: BluntEdges = outline.leading_edge.kind == "blunt", outline.trailing_edge.kind == "blunt"
        self.closed = closed_knots(self.knots, DEGREE, self.blunt)

    def _shape(self, design: Any) -> ModelShape:
        upper, lower = (np.real(net) for net in self._nets(design))
        sides = [Curve(control_points=net, knots=self.closed, degree=DEGREE) for net in (upper, lower)]
        constraints = np.real(infeasibility(design.section, SINGLE_SECTION))
        return ModelShape(design=design, sides=(sides[0], sides[1]), constraints=constraints)

    def tangents(self, shape: ModelShape, paths: Sequence[str]) -> tuple[Reals, Reals]:
        """From one rebuild with a complex step on each parameter in a batch."""
        nets = self._nets(shape.design.changed(complex_steps(shape.design, paths)))
        upper, lower = (np.imag(np.broadcast_to(net, (len(paths), *net.shape[-2:]))) / STEP for net in nets)
        return upper, lower

    def constraint_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """Derivatives of the section's infeasibility."""
        return infeasibility_rates(shape, paths, SINGLE_SECTION)

    def _nets(self, design: Any) -> tuple[Array, Array]:
        """Control points (..., n, 2) of both sides where the section stands [m]."""
        outline, turn = design.section.outline(SINGLE_SECTION), design.section.stagger(SINGLE_SECTION)
        inner = greville(self.knots, DEGREE)[3:-3]
        edges = outline.leading_edge, outline.trailing_edge
        nets = [
            _net(points, edges, name, self.knots)
            for points, name in zip(outline.points(inner), ("upper", "lower"), strict=True)
        ]
        metre = UNITS[design.length_unit]
        chord, x, y = (
            np.asarray(value)[..., None] * metre
            for value in (design.chord, design.leading_edge_x, design.leading_edge_y)
        )
        cosine, sine = np.cos(turn), np.sin(turn)
        placed = []
        for net in nets:
            a, b = net[..., 0], net[..., 1]
            points = [x + chord * (a * cosine - b * sine), y + chord * (a * sine + b * cosine)]
            placed.append(np.stack(np.broadcast_arrays(*points), axis=-1))
        return closed_nets(placed[0], placed[1], DEGREE, self.blunt)


def _net(points: Array, edges: tuple[Edge, Edge], name: str, knots: Reals) -> Array:
    """Control points (..., n, 2) of a side in chords, from its points (..., 1, n - 6, 2) between the edges."""
    starts = [getattr(edge, name) for edge in edges]
    batch = np.broadcast_shapes(points.shape[:-3], *[each.shape[:-2] for start in starts for each in start])
    rows = [EdgeDerivatives(*(np.broadcast_to(each, (*batch, 1, 2)) for each in start)) for start in starts]
    lines = np.broadcast_to(points, (*batch, *points.shape[-3:]))
    return interpolated_along_u(np.swapaxes(lines, -3, -2), rows[0], rows[1], knots)[..., 0, :]


def infeasibility_rates(shape: ModelShape, paths: Sequence[str], span: Span) -> Reals:
    """Derivatives (k, c) of the infeasibility of sections by every parameter."""
    found = np.zeros((len(paths), len(shape.constraints)))
    own = [i for i, path in enumerate(paths) if path.startswith("section.")]
    if len(shape.constraints) and own:
        design = shape.design.changed(complex_steps(shape.design, [paths[i] for i in own]))
        found[own] = np.imag(infeasibility(design.section, span)) / STEP
    return found


@model_of.register
def _(design: PlanarSection, tolerance: float | None = None) -> Model:
    return PlanarModel(design, tolerance)


SLOWEST_PACE = 0.003
"""smallest speed of a side's own parameter by s beside an edge, of its mean speed; at 0 the family refuses the side."""
OPENING_MARGIN = 0.003
"""smallest distance of an edge's opening from the largest one that the family allows."""


def infeasibility(part: Any, span: Span) -> Array:
    """By how much sections at places along the span are nearer to a refusal than they may be (..., c).

    Values above 0 violate the margin. Raises DesignError where the sections are refused already.
    """
    if isinstance(part, Segmented):
        return _turning_back(part.outline(span))
    if not isinstance(part, SuctionPressure):
        return np.zeros(0)
    edges = edge_points(part, span)
    rows = [_opening_excess(part, edge, span) for edge in ("leading_edge", "trailing_edge")]
    for side in sides(part, span, *edges):
        rows += [SLOWEST_PACE - side.own_parameter(end, CHECKED_AT, 1) for end in (0, 1)]
    shape = np.broadcast_shapes(*[each.shape[:-2] for each in rows])
    return np.concatenate([np.broadcast_to(each, (*shape, *each.shape[-2:])).reshape(*shape, -1) for each in rows], -1)


def _turning_back(outline: SegmentedOutline) -> Array:
    """By how much control points of segments lie ahead of the ones before them; those at the nose may (..., c)."""
    rows = []
    for side in outline.sides:
        for number, controls in enumerate(side.controls):
            x = controls[..., 2 if number == 0 else 0 :, 0]
            rows.append(x[..., :-1] - x[..., 1:])
    shape = np.broadcast_shapes(*[each.shape[:-1] for each in rows])
    return np.concatenate(
        [np.broadcast_to(each, (*shape, each.shape[-1])).reshape(*shape[:-1], -1) for each in rows], -1
    )


def _opening_excess(part: SuctionPressure, edge: str, span: Span) -> Array:
    """The same for the two ellipses of an edge (..., m, 2), by their opening."""
    stretch, skew, wedge = (span.values(getattr(part, f"{edge}_{each}")) for each in ("stretch", "skew", "wedge"))
    ratios = [opening(stretch * (1.0 + sign * skew), radians(wedge)) for sign in (1.0, -1.0)]
    return np.stack(np.broadcast_arrays(*ratios), axis=-1) - (MAX_OPENING[part.edges] - OPENING_MARGIN)
