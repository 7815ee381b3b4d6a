"""Sections in their developed plane: along the span, next to their neighbour, and close up at both edges."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from matplotlib.ticker import MaxNLocator

from bladewright.numerics.elementary import length, unit
from bladewright.nurbs.basis import Reals
from bladewright.views.style import (
    CAMBER,
    INK,
    PALE,
    RED,
    SOFT,
    WALLS,
    Line,
    draw_lines,
    label_axes,
    legend_below,
    per_metre,
    span_colour,
    span_name,
    unit_name,
)

if TYPE_CHECKING:
    from matplotlib.figure import SubFigure

    from bladewright.blade.native.blade import Blade
    from bladewright.section.section import Section


_AXES = {
    "x-y": ("x", "y"),
    "m-y": ("m", "y"),
    "m'-theta": (r"$m'\,\bar{r}$", r"$\theta\,\bar{r}$"),
    "m-r*theta": ("m", r"$r\,\theta$"),
    "u-y/L": (r"$u\,L$", r"$r\,\theta$"),
}
"""Names of the axes of the developed planes. A bar marks the mean along the section: angles are then true, and lengths
nearly so."""
SAME_OUTLINE = 1e-6
"""Distance of two outlines, of their size, up to which they are the same: far less than a line is wide."""
ISOLATED_PITCH = 4.0
"""Pitch in chords from which on a neighbour is not drawn: the section would shrink to a line beside it."""
EDGE_WINDOW_RADII, EDGE_WINDOW_CHORDS = 5.0, 0.15
"""Half width of the close-up of an edge, in edge radii and in chords, whichever is less: the edge's circle takes a
fifth of the panel, and the other edge stays outside."""
FLAT_EDGE_RADIUS = 100.0
"""Radius in chords from which on an edge is called flat: its circle cannot be told from a straight line."""
FOOT, FOOT_POINTS = (0, (3.0, 1.5)), 101
"""Line style of the foot of a fillet, and points of each of its curves."""
WALL_POINTS = 2001
"""Points of a wall along a section among which the nearest to a foot is looked for."""
SHARP_EDGE_SIZE = 0.01
"""Length in chords that sets the close-up of a sharp edge, which has no radius."""
LEAST_EDGES = 4
"""Close-ups that a strip has room for at least: two alone would stand far apart."""
_AT_EDGE = {"m'-theta": (r"$m'\,r_e$", r"$\theta\,r_e$")}
"""Names of the axes of close-ups, where they differ from `_AXES`: lengths are true at the edge, at the radius r_e."""


def coordinates(plane: str, *, at_edge: bool = False) -> tuple[str, str]:
    """Names and unit of the axes of a section's developed plane, or of the close-up of an edge."""
    abscissa, ordinate = _AT_EDGE.get(plane, _AXES[plane]) if at_edge else _AXES[plane]
    return f"{abscissa} [{unit_name()}]", f"{ordinate} [{unit_name()}]"


def cosine_spacing(count: int = 201) -> Reals:
    """Parameters (count,) from 0 to 1 in cosine spacing, dense towards both edges."""
    return (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, count))) / 2.0


def drawn_per_unit(section: "Section") -> float:
    """Units of the picture in one unit of the section's plane, in the mean between its edges."""
    ends = np.real(section.camber.control_points[[0, -1], 0])
    return float(np.mean(np.real(section.scale(np.linspace(ends[0], ends[1], 65))))) * per_metre()


def developed(section: "Section", points: Reals) -> Reals:
    """Points (n, 2) of the section's plane."""
    return np.real(points) * drawn_per_unit(section)


def outline(section: "Section") -> Reals:
    """The closed outline (n, 2): the upper side from leading to trailing edge, then the lower side back."""
    u = cosine_spacing()
    upper, lower = (developed(section, section.curves[name](u)) for name in ("upper", "lower"))
    closing = upper[:1] if section.edges[0] == "blunt" else upper[:0]
    return np.concatenate([upper, lower[::-1], closing])


