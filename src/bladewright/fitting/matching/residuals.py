"""The least-squares problem of a match: residuals in chords, and what is held where a cloud says nothing.

The regularisation holds smooth laws, equal sides, nothing far from the start, by rows of variance one that are linear
in the scaled parameters. A search weighs them with the noise of the cloud, so that they vanish beside exact data.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import InitVar, dataclass, field
from itertools import chain, groupby

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Law
from bladewright.errors import DesignError
from bladewright.fitting.free_parameters import EDGES, Scales
from bladewright.fitting.matching.blade_ends import BladeEnds, EdgeOverhang, WallPoints
from bladewright.fitting.matching.footpoints import Footpoints, concatenated, nearest_footpoints
from bladewright.fitting.models.model import Model, ModelShape
from bladewright.numerics.least_squares import ConstrainedProblem
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import named_laws, number_paths
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import TANGENTS, THICKNESSES

SPREAD_ABOUT_START = 3.0
"""spread of a parameter about its start, in its own scale: it holds what is left open (design/matching_constants.md)"""
CHANNEL_SPREAD = 1.0
"""the same of points of meridional curves, which the cloud lets slide along these (design/matching_constants.md)"""
CORNER_SPREAD = 0.25
"""the same of corners of a channel whose ends the outline alone shows (design/matching_constants.md)"""
MERIDIANS = ("channel.", "flow_path.", "leading_edge.", "trailing_edge.")
"""beginnings of the paths of those, and of the edge curves and walls of blades from sections."""
POINT_PATH = re.compile(r"(.*)\[\d+\](\.[xr])")
"""path of a coordinate of a point of such a curve"""
BEND_SPREAD = 0.5
"""spread of the second differences of a law, in the scale of its parameters (design/matching_constants.md)"""
CAMBER_SPREAD = 0.3
"""spread of the difference of upper and lower thickness, in their scale (design/matching_constants.md)"""
USUAL_TANGENT, TANGENT_SPREAD = 0.4, 1.5
"""usual tangent proportion of a unified blade's camber lines, and the spread about it, in the scale of tangents: nearly
straight cambers hardly show them (design/matching.md)"""
EDGE_SHARE = 0.05
"""share of a cloud's points that show its edges: rows of edges count as much (design/matching_constants.md)"""
USUAL_EDGE_HEIGHT = (0.8, 0.2)
"""usual height of the control point of an edge's radius, of the thickness; its spread (design/matching_constants.md)"""

Row = tuple[list[tuple[str, float]], float, float]
"""paths of parameters and their factors, the usual value of their sum, and its spread in the scale of the parameters"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Regularisation:
    """Rows `matrix @ z - rhs`, with z the scaled change of the parameters."""

    matrix: Reals
    """(m, k) rows by scaled parameters"""
    rhs: Reals
    """(m,) what the rows should be"""

    def scaled(self, factor: float) -> "Regularisation":
        """The same with all rows multiplied by a factor."""
        return Regularisation(matrix=self.matrix * factor, rhs=self.rhs * factor)

    def residuals(self, z: Reals) -> Reals:
        """The residuals (m,) of scaled changes (k,)."""
        return self.matrix @ z - self.rhs


def regularisation_of(
    start: Design, paths: Sequence[str], size: Reals, *, ends_shown: bool = True, independent_share: float = 1.0
) -> Regularisation:
    """The regularisation about a start, for parameters (k,) of scale `size`.

    `ends_shown` tells whether rows of points show both ends of the blade. Tangents are weighed by the share of the
    points that count as independent, as edge heights are.
    """
    spread = np.where([path.startswith(MERIDIANS) for path in paths], CHANNEL_SPREAD, SPREAD_ABOUT_START)
    channel = None if ends_shown else getattr(start, "channel", None)
    ends = {} if channel is None else {edge: (0, len(getattr(channel, edge)) - 1) for edge in EDGES}
    corners = {f"channel.{edge}[{at}]" for edge, both in ends.items() for at in both}
    spread = np.where([path.rpartition(".")[0] in corners for path in paths], CORNER_SPREAD, spread)
    rows, rhs = [np.diag(1.0 / spread)], [0.0] * len(paths)
    values = start.parameters()
    index = {path: i for i, path in enumerate(paths)}
    wide = TANGENT_SPREAD * float(np.sqrt(independent_share))
    shown = [path for path in values if path.startswith(TANGENTS)] if isinstance(start, UnifiedBlade) else []
    tangents: list[Row] = [([(path, 1.0)], USUAL_TANGENT, wide) for path in shown]
    bends = chain(_second_differences(start), _meridional_bends(start))
    for terms, usual, width in chain(bends, _thickness_differences(start), tangents):
        free = {index[path]: factor for path, factor in terms if path in index}
        if not free:
            continue
        row, scale = np.zeros(len(paths)), width * float(np.max(size[[*free]]))
        for place, factor in free.items():
            row[place] = factor * size[place] / scale
        rows.append(row)
        rhs.append((usual - sum(factor * values[path] for path, factor in terms)) / scale)
    return Regularisation(matrix=np.vstack(rows), rhs=np.array(rhs))


def _second_differences(start: Design) -> Iterator[Row]:
    """Second differences of laws along the span, and of rows of laws or numbers along the chord."""
    laws: Iterable[tuple[str, Law]] = named_laws(start)
    if isinstance(start, UnifiedSection):
        laws = ((f"{name}[{i}]", value) for name in THICKNESSES for i, value in enumerate(getattr(start, name)))
    for _, row in groupby(laws, key=lambda each: each[0].partition("[")[0]):
        lines = [number_paths(law, path) for path, law in row]
        columns = zip(*lines, strict=True) if len({len(line) for line in lines}) == 1 else ()
        for line in (*lines, *columns):
            yield from _second_differences_of(line)


def _second_differences_of(line: Sequence[str]) -> Iterator[Row]:
    for before, at, after in zip(line, line[1:], line[2:], strict=False):
        yield [(before, 1.0), (at, -2.0), (after, 1.0)], 0.0, BEND_SPREAD


def _meridional_bends(start: Design) -> Iterator[Row]:
    """Second differences of what points of curves change by: the curves bend themselves."""
    values, lines = start.parameters(), dict[str, list[str]]()
    for path in values:
        found = POINT_PATH.fullmatch(path)
        if found and path.startswith(MERIDIANS):
            lines.setdefault(found[1] + found[2], []).append(path)
    for line in lines.values():
        for terms, _, width in _second_differences_of(line):
            yield terms, sum(factor * values[path] for path, factor in terms), width


def _thickness_differences(start: Design) -> Iterator[Row]:
    above, below = ([path for path in start.parameters() if path.startswith(name)] for name in THICKNESSES)
    if len(above) == len(below):
        for pair in zip(above, below, strict=True):
            yield list(zip(pair, (1.0, -1.0), strict=True)), 0.0, CAMBER_SPREAD


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacedCloud:
    """A shape and the cloud's footpoints on it."""

    shape: ModelShape
    footpoints: Footpoints
    _located: dict[WallPoints, tuple[Reals, Reals, Reals]] = field(default_factory=dict)

    def located(self, wall: WallPoints) -> tuple[Reals, Reals, Reals]:
        """What `WallPoints.located` finds on the shape, kept."""
        if wall not in self._located:
            self._located[wall] = wall.located(self.shape.exact)
        return self._located[wall]


