"""The same shape with other numbers of control points, as nearly as they allow, and with edges of a valid shape."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any, ClassVar, final

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Law, Point, Points, Stations
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.search import COARSEST_TOLERANCE
from bladewright.fitting.model_selection.structure import (
    CHANNEL_CURVES,
    FEWEST_THICKNESSES,
    MOST_CHORDWISE,
    MOST_CURVE,
    MOST_SPAN,
    SPANWISE,
    Structure,
    structure_of,
)
from bladewright.fitting.models.model import model_of
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.laws import Span, law_basis, law_points, number_paths, sampled_at, stations_of, with_values
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES
from bladewright.section.unified_sides import sample_places

LAW_LIMITS = {
    **dict.fromkeys(ANGLES, (-88.0, 88.0)),
    **dict.fromkeys(TANGENTS, (0.03, 0.99)),
    **dict.fromkeys(RADII, (1e-4, 0.9)),
}
"""within which a law is kept that another number of control points would carry past the family's own limits"""
COMPARED_PLACES = np.linspace(0.0, 1.0, 101)
"""parameters at which laws and curves are compared"""


@singledispatch
def reshaped(design: Design, structure: Any) -> Design:  # noqa: ARG001 - the contract's
    """A design of another structure whose laws and curves are nearest to those of `design`, by least squares."""
    raise FitError(
        f"a {type(design).__name__} has no laws that a fit knows: give a design of the unified family, or another"
    )


@reshaped.register
def _(design: UnifiedSection, structure: Structure) -> Design:
    thicknesses: dict[str, Any] = {
        name: tuple(float(row[0]) for row in grid_of(getattr(design, name), count, 1, structure))
        for name, count in zip(THICKNESSES, structure.chordwise, strict=True)
    }
    return replace(design, samples=structure.samples, clustering=structure.clustering, **thicknesses)


@reshaped.register
def _(design: UnifiedBlade, structure: Structure) -> Design:
    place = _field(design, "place")
    changes: dict[str, Any] = {
        name: law_of(getattr(design, name), structure.span[name], LAW_LIMITS[name]) for name in SPANWISE
    }
    changes[place] = law_of(getattr(design, place), structure.span["place"])
    for name, count in zip(THICKNESSES, structure.chordwise, strict=True):
        stations = structure.stations.get(name)
        grid = grid_of(getattr(design, name), count, structure.span[name], structure, stations)
        changes[name] = tuple(_plain(row) if stations is None else with_values(stations, row) for row in grid)
    for name, stations in structure.stations.items():
        if name not in THICKNESSES:
            field = place if name == "place" else name
            changes[field] = sampled_at(getattr(design, field), stations)
    return replace(
        design,
        samples=structure.samples,
        clustering=structure.clustering,
        channel=_channel(design.channel, structure),
        **changes,
    )


def _field(design: Any, name: str) -> str:
    """The field of a law by its name in a structure."""
    if name != "place":
        return name
    return "leading_edge_theta" if design.arrangement == "annular" else "leading_edge_y"


def _values(law: Law) -> Reals:
    return np.asarray(Span(COMPARED_PLACES).values(law), dtype=float)


def law_of(law: Law, count: int, limits: tuple[float, float] = (-np.inf, np.inf)) -> Law:
    """The nearest law of so many control points, within limits."""
    if count == len(law_points(law)):
        return law
    found, *_ = np.linalg.lstsq(law_basis(count, COMPARED_PLACES), _values(law), rcond=None)
    return _plain(np.clip(np.asarray(found, dtype=np.float64), *limits))


def _plain(values: Reals) -> Law:
    return tuple(float(value) for value in values) if len(values) > 1 else float(values[0])