def distinct(sections: Sequence["Section"]) -> Sequence["Section"]:
    """The sections; the middle one alone where all have the same outline."""
    shapes = [outline(section) for section in sections]
    close = SAME_OUTLINE * float(np.ptp(shapes[0]))
    alike = all(
        shape.shape == shapes[0].shape and np.allclose(shape, shapes[0], rtol=0.0, atol=close) for shape in shapes
    )
    return [sections[len(sections) // 2]] if alike else sections


def pitch_of(blade: "Blade", section: "Section") -> float:
    """Tangential distance between neighbours in the section's developed plane."""
    from bladewright.section.checks import UNITS

    design = blade.design
    if design.pitch is not None:
        return design.pitch * UNITS[design.length_unit] * per_metre()
    radius = drawn_per_unit(section)
    if section.plane != "m'-theta":
        lines = blade.exact.sections(np.array([section.span])).lines
        radius = float(np.mean(np.real(lines.position(np.linspace(0.0, 1.0, 65))[..., 1]))) * per_metre()
    return 2.0 * np.pi / (design.blade_count or 1) * radius


def neighbour_outline(blade: "Blade", section: "Section", shape: Reals) -> Reals:
    """The outline (n, 2) of the neighbour one pitch away from a section of a blade whose outline is `shape`."""
    mapping, pitch = blade.exact.mapping, pitch_of(blade, section)
    offset = np.full(len(shape), pitch)
    if not mapping.keeps_ordinate and mapping.revolved:
        lines = blade.exact.sections(np.array([section.span])).lines
        radius = lines.position(lines.u_at((shape[:, 0] / drawn_per_unit(section))[None]))[..., 1]
        turn = np.full(radius.shape, 2.0 * np.pi / (blade.design.blade_count or 1))
        offset = np.real(mapping.start(turn, radius, lines.lengths[..., None]))[0] * drawn_per_unit(section)
    return np.stack([shape[:, 0], shape[:, 1] + offset], axis=-1)


def draw_sections(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draw sections along the span on top of each other, each with its camber line."""
    lines = list[Line]()
    for section in sections:
        colour = span_colour(section.span)
        shape = outline(section)
        axes.fill(*shape.T, color=colour, alpha=0.10, linewidth=0.0)
        lines.append((shape[:, 0], shape[:, 1], {"color": colour, "label": span_name(section.span, ends)}))
        camber = developed(section, section.camber(cosine_spacing()))
        axes.plot(*camber.T, color=colour, linewidth=0.8, linestyle=CAMBER)
    draw_lines(axes, lines)
    label_axes(axes, "Sections with camber lines", *coordinates(sections[0].plane))
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 3, handlelength=1.0, columnspacing=0.9)


def draw_feet(axes: Axes, blade: "Blade", sections: Sequence["Section"]) -> None:
    """Draw the feet of fillets around the sections at hub and shroud, where the blade stands on an uncut wall."""
    cut = blade.design.cut
    uncut = {"hub": cut is None or cut.hub is None, "shroud": cut is None or cut.tip is None}
    for section in sections:
        name = {0.0: "hub", 1.0: "shroud"}.get(section.span)
        if name and uncut[name] and any(face.startswith(f"{name}_fillet") for face in blade.surfaces):
            foot = developed(section, foot_in_plane(blade, name, section.span))
            axes.plot(*foot.T, color=span_colour(section.span), linewidth=0.9, linestyle=FOOT, label=f"foot at {name}")


def foot_in_plane(blade: "Blade", name: str, span: float) -> Reals:
    """The foot (n, 2) of the fillet at a wall in the plane of the section that stands there."""
    exact = blade.plain.exact
    lines, mapping = exact.sections(np.array([span])).lines, exact.mapping
    points = np.concatenate(
        [np.real(curve(np.linspace(*curve.domain, FOOT_POINTS))) for curve in blade.end_outline(name)]
    )
    x, y, z = points.T
    radius, tangential = (np.hypot(y, z), np.unwrap(np.arctan2(y, z))) if mapping.revolved else (z, y)
    places = np.stack([x, radius], axis=-1)
    own = np.real(blade.plain.section(span).curves["upper"](cosine_spacing(WALL_POINTS))[:, 0])
    across = np.linspace(own.min(), own.max(), WALL_POINTS)
    wall = np.real(lines.position(lines.u_at(across[None])))[0]
    nearest = np.argmin(np.sum((places[:, None] - wall) ** 2, axis=-1), axis=1)
    # from there along the wall, which past the noses is as good as straight
    step, metres = np.gradient(wall, across, axis=0), places - wall[nearest]
    along = across[nearest] + np.sum(metres * step[nearest], axis=-1) / np.sum(step[nearest] ** 2, axis=-1)
    ordinate = mapping.start(tangential[None], radius[None], lines.lengths[..., None])
    return np.stack([along, np.real(ordinate)[0]], axis=-1)


def draw_neighbour(
    axes: Axes, section: "Section", pitch: float | None, title: str, blade: "Blade | None" = None
) -> None:
    """Draw a section with its camber line, and its neighbour one pitch away with the narrowest gap between them.

    Where a blade is given, its geometry says where the neighbour lies; otherwise the neighbour is shifted by the pitch.
    """
    shape = outline(section)
    colour = span_colour(section.span)
    chord = section.chord * per_metre()
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour)
    camber = developed(section, section.camber(cosine_spacing()))
    axes.plot(*camber.T, color=INK, linewidth=0.9, linestyle=CAMBER, label="camber line")
    axes.plot(*camber[[0, -1]].T, color=SOFT, linewidth=0.8, linestyle=":", label=f"chord {chord:.4g} {unit_name()}")
    if pitch is not None and pitch < ISOLATED_PITCH * chord:
        neighbour = shape + np.array([0.0, pitch]) if blade is None else neighbour_outline(blade, section, shape)
        axes.fill(*neighbour.T, color=PALE, linewidth=0.0)
        axes.plot(*neighbour.T, color=SOFT)
        gap = narrowest_gap(shape, neighbour)
        width = float(length(gap[1] - gap[0]))
        axes.plot(
            *gap.T, color=RED, linewidth=1.1, marker="o", markersize=3.0, label=f"narrowest {width:.4g} {unit_name()}"
        )
    if pitch is not None:
        title = f"{title}, pitch {pitch:.4g} {unit_name()}"
    label_axes(axes, title, *coordinates(section.plane))
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 2, handlelength=1.5, columnspacing=0.9)


def narrowest_gap(shape: Reals, neighbour: Reals) -> Reals:
    """The two points (2, 2) of two closed outlines that are nearest to each other."""
    distances = length(shape[:, None] - neighbour[None])
    first, second = np.unravel_index(int(np.argmin(distances)), distances.shape)
    return np.stack([shape[first], neighbour[second]])


def draw_edges(strip: "SubFigure", sections: Sequence["Section"], ends: tuple[str, str]) -> None:
    """Draw close-ups of both edges of several sections in a row."""
    axes = strip.subplots(1, max(2 * len(sections), LEAST_EDGES))
    for place in axes[2 * len(sections) :]:
        place.remove()
    for index, section in enumerate(sections):
        for trailing in (False, True):
            place = axes[index + len(sections) * trailing]
            draw_edge(place, section, trailing=trailing)
            edge, _, size = place.get_title(loc="left").partition(", ")
            place.set_title(f"{edge}, {span_name(section.span, ends)}\n{size}", fontsize=9.5)
            place.set_ylabel("")
            place.xaxis.set_major_locator(MaxNLocator(3))
            place.yaxis.set_major_locator(MaxNLocator(4))


def draw_edge(axes: Axes, section: "Section", *, trailing: bool) -> None:
    """Draw a close-up of the leading or the trailing edge of a section, with the camber line and a round edge's circle.

    Lengths are true at the edge. An edge that is smooth but flat, like the back face of a wedge diffuser's vane, has no
    circle.
    """
    scale = edge_scale(section, trailing=trailing)
    at, kind = np.array([float(trailing)]), section.edges[int(trailing)]
    tip = scale * developed(section, section.camber(at))[0]
    inwards = np.real(unit(section.camber.derivative(at)))[0] * (-1.0 if trailing else 1.0)
    shape = scale * outline(section)
    colour = span_colour(section.span)
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour)
    camber = scale * developed(section, section.camber(cosine_spacing()))
    axes.plot(*camber.T, color=INK, linewidth=0.9, linestyle=CAMBER)
    size, name = edge_size(section, trailing=trailing)
    if kind == "round" and size < EDGE_WINDOW_CHORDS * float(np.real(section.chord)) * per_metre():
        centre = tip + size * inwards
        axes.add_patch(Circle((centre[0], centre[1]), size, fill=False, edgecolor=RED, linewidth=1.1, linestyle="--"))
        axes.plot(*centre, marker="+", color=RED, markersize=7.0)
    half_width = edge_half_width(section, size)
    middle = tip + 0.6 * half_width * inwards
    axes.set_xlim(middle[0] - half_width, middle[0] + half_width)
    axes.set_ylim(middle[1] - half_width, middle[1] + half_width)
    axes.set_aspect("equal", adjustable="box")
    edge = "Trailing edge" if trailing else "Leading edge"
    label_axes(axes, f"{edge}, {name}", *coordinates(section.plane, at_edge=True))


def edge_scale(section: "Section", *, trailing: bool) -> float:
    """Ratio of true lengths at an edge to lengths in the developed section, which is scaled by its mean radius."""
    end = np.real(section.camber.control_points[-1 if trailing else 0, :1])
    return float(np.real(section.scale(end))[0]) * per_metre() / drawn_per_unit(section)


def edge_half_width(section: "Section", size: float) -> float:
    """Half width of the close-up of an edge of this size."""
    widest = EDGE_WINDOW_CHORDS * float(np.real(section.chord)) * per_metre()
    return min(max(widest, 1.5 * size), EDGE_WINDOW_RADII * size) if size < widest else widest


def edge_size(section: "Section", *, trailing: bool) -> tuple[float, str]:
    """The size of an edge, its radius or half its width, and the words that say it."""
    kind, end = section.edges[int(trailing)], -1 if trailing else 0
    if kind == "round":
        radius = section.edge_radii[int(trailing)] * per_metre()
        flat = radius > FLAT_EDGE_RADIUS * float(np.real(section.chord)) * per_metre()
        return radius, "flat" if flat else f"radius {radius:.4g} {unit_name()}"
    sides = [developed(section, section.curves[name](np.array([0.0, 1.0]))) for name in ("upper", "lower")]
    width = edge_scale(section, trailing=trailing) * float(length(sides[0][end] - sides[1][end]))
    if kind == "blunt":
        return 0.5 * width, f"blunt, {width:.4g} {unit_name()}"
    return SHARP_EDGE_SIZE * float(np.real(section.chord)) * per_metre(), "sharp"
