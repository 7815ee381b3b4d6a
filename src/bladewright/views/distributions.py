"""Distributions along a section: curvature, its slope with the jumps at joints, and thickness."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.section.smoothness import STEADY, SmoothLine, Smoothness, smoothness
from bladewright.views.sections import cosine_spacing
from bladewright.views.style import (
    INK,
    LOWER,
    SOFT,
    UPPER,
    WALLS,
    Line,
    axis,
    bands,
    draw_lines,
    in_unit,
    label_axes,
    legend_below,
    per_metre,
    span_colour,
    span_name,
    unit_name,
)
from bladewright.views.text_table import draw_text_table

if TYPE_CHECKING:
    from bladewright.section.section import Section

ARC_LABEL = "part of the arc, leading to trailing edge [-]"
"""Name of the abscissa along a side."""
CAMBER_LABEL = "along the camber, leading to trailing edge [-]"
"""Name of the abscissa along the camber line."""
Smooth = Sequence[tuple["Section", Smoothness]]
"""Sections with their smoothness."""
POWERS = 4
"""Most powers of ten beside a logarithmic axis, on either side of zero; fewer leave room for the linear part."""
STRAIGHT = 1e-9
"""Curvature of a camber line that is straight [1 / chord], and slope of that of an arc [1 / chord^2]: rounding."""
EDGE_SHARE = 0.05
"""Fraction of the arc length at either end that does not set the scale of an axis: values at the edges are far larger
than between them."""


class _Drawn(NamedTuple):
    """A line of values along a side or a camber line."""

    line: SmoothLine
    values: Reals
    options: dict[str, Any]


def side_curvature(section: "Section", name: str) -> tuple[Reals, Reals]:
    """Fraction of a side's arc length from the leading edge (n,), and curvature there (n,), convex positive."""
    u = cosine_spacing(601)
    points = np.real(section.curves[name](u))
    steps = length(np.diff(points, axis=0)) * np.real(section.scale((points[1:, 0] + points[:-1, 0]) / 2.0))
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    outwards = -1.0 if name == "upper" else 1.0
    return arc / arc[-1], outwards * section.curvature(name, u) / per_metre()


