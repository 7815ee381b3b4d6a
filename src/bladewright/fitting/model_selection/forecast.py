"""What matches of other structures would leave, predicted linearly about one design, without a search.

Laws with other numbers of control points are products with the motion of whole laws. Along the chord and along the
walls laws move control point by control point: there, narrower ones are taken as the nearest that the widest can
represent.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from bladewright.errors import DesignError
from bladewright.fitting.free_parameters import EDGES, WALLS
from bladewright.fitting.matching.footpoints import footpoints_at, nearest_footpoints
from bladewright.fitting.matching.residuals import PlacedCloud
from bladewright.fitting.matching.scales import scales_of
from bladewright.fitting.matching.search import Match
from bladewright.fitting.model_selection.reshaping import (
    COMPARED_PLACES,
    LAW_LIMITS,
    curve_of,
    grid_of,
    law_of,
    reshaped,
    samples_of,
)
from bladewright.fitting.model_selection.structure import SPANWISE, Structure, structure_of
from bladewright.fitting.models.law_jacobian import AXES, LawJacobian, edge_basis, stands_on_channel
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span, law_basis, law_weights, sampled_at
from bladewright.section.unified_limits import THICKNESSES

STRUCTURE_LAWS = (*SPANWISE, "place", *THICKNESSES, *EDGES, *WALLS)
"""laws whose numbers of control points a structure states"""
STEP_SHARES = (1.0, 0.3, 0.0)
"""shares of a predicted step that are tried: far from a match the linear prediction goes too far."""
COARSE_STEP = 1e-3
"""last step of the projections of these trials, in the parameters of a patch."""
Counts = tuple[int, ...]
"""numbers of control points on which the motion with a law depends"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Prediction:
    """The least squares that a structure is predicted to leave."""

    cost: float
    parameters: int
    rows: Reals
    """(m,) the residuals that are left"""
    step: Reals
    """(k,) of the scaled parameters, law by law, from the nearest laws"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Forecast:
    """The motion of all laws of the widest design of a set of structures, by which all others are predicted."""

    design: Any
    widest: Structure
    jacobian: LawJacobian
    rows: Reals
    """(m,) residuals of the widest design at the present footpoints"""
    sizes: dict[str, float]
    """scales of the parameters by field"""
    held: frozenset[str]
    """radii of the channel's corners that are not free"""
    fixed_laws: frozenset[str]
    """laws that are held"""
    noise: float
    match: Match
    points: int
    """number of rows of points, which come first"""
    _known: dict[tuple[str, Counts], tuple[Reals, Reals]] = field(default_factory=dict)

    def names(self) -> Iterator[str]:
        """The laws that a structure determines and that are free."""
        yield from (name for name in STRUCTURE_LAWS if name not in self.fixed_laws)

    def prediction(self, structure: Structure, roots: Reals | None = None) -> Prediction:
        """What a structure, nowhere wider than the widest, leaves; rows are multiplied by `roots` (m,)."""
        parts = [self.block(name, self.counts(structure, name)) for name in self.names()]
        columns = np.concatenate([part[0] for part in parts], axis=1)
        rows = self.rows + np.sum([part[1] for part in parts], axis=0)
        cost, step = _least_squares(columns, rows, roots, self.noise)
        return Prediction(cost=cost, parameters=columns.shape[1], rows=rows + columns @ step, step=step)

    def designed(self, structure: Structure, prediction: Prediction) -> Any:
        """The design predicted for a structure, or one on the way there that is nearer to the cloud."""
        tried = [self._on_the_way(structure, prediction, share) for share in STEP_SHARES]
        return min(tried, key=self._misfit)

    def _misfit(self, design: Any) -> float:
        """Sum of squares of a design at its own footpoints; infinite where it has no shape."""
        state = self._state(design)
        if state is None:
            return np.inf
        rows = self.match.problem.cloud_residuals.residuals(state)
        return float(rows @ rows)

    def _state(self, design: Any) -> PlacedCloud | None:
        cloud_residuals, footpoints = self.match.problem.cloud_residuals, self.match.state.footpoints
        try:
            shape = cloud_residuals.model.shape(design)
        except DesignError:
            return None
        if not shape.finite:
            return None
        return PlacedCloud(
            shape=shape,
            footpoints=nearest_footpoints(cloud_residuals.points, shape.sides, footpoints, converged=COARSE_STEP),
        )

    def _on_the_way(self, structure: Structure, prediction: Prediction, share: float) -> Any:
        """The design predicted for a structure, or a share of the way there, within the family's bounds."""
        nearest = reshaped(self.design, structure)
        values = nearest.parameters()
        paths = [path for name in self.names() for path in self._paths(name, structure)]
        scales = scales_of(nearest, paths, self.match.model.chord)
        now = np.array([float(values[path]) for path in paths])
        sizes = np.array([self.sizes[path.partition("[")[0]] for path in paths])
        fresh = np.clip(now + share * sizes * prediction.step, scales.low, scales.high)
        return nearest.changed({path: float(value) for path, value in zip(paths, fresh, strict=True)})

    def _paths(self, name: str, structure: Structure) -> list[str]:
        """The paths of a law's columns."""
        if name in THICKNESSES:
            along, across = structure.chordwise[THICKNESSES.index(name)], structure.span[name]
            return [path for i in range(along) for path in _row(f"{name}[{i}]", across)]
        if name in (*EDGES, *WALLS):
            count = structure.channel[name] - (2 if name in WALLS else 0)
            ends = {0: 0, count - 1: len(getattr(self.design.channel, name)) - 1}
            return [
                f"channel.{name}[{point}].{label}"
                for point in range(count)
                for label in AXES
                if name in WALLS or f"channel.{name}[{ends.get(point, -1)}].{label}" not in self.held
            ]
        return _row(_field(self.design, name), structure.span[name])

    def costs(self, structure: Structure, others: Sequence[tuple[str, Structure]], roots: Reals | None) -> list[float]:
        """What structures leave that differ from one in the law named with each."""
        names = list(self.names())
        parts = {name: self.block(name, self.counts(structure, name)) for name in names}
        root = np.ones(len(self.rows)) if roots is None else roots
        columns = np.concatenate([parts[name][0] for name in names], axis=1) * root[:, None]
        rows = (self.rows + np.sum([parts[name][1] for name in names], axis=0)) * root
        gram, right = columns.T @ columns, columns.T @ rows
        starts = np.cumsum([0, *[parts[name][0].shape[1] for name in names]])
        found = []
        for name, other in others:
            place = names.index(name)
            own = slice(starts[place], starts[place + 1])
            fresh, shift = self.block(name, self.counts(other, name))
            moved = (shift - parts[name][1]) * root
            fresh = fresh * root[:, None]
            now = rows + moved
            kept = np.r_[0 : own.start, own.stop : len(gram)]
            mixed = (columns.T @ np.column_stack([fresh, moved]))[kept]
            cross = mixed[:, :-1]
            whole = np.block([[gram[np.ix_(kept, kept)], cross], [cross.T, fresh.T @ fresh]])
            rhs = np.concatenate([right[kept] + mixed[:, -1], fresh.T @ now])
            step = regularised_step(whole, rhs, self.noise)
            found.append(float(now @ now - rhs @ step))
        return found

    def counts(self, structure: Structure, name: str) -> Counts:
        """The numbers of control points on which the motion with a law depends."""
        if name in THICKNESSES:
            return structure.chordwise[THICKNESSES.index(name)], structure.span[name]
        if name in EDGES:
            return structure.channel[name], *(structure.channel[wall] for wall in WALLS)
        return (structure.channel[name],) if name in WALLS else (structure.span[name],)

    def block(self, name: str, counts: Counts) -> tuple[Reals, Reals]:
        """Derivatives (m, k) by a law's scaled parameters, and the rows' change (m,) by its nearest law."""
        if (name, counts) not in self._known:
            kind = self._thickness if name in THICKNESSES else self._edge if name in EDGES else self._wall
            self._known[name, counts] = (kind if name in (*THICKNESSES, *EDGES, *WALLS) else self._law)(name, counts)
        return self._known[name, counts]

    def _law(self, name: str, counts: Counts) -> tuple[Reals, Reals]:
        label = _field(self.design, name)
        law, sites, moves = getattr(self.design, label), self.jacobian.sites, self.jacobian.moves[label]
        other = law_of(law, counts[0], LAW_LIMITS.get(name, (-np.inf, np.inf)))
        rows = law_weights(other, sites)
        change = Span(sites).values(other) - Span(sites).values(law)
        return moves @ rows * self.sizes[label], moves @ change

    def _thickness(self, name: str, counts: Counts) -> tuple[Reals, Reals]:
        sites, laws = self.jacobian.sites, getattr(self.design, name)
        moves = np.stack([self.jacobian.moves[f"{name}[{i}]"] for i in range(len(laws))])
        stations = self.widest.stations.get(name)
        grid = grid_of(laws, counts[0], counts[1], self.widest, stations)
        u = samples_of(self.widest)
        share = np.linalg.lstsq(law_basis(len(laws), u), law_basis(counts[0], u), rcond=None)[0]
        rows = law_basis(counts[1], sites) if stations is None else law_weights(sampled_at(laws[0], stations), sites)
        columns = np.einsum("lnm,li,mj->nij", moves, share, rows, optimize=True)
        values = np.stack([Span(sites).values(law) for law in laws])
        change = share @ grid @ rows.T - values
        return columns.reshape(len(self.rows), -1) * self.sizes[name], np.einsum("lnm,lm->n", moves, change)

    def _edge(self, name: str, counts: Counts) -> tuple[Reals, Reals]:
        sites, channel, metre = self.jacobian.sites, self.design.channel, UNITS[self.design.length_unit]
        old = np.array(getattr(channel, name), dtype=float)
        new = np.array(curve_of(getattr(channel, name), counts[0], channel.degree), dtype=float)
        rows = edge_basis(len(new), channel.degree, sites)
        change = rows @ new - edge_basis(len(old), channel.degree, sites) @ old
        columns, shift = [], np.zeros(len(self.rows))
        for point in range(len(new)):
            for label, axis in AXES.items():
                wall = {0: 0, len(new) - 1: 1}.get(point)
                if wall is not None and f"channel.{name}[{0 if wall == 0 else len(old) - 1}].{label}" in self.held:
                    continue
                column = self.jacobian.moves[name, None, axis] @ rows[:, point]
                if wall is not None:
                    share = self._along_wall(WALLS[wall], counts[1 + wall])[:, 0 if name == EDGES[0] else -1]
                    column = column + self._leaves(WALLS[wall], axis) @ share
                columns.append(column)
        for axis in AXES.values():
            shift += self.jacobian.moves[name, None, axis] @ change[:, axis]
        return np.stack(columns, axis=1) * metre * self.sizes[f"channel.{name}"], shift * metre

    def _wall(self, name: str, counts: Counts) -> tuple[Reals, Reals]:
        channel, metre = self.design.channel, UNITS[self.design.length_unit]
        old = np.array(_wall_points(channel, name), dtype=float)
        new = np.array(curve_of(_wall_points(channel, name), counts[0], channel.degree), dtype=float)
        share = self._along_wall(name, counts[0])
        change = share @ new - old
        leaves = [self._leaves(name, axis) for axis in AXES.values()]
        columns = np.stack([each @ share[:, 1:-1] for each in leaves], axis=-1).reshape(len(self.rows), -1)
        shift = sum(each @ change[:, axis] for axis, each in enumerate(leaves))
        return columns * metre * self.sizes.get(f"channel.{name}", 0.0), np.asarray(shift * metre)

    def _along_wall(self, name: str, count: int) -> Reals:
        """Control points (n, count) of the widest wall whose curves are nearest to those of a narrower one."""
        degree, own = self.design.channel.degree, len(getattr(self.design.channel, name)) + 2
        if own == count:
            return np.eye(own)
        rows, rhs = edge_basis(own, degree, COMPARED_PLACES), edge_basis(count, degree, COMPARED_PLACES)
        share = np.zeros((own, count))
        share[0, 0] = share[-1, -1] = 1.0
        inner = rhs - rows @ share
        share[1:-1] = np.linalg.lstsq(rows[:, 1:-1], inner, rcond=None)[0]
        return share

    def _leaves(self, name: str, axis: int) -> Reals:
        """Derivatives (m, n) by the control points of a wall; zero for corners that are held."""
        own, none = len(getattr(self.design.channel, name)) + 2, np.zeros((len(self.rows), 1))
        moves = [self.jacobian.moves.get((name, point, axis), none) for point in range(own)]
        return np.stack([np.sum(each, axis=1) for each in moves], axis=1)


