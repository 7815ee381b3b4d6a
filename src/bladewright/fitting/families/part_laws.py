"""The laws of designs of one part, whose numbers of control points a match may choose: along the chord and the span."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any, ClassVar, final

import numpy as np
from scipy.interpolate import CubicSpline

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.designs import Law, Point, value_at
from bladewright.errors import DesignError
from bladewright.fitting.families.section_shape import FINE_PLACES
from bladewright.fitting.free_parameters import EDGES, WALLS, sliding_coordinate
from bladewright.fitting.initial_guess.slices import plain_law
from bladewright.fitting.model_selection.reshaping import reshaped, richest
from bladewright.fitting.model_selection.structure import (
    COMPARED_PLACES,
    MOST_CURVE,
    MOST_SPAN,
    Counts,
    ResizableLaw,
    law_embedding,
    resizable_laws,
    structure_of,
)
from bladewright.fitting.models.sectioned import SINGLE_SECTION
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import Span, law_basis, law_points, named_laws, number_paths, stations_of
from bladewright.section.planar import PlanarSection
from bladewright.section.suction_pressure.part import SuctionPressure

RICH_CHORDWISE = {2: 12, 3: 8}
"""control points of a law along the chord in a rich structure, by dimension."""
RICH_SPAN = 5
"""control points of a law along the span in a rich structure."""
RICH_CURVE = 8
"""points on an edge curve or a wall of a rich structure: as many as on a channel's edges"""
FEWEST_ON_WALL = 5
"""points of a wall at least: its ends, and three beside the blade"""
MOST_CHORDWISE = 24
"""control points of a law along the chord at most; it bounds the time: half and twice change nothing
(design/matching_constants.md)."""


@dataclass(frozen=True, kw_only=True)
class Chordwise:
    """A row of control points along the chord whose number may change."""

    fewest: int
    optional: bool = False
    """whether the row may be left out, which is as if it were zero; its fewest control points then count as one"""
    held: Counts = (0, 0)
    """control points before and behind the row that its curve has besides, and that stay"""
    by_ratio: bool = False
    """whether only the ratios of its numbers count"""
    places: Callable[[int], Reals] | None = None
    """the places along the chord of all control points of a curve by their number; None where they are even"""
    most: int = MOST_CHORDWISE

    def points(self, count: int) -> int:
        """How many control points a count stands for."""
        return count + self.fewest - 1 if count and self.optional else count

    def count(self, points: int) -> int:
        """The count of a row of so many control points."""
        return points - self.fewest + 1 if points and self.optional else points

    def basis(self, count: int) -> Reals:
        """Values (m, points) along the chord of the basis functions of the control points."""
        first, last = self.held
        points = self.points(count)
        if not points:
            return np.zeros((len(COMPARED_PLACES), 0))
        at = COMPARED_PLACES
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


@singledispatch
def chordwise_rows(part: Any) -> dict[str, Chordwise]:  # noqa: ARG001 - most parts have none
    """The rows of a part whose number of control points may change, by field: those without given places."""
    return {}


@chordwise_rows.register
def _(part: CamberAngle) -> dict[str, Chordwise]:
    found = {"camber_angle": Chordwise(fewest=1)}
    if not (part.thickness_places or part.thickness_weights):

        def places(count: int) -> Reals:
            outline = replace(part, half_thickness=(0.01,) * count).outline(SINGLE_SECTION)
            return np.asarray(np.real(outline.places.controls)[0])

        held = 1, 0 if part.trailing_edge == "blunt" else 1
        found["half_thickness"] = Chordwise(fewest=3, held=held, places=places)
    return found


@chordwise_rows.register
def _(part: CurvatureMeanline) -> dict[str, Chordwise]:
    found = {}
    if part.curvature and not part.curvature_places:
        found["curvature"] = Chordwise(fewest=2, by_ratio=True)
    if not part.thickness_multiplier_places:
        found["thickness_multiplier"] = Chordwise(fewest=3, optional=True)
    return found


