"""Meridional views: the channel of a blade with the points that define it, and the duct of a passage."""

from dataclasses import fields
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.faces import sampled
from bladewright.views.sections import cosine_spacing
from bladewright.views.solid import FILLET, SIDES
from bladewright.views.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PALE,
    RED,
    SOFT,
    VIOLET,
    axis,
    label_axes,
    legend_below,
    per_metre,
    unit_name,
)

if TYPE_CHECKING:
    from bladewright.blade.exact.meridional_view import MeridionalView, ViewLine
    from bladewright.blade.native.blade import Blade
    from bladewright.domain.passage import Passage


CURVES = {"hub": BLUE, "shroud": ORANGE, "leading_edge": GREEN, "trailing_edge": RED}
"""Colours of the walls and of the edges."""
FEW_SURFACES = 5
"""Most stream surfaces that are drawn with their points: those of more would cover the blade."""
FEW_POINTS = 12
"""Most points of a line with marks of full size."""
SEEN_BEYOND = 0.6
"""What is seen before and behind the blade, in its larger extent: a long duct would make the blade small."""
CUT_BEYOND = 0.15
"""How far a straight cut is drawn past the blade, of its extent."""
INLET, OUTLET = VIOLET, GREY
"""Colours of the ends of a passage."""


def draw_meridional(axes: Axes, blade: "Blade") -> None:
    """Draw the meridional view of a blade in the (x, r) plane, or (x, z) in a cascade, to one scale on both axes."""
    exact, view = blade.exact, blade.exact.meridional_view
    covered = blade_outline(blade.plain) * per_metre()
    if blade.plain is blade:
        axes.fill(*covered.T, color=INK, alpha=0.08, linewidth=0.0, label="blade")
        axes.plot(*covered.T, color=INK, linewidth=0.7)
    else:
        draw_covered(axes, blade)
    draw_view(axes, view)
    draw_cuts(axes, blade, covered)
    draw_outlines(axes, blade)
    for index, line in enumerate(built_edges(blade)):
        label = None if index else "edges as built"
        axes.plot(*(line * per_metre()).T, color=INK, linestyle=(0, (1, 1.2)), linewidth=1.6, label=label)
    draw_clearance(axes, view)
    label_axes(
        axes,
        "Meridional channel, given points",
        axis("x"),
        axis("r") if exact.mapping.revolved else axis("z"),
    )
    axes.set_aspect("equal", adjustable="datalim")
    _near_the_blade(axes, covered)
    legend_below(axes, 3)


def draw_view(axes: Axes, view: "MeridionalView") -> None:
    """Draw the lines of a design in the meridional plane, with the points that define them."""
    for index, line in enumerate(view.stream_lines):
        axes.plot(*(line * per_metre()).T, color=SOFT, linewidth=0.6, label=None if index else "stream lines")
    for index, line in enumerate(view.quasi_orthogonals):
        label = None if index else "quasi-orthogonals"
        axes.plot(*(line * per_metre()).T, color=SOFT, linestyle=(0, (3, 2)), linewidth=0.9, label=label)
    given = len(view.stream_surfaces)
    for index, surface in enumerate(view.stream_surfaces):
        label = None if index else f"{given} stream surfaces given" if given > 1 else "stream surface given"
        _draw(axes, surface, VIOLET, label, hairline=given > FEW_SURFACES)
    for name, curve in view.lines.items():
        _draw(axes, curve, CURVES[name], name.replace("_", " "))


def _near_the_blade(axes: Axes, covered: Reals) -> None:
    """Leave out what is far from the blade along the axis."""
    (left, low), (right, high) = covered.min(axis=0), covered.max(axis=0)
    beyond = SEEN_BEYOND * max(right - left, high - low)
    seen = axes.get_xlim()
    axes.set_xlim(max(seen[0], left - beyond), min(seen[1], right + beyond), auto=True)


def draw_covered(axes: Axes, blade: "Blade") -> None:
    """Fill what the faces of a cut or filleted blade cover, its fillets in their own colour."""
    kinds: list[tuple[str, Any, list[str]]] = [
        ("blade", PALE, [name for name in blade.surfaces if name in SIDES or "strip" in name]),
        ("fillet", FILLET, [name for name in blade.surfaces if "fillet" in name]),
    ]
    for label, colour, names in kinds:
        pieces = list[Reals]()
        for name in names:
            x, y, z = np.moveaxis(sampled(blade.surfaces[name], cosine_spacing(81), cosine_spacing(17))[0], -1, 0)
            flat = np.stack([x, np.hypot(y, z) if blade.exact.mapping.revolved else z], axis=-1)
            corners = flat[:-1, :-1], flat[1:, :-1], flat[1:, 1:], flat[:-1, 1:]
            pieces += [*np.stack(corners, axis=2).reshape(-1, 4, 2)]
        if pieces:
            axes.add_collection(PolyCollection(pieces, facecolors=colour, edgecolors=colour, label=label))


def draw_cuts(axes: Axes, blade: "Blade", covered: Reals) -> None:
    """Draw the lines that a design cuts its blade by; straight ones pass what it covered (n, 2) by a little."""
    cut, metre = blade.design.cut, blade.design.metre
    if cut is None:
        return
    low, high = covered.min(axis=0), covered.max(axis=0)
    low, high = low - CUT_BEYOND * (high - low), high + CUT_BEYOND * (high - low)
    label: str | None = "cut"
    for line in (getattr(cut, each.name) for each in fields(cut)):
        if line is None:
            continue
        points = per_metre() * line.points_within(metre, low / per_metre(), high / per_metre())
        axes.plot(*points.T, color=VIOLET, linestyle=(0, (5, 1.5)), linewidth=1.3, label=label)
        label = None


