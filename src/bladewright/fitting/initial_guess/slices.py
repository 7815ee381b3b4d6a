"""Camber and thickness of a blade's sections: linear least squares of both sides in frames along the chord.

With t from edge to edge along the chord, the sides stand at c(t, v) + h(t, v) and c(t, v) - h(t, v) across it. The
middle c is a cubic in t, so that it is a Bezier curve in the plane, and the half thickness h is made of the roots and
powers that round, sharp and blunt edges need; each coefficient is a law along the span v. Which side a point is on, and
how much it counts, follows from the last turn.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from bladewright.numerics.elementary import length
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation
from bladewright.nurbs.basis import Reals
from bladewright.section.camber import bernstein, camber_tangents
from bladewright.section.laws import law_basis, plain_law
from bladewright.section.unified_limits import THICKNESSES

TURNS = 12
"""times that points are assigned to the sides; most clouds settle in five (design/first_guesses.md)"""
RIDGE = 1e-3
"""weight that holds coefficients which the points leave open, of the weight of all points (design/first_guesses.md)"""
STEEPEST = np.radians(86.0)
"""steepest angle of a chord or a camber [rad]; the family's own limit is 90 degrees (design/first_guesses.md)"""
BANDS, BAND_POINTS = 8, 12
"""bands along the span that show ends and turns of sections, and the least points of one (design/first_guesses.md)"""
PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 42)[1:-1])) / 2.0
"""places along the chord at which the half thickness is given"""
EDGE_PLACE = 0.02
"""place along the chord, from an edge, at which the half thickness shows the edge's radius (design/first_guesses.md)"""
NOSE, LEAST_NOSE_WEIGHT, NOSE_REACH = 0.08, 0.05, 0.2
"""distance from an edge, in chords, from which points count in full, as a cambered section's nose does not point along
the chord; weight of a point at the edge; and distance from the nose within which the edge is sought, as the point
furthest along the camber (design/first_guesses.md)"""
EDGE_SHARE = 60
"""one in so many points of a band stands at an edge (design/first_guesses.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanePoints:
    """Points of a cloud in the planes of their sections."""

    points: Reals
    """(n, 2) abscissa and ordinate, in extents of the stream lines"""
    v: Reals
    """(n,) place along the span; zeros of a single section"""

    @cached_property
    def bands(self) -> list[NDArray[np.intp]]:
        """Indices of the points in bands along the span that overlap."""
        middles = np.linspace(0.0, 1.0, BANDS + 1)
        found = [np.flatnonzero(np.abs(self.v - middle) < 1.0 / BANDS) for middle in middles]
        return [rows for rows in found if len(rows) >= BAND_POINTS]


@dataclass(frozen=True, kw_only=True, eq=False)
class Slices:
    """Sections at places v (m,) along the span, in extents of the stream lines."""

    v: Reals
    camber: Reals
    """(m, 4, 2) control points of the camber lines, cubic Bezier curves"""
    half: Reals
    """(m, k) half thickness at PLACES, normal to the camber"""
    mean_distance: float
    """of the points from the sections, in chords"""

    @property
    def chords(self) -> Reals:
        """(m,) distances from edge to edge."""
        return length(self.camber[:, 3] - self.camber[:, 0])

    @property
    def radii(self) -> Reals:
        """(2, m) radii of the parabolas through leading and trailing edge: h^2 = 2 R t."""
        half = np.array([[np.interp(at, PLACES, row) for row in self.half] for at in (EDGE_PLACE, 1.0 - EDGE_PLACE)])
        return half**2 / (2.0 * EDGE_PLACE * self.chords)


def slices_of(plane: PlanePoints, turn: Reals, stations: Reals, count: int) -> Slices:
    """The sections of points whose chord lies along the law `turn` (k,) [rad], with laws of `count` control points."""
    direction = law_basis(len(turn), plane.v) @ turn
    cosine, sine = np.cos(direction), np.sin(direction)
    rows, at = law_basis(count, plane.v), law_basis(count, stations)
    a, b = plane.points.T
    along, across = cosine * a + sine * b, -sine * a + cosine * b
    everywhere = np.arange(len(along))
    low, high = (_outermost(plane, rows, along[:, None], sign * along, everywhere)[:, 0] for sign in (-1.0, 1.0))
    first, size = rows @ low, np.maximum(rows @ (high - low), 1e-6)
    t = np.clip((along - first) / size, 0.0, 1.0)
    middle_rows, half_rows = (
        (values[:, :, None] * rows[:, None, :]).reshape(len(t), -1)
        for values in (chebyshev.chebvander(2.0 * t - 1.0, 3), _half_basis(t))
    )
    # each part of the blade counts alike, however many points it has
    cells = np.minimum((10.0 * t).astype(int), 9) + 10 * np.clip((4.0 * plane.v).astype(int), 0, 3)
    full = 1.0 / np.sqrt(np.bincount(cells)[cells])
    even = full * np.clip(np.minimum(t, 1.0 - t) / NOSE, LEAST_NOSE_WEIGHT, 1.0)
    weight: Reals = even
    upper = across > middle_rows @ _ridge(middle_rows, across, even)
    for _ in range(TURNS):
        above = np.where(upper, 1.0, -1.0)[:, None]
        found = _ridge(np.concatenate([middle_rows, above * half_rows], axis=1), across, weight)
        middle, half = middle_rows @ found[: 4 * count], half_rows @ found[4 * count :]
        off = across - middle
        # where the sides meet, noise may cross them
        now = off * np.sign(half) > 0.0
        left = np.abs(np.abs(off) - np.abs(half))
        width = TUKEY_WIDTH * (median_deviation(left) + 1e-12)
        weight = np.asarray(even * np.maximum(1.0 - (left / width) ** 2, 0.05))
        if np.array_equal(now, upper):
            break
        upper = now
    # the noses tell the edges' radii
    found[4 * count :] = _ridge(half_rows, np.where(upper, off, -off), full)
    left = np.abs(np.abs(off) - np.abs(half_rows @ found[4 * count :]))
    middle_laws, half_laws = found[: 4 * count].reshape(4, count), found[4 * count :].reshape(-1, count)
    ends = []
    for place, sign in ((NOSE, -1.0), (1.0 - NOSE, 1.0)):
        slopes = (2.0 * chebyshev.chebvander(2.0 * place - 1.0, 2) @ chebyshev.chebder(middle_laws))[0]
        ahead = along + (rows @ slopes) / size * across
        near = np.flatnonzero(np.abs(t - place) < NOSE_REACH)
        ends.append(_outermost(plane, rows, np.stack([along, across], axis=-1), sign * ahead, near))
    line, half = _placed(at, middle_laws, half_laws, (at @ low, at @ (high - low)), (at @ ends[0], at @ ends[1]))
    direction = law_basis(len(turn), stations) @ turn
    cosine, sine = np.cos(direction)[:, None], np.sin(direction)[:, None]
    x, y = line[..., 0], line[..., 1]
    line = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
    return Slices(v=stations, camber=line, half=half, mean_distance=float(np.mean(left / size)))


def _outermost(plane: PlanePoints, rows: Reals, places: Reals, ahead: Reals, near: NDArray[np.intp]) -> Reals:
    """Control points (count, k) of the law of places (n, k) of the points that stand furthest ahead, of those near."""
    chosen = []
    for band in plane.bands:
        some = np.intersect1d(band, near)
        chosen.append(some[np.argsort(-ahead[some])[: max(1, len(band) // EDGE_SHARE)]])
    which = np.concatenate(chosen)
    return np.stack([_ridge(rows[which], each, np.ones(len(which))) for each in places[which].T], axis=-1)


def _placed(
    at: Reals, middle: Reals, half: Reals, frame: tuple[Reals, Reals], ends: tuple[Reals, Reals]
) -> tuple[Reals, Reals]:
    """Camber lines (m, 4, 2) between edges `ends` (m, 2), and half thicknesses (m, k) normal to them.

    `middle` and `half` are the coefficients of c and h; `frame` (m,) has where t begins and how long it is.
    """
    first, size = frame
    start, extent = ends[0][:, 0], np.maximum(ends[1][:, 0] - ends[0][:, 0], 0.2 * size)
    inner = np.linspace(2.0 * NOSE, 1.0 - 2.0 * NOSE, 9)
    heights = (chebyshev.chebvander(2.0 * inner - 1.0, 3) @ middle @ at.T).T
    line = np.empty((len(size), 4, 2))
    line[..., 0] = start[:, None] + extent[:, None] * np.linspace(0.0, 1.0, 4)
    places = (first[:, None] + size[:, None] * inner - start[:, None]) / extent[:, None]
    for row, s, height, low, high in zip(line, places, heights, *(end[:, 1] for end in ends), strict=True):
        shares = bernstein(s)
        row[[0, 3], 1] = low, high
        row[1:3, 1] = np.linalg.lstsq(shares[:, 1:3], height - shares[:, [0, 3]] @ [low, high], rcond=None)[0]
    t = np.clip((start[:, None] + extent[:, None] * PLACES - first[:, None]) / size[:, None], 0.0, 1.0)
    found = np.einsum("mkj,jc,mc->mk", _half_basis(t), half, at)
    # across the chord the sides stand further apart than along the camber's normal
    return line, np.maximum(found, 1e-4 * extent[:, None]) * camber_tangents(line, PLACES)[..., 0]


def chord_direction(plane: PlanePoints) -> Reals:
    """The law (k,) of the chord's angle [rad]: the principal axis of bands of points, less their trend."""
    angles, places = [], []
    for rows in plane.bands:
        trend = np.stack([np.ones(len(rows)), plane.v[rows]], axis=-1)
        band = plane.points[rows]
        band = band - trend @ np.linalg.lstsq(trend, band, rcond=None)[0]
        axis = np.linalg.eigh(band.T @ band)[1][:, 1]
        angles.append(float(np.arctan(axis[1] / axis[0])) if axis[0] else np.pi / 2.0)
        places.append(float(np.mean(plane.v[rows])))
    law = fitted_law(np.array(angles), np.array(places), min(3, len(places)))
    return np.clip(law, -STEEPEST, STEEPEST)


