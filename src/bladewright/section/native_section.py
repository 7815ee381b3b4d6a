"""One section of a family as a `Section`: native curves from its outline, turned, enlarged and moved in its plane."""

from collections.abc import Callable
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np

from bladewright.numerics.elementary import Array, angle, frozen
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.transform import transformed
from bladewright.section.laws import Span
from bladewright.section.meanline import Meanline
from bladewright.section.native import SectionKnots, native_curves
from bladewright.section.outline import Outline
from bladewright.section.section import Section


class Family(Protocol):
    """A family's part: its sections along a span, each number of it a law."""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        ...

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord lines [rad]."""
        ...


def native_section(
    outline: Outline,
    knots: SectionKnots,
    *,
    turn: Array,
    chord: Array,
    shift: Array,
    span: float,
    plane: str,
    scale: Callable[[Array], Array],
    meanline: Callable[[Array], tuple[Array, Array, Array]] | None,
) -> Section:
    """The section of an outline of shape () or (1,), staggered by `turn` (), `chord` () long, its edge at `shift` (2,).

    `plane`, `scale` and `meanline` are the section's own.
    """
    matrix = chord * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    upper, lower, camber = native_curves(outline, knots=knots)
    sides = {"upper": upper, "lower": lower, **_faces(outline, upper, lower)}
    line = transformed(camber, matrix, shift)
    slope = line.derivative(np.array([0.0, 1.0]))
    metal = np.real(angle(slope[:, 1], slope[:, 0]))
    return Section(
        span=span,
        plane=plane,
        curves=MappingProxyType({name: transformed(curve, matrix, shift) for name, curve in sides.items()}),
        camber=line,
        stagger=float(np.real(turn)),
        metal_angle_in=float(metal[0]),
        metal_angle_out=float(metal[1]),
        scale=scale,
        edges=(outline.leading_edge.kind, outline.trailing_edge.kind),
        knots=knots,
        meanline=meanline,
        outline=outline,
    )


def meanline_of(part: Any, span: Span) -> Callable[[Array], tuple[Array, Array, Array]] | None:
    """v and its first two derivatives (k,) by u (k,) of the first of a part's meanlines; None where it has none."""
    found = getattr(part, "meanline", None)
    if found is None:
        return None
    line: Meanline = found(span)

    def derivatives(u: Array) -> tuple[Array, Array, Array]:
        value, slope, bend, _ = line.derivatives(u)
        return value[..., 0, :], slope[..., 0, :], bend[..., 0, :]

    return derivatives


def _faces(outline: Outline, upper: Curve, lower: Curve) -> dict[str, Curve]:
    """The straight faces of blunt edges, each from the upper to the lower side."""
    faces = {}
    for i, edge in enumerate((outline.leading_edge, outline.trailing_edge)):
        if edge.kind == "blunt":
            ends = frozen(np.stack([upper.control_points[-i], lower.control_points[-i]]))
            knots = np.array([0.0, 0.0, 1.0, 1.0])
            faces[("leading_edge", "trailing_edge")[i]] = Curve(control_points=ends, knots=knots, degree=1)
    return faces
