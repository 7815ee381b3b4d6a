"""Deviations of a fit: over the unwrapped blade, beside sections magnified, and at the edges to scale."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.ticker import FixedLocator, FuncFormatter

from bladewright.nurbs.basis import Reals
from bladewright.views.fit_data import (
    BLUNT_FACES,
    DEVIATION_COLOURS,
    ROUND_NUMBERS,
    SIDES,
    WORST_POINTS,
    DrawnSection,
    FitResult,
    Index,
    colour_scale,
    count_of,
    cross_out,
    deviations_mm,
    on_sides,
    points_to_draw,
)
from bladewright.views.sections import coordinates, edge_half_width, edge_size
from bladewright.views.style import INK, PALE, SOFT, axis, in_unit, label_axes, per_metre, unit_name

MAP_POINTS = 20_000
"""Most points that are drawn on the map one by one; of more, the mean of each cell is drawn, as dots would cover each
other."""
CELL_POINTS = 10
"""Points per cell of the map in the mean, which averages noise to about a third."""
MAX_CELLS = 320
"""Most cells along the outline of the map: more are smaller than what its panel shows."""
ABSCISSA = "u:  trailing edge  ←  lower side  →  leading edge  ←  upper side  →  trailing edge"
INSIDE, OUTSIDE = "#2f7fb5", "#c4553f"
"""Colours of deviations into and out of the section."""
MARKER, SMALL_MARKER = 2.6, 1.2
"""Sizes of the marks of few and of many points [points]."""
TOLERANCE_SHARE = 0.4
"""Largest distance, in largest thicknesses of the section, at which the tolerance is drawn inside it: a line further
inside would fold at the edges."""
LEAST_EDGE_WINDOW = 0.01
"""Least half width of the close-up of an edge, in chords."""
CROSSED_OUTLIERS = 60
"""Most outliers beside a section that are all crossed; of more, those beyond the panel are left out, as they would line
its border."""
SECTION_POINTS = 4000
"""Most points drawn beside a section: more make the file large and add nothing that can be seen."""
DRAWN_HEIGHT = 0.035
"""Largest height, in chords, with which deviations are drawn, but for the largest hundredth of them: the shape of the
section stays clear."""


def draw_map(axes: Axes, fit: FitResult) -> None:
    """Draw the signed deviations of a blade over u and v."""
    scale = colour_scale(fit)
    axes.set_facecolor(PALE)
    axes.grid(visible=False)
    sides = on_sides(fit) & fit.inliers
    total = int(np.count_nonzero(sides))
    if total > MAP_POINTS:
        _draw_cells(axes, fit, np.flatnonzero(sides), scale)
        drawn = points_to_draw(fit, sides, WORST_POINTS * 2)[-WORST_POINTS:]
        caption = f"mean in each cell of {count_of(total, 'point')}, the {WORST_POINTS} farthest as dots"
    else:
        drawn = points_to_draw(fit, sides, MAP_POINTS)
        caption = f"{count_of(total, 'point')} on the sides"
    size = float(np.clip(1.6e5 / max(total, 1), 5.0, 60.0)) if total <= MAP_POINTS else 7.0
    dots: dict[str, Any] = {"s": size, "cmap": DEVIATION_COLOURS, "norm": scale, "rasterized": True}
    places = abscissae(fit, drawn), fit.v[drawn]
    axes.scatter(*places, c=deviations_mm(fit, drawn), linewidths=0.25, edgecolors=INK, **dots)
    outliers = np.flatnonzero(on_sides(fit) & ~fit.inliers)
    caption += _cross_map_outliers(axes, fit, outliers, fit.v[outliers])
    others = int(np.count_nonzero(~on_sides(fit)))
    if others:
        caption += f"; {count_of(others, 'point')} on ends and blunt edges not shown"
    _label_map(axes)
    axes.set_ylim(-0.03, 1.03)
    label_axes(axes, "Deviation from the blade", f"{ABSCISSA}\n{caption}", "span v [-]")
    bar = axes.figure.colorbar(
        ScalarMappable(norm=scale, cmap=DEVIATION_COLOURS), ax=axes, extend="both", pad=0.012, aspect=28
    )
    bar.set_label(f"inside the blade  ←  deviation [{unit_name()}]  →  outside")
    bar.outline.set_visible(False)


def draw_outline_deviation(axes: Axes, fit: FitResult) -> None:
    """Draw the signed deviations of a section over u; outliers are held at the border of the panel."""
    scale = colour_scale(fit)
    total = int(np.count_nonzero(fit.inliers))
    drawn = points_to_draw(fit, fit.inliers, MAP_POINTS)
    most = max(float(np.max(np.abs(fit.deviations[fit.inliers]), initial=0.0)), fit.tolerance or 0.0) * per_metre()
    limit = 1.25 * (most if most > 0.0 else 1.0)
    caption = f"{count_of(total, 'point')}"
    if len(drawn) < total:
        caption += f", {len(drawn):,} of them drawn with the {WORST_POINTS} farthest"
    size = float(np.clip(2e4 / max(len(drawn), 1), 4.0, 30.0))
    dots: dict[str, Any] = {"s": size, "cmap": DEVIATION_COLOURS, "norm": scale, "rasterized": len(drawn) > 2000}
    values = deviations_mm(fit, drawn)
    axes.scatter(
        abscissae(fit, drawn), values, c=values, linewidths=0.35 if len(drawn) < 2000 else 0.0, edgecolors=INK, **dots
    )
    outliers = np.flatnonzero(~fit.inliers)
    clipped = np.clip(deviations_mm(fit, outliers), -0.95 * limit, 0.95 * limit)
    caption += _cross_map_outliers(axes, fit, outliers, clipped)
    axes.axhline(0.0, color=INK, linewidth=0.9)
    if fit.tolerance is not None:
        for sign in (-1.0, 1.0):
            axes.axhline(sign * fit.tolerance * per_metre(), color=SOFT, linewidth=1.0, linestyle="--")
        caption += f"; dashed: the tolerance, {in_unit(fit.tolerance, '.3g')}"
    _label_map(axes)
    axes.set_ylim(-limit, limit)
    label_axes(axes, "Deviation from the section", f"{ABSCISSA}\n{caption}", axis("deviation, outside positive"))


def abscissae(fit: FitResult, index: Index) -> Reals:
    """u of points on the upper side, -u of those on the lower one; the face of a blunt edge is at the edge."""
    places = fit.places[index]
    u = np.where(places == "leading_edge", 0.0, np.where(places == "trailing_edge", 1.0, fit.u[index]))
    return np.where(places == "lower", -u, u)


def _cross_map_outliers(axes: Axes, fit: FitResult, index: Index, ordinate: Reals) -> str:
    """Draw crosses for the outliers; return the words that say how many they are."""
    if len(index) == 0:
        return ""
    cross_out(axes, abscissae(fit, index), ordinate, 200)
    return f", {count_of(len(index), 'outlier')} crossed"


def _draw_cells(axes: Axes, fit: FitResult, index: Index, scale: Normalize) -> None:
    along = int(np.clip(np.sqrt(4.0 * len(index) / CELL_POINTS), 40, MAX_CELLS))
    shape = along, along // 4
    edges = np.linspace(-1.0, 1.0, shape[0] + 1), np.linspace(0.0, 1.0, shape[1] + 1)
    cell = [
        np.clip(np.searchsorted(ends, at, side="right") - 1, 0, count - 1)
        for ends, at, count in zip(edges, (abscissae(fit, index), fit.v[index]), shape, strict=True)
    ]
    flat = np.ravel_multi_index((cell[0], cell[1]), shape)
    number = np.bincount(flat, minlength=shape[0] * shape[1])
    total = np.bincount(flat, weights=deviations_mm(fit, index), minlength=len(number))
    mean = np.ma.masked_where(number == 0, total / np.maximum(number, 1)).reshape(shape)
    axes.pcolormesh(*edges, mean.T, cmap=DEVIATION_COLOURS, norm=scale, rasterized=True)


def _label_map(axes: Axes) -> None:
    axes.set_xlim(-1.01, 1.01)
    axes.axvline(0.0, color=SOFT, linewidth=0.9, zorder=0.9)
    axes.xaxis.set_major_locator(FixedLocator(np.linspace(-1.0, 1.0, 11).tolist()))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{abs(value):g}"))


def magnification(fit: FitResult) -> float:
    """A round factor by which deviations are magnified beside a section."""
    size = np.abs(fit.deviations[fit.inliers])
    most = float(np.percentile(size, 99.0)) if len(size) else 0.0
    if most <= 0.0:
        return 1.0
    factor = DRAWN_HEIGHT * float(np.real(fit.built.chord)) / most
    decade = 10.0 ** np.floor(np.log10(factor))
    steps = [each for each in ROUND_NUMBERS if each in {1.0, 2.0, 5.0}]
    return max(1.0, float(max(each for each in steps if each * decade <= factor * (1.0 + 1e-9)) * decade))


def draw_magnified(axes: Axes, fit: FitResult, outline: DrawnSection, name: str) -> None:
    """Draw a section with the deviations of the points near it magnified, and outliers crossed.

    Outliers further off are crossed at 8 % of the chord; where there are many, only those nearer are crossed.
    """
    factor = magnification(fit)
    axes.fill(*outline.closed.T, color=PALE, linewidth=0.0)
    _draw_tolerance(axes, fit, outline, factor)
    drawn = points_to_draw(fit, outline.points & fit.inliers, SECTION_POINTS)
    deviation = deviations_mm(fit, drawn)
    footpoints, normals = outline.footpoints(fit, drawn)
    tips = footpoints + normals * (factor * deviation)[:, None]
    many = len(drawn) > 1000
    for colour, part in ((INSIDE, deviation < 0.0), (OUTSIDE, deviation >= 0.0)):
        lines = list(np.stack([footpoints[part], tips[part]], axis=1))
        axes.add_collection(LineCollection(lines, colors=colour, linewidths=0.4 if many else 0.9, rasterized=many))
        size = SMALL_MARKER if many else MARKER
        x, y = tips[part].T
        axes.plot(
            x, y, color=colour, linestyle="none", marker="o", rasterized=many, markersize=size, markeredgewidth=0.0
        )
    axes.plot(*outline.closed.T, color=INK, linewidth=1.0)
    _cross_outliers(axes, fit, outline, factor, 0.08 * float(outline.section.chord) * per_metre())
    abscissa, ordinate = coordinates(outline.section.plane)
    caption = "" if fit.tolerance is None else f", dashed: the tolerance × {factor:g}"
    label_axes(axes, f"{name}, deviations × {factor:g}", f"{abscissa}{caption}", ordinate)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06)


def draw_edge_points(axes: Axes, fit: FitResult, outline: DrawnSection, *, trailing: bool, where: str) -> None:
    """Draw a close-up of the leading or the trailing edge of a section, with the points there to scale."""
    section = outline.section
    size, description = edge_size(section, trailing=trailing)
    end = -1 if trailing else 0
    tip = 0.5 * (outline.sides["upper"][end] + outline.sides["lower"][end])
    inwards = outline.inwards(trailing=trailing)
    chord = float(section.chord) * per_metre()
    region = fit.by_region.get(f"{'trailing' if trailing else 'leading'} edge")
    # Where the fitted edge is far too sharp, the panel must still show how far off the points are.
    least = max(LEAST_EDGE_WINDOW * chord, 1.5 * region.maximum * per_metre() if region else 0.0)
    half_width = max(edge_half_width(section, size), least)
    middle = tip + 0.6 * half_width * inwards
    axes.fill(*outline.closed.T, color=PALE, linewidth=0.0)
    _draw_tolerance(axes, fit, outline, 1.0)
    # The range of u that the panel shows.
    in_panel = [np.max(np.abs(side - middle), axis=-1) <= 1.2 * half_width for side in outline.sides.values()]
    span = float(np.max(np.abs(outline.u - float(trailing))[in_panel[0] | in_panel[1]]))
    visible = np.zeros_like(outline.points)
    ahead = np.isin(fit.places, BLUNT_FACES) | (fit.u >= 1.0 - span if trailing else fit.u <= span)
    candidates = np.flatnonzero(outline.points & fit.inliers & ahead)
    visible[candidates[np.max(np.abs(_places(fit, outline, candidates) - middle), axis=-1) <= 1.05 * half_width]] = True
    drawn = points_to_draw(fit, visible, SECTION_POINTS)
    positions = _places(fit, outline, drawn)
    # Many points would hide the outline, so it is drawn over them.
    axes.plot(*outline.closed.T, color=INK, linewidth=1.2, zorder=3.5 if len(drawn) > 1000 else 2.5)
    dot = float(np.clip(6e3 / max(len(drawn), 1), 3.0, 26.0))
    axes.scatter(
        positions[:, 0],
        positions[:, 1],
        s=dot,
        c=deviations_mm(fit, drawn),
        cmap=DEVIATION_COLOURS,
        norm=colour_scale(fit),
        linewidths=0.4 if len(drawn) < 1000 else 0.0,
        edgecolors=INK,
        zorder=3.0,
        rasterized=len(drawn) > 1500,
    )
    _cross_outliers(axes, fit, outline, 1.0, np.inf)
    axes.set_xlim(middle[0] - half_width, middle[0] + half_width)
    axes.set_ylim(middle[1] - half_width, middle[1] + half_width)
    axes.set_aspect("equal", adjustable="box", anchor="N")
    edge = "Trailing" if trailing else "Leading"
    abscissa, ordinate = coordinates(section.plane)
    caption = f"{count_of(int(np.count_nonzero(visible)), 'point')}, {description}"
    label_axes(
        axes, f"{edge} edge{where}", f"{abscissa}\n{caption if not where else 'its worst: ' + caption}", ordinate
    )


def _draw_tolerance(axes: Axes, fit: FitResult, outline: DrawnSection, factor: float) -> None:
    if fit.tolerance is None:
        return
    offset = factor * fit.tolerance * per_metre()
    # Inside a thin section the line would fold.
    inside = offset < TOLERANCE_SHARE * outline.section.maximum_thickness[0] * per_metre()
    for sign in (-1.0, 1.0) if inside else (1.0,):
        for side in SIDES:
            axes.plot(*outline.moved(side, sign * offset).T, color=SOFT, linewidth=0.8, linestyle="--")


def _places(fit: FitResult, outline: DrawnSection, index: Index) -> Reals:
    """Positions (m, 2) of points beside the outline."""
    footpoints, normals = outline.footpoints(fit, index)
    return footpoints + normals * deviations_mm(fit, index)[:, None]


def _cross_outliers(axes: Axes, fit: FitResult, outline: DrawnSection, factor: float, most: float) -> None:
    index = np.flatnonzero(outline.points & ~fit.inliers)
    if len(index) == 0:
        return
    deviation = factor * deviations_mm(fit, index)
    if len(index) > CROSSED_OUTLIERS:
        # So many crosses at the border would look like a wall.
        index, deviation = index[np.abs(deviation) < most], deviation[np.abs(deviation) < most]
    footpoints, normals = outline.footpoints(fit, index)
    positions: Reals = footpoints + normals * np.clip(deviation, -most, most)[:, None]
    cross_out(axes, positions[:, 0], positions[:, 1], CROSSED_OUTLIERS)
