"""How many control points the laws of a design have, apart from their values; and those that a match begins with."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import singledispatch
from typing import Any, ClassVar, final

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Law, Stations
from bladewright.errors import FitError
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.laws import law_basis, law_points, number_paths, stations_of
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES
from bladewright.section.unified_sides import sample_places

CHANNEL_CURVES = ("leading_edge", "trailing_edge", "hub", "shroud")
"""the four curves of a channel"""
FEWEST_THICKNESSES = 3
"""control points of a thickness along the chord at least: half and twice change nothing measured
(design/matching_constants.md)"""
SPARE_SAMPLES = 4
"""samples along the chord beyond a thickness's control points: fewer leave its law undetermined
(design/matching_constants.md)."""
MOST_SAMPLES = 60
"""samples along the chord at most: half and twice change nothing measured (design/matching_constants.md)"""
MOST_CHORDWISE, MOST_SPAN, MOST_CURVE = MOST_SAMPLES - SPARE_SAMPLES, 12, 12
"""control points along the chord, along the span and of a curve of the channel at most; they bound the time."""
COMPARED_PLACES = np.linspace(0.0, 1.0, 101)
"""parameters at which laws and curves are compared"""
SPANWISE = (*ANGLES, *TANGENTS, *RADII)
"""laws along the span, besides the position of the leading edge and the thicknesses"""


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Numbers of control points: chosen before a fit, which finds the values."""

    chordwise: tuple[int, int] = (6, 6)
    """control points of the upper and the lower thickness along the chord"""
    span: Mapping[str, int] = field(default_factory=dict)
    """control points along the span by field: those of SPANWISE, `place` of the leading edge, and `thickness_upper` and
    `thickness_lower`; empty for a section"""
    stations: Mapping[str, Stations] = field(default_factory=dict)
    """those of the fields of `span` that are given at stations, which stay; their values do not count"""
    channel: Mapping[str, int] = field(default_factory=dict)
    """control points of the four curves, corners among them; empty for a section"""
    samples: int = 16
    clustering: float = 1.0

    def with_samples(self, least: int) -> "Structure":
        """The structure with as many samples along the chord as its thicknesses need, and at least so many."""
        return replace(self, samples=min(MOST_SAMPLES, max(least, max(self.chordwise) + SPARE_SAMPLES)))


@singledispatch
def structure_of(design: Design) -> Any:
    """The structure of a design."""
    raise FitError(
        f"a {type(design).__name__} has no laws that a fit knows: give a design of the unified family, or another"
    )


@structure_of.register
def _(design: UnifiedSection) -> Structure:
    return Structure(
        chordwise=(len(design.thickness_upper), len(design.thickness_lower)),
        samples=design.samples,
        clustering=design.clustering,
    )


@structure_of.register
def _(design: UnifiedBlade) -> Structure:
    place = design.leading_edge_theta if design.arrangement == "annular" else design.leading_edge_y
    span = {name: _count(getattr(design, name)) for name in SPANWISE} | {
        "place": _count(0.0 if place is None else place)
    }
    rows = {name: (getattr(design, name),) for name in SPANWISE} | {"place": () if place is None else (place,)}
    for name in THICKNESSES:
        rows[name] = getattr(design, name)
        span[name] = max(_count(law) for law in rows[name])
    found = {name: [each for law in row if (each := stations_of(law))] for name, row in rows.items()}
    channel = design.channel
    return Structure(
        chordwise=(len(design.thickness_upper), len(design.thickness_lower)),
        span=span,
        stations={name: replace(row[0], values=(0.0,) * len(row[0].span)) for name, row in found.items() if row},
        channel={
            "leading_edge": len(channel.leading_edge),
            "trailing_edge": len(channel.trailing_edge),
            "hub": len(channel.hub) + 2,
            "shroud": len(channel.shroud) + 2,
        },
        samples=design.samples,
        clustering=design.clustering,
    )


def _count(law: Law) -> int:
    return len(law_points(law))


Counts = tuple[int, ...]
"""numbers of control points of a law along its directions, or of several curves"""


