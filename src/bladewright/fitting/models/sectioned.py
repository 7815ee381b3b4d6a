"""Blades from sections, as a search sees them."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, final

import numpy as np

from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.exact.cut_sectioned import exact_blade_of_sections
from bladewright.blade.native.blade import side_surface
from bladewright.blade.native.interpolation import edge_faces, native_sides
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.refinement import mean_chord, refined_knots
from bladewright.derivatives.complex_step import Nets
from bladewright.fitting.models.blunt_edges import BluntEdges, closed_nets, closed_with
from bladewright.fitting.models.model import Model, ModelShape, SpatialModel, model_of
from bladewright.fitting.models.planar import infeasibility, infeasibility_rates
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span

FEASIBILITY_SPAN = Span(np.linspace(0.0, 1.0, 5))
"""places along the span at which sections must stay feasible; each costs one more section a step"""


@final
class SectionedModel(SpatialModel):
    """A blade from sections of any family, at the knots that one design needs for a tolerance, of the chord."""

    def __init__(self, design: SectionedBlade, tolerance: float | None = None) -> None:
        own = replace(design, tolerance=design.tolerance if tolerance is None else tolerance)
        exact = exact_blade_of_sections(own, checked=False)
        self.chord = mean_chord(exact)
        self.knots: Knots = refined_knots(exact, self.chord)
        kinds = exact.survey.edge_kinds
        self.blunt: BluntEdges = kinds[0] == "blunt", kinds[1] == "blunt"

    def _shape(self, design: Any) -> ModelShape:
        exact = exact_blade_of_sections(design, self.knots, checked=False)
        stations = exact.sections(self.knots.sites_v)
        sides = [side_surface(net, self.knots, DEGREE) for net in native_sides(stations, self.knots)]
        faces = edge_faces(stations, sides[0], sides[1], self.knots) if any(self.blunt) else {}
        upper, lower = closed_with(sides[0], sides[1], faces)
        constraints = np.real(infeasibility(design.section, FEASIBILITY_SPAN))
        return ModelShape(design=design, sides=(upper, lower), exact=exact, constraints=constraints)

    def _closed(self, upper: Reals, lower: Reals) -> Nets:
        """With a face of a blunt edge that moves as the straight one between its edges."""
        if not any(self.blunt):
            return upper, lower
        rates = closed_nets(np.moveaxis(upper, 1, -2), np.moveaxis(lower, 1, -2), DEGREE, self.blunt)
        return np.moveaxis(rates[0], -2, 1), np.moveaxis(rates[1], -2, 1)

    def constraint_rates(self, shape: ModelShape, paths: Sequence[str]) -> Reals:
        """Derivatives of the sections' infeasibility."""
        return infeasibility_rates(shape, paths, FEASIBILITY_SPAN)


@model_of.register
def _(design: SectionedBlade, tolerance: float | None = None) -> Model:
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        return SectionedModel(design, tolerance)
