"""The sheet of a flow passage: its body, duct, unwrapped walls and figures; of a 2D section, its curves."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.views.meridional import INLET, OUTLET, draw_duct
from bladewright.views.pages import Page, columns, draw_header, rows
from bladewright.views.sections import coordinates, developed, outline
from bladewright.views.solid import draw_passage_solid
from bladewright.views.style import (
    CAMBER,
    INK,
    LOWER,
    SOFT,
    UPPER,
    in_unit,
    label_axes,
    per_metre,
    span_colour,
    unit_name,
)
from bladewright.views.text_table import draw_text_table
from bladewright.views.walls import draw_least_jacobian, draw_wall

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage
    from bladewright.domain.section import SectionPassage


VIEW = (900, 760)
"""Largest width and height of the view in space [pixels]: what its panel of the sheet shows."""
Rows = list[tuple[str, str]]
"""Names and values of a table; a heading has no value."""


def passage_sheet(passage: "Passage") -> Figure:
    """The sheet of a 3D passage, before its layout."""
    figure = Page(figsize=(16.0, 13.0))
    draw_header(figure, passage.name, passage.description, passage_header(passage))
    top, bottom = rows(figure, 6.0, 6.0)
    # Separate columns: in one row of panels the legend of the duct would make the view lower.
    body, duct, numbers = columns(top, 1.35, 1.0, 0.65)
    view = body.subplots()
    draw_passage_solid(view, passage, size=VIEW)
    view.set_title("Passage, see-through from outside")
    view.set_anchor("N")
    draw_duct(duct.subplots(), passage)
    draw_figures(numbers.subplots(), figures(passage))
    panels = bottom.subplots(1, 3 if passage.skin is None else 2)
    for panel, wall in zip(panels, ("hub", "shroud"), strict=False):
        draw_wall(panel, passage, wall)
    if passage.skin is None:
        draw_least_jacobian(panels[2], passage)
    return figure


def section_passage_sheet(design: Any, passage: "SectionPassage") -> Figure:
    """The sheet of a 2D section's passage, before its layout; the design, where it is known, gives the name."""
    figure = Page(figsize=(14.0, 10.5))
    name, description = (design.name, design.description) if design is not None else ("section", "")
    draw_header(figure, f"{name}-passage", description, section_header(passage))
    (strip,) = rows(figure, 1.0)
    axes = strip.subplots(1, 2, width_ratios=[2.6, 1.0])
    draw_section_passage(axes[0], passage)
    draw_figures(axes[1], section_figures(passage))
    return figure


def draw_section_passage(axes: Axes, passage: "SectionPassage") -> None:
    """Draw the curves around a section [mm], its continued camber line and its neighbours."""
    section = passage.section
    colour = span_colour(section.span)
    shape, pitch = outline(section), section_pitch(passage)
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour, label="section")
    for turn in (-1.0, 1.0):
        neighbour = shape + np.array([0.0, turn * pitch])
        axes.plot(*neighbour.T, color=SOFT, linewidth=0.8, label="neighbours" if turn > 0.0 else None)
    lines = {name: boundary(passage, name) for name in ("periodic_lower", "periodic_upper", "inlet", "outlet")}
    camber = (lines["periodic_lower"] + lines["periodic_upper"]) / 2.0
    axes.plot(*camber.T, color=INK, linewidth=0.8, linestyle=CAMBER, label="camber line, continued")
    for name, ink, style in (
        ("periodic_upper", INK, UPPER),
        ("periodic_lower", INK, LOWER),
        ("inlet", INLET, UPPER),
        ("outlet", OUTLET, UPPER),
    ):
        axes.plot(*lines[name].T, color=ink, linestyle=style, linewidth=1.8, label=name.replace("_", " "))
    label_axes(axes, f"Flow domain, pitch {pitch:.4g} {unit_name()}", *coordinates(section.plane))
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.08), ncols=4)


def section_pitch(passage: "SectionPassage") -> float:
    """Distance between neighbours [mm]."""
    return float(np.ptp(boundary(passage, "inlet")[:, 1]))


def boundary(passage: "SectionPassage", name: str) -> Reals:
    """Points (n, 2) [mm] of a boundary curve of a section's passage."""
    curve = passage.curves[name]
    low, high = curve.domain
    return developed(passage.section, curve(low + (high - low) * np.linspace(0.0, 1.0, 601)))


