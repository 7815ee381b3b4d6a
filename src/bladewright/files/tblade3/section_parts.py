"""The sections of a T-Blade3 case as curvature-meanline sections, one by one or as laws along the span.

The laws take T-Blade3's values at its sections, to rounding. The sections stand at those span fractions at which a
cubic spline through them has the knots of a law with as many control points: so the law through all sections is their
cubic spline with not-a-knot ends, whatever their spans are. The span fraction of such a design counts sections; it is
not their radius.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from bladewright.designs import ChordwiseLaw, Law
from bladewright.errors import DesignError, FileError
from bladewright.files.tblade3.case import TBlade3Case
from bladewright.files.tblade3.section_values import MetalAngles, SectionValues
from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.edge_spline import NARROW, EdgeSpline
from bladewright.section.laws import DEGREE, Span, law_basis
from bladewright.section.meanline import CurvedMeanline
from bladewright.section.thickness.law import ThicknessLaw
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

LAW_TOLERANCE = 1e-13
"""Deviation of a law from its values, as a fraction of the largest, that counts as rounding: some hundred times the
precision of a double, for the solution of a linear system of some ten equations."""

ROUNDING = 1e-15
"""Control points smaller than this fraction of the largest value are set to 0: a few times the precision of a
double."""
NEAREST_CONTACT, FARTHEST_CONTACT = 0.021, 0.49
"""Least and largest s of the contact of a leading edge spline, just within the limits 0.02 and 0.5 of the family."""
BISECTIONS = 60
"""Bisections for the s of a contact: more than the 53 bits of a double."""
CAMBERED = np.radians(1.0)
"""[rad] Camber below which the scale of a meanline's second derivative is a quotient of small numbers, and is not used
to relate one section to another."""


def section_places(spans: Reals, *further: Reals) -> Reals:
    """Span fractions (m,) of the design for sections with given spans (m,), from 0 to 1.

    `further` are other measures (m,) of the same sections, such as their distances along the other edge. The second and
    the last section but one are put as near to the ends as the smallest measure has them: through sections that are
    closer together than their span fractions say, a cubic spline would overshoot and stream surfaces would cross.
    """
    count = len(spans)
    rising = bool(np.all(np.diff(spans) > 0.0))
    if count <= DEGREE + 1:
        return spans if rising else np.linspace(0.0, 1.0, count)
    knots = np.linspace(0.0, 1.0, count - DEGREE + 1)
    measures = [each for each in (spans, *further) if np.all(np.diff(each) > 0.0)]
    first = min([(each[1] - each[0]) / (each[2] - each[0]) for each in measures], default=0.5)
    last = min([(each[-1] - each[-2]) / (each[-1] - each[-3]) for each in measures], default=0.5)
    second, last_but_one = first * knots[1], 1.0 - last * (1.0 - knots[-2])
    return np.concatenate([[0.0, second], knots[1:-1], [last_but_one, 1.0]])


def law_through(values: Reals, places: Reals) -> Law:
    """The law with the fewest control points, at most m, that has values (m,) at span fractions (m,) to rounding."""
    scale = max(float(np.max(np.abs(values))), 1e-300)
    if np.ptp(values) <= LAW_TOLERANCE * scale:
        return float(values[len(values) // 2])
    for count in range(2, len(values)):
        rows = law_basis(count, places)
        controls: Reals = np.asarray(np.linalg.lstsq(rows, values, rcond=None)[0], dtype=np.float64)
        if np.max(np.abs(rows @ controls - values)) <= LAW_TOLERANCE * scale:
            return _plain(controls, scale)
    return _plain(np.asarray(np.linalg.solve(law_basis(len(values), places), values), dtype=np.float64), scale)


def _plain(controls: Reals, scale: float) -> Law:
    """Control points, set to 0 where they are rounding errors, whose sign a parameter might not allow."""
    return tuple(0.0 if abs(each) < ROUNDING * scale else float(each) for each in controls)


def laws_through(values: Reals, places: Reals) -> ChordwiseLaw:
    """Laws through values (m, k): k of them, one for each control point along the chord."""
    return tuple(law_through(column, places) for column in values.T)


class TranslatedEdges(NamedTuple):
    """The leading edge splines of m sections as the curvature-meanline family has them."""

    contact: float
    """s of the contact with the sides, the same for all sections"""
    elongation: Reals
    """(m,)"""
    droop: Reals
    """(m,)"""


def translated_edges(parts: list[CurvatureMeanline], table: Reals) -> TranslatedEdges:
    """The leading edge splines of sections that have none yet, from T-Blade3's 13 numbers of each (m, 13).

    The contact is where the thickness, without its multiplier, reaches that of the edge; all sections share the mean of
    these s. T-Blade3's tip lies (1 + ee) half thicknesses ahead of the contact, and droop (1 + ee) of them to the side.
    """
    contact = float(np.mean([_contact(part, 0.5 * row[0]) for part, row in zip(parts, table, strict=True)]))
    # the contact moves to a joint close downstream, so that the spline does not continue a piece that ends there
    for joint in sorted({each.s for part in parts for each in part.unsplined(Span(np.zeros(1))).joints}):
        contact = joint if contact < joint < contact + NARROW else contact
    elongation = []
    for part, row in zip(parts, table, strict=True):
        edge = EdgeSpline(contact=contact).applied(part.unsplined(Span(np.zeros(1))), Span(np.zeros(1)))
        upper, lower = (np.real(side)[0, 0] for side in edge.outline.points(np.array([contact])))
        half = 0.5 * float(np.sqrt(np.sum((upper - lower) ** 2)))
        distance = float(np.sqrt(np.sum((0.5 * (upper + lower)) ** 2)))
        elongation.append(1.0 + row[3] - distance / half)
    # the family's droop is positive towards the lower side, T-Blade3's deflection towards the upper
    return TranslatedEdges(contact, np.array(elongation), -table[:, 2] * (1.0 + table[:, 3]))


def _contact(part: CurvatureMeanline, half: float) -> float:
    """The smallest s at which the half thickness without its multiplier reaches a value."""
    thickness = part.thickness.at(Span(np.zeros(1)))
    s = np.linspace(0.0, FARTHEST_CONTACT, 257)
    reached = np.flatnonzero(np.real(thickness.half(s))[0] >= half)
    if len(reached) == 0 or reached[0] == 0:
        return FARTHEST_CONTACT if len(reached) == 0 else NEAREST_CONTACT
    low, high = s[reached[0] - 1], s[reached[0]]
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = np.real(thickness.half(np.array([middle])))[0, 0] < half
        low, high = (middle, high) if below else (low, middle)
    return float(np.clip(high, NEAREST_CONTACT, FARTHEST_CONTACT))


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionParameters:
    """The parameters of the m sections of a case by name of field: arrays (m,), or (m, k) along the chord."""

    section: dict[str, Any]
    """fields of the section; what is no array is the same for all sections"""
    thickness: dict[str, Any]
    """fields of the thickness law"""
    law: type[ThicknessLaw]
    """class of the thickness law"""
    edges: TranslatedEdges | None = None
    """leading edge splines"""

    def of(self, index: int) -> CurvatureMeanline:
        """One section with its numbers; raises DesignError, naming the section, where they make none."""

        def one(value: Any) -> Any:
            if not isinstance(value, np.ndarray):
                return value
            return float(value[index]) if value.ndim == 1 else tuple(float(each) for each in value[index])

        try:
            return self._made(one)
        except DesignError as error:
            raise DesignError(f"section {index + 1}: {error}") from error

    def along(self, places: Reals) -> CurvatureMeanline:
        """All sections as one, with laws along the span through their numbers at span fractions (m,)."""

        def law(value: Any) -> Any:
            if not isinstance(value, np.ndarray):
                return value
            return law_through(value, places) if value.ndim == 1 else laws_through(value, places)

        return self._made(law)

    def _made(self, kind: Any) -> CurvatureMeanline:
        thickness = self.law(**{name: kind(value) for name, value in self.thickness.items()})
        edge = None
        if self.edges is not None:
            contact, elongation, droop = self.edges
            edge = EdgeSpline(contact=contact, elongation=kind(elongation), droop=kind(droop))
        return CurvatureMeanline(
            thickness=thickness,  # type: ignore[arg-type]
            leading_edge_spline=edge,
            **{name: kind(value) for name, value in self.section.items()},
        )


def section_parameters(case: TBlade3Case, values: SectionValues, angles: MetalAngles) -> SectionParameters:
    """The parameters of a case's sections. Raises FileError for what the family does not have."""
    section: dict[str, Any] = {}
    if values.meanlines is None:
        section["camber"] = "mixed"
        inlet, end = _mixed_meanline_angles(angles)
    else:
        curves = _same(case, values.meanlines, "the curvature")
        places, curvature = curves[..., 0], curves[..., 1]
        inlet, end, scale = _curved_meanline_angles(case, angles, places, curvature)
        if case.meanlines is not None and case.meanlines.span is None:
            curvature = _scaled(curvature, scale, end - inlet)
        section["curvature"] = curvature
        section["curvature_places"] = places[:, 1:-1]
    if values.multipliers is not None:
        multiplied = _same(case, values.multipliers, "the thickness multiplier")
        section["thickness_multiplier"] = multiplied[..., 1]
        section["thickness_multiplier_places"] = multiplied[:, 1:-1, 0]
    law, thickness = _thickness(case, values)
    angles_of = {"metal_angle_in": np.degrees(inlet), "metal_angle_out": np.degrees(end)}
    found = SectionParameters(section={**angles_of, **section}, thickness=thickness, law=law)
    if values.leading_edges is None:
        return found
    alone = [found.of(i) for i in range(len(values.span))]
    return replace(found, edges=translated_edges(alone, values.leading_edges))


