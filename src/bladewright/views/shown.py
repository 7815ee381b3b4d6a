"""What `plot()` and a notebook show of each kind of result, by the name that the result says."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladewright.views.body import BODIES, body_figures, body_scene
from bladewright.views.fit_data import FitResult
from bladewright.views.fit_deviations import draw_outline_deviation
from bladewright.views.fit_sheet import fit_sheet
from bladewright.views.html import Rows, frame, image, table, with_headings
from bladewright.views.masses import mass_rows
from bladewright.views.optimum import optimum_figure, optimum_rows
from bladewright.views.pareto import front_figure, front_rows
from bladewright.views.passage import draw_section_passage, figures, section_figures
from bladewright.views.picture import sheet
from bladewright.views.polar import polar_figure, polar_table
from bladewright.views.round_trip import round_trip_figure, round_trip_tables
from bladewright.views.runs import parallel_coordinates, run_rows
from bladewright.views.sections import draw_neighbour
from bladewright.views.station_table import station_figure, station_html
from bladewright.views.style import axis, drawing_style, in_unit, lengths_in, per_metre, unit_name
from bladewright.views.view3d import blade_scene, fit_scene, passage_scene, view3d

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade
    from bladewright.display import Shown
    from bladewright.section.section import Section


@dataclass(frozen=True, kw_only=True)
class Kind:
    """How results of a kind are shown."""

    figure: Callable[[Any], Figure]
    """what `plot()` returns"""
    picture: Callable[[Any], str]
    """HTML of the picture in a notebook"""
    tables: Callable[[Any], str]
    """HTML of the tables beside it"""
    title: Callable[[Any], tuple[str, str]]
    """name of a result, and a remark"""
    further: Callable[[Any, Sequence[float] | None], str] = lambda *_: ""
    """HTML of what stands under both, at stations where it has some"""
    unit: Callable[[Any], str] = lambda _: "mm"
    """its unit of length; millimetres of a section, which knows no design"""


def figure(shown: "Shown") -> Figure:
    """The figure of a result, laid out; pyplot does not know of it."""
    return KINDS[shown.shown_as].figure(shown)


def html(shown: "Shown") -> str:
    """Picture and table of a result, which load nothing."""
    kind = KINDS[shown.shown_as]
    with lengths_in(kind.unit(shown)):
        return frame(*kind.title(shown), kind.picture(shown), kind.tables(shown), kind.further(shown, None))


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
        *mass_rows(blade),
        ("faces", ", ".join(blade.surfaces)),
        ("poles of a side", f"{along} x {across}"),
        ("off the exact blade", f"{blade.error:.1e} of the chord"),
        ("checks", "all passed" if blade.conformance.kept else "NOT all passed"),
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


def _fit_picture(fit: FitResult) -> str:
    flat = fit.cloud.shape[-1] == 2
    return _panel(lambda axes: draw_outline_deviation(axes, fit)) if flat else view3d(fit_scene(fit), fit.design.name)


def _fit_tables(fit: FitResult) -> str:
    rows, regions = fit_rows(fit)
    return table(rows) + table(regions, (axis("deviation"), "points", "mean", "rms", "99 %", "largest"))


def _verdict(result: Any) -> str:
    return "passed" if result.passed else "FAILED"


KINDS: Mapping[str, Kind] = {
    "blade": Kind(
        figure=sheet,
        picture=lambda blade: view3d(blade_scene(blade), blade.name),
        tables=lambda blade: table(blade_rows(blade)),
        further=lambda blade, stations: station_html(blade.report(stations)),
        title=lambda blade: (blade.name, type(blade.design).__name__),
        unit=lambda blade: blade.design.length_unit,
    ),
    "passage": Kind(
        figure=sheet,
        picture=lambda passage: view3d(passage_scene(passage), passage.name),
        tables=lambda passage: table(with_headings(figures(passage))),
        title=lambda passage: (passage.name, "flow passage"),
        unit=lambda passage: passage.blade.design.length_unit,
    ),
    **{
        name: Kind(
            figure=sheet,
            picture=lambda body: view3d(body_scene(body), body.name),
            tables=lambda body: table(with_headings(body_figures(body))),
            title=lambda body: (body.name, body.shown_as),
            unit=lambda body: body.blade.design.length_unit,
        )
        for name in BODIES
    },
    "section": Kind(
        figure=sheet,
        picture=lambda section: _panel(lambda axes: draw_neighbour(axes, section, None, "Section")),
        tables=lambda section: table(section_rows(section)),
        title=lambda section: ("section", f"at span {section.span:.4g}, in the plane {section.plane}"),
    ),
    "section passage": Kind(
        figure=sheet,
        picture=lambda passage: _panel(lambda axes: draw_section_passage(axes, passage)),
        tables=lambda passage: table(with_headings(section_figures(passage))),
        title=lambda _: ("section-passage", "flow domain"),
    ),
    "stations": Kind(
        figure=station_figure,
        picture=station_html,
        tables=lambda _: "",
        title=lambda stations: (stations.name, "at stations along the span"),
        unit=lambda stations: stations.length_unit,
    ),
    "fit": Kind(
        figure=fit_sheet,
        picture=_fit_picture,
        tables=_fit_tables,
        title=lambda fit: (fit.design.name, f"fit, {_verdict(fit)}"),
        unit=lambda fit: fit.design.length_unit,
    ),
    "polar": Kind(
        figure=polar_figure,
        picture=lambda polar: image(polar_figure(polar), "polar"),
        tables=polar_table,
        title=lambda polar: (polar.name, "polar of the lone airfoil"),
    ),
    "round trip": Kind(
        figure=lambda trip: round_trip_figure(trip.to_dict()),
        picture=lambda trip: image(round_trip_figure(trip.to_dict()), "deviations"),
        tables=lambda trip: round_trip_tables(trip.to_dict()),
        title=lambda trip: (trip.file, f"round trip, {_verdict(trip)}"),
    ),
    "optimum": Kind(
        figure=optimum_figure,
        picture=lambda found: image(optimum_figure(found), "search"),
        tables=lambda found: table(optimum_rows(found), ("", "start", "found")),
        title=lambda found: (found.name, f"optimum, {_verdict(found)}"),
    ),
    "pareto": Kind(
        figure=lambda found: front_figure([found]),
        picture=lambda found: image(front_figure([found]), "front"),
        tables=lambda found: table(front_rows(found), ("", "lowest", "highest")),
        title=lambda found: (found.name, f"Pareto set of {len(found.members)} designs"),
    ),
    "runs": Kind(
        figure=parallel_coordinates,
        picture=lambda runs: image(parallel_coordinates(runs), "parallel coordinates"),
        tables=lambda runs: table(run_rows(runs), ("", "lowest", "mean", "highest")),
        title=lambda runs: (runs.name, f"{len(runs)} runs"),
    ),
}
"""By the names that results say (`Shown.shown_as`)."""
