"""A round trip as picture and tables: how far each face of the reopened file is from the native one."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bladewright.domain.row import of_every_blade
from bladewright.views.html import Rows, table
from bladewright.views.pages import Page, with_fixed_layout
from bladewright.views.style import BLUE, RED, SOFT, drawing_style, label_axes

Report = Mapping[str, Any]
"""A round trip as its JSON has it."""
LIMITS = {"side_mm": "--", "end_mm": ":"}
"""Limits of deviations by their keys, and the styles of their lines."""
LEAST = 1e-16
"""Shortest bar [mm]: what is exact has no place on an axis of powers of ten."""


def round_trip_figure(report: Report) -> Figure:
    """Largest deviation of each face, and of the edges, beside their limits."""
    limits, faces = report["limits"], worst_faces(report)
    bars = [*((face["name"], face["max_deviation_mm"]) for face in faces), ("edges", report["edges"]["max_gap_mm"])]
    with drawing_style():
        figure = Page(figsize=(6.0, 1.2 + 0.28 * len(bars)), layout="constrained")
        axes = figure.add_subplot()
        names, values = zip(*bars, strict=True)
        failed = " ".join(of_every_blade(word) for failure in report["failures"] for word in failure.split())
        colours = [RED if name in failed else BLUE for name in names]
        axes.barh(np.arange(len(bars)), np.maximum(values, LEAST), left=0.0, color=colours, height=0.6)
        axes.set_yticks(np.arange(len(bars)), [name.replace("_", " ") for name in names])
        axes.invert_yaxis()
        axes.set_xscale("log")
        for name, style in LIMITS.items():
            words = f"limit of {name.removesuffix('_mm')}s, {limits[name]:.3g} mm"
            axes.axvline(limits[name], color=SOFT, linestyle=style, label=words)
        axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.25 / (0.3 + 0.1 * len(bars))), ncols=2)
        label_axes(axes, "Reopened file off the native faces", "largest deviation [mm], logarithmic", "")
        return with_fixed_layout(figure)


def round_trip_rows(report: Report) -> Rows:
    """What the file holds, and its volume, area and centroid beside the native ones."""
    kind = " ".join(word for word in (report["format"], report["schema"]) if word)
    volume, area, edges = report["volume_mm3"], report["area_mm2"], report["edges"]
    valid = "valid" if report["valid"] else "INVALID"
    shown, faults = volume.get("kernel_default"), report.get("kernel_check")
    faulty = ", ".join(f"{fault['fault']} ({fault['count']})" for fault in faults or ())
    others = [] if shown is None else [("in FreeCAD", f"{shown['cad']:.8g} mm³, {shown['relative_error']:.1e} off")]
    others += [] if faults is None else [("its check finds", faulty or "nothing")]
    return [
        ("file", f"{report['file']} ({kind}, {report['unit']})"),
        ("verdict", "passed" if report["passed"] else "FAILED"),
        *(("", failure) for failure in report["failures"]),
        ("holds", f"{report['solids']} solid, {report['shells']} shell, {report['free_edges']} free edges, {valid}"),
        *placement_rows(report),
        ("volume", f"{volume['cad']:.8g} mm³, {volume['relative_error']:.1e} off"),
        *others,
        ("surface", f"{area['cad']:.8g} mm², {area['relative_error']:.1e} off"),
        ("centroid", f"{report['centroid_mm']['distance']:.1e} mm off"),
        ("edges", f"{edges['count']}, gap {edges['max_gap_mm']:.1e} mm, tolerance {edges['max_tolerance_mm']:.1e} mm"),
    ]


def worst_faces(report: Report) -> list[Report]:
    """The faces; of those that a wheel has for every blade the one with the largest deviation, as `blade_*_upper`."""
    worst: dict[str, Report] = {}
    for face in report["faces"]:
        name = of_every_blade(face["name"])
        if name not in worst or face["max_deviation_mm"] > worst[name]["max_deviation_mm"]:
            worst[name] = {**face, "name": name}
    return list(worst.values())


def placement_rows(report: Report) -> Rows:
    """How far the blades of a row are from their places."""
    away = [each["displacement_mm"] for each in report.get("placements", ())]
    return [("placements", f"{len(away)}, at most {max(away):.1e} mm off")] if away else []


def round_trip_tables(report: Report) -> str:
    """Both as HTML: the whole, and a row for each face."""
    header = ("face", "largest [mm]", "mean [mm]", "area [mm²]", "area off")
    faces = [
        (
            face["name"],
            f"{face['max_deviation_mm']:.1e}",
            f"{face['mean_deviation_mm']:.1e}",
            f"{face['area_mm2']['cad']:.6g}",
            f"{face['area_mm2']['relative_error']:.1e}",
        )
        for face in worst_faces(report)
    ]
    return table(round_trip_rows(report)) + table(faces, header)