def _mixed_meanline_angles(angles: MetalAngles) -> tuple[Reals, Reals]:
    """Metal angles (m,) [rad] at inlet and exit of mixed camber lines: as given, or those of a wing."""
    if angles.inlet is not None and angles.exit is not None:
        return angles.inlet, angles.exit
    # half of the turning lies on each side of the chord line
    twist, camber = np.asarray(angles.stagger), np.asarray(angles.camber)
    return twist - 0.5 * camber, twist + 0.5 * camber


def _curved_meanline_angles(
    case: TBlade3Case, angles: MetalAngles, places: Reals, curvature: Reals
) -> tuple[Reals, Reals, Reals]:
    """Metal angles (m,) [rad] at inlet and exit of meanlines by curvature, and the scale (m,) of the curvature."""
    camber = np.asarray(angles.camber)
    line = CurvedMeanline(places=places, values=curvature, camber=camber)
    scale = np.real(line.scale)
    missed = np.flatnonzero(np.isnan(scale))
    if len(missed):
        which = int(missed[0])
        most = float(np.degrees(np.broadcast_to(line.largest_camber, scale.shape)[which]))
        raise FileError(
            f"'{case.file}': section {which + 1} has a camber of {np.degrees(camber[which]):.4g} deg, but a meanline "
            f"with its control points of the curvature turns by {most:.4g} deg at most: correct these, or its angles"
        )
    if angles.inlet is not None and angles.exit is not None:
        return angles.inlet, angles.exit, scale
    twist = np.asarray(angles.stagger)
    return twist + np.real(line.angle_in), twist + np.real(line.angle_out), scale