def draw_curvature(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draw the curvature of both sides, linear about zero and logarithmic beyond, as it is far larger at the edges."""
    styles = {"upper": UPPER, "lower": LOWER}
    draw_lines(
        axes,
        [
            (*side_curvature(section, name), {"color": span_colour(section.span), "linestyle": style})
            for section in sections
            for name, style in styles.items()
        ],
    )
    least = 2.0 / (per_metre() * min(float(section.chord) for section in sections))
    axes.axhline(0.0, color=SOFT, linewidth=0.8)
    axes.set_xlim(-0.01, 1.01)
    label_axes(axes, "Curvature of the sides, convex positive", ARC_LABEL, f"curvature [1/{unit_name()}]")
    logarithmic_beyond(axes, least)
    sides_legend(axes, [section.span for section in sections], ends)


def logarithmic_beyond(axes: Axes, least: float) -> None:
    """Scale the ordinate linearly up to a round value that is not below `least`, logarithmically beyond; say so.

    The name of the axis goes before. Ticks are zero, the round value, half of it and powers of ten far enough apart to
    be read.
    """
    decade = 10.0 ** np.floor(np.log10(least))
    threshold = decade * min(each for each in (1.0, 2.0, 5.0, 10.0) if each * decade >= least * (1.0 - 1e-9))
    axes.set_yscale("symlog", linthresh=threshold, linscale=1.5)
    low, high = axes.get_ylim()
    low, high = min(low, -threshold), max(high, threshold)
    powers = np.arange(np.ceil(np.log10(4.0 * threshold)), np.floor(np.log10(max(-low, high))) + 1.0)
    beyond = 10.0 ** powers[:: max(1, -(-len(powers) // POWERS))]
    inner = threshold * np.linspace(-1.0, 1.0, 5 if len(powers) < POWERS else 3)
    ticks = np.concatenate([-beyond, inner, beyond])
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(FixedLocator(ticks[(ticks >= low) & (ticks <= high)].tolist()))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _tick(value)))
    axes.set_ylabel(f"{axes.get_ylabel()},\nlogarithmic beyond ±{_tick(threshold)}")


def _tick(value: float) -> str:
    """A value on an axis; powers of ten that would be long as such."""
    size = float(np.sqrt(value * value))
    if size == 0.0 or 1e-4 <= size < 1e5:
        return f"{value:g}".replace("-", "\N{MINUS SIGN}")
    digits, _, power = f"{value:.0e}".partition("e")
    factor = {"1": "", "-1": "-"}.get(digits, rf"{digits}\times")
    return rf"${factor}10^{{{int(power)}}}$"


def draw_thickness(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draw the thickness across the camber line as built, and mark its largest value."""
    lines = list[Line]()
    for section in sections:
        colour = span_colour(section.span)
        u, thickness = section.thickness
        largest, place = section.maximum_thickness
        share = 100.0 * largest / section.chord
        label = f"{in_unit(largest, '.3g')}, {share:.3g} % of the chord"
        if len(sections) > 1:
            label = f"{span_name(section.span, ends)} {share:.3g} %"
        lines.append((u, thickness * per_metre(), {"color": colour, "label": label}))
        axes.plot(place, largest * per_metre(), marker="o", markersize=4.0, color=colour, linestyle="none")
    draw_lines(axes, lines)
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(-0.01, 1.01)
    label_axes(axes, "Thickness as built, largest in % of chord", CAMBER_LABEL, axis("thickness across the camber"))
    legend_below(axes, 3, handlelength=1.2)


def sides_legend(axes: Axes, spans: Sequence[float], ends: tuple[str, str] = WALLS) -> None:
    """Draw a legend under the panel: span fractions by colour, where there are several, and sides by line style."""
    handles = [Line2D([], [], color=span_colour(v), label=span_name(v, ends)) for v in spans]
    ink = INK if len(spans) > 1 else span_colour(spans[0])
    styles = {"upper": UPPER, "lower": LOWER}
    sides = [Line2D([], [], color=ink, linestyle=style, label=name) for name, style in styles.items()]
    handles = [*(handles if len(spans) > 1 else []), *sides]
    legend_below(axes, 3, handles=handles)


def draw_smoothness(strip: SubFigure, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draw the slope of the sides' curvature, curvature and slope of the camber lines, and a table of jumps.

    Curvature is that in the section's plane. Camber lines that are straight at all sections have no panels.
    """
    smooth = [(section, smoothness(section)) for section in sections]
    bent = any(float(np.max(each.camber.curvature**2)) > STRAIGHT**2 for _, each in smooth)
    widths = [1.0, 0.85, 0.85, 1.3] if bent else [1.5, 1.3, 1.2]
    axes = strip.subplots(1, len(widths), width_ratios=widths)
    _draw_side_slopes(axes[0], smooth, ends)
    if bent:
        _draw_camber(axes[1], smooth, order=0)
        _draw_camber(axes[2], smooth, order=1)
        _draw_jumps(axes[3], smooth, ends)
    else:
        _draw_jumps(axes[1], smooth, ends)
        axes[2].remove()


def _draw_side_slopes(axes: Axes, smooth: Smooth, ends: tuple[str, str]) -> None:
    """Draw the slope of the curvature of both sides."""
    drawn, least = list[_Drawn](), 0.0
    for section, each in smooth:
        square = _chord(section) ** 2
        # On the lower side a convex bend turns the other way.
        for line, sign, style in ((each.upper, 1.0, UPPER), (each.lower, -1.0, LOWER)):
            options = {"color": span_colour(section.span), "linestyle": style}
            drawn.append(_Drawn(line, sign * line.slope / square, options))
            least = max(least, max(STEADY * float(np.median(line.curvature**2)), 1e-3) / square)
    _draw(axes, drawn, order=1)
    label_axes(axes, "Slope of the curvature of the sides", ARC_LABEL, f"d curvature / d arc [1/{unit_name()}²]")
    most = float(np.median(np.sqrt(np.concatenate([_inner(each) for each in drawn]) ** 2)))
    logarithmic_beyond(axes, 10.0 ** np.ceil(np.log10(max(2.0 * most, least))))
    sides_legend(axes, [section.span for section, _ in smooth], ends)


def _draw_camber(axes: Axes, smooth: Smooth, *, order: int) -> None:
    """Draw the curvature of the camber lines (order 0) or its slope (order 1)."""
    drawn = list[_Drawn]()
    for section, each in smooth:
        in_chords = each.camber.slope if order else each.camber.curvature
        values = np.where(in_chords**2 > STRAIGHT**2, in_chords, 0.0) / _chord(section) ** (order + 1)
        drawn.append(_Drawn(each.camber, values, {"color": span_colour(section.span), "linestyle": UPPER}))
    _draw(axes, drawn, order=order)
    _limited(axes, [_inner(each) for each in drawn])
    if order:
        label_axes(axes, "Slope of that curvature", ARC_LABEL, f"d curvature / d arc [1/{unit_name()}²]")
    else:
        label_axes(axes, "Curvature of the camber line", ARC_LABEL, f"curvature [1/{unit_name()}]")


def _draw_jumps(axes: Axes, smooth: Smooth, ends: tuple[str, str]) -> None:
    """Write the table of jumps."""
    axes.set_title("Largest jumps at joints")
    owners = [section for section, each in smooth for _ in each.lines]
    draw_text_table(
        axes,
        jump_rows(smooth, ends),
        align="lll",
        header=("", f"curvature [1/{unit_name()}]", f"its slope [1/{unit_name()}²]"),
        inks={(row, 0): span_colour(section.span) for row, section in enumerate(owners)},
    )


def _chord(section: "Section") -> float:
    """The chord in the unit of the picture."""
    return float(np.real(section.chord)) * per_metre()


def jump_rows(smooth: Smooth, ends: tuple[str, str]) -> list[tuple[str, str, str]]:
    """The largest jump of curvature and of its slope at the joints of every line, in the unit of the picture."""
    rows = []
    for section, each in smooth:
        for line in each.lines:
            name = line.name if len(smooth) == 1 else f"{span_name(section.span, ends)}, {line.name}"
            cells = []
            for order, sizes in enumerate(
                ([jump.of_curvature for jump in line.jumps], [jump.of_slope for jump in line.jumps])
            ):
                beyond = [size for size, jump in zip(sizes, line.jumps, strict=True) if jump.discontinuous[order]]
                jump = f"{max(beyond, default=0.0) / _chord(section) ** (order + 1):.3g}"
                cells.append("continuous" if line.continuous[order] else jump if beyond else "with it")
            rows.append((name, cells[0], cells[1]))
    return rows


def _draw(axes: Axes, drawn: Sequence[_Drawn], *, order: int) -> None:
    """Draw lines, with a gap and two dots where the curvature (order 0) or its slope (order 1) jumps at a joint."""
    for (line, values, options), band in zip(
        drawn, bands([(line.arc, values) for line, values, _ in drawn]), strict=True
    ):
        joints = [jump.at for jump in line.jumps if jump.place == "joint" and not jump.continuous[order]]
        cuts = [int(np.searchsorted(line.arc, at, side="left")) for at in joints]
        for part in np.split(np.arange(len(values)), cuts):
            axes.plot(line.arc[part], values[part], **options, **band)
        dots = np.array([k for cut in cuts for k in (cut - 1, cut) if cut < len(values)], dtype=int)
        axes.plot(line.arc[dots], values[dots], color=options["color"], linestyle="none", marker="o", markersize=2.6)
    axes.axhline(0.0, color=SOFT, linewidth=0.8)
    axes.set_xlim(-0.01, 1.01)


def _inner(drawn: _Drawn) -> Reals:
    """The values of a line away from both edges."""
    arc = drawn.line.arc
    return drawn.values[(arc > EDGE_SHARE) & (arc < 1.0 - EDGE_SHARE)]


def _limited(axes: Axes, values: Sequence[Reals]) -> None:
    """Set limits that hold the values and zero, with a margin."""
    low, high = min(0.0, *(float(each.min()) for each in values)), max(0.0, *(float(each.max()) for each in values))
    margin = 0.08 * (high - low) or 1.0
    axes.set_ylim(low - margin, high + margin)
