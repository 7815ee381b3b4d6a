"""Laws and curves of designs whose numbers of control points a match may choose, and the nearest of other numbers."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from bladewright.designs import Law, Point, Stations, value_at
from bladewright.errors import DesignError
from bladewright.fitting.free_parameters import scales_of
from bladewright.fitting.models.designs import SINGLE_SECTION
from bladewright.numerics.elementary import cumulative_length, length
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.laws import Span, law_basis, law_points, number_paths, plain_law, stations_of, with_values
from bladewright.section.segmented.part import side_joints
from bladewright.section.segmented.segment import DEGREE, control_points, segment_knots
from bladewright.section.segmented.skin import SEGMENTS

Counts = tuple[int, ...]
"""numbers of control points of a law along its directions, or of several curves"""
MOST_CHORD, MOST_SPAN, MOST_CURVE = 24, 12, 12
"""control points along the chord, along the span and of a meridional curve at most (design/matching_constants.md)"""
LEAST_SHARE = 0.5
"""share of a law's smallest control point below which none of the resized law falls (design/matching_constants.md)"""
COMPARED_PLACES: Reals = np.linspace(0.0, 1.0, 101)
"""parameters at which laws and curves are compared"""


@dataclass(frozen=True, kw_only=True, eq=False)
class ResizableLaw(ABC):
    """A law whose number of control points may change by itself; or curves that share points."""

    name: str
    """path of its field"""
    fewest: Counts
    """numbers of control points that it has at least"""
    most: Counts
    """at most"""
    rich: Counts
    """its numbers of control points in a rich structure"""
    holds_corners: bool = False
    """whether it may change though some of its parameters are held: the corners of a channel, the largest of a row"""
    along_span: tuple[int, ...] = ()
    """places of the numbers along the span among its counts"""

    @abstractmethod
    def counts_of(self, design: Any) -> Counts:
        """Its numbers of control points in a design."""

    @abstractmethod
    def paths(self, design: Any) -> list[str]:
        """The parameters (k,) that are its control points' numbers."""

    @abstractmethod
    def embedding(self, counts: Counts, other: Counts) -> Reals:
        """Its numbers (k, j) with some counts that are nearest to those of the law with others."""

    def offset(self, design: Any, counts: Counts, other: Counts) -> Reals:  # noqa: ARG002 - the contract's
        """What is added (k,) to the embedding of numbers with other counts: ends that no number of the law moves."""
        return np.zeros(1)

    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:  # noqa: ARG002 - the contract's
        """The value of its field with other counts, or at stations along the span, that is nearest to a design's."""
        own, values = self.counts_of(design), design.parameters()
        if counts == own:
            return value_at(design, self.name)
        numbers = np.array([values[path] for path in self.paths(design)], dtype=float)
        return self.with_numbers(
            design, counts, self.embedding(counts, own) @ numbers + self.offset(design, counts, own)
        )

    def with_numbers(self, design: Any, counts: Counts, numbers: Reals) -> Any:
        """The value of its field with other counts, of these numbers (k,); laws that resize themselves need none."""
        raise NotImplementedError

    def stations_of(self, design: Any) -> Stations | None:  # noqa: ARG002 - the contract's
        """The stations at which it is given in a design; their values do not count."""
        return None

    def settled(self, before: Any, after: Any) -> Any:  # noqa: ARG002 - the contract's
        """A design after laws were resized, with what changes besides where this one was."""
        return after


