"""The laws of designs whose numbers of control points a match may choose, and the nearest ones of other numbers."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, final

import numpy as np
from scipy.interpolate import CubicSpline

from bladewright.designs import Law, Point, Stations, value_at
from bladewright.errors import DesignError
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.laws import (
    Span,
    law_basis,
    law_points,
    number_paths,
    plain_law,
    sampled_at,
    stations_of,
    with_values,
)

Counts = tuple[int, ...]
"""numbers of control points of a law along its directions, or of several curves"""
CHANNEL_CURVES = ("leading_edge", "trailing_edge", "hub", "shroud")
"""the four curves of a channel"""
MOST_SPAN, MOST_CURVE = 12, 12
"""control points along the span and of a meridional curve at most; they bound the time."""
LEAST_SHARE = 0.5
"""share of a law's smallest control point, where that is positive, below which none falls of the law that is resized"""
FEWEST_ON_WALL = 5
"""points of a wall at least: its ends, and three beside the blade"""
COMPARED_PLACES: Reals = np.linspace(0.0, 1.0, 101)
"""parameters at which laws and curves are compared"""
FINE_PLACES: Reals = np.linspace(0.0, 1.0, 2001)
"""parameters of a curve between which it is taken as linear, within 1e-7 of its length"""


@dataclass(frozen=True, eq=False)
class ResizableLaw(ABC):
    """A law whose number of control points may change by itself; or curves that share points."""

    name: str
    """path of its field"""
    rich: Counts
    """its numbers of control points in a rich structure"""
    holds_corners: ClassVar[bool] = False
    """whether it may change though some of its parameters, the corners of a channel, are held"""
    along_span: ClassVar[tuple[int, ...]] = (-1,)
    """places of the numbers along the span among its counts"""

    @abstractmethod
    def counts_of(self, design: Any) -> Counts:
        """Its numbers of control points in a design."""

    @abstractmethod
    def limits(self) -> tuple[Counts, Counts]:
        """Fewest and most of them."""

    @abstractmethod
    def paths(self, design: Any) -> list[str]:
        """The parameters (k,) that are its control points' numbers."""

    @abstractmethod
    def embedding(self, counts: Counts, other: Counts) -> Reals:
        """Its numbers (k, j) with some counts that are nearest to those of the law with others."""

    def offset(self, design: Any, counts: Counts, other: Counts) -> Reals:  # noqa: ARG002 - the contract's
        """What is added (k,) to the embedding of numbers with other counts: ends that no number of the law moves."""
        return np.zeros(1)

    @abstractmethod
    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:
        """The value of its field with other counts, or at stations along the span, that is nearest to a design's."""

    def stations_of(self, design: Any) -> Stations | None:  # noqa: ARG002 - the contract's
        """The stations at which it is given in a design; their values do not count."""
        return None

    def settled(self, before: Any, after: Any) -> Any:  # noqa: ARG002 - the contract's
        """A design after laws were resized, with what changes besides where this one was."""
        return after


@dataclass(frozen=True, kw_only=True, eq=False)
class Chordwise:
    """A row of control points along the chord whose number may change."""

    fewest: int
    most: int
    optional: bool = False
    """whether the row may be left out, which is as if it were zero; its fewest control points then count as one"""
    held: Counts = (0, 0)
    """control points before and behind the row that its curve has besides, and that stay"""
    by_ratio: bool = False
    """whether only the ratios of its numbers count"""
    places: Callable[[int], Reals] | None = None
    """the places along the chord of all control points of a curve by their number; None where they are even"""
    compared: Reals = field(default_factory=lambda: COMPARED_PLACES)
    """(m,) places along the chord at which rows are compared"""

    def points(self, count: int) -> int:
        """How many control points a count stands for."""
        return count + self.fewest - 1 if count and self.optional else count

    def count(self, points: int) -> int:
        """The count of a row of so many control points."""
        return points - self.fewest + 1 if points and self.optional else points

    def basis(self, count: int) -> Reals:
        """Values (m, points) along the chord of the basis functions of the control points."""
        first, last = self.held
        points, at = self.points(count), self.compared
        if not points:
            return np.zeros((len(at), 0))
        if self.places is not None:
            along = law_basis(points + first + last, at) @ self.places(points)
            at = np.interp(at, along, at)
        return law_basis(points + first + last, at)[:, first : first + points]

    def embedding(self, count: int, other: int) -> Reals:
        """Control points of the rows nearest to those of another count."""
        if count == other:
            return np.eye(self.points(count))
        return np.asarray(np.linalg.lstsq(self.basis(count), self.basis(other), rcond=None)[0])


ONE_LAW = Chordwise(fewest=1, most=1)
"""a law along the span that belongs to no row"""


def law_embedding(count: int, other: int) -> Reals:
    """Control points (count, other) of the laws along the span nearest to those of another number."""
    if count == other:
        return np.eye(count)
    rows = law_basis(count, COMPARED_PLACES), law_basis(other, COMPARED_PLACES)
    return np.asarray(np.linalg.lstsq(*rows, rcond=None)[0])


