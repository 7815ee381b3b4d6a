"""Points of hub and shroud beside a blade: a sheet on one curve of the meridional plane that ends the blade.

Sheets are connected patches of neighbouring points, whose plane holds the pitchwise direction (principal components:
Hoppe et al. 1992). A sheet is a wall where it is wider along the pitch than the blade is thick beside it, past which
it reaches on both sides, and most other points stand on no such curve. Sides do not, nor do noses, end faces and rows
of points.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.blade.design.row_design import Arrangement
from bladewright.fitting.clouds.thinning import groups, random_subset
from bladewright.numerics.elementary import cross2, length, turned_left
from bladewright.numerics.robust import median_deviation
from bladewright.nurbs.basis import Reals

LOOKED_AT = 6000
"""points, drawn at random, among which sheets are sought; it bounds the time (design/matching_constants.md)"""
PATCH, BESIDE = 12, 24
"""points of a patch, whose plane is known to some degrees, and of the surroundings of a point in the meridional plane
(design/matching_constants.md)"""
FLAT, AREA = 0.1, 0.3
"""ratio of a patch's extents in the meridional plane up to which it stands on a curve there, and in space from which it
is an area and no row of points (design/matching_constants.md)"""
TURN = 0.3
"""sine of the angle between neighbouring patches of one sheet at most (design/matching.md)"""
FEWEST_SHARE = 0.01
"""share of the points that the smallest wall has, and two patches in any case (design/matching_constants.md)"""
MOST_SHEETS = 0.5
"""share of the points off a wall that may stand on curves too: blades do that are seen along their span, as one at the
side of the axis is while a cascade is tried (design/matching.md)"""
WIDER = 1.35
"""least width of a wall along the pitch, of the largest thickness beside it (design/matching.md)"""
PAST = 0.1
"""share of a wall's points that lie past the blade on each side at least (design/matching.md)"""
FILLET_PATCH = 8
"""points of a patch of a fillet, which is small (design/matching_constants.md)"""
AT_WALL, ON_FILLET = 0.65, 0.5
"""cosine between the normals of wall and surface, by the median of `BESIDE` points, from which the points next to a
wall are a fillet's, and down to which those above are (design/matching.md)"""
ROW_WIDTH, LEAST_SCATTER = 4.5, 1e-4
"""standard deviations of its scatter within which a point stands on a wall's curve, and the least such distance, of the
wall's extent: exact walls are curved within a patch (design/matching_constants.md)"""


class Walls(NamedTuple):
    """Walls beside a blade."""

    kinds: NDArray[np.str_]
    """(n,) what a point may lie on: empty of the sides, `wall` where one stands in the meridional plane, as the sides'
    own ends do, too, and `fillet` as near to it as its fillet reaches at most"""
    places: tuple[Reals, ...] = ()
    """(m, 2) of each wall, points in x and the radius, or in x and z of a cascade [m]"""


class _Unrolled(NamedTuple):
    """Points unrolled into the meridional plane and the pitch."""

    plane: Reals
    """(n, 2) x and the radius, or x and z of a cascade [m]"""
    pitchwise: Reals
    """(n,) arc around the axis, or y of a cascade [m]"""
    second: Reals
    """(n, 3) unit vectors of the second coordinate in the plane"""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sheet:
    """A curve in the meridional plane through the points (m, 2) of a sheet."""

    points: Reals
    tangents: Reals

    @cached_property
    def tree(self) -> cKDTree:
        return cKDTree(self.points)

    @property
    def extent(self) -> float:
        return float(length(np.ptp(self.points, axis=0)))

    def beside(self, plane: Reals, width: float) -> tuple[Reals, NDArray[np.intp], NDArray[np.bool_]]:
        """Distances of places (n, 2) from the sheet's points, the nearest of these, and which stand above or below."""
        away, nearest = self.tree.query(plane)
        along = np.sum((plane - self.points[nearest]) * self.tangents[nearest], axis=1)
        return away, nearest, np.abs(along) < width

    def off(self, plane: Reals) -> Reals:
        """Distances (n,) from the line through the sheet's points around each place (n, 2)."""
        patches = self.points[self.tree.query(plane, k=PATCH)[1]]
        return np.abs(cross2(plane - np.mean(patches, axis=1), _extents(patches)[1][:, 0]))

    def holds(self, plane: Reals, reach: float) -> NDArray[np.bool_]:
        """Which of places (n, 2) stand on the curve, nearer than `reach` to the sheet."""
        within = ROW_WIDTH * median_deviation(self.off(self.points)) + LEAST_SCATTER * self.extent
        return np.asarray((self.tree.query(plane)[0] < reach) & (self.off(plane) <= within))


def walls_of(points: Reals, arrangement: Arrangement | None) -> Walls:
    """Hub and shroud beside a blade of points (n, 3) [m]; if no arrangement is known, in that of more such points."""
    if points.shape[1] == 2:
        return Walls(np.full(len(points), ""))
    kinds: tuple[Arrangement, ...] = ("annular", "linear") if arrangement is None else (arrangement,)
    return max((_walls(points, kind) for kind in kinds), key=lambda walls: np.count_nonzero(walls.kinds == "wall"))


