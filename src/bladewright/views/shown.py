"""What `plot()` and a notebook show of each kind of result, by the name that the result says."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladewright.views.fit_data import FitResult
from bladewright.views.fit_deviations import draw_outline_deviation
from bladewright.views.fit_sheet import fit_sheet
from bladewright.views.html import Rows, frame, image, table
from bladewright.views.passage import draw_section_passage, figures, section_figures
from bladewright.views.picture import sheet
from bladewright.views.round_trip import RoundTripResult, face_rows, round_trip_figure, round_trip_rows
from bladewright.views.sections import draw_neighbour
from bladewright.views.style import axis, drawing_style, in_unit, lengths_in, per_metre, unit_name
from bladewright.views.view3d import blade_scene, fit_scene, passage_scene, view3d

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade
    from bladewright.display import Shown
    from bladewright.domain.passage import Passage
    from bladewright.domain.section import SectionPassage
    from bladewright.section.section import Section


@dataclass(frozen=True, kw_only=True)
class Kind:
    """How results of a kind are shown."""

    figure: Callable[[Any], Figure]
    html: Callable[[Any], str]
    unit: Callable[[Any], str] = lambda _: "mm"
    """its unit of length; millimetres of a section, which knows no design"""


def figure(shown: "Shown") -> Figure:
    """The figure of a result, laid out; pyplot does not know of it."""
    return KINDS[shown.shown_as].figure(shown)


def html(shown: "Shown") -> str:
    """Picture and table of a result, which load nothing."""
    kind = KINDS[shown.shown_as]
    with lengths_in(kind.unit(shown)):
        return kind.html(shown)


def blade_rows(blade: "Blade") -> Rows:
    """Size of a blade and how well it is built."""
    count, (along, across), unit = blade.design.blade_count, blade.knots.poles, unit_name()
    centroid = per_metre() * np.real(blade.properties.centroid)
    return [
        ("blades", "linear cascade" if count is None else str(count)),
        ("mean chord", in_unit(blade.chord, ".5g")),
        ("volume", f"{float(np.real(blade.properties.volume)) * per_metre() ** 3:.6g} {unit}³"),
        ("surface", f"{float(np.real(blade.properties.area)) * per_metre() ** 2:.6g} {unit}²"),
        ("centroid", f"{', '.join(f'{x:.4g}' for x in centroid)} {unit}"),
        ("faces", ", ".join(blade.surfaces)),
        ("poles of a side", f"{along} x {across}"),
        ("off the exact blade", f"{blade.error:.1e} of the chord"),
        ("promises", "all kept" if blade.conformance.kept else "NOT all kept"),
    ]


def section_rows(section: "Section") -> Rows:
    """Size and angles of a section."""
    thickest, place = section.maximum_thickness
    leading, trailing = (in_unit(radius) for radius in section.edge_radii)
    angles = ("stagger", "metal_angle_in", "metal_angle_out")
    return [
        ("chord", in_unit(np.real(section.chord), ".5g")),
        *((name.replace("_", " "), f"{np.degrees(getattr(section, name)):.4g}°") for name in angles),
        ("maximum thickness", f"{in_unit(thickest)} at {100.0 * place:.3g} % of the camber line"),
        ("leading edge", f"{section.edges[0]}, radius {leading}"),
        ("trailing edge", f"{section.edges[1]}, radius {trailing}"),
        ("area", f"{float(np.real(section.area)) * per_metre() ** 2:.5g} {unit_name()}²"),
        ("perimeter", in_unit(np.real(section.perimeter), ".5g")),
    ]


def fit_rows(fit: FitResult) -> tuple[Rows, Rows]:
    """Figures of a fit, and its deviations by region in the unit of the picture."""
    outliers = len(fit.inliers) - int(np.count_nonzero(fit.inliers))
    tolerance = [] if fit.tolerance is None else [("tolerance", in_unit(fit.tolerance, ".3g"))]
    rows = [
        ("points", f"{len(fit.cloud)}, {outliers} outliers"),
        ("free parameters", f"{len(fit.estimates)}, rank {fit.rank}"),
        ("noise of the cloud", in_unit(fit.noise, ".3g")),
        *tolerance,
        *(("", failure) for failure in fit.failures),
    ]
    names = ("mean", "rms", "percentile_99", "maximum")
    found = {"all inliers": fit.deviation, **fit.by_region}
    regions = [
        (name, str(of.count), *(f"{getattr(of, each) * per_metre():.3g}" for each in names))
        for name, of in found.items()
        if of.count
    ]
    return rows, regions


def _panel(draw: Callable[[Axes], None]) -> str:
    """A figure of one panel as an image."""
    with drawing_style(unit_name()):
        found = Figure(figsize=(6.0, 4.5), layout="constrained")
        draw(found.add_subplot())
    return image(found, "section")


def _blade(blade: "Blade") -> str:
    view = view3d(blade_scene(blade), blade.name)
    return frame(blade.name, view, table(blade_rows(blade)), type(blade.design).__name__)


def _passage(passage: "Passage") -> str:
    rows = [row if row[1] else row[:1] for row in figures(passage)]
    return frame(passage.name, view3d(passage_scene(passage), passage.name), table(rows), "flow passage")


def _section(section: "Section") -> str:
    drawn = _panel(lambda axes: draw_neighbour(axes, section, None, "Section"))
    where = f"at span {section.span:.4g}, in the plane {section.plane}"
    return frame("section", drawn, table(section_rows(section)), where)


def _section_passage(passage: "SectionPassage") -> str:
    rows = [row if row[1] else row[:1] for row in section_figures(passage)]
    return frame("section-passage", _panel(lambda axes: draw_section_passage(axes, passage)), table(rows))


def _fit(fit: FitResult) -> str:
    rows, regions = fit_rows(fit)
    header = (axis("deviation"), "points", "mean", "rms", "99 %", "largest")
    flat = fit.cloud.shape[-1] == 2
    drawn = _panel(lambda axes: draw_outline_deviation(axes, fit)) if flat else view3d(fit_scene(fit), fit.design.name)
    verdict = "passed" if fit.passed else "FAILED"
    return frame(fit.design.name, drawn, table(rows) + table(regions, header), f"fit, {verdict}")


def _round_trip(trip: RoundTripResult) -> str:
    report = trip.to_dict()
    rows = table(round_trip_rows(report)) + table(*face_rows(report))
    verdict = "passed" if report["passed"] else "FAILED"
    return frame(report["file"], image(round_trip_figure(report), "deviations"), rows, f"round trip, {verdict}")


KINDS: Mapping[str, Kind] = {
    "blade": Kind(figure=sheet, html=_blade, unit=lambda blade: blade.design.length_unit),
    "passage": Kind(figure=sheet, html=_passage, unit=lambda passage: passage.blade.design.length_unit),
    "section": Kind(figure=sheet, html=_section),
    "section passage": Kind(figure=sheet, html=_section_passage),
    "fit": Kind(figure=fit_sheet, html=_fit, unit=lambda fit: fit.design.length_unit),
    "round trip": Kind(figure=lambda trip: round_trip_figure(trip.to_dict()), html=_round_trip),
}
"""By the names that results say (`Shown.shown_as`)."""
