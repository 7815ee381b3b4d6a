"""What a cloud shows of the ends and the edges of a blade: points at hub and shroud, on end faces, and beside edges."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.native.cut_lines import in_meridian
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.matching.footpoints import (
    EDGE_PARAMETERS,
    Footpoints,
    Side,
    footpoints_at,
    part_of,
    unit_or_zero,
)
from bladewright.fitting.models.model import ModelShape, stepped_rates
from bladewright.numerics.elementary import length, turned_left
from bladewright.numerics.robust import median_deviation
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

ROW_BAND = 0.015
"""distance from an end, in v, within which a point may belong to its row (design/matching_constants.md)"""
ROW_PARTS, ROW_SHARE = 20, 0.5
"""parts of the chord, and share of them that must show an end: a part of the span does not (design/matching.md)"""
FACE_BAND, FACE_DEPTH, FACE_NEARER_WALL = 0.1, 5.0, 0.3
"""of a point of an end face: largest distance from the end, in v, least depth, in usual distances from the sides, and
largest distance from the wall or a row of outliers, of that depth (design/matching_constants.md)"""
FACE_OUTLIERS, FACE_OUTLIERS_NEARER_WALL = 20, 0.1
"""fewest outliers of an end face, and median of distances from a row, of their depths (design/matching_constants.md)"""
DEEPEST_FACE_POINT = 0.2
"""least depth of an end face's deepest point, of the blade's half thickness (design/matching_constants.md)"""
PAST_END_BAND = 0.05
"""distance from an end, in v, within which a point may come to lie past it (design/matching_constants.md)"""
MOST_WALL_POINTS = 400
"""points of a wall beside the blade that count: as many as a row at an end has (design/matching_constants.md)"""
FEWEST_ROW_POINTS = 5
"""points that a row at an end needs (design/matching_constants.md)"""
ROW_WIDTH, ROW_LEAST_WIDTH = 4.5, 1e-6
"""distance from the middle of a row within which a point belongs to it, in standard deviations, and the least of these,
of the places' extent (design/matching_constants.md)"""
ROW_DEGREE, ROW_TURNS, ROW_SETTLING_TURNS = 6, 30, 3
"""highest degree of the law by which a row may be off the wall, and turns in which it is found as a quantile, then by
least squares (design/matching_constants.md)"""
OWN_DEGREE = 12
"""highest degree of a row's own law off a straight line, as hubs turn by a right angle (design/matching.md)"""
CLEARLY_ALONE = 0.01
"""ratio of medians below which a row is told by a line of its own, not by its wall (design/matching.md)"""
OUTER_QUANTILE = 0.2
"""share of the places outside the law that is first sought: a row is the outermost (design/matching_constants.md)"""
WALL_REACH = (-0.1, 1.1)
"""parameters between which a wall is continued past the edges (design/matching.md)"""
ROW_SPREAD = 1e-3
"""spread of the points at an end below which they stand in a row, of the chord (design/matching_constants.md)"""
END_PARAMETERS = {"hub": 0.0, "shroud": 1.0}
"""v of the two ends, by the name of their wall."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WallPoints:
    """Points of the cloud at one end of the blade, in the meridional plane."""

    name: str
    """of the wall: hub or shroud"""
    places: Reals
    """(m, 2) the points in (x, r) [m]"""
    spread: float = 0.0
    """standard deviation of their distances from one curve: small where the cloud has a row there [m]"""
    rows: NDArray[np.intp] = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    """(m,) which points of the cloud they are; none of a wall beside the blade"""

    def located(self, exact: ExactBlade) -> tuple[Reals, Reals, Reals]:
        """Nearest parameters (m,) on the wall's curve, continued, unit normals (m, 2) and signed distances (m,) [m]."""
        line = exact.wall(self.name)
        t = np.linspace(-0.05, 1.05, 400)
        t = t[cKDTree(np.real(line.values(t))).query(self.places)[1]]
        for _ in range(6):
            value, first, second = (np.real(line.values(t, order)) for order in range(3))
            miss = value - self.places
            rise = np.sum(first**2, axis=-1) + np.sum(miss * second, axis=-1)
            t = np.clip(t - np.sum(miss * first, axis=-1) / np.where(rise > 0.0, rise, np.inf), *WALL_REACH)
        value, first = (np.real(line.values(t, order)) for order in range(2))
        normal = unit_or_zero(turned_left(first))
        return t, normal, np.asarray(np.sum(normal * (self.places - value), axis=-1))

    def motion_rates(self, exact: ExactBlade, points: Reals, rates: Reals) -> Reals:
        """Rates (m, 2, k) of the places where points (n, 3) of the cloud move at rates (n, 3, k); 0 of walls beside."""
        if len(self.rows) == 0:
            return np.zeros((len(self.places), 2, rates.shape[2]))
        across = points[self.rows] * [0.0, 1.0, 1.0]
        radial = unit_or_zero(across) if exact.mapping.revolved else np.tile([0.0, 0.0, 1.0], (len(across), 1))
        return np.stack([rates[self.rows, 0], np.einsum("md,mdk->mk", radial, rates[self.rows])], axis=1)

    def rates(self, shape: ModelShape, t: Reals, paths: Sequence[str]) -> Reals:
        """Derivatives (m, k, 2) of the places on the curve at held parameters."""

        def places(design: Any) -> Reals:
            return np.reshape(shape.exact.moved_to(design).wall(self.name).values(t), (-1, 2 * len(t)))

        moving = ("channel.", "flow_path.", "tip_", "hub_")
        found = stepped_rates(shape, paths, moving, 2 * len(t), places)
        return np.moveaxis(found.reshape(len(paths), len(t), 2), 0, 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class BladeEnds:
    """What a cloud shows of the blade's ends."""

    walls: Mapping[str, WallPoints]
    on_end_face: NDArray[np.bool_]
    """(n,) whether a point lies on an end face, inside the blade's outline"""
    near: NDArray[np.intp]
    """indices of the points that may lie past an end of the sides"""

    def in_rows(self, chord: float) -> bool:
        """Whether rows of points show where hub and shroud are."""
        return len(self.walls) == 2 and all(wall.spread < ROW_SPREAD * chord for wall in self.walls.values())


def blade_ends_of(
    points: Reals,
    footpoints: Footpoints,
    shape: ModelShape,
    rows: NDArray[np.bool_],
    beside: Sequence[Reals] = (),
    reach: float = ROW_BAND,
) -> BladeEnds:
    """The ends as points (n, d) show them, of those in `rows` (n,), and places (m, 2) of walls `beside` the blade.

    Most parts of the chord must have points within `reach` of an end, in v.
    """
    on_end_face = np.zeros(len(points), dtype=bool)
    exact = shape.exact
    if exact is None:
        return BladeEnds(walls={}, on_end_face=on_end_face, near=np.empty(0, dtype=np.intp))
    places = in_meridian(points, exact.mapping.revolved)
    usual = median_deviation(footpoints.distances[rows])
    walls = {}
    for name, end in END_PARAMETERS.items():
        beside_end = np.abs(footpoints.v - end) < FACE_BAND
        inside = np.flatnonzero(beside_end & (footpoints.heights < -FACE_DEPTH * usual))
        depth, out = -footpoints.heights[inside], ~rows[inside]
        share = np.abs(WallPoints(name=name, places=places[inside]).located(exact)[2]) / depth
        # points of a solid's end faces are outliers to its sides, and stand in a row, beside a wall that is not found
        # yet; stray points do not
        if np.count_nonzero(out) >= FACE_OUTLIERS:
            share[out] = _off_row(WallPoints(name=name, places=places[inside[out]]), exact) / depth[out]
        dense = np.count_nonzero(out) >= FACE_OUTLIERS and np.median(share[out]) < FACE_OUTLIERS_NEARER_WALL
        face = inside[(share < FACE_NEARER_WALL) & (rows[inside] | dense)]
        # beside an edge that is not yet found, points lie a little inside too
        thickness = shape.thickness(np.linspace(0.1, 0.9, 9), end)
        if np.max(-footpoints.heights[face], initial=0.0) > 0.5 * DEEPEST_FACE_POINT * thickness:
            on_end_face[face] = True
        chosen = np.flatnonzero(_outermost(footpoints, rows & ~on_end_face, end, reach) | (on_end_face & beside_end))
        if len(chosen) < FEWEST_ROW_POINTS:
            continue
        aside = _off_row(WallPoints(name=name, places=places[chosen]), exact)
        spread = median_deviation(aside)
        # points of the sides beside the row would pull the end inwards
        chosen = chosen[aside <= ROW_WIDTH * max(spread, ROW_LEAST_WIDTH * float(np.ptp(places)))]
        walls[name] = WallPoints(name=name, places=places[chosen], spread=spread, rows=chosen)
    walls |= {wall.name: wall for wall in _walls_beside(beside, exact)}
    near = np.flatnonzero(((footpoints.v < PAST_END_BAND) | (footpoints.v > 1.0 - PAST_END_BAND)) & ~on_end_face)
    return BladeEnds(walls=walls, on_end_face=on_end_face, near=near)


def _outermost(footpoints: Footpoints, rows: NDArray[np.bool_], end: float, reach: float) -> NDArray[np.bool_]:
    """Which of n points, of those in `rows` (n,), may belong to the row at an end, shown within `reach` of it."""
    # where most parts of the chord show the end, the row is the points beside the outermost of each part: a corner that
    # has slid past its points is far from its row
    away, part = np.abs(footpoints.v - end), part_of(footpoints.u, ROW_PARTS)
    least = np.full(ROW_PARTS, np.inf)
    np.minimum.at(least, part[rows], away[rows])
    slid = np.where(np.mean(least < reach) > ROW_SHARE, least, 0.0)[part]
    return rows & (away < np.where(slid < FACE_BAND, slid, 0.0) + ROW_BAND)


def _walls_beside(beside: Sequence[Reals], exact: ExactBlade) -> Iterator[WallPoints]:
    """The places (m, 2) beside a blade between its edges, each set of them with the wall that most are nearer to."""

    def away(wall: WallPoints) -> float:
        return float(np.median(np.abs(wall.located(exact)[2])))

    nearer = [min((WallPoints(name=name, places=each) for name in END_PARAMETERS), key=away) for each in beside]
    for name in sorted({wall.name for wall in nearer}):
        places = np.concatenate([wall.places for wall in nearer if wall.name == name])
        t, _, _ = WallPoints(name=name, places=places).located(exact)
        between = np.flatnonzero((t > 0.0) & (t < 1.0))
        found = WallPoints(name=name, places=places[between[random_subset(len(between), MOST_WALL_POINTS)]])
        yield replace(found, spread=median_deviation(_off_row(found, exact))) if len(between) else found


def _off_row(wall: WallPoints, exact: ExactBlade) -> Reals:
    """Distances (m,) [m] from the row in which most places stand, which may be off the wall by a smooth law.

    Where that leaves a hundred times as much, from a row of its own: a wall that is not found yet may be no smooth one.
    """
    t, normals, distances = wall.located(exact)
    inward = 1.0 if wall.name == "hub" else -1.0
    # places past a wall's continuation are on no law off it
    miss = length(wall.places - np.real(exact.wall(wall.name).values(t)))
    past = np.where((t <= WALL_REACH[0]) | (t >= WALL_REACH[1]), miss, 0.0)
    by_wall = np.maximum(_off_law(2.0 * t - 1.0, distances, inward, ROW_DEGREE), past)
    about = wall.places - np.mean(wall.places, axis=0)
    axes = np.linalg.eigh(about.T @ about)[1].T
    # along the wall: across it, rows beside each other seem to be one
    first, last = np.real(exact.wall(wall.name).values(np.array([0.0, 1.0])))
    across, line = axes[np.argsort(np.abs(axes @ (last - first)))]
    way, off = about @ line, about @ across
    along = way / max(float(np.max(np.abs(way))), 1e-300)
    alone = _off_law(along, off, inward * float(np.sign(np.sum(normals @ across))), OWN_DEGREE)
    return alone if np.median(alone) < CLEARLY_ALONE * np.median(by_wall) else by_wall


def _off_law(along: Reals, distances: Reals, inward: float, most: int) -> Reals:
    """Magnitudes (m,) of what a polynomial of degree `most` along [-1, 1] leaves of distances (m,): most follow one.

    First it is that of a quantile, as places beside the row lie inwards of it only.
    Reference: Koenker and Bassett 1978 (quantiles), by iteratively reweighted least squares.
    """
    degree = min(most, max(len(along) // FEWEST_ROW_POINTS - 1, 0))
    terms = np.polynomial.chebyshev.chebvander(along, degree)
    roots, left = np.ones(len(along)), distances
    for _ in range(ROW_TURNS):
        left = distances - terms @ np.linalg.lstsq(roots[:, None] * terms, roots * distances, rcond=None)[0]
        size = np.maximum(np.abs(left), 1e-3 * float(np.median(np.abs(left))))
        share = np.where(inward * left > 0.0, OUTER_QUANTILE, 1.0 - OUTER_QUANTILE)
        roots = np.sqrt(share / np.where(size > 0.0, size, 1.0))
        roots /= np.max(roots)
    for _ in range(ROW_SETTLING_TURNS):
        row = np.abs(left) <= ROW_WIDTH * median_deviation(left)
        left = distances - terms @ np.linalg.lstsq(terms[row], distances[row], rcond=None)[0]
    return np.abs(left)


STATIONS: Reals = np.concatenate([[0.0], np.linspace(1.0 / 32.0, 31.0 / 32.0, 16), [1.0]])
"""places along the span, v, at which each edge is looked at; more add rows that say the same."""
COVERED_SPAN = 0.05
"""distance of the nearest point from an end, in v, up to which the cloud shows it (design/matching_constants.md)"""
SPANWISE_WEIGHT = 0.2
"""factor of distances along an edge in the search for its nearest point (design/matching_constants.md)"""
NEIGHBOURS = 6
"""points beside an edge whose distances from each other are looked at (design/matching_constants.md)"""
ALLOWED_SPACINGS, ALLOWED_SPACINGS_EXACT = 1.5, {2: 15.0, 3: 5.2}
"""allowed overhang in spacings of the points beside the edge, and in an exact cloud, by dimension, where a true edge
must cost nothing even by chance (Poisson process, design/matching.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgeOverhang:
    """Places along both edges, and beside each the nearest point of the cloud."""

    points: Reals
    """(m, d) the nearest points of the cloud [m]"""
    u: Reals
    """(m,) of the edge: 0 or 1"""
    v: Reals
    """(m,) of the places along the edges"""
    allowed: Reals
    """(m,) overhang that costs nothing [m]; infinite where the cloud does not show the edge"""
    normals: Reals
    """(m, d) out of the blade, held: a nose turns them as it moves, where the points beside it may lie far along it"""

    def looks_at(self, u: float) -> bool:
        """Whether the cloud shows the edge at u."""
        return bool(np.any(np.isfinite(self.allowed[self.u == u])))

    def edges(self, sides: Sequence[Side]) -> Footpoints:
        """The places on the edges beside the points, as footpoints with the held normals."""
        return replace(footpoints_at(self.points, sides, 0, self.u, self.v), normals=self.normals)

    def excess(self, edges: Footpoints) -> Reals:
        """By how much edges stand out further than allowed (m,) [m]; negative where they do not."""
        return np.asarray(-np.sum(edges.miss * edges.normals, axis=-1) - self.allowed)


def edge_overhang_of(
    points: Reals,
    sides: Sequence[Side],
    rows: NDArray[np.bool_],
    *,
    exact: bool = False,
    cut_edges: Collection[str] = (),
) -> EdgeOverhang:
    """The overhang of both edges over points in `rows` (n,); loose limits for an `exact` cloud, none at cut edges."""
    upper, cloud = sides[0], points[rows]
    stations: Reals = STATIONS if isinstance(upper, Surface) else np.zeros(1)
    u, v = np.repeat([0.0, 1.0], len(stations)), np.tile(stations, 2)
    cut = [end for name, end in EDGE_PARAMETERS.items() if name.replace(" ", "_") in cut_edges]
    chosen, shown = [], ~np.isin(u, cut)
    for i, at in enumerate(footpoints_at(None, sides, 0, u, v).points):
        offset = cloud - at
        away = np.sum(offset**2, axis=-1)
        if isinstance(upper, Surface):
            along = np.asarray(upper.derivative(u[i : i + 1], v[i : i + 1], 0, 1))[0]
            way = offset @ along / (along @ along)
            away -= (1.0 - SPANWISE_WEIGHT**2) * way**2 * (along @ along)
            shown[i] &= 0.0 < v[i] < 1.0 or abs(way[np.argmin(away)]) < COVERED_SPAN
        chosen.append(int(np.argmin(away)))
    nearest = cloud[chosen]
    tree = cKDTree(cloud)
    _, around = tree.query(nearest, k=NEIGHBOURS)
    spacings = tree.query(cloud[around.ravel()], k=3)[0][:, -1]
    most = ALLOWED_SPACINGS_EXACT[points.shape[1]] if exact else ALLOWED_SPACINGS
    allowed = np.where(shown, most * np.median(spacings.reshape(len(chosen), NEIGHBOURS), axis=1), np.inf)
    return EdgeOverhang(points=nearest, u=u, v=v, allowed=allowed, normals=outward_at_edges(sides, u, v))


def outward_at_edges(sides: Sequence[Side], u: Reals, v: Reals) -> Reals:
    """Unit vectors (m, d) out of the blade at its edges, where u is 0 or 1."""
    # around a round edge the sides run opposite ways, and their normals point out; at a blunt or a sharp one the
    # normals are nearly opposite, and the sides run out
    out = np.zeros((len(u), np.real(sides[0].control_points).shape[-1]))
    for number, side in enumerate(sides):
        at = footpoints_at(None, sides, number, u, v)
        along = side.derivative(u, v, 1, 0) if isinstance(side, Surface) else side.derivative(u)
        out += at.normals + np.where(u > 0.5, 1.0, -1.0)[:, None] * unit_or_zero(np.asarray(along))
    if isinstance(sides[0], Surface):
        # across the edge, as the points beside an oblique one may lie far along it
        edge = unit_or_zero(np.asarray(sides[0].derivative(u, v, 0, 1)))
        out -= np.sum(out * edge, axis=-1, keepdims=True) * edge
    return unit_or_zero(out)
