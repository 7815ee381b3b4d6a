"""Figures of a flow passage: sizes, what is promised of it, and the poles of its faces."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.views.style import MILLIMETRES

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage
    from bladewright.domain.section import SectionPassage

Rows = list[tuple[str, str]]
"""names and values; a heading has no value"""
ROWS = 24
"""rows that a panel holds at least"""


def head(passage: "Passage") -> list[str]:
    """The key figures under a passage's name."""
    count = passage.blade.design.blade_count
    filled = "passages and blades fill the ring" if count else "passage and blade fill a pitch"
    return [
        "linear cascade" if count is None else f"one passage of {count}",
        f"volume {_cubic(passage.properties.volume)}",
        f"{filled} within {abs(passage.ring_error):.1e}",
        f"walls within {passage.wall_error:.1e} of the chord",
        f"least Jacobian {_least(passage):.2g} of its median",
    ]


def figures(passage: "Passage") -> Rows:
    """Sizes, what is promised, extents, and the poles of every face."""
    count, size = passage.blade.design.blade_count, passage.knots.length * MILLIMETRES
    found = [
        ("Volume", ""),
        ("passage", _cubic(passage.properties.volume)),
        ("blade", _cubic(passage.blade.properties.volume)),
        (f"ring of N = {count}" if count else "one pitch of the duct", _cubic(passage.ring)),
        (f"{'N ' if count else ''}(passage + blade) / {'ring' if count else 'duct'} - 1", f"{passage.ring_error:.1e}"),
        ("Walls", ""),
        ("off their surfaces / chord", f"{passage.wall_error:.1e}"),
        ("least Jacobian / median", f"{_least(passage):.2g}"),
        ("Extents", ""),
        ("upstream", f"{passage.knots.upstream:.3g} x {size:.4g} mm"),
        ("downstream", f"{passage.knots.downstream:.3g} x {size:.4g} mm"),
    ]
    for name, turn in zip(("inlet angle", "outlet angle"), passage.camber.turned, strict=True):
        if turn is not None:
            found.append((name, f"{np.degrees(np.arctan(float(np.real(turn)))):.3g}°"))
    return [*found, ("Poles", ""), *((_worded(name), poles(passage, name)) for name in passage.whole)]


def poles(passage: "Passage", name: str) -> str:
    """Poles of a face along u and v; of one that is split, those of its pieces."""
    pieces = [face for piece, face in passage.surfaces.items() if piece == name or piece.startswith(f"{name}_")]
    shapes = [(face.surface if isinstance(face, TrimmedSurface) else face).control_points.shape for face in pieces]
    along = " + ".join(str(shape[-3]) for shape in shapes)
    return f"{f'({along})' if len(shapes) > 1 else along} x {shapes[0][-2]}"


def section_head(passage: "SectionPassage") -> list[str]:
    """The key figures under the name of a section's passage."""
    ends = [float(np.real(passage.curves[name].control_points[0, 0])) for name in ("inlet", "outlet")]
    return [f"area {_square(passage.area)}", f"from x = {ends[0] * MILLIMETRES:.4g} to {ends[1] * MILLIMETRES:.4g} mm"]


def section_figures(passage: "SectionPassage") -> Rows:
    """Areas of a section's passage, and the poles of every curve."""
    areas = [("Area", ""), ("passage", _square(passage.area)), ("section", _square(passage.section.area))]
    poles = [(_worded(name), str(len(curve.control_points))) for name, curve in passage.curves.items()]
    return [*areas, ("Poles", ""), *poles]


def draw_figures(axes: Axes, rows: Rows) -> None:
    """Writes names and values under one another."""
    axes.set_axis_off()
    axes.set_ylim(max(len(rows), ROWS) - 0.5, -0.5)
    for line, (name, value) in enumerate(rows):
        axes.text(0.0, line, name, va="center", fontweight="normal" if value else "bold")
        axes.text(1.0, line, value, va="center", ha="right")
    axes.set_title("Figures")


def _least(passage: "Passage") -> float:
    return min(share for share, _, _ in passage.folds.values())


def _worded(name: str) -> str:
    return name.replace("_", " ")


def _cubic(volume: np.ndarray) -> str:
    """A volume [m^3] in words."""
    cubic = float(np.real(volume)) * MILLIMETRES**3
    return f"{cubic:.5g} mm³" if cubic < 1e4 else f"{cubic / 1e3:.5g} cm³" if cubic < 1e8 else f"{cubic / 1e6:.5g} dm³"


def _square(area: np.ndarray) -> str:
    """An area [m^2] in words."""
    return f"{float(np.real(area)) * MILLIMETRES**2:.5g} mm²"