@dataclass(frozen=True, kw_only=True, eq=False)
class CloudResiduals:
    """What is measured of a cloud against a shape: points, ends, walls and edge overhang, as residuals in chords."""

    points: Reals
    """(n, d) of the cloud [m]"""
    roots: Reals
    """(n,) square roots of the points' weights"""
    model: Model
    ends: BladeEnds
    overhang: EdgeOverhang
    noise: float
    """of the cloud, in chords: places on walls that scatter more than this count less"""
    precision: Reals
    """(n,) inverse variances of the points, relative to each other"""

    def residuals(self, state: PlacedCloud) -> Reals:
        """All residuals (m,); those of the points (n,) along their normals come first."""
        footpoints, shape = state.footpoints, state.shape
        past = np.sum(footpoints.miss * footpoints.beyond, axis=-1)
        walls = [self._of_wall(wall) * state.located(wall)[2] for wall in self.ends.walls.values()]
        edges = self._of_edge * np.maximum(self.overhang.excess(self.overhang.edges(shape.sides)), 0.0)
        rows = [self.roots * footpoints.heights, (self.roots * past)[self.ends.near], *walls, edges]
        return np.concatenate(rows) / self.model.chord

    def slopes(self, state: PlacedCloud, paths: Sequence[str]) -> Reals:
        """Derivatives (m, k) by parameters at held footpoints, which move along the surface only."""
        shape, footpoints, near, chord = state.shape, state.footpoints, self.ends.near, self.model.chord
        edges = self.overhang.edges(shape.sides)
        beyond = self._of_edge * (self.overhang.excess(edges) > 0.0)
        directions = [-self.roots[:, None] * footpoints.normals, -(self.roots[:, None] * footpoints.beyond)[near]]
        directions.append(beyond[:, None] * edges.normals)
        places = concatenated([footpoints, footpoints.part(near), edges])
        rates = self.model.along(shape, places, np.concatenate(directions), paths)
        *blocks, at_edges = np.split(rates, [-len(beyond)])
        for wall in self.ends.walls.values():
            t, normal, _ = state.located(wall)
            blocks.append(-self._of_wall(wall) * np.einsum("nkd,nd->nk", wall.rates(shape, t, paths), normal))
        return np.concatenate([*blocks, at_edges]) / chord

    def motion_slopes(self, state: PlacedCloud, rates: Reals) -> Reals:
        """Derivatives (m, k) by the motion of the cloud, whose points move at `rates` (n, d, k)."""
        footpoints, near = state.footpoints, self.ends.near
        directions = self.roots[:, None] * footpoints.normals, (self.roots[:, None] * footpoints.beyond)[near]
        blocks = [np.einsum("nd,ndk->nk", *each) for each in zip(directions, (rates, rates[near]), strict=True)]
        exact = state.shape.exact
        for wall in self.ends.walls.values():
            across = self._of_wall(wall) * state.located(wall)[1]
            blocks.append(np.einsum("nd,ndk->nk", across, wall.motion_rates(exact, self.points, rates)))
        return np.concatenate(blocks) / self.model.chord

    def _of_wall(self, wall: WallPoints) -> float:
        """Weight of a wall's places: one where they stand in a row, less where they scatter."""
        spread = wall.spread / self.model.chord
        return self.noise / max(self.noise, spread) if spread > 0.0 else 1.0

    @property
    def _of_edge(self) -> float:
        """Weight of a place on an edge: together they count as the points that show an edge."""
        return float(np.sqrt(max(1.0, EDGE_SHARE * len(self.points) / max(1, len(self.overhang.u)))))


