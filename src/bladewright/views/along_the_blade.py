"""Angle, wrap and flow area along the meridional length, and throat, wrap and lean along the span."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from bladewright.errors import DesignError
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.section.section import Section
from bladewright.views.sections import ISOLATED_PITCH, cosine_spacing
from bladewright.views.style import (
    BLUE,
    GREEN,
    RED,
    Line,
    axis,
    draw_lines,
    label_axes,
    legend_below,
    per_metre,
    span_colour,
    span_name,
    unit_name,
)

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade

ALONG_SPAN = np.linspace(0.0, 1.0, 21)
"""Span fractions at which the station table is taken for a curve along the span: as dense as laws have knots."""
FOR_AREA = np.linspace(0.0, 1.0, 11)
"""Span fractions between which the flow area is summed; it is drawn, not reported."""

ANGLE_DECIMALS = 6
"""Decimals of lean and sweep that are drawn: rounding of a blade without any is no curve [deg]"""


class CamberLine(NamedTuple):
    """A camber line along the meridional length of its stream line."""

    m: Reals
    """(n,) from the leading edge [m]"""
    position: Reals
    """(n, 2) in (x, r), or (x, z) [m]"""
    tangential: Reals
    """(n,) theta [rad], or y [m] in a cascade"""
    angle: Reals
    """(n,) from the meridional direction [rad]"""


def camber_line(blade: "Blade", section: Section) -> CamberLine:
    """The camber line of an exact section."""
    plane = np.real(section.camber(cosine_spacing(101)))[None]
    stack = blade.exact.sections(np.array([section.span]))
    _, position, tangential = (np.real(each)[0] for each in stack.on_lines(plane))
    steps = length(np.diff(position, axis=0))
    m = np.concatenate([[0.0], np.cumsum(steps)])
    radius = (position[1:, 1] + position[:-1, 1]) / 2.0 if blade.exact.mapping.revolved else 1.0
    middles = np.arctan2(radius * np.diff(tangential), steps)
    angle = np.interp(m, (m[1:] + m[:-1]) / 2.0, middles)
    return CamberLine(m, position, tangential, angle)


def draw_camber_angle(axes: Axes, blade: "Blade", sections: Sequence[Section]) -> None:
    """Draw the angle of the camber lines along the meridional length."""
    lines = list[Line]()
    for section in sections:
        v, line = section.span, camber_line(blade, section)
        options = {"color": span_colour(v), "label": _name(blade, v)}
        lines.append((line.m * per_metre(), np.degrees(line.angle), options))
    draw_lines(axes, lines)
    label_axes(axes, "Camber angle", axis("meridional length"), "from the meridional direction [deg]")
    legend_below(axes, 2, handlelength=1.0, columnspacing=0.9)


def draw_wrap(axes: Axes, blade: "Blade", sections: Sequence[Section]) -> None:
    """Draw the camber lines' position around the axis, or along y, over the meridional length."""
    revolved, lines = blade.exact.mapping.revolved, list[Line]()
    for section in sections:
        v, line = section.span, camber_line(blade, section)
        around = np.degrees(line.tangential) if revolved else line.tangential * per_metre()
        wrap = f"{abs(around[-1] - around[0]):.3g}" + (" deg" if revolved else f" {unit_name()}")
        label = f"{_name(blade, v)} {wrap}"
        lines.append((line.m * per_metre(), around, {"color": span_colour(v), "label": label}))
    draw_lines(axes, lines)
    title = "Wrap" if revolved else "Tangential position"
    label_axes(axes, title, axis("meridional length"), "theta [deg]" if revolved else axis("y"))
    legend_below(axes, 2, handlelength=1.0, columnspacing=0.9)