def furthest_apart(points: Reals) -> Reals:
    """The two (2, 2) of points (n, 2) with the longest distance between them."""
    corners = points[ConvexHull(points).vertices]
    square = np.sum((corners[:, None] - corners) ** 2, axis=-1)
    return corners[list(np.unravel_index(int(np.argmax(square)), square.shape))]


def longest_chord(points: Reals) -> float:
    """Direction [rad], towards larger abscissae, of the longest distance between two of points (n, 2)."""
    x, y = np.diff(furthest_apart(points), axis=0)[0]
    return float(np.arctan2(y, x) if x > 0.0 else np.arctan2(-y, -x))


def _half_basis(t: Reals) -> Reals:
    """Functions of the half thickness (n, 6): round edges, two powers between, and edges with a thickness."""
    s = 1.0 - t
    return np.stack([np.sqrt(t) * s, np.sqrt(s) * t, t * s, t**2 * s, s, t], axis=-1)


def _ridge(matrix: Reals, rhs: Reals, weight: Reals) -> Reals:
    """Weighted least squares (n,), with a weak pull of all coefficients to zero: ordinates count from near there."""
    rows = matrix * weight[:, None]
    normal = rows.T @ rows
    normal[np.diag_indices_from(normal)] += RIDGE**2 * np.sum(weight**2)
    return np.asarray(np.linalg.solve(normal, rows.T @ (rhs * weight)))