def _scaled(curvature: Reals, scale: Reals, camber: Reals) -> Reals:
    """Second derivatives of the meanlines, multiplied by their scale where control points are given section by section.

    Such control points need not be of one scale, but what lies between two sections would depend on it.
    """
    if np.ptp(curvature, axis=0).max() == 0.0:
        return curvature
    cambered = np.all(np.square(camber) > CAMBERED**2) and np.ptp(np.sign(camber)) == 0.0
    return curvature * scale[:, None] if cambered else curvature


def _same(case: TBlade3Case, curves: tuple[Reals, ...], what: str) -> Reals:
    """Control points (m, k, 2) of all sections; FileError where their numbers differ."""
    counts = [len(curve) for curve in curves]
    if len(set(counts)) > 1:
        odd = next(i for i, count in enumerate(counts) if count != counts[0])
        raise FileError(
            f"'{case.companion}': section {odd + 1} has {counts[odd]} control points of {what}, section 1 has "
            f"{counts[0]}: sections of one design need equal numbers, so that each varies along the span; give them so"
        )
    return np.stack(curves)


def _thickness(case: TBlade3Case, values: SectionValues) -> tuple[type[ThicknessLaw], dict[str, Any]]:
    shared: dict[str, Any] = {
        "maximum_thickness": values.thickness,
        "maximum_thickness_at": values.thickest,
    }
    if case.thickness == "naca":
        sharp = _none(values.trailing_thickness)
        found = {"leading_edge_index": np.asarray(values.leading_index), **shared}
        if not sharp:
            found["trailing_edge_thickness"] = values.trailing_thickness
        if values.trailing_slope is not None:
            found["trailing_edge_slope"] = values.trailing_slope
        return ModifiedNaca, {**found, "trailing_edge": "sharp" if sharp else "circular"}
    edges = {"leading_edge_thickness": np.asarray(values.leading_thickness)}
    edges["trailing_edge_thickness"] = values.trailing_thickness
    if case.thickness == "wennerstrom":
        for name in ("leading_edge", "trailing_edge"):
            if _none(edges[f"{name}_thickness"]):
                del edges[f"{name}_thickness"]
                shared[name] = "sharp"
        return Wennerstrom, {**shared, **edges, "straight_end": _straight_end(case, values)}
    shared["trailing_edge"] = "sharp" if case.thickness == "quartic-sharp" else "closed"
    return QuarticSpline, {**shared, **edges}


def _none(thickness: Reals) -> bool:
    return bool(np.all(thickness == 0.0))


def _straight_end(case: TBlade3Case, values: SectionValues) -> str:
    """The end of Wennerstrom's thickness without curvature, farther from the maximum; the same in all sections."""
    before = values.thickest < 0.5
    if np.all(before) or not np.any(before):
        return "trailing" if before[0] else "leading"
    if np.array_equal(np.asarray(values.leading_thickness), values.trailing_thickness):
        return "farther"
    odd = int(np.flatnonzero(before != before[0])[0])
    raise FileError(
        f"'{case.file}': the maximum thickness stands before mid-chord in some sections and behind it in others (from "
        f"section {odd + 1} on), with edges of different thickness: T-Blade3 changes the cubics' end conditions there, "
        "so that between two sections the shape would jump; keep the maxima on one side of 0.5, or give both edges one "
        "thickness"
    )
