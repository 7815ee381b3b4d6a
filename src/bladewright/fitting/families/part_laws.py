"""The laws of designs of one part, whose numbers of control points a match may choose: along the chord and the span."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any, ClassVar, final

import numpy as np
from scipy.interpolate import CubicSpline

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.designs import Law, Point
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


POSITIONS = ("leading_edge_theta", "leading_edge_y")
"""where the leading edge of a blade stands"""


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

    row: Chordwise | None
    spanwise: bool
    """whether it may vary along the span"""

    def grid(self, design: Any) -> list[Law]:
        """Its laws along the span, one for each control point along the chord."""
        value = law_at(design, self.name)
        return [value] if self.row is None else list(value)

    def counts(self, structure: PartStructure) -> Counts:
        return structure.counts[self.name]

    def counts_of(self, design: Any) -> Counts:
        """Its numbers of control points in a design."""
        laws = self.grid(design)
        across = max((len(law_points(law)) for law in laws), default=1)
        return 1 if self.row is None else self.row.count(len(laws)), across

    def resized(self, structure: PartStructure, counts: Counts) -> PartStructure:
        return PartStructure({**structure.counts, self.name: counts})

    def limits(self) -> tuple[Counts, Counts]:
        most = MOST_SPAN if self.spanwise else 1
        if self.row is None:
            return (1, 1), (1, most)
        return (0 if self.row.optional else self.row.fewest, 1), (MOST_CHORDWISE, most)

    def paths(self, design: Any) -> list[str]:
        stems = (
            [self.name] if self.row is None else [f"{self.name}[{i}]" for i in range(len(law_at(design, self.name)))]
        )
        return [path for law, stem in zip(self.grid(design), stems, strict=True) for path in number_paths(law, stem)]

    def embedding(self, structure: PartStructure, counts: Counts) -> Reals:
        along, across = self.counts(structure)
        chordwise = np.eye(1)
        if self.row is not None:
            same = along == counts[0]
            chordwise = np.eye(self.row.points(along)) if same else _nearest(self.row, along, counts[0])
        return np.asarray(np.kron(chordwise, law_embedding(across, counts[1], COMPARED_PLACES)))

    def resized_value(self, design: Any, counts: Counts) -> Any:
        """Its laws nearest to those of a design, with other numbers of control points."""
        along, across = self.counts_of(design)
        laws = self.grid(design)
        if (along, across) == counts and all(len(law_points(law)) == across for law in laws):
            return law_at(design, self.name)
        across_rows = law_basis(counts[1], COMPARED_PLACES)
        rows = np.zeros((len(laws), counts[1]))
        for i, law in enumerate(laws):
            rows[i] = np.linalg.lstsq(across_rows, np.real(Span(COMPARED_PLACES).values(law)), rcond=None)[0]
        if self.row is not None and along != counts[0]:
            rows = _nearest(self.row, counts[0], along) @ rows
        least = min((float(np.min(law_points(law))) for law in laws), default=0.0)
        if least > 0.0:
            # laws that run past their numbers stay positive
            rows = np.maximum(rows, 0.5 * least)
        found = tuple(plain_law(row) for row in rows)
        return found[0] if self.row is None else found


def law_at(design: Any, path: str) -> Any:
    """The law, or the row of laws, at a path."""
    for step in re.findall(r"\w+", path):
        design = design[int(step)] if step.isdigit() else getattr(design, step)
    return design


@final
class RatioLaw(PartLaw):
    """A row of which only the ratios count, so that the largest number is held."""

    holds_corners: ClassVar[bool] = True


@final
class EdgeCurve(PartLaw):
    """An edge curve through points at even steps of the coordinate in which they slide on it, whose other is free."""

    def counts_of(self, design: Any) -> Counts:
        return (len(getattr(design, self.name).points),)

    def limits(self) -> tuple[Counts, Counts]:
        return (2,), (MOST_CURVE,)

    def paths(self, design: Any) -> list[str]:
        free = "x" if sliding_coordinate(design, self.name) == "r" else "r"
        return [f"{self.name}.points[{i}].{free}" for i in range(*self.counts_of(design))]

    def embedding(self, structure: PartStructure, counts: Counts) -> Reals:
        own, other = (np.linspace(0.0, 1.0, each[0]) for each in (self.counts(structure), counts))
        return np.asarray(CubicSpline(other, np.eye(len(other)))(own))

    def resized_value(self, design: Any, counts: Counts) -> Any:
        curve = getattr(design, self.name)
        if self.counts_of(design) == counts:
            return curve
        line = np.real(curve.line(1.0).values(np.linspace(0.0, 1.0, FINE_PLACES)))
        line = line[:, ::-1] if sliding_coordinate(design, self.name) == "r" else line
        order = np.argsort(line[:, 0])
        at = np.linspace(line[0, 0], line[-1, 0], counts[0])
        rows = np.stack([at, np.interp(at, *line[order].T)], axis=-1)
        rows = rows[:, ::-1] if sliding_coordinate(design, self.name) == "r" else rows
        return replace(curve, points=tuple(Point(*row) for row in rows.tolist()))


@final
@dataclass(frozen=True)
class WallCurve(PartLaw):
    """Hub or shroud through points: two ends, and others at even steps of its length past both edges."""

    stations: tuple[float, ...]
    """of its points, fractions of its length"""
    holds_corners: ClassVar[bool] = True
    along_span: ClassVar[tuple[int, ...]] = ()

    def counts_of(self, design: Any) -> Counts:
        return (len(law_at(design, self.name).points),)

    def limits(self) -> tuple[Counts, Counts]:
        return (FEWEST_ON_WALL,), (MOST_CURVE,)

    def paths(self, design: Any) -> list[str]:
        return [f"{self.name}.points[{i}].{axis}" for i in range(*self.counts_of(design)) for axis in "xr"]

    def embedding(self, structure: PartStructure, counts: Counts) -> Reals:
        own, other = (self._stations(each[0]) for each in (self.counts(structure), counts))
        return np.asarray(np.kron(CubicSpline(other, np.eye(len(other)))(own), np.eye(2)))

    def resized_value(self, design: Any, counts: Counts) -> Any:
        curve = law_at(design, self.name)
        if self.counts_of(design) == counts:
            return curve
        line = np.real(curve.line(1.0).values(np.linspace(0.0, 1.0, FINE_PLACES)))
        way = cumulative_length(line)
        rows = np.stack([np.interp(self._stations(*counts), way / way[-1], axis) for axis in line.T], axis=-1)
        return replace(curve, points=tuple(Point(*row) for row in rows.tolist()))

    def _stations(self, count: int) -> Reals:
        if count == len(self.stations):
            return np.array(self.stations)
        return np.array([0.0, *np.linspace(self.stations[1], self.stations[-2], count - 2), 1.0])


def _wall_law(design: Any, name: str) -> WallCurve:
    points = np.array([[float(np.real(each.x)), float(np.real(each.r))] for each in law_at(design, name).points])
    way = cumulative_length(points)
    return WallCurve(name, None, spanwise=True, stations=tuple((way / way[-1]).tolist()))


def _nearest(row: Chordwise, count: int, other: int) -> Reals:
    """Control points of the rows nearest to those of another count."""
    return np.asarray(np.linalg.lstsq(row.basis(count), row.basis(other), rcond=None)[0])


def _laws(design: Any) -> list[Any]:
    spanwise = isinstance(design, SectionedBlade)
    laws = [(f"section.{path}", law) for path, law in named_laws(design.section)]
    if spanwise:
        laws += [(name, law) for name in POSITIONS if (law := getattr(design, name)) is not None]
    stationary = {path.partition("[")[0] for path, law in laws if stations_of(law) is not None}
    rows = {f"section.{name}": row for name, row in chordwise_rows(design.section).items()}
    found: list[Any] = [
        (RatioLaw if row.by_ratio else PartLaw)(name, row, spanwise)
        for name, row in rows.items()
        if name not in stationary
    ]
    if not spanwise:
        return found
    single = [path for path, _ in laws if path.partition("[")[0] not in {*stationary, *rows}]
    edges = [edge for edge in EDGES if isinstance(getattr(design, edge), ThroughPoints)]
    paths = {f"flow_path.{wall}": getattr(design.flow_path, wall) for wall in WALLS}
    walls = [p for p, w in paths.items() if isinstance(w, ThroughPoints) and len(w.points) >= FEWEST_ON_WALL]
    found += [PartLaw(path, None, spanwise) for path in single]
    return [*found, *(EdgeCurve(e, None, spanwise) for e in edges), *(_wall_law(design, wall) for wall in walls)]


def _structure(design: Any) -> PartStructure:
    return PartStructure({law.name: law.counts_of(design) for law in _laws(design)})


def _reshaped(design: Any, structure: PartStructure) -> Any:
    changes = {law.name: law.resized_value(design, law.counts(structure)) for law in _laws(design)}
    found = design.changed(changes)
    for name in [name for name in changes if name.endswith("_heights")]:
        # the side leaves its corner as fast where its first control point is as much nearer as the knots are
        ratio = (len(law_at(design, name)) + 1.0) / (len(changes[name]) + 1.0)
        for tangent in (name.replace("heights", f"tangent_{way}") for way in ("in", "out")):
            law = law_at(found, tangent)
            if law is not None and stations_of(law) is None:
                scaled = found.changed({tangent: plain_law(ratio * np.array(law_points(law)))})
                found = scaled if ratio >= 1.0 or _has_shape(scaled) else found
    return found


def _has_shape(design: Any) -> bool:
    """Whether the sides leave the edges; with short tangents they turn back."""
    try:
        design.section.outline(Span(COMPARED_PLACES[::10]))
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
        chordwise = along if law.row is None else max(along, RICH_CHORDWISE[3 if law.spanwise else 2])
        found[law.name] = min(chordwise, most[0]), min(max(across, RICH_SPAN), most[1])
    return PartStructure(found)


for _kind in (PlanarSection, SectionedBlade):
    resizable_laws.register(_kind, _laws)
    structure_of.register(_kind, _structure)
    reshaped.register(_kind, _reshaped)
    richest.register(_kind, _richest)
