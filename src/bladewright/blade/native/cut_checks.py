"""The meridians of cuts, and what is refused: cuts that miss the blade, cross it twice or leave nothing of it."""

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.cut_faces import along
from bladewright.blade.native.cut_lines import (
    Crossing,
    Found,
    Lines,
    continued,
    crossing,
    in_meridian,
    real_curve,
    searched,
)
from bladewright.blade.native.end_faces import EDGES
from bladewright.errors import DesignError
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.surface import Surface

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

ACROSS = np.linspace(0.0, 1.0, 33)
"""Places along the span at which the cut of an edge is searched."""
ALONG = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, 49)) ** 2
"""Places along the sides at which the cut of an end is searched, denser at the edges."""
ON_FACES = np.linspace(0.0, 1.0, 5)
"""The same on the faces of blunt edges."""
ON_THE_CUT = 201
"""Points of a cut at which its radius is looked at."""
LEAST_LEFT = 0.02
"""Least share of a line, from edge to edge or from end to end, that cuts may leave: less is no blade."""


def meridian_of_cut(blade: Blade, design: "RowDesign", name: str) -> Curve:
    """The meridian (x, r) [m] of a cut, continued straight past the blade; from hub to tip, or along the flow.

    Raises DesignError where it crosses the axis that the blade turns about.
    """
    line = getattr(design.cut, name).line(design.metre).curve()
    revolved = blade.plain.exact.mapping.revolved
    low, high = line.domain
    lowest = float(np.min(np.real(line(np.linspace(low, high, ON_THE_CUT))[:, 1])))
    if revolved and lowest < 0.0:
        raise DesignError(
            f"cut.{name}: its curve reaches down to r = {lowest / design.metre:.5g} {design.length_unit}: it must stay "
            "above the axis; move its points"
        )
    points = np.concatenate(
        [np.real(in_meridian(side.control_points.reshape(-1, 3), revolved)) for side in blade.sides]
    )

    def reach(point: Reals) -> float:
        return float(np.max(length(points - point)))

    meridian = continued(line, reach, revolved=revolved)
    # it runs as the places do at which the first and the last line meet it; elsewhere, as those nearest to their ends
    lines = _lines(blade, blade.sides[0], name, np.array([0.0, 1.0]))
    met_by = searched(lines.real(), real_curve(meridian))
    if all(len(each) == 1 for each in met_by):
        return meridian if met_by[0][0][1] < met_by[1][0][1] else run_back(meridian)
    upper = np.real(in_meridian(blade.sides[0].control_points[[0, 0, -1, -1], [0, -1, 0, -1]], revolved))
    ends = {"leading_edge": (0, 1), "trailing_edge": (2, 3), "hub": (0, 2), "tip": (1, 3)}[name]
    return along(meridian, *upper[list(ends)])


def check_edge_cut(blade: Blade, design: "RowDesign", edge: str, meridian: Curve) -> dict[str, Found]:
    """About where both sides' lines of constant v meet the cut of an edge, which each must do once."""
    upper, lower = (_once(_lines(blade, side, edge, ACROSS), design, edge, meridian) for side in blade.sides)
    back = blade.plain.exact.survey.back
    if edge == EDGES[1] and back is not None and EDGES[1] not in blade.walls:
        most = max(float(np.max(found.place)) for _, found in (upper, lower))
        if most > back:
            raise DesignError(
                f"{_said(design, edge)}: the cut crosses the face of the trailing edge, which is blunt already, at "
                f"u = {most:.4f} of the sides, where that face begins at {back:.4f}: move the cut upstream of it, or "
                f"leave cut.{edge} out"
            )
    return {"upper": upper, "lower": lower}


def mirrored_edges(blade: Blade, cut: Mapping[str, Curve]) -> tuple[bool, bool]:
    """Whether the lower side mirrors the upper one at the edges: where they are round, and are not `cut`."""
    first, last = (
        own is None and edge not in blade.walls and edge not in cut
        for own, edge in zip(blade.plain.exact.survey.lower_edges(), EDGES, strict=True)
    )
    return first, last


def check_end_cut(blade: Blade, design: "RowDesign", end: str, meridian: Curve) -> dict[str, Found]:
    """About where the lines along the span of all native faces meet the cut of an end, which each must do once."""
    faces = dict(zip(("upper", "lower"), blade.sides, strict=True))
    found = {name: _once(_lines(blade, face, end, ALONG), design, end, meridian) for name, face in faces.items()}
    native = {name: face for name, face in blade.surfaces.items() if name in EDGES and name not in blade.walls}
    for name, face in native.items():
        if isinstance(face, Surface):
            found[name] = _once(_lines(blade, face, end, ON_FACES), design, end, meridian)
    return found