def passage_header(passage: "Passage") -> list[str]:
    """The key figures of a passage, for the header."""
    count = passage.blade.design.blade_count
    filled = "passages and blades fill the ring" if count else "passage and blade fill a pitch"
    return [
        "linear cascade" if count is None else f"one passage of {count}",
        f"volume {cubic(passage.properties.volume)}",
        f"{filled} within {abs(passage.ring_error):.1e}",
        f"walls within {passage.wall_error:.1e} of the chord",
        "trimmed walls" if passage.skin else f"least Jacobian {_least(passage):.2g} of its median",
    ]


def figures(passage: "Passage") -> Rows:
    """Volumes, errors, extents, and the poles of every face."""
    count, size = passage.blade.design.blade_count, passage.knots.length * per_metre()
    table = [
        ("Volume", ""),
        ("passage", cubic(passage.properties.volume)),
        ("blade", cubic(passage.blade.properties.volume)),
        (f"ring of N = {count}" if count else "one pitch of the duct", cubic(passage.ring)),
        (f"{'N ' if count else ''}(passage + blade) / {'ring' if count else 'duct'} - 1", f"{passage.ring_error:.1e}"),
        ("Walls", ""),
        ("off their surfaces / chord", f"{passage.wall_error:.1e}"),
        ("least Jacobian / median", "trimmed" if passage.skin else f"{_least(passage):.2g}"),
        ("Extents", ""),
        ("upstream", f"{passage.knots.upstream:.3g} x {size:.4g} {unit_name()}"),
        ("downstream", f"{passage.knots.downstream:.3g} x {size:.4g} {unit_name()}"),
    ]
    for name, turn in zip(("inlet angle", "outlet angle"), passage.camber.turned, strict=True):
        if turn is not None:
            table.append((name, f"{np.degrees(np.arctan(float(np.real(turn)))):.3g}°"))
    return [*table, ("Poles", ""), *((_spaced(name), poles(passage, name)) for name in passage.whole)]


def poles(passage: "Passage", name: str) -> str:
    """Numbers of poles of a face along u and v; of a face that is split, those of its pieces."""
    pieces = [face for piece, face in passage.surfaces.items() if piece == name or piece.startswith(f"{name}_")]
    shapes = [(face.surface if isinstance(face, TrimmedSurface) else face).control_points.shape for face in pieces]
    along = " + ".join(str(shape[-3]) for shape in shapes)
    return f"{f'({along})' if len(shapes) > 1 else along} x {shapes[0][-2]}"


def section_header(passage: "SectionPassage") -> list[str]:
    """The key figures of a section's passage, for the header."""
    ends = [float(np.real(passage.curves[name].control_points[0, 0])) for name in ("inlet", "outlet")]
    return [
        f"area {_square(passage.area)}",
        f"from x = {ends[0] * per_metre():.4g} to {in_unit(ends[1])}",
    ]


def section_figures(passage: "SectionPassage") -> Rows:
    """Areas of a section's passage, and the poles of every curve."""
    areas = [("Area", ""), ("passage", _square(passage.area)), ("section", _square(passage.section.area))]
    poles = [(_spaced(name), str(len(curve.control_points))) for name, curve in passage.curves.items()]
    return [*areas, ("Poles", ""), *poles]


def draw_figures(axes: Axes, rows: Rows) -> None:
    """Write a table of names and values."""
    draw_text_table(axes, rows, align="lr")
    axes.set_title("Figures")


def _least(passage: "Passage") -> float:
    """The least Jacobian of the walls, as a fraction of the median of its patch."""
    return min(share for share, _, _ in passage.folds.values())


def _spaced(name: str) -> str:
    return name.replace("_", " ")


def cubic(volume: np.ndarray) -> str:
    """A volume [m^3] with a unit that suits its size."""
    cubic = float(np.real(volume)) * per_metre() ** 3
    if unit_name() != "mm":
        return f"{cubic:.5g} {unit_name()}³"
    return f"{cubic:.5g} mm³" if cubic < 1e4 else f"{cubic / 1e3:.5g} cm³" if cubic < 1e8 else f"{cubic / 1e6:.5g} dm³"


def _square(area: np.ndarray) -> str:
    """An area [m^2] as text."""
    return f"{float(np.real(area)) * per_metre() ** 2:.5g} {unit_name()}²"