@dataclass(frozen=True)
class ResizableLaw(ABC):
    """A law whose number of control points may change by itself; or curves that share points."""

    name: str
    """its name in a structure"""
    holds_corners: ClassVar[bool] = False
    """whether it may change though some of its parameters, the corners of a channel, are held"""
    along_span: ClassVar[tuple[int, ...]] = (-1,)
    """places of the numbers along the span among its counts"""

    @abstractmethod
    def counts(self, structure: Any) -> Counts:
        """Its numbers of control points."""

    @abstractmethod
    def resized(self, structure: Any, counts: Counts) -> Any:
        """The structure with other numbers of them."""

    @abstractmethod
    def limits(self) -> tuple[Counts, Counts]:
        """Fewest and most of them."""

    @abstractmethod
    def paths(self, design: Any) -> list[str]:
        """The parameters (k,) that are its control points' numbers."""

    @abstractmethod
    def embedding(self, structure: Any, counts: Counts) -> Reals:
        """Its numbers (k, j) in a structure that are nearest to those of a law with other counts."""


@final
class SpanLaw(ResizableLaw):
    """A law along the span."""

    def counts(self, structure: Structure) -> Counts:
        return (structure.span[self.name],)

    def resized(self, structure: Structure, counts: Counts) -> Structure:
        return replace(structure, span={**structure.span, self.name: counts[0]})

    def limits(self) -> tuple[Counts, Counts]:
        return (1,), (MOST_SPAN,)

    def paths(self, design: Any) -> list[str]:
        name = law_field(design, self.name)
        return number_paths(getattr(design, name), name)

    def embedding(self, structure: Structure, counts: Counts) -> Reals:
        return law_embedding(structure.span[self.name], counts[0], COMPARED_PLACES)


@final
class ThicknessLaw(ResizableLaw):
    """A thickness, along the chord and along the span."""

    def counts(self, structure: Structure) -> Counts:
        return structure.chordwise[THICKNESSES.index(self.name)], structure.span.get(self.name, 1)

    def resized(self, structure: Structure, counts: Counts) -> Structure:
        chordwise = [*structure.chordwise]
        chordwise[THICKNESSES.index(self.name)] = counts[0]
        span = {**structure.span, self.name: counts[1]} if self.name in structure.span else structure.span
        return replace(structure, chordwise=(chordwise[0], chordwise[1]), span=span)

    def limits(self) -> tuple[Counts, Counts]:
        return (FEWEST_THICKNESSES, 1), (MOST_CHORDWISE, MOST_SPAN)

    def paths(self, design: Any) -> list[str]:
        rows = enumerate(getattr(design, self.name))
        return [path for i, law in rows for path in number_paths(law, f"{self.name}[{i}]")]

    def embedding(self, structure: Structure, counts: Counts) -> Reals:
        along, across = self.counts(structure)
        chordwise = law_embedding(along, counts[0], samples_of(structure))
        return np.asarray(np.kron(chordwise, law_embedding(across, counts[1], COMPARED_PLACES)))


@final
@dataclass(frozen=True)
class ChannelCurves(ResizableLaw):
    """The four curves of a channel, which share its corners."""

    degree: int
    """highest degree of the curves"""
    holds_corners: ClassVar[bool] = True
    along_span: ClassVar[tuple[int, ...]] = (0, 1)

    def counts(self, structure: Structure) -> Counts:
        return tuple(structure.channel[name] for name in CHANNEL_CURVES)

    def resized(self, structure: Structure, counts: Counts) -> Structure:
        return replace(structure, channel=dict(zip(CHANNEL_CURVES, counts, strict=True)))

    def limits(self) -> tuple[Counts, Counts]:
        return (2,) * 4, (MOST_CURVE,) * 4

    def paths(self, design: Any) -> list[str]:
        curves = [(name, len(getattr(design.channel, name))) for name in CHANNEL_CURVES]
        return [f"channel.{name}[{i}].{axis}" for name, count in curves for i in range(count) for axis in "xr"]

    def embedding(self, structure: Structure, counts: Counts) -> Reals:
        own = self.counts(structure)
        rows, columns = (np.cumsum([0, each[0], each[1], each[2] - 2, each[3] - 2]) for each in (own, counts))
        found = np.zeros((rows[-1], columns[-1]))
        for curve in range(4):
            part = curve_embedding(own[curve], counts[curve], self.degree)
            inner = slice(rows[curve], rows[curve + 1]), slice(columns[curve], columns[curve + 1])
            if curve < 2:
                found[inner] = part
                continue
            # a wall's ends are the edges' ends
            corners = [columns[0], columns[1]] if curve == 2 else [columns[1] - 1, columns[2] - 1]
            found[inner] = part[1:-1, 1:-1]
            found[inner[0], corners] = part[1:-1, [0, -1]]
        return np.asarray(np.kron(found, np.eye(2)))