@dataclass(frozen=True, kw_only=True, eq=False)
class Row:
    """Control points in a row, along the chord or the span, whose number may change."""

    fewest: int
    most: int
    optional: bool = False
    """whether the row may be left out, which is as if it were zero; its fewest control points then count as one"""
    held: Counts = (0, 0)
    """control points before and behind the row that its curve has besides, and that stay"""
    places: Callable[[int], Reals] | None = None
    """the places along the row of all control points of a curve by their number; None where they are even"""
    compared: Reals = field(default_factory=lambda: COMPARED_PLACES)
    """(m,) places along the row at which rows are compared"""

    def points(self, count: int) -> int:
        """How many control points a count stands for."""
        return count + self.fewest - 1 if count and self.optional else count

    def count(self, points: int) -> int:
        """The count of a row of so many control points."""
        return points - self.fewest + 1 if points and self.optional else points

    def basis(self, count: int) -> Reals:
        """Values (m, points) along the row of the basis functions of the control points."""
        first, last = self.held
        points, at = self.points(count), self.compared
        if not points:
            return np.zeros((len(at), 0))
        if self.places is not None:
            along = law_basis(points + first + last, at) @ self.places(points)
            at = np.interp(at, along, at)
        return law_basis(points + first + last, at)[:, first : first + points]

    @cached_property
    def embedding(self) -> Callable[[int, int], Reals]:
        """The control points (n, m) of a row of n that are nearest to each of m others, by both counts."""
        return cache(self._embedding)

    def _embedding(self, count: int, other: int) -> Reals:
        if count == other:
            return np.eye(self.points(count))
        return np.asarray(np.linalg.lstsq(self.basis(count), self.basis(other), rcond=None)[0])


ONE, ALONG_SPAN = Row(fewest=1, most=1), Row(fewest=1, most=MOST_SPAN)
"""no row but one control point, and those of a law along the span"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanLaw(ResizableLaw):
    """A law along the span, or a row of them along the chord."""

    row: Row = ONE
    """along the chord"""
    along_span: tuple[int, ...] = (1,)

    def laws(self, design: Any) -> list[Law]:
        """Its laws along the span, one for each control point along the chord."""
        value = value_at(design, self.name)
        return [value] if self.row is ONE else list(value)

    def counts_of(self, design: Any) -> Counts:
        laws = self.laws(design)
        return self.row.count(len(laws)), max((len(law_points(law)) for law in laws), default=1)

    def paths(self, design: Any) -> list[str]:
        laws = self.laws(design)
        stems = [self.name] if self.row is ONE else [f"{self.name}[{i}]" for i in range(len(laws))]
        return [path for law, stem in zip(laws, stems, strict=True) for path in number_paths(law, stem)]

    def stations_of(self, design: Any) -> Stations | None:
        found = [each for law in self.laws(design) if (each := stations_of(law))]
        return replace(found[0], values=(0.0,) * len(found[0].span)) if found else None

    def embedding(self, counts: Counts, other: Counts) -> Reals:
        along, across = self.row.embedding(counts[0], other[0]), ALONG_SPAN.embedding(counts[1], other[1])
        return np.asarray(np.kron(along, across))

    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:
        along, laws = self.counts_of(design)[0], self.laws(design)
        across = counts[1] if stations is None else len(stations.span)
        rows = np.array([_nearest_numbers(law, across, stations) for law in laws]).reshape(len(laws), across)
        if along != counts[0]:
            rows = self.row.embedding(counts[0], along) @ rows
        same = along == counts[0] and all(len(law_points(law)) == across for law in laws)
        if laws and not same:
            scales = scales_of(design, self.paths(design), 1.0)
            smallest = min(float(np.min(law_points(law))) for law in laws)
            low = LEAST_SHARE * smallest if smallest > 0.0 else np.max(scales.low)
            rows = np.clip(rows, low, np.min(scales.high))
        found = tuple(plain_law(row) if stations is None else with_values(stations, row) for row in rows)
        return found[0] if self.row is ONE else found


def _nearest_numbers(law: Law, count: int, stations: Stations | None) -> Reals:
    """Control points (count,) of the law that is nearest to another, or its values at stations."""
    if stations is not None:
        return np.real(Span(np.array(stations.span)).values(law))
    if stations_of(law) is None and len(law_points(law)) == count:
        return np.array(law_points(law))
    values = np.real(Span(COMPARED_PLACES).values(law))
    return np.asarray(np.linalg.lstsq(law_basis(count, COMPARED_PLACES), values, rcond=None)[0])


@final
class HeightsLaw(SpanLaw):
    """The heights of a side by suction and pressure, whose tangents stand on the same knots."""

    def settled(self, before: Any, after: Any) -> Any:
        """A side leaves its corner as fast where its first control point is as much nearer as the knots are."""
        ratio = (len(self.laws(before)) + 1.0) / (len(self.laws(after)) + 1.0)
        for tangent in (self.name.replace("heights", f"tangent_{way}") for way in ("in", "out")):
            law = value_at(after, tangent)
            if law is not None and stations_of(law) is None:
                scaled = after.changed({tangent: plain_law(ratio * np.array(law_points(law)))})
                after = scaled if ratio >= 1.0 or _has_sections(scaled) else after
        return after


def _has_sections(design: Any) -> bool:
    """Whether the sides leave the edges; with short tangents they turn back."""
    span = Span(COMPARED_PLACES[::10])
    try:
        design.section.outline(span).check_limits([""] * len(span.v))
    except DesignError:
        return False
    return True


RICH_CHANNEL = (9, 9, 6, 6)
"""control points of the edges, of hub and of shroud of a rich structure, which hold cubic curves of 4, 5 and 6
(design/matching_constants.md)"""
RICH_CURVE, RICH_SEGMENT = 8, 5
"""points on an edge curve or a wall of a rich structure, and inner control points of a segment, which hold segments of
one (design/matching_constants.md)"""
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
    fewest: Counts = (2,) * 4
    most: Counts = (MOST_CURVE,) * 4
    rich: Counts = RICH_CHANNEL
    holds_corners: bool = True
    along_span: tuple[int, ...] = (0, 1)

    def counts_of(self, design: Any) -> Counts:
        walls = {"hub": 2, "shroud": 2}
        return tuple(len(getattr(design.channel, name)) + walls.get(name, 0) for name in CHANNEL_CURVES)

    def paths(self, design: Any) -> list[str]:
        curves = [(name, len(getattr(design.channel, name))) for name in CHANNEL_CURVES]
        return [f"channel.{name}[{i}].{axis}" for name, count in curves for i in range(count) for axis in "xr"]

    def embedding(self, counts: Counts, other: Counts) -> Reals:
        found = np.zeros((sum(counts) - 4, sum(other) - 4))
        for curve, places in enumerate(zip(_places(counts), _places(other), strict=True)):
            found[np.ix_(*places)] = _curve_embedding(counts[curve], other[curve], self.degree)
        return np.asarray(np.kron(found, np.eye(2)))

    def with_numbers(self, design: Any, counts: Counts, numbers: Reals) -> Any:
        curves = _split(numbers.reshape(-1, 2), counts)
        points = (tuple(Point(*row) for row in rows.tolist()) for rows in curves)
        return replace(design.channel, **dict(zip(CHANNEL_CURVES, points, strict=True)))


def _split(rows: NDArray[Any], counts: Counts) -> list[NDArray[Any]]:
    """The rows of each curve among those of a channel's points: edges, then hub and shroud without the corners."""
    return np.split(rows, np.cumsum([counts[0], counts[1], counts[2] - 2]))