def grid_of(
    laws: tuple[Law, ...], count: int, span: int, structure: Structure, stations: Stations | None = None
) -> Reals:
    """Control points (count, span) of a thickness, or its values at stations, kept positive."""
    same = len(laws) == count
    if stations is not None:
        rows = np.stack([np.array(sampled_at(law, stations).values) for law in laws])
        if same:
            return rows
    elif same and all(len(law_points(law)) == span and stations_of(law) is None for law in laws):
        return np.array([law_points(law) for law in laws], dtype=float)
    else:
        across = law_basis(span, COMPARED_PLACES)
        rows = np.stack([np.linalg.lstsq(across, _values(law), rcond=None)[0] for law in laws])
    if len(laws) != count:
        # where the samples of the sides stand, the law matters most
        u = samples_of(structure)
        rows, *_ = np.linalg.lstsq(law_basis(count, u), law_basis(len(laws), u) @ rows, rcond=None)
    least = 0.02 * float(np.max(rows))
    return np.asarray(np.maximum(rows, least))


def samples_of(structure: Structure) -> Reals:
    """Places along the chord at which laws of the thickness are compared."""
    return np.sort(np.concatenate([sample_places(structure.samples, structure.clustering)[2:-2], COMPARED_PLACES]))


def _channel(channel: Channel, structure: Structure) -> Channel:
    corners = [channel.leading_edge[0], channel.leading_edge[-1], channel.trailing_edge[0], channel.trailing_edge[-1]]
    curves = {
        "leading_edge": channel.leading_edge,
        "trailing_edge": channel.trailing_edge,
        "hub": (corners[0], *channel.hub, corners[2]),
        "shroud": (corners[1], *channel.shroud, corners[3]),
    }
    found = {name: curve_of(points, structure.channel[name], channel.degree) for name, points in curves.items()}
    return replace(
        channel,
        leading_edge=found["leading_edge"],
        trailing_edge=found["trailing_edge"],
        hub=found["hub"][1:-1],
        shroud=found["shroud"][1:-1],
    )


def curve_of(points: Points, count: int, highest: int) -> Points:
    """The nearest curve of so many control points and at most the highest degree, between the same ends."""
    if count == len(points):
        return points
    old = np.array(points, dtype=float)
    before, after = (min(n - 1, highest) for n in (len(points), count))
    values = basis(uniform_knots(len(points), before), before, COMPARED_PLACES) @ old
    rows = basis(uniform_knots(count, after), after, COMPARED_PLACES)
    rhs = values - rows[:, [0, -1]] @ old[[0, -1]]
    inner, *_ = np.linalg.lstsq(rows[:, 1:-1], rhs, rcond=None)
    full = np.concatenate([old[:1], inner, old[-1:]])
    return tuple(Point(float(x), float(r)) for x, r in full)


Counts = tuple[int, ...]
"""numbers of control points of a law along its directions, or of several curves"""


@dataclass(frozen=True)
class ResizableLaw(ABC):
    """A law whose number of control points may change by itself; or curves that share points."""

    name: str
    """its name in a structure"""
    holds_corners: ClassVar[bool] = False
    """whether it may change though some of its parameters, the corners of a channel, are held"""

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
        name = _field(design, self.name)
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


THINNER_EDGES, MOST_THINNINGS = 0.7, 12
"""ratio by which the thickness beside the edges is reduced at a time, `MOST_THINNINGS` times at most."""


def with_feasible_edges(design: Design) -> Design:
    """The design, or one with thinner edges where given values leave it no shape; the last where none has.

    A camber that is turned away from the points may leave the third control points of the sides outside the edges.
    """
    if not isinstance(design, UnifiedSection | UnifiedBlade):
        return design
    for _ in range(MOST_THINNINGS):
        if _has_shape(design):
            break
        values = design.parameters()
        ends = tuple(f"{name}[{place}]" for name in THICKNESSES for place in (0, len(getattr(design, name)) - 1))
        design = design.changed(
            {path: THINNER_EDGES * value for path, value in values.items() if path.startswith(ends)}
        )
    return design


def _has_shape(design: UnifiedSection | UnifiedBlade) -> bool:
    try:
        with np.errstate(all="ignore"):
            return model_of(design, COARSEST_TOLERANCE).shape(design).finite
    except DesignError:
        return False
