"""Curves of designs whose numbers of control points a match may choose: of a channel, edges, walls and segments."""

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from scipy.interpolate import CubicSpline

from bladewright.designs import Point, Stations, value_at
from bladewright.fitting.model_selection.laws import COMPARED_PLACES, MOST_CHORD, MOST_CURVE, Counts, ResizableLaw
from bladewright.fitting.models.sectioned import SINGLE_SECTION
from bladewright.numerics.elementary import cumulative_length, length
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.segmented.part import side_joints
from bladewright.section.segmented.segment import DEGREE, control_points, segment_knots
from bladewright.section.segmented.skin import SEGMENTS

CHANNEL_CURVES = ("leading_edge", "trailing_edge", "hub", "shroud")
"""the four curves of a channel"""
FEWEST_ON_WALL = 5
"""points of a wall at least: its ends, and three beside the blade (design/matching_constants.md)"""
FINE_PLACES: Reals = np.linspace(0.0, 1.0, 2001)
"""parameters of a curve between which it is taken as linear, within 1e-7 of its length"""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelCurves(ResizableLaw):
    """The four curves of a channel, which share its corners."""

    degree: int
    """highest degree of the curves"""
    holds_corners: bool = True
    along_span: tuple[int, ...] = (0, 1)

    def counts_of(self, design: Any) -> Counts:
        walls = {"hub": 2, "shroud": 2}
        return tuple(len(getattr(design.channel, name)) + walls.get(name, 0) for name in CHANNEL_CURVES)

    def limits(self) -> tuple[Counts, Counts]:
        return (2,) * 4, (MOST_CURVE,) * 4

    def paths(self, design: Any) -> list[str]:
        curves = [(name, len(getattr(design.channel, name))) for name in CHANNEL_CURVES]
        return [f"channel.{name}[{i}].{axis}" for name, count in curves for i in range(count) for axis in "xr"]

    def embedding(self, counts: Counts, other: Counts) -> Reals:
        rows, columns = (np.cumsum([0, each[0], each[1], each[2] - 2, each[3] - 2]) for each in (counts, other))
        found = np.zeros((rows[-1], columns[-1]))
        for curve in range(4):
            part = _curve_embedding(counts[curve], other[curve], self.degree)
            inner = slice(rows[curve], rows[curve + 1]), slice(columns[curve], columns[curve + 1])
            if curve < 2:
                found[inner] = part
                continue
            # a wall's ends are the edges' ends
            corners = [columns[0], columns[1]] if curve == 2 else [columns[1] - 1, columns[2] - 1]
            found[inner] = part[1:-1, 1:-1]
            found[inner[0], corners] = part[1:-1, [0, -1]]
        return np.asarray(np.kron(found, np.eye(2)))

    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:  # noqa: ARG002 - the contract's
        if counts == self.counts_of(design):
            return design.channel
        points = self.nearest_numbers(design, counts).reshape(-1, 2)
        curves = np.split(points, np.cumsum([counts[0], counts[1], counts[2] - 2]))
        changes = {
            name: tuple(Point(*row) for row in rows.tolist()) for name, rows in zip(CHANNEL_CURVES, curves, strict=True)
        }
        return replace(design.channel, **changes)