@chordwise_rows.register
def _(part: SuctionPressure) -> dict[str, Chordwise]:
    heights = {name: getattr(part, f"{name}_heights") for name in ("suction", "pressure")}
    return {
        f"{name}_heights": Chordwise(fewest=1, held=(2, 2))
        for name, row in heights.items()
        if row and not (getattr(part, f"{name}_places") or getattr(part, f"{name}_knots"))
    }


@dataclass(frozen=True)
class PartStructure:
    """Numbers of control points of the laws of a part, and of the position of a blade's leading edge."""

    counts: Mapping[str, Counts]
    """along the chord and along the span, by path"""
    samples: int = 0

    def with_samples(self, least: int) -> "PartStructure":  # noqa: ARG002 - sections of one part are not sampled
        """The same."""
        return self


@dataclass(frozen=True)
class PartLaw(ResizableLaw):
    """A law along the span, or a row of them along the chord; its name is its path."""

    row: Chordwise
    spanwise: bool
    """whether it may vary along the span"""

    def laws(self, design: Any) -> list[Law]:
        """Its laws along the span, one for each control point along the chord."""
        value = value_at(design, self.name)
        return [value] if self.row is ONE_LAW else list(value)

    def counts(self, structure: PartStructure) -> Counts:
        return structure.counts[self.name]

    def counts_of(self, design: Any) -> Counts:
        """Its numbers of control points in a design."""
        laws = self.laws(design)
        return self.row.count(len(laws)), max((len(law_points(law)) for law in laws), default=1)

    def resized(self, structure: PartStructure, counts: Counts) -> PartStructure:
        return PartStructure({**structure.counts, self.name: counts})

    def limits(self) -> tuple[Counts, Counts]:
        return (0 if self.row.optional else self.row.fewest, 1), (self.row.most, MOST_SPAN if self.spanwise else 1)

    def paths(self, design: Any) -> list[str]:
        laws = self.laws(design)
        stems = [self.name] if self.row is ONE_LAW else [f"{self.name}[{i}]" for i in range(len(laws))]
        return [path for law, stem in zip(laws, stems, strict=True) for path in number_paths(law, stem)]

    def embedding(self, structure: PartStructure, counts: Counts) -> Reals:
        along, across = self.counts(structure)
        return np.asarray(
            np.kron(self.row.embedding(along, counts[0]), law_embedding(across, counts[1], COMPARED_PLACES))
        )

    def resized_value(self, design: Any, counts: Counts) -> Any:
        """Its laws nearest to those of a design, with other numbers of control points."""
        along, across = self.counts_of(design)
        laws = self.laws(design)
        if (along, across) == counts and all(len(law_points(law)) == across for law in laws):
            return value_at(design, self.name)
        across_rows = law_basis(counts[1], COMPARED_PLACES)
        rows = np.zeros((len(laws), counts[1]))
        for i, law in enumerate(laws):
            rows[i] = np.linalg.lstsq(across_rows, np.real(Span(COMPARED_PLACES).values(law)), rcond=None)[0]
        if along != counts[0]:
            rows = self.row.embedding(counts[0], along) @ rows
        least = min((float(np.min(law_points(law))) for law in laws), default=0.0)
        if least > 0.0:
            # laws that run past their numbers stay positive
            rows = np.maximum(rows, 0.5 * least)
        found = tuple(plain_law(row) for row in rows)
        return found[0] if self.row is ONE_LAW else found


@final
class RatioLaw(PartLaw):
    """A row of which only the ratios count, so that the largest number is held."""

    holds_corners: ClassVar[bool] = True


@dataclass(frozen=True)
class CurvePoints(PartLaw):
    """The points of an edge curve, at even steps of the coordinate in which they slide on it; the other is free."""

    axes: str
    """coordinates of its points that are free"""

    def counts_of(self, design: Any) -> Counts:
        return (len(value_at(design, self.name).points),)

    def limits(self) -> tuple[Counts, Counts]:
        return (2,), (MOST_CURVE,)

    def paths(self, design: Any) -> list[str]:
        return [f"{self.name}.points[{i}].{axis}" for i in range(*self.counts_of(design)) for axis in self.axes]

    def embedding(self, structure: PartStructure, counts: Counts) -> Reals:
        own, other = (self.places(each[0]) for each in (self.counts(structure), counts))
        return np.asarray(np.kron(CubicSpline(other, np.eye(len(other)))(own), np.eye(len(self.axes))))

    def resized_value(self, design: Any, counts: Counts) -> Any:
        curve = value_at(design, self.name)
        if self.counts_of(design) == counts:
            return curve
        line = np.real(curve.line(1.0).values(np.linspace(0.0, 1.0, FINE_PLACES)))
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
@dataclass(frozen=True)
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