def _places(counts: Counts) -> list[list[int]]:
    """The places of each curve's points among those of a channel: a wall's ends are the edges' ends."""
    leading, trailing, hub, shroud = (each.tolist() for each in _split(np.arange(sum(counts) - 4), counts))
    return [leading, trailing, [leading[0], *hub, trailing[0]], [leading[-1], *shroud, trailing[-1]]]


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
    fewest: Counts = (2,)
    most: Counts = (MOST_CURVE,)
    rich: Counts = (RICH_CURVE,)
    along_span: tuple[int, ...] = (0,)

    def counts_of(self, design: Any) -> Counts:
        return (len(value_at(design, self.name).points),)

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
    axes: str = "xr"
    fewest: Counts = (FEWEST_ON_WALL,)
    holds_corners: bool = True
    along_span: tuple[int, ...] = ()

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
    most: Counts = (MOST_CHORD,)
    rich: Counts = (RICH_SEGMENT,)

    def counts_of(self, design: Any) -> Counts:
        return (len(value_at(design, self.name).abscissas),)

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

    def with_numbers(self, design: Any, counts: Counts, numbers: Reals) -> Any:  # noqa: ARG002 - the contract's
        abscissas, ordinates = numbers.reshape(-1, 2).T.tolist()
        return replace(value_at(design, self.name), abscissas=tuple(abscissas), ordinates=tuple(ordinates))
