"""The least-squares problem of a fit: residuals in chords and their derivatives by the scaled parameters."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.fitting.descent import Constrained
from bladewright.fitting.feet import Feet, feet
from bladewright.fitting.model import Model, Shape
from bladewright.fitting.prior import Prior
from bladewright.fitting.reach import Reach
from bladewright.fitting.scales import Scales
from bladewright.fitting.walls import Ends, Wall
from bladewright.nurbs.basis import Reals
EDGES = 0.05
"""part of a cloud that tells of its edges"""
FULLNESS = (0.8, 0.2)
"""how high the control point that sets an edge's radius usually stands, of the thickness beside it, and its spread"""


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """A shape and where the cloud stands on it."""

    shape: Shape
    feet: Feet


class Problem(Constrained):
    """Residuals of points, walls, noses and the prior; with the noise they are weighed by."""

    def __init__(
        self,
        *,
        points: Reals,
        weights: Reals,
        model: Model,
        start: Design,
        paths: Sequence[str],
        scales: Scales,
        prior: Prior,
        noise: float,
        alone: float,
        ends: Ends,
        reach: Reach,
        hint: Feet,
        margin: float = 0.0,
    ) -> None:
        self.points, self.roots, self.model = points, np.sqrt(weights * ~ends.covered), model
        self.start, self.paths, self.scales = start, tuple(paths), scales
        self.reach = reach
        self.noise, self.walls, self.ends, self.margin = noise, ends.walls, ends.near, margin
        self.trust = noise / float(np.sqrt(alone))
        """what the prior's spreads are measured by: larger where points repeat each other"""
        self.prior = Prior(matrix=prior.matrix * noise, aim=prior.aim * noise)
        values = start.parameters()
        self.first = np.array([float(values[path]) for path in self.paths])
        self.evaluations, self._least = 0, np.inf
        self._hint = hint
        self.best = np.zeros(len(self.paths))
        """of all that were asked"""
        self._last: tuple[bytes, State | None] = (b"", None)

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        """Lowest and highest scaled change."""
        return (self.scales.low - self.first) / self.scales.size, (self.scales.high - self.first) / self.scales.size

    def design(self, z: Reals) -> Design:
        """The design of a scaled change (k,)."""
        values = self.first + z * self.scales.size
        return self.start.changed({path: float(value) for path, value in zip(self.paths, values, strict=True)})

    def state(self, z: Reals) -> State | None:
        """The shape and the cloud's feet; None where there is no such shape."""
        key = z.tobytes()
        if self._last[0] != key:
            self._last = key, self._state(z)
        return self._last[1]

    def _state(self, z: Reals) -> State | None:
        self.evaluations += 1
        try:
            with np.errstate(invalid="ignore", divide="ignore"):
                shape = self.model.shape(self.design(z))
        except DesignError:
            return None
        if not shape.finite:
            return None
        self._hint = feet(self.points, shape.sides, self._hint)
        return State(shape=shape, feet=self._hint)

    def values(self, z: Reals) -> tuple[Reals, Reals] | None:
        """All residuals (m,), and by how much noses exceed the thickness beside them (c,)."""
        state = self.state(z)
        if state is None:
            return None
        rows = self._data(state, z)
        held = np.ravel(state.shape.noses[0]) + self.margin
        cost = float(rows @ rows) * (1.0 + 1e3 * float(np.max(held, initial=0.0)))
        if cost < self._least:
            self._least, self.best = cost, np.array(z)
        return rows, held

    def _data(self, state: State, z: Reals) -> Reals:
        chord = self.model.chord
        on = state.feet
        rows = [self.roots * on.heights / chord]
        rows.append((self.roots * np.sum(on.miss * on.beyond, axis=-1))[self.ends] / chord)
        for wall in self.walls.values():
            assert state.shape.exact is not None
            _, normal, miss = wall.misses(state.shape.exact)
            rows.append(self._wall_weight(wall) * np.sum(normal * miss, axis=-1) / chord)
        rows.append(self._nose_weight(state.shape) * (np.ravel(state.shape.noses[1]) - FULLNESS[0]))
        excess = self.reach.excess(self.reach.edges(state.shape))
        rows.append(self._edge_weight * np.maximum(excess, 0.0) / chord)
        rows.append(self.prior.matrix @ z - self.prior.aim)
        return np.concatenate(rows)

    def derivatives(self, z: Reals) -> tuple[Reals, Reals]:
        """Those (m, k) of all residuals, at held feet: those move along the surface only; and (c, k)."""
        state = self.state(z)
        assert state is not None
        chord, size = self.model.chord, self.scales.size
        on = state.feet
        tangents = self.model.tangents(state.shape, self.paths)
        rates = self.model.rates(state.shape, on, tangents)
        along = self.roots[:, None] * on.normals
        out = (self.roots[:, None] * on.beyond)[self.ends]
        blocks = [
            -np.einsum("nkd,nd->nk", rates, along) / chord,
            -np.einsum("nkd,nd->nk", rates[self.ends], out) / chord,
        ]
        for wall in self.walls.values():
            assert state.shape.exact is not None
            t, normal, _ = wall.misses(state.shape.exact)
            moving = wall.rates(state.shape, t, self.paths)
            blocks.append(-self._wall_weight(wall) * np.einsum("nkd,nd->nk", moving, normal) / chord)
        noses = self.model.nose_rates(state.shape, self.paths)
        held, fullness = (noses[:, i].reshape(len(self.paths), -1).T for i in (0, 1))
        blocks.append(self._nose_weight(state.shape) * fullness)
        edges = self.reach.edges(state.shape)
        out = edges.normals * (self._edge_weight * (self.reach.excess(edges) > 0.0))[:, None]
        blocks.append(np.einsum("nkd,nd->nk", self.model.rates(state.shape, edges, tangents), out) / chord)
        return np.concatenate([*(block * size for block in blocks), self.prior.matrix]), held * size

    @property
    def _edge_weight(self) -> float:
        """As of so many points, which the part of the cloud has that tells of an edge."""
        return float(np.sqrt(max(1.0, EDGES * len(self.points) / max(1, len(self.reach.u)))))

    def _nose_weight(self, shape: Shape) -> float:
        stations = shape.noses[0].size / 4.0
        return self.trust / (FULLNESS[1] * float(np.sqrt(stations)))

    def _wall_weight(self, wall: Wall) -> float:
        spread = wall.spread / self.model.chord
        return self.noise / max(self.noise, spread) if spread > 0.0 else 1.0
