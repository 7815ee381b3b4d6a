"""A design of the unified family fitted to a cloud of points: least squares on true distances.

The distance of a point is that to its nearest place on the native sides. With the place held fixed, only the motion of
the surface along the direction to the point counts, so the derivative of a distance by a parameter is -n . dS/dp, and
dS/dp comes from one rebuild with an imaginary step on every parameter at once (a leaf may be a batch of numbers).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from cloud_feet import Feet, feet, projected, wall_feet
from cloud_laws import Free, Weights, edges_unchecked, overfull, pressed, taming
from scipy.optimize import OptimizeResult, least_squares
from scipy.spatial import cKDTree

from bladewright.blade.blade import surface_of
from bladewright.blade.exact import exact_blade
from bladewright.blade.fitness import chord_of, knots_for
from bladewright.blade.knots import DEGREE, Knots
from bladewright.blade.native import native_sides
from bladewright.blade.stations import Stations
from bladewright.blade.unified import UnifiedBlade
from bladewright.errors import DesignError
from bladewright.nurbs.basis import Reals, basis
from bladewright.nurbs.surface import Surface

STEP = 1e-30


@dataclass(kw_only=True)
class Fitting:
    """Residuals, in chords, and their derivatives of a cloud, its walls and what keeps the laws smooth."""

    points: Reals
    """(n, 3) cloud [m]"""
    walls: dict[str, Reals]
    """(m, 2) places (x, r) [m] of `hub`, `shroud` and the edges, as far as they are known"""
    start: UnifiedBlade
    free: Sequence[Free]
    weights: Weights = field(default_factory=Weights)
    tolerance: float = 1e-5
    """of the native sides while fitting, of the chord; their knots are held"""

    def __post_init__(self) -> None:
        values = self.start.parameters()
        spacing = cKDTree(self.points).query(self.points, k=4)[0][:, 1:].mean(axis=1)
        self.share = np.clip(np.sqrt(spacing / np.mean(spacing)), 0.5, 2.0)
        self.wall_share = {
            wall: np.sqrt(self.weights.edges * len(self.points) / len(places)) if "edge" in wall else 1.0
            for wall, places in self.walls.items()
        }
        self.first = np.array([values[each.paths[0]] for each in self.free])
        self.size = np.array([each.size for each in self.free])
        with edges_unchecked():
            exact = exact_blade(self.start.changed("tolerance", self.tolerance))
            self.chord = chord_of(exact)
            self.knots: Knots = knots_for(exact, self.chord)
        self.tame, self.aim = taming(self.start, self.free, self.weights)

    def design(self, z: Reals) -> UnifiedBlade:
        return self.start.changed(self._leaves(self.first + z * self.size))

    def feet(self, design: UnifiedBlade) -> Feet:
        """The cloud's nearest places on a design's native sides at the fit's knots."""
        with edges_unchecked():
            return feet(self.points, *self._sides(exact_blade(design).stations(self.knots.sites_v)))

    def residuals(self, z: Reals) -> Reals:
        try:
            with edges_unchecked():
                exact = exact_blade(self.design(z))
                stations = exact.stations(self.knots.sites_v)
            sides = self._sides(stations)
        except DesignError:
            sides = ()
        if not sides or not np.all(np.isfinite(sides[0].control_points + sides[1].control_points)):
            count = 2 * len(self.points) + sum(map(len, self.walls.values())) + 4 * len(self.knots.sites_v)
            return np.full(count + len(self.aim), np.inf)
        on = feet(self.points, *sides)
        rows = [self.share * np.sum(on.miss * each, axis=-1) for each in (on.normal, on.beyond)]
        for wall, places in self.walls.items():
            _, normal, miss = wall_feet(exact.channel, wall, places)
            rows.append(self.wall_share[wall] * np.sum(miss * normal, axis=-1))
        held = self.weights.held * pressed(overfull(stations)).ravel()
        return np.concatenate([*(row / self.chord for row in rows), held, self.tame @ z - self.aim])

    def jacobian(self, z: Reals) -> Reals:
        with edges_unchecked():
            exact = exact_blade(self.design(z))
            stations = exact.stations(self.knots.sites_v)
        sides = self._sides(stations)
        on = feet(self.points, *sides)
        x, count = self.first + z * self.size, len(z)
        batch = [x[i] + 1j * STEP * self.size[i] * (np.arange(count) == i) for i in range(count)]
        with edges_unchecked():
            moved = exact_blade(self.start.changed(self._leaves(batch)))
            moving = moved.stations(self.knots.sites_v)
        nets = [np.imag(net) / STEP for net in native_sides(moving, self.knots)]
        rows = np.zeros((2, len(self.points), count))
        for net, mask in ((nets[0], on.upper), (nets[1], ~on.upper)):
            flat = np.broadcast_to(net, (count, *net.shape[-3:])).reshape(count, -1).T
            for row, direction in zip(rows, (on.normal, on.beyond), strict=True):
                along = direction[mask] * self.share[mask, None]
                row[mask] = -(projected(self.knots, on.u[mask], on.v[mask], along) @ flat)
        blocks = [*rows]
        for wall, places in self.walls.items():
            t, normal, _ = wall_feet(exact.channel, wall, places)
            curve = np.imag(moved.channel.line(wall).points) / STEP
            curve = np.broadcast_to(curve, (count, *curve.shape[-2:]))
            at = basis(exact.channel.knots(wall), exact.channel.degree_of(wall), t)
            blocks.append(-self.wall_share[wall] * np.einsum("ni,pid,nd->np", at, curve, normal))
        held = self.weights.held * np.imag(pressed(overfull(moving))) / STEP
        held = np.broadcast_to(held, (count, *held.shape[-2:])).reshape(count, -1).T
        return np.concatenate([*(block / self.chord for block in blocks), held, self.tame])

    def solve(self, rounds: int) -> tuple[UnifiedBlade, OptimizeResult]:
        low = (np.array([each.low for each in self.free]) - self.first) / self.size
        high = (np.array([each.high for each in self.free]) - self.first) / self.size
        zero = np.clip(np.zeros(len(self.free)), low + 1e-9, high - 1e-9)
        result = least_squares(
            self.residuals, zero, self.jacobian, bounds=(low, high), max_nfev=rounds, x_scale=1.0, xtol=1e-6, ftol=1e-5
        )
        return self.design(result.x), result

    def _leaves(self, values: Any) -> dict[str, Any]:
        return {path: values[i] for i, each in enumerate(self.free) for path in each.paths}

    def _sides(self, stations: Stations) -> tuple[Surface, Surface]:
        nets = native_sides(stations, self.knots)
        return surface_of(nets[0], self.knots, DEGREE), surface_of(nets[1], self.knots, DEGREE)
