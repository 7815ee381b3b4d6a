"""The meridional view of a blade: every line that a design or its build has in (x, r), or in (x, z) of a cascade."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.design.meridional_curve import Meridian
from bladewright.blade.flow_path.quasi_orthogonals import parameters_at
from bladewright.frozen import FrozenMapping
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

if TYPE_CHECKING:
    from bladewright.blade.exact.sectioned import ExactSectionedBlade
    from bladewright.blade.exact.unified import ExactUnifiedBlade

COUNT = 201
"""Points of a drawn curve."""
STREAM_LINES = np.linspace(0.1, 0.9, 9)
"""Span fractions of the stream lines that are drawn."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ViewLine:
    """A curve as the design gives it."""

    points: Reals
    """(n, 2) [m]"""
    beyond: tuple[Reals, ...] = ()
    """(n, 2) its continuations past the blade, which the design does not give [m]"""
    given: Reals
    """(k, 2) the points that the design gives [m]"""
    polygon: bool
    """whether those are control points or corners, and do not lie on the curve"""


@dataclass(frozen=True, kw_only=True, eq=False)
class MeridionalView:
    """The lines by what they are."""

    lines: Mapping[str, ViewLine]
    """`hub`, `shroud`, `leading_edge` and `trailing_edge`"""
    stream_lines: tuple[Reals, ...]
    """(n, 2) at `STREAM_LINES` [m]"""
    stream_surfaces: tuple[ViewLine, ...] = ()
    """those that are given"""
    quasi_orthogonals: tuple[Reals, ...] = ()
    """(n, 2) those that are given [m]"""
    tip: Reals | None = None
    """(n, 2) the clearance surface [m]"""
    clearance: tuple[float, ...] = ()
    """its distances from the wall at the leading and the trailing edge [m]"""


def channel_view(exact: "ExactUnifiedBlade") -> MeridionalView:
    """The view of a blade in a channel of four curves."""
    inside, u = np.linspace(0.0, 1.0, COUNT), np.linspace(-exact.before, 1.0 + exact.after, COUNT)
    path, metre = exact.design.flow_path, exact.design.metre
    lines: dict[str, ViewLine] = {}
    for name in ("hub", "shroud", "leading_edge", "trailing_edge"):
        if path is not None and name in ("hub", "shroud"):
            lines[name] = _line(getattr(path, name), np.real(exact.full_channel.curve(name)(inside)), metre)
            continue
        curve = exact.full_channel.curve(name)
        beyond = (u[u < 0.0], u[u > 1.0]) if name in ("hub", "shroud") else ()
        lines[name] = ViewLine(
            points=np.real(curve(inside)),
            beyond=tuple(np.real(curve(part)) for part in beyond),
            given=np.real(curve.control_points),
            polygon=True,
        )
    clearance = exact.clearance
    tip = None if clearance is None else np.real(exact.channel.curve(clearance.wall)(inside))
    clearances = () if clearance is None else np.real(clearance.real().distance(inside[[0, -1]])).tolist()
    return MeridionalView(
        lines=FrozenMapping(lines),
        stream_lines=tuple(np.real(exact.sections(STREAM_LINES).lines.position(u))),
        tip=tip,
        clearance=tuple(clearances),
    )


def flow_path_view(exact: "ExactSectionedBlade") -> MeridionalView:
    """The view of a blade in a flow path; edges without a given curve, or shifted ones, are shown as they are built."""
    design, surfaces = exact.design, exact.surfaces.real()
    path, metre = design.flow_path, UNITS[design.length_unit]
    t = np.linspace(surfaces.low, surfaces.high, COUNT)
    v = np.linspace(0.0, 1.0, COUNT)
    drawn = {
        name: _line(getattr(path, name), np.real(surfaces.wall(name).values(v)), metre) for name in ("hub", "shroud")
    }
    built = np.real(exact.sections(v).lines.position(np.array([0.0, 1.0])))
    shifted = any(law is not None for law in (design.sweep, design.lean, design.conformal_sweep))
    for end, name in enumerate(("leading_edge", "trailing_edge")):
        given, line = getattr(design, name), exact.placement.edge_curves[end]
        drawn[name] = (
            ViewLine(points=built[:, end], given=np.empty((0, 2)), polygon=False)
            if shifted or given is None or line is None
            else _line(given, np.real(line.values(v)), metre)
        )
    given = zip(path.stream_surfaces, surfaces.curves[1:-1], strict=True)
    on_hub = np.array([float(np.real(pair[0])) for pair in path.quasi_orthogonals])
    joined = (
        surfaces.grid(parameters_at(surfaces.matches[0], on_hub, surfaces.low, surfaces.high), v)[0]
        if len(on_hub)
        else ()
    )
    return MeridionalView(
        lines=FrozenMapping(drawn),
        stream_lines=tuple(np.real(surfaces.position(STREAM_LINES, np.tile(t, (len(STREAM_LINES), 1))))),
        stream_surfaces=tuple(_line(meridian, np.real(each.values(v)), metre) for meridian, each in given),
        quasi_orthogonals=tuple(np.real(joined)),
    )


def _line(meridian: Meridian, points: Reals, metre: float) -> ViewLine:
    given = metre * np.array([[np.real(point.x), np.real(point.r)] for point in meridian.given])
    return ViewLine(points=points, given=given, polygon=meridian.polygon)