def _unrolled(points: Reals, arrangement: Arrangement) -> _Unrolled:
    x, y, z = points.T
    if arrangement == "linear":
        return _Unrolled(np.stack([x, z], axis=-1), y, np.tile([0.0, 0.0, 1.0], (len(x), 1)))
    radius, angle = np.hypot(y, z), np.arctan2(y, z)
    middle = np.angle(np.mean(np.exp(1j * angle)))
    outward = np.stack([np.zeros_like(angle), np.sin(angle), np.cos(angle)], axis=-1)
    return _Unrolled(np.stack([x, radius], axis=-1), radius * np.angle(np.exp(1j * (angle - middle))), outward)


def _walls(points: Reals, arrangement: Arrangement) -> Walls:
    every, places = _unrolled(points, arrangement), list[Reals]()
    on_curve, on_fillet = np.zeros((2, len(points)), dtype=bool)
    rows = random_subset(len(points), LOOKED_AT)
    some = _Unrolled(*(each[rows] for each in every))
    near = cKDTree(points[rows]).query(points[rows], k=PATCH)[1]
    extents, axes = _extents(some.plane[near])
    tangents, in_space = axes[:, 0], _extents(points[rows][near])[0]
    # areas, and no rows of points
    sheets = (extents[:, 1] < FLAT * extents[:, 0]) & (in_space[:, 1] > AREA * in_space[:, 0])
    together = np.abs(cross2(tangents[:, None], tangents[near])) < TURN
    label = groups(sheets[:, None] & sheets[near] & together, near)
    for group in np.unique(label[sheets]):
        own = sheets & (label == group) & ~on_curve[rows]
        if np.count_nonzero(own) >= max(2 * PATCH, FEWEST_SHARE * len(rows)):
            # a wall may lie to both sides of its blade
            one = _Sheet(points=some.plane[own], tangents=tangents[own])
            alike = np.abs(cross2(tangents, one.tangents[one.tree.query(some.plane)[1]])) < TURN
            own |= sheets & alike & one.holds(some.plane, one.extent)
            sheet = _Sheet(points=some.plane[own], tangents=tangents[own])
            width = float(np.median(extents[own, 0]))
            others = ~own & ~sheet.holds(some.plane, 2.0 * width)
            seen_along_span = np.count_nonzero(others & sheets) > MOST_SHEETS * np.count_nonzero(others)
            if not seen_along_span and _is_wall(sheet, some, own, others, width):
                on_curve |= sheet.holds(every.plane, 2.0 * width)
                on_fillet |= sheet.tree.query(every.plane)[0] < _fillet_height(sheet, some, points[rows], others, width)
                places.append(sheet.points)
    return Walls(np.where(on_curve, "wall", np.where(on_fillet, "fillet", "")), tuple(places))


def _extents(patches: Reals) -> tuple[Reals, Reals]:
    """Extents (n, d) of patches (n, k, d) along their own axes, largest first, and these axes (n, d, d)."""
    _, sizes, axes = np.linalg.svd(patches - np.mean(patches, axis=1)[:, None], full_matrices=False)
    return sizes / np.sqrt(patches.shape[1]), axes


def _is_wall(sheet: _Sheet, some: _Unrolled, own: NDArray[np.bool_], others: NDArray[np.bool_], width: float) -> bool:
    """Whether a sheet is wider along the pitch than the blade is thick beside it, and reaches past both sides."""
    away, _, across = sheet.beside(some.plane, width)
    if np.count_nonzero(others & (away < 0.25 * sheet.extent) & across) < BESIDE:
        return False
    at = some.pitchwise[own]
    own_width = np.ptp(at[sheet.tree.query(sheet.points, k=BESIDE)[1]], axis=1)
    beside = some.pitchwise[others][cKDTree(some.plane[others]).query(sheet.points, k=BESIDE)[1]]
    low, high = np.min(beside, axis=1), np.max(beside, axis=1)
    past = min(np.mean(at < low), np.mean(at > high))
    return bool(past > PAST and np.median(own_width) > WIDER * np.quantile(high - low, 0.95))


def _fillet_height(sheet: _Sheet, some: _Unrolled, points: Reals, others: NDArray[np.bool_], width: float) -> float:
    """Height [m] above a wall that its fillet reaches at most; 0 where there is none.

    With a the cosine between the normals of wall and surface, a ball of radius r leaves the height r (1 - a), and ends
    below 2 r.
    """
    away, nearest, across = sheet.beside(some.plane, width)
    rows = np.flatnonzero(others & across)
    rows = rows[np.argsort(away[rows], kind="stable")]
    patches = points[others][cKDTree(points[others]).query(points[rows], k=FILLET_PATCH)[1]]
    normals = _extents(patches)[1][:, 2]
    upright = turned_left(sheet.tangents[nearest[rows]])
    in_space = upright[:, :1] * [1.0, 0.0, 0.0] + upright[:, 1:] * some.second[rows]
    facing = np.abs(np.sum(normals * in_space, axis=1))
    windows = np.median(np.lib.stride_tricks.sliding_window_view(facing, min(BESIDE, len(rows))), axis=1)
    if windows[0] < AT_WALL or not np.any(windows < ON_FILLET):
        return 0.0
    low = int(np.argmax(windows < ON_FILLET))
    return 2.0 * float(np.sum(sheet.off(some.plane[rows[:low]])) / np.sum(1.0 - facing[:low]))