@dataclass(frozen=True, eq=False)
class SpanLaw(ResizableLaw):
    """A law along the span, or a row of them along the chord."""

    row: Chordwise = ONE_LAW
    spanwise: bool = True
    """whether it may vary along the span"""
    allowed: tuple[float, float] = (-np.inf, np.inf)
    """within which they stay"""

    def laws(self, design: Any) -> list[Law]:
        """Its laws along the span, one for each control point along the chord."""
        value = value_at(design, self.name)
        return [value] if self.row is ONE_LAW else list(value)

    def counts_of(self, design: Any) -> Counts:
        laws = self.laws(design)
        return self.row.count(len(laws)), max((len(law_points(law)) for law in laws), default=1)

    def limits(self) -> tuple[Counts, Counts]:
        return (0 if self.row.optional else self.row.fewest, 1), (self.row.most, MOST_SPAN if self.spanwise else 1)

    def paths(self, design: Any) -> list[str]:
        laws = self.laws(design)
        stems = [self.name] if self.row is ONE_LAW else [f"{self.name}[{i}]" for i in range(len(laws))]
        return [path for law, stem in zip(laws, stems, strict=True) for path in number_paths(law, stem)]

    def stations_of(self, design: Any) -> Stations | None:
        found = [each for law in self.laws(design) if (each := stations_of(law))]
        return replace(found[0], values=(0.0,) * len(found[0].span)) if found else None

    def embedding(self, counts: Counts, other: Counts) -> Reals:
        return np.asarray(np.kron(self.row.embedding(counts[0], other[0]), law_embedding(counts[1], other[1])))

    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:
        along, laws = self.counts_of(design)[0], self.laws(design)
        if stations is not None:
            rows = np.array([sampled_at(law, stations).values for law in laws])
        elif any(len(law_points(law)) != counts[1] or stations_of(law) is not None for law in laws):
            values = np.array([np.real(Span(COMPARED_PLACES).values(law)) for law in laws]).reshape(len(laws), -1)
            rows = np.linalg.lstsq(law_basis(counts[1], COMPARED_PLACES), values.T, rcond=None)[0].T
        elif along == counts[0]:
            return value_at(design, self.name)
        else:
            rows = np.array([law_points(law) for law in laws]).reshape(len(laws), counts[1])
        if along != counts[0]:
            rows = self.row.embedding(counts[0], along) @ rows
        if stations is None or along != counts[0]:
            smallest = min((float(np.min(law_points(law))) for law in laws), default=0.0)
            low = max(self.allowed[0], LEAST_SHARE * smallest if smallest > 0.0 else -np.inf)
            rows = np.clip(rows, low, self.allowed[1])
        found = tuple(plain_law(row) if stations is None else with_values(stations, row) for row in rows)
        return found[0] if self.row is ONE_LAW else found


@final
class RatioLaw(SpanLaw):
    """A row of which only the ratios count, so that the largest number is held."""

    holds_corners: ClassVar[bool] = True


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


@final
@dataclass(frozen=True, eq=False)
class ChannelCurves(ResizableLaw):
    """The four curves of a channel, which share its corners."""

    degree: int
    """highest degree of the curves"""
    holds_corners: ClassVar[bool] = True
    along_span: ClassVar[tuple[int, ...]] = (0, 1)

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
        own, channel = self.counts_of(design), design.channel
        if counts == own:
            return channel
        values = np.array([tuple(point) for name in CHANNEL_CURVES for point in getattr(channel, name)], dtype=float)
        points = (self.embedding(counts, own) @ values.ravel()).reshape(-1, 2)
        curves = np.split(points, np.cumsum([counts[0], counts[1], counts[2] - 2]))
        changes = {
            name: tuple(Point(*row) for row in rows.tolist()) for name, rows in zip(CHANNEL_CURVES, curves, strict=True)
        }
        return replace(channel, **changes)


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


@dataclass(frozen=True, eq=False)
class CurvePoints(ResizableLaw):
    """The points of an edge curve, at even steps of the coordinate in which they slide on it; the other is free."""

    axes: str
    """coordinates of its points that are free"""

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
@dataclass(frozen=True, eq=False)
class WallPoints(CurvePoints):
    """The points of hub or shroud: two ends, and others at even steps of its length past both edges."""

    stations: tuple[float, ...]
    """of its points, fractions of its length"""
    holds_corners: ClassVar[bool] = True
    along_span: ClassVar[tuple[int, ...]] = ()

    def limits(self) -> tuple[Counts, Counts]:
        return (FEWEST_ON_WALL,), (MOST_CURVE,)

    def way(self, line: Reals) -> Reals:
        return np.asarray(cumulative_length(line))

    def places(self, count: int) -> Reals:
        if count == len(self.stations):
            return np.array(self.stations)
        return np.array([0.0, *np.linspace(self.stations[1], self.stations[-2], count - 2), 1.0])