@dataclass(kw_only=True, eq=False, repr=False)
class MatchProblem(ConstrainedProblem):
    """Residuals of a cloud, of unusual edge heights and of the regularisation, under the shape's constraints."""

    cloud_residuals: CloudResiduals
    start: Design
    paths: tuple[str, ...]
    scales: Scales
    regularisation: Regularisation
    edge_height_noise: float
    """noise by which edge heights are weighed: larger where points repeat each other"""
    margin: float
    """that keeps edge radii from what is refused"""
    begun: InitVar[PlacedCloud]
    evaluations: int = 0
    model: Model = field(init=False)
    """of the cloud's residuals"""
    first: Reals = field(init=False)
    """(k,) parameters of the start, in the units of their fields"""
    best: Reals = field(init=False)
    """(k,) the variables of least cost so far"""

    def __post_init__(self, begun: PlacedCloud) -> None:
        self.model = self.cloud_residuals.model
        self.first = self.values_of(self.start)
        self.best, self._least = np.zeros(len(self.paths)), np.inf
        self._hint = begun.footpoints
        self._last: tuple[bytes, PlacedCloud | None] = (self.vector(begun.shape.design).tobytes(), begun)

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        """Lowest and highest scaled change of the parameters."""
        return (self.scales.low - self.first) / self.scales.size, (self.scales.high - self.first) / self.scales.size

    def values_of(self, design: Design) -> Reals:
        """The parameters (k,) of a design, in the units of their fields."""
        values = design.parameters()
        return np.array([float(values[path]) for path in self.paths])

    def vector(self, design: Design) -> Reals:
        """The scaled change (k,) of a design."""
        return (self.values_of(design) - self.first) / self.scales.size

    def design(self, z: Reals) -> Design:
        """The design of a scaled change (k,)."""
        values = self.first + z * self.scales.size
        return self.start.changed({path: float(value) for path, value in zip(self.paths, values, strict=True)})

    def state(self, z: Reals) -> PlacedCloud | None:
        """The shape and the cloud's footpoints; None where there is no such shape."""
        key, placed = z.tobytes(), None
        if self._last[0] != key:
            self.evaluations += 1
            with suppress(DesignError):
                shape = self.model.shape(self.design(z))
                if shape.finite:
                    self._hint = nearest_footpoints(self.cloud_residuals.points, shape.sides, self._hint)
                    placed = PlacedCloud(shape=shape, footpoints=self._hint)
            self._last = key, placed
        return self._last[1]

    def values(self, z: Reals) -> tuple[Reals, Reals] | None:
        """All residuals (m,), and by how much edge radii exceed the thickness and the channel folds (c,)."""
        state = self.state(z)
        if state is None:
            return None
        shape = state.shape
        unusual = self._edge_height_weight(shape) * (shape.edge_heights - USUAL_EDGE_HEIGHT[0])
        rows = np.concatenate([self.cloud_residuals.residuals(state), unusual, self.regularisation.residuals(z)])
        margins = np.concatenate([shape.edge_excess + self.margin, shape.constraints])
        cost = float(rows @ rows) * (1.0 + 1e3 * float(np.max(margins, initial=0.0)))
        if cost < self._least:
            self._least, self.best = cost, np.array(z)
        return rows, margins

    def derivatives(self, z: Reals) -> tuple[Reals, Reals] | None:
        """Derivatives (m, k) of residuals and (c, k) of constrained values; None where stream lines turn back."""
        state = self.state(z)
        if state is None:
            return None
        try:
            excess, heights = self.model.edge_rates(state.shape, self.paths)
            margins = np.concatenate([excess.T, self.model.constraint_rates(state.shape, self.paths).T])
            slopes = self.cloud_residuals.slopes(state, self.paths)
        except DesignError:
            return None
        rows = np.concatenate([slopes, self._edge_height_weight(state.shape) * heights.T])
        return np.concatenate([rows * self.scales.size, self.regularisation.matrix]), margins * self.scales.size

    def _edge_height_weight(self, shape: ModelShape) -> float:
        stations = max(len(shape.edge_heights) / 4.0, 1.0)
        return self.edge_height_noise / (USUAL_EDGE_HEIGHT[1] * float(np.sqrt(stations)))