def draw_outlines(axes: Axes, blade: "Blade") -> None:
    """Draw the outlines of disc and shroud ring that a design gives."""
    design = blade.design
    outlines = {
        name: part.outline
        for name, part in (("disc", design.disc), ("ring", design.shroud_ring))
        if part is not None and part.outline is not None
    }
    label: str | None = ", ".join(outlines)
    for outline in outlines.values():
        line = outline.pieces.line(design.metre)
        axes.plot(*(per_metre() * line.drawn_points).T, color=GREY, linewidth=1.3, label=label)
        label = None


def draw_clearance(axes: Axes, view: "MeridionalView") -> None:
    """Draw the clearance surface where there is one."""
    if view.tip is None:
        return
    stated = " to ".join(dict.fromkeys(f"{each * per_metre():.3g}" for each in view.clearance))
    tip = view.tip * per_metre()
    axes.plot(*tip.T, color=INK, linestyle="--", linewidth=1.0, label=f"clearance {stated} {unit_name()}")


def built_edges(blade: "Blade") -> list[Reals]:
    """Leading and trailing edge (n, 2) of the native sides in (x, r) [m]; of a blunt edge those of both sides."""
    v, edges = np.linspace(0.0, 1.0, 101), []
    for end, name in ((0.0, "leading_edge"), (1.0, "trailing_edge")):
        for side in SIDES if name in blade.surfaces else SIDES[:1]:
            along = [part for part in (f"hub_strip_{side}", side, f"shroud_strip_{side}") if part in blade.surfaces]
            lines = [np.real(cast(Surface, blade.surfaces[part]).grid(np.array([end]), v))[0] for part in along]
            x, y, z = np.concatenate(lines).T
            edges.append(np.stack([x, np.sqrt(y * y + z * z) if blade.exact.mapping.revolved else z], axis=-1))
    return edges


def _draw(axes: Axes, line: "ViewLine", colour: str, label: str | None, *, hairline: bool = False) -> None:
    """Draw a curve with its continuations and the points that define it; a hairline without them."""
    if hairline:
        axes.plot(*(line.points * per_metre()).T, color=colour, linewidth=0.4, label=label)
        return
    axes.plot(*(line.points * per_metre()).T, color=colour, label=label)
    for part in line.beyond:
        axes.plot(*(part * per_metre()).T, color=colour, linewidth=0.8)
    size = 4.5 if len(line.given) <= FEW_POINTS else 2.0
    marks: dict[str, Any] = {"marker": "o", "markersize": size, "markerfacecolor": "white"}
    style = ":" if line.polygon else "none"
    axes.plot(*(line.given * per_metre()).T, color=colour, linestyle=style, linewidth=0.8, **marks)


def blade_outline(blade: "Blade") -> Reals:
    """Closed outline (n, 2) in (x, r) [m] of the area that the blade covers, with what bulges past its edge curves."""
    sections = blade.exact.sections(np.linspace(0.0, 1.0, 41))
    u, position, _ = sections.on_lines(np.concatenate(sections.plane_points(cosine_spacing(101)), axis=-2))
    order = np.argsort(np.real(u), axis=-1)
    ends = np.take_along_axis(np.real(position), order[:, [0, -1], None], axis=1)
    hub, shroud = (np.real(position)[row, order[row]] for row in (0, -1))
    return np.concatenate([ends[:, 0], shroud, ends[::-1, 1], hub[::-1]])


def draw_duct(axes: Axes, passage: "Passage") -> None:
    """Draw the native duct in the (x, r) plane, or (x, z) in a cascade, to one scale on both axes."""
    blade = passage.blade
    covered = blade_outline(blade) * per_metre()
    axes.fill(*covered.T, color=INK, alpha=0.08, linewidth=0.0, label="blade")
    periodic, across = cast(Surface, passage.whole["periodic_upper"]), np.linspace(0.0, 1.0, 101)
    u = np.unique(np.concatenate([np.linspace(0.0, 1.0, 401), 0.25 + 0.5 * cosine_spacing(201)]))
    for index, line in enumerate(np.swapaxes(_meridional(passage, periodic, u, np.linspace(0.1, 0.9, 9)), 0, 1)):
        axes.plot(*line.T, color=SOFT, linewidth=0.6, label=None if index else "stream lines")
    for wall, v in (("hub", 0.0), ("shroud", 1.0)):
        line = _meridional(passage, periodic, u, np.array([v]))[:, 0]
        axes.plot(*line.T, color=CURVES[wall], linewidth=1.8, label=wall)
    for name, end, colour in (("inlet", 0.0, INLET), ("outlet", 1.0, OUTLET)):
        line = _meridional(passage, periodic, np.array([end]), across)[0]
        axes.plot(*line.T, color=colour, linewidth=1.8, label=name)
        side = cast(Surface, passage.whole["blade_upper"])
        edge = "leading_edge" if name == "inlet" else "trailing_edge"
        line = _meridional(passage, side, np.array([end]), across)[0]
        axes.plot(*line.T, color=CURVES[edge], label=edge.replace("_", " "))
    draw_clearance(axes, blade.exact.meridional_view)
    label_axes(
        axes,
        "Meridional duct",
        axis("x"),
        axis("r") if passage.duct.revolved else axis("z"),
    )
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 3)


def _meridional(passage: "Passage", face: Surface, u: Reals, v: Reals) -> Reals:
    """Points (k, l, 2) in (x, r) or (x, z) [mm] of a native face at u (k,) and v (l,)."""
    x, y, z = np.moveaxis(np.real(face.grid(u, v)), -1, 0)
    return np.stack([x, np.sqrt(y * y + z * z) if passage.duct.revolved else z], axis=-1) * per_metre()