def _laws(design: Any) -> list[Any]:
    spanwise = isinstance(design, SectionedBlade)
    laws = [(f"section.{path}", law) for path, law in named_laws(design.section)]
    if spanwise:
        positions = ("leading_edge_theta", "leading_edge_y")
        laws += [(name, law) for name in positions if (law := getattr(design, name)) is not None]
    stationary = {path.partition("[")[0] for path, law in laws if stations_of(law) is not None}
    rows = {f"section.{name}": row for name, row in chordwise_rows(design.section).items()}
    found: list[Any] = [
        (RatioLaw if row.by_ratio else PartLaw)(name, row, spanwise)
        for name, row in rows.items()
        if name not in stationary
    ]
    if not spanwise:
        return found
    for path, _ in laws:
        if path.partition("[")[0] not in {*stationary, *rows}:
            found.append(PartLaw(path, ONE_LAW, spanwise))
    for edge in EDGES:
        if isinstance(getattr(design, edge), ThroughPoints):
            axes = "x" if sliding_coordinate(design, edge) == "r" else "r"
            found.append(CurvePoints(edge, ONE_LAW, spanwise, axes))
    for wall in WALLS:
        curve = getattr(design.flow_path, wall)
        if isinstance(curve, ThroughPoints) and len(curve.points) >= FEWEST_ON_WALL:
            way = cumulative_length(np.real(np.array([tuple(each) for each in curve.points])))
            stations = tuple((way / way[-1]).tolist())
            found.append(WallPoints(f"flow_path.{wall}", ONE_LAW, spanwise, "xr", stations))
    return found


def _structure(design: Any) -> PartStructure:
    return PartStructure({law.name: law.counts_of(design) for law in _laws(design)})


def _reshaped(design: Any, structure: PartStructure) -> Any:
    changes = {law.name: law.resized_value(design, law.counts(structure)) for law in _laws(design)}
    found = design.changed(changes)
    for name in [name for name in changes if name.endswith("_heights")]:
        # the side leaves its corner as fast where its first control point is as much nearer as the knots are
        ratio = (len(value_at(design, name)) + 1.0) / (len(changes[name]) + 1.0)
        for tangent in (name.replace("heights", f"tangent_{way}") for way in ("in", "out")):
            law = value_at(found, tangent)
            if law is not None and stations_of(law) is None:
                scaled = found.changed({tangent: plain_law(ratio * np.array(law_points(law)))})
                found = scaled if ratio >= 1.0 or _has_shape(scaled) else found
    return found


def _has_shape(design: Any) -> bool:
    """Whether the sides leave the edges; with short tangents they turn back."""
    span = Span(COMPARED_PLACES[::10])
    try:
        design.section.outline(span).check_limits([""] * len(span.v))
    except DesignError:
        return False
    return True


def _richest(design: Any) -> PartStructure:
    found: dict[str, Counts] = {}
    for law in _laws(design):
        most = law.limits()[1]
        if len(most) == 1:
            found[law.name] = (max(*law.counts_of(design), RICH_CURVE),)
            continue
        along, across = law.counts_of(design)
        chordwise = max(along, RICH_CHORDWISE[3 if law.spanwise else 2])
        found[law.name] = min(chordwise, most[0]), min(max(across, RICH_SPAN), most[1])
    return PartStructure(found)


for _kind in (PlanarSection, SectionedBlade):
    resizable_laws.register(_kind, _laws)
    structure_of.register(_kind, _structure)
    reshaped.register(_kind, _reshaped)
    richest.register(_kind, _richest)