def forecast_of(match: Match, widest: Structure) -> Forecast | None:
    """The forecast about a match; None for other kinds, or where the widest structure leaves it no shape."""
    problem, footpoints = match.problem, match.state.footpoints
    if not stands_on_channel(match.design):
        return None
    try:
        design: Any = reshaped(match.design, widest)
        shape = match.model.shape(design)
    except DesignError:
        return None
    if not shape.finite:
        return None
    cloud_residuals = problem.cloud_residuals
    state = PlacedCloud(
        shape=shape,
        footpoints=footpoints_at(cloud_residuals.points, shape.sides, footpoints.side, footpoints.u, footpoints.v),
    )
    free = set(problem.paths)
    ends = [(edge, end) for edge in EDGES for end in (0, len(getattr(design.channel, edge)) - 1)]
    corners = {f"channel.{edge}[{end}].{label}" for edge, end in ends for label in AXES}
    was = {_same_corner(path, match.design, design) for path in free}
    held = frozenset(corners - was)
    fixed_laws = frozenset(name for name in STRUCTURE_LAWS if _is_held(match.design, name, free))
    paths = [path for path in design.parameters() if _law_of(path) and _law_of(path) not in fixed_laws]
    scales = scales_of(design, paths, match.model.chord)
    sizes = {path.partition("[")[0]: float(size) for path, size in zip(paths, scales.size, strict=True)}
    return Forecast(
        design=design,
        widest=structure_of(design),
        jacobian=cloud_residuals.jacobian(state, paths),
        rows=cloud_residuals.residuals(state),
        sizes=sizes,
        held=held,
        fixed_laws=fixed_laws,
        noise=problem.noise,
        match=match,
        points=len(cloud_residuals.points),
    )