def between_cuts(
    design: "RowDesign", names: tuple[str, str], near: Mapping[str, Mapping[str, Found]]
) -> tuple[Reals, Reals]:
    """Parameters (k,) at which the blade's lines begin and end between the cuts `names`: 0 and 1 where there is none.

    Raises DesignError where less than a little of some line is left.
    """
    low, high = (
        np.concatenate([found.place for _, found in near[name].values()]) if name in near else np.array([at])
        for name, at in zip(names, (0.0, 1.0), strict=True)
    )
    _check_left(design, names, low, high)
    return low, high


def _check_left(design: "RowDesign", names: tuple[str, str], low: Reals, high: Reals) -> None:
    least = float(np.min(high - low))
    if least >= LEAST_LEFT:
        return
    given = [name for name in names if getattr(design.cut, name) is not None]
    what = "the cuts cross, or leave" if len(given) == 2 else "the cut leaves"
    raise DesignError(
        f"{' and '.join(_said(design, name) for name in given)}: {what} {max(least, 0.0):.2g} of a line of the blade, "
        f"at least {LEAST_LEFT:g} is needed; move {'one of them' if len(given) == 2 else 'it'} outwards"
    )


def met(lines: Lines, meridian: Curve, near: Crossing, key: str) -> Crossing:
    """Where lines meet a cut; raises DesignError where one does not."""
    found = crossing(lines, meridian, near)
    if found is None:
        raise DesignError(
            f"{key}: the cut does not meet the blade once and clearly on every line: it runs along the blade's own "
            "lines, or has a sharp bend beside the blade; give a smoother curve, or one more across"
        )
    return found


def about(at: Reals, found: Found) -> Crossing:
    """About where lines at places (k,) meet a cut, from those that were searched."""
    places, near = found
    return Crossing(np.interp(at, places, np.real(near.place)), np.interp(at, places, np.real(near.t)))


def _lines(blade: Blade, face: Surface, name: str, at: Reals) -> Lines:
    return Lines(face=face, along="u" if name in EDGES else "v", at=at, revolved=blade.plain.exact.mapping.revolved)


def _once(lines: Lines, design: "RowDesign", name: str, meridian: Curve) -> Found:
    """Where each line meets the meridian; DesignError where one does not, or more than once."""
    found = searched(lines.real(), real_curve(meridian))
    counts = np.array([len(each) for each in found])
    if np.all(counts == 1):
        place, t = np.transpose([each[0] for each in found])
        return lines.at, met(lines.real(), real_curve(meridian), Crossing(place, t), f"cut.{name}")
    raise DesignError(f"{_said(design, name)}: {_why_not(lines.real(), counts, design, name)}")


def _why_not(lines: Lines, counts: Reals, design: "RowDesign", name: str) -> str:
    other = "v" if lines.along == "u" else "u"
    if np.max(counts) > 1:
        worst = int(np.argmax(counts))
        return (
            f"it crosses one side of the blade {counts[worst]:.0f} times along {other} = {lines.at[worst]:.3g}: a cut "
            f"must cross each side once from {'end to end' if other == 'v' else 'edge to edge'}; move it further into "
            "the blade, or give a curve that does"
        )
    missed = lines.at[counts == 0]
    where = "" if len(missed) == len(lines.at) else f" from {other} = {missed[0]:.3g} to {missed[-1]:.3g}"
    limits = _limits(lines, design, name)
    return f"it misses the blade{where}: a cut must cross it all along; {limits}"


def _limits(lines: Lines, design: "RowDesign", name: str) -> str:
    """Between which values a radius or an axial place crosses all lines, or where a curve is to run."""
    _, points = lines.sampled()
    points = points / design.metre
    unit, key = design.length_unit, fields(getattr(design.cut, name))[0].name
    if key in ("x", "radius"):
        values = points[..., 0 if key == "x" else 1]
        low, high = np.round([np.max(np.min(values, axis=1)), np.min(np.max(values, axis=1))], 9)
        if low < high:
            return f"cut.{name}.{key} must lie between {low:.5g} and {high:.5g} {unit}"
        return f"no {key} does, so give a curve in (x, r)"
    ends = ", ".join(f"({x:.4g}, {r:.4g})" for x, r in (points[0, 0], points[0, -1], points[-1, -1], points[-1, 0]))
    return f"let the curve, which is continued straight past its ends, cross the blade inside (x, r) = {ends} {unit}"


def _said(design: "RowDesign", name: str) -> str:
    """The cut's key, with its value where it is a number."""
    cut = getattr(design.cut, name)
    key = fields(cut)[0].name
    value = np.real(getattr(cut, key)) if key in ("x", "radius") else None
    return f"cut.{name}" if value is None else f"cut.{name}.{key} is {float(value):g} {design.length_unit}"