@singledispatch
def resizable_laws(design: Any) -> list[ResizableLaw]:
    """The laws of a design whose numbers of control points may change: stations stay."""
    structure = structure_of(design)
    laws: list[ResizableLaw] = [ThicknessLaw(name) for name in THICKNESSES if name not in structure.stations]
    laws += [SpanLaw(name) for name in structure.span if name not in THICKNESSES and name not in structure.stations]
    return [*laws, ChannelCurves("channel", design.channel.degree)] if structure.channel else laws


def rows_shown(v: Reals) -> int:
    """How many control points along the span points at v (n,) show: the most equal parts of it of which each has some.

    A spline's control points are determined where each basis function has a place of its own (Schoenberg and Whitney
    1953): a blade that is measured in four sections determines four.
    """
    counts = range(MOST_SPAN, 1, -1)
    return next((n for n in counts if len(np.unique(np.minimum((n * v).astype(int), n - 1))) == n), 1)


def within_rows(structure: Any, design: Any, rows: int) -> Any:
    """A structure with no more control points along the span than rows, but the fewest that its laws may have."""
    for law in resizable_laws(design):
        counts, least = list(law.counts(structure)), law.limits()[0]
        for place in law.along_span:
            counts[place] = max(min(counts[place], rows), least[place])
        structure = law.resized(structure, tuple(counts))
    return structure


def samples_of(structure: Structure) -> Reals:
    """Places along the chord at which laws of the thickness are compared."""
    return np.sort(np.concatenate([sample_places(structure.samples, structure.clustering)[2:-2], COMPARED_PLACES]))


def law_field(design: Any, name: str) -> str:
    """The field of a law by its name in a structure."""
    if name != "place":
        return name
    return "leading_edge_theta" if design.arrangement == "annular" else "leading_edge_y"


def law_embedding(count: int, other: int, places: Reals) -> Reals:
    """Control points (count, other) of the laws nearest to those of another number, at places (n,)."""
    if count == other:
        return np.eye(count)
    return np.asarray(np.linalg.lstsq(law_basis(count, places), law_basis(other, places), rcond=None)[0])


def curve_embedding(count: int, other: int, highest: int) -> Reals:
    """Control points (count, other) of the curves nearest to those of other numbers, between the same ends."""
    if count == other:
        return np.eye(count)
    own, rhs = (_curve_basis(each, highest) for each in (count, other))
    found = np.zeros((count, other))
    found[0, 0] = found[-1, -1] = 1.0
    found[1:-1] = np.linalg.lstsq(own[:, 1:-1], rhs - own @ found, rcond=None)[0]
    return found


def _curve_basis(count: int, highest: int) -> Reals:
    degree = min(count - 1, highest)
    return np.asarray(basis(uniform_knots(count, degree), degree, COMPARED_PLACES))


def _blade(
    chordwise: int, thickness: int, angles: int, tangents: int, radii: int, channel: tuple[int, ...]
) -> Structure:
    span = {name: angles if name == "stagger" or "angle" in name else tangents for name in SPANWISE}
    span |= {name: radii for name in SPANWISE if name.endswith("radius")}
    return Structure(
        chordwise=(chordwise, chordwise),
        span={**span, "place": angles, "thickness_upper": thickness, "thickness_lower": thickness},
        channel=dict(zip(("leading_edge", "trailing_edge", "hub", "shroud"), channel, strict=True)),
    )


INITIAL_BLADES = (
    _blade(4, 1, 1, 1, 1, (2, 2, 2, 2)),
    _blade(5, 2, 3, 2, 1, (3, 3, 4, 4)),
    _blade(6, 3, 4, 3, 2, (4, 5, 4, 4)),
)
"""from a prismatic blade to a twisted and swept one; the last one's laws are free enough to find its edges"""
