"""What places the sections of a design on their stream lines: the contract, and the sections' reference points."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.design.stacking import Stacking
from bladewright.blade.flow_path.blade_streamlines import BladeStreamlines
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.designs import naming
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated
from bladewright.numerics.quadrature import converged_quadrature, gauss, panels
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.outline import Outline

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade

STEEP = np.radians(89.0)
"""Largest angle of a chord line [rad]: beyond it, its extent along the flow says nothing of the chord."""
PIECES = 6
"""Equal pieces that a side is cut into for quadrature, besides its joints; the order is then raised until the
centroid converges."""

Placed = tuple[BladeStreamlines, Outline, Array, Array]
"""Stream lines by u between the sections' edges, the sections in chords, their stagger (..., m) [rad], and their
reference points (..., m, 2) in chords."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Placement(ABC):
    """What places sections on their stream lines: prescribed edge curves, or a stacking axis and a chord."""

    surfaces: StreamSurfaces

    @property
    def edge_curves(self) -> tuple[MeridionalCurve | None, MeridionalCurve | None]:
        """The leading- and the trailing-edge curve, where they are given."""
        return None, None

    @abstractmethod
    def placed(self, design: "SectionedBlade", mapping: StreamSurfaceMap, span: Span) -> Placed:
        """The sections at the places of a span, before sweep and lean.

        Raises DesignError where there are none, or they do not fit in the flow path.
        """

    @abstractmethod
    def span_joints(self) -> list[tuple[float, int]]:
        """v at which the curves that sections are placed by lose derivatives, and how many they keep there."""


def family_sections(design: "SectionedBlade", span: Span, lines: BladeStreamlines) -> tuple[Outline, Array]:
    """The family's sections in chords and their stagger (..., m) [rad] on stream lines."""
    part = design.section

    def meridional(fractions: Reals) -> Array:
        u = lines.u_at(lines.extents()[..., None] * fractions)
        return lines.meridional(u) / lines.lengths[..., None]

    with naming("section", part):
        if lines.mapping.plane != "m'-theta":
            return part.outline(span), part.stagger(span)
        return part.on_stream_surfaces(span, meridional)


def check_stagger(stagger: Array, v: Reals) -> None:
    """Refuse chord lines (..., m) that stand across the flow."""
    real = np.real(stagger).reshape(-1, len(v))
    steep = np.argwhere(real**2 >= STEEP**2)
    if len(steep):
        row, at = steep[0]
        raise DesignError(
            f"section: its chord line stands at {np.degrees(real[row, at]):.4g} deg at v = {v[at]:.3f}: it must keep "
            "below 89 deg to both sides, for beyond it the extent along the flow says nothing of the chord; lower the "
            "stagger angle there"
        )


def reference_points(stacking: Stacking | None, outline: Outline, span: Span) -> Array:
    """Points (..., m, 2) of the sections in chords, unstaggered; the leading edge where there is no stacking."""
    which = "leading-edge" if stacking is None else stacking.reference
    if which == "centroid":
        return centroid(outline)
    ends = {"leading-edge": 0.0, "trailing-edge": 1.0}
    along = np.full(len(span.v), ends[which]) if which in ends else _fraction(stacking, span)
    return np.stack([along, np.zeros_like(along)], axis=-1)


def _fraction(stacking: Stacking | None, span: Span) -> Array:
    law = None if stacking is None else stacking.chord_fraction
    return span.values(0.0 if law is None else law)


def centroid(outline: Outline) -> Array:
    """Centres of area (..., 2) of sections in their planes, in chords, by Green's theorem and Gauss quadrature.

    Each side is the polynomial through the Gauss points of a panel, whose order is raised until the centre moves by
    less than 1e-13.
    """
    return converged_quadrature(lambda order: _centroid(outline, order))


def _centroid(outline: Outline, order: int) -> Array:
    breaks = np.unique([*np.linspace(0.0, 1.0, PIECES + 1), *(joint.s for joint in outline.joints)])
    s, weights = panels(breaks, order)
    slopes = _slopes(order)
    widths = np.diff(breaks)[:, None, None]
    upper, lower = outline.points(s)
    area: Array = np.zeros(())
    first: Array = np.zeros(())
    second: Array = np.zeros(())
    for side, sign in ((upper, 1.0), (lower, -1.0)):
        pieces = side.reshape(*side.shape[:-2], len(breaks) - 1, order, 2)
        rates = ((slopes @ pieces) / widths).reshape(side.shape)
        x, y = side[..., 0], side[..., 1]
        area = area + sign * np.sum(weights * (x * rates[..., 1] - y * rates[..., 0]), axis=-1) / 2.0
        first = first + sign * np.sum(weights * x**2 * rates[..., 1], axis=-1) / 2.0
        second = second - sign * np.sum(weights * y**2 * rates[..., 0], axis=-1) / 2.0
    for start, end in _faces(outline):
        a, b = np.moveaxis(start, -1, 0), np.moveaxis(end, -1, 0)
        step = b - a
        area = area + (a[0] * b[1] - a[1] * b[0]) / 2.0
        first = first + step[1] * (a[0] ** 2 + a[0] * b[0] + b[0] ** 2) / 6.0
        second = second - step[0] * (a[1] ** 2 + a[1] * b[1] + b[1] ** 2) / 6.0
    return concatenated([(first / area)[..., None], (second / area)[..., None]], axis=-1)


def _faces(outline: Outline) -> list[tuple[Array, Array]]:
    """Ends (..., 2) of the straight faces of blunt edges, round the section as the upper side runs."""
    first, last = outline.leading_edge, outline.trailing_edge
    found = [(last.upper.point, last.lower.point)] if last.kind == "blunt" else []
    return found + ([(first.lower.point, first.upper.point)] if first.kind == "blunt" else [])


def _slopes(order: int) -> Reals:
    """Derivatives (order, order) at Gauss points of [0, 1] of the polynomial through values there, barycentric."""
    nodes = gauss(order)[0]
    differences = nodes[:, None] - nodes + np.eye(order)
    shares = 1.0 / np.prod(4.0 * differences, axis=1)
    matrix = shares / shares[:, None] / differences
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -np.sum(matrix, axis=1))
    return matrix