def _curve_embedding(count: int, other: int, highest: int) -> Reals:
    """Control points (count, other) of the curves nearest to those of other numbers, between the same ends."""
    if count == other:
        return np.eye(count)
    degrees = [min(each - 1, highest) for each in (count, other)]
    own, rhs = (
        basis(uniform_knots(each, degree), degree, COMPARED_PLACES)
        for each, degree in zip((count, other), degrees, strict=True)
    )
    found = np.zeros((count, other))
    found[0, 0] = found[-1, -1] = 1.0
    found[1:-1] = np.linalg.lstsq(own[:, 1:-1], rhs - own @ found, rcond=None)[0]
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class CurvePoints(ResizableLaw):
    """The points of an edge curve, at even steps of the coordinate in which they slide on it; the other is free."""

    axes: str
    """coordinates of its points that are free"""
    along_span: tuple[int, ...] = (0,)

    def counts_of(self, design: Any) -> Counts:
        return (len(value_at(design, self.name).points),)

    def limits(self) -> tuple[Counts, Counts]:
        return (2,), (MOST_CURVE,)

    def paths(self, design: Any) -> list[str]:
        return [f"{self.name}.points[{i}].{axis}" for i in range(*self.counts_of(design)) for axis in self.axes]

    def embedding(self, counts: Counts, other: Counts) -> Reals:
        own, known = self.places(*counts), self.places(*other)
        return np.asarray(np.kron(CubicSpline(known, np.eye(len(known)))(own), np.eye(len(self.axes))))

    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:  # noqa: ARG002 - the contract's
        curve = value_at(design, self.name)
        if self.counts_of(design) == counts:
            return curve
        line = np.real(curve.line(1.0).values(FINE_PLACES))
        way = self.way(line)
        order, at = np.argsort(way), way[0] + self.places(*counts) * (way[-1] - way[0])
        rows = np.stack([np.interp(at, way[order], axis[order]) for axis in line.T], axis=-1)
        return replace(curve, points=tuple(Point(*row) for row in rows.tolist()))

    def way(self, line: Reals) -> Reals:
        """The coordinate (n,) along places (n, 2) of the curve in which its points stand at their places."""
        return np.asarray(line[:, 1 - "xr".index(self.axes)])

    def places(self, count: int) -> Reals:
        """Places (count,) of its points, from 0 to 1."""
        return np.linspace(0.0, 1.0, count)


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class WallPoints(CurvePoints):
    """The points of hub or shroud: two ends, and others at even steps of its length past both edges."""

    stations: tuple[float, ...]
    """of its points, fractions of its length"""
    holds_corners: bool = True
    along_span: tuple[int, ...] = ()

    def limits(self) -> tuple[Counts, Counts]:
        return (FEWEST_ON_WALL,), (MOST_CURVE,)

    def way(self, line: Reals) -> Reals:
        return np.asarray(cumulative_length(line))

    def places(self, count: int) -> Reals:
        if count == len(self.stations):
            return np.array(self.stations)
        return np.array([0.0, *np.linspace(self.stations[1], self.stations[-2], count - 2), 1.0])


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentPoints(ResizableLaw):
    """The inner control points of a segment of an airfoil that stands alone, between ends that its joints give."""

    sign: float
    """1 on the upper side, -1 on the lower one"""
    held: Counts
    """control points that its joints give at its ends"""

    def counts_of(self, design: Any) -> Counts:
        return (len(value_at(design, self.name).abscissas),)

    def limits(self) -> tuple[Counts, Counts]:
        return (max(1, DEGREE + 1 - sum(self.held)),), (MOST_CHORD,)

    def paths(self, design: Any) -> list[str]:
        inner = range(*self.counts_of(design))
        return [f"{self.name}.{axis}[{i}]" for i in inner for axis in ("abscissas", "ordinates")]

    def _basis(self, count: int) -> tuple[Reals, slice]:
        """Values (m, n) of the basis functions of all control points, and which of these are so many inner ones."""
        rows = basis(segment_knots(count + sum(self.held)), DEGREE, COMPARED_PLACES)
        return rows, slice(self.held[0], self.held[0] + count)

    def embedding(self, counts: Counts, other: Counts) -> Reals:
        (own, inner), (known, others) = self._basis(*counts), self._basis(*other)
        return np.asarray(np.kron(np.linalg.lstsq(own[:, inner], known[:, others], rcond=None)[0], np.eye(2)))

    def offset(self, design: Any, counts: Counts, other: Counts) -> Reals:
        number, segment = SEGMENTS.index(self.name.rpartition(".")[2]), value_at(design, self.name)
        joints = side_joints(design.section, self.sign, SINGLE_SECTION)[number : number + 2]
        distance = length(joints[1].point - joints[0].point)
        scales = (np.array([each or 1.0]) for each in (segment.front_scale, segment.rear_scale))
        first, last = (joint.end(distance, scale) for joint, scale in zip(joints, scales, strict=True))
        ends = [control_points(first, np.zeros((1, *each, 2)), last)[0] for each in (counts, other)]
        (own, inner), (known, _) = self._basis(*counts), self._basis(*other)
        return np.linalg.lstsq(own[:, inner], known @ ends[1] - own @ ends[0], rcond=None)[0].ravel()

    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:  # noqa: ARG002 - the contract's
        segment = value_at(design, self.name)
        if counts == self.counts_of(design):
            return segment
        points = self.nearest_numbers(design, counts).reshape(-1, 2)
        return replace(segment, abscissas=tuple(points[:, 0].tolist()), ordinates=tuple(points[:, 1].tolist()))
