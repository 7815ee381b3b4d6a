"""The stream lines of a T-Blade3 case, and where the blade's edges lie on them, by T-Blade3's own rules."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.flow_path.intersections import intersections
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve
from bladewright.designs import Point
from bladewright.errors import DesignError, FileError
from bladewright.files.tblade3.case import TBlade3Case
from bladewright.files.tblade3.section_values import section_spans
from bladewright.nurbs.basis import Reals

NEAR_AXIS = 1e-5
"""Radius, in T-Blade3's lengths without dimension, below which a point of a stream line lies on the axis: T-Blade3's
own constant."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CaseStreamLines:
    """The m stream lines of a case, with their offsets, and m' of the blade's edges on them.

    m' is counted from the first point of a line: each chord divided by the mean radius of its ends. x and r are cubic
    splines of m', with second derivative 0 at the first point and third derivative 0 at the last.
    """

    meridians: tuple[ThroughPoints, ...]
    """stream lines in the case's unit"""
    lines: tuple[MeridionalCurve, ...]
    """the same in metres"""
    edges: tuple[ThroughPoints, ThroughPoints]
    """the leading- and the trailing-edge curve as the case gives them, in its unit"""
    leading: Reals
    """(m,) m' at the leading edge"""
    trailing: Reals
    """(m,) m' at the trailing edge"""
    dropped: int = 0
    """number of points that an offset would move beyond the axis, and that are left out"""

    @cached_property
    def totals(self) -> Reals:
        """(m,) m' of the stream lines' last points."""
        return np.array([_counted(line) for line in self.lines])

    def at(self, places: Reals, order: int = 0) -> Reals:
        """(x, r) [m] (m, 2) at m' (m,), one on each line, or derivatives by m'; its ends are continued."""
        found = [
            np.real(line.values(np.array([place / total]), order)[0]) / total**order
            for line, place, total in zip(self.lines, places, self.totals, strict=True)
        ]
        return np.array(found)

    @cached_property
    def slopes(self) -> tuple[Reals, Reals]:
        """phi = atan(dr/dx) (m,) [rad] of the stream lines at the leading and the trailing edge."""
        found = []
        for places in (self.leading, self.trailing):
            x, r = self.at(places, 1).T
            upright = np.where(x == 0.0, np.copysign(0.5 * np.pi, r), 0.0)
            found.append(np.where(x == 0.0, upright, np.arctan(r / np.where(x == 0.0, 1.0, x))))
        return found[0], found[1]

    @property
    def distances(self) -> tuple[Reals, Reals]:
        """Distances (m,) [m] of the sections from the first one, along the leading and along the trailing edge."""
        steps = [np.diff(self.at(places), axis=0) for places in (self.leading, self.trailing)]
        lead, trail = (np.append(0.0, np.cumsum(np.sqrt(np.sum(each**2, axis=-1)))) for each in steps)
        return lead, trail

    @cached_property
    def spans(self) -> Reals:
        """(m,) spans of the sections, measured by the radius of their leading edges, or by x in a radial machine.

        T-Blade3 takes a machine as radial where the last stream line is somewhere steeper than 45 degrees, and the
        first and the last line start at the same radius.
        """
        first, last = self.meridians[0].points[0], self.meridians[-1].points[0]
        line = self.lines[-1]
        rates = np.real(line.values(line.breaks, 1))
        steep = bool(np.any(rates[:, 1] ** 2 >= rates[:, 0] ** 2))
        return section_spans(self.at(self.leading), along_axis=steep and first.r == last.r)


def case_stream_lines(case: TBlade3Case) -> CaseStreamLines:
    """The stream lines of a case, and where its edge curves cross them.

    Raises FileError where a stream line is none, or an edge curve does not cross it once.
    """
    meridians = [_stream_line(case, index) for index in range(len(case.streamlines))]
    metre, dropped = case.unit_length / case.scale, 0
    for index, offset, side in ((0, case.hub_offset, 1.0), (len(meridians) - 1, case.tip_offset, -1.0)):
        if offset:
            points = _shifted(meridians[index], side * offset * case.scale)
            kept = [point for point in points if point[1] > 0.0]
            dropped += len(points) - len(kept)
            meridians[index] = _through(case, f"streamline {index + 1}, as it is offset,", kept, "conformal")
    lines = tuple(each.line(metre) for each in meridians)
    edges = _edge(case, "leading", case.leading_curve), _edge(case, "trailing", case.trailing_curve)
    places = [
        np.array([_met(case, line, edge, name, index) for index, line in enumerate(lines, 1)])
        for name, edge in zip(("leading", "trailing"), (each.line(metre) for each in edges), strict=True)
    ]
    return CaseStreamLines(
        meridians=tuple(meridians),
        lines=lines,
        edges=edges,
        leading=places[0],
        trailing=places[1],
        dropped=dropped,
    )


def _stream_line(case: TBlade3Case, index: int) -> ThroughPoints:
    first, *others = case.streamlines[index]
    # a point near the axis replaces the first point
    first = next((point for point in reversed(others) if point[1] < NEAR_AXIS), first)
    kept = [first, *(point for point in others if point[1] >= NEAR_AXIS)]
    return _through(case, f"streamline {index + 1}", [(x * case.scale, r * case.scale) for x, r in kept], "conformal")


def _edge(case: TBlade3Case, name: str, curve: tuple[tuple[float, float], ...]) -> ThroughPoints:
    return _through(case, f"the {name}-edge curve", [(x * case.scale, r * case.scale) for x, r in curve], "length")


def _through(case: TBlade3Case, what: str, points: list[tuple[float, float]], spacing: str) -> ThroughPoints:
    try:
        return ThroughPoints(points=tuple(Point(*each) for each in points), spacing=spacing, ends="released")  # type: ignore[arg-type]
    except DesignError as error:
        raise FileError(
            f"'{case.file}': {what} cannot be splined: {error} (T-Blade3 breaks its spline at a repeated point, which "
            "is not translated)"
        ) from error


def _shifted(line: ThroughPoints, by: float) -> list[tuple[float, float]]:
    """The points of a stream line moved along their normals, to the right of its direction."""
    own = line.line(1.0)
    at = np.real(own.values(own.breaks))
    rate = np.real(own.values(own.breaks, 1))
    normals = np.stack([rate[:, 1], -rate[:, 0]], axis=-1)
    moved = at + by * normals / np.sqrt(np.sum(rate**2, axis=-1, keepdims=True))
    return [(float(x), float(r)) for x, r in moved]


def _met(case: TBlade3Case, line: MeridionalCurve, edge: MeridionalCurve, name: str, index: int) -> float:
    """m' where an edge curve crosses a stream line."""

    def position(t: Reals, order: int) -> Reals:
        return np.real(line.values(t[0], order))[None]

    try:
        place = intersections(
            position, (0.0, 1.0), edge, f"the {name}-edge curve", [f"the stream line of section {index}"]
        )[0][0]
    except DesignError as error:
        raise FileError(f"'{case.file}': {error}") from error
    return float(np.real(place)) * _counted(line)


def _counted(line: MeridionalCurve) -> float:
    """m' of a stream line's last point."""
    return 0.0 if line.counted is None else float(line.counted.real)
