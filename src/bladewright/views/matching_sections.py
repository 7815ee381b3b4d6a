"""Fitted sections with the points beside them: deviations magnified, and the edges close by as they are."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from bladewright.nurbs.basis import Reals
from bladewright.views.edges import edge_reach, edge_size
from bladewright.views.matching_outline import FACES, Outline
from bladewright.views.matching_points import (
    COLOURS,
    ROUND,
    SIDES,
    Index,
    Matched,
    counted,
    cross,
    drawn,
    millimetres,
    scale_of,
)
from bladewright.views.sections import COORDINATES
from bladewright.views.style import INK, MILLIMETRES, PALE, SOFT, titled

INSIDE, OUTSIDE = "#2f7fb5", "#c4553f"
CLEAR, FINE = 2.6, 1.2
THICK = 0.4
"""of the largest thickness, that the tolerance is drawn within"""
SHARP = 0.01
"""of the chord, the least half width of the picture of an edge"""
FEW = 60
"""outliers beside a section up to which all are crossed"""
MOST = 4000
"""points drawn beside a section"""
HEIGHT = 0.035
"""of the chord, that the largest of 99 of 100 deviations is drawn with at most"""


def magnification(fit: Matched) -> float:
    """A round factor by which the deviations are seen beside a section."""
    off = np.abs(fit.deviations[fit.inliers])
    most = float(np.percentile(off, 99.0)) if len(off) else 0.0
    if most <= 0.0:
        return 1.0
    factor = HEIGHT * float(np.real(fit.built.chord)) / most
    decade = 10.0 ** np.floor(np.log10(factor))
    steps = [each for each in ROUND if each in {1.0, 2.0, 5.0}]
    return max(1.0, float(max(each for each in steps if each * decade <= factor * (1.0 + 1e-9)) * decade))


def draw_magnified(axes: Axes, fit: Matched, outline: Outline, name: str) -> None:
    """Draws a section with the deviations of the points near it magnified, outliers crossed.

    An outlier that is too far off stands 8 % of the chord away; where there are many, only those nearer are crossed.
    """
    factor = magnification(fit)
    axes.fill(*outline.closed.T, color=PALE, linewidth=0.0)
    _draw_tolerance(axes, fit, outline, factor)
    shown = drawn(fit, outline.points & fit.inliers, MOST)
    off = millimetres(fit, shown)
    feet, normals = outline.feet(fit, shown)
    tops = feet + normals * (factor * off)[:, None]
    many = len(shown) > 1000
    for colour, own in ((INSIDE, off < 0.0), (OUTSIDE, off >= 0.0)):
        lines = list(np.stack([feet[own], tops[own]], axis=1))
        axes.add_collection(LineCollection(lines, colors=colour, linewidths=0.4 if many else 0.9, rasterized=many))
        size = FINE if many else CLEAR
        x, y = tops[own].T
        axes.plot(
            x, y, color=colour, linestyle="none", marker="o", rasterized=many, markersize=size, markeredgewidth=0.0
        )
    axes.plot(*outline.closed.T, color=INK, linewidth=1.0)
    _cross_outliers(axes, fit, outline, factor, 0.08 * float(outline.section.chord) * MILLIMETRES)
    abscissa, ordinate = COORDINATES[outline.section.plane]
    told = "" if fit.tolerance is None else f", dashed: the tolerance × {factor:g}"
    titled(axes, f"{name}, deviations × {factor:g}", f"{abscissa}{told}", ordinate)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06)


def draw_edge_match(axes: Axes, fit: Matched, outline: Outline, *, trailing: bool, where: str) -> None:
    """Draws the leading or the trailing edge of a section with the points there, as they are."""
    section = outline.section
    size, called = edge_size(section, trailing=trailing)
    end = -1 if trailing else 0
    tip = 0.5 * (outline.sides["upper"][end] + outline.sides["lower"][end])
    inwards = outline.inwards(trailing=trailing)
    chord = float(section.chord) * MILLIMETRES
    off = fit.by_region.get(f"{'trailing' if trailing else 'leading'} edge")
    # a nose that came out far too sharp must not hide how far the points are
    least = max(SHARP * chord, 1.5 * off.maximum * MILLIMETRES if off else 0.0)
    reach = max(edge_reach(section, size), least)
    middle = tip + 0.6 * reach * inwards
    axes.fill(*outline.closed.T, color=PALE, linewidth=0.0)
    _draw_tolerance(axes, fit, outline, 1.0)
    # how far along u the picture reaches
    seen = [np.max(np.abs(side - middle), axis=-1) <= 1.2 * reach for side in outline.sides.values()]
    span = float(np.max(np.abs(outline.u - float(trailing))[seen[0] | seen[1]]))
    near = np.zeros_like(outline.points)
    ahead = np.isin(fit.places, FACES) | (fit.u >= 1.0 - span if trailing else fit.u <= span)
    beside = np.flatnonzero(outline.points & fit.inliers & ahead)
    near[beside[np.max(np.abs(_places(fit, outline, beside) - middle), axis=-1) <= 1.05 * reach]] = True
    shown = drawn(fit, near, MOST)
    at = _places(fit, outline, shown)
    # over the points where they would hide it
    axes.plot(*outline.closed.T, color=INK, linewidth=1.2, zorder=3.5 if len(shown) > 1000 else 2.5)
    dot = float(np.clip(6e3 / max(len(shown), 1), 3.0, 26.0))
    axes.scatter(
        at[:, 0],
        at[:, 1],
        s=dot,
        c=millimetres(fit, shown),
        cmap=COLOURS,
        norm=scale_of(fit),
        linewidths=0.4 if len(shown) < 1000 else 0.0,
        edgecolors=INK,
        zorder=3.0,
        rasterized=len(shown) > 1500,
    )
    _cross_outliers(axes, fit, outline, 1.0, np.inf)
    axes.set_xlim(middle[0] - reach, middle[0] + reach)
    axes.set_ylim(middle[1] - reach, middle[1] + reach)
    axes.set_aspect("equal", adjustable="box", anchor="N")
    edge = "Trailing" if trailing else "Leading"
    abscissa, ordinate = COORDINATES[section.plane]
    told = f"{counted(int(np.count_nonzero(near)), 'point')}, {called}"
    titled(axes, f"{edge} edge{where}", f"{abscissa}\n{told if not where else 'its worst: ' + told}", ordinate)


def _draw_tolerance(axes: Axes, fit: Matched, outline: Outline, factor: float) -> None:
    if fit.tolerance is None:
        return
    off = factor * fit.tolerance * MILLIMETRES
    # inside a thin section the line would fold
    inside = off < THICK * outline.section.maximum_thickness[0] * MILLIMETRES
    for sign in (-1.0, 1.0) if inside else (1.0,):
        for side in SIDES:
            axes.plot(*outline.moved(side, sign * off).T, color=SOFT, linewidth=0.8, linestyle="--")


def _places(fit: Matched, outline: Outline, index: Index) -> Reals:
    """Where points (m, 2) lie beside the outline."""
    feet, normals = outline.feet(fit, index)
    return feet + normals * millimetres(fit, index)[:, None]


def _cross_outliers(axes: Axes, fit: Matched, outline: Outline, factor: float, most: float) -> None:
    index = np.flatnonzero(outline.points & ~fit.inliers)
    if len(index) == 0:
        return
    off = factor * millimetres(fit, index)
    if len(index) > FEW:
        # held at the border they would draw a wall
        index, off = index[np.abs(off) < most], off[np.abs(off) < most]
    feet, normals = outline.feet(fit, index)
    at: Reals = feet + normals * np.clip(off, -most, most)[:, None]
    cross(axes, at[:, 0], at[:, 1], FEW)
