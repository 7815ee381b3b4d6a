"""T-Blade3's sections as parts of the curvature-meanline family: one each, or one with laws along the span."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bladewright.errors import DesignError, FileError
from bladewright.files.tblade3.angles import MetalAngles
from bladewright.files.tblade3.laws import law_through, laws_through
from bladewright.files.tblade3.leading_edges import Moved, moved_edges
from bladewright.files.tblade3.records import TBlade3Case
from bladewright.files.tblade3.sections import SectionValues
from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.edge_spline import EdgeSpline
from bladewright.section.meanline import CurvatureIntegral, CurvedMeanline, camber_scale
from bladewright.section.thickness.law import ThicknessLaw
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

CAMBERED = np.radians(1.0)
"""camber below which a meanline's own scale of its second derivative says little"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Parameters:
    """Numbers of the m sections of a case by their fields in the family, each array (m,) or, chordwise, (m, k)."""

    section: dict[str, Any]
    """fields of the section; an array is one number a section"""
    thickness: dict[str, Any]
    """fields of the thickness"""
    law: type[ThicknessLaw]
    edges: Moved | None = None
    """leading edges that are splines"""

    def of(self, index: int) -> CurvatureMeanline:
        """The part of one section, holding numbers; raises DesignError, naming the section, where it has none."""

        def one(value: Any) -> Any:
            if not isinstance(value, np.ndarray):
                return value
            return float(value[index]) if value.ndim == 1 else tuple(float(each) for each in value[index])

        try:
            return self._made(one)
        except DesignError as error:
            raise DesignError(f"section {index + 1}: {error}") from error

    def along(self, places: Reals) -> CurvatureMeanline:
        """The part of all sections, its laws along the span going through their numbers at places (m,)."""

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


def parameters(case: TBlade3Case, values: SectionValues, angles: MetalAngles) -> Parameters:
    """The numbers of a case's sections. Raises FileError for what the family does not have."""
    section: dict[str, Any] = {}
    if values.meanlines is None:
        section["camber"] = "mixed"
        inlet, end = _angles(angles)
    else:
        curves = _same(case, values.meanlines, "the curvature")
        places, curvature = curves[..., 0], curves[..., 1]
        inlet, end, scale = _turned(case, angles, places, curvature)
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
    found = Parameters(section={**angles_of, **section}, thickness=thickness, law=law)
    if values.leading_edges is None:
        return found
    alone = [found.of(i) for i in range(len(values.span))]
    return replace(found, edges=moved_edges(alone, values.leading_edges))


def _angles(angles: MetalAngles) -> tuple[Reals, Reals]:
    """Metal angles (m,) [rad] of mixed camber lines: a wing's, or as they are given."""
    if angles.inlet is not None and angles.exit is not None:
        return angles.inlet, angles.exit
    # half of the turning lies on each side of the chord line
    twist, camber = np.asarray(angles.stagger), np.asarray(angles.camber)
    return twist - 0.5 * camber, twist + 0.5 * camber


def _turned(case: TBlade3Case, angles: MetalAngles, places: Reals, curvature: Reals) -> tuple[Reals, Reals, Reals]:
    """Metal angles (m,) [rad] at inlet and exit, and the scale (m,) of the second derivative."""
    camber = np.asarray(angles.camber)
    integral = CurvatureIntegral(places=places, values=curvature)
    scale, largest = (np.real(each) for each in camber_scale(integral.totals, camber))
    missed = np.flatnonzero(np.isnan(scale))
    if len(missed):
        which = int(missed[0])
        most = float(np.degrees(np.broadcast_to(largest, scale.shape)[which]))
        raise FileError(
            f"'{case.file}': section {which + 1} has a camber of {np.degrees(camber[which]):.4g} deg, but a meanline "
            f"with its control points of the curvature turns by {most:.4g} deg at most: correct these, or its angles"
        )
    if angles.inlet is not None and angles.exit is not None:
        return angles.inlet, angles.exit, scale
    line = CurvedMeanline(curvature=integral, scale=scale)
    twist = np.asarray(angles.stagger)
    return twist + np.real(line.angle_in), twist + np.real(line.angle_out), scale


def _scaled(curvature: Reals, scale: Reals, camber: Reals) -> Reals:
    """Second derivatives as they are instead of as they stand in the file, where that says how they vary with span.

    Values that were given section by section need not have one scale, and what lies between would turn on that.
    """
    if np.ptp(curvature, axis=0).max() == 0.0:
        return curvature
    cambered = np.all(np.square(camber) > CAMBERED**2) and np.ptp(np.sign(camber)) == 0.0
    return curvature * scale[:, None] if cambered else curvature


def _same(case: TBlade3Case, curves: tuple[Reals, ...], what: str) -> Reals:
    """Control points (m, k, 2) of sections with equal numbers of them."""
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
    """The end of Wennerstrom's body without curvature: that farther from the maximum, in all sections the same one."""
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