def _row(label: str, count: int) -> list[str]:
    return [label] if count == 1 else [f"{label}[{i}]" for i in range(count)]


def _same_corner(path: str, old: Any, new: Any) -> str:
    """The path of a corner in a design with another number of control points of its edge."""
    for edge in EDGES:
        last = f"channel.{edge}[{len(getattr(old.channel, edge)) - 1}]"
        if path.startswith(last):
            return f"channel.{edge}[{len(getattr(new.channel, edge)) - 1}]{path[len(last) :]}"
    return path


def _law_of(path: str) -> str:
    """The law of a parameter by its name in a structure; empty where it has none."""
    name = path.removeprefix("channel.").partition("[")[0]
    if path.startswith("channel."):
        return name
    if name in ("leading_edge_theta", "leading_edge_y"):
        return "place"
    return name if name in (*SPANWISE, *THICKNESSES) else ""


def _field(design: Any, name: str) -> str:
    if name != "place":
        return name
    return "leading_edge_theta" if design.arrangement == "annular" else "leading_edge_y"


def _is_held(design: Any, name: str, free: set[str]) -> bool:
    own = [path for path in design.parameters() if _law_of(path) == name]
    corners = [path for path in own if name in EDGES and path.endswith(".r")]
    return (not own and name not in WALLS) or not set(own) - set(corners) <= free


def _wall_points(channel: Any, name: str) -> Any:
    end = 0 if name == "hub" else -1
    return (channel.leading_edge[end], *getattr(channel, name), channel.trailing_edge[end])


def _least_squares(columns: Reals, rows: Reals, roots: Reals | None, noise: float) -> tuple[float, Reals]:
    """The least squares by parameters that the regularisation's spread holds, and the step there."""
    own = columns if roots is None else columns * roots[:, None]
    rhs = rows if roots is None else rows * roots
    gram, right = own.T @ own, own.T @ rhs
    step = regularised_step(gram, right, noise)
    return float(rhs @ rhs - right @ step), -step


def regularised_step(gram: Reals, right: Reals, noise: float) -> Reals:
    """The solution (k,) of normal equations held by the regularisation's spread, or by rounding if that is more."""
    hold, rounding = noise**2, len(gram) * float(np.finfo(float).eps) * float(np.max(np.diag(gram), initial=1e-300))
    while True:
        try:
            return np.asarray(cho_solve(cho_factor(gram + hold * np.eye(len(gram))), right))
        except LinAlgError:
            # the spread of an exact cloud vanishes, and laws of equal effect leave the normal equations indefinite
            hold = max(10.0 * hold, rounding)