def draw_flow_area(axes: Axes, blade: "Blade", sections: Sequence[Section]) -> None:
    """Draw the area of one passage normal to the camber lines, at equal fractions of their meridional lengths.

    It is the sum over the span of pitch times the cosine of the camber angle, less the thickness: an estimate that
    takes the flow along the camber lines.
    """
    del sections
    share = np.linspace(0.0, 1.0, 81)
    across = [blade.section(v) for v in blade.exact.shown_spans(tuple(FOR_AREA))]
    lines = [camber_line(blade, section) for section in across]
    places = np.stack([_at(line, line.position, share) for line in lines])
    angles = np.stack([_at(line, line.angle[:, None], share)[:, 0] for line in lines])
    pitch = blade.design.spacing * (places[..., 1] if blade.exact.mapping.revolved else 1.0)
    thickness = np.stack([_thickness(*each, share) for each in zip(across, lines, strict=True)])
    width = np.real(pitch) * np.cos(angles) - thickness
    along = np.gradient(places, share, axis=1)
    along /= length(along)[..., None]
    rise = np.diff(places, axis=0)
    towards = (along[1:] + along[:-1]) / 2.0
    height = np.sqrt((rise[..., 1] * towards[..., 0] - rise[..., 0] * towards[..., 1]) ** 2)
    area = np.sum(height * (width[1:] + width[:-1]) / 2.0, axis=0)
    axes.plot(share, area * per_metre() ** 2, color=BLUE)
    axes.set_ylim(bottom=0.0)
    label_axes(axes, "Flow area, estimate", "part of the meridional length [-]", f"{axis('area')[:-1]}²]")


def draw_throat(axes: Axes, blade: "Blade", sections: Sequence[Section]) -> None:
    """Draw the throat width and the pitch at mid-chord along the span."""
    del sections
    table = blade.report(ALONG_SPAN.tolist())
    for name, values, colour in (("throat", table.throat, RED), ("pitch, mid-chord", table.pitch_mid, BLUE)):
        axes.plot(np.real(values) * per_metre(), ALONG_SPAN, color=colour, label=name)
    axes.set_xlim(left=0.0)
    label_axes(axes, "Throat and pitch", axis("width"), "span v [-]")
    legend_below(axes, 2)


def draw_lean(axes: Axes, blade: "Blade", sections: Sequence[Section]) -> None:
    """Draw lean and sweep of the edges along the span."""
    del sections
    table = blade.report(ALONG_SPAN.tolist())
    curves = (
        ("lean, l.e.", table.lean, GREEN, "-"),
        ("lean, t.e.", table.trailing_edge_lean, RED, "-"),
        ("sweep, l.e.", table.leading_edge_sweep, GREEN, "--"),
        ("sweep, t.e.", table.trailing_edge_sweep, RED, "--"),
    )
    lines = list[Line]()
    for name, values, colour, style in curves:
        angle = np.round(np.degrees(np.real(values)), ANGLE_DECIMALS)
        lines.append((angle, ALONG_SPAN, {"color": colour, "linestyle": style, "label": name}))
    draw_lines(axes, lines)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    label_axes(axes, "Lean and sweep", "angle [deg]", "span v [-]")
    legend_below(axes, 2)


def has_throat(blade: "Blade") -> bool:
    """Whether the blade has neighbours so near that a throat can be located between them."""
    try:
        table = blade.report([0.0, 0.5, 1.0])
        near = np.real(table.pitch_mid) < ISOLATED_PITCH * blade.chord
        return bool(np.all(near & (np.real(table.throat) > 0.0)))
    except DesignError:
        return False


def _at(line: CamberLine, values: Reals, share: Reals) -> Reals:
    """Values (n, k) of a camber line at fractions (m,) of its meridional length."""
    return np.stack([np.interp(share * line.m[-1], line.m, column) for column in values.T], axis=-1)


def _thickness(section: Section, line: CamberLine, share: Reals) -> Reals:
    """Thickness across the camber [m] at fractions of the meridional length."""
    u, thickness = section.thickness
    at = np.interp(share * line.m[-1], line.m, cosine_spacing(101))
    return np.interp(at, u, thickness)


def _name(blade: "Blade", v: float) -> str:
    return span_name(v, blade.design.law_ends)