LIMITS = {
    "stagger": (-STEEPEST, STEEPEST),
    "metal_angle_in": (-STEEPEST, STEEPEST),
    "metal_angle_out": (-STEEPEST, STEEPEST),
    "tangent_in": (0.05, 0.95),
    "tangent_out": (0.05, 0.95),
    "leading_edge_radius": (1e-3, 0.5),
    "trailing_edge_radius": (1e-3, 0.5),
}
"""limits of a first blade's laws, inside the family's own; angles in radians"""
THINNEST = 1e-3
"""smallest half thickness of a first blade, of the meridional length (design/matching_constants.md)"""


def unified_numbers(slices: Slices, counts: Mapping[str, tuple[int, ...]], scale: Reals | float) -> dict[str, Any]:
    """Angles, tangents, radii and thicknesses of sections, as laws of `counts` control points along chord and span.

    `scale` (m, k) is the meridional length, in extents of the plane, at PLACES of each section.
    """
    line, v = slices.camber, slices.v
    scale = np.broadcast_to(scale, (len(v), len(PLACES)))
    chord, first, last = line[:, 3] - line[:, 0], line[:, 1] - line[:, 0], line[:, 3] - line[:, 2]
    extent = np.maximum(chord[:, 0], 0.02)
    radii = slices.radii / scale[:, [0, -1]].T
    values = {
        "stagger": np.arctan2(chord[:, 1], extent),
        "metal_angle_in": np.arctan2(first[:, 1], np.maximum(first[:, 0], 1e-9)),
        "metal_angle_out": np.arctan2(last[:, 1], np.maximum(last[:, 0], 1e-9)),
        "tangent_in": length(first) / extent,
        "tangent_out": length(last) / extent,
        "leading_edge_radius": radii[0],
        "trailing_edge_radius": radii[1],
    }
    found: dict[str, Any] = {}
    for name, row in values.items():
        law = np.clip(fitted_law(np.clip(row, *LIMITS[name]), v, counts.get(name, (1, 1))[1]), *LIMITS[name])
        found[name] = plain_law(np.degrees(law) if LIMITS[name][0] < 0.0 else law)
    for name in THICKNESSES:
        count, across = counts[name]
        along = fitted_law((slices.half / scale).T, PLACES, count)
        found[name] = tuple(plain_law(np.maximum(fitted_law(row, v, across), THINNEST)) for row in along)
    return found


def fitted_law(values: Reals, v: Reals, count: int) -> Reals:
    """Control points (count, ...) of the law nearest to values (m, ...) at v (m,)."""
    return np.asarray(np.linalg.lstsq(law_basis(count, v), values, rcond=None)[0])
