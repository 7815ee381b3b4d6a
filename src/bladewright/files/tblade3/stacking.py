"""The stacking points of T-Blade3's sections."""

import numpy as np

from bladewright.files.tblade3.case import CaseStacking, TBlade3Case
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.edge_spline import SplinedOutline
from bladewright.section.laws import Span
from bladewright.section.outline import Outline

POINTS_PER_SIDE = 121
"""Points that T-Blade3 writes for each side of a section, both ends included."""
POLYGON_STATIONS = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 2001))) / 2.0
"""Parameters along the sides of the polygon whose centroid stands for that of the exact section; it is exact to 1e-7
chords."""
REFINEMENTS = 8
"""Times that an interval is divided into 64 parts in search of an abscissa: 64^-8 is below rounding."""


def chord_stations(case: TBlade3Case) -> Reals | None:
    """The chord fractions (121,) at which T-Blade3 computes a section's sides; None for other clusterings.

    They are uniform, or have steps in proportion to sin^p(pi i / 121), i = 1 to 120.
    """
    if case.leading_edge == "spline":
        return None
    if case.clustering == "uniform":
        return np.linspace(0.0, 1.0, POINTS_PER_SIDE)
    if case.clustering == "sine" and case.clustering_parameter is not None:
        steps = np.sin(np.pi * np.arange(1, POINTS_PER_SIDE) / POINTS_PER_SIDE) ** case.clustering_parameter
        return np.append(0.0, np.minimum(np.cumsum(steps) / np.sum(steps), 1.0))
    return None


def stacking_point(part: CurvatureMeanline, stacking: CaseStacking, stations: Reals | None = None) -> Reals:
    """The stacking point (2,) of a section in chords, from the leading edge, along and across the chord line.

    It is the centroid of the area; or a fraction of the chord along, and across either the chord line itself or a
    fraction of the way from the mean of both sides to one of them. With `stations` (k,) the section is the polygon for
    which T-Blade3 takes it, else it is exact. Where the leading edge is a spline, the chord line is that of the section
    without it, as in T-Blade3. `part` holds numbers, not laws.
    """
    sides = _Sides(part)
    polygons = None
    if stations is not None and (stacking.centroid or stacking.above):
        outline = part.unsplined(Span(np.zeros(1)))
        polygons = tuple(np.real(side)[0] for side in outline.at(stations, outline.half_at(stations)))
    if stacking.centroid:
        return _exact_centroid(*sides(POLYGON_STATIONS)) if polygons is None else _polygon_centroid(*polygons)
    along = float(sides(np.ones(1))[0][0, 0]) * stacking.along
    if stacking.above == 0.0:
        return np.array([along, 0.0])
    if polygons is None:
        upper, lower = (_ordinate(sides, along, side) for side in (0, 1))
    else:
        upper, lower = (_on_polygon(side, along) for side in polygons)
    middle = 0.5 * (upper + lower)
    distance = abs((upper if stacking.above > 0.0 else lower) - middle)
    return np.array([along, middle + stacking.above * distance])


class _Sides:
    """Points (k, 2) of a section's sides, in chords of the section without its leading edge spline."""

    def __init__(self, part: CurvatureMeanline) -> None:
        self._outline = part.outline(Span(np.zeros(1)))

    def __call__(self, s: Reals) -> tuple[Reals, Reals]:
        upper, lower = (unturned(self._outline, np.real(side)[0]) for side in self._outline.points(s))
        return upper, lower


def unturned(outline: Outline, points: Reals) -> Reals:
    """Points (k, 2) in chords of a section without its leading edge spline, from those in chords of the section."""
    if not isinstance(outline, SplinedOutline):
        return points
    tip = np.real(outline.tip)[0]
    along, up = np.array([1.0, 0.0]) - tip
    x, y = points.T
    return tip + np.stack([x * along - y * up, x * up + y * along], axis=-1)


def _ordinate(sides: "_Sides", along: float, side: int) -> float:
    """Ordinate of a side where its abscissa first reaches a value, or at the nearer end."""
    s = np.linspace(0.0, 1.0, 513)
    x = sides(s)[side][:, 0]
    past = np.flatnonzero((x[:-1] <= along) & (along <= x[1:]))
    if len(past) == 0:
        at = 0.0 if along <= x[0] else 1.0
        return float(sides(np.array([at]))[side][0, 1])
    low, high = s[past[0]], s[past[0] + 1]
    for _ in range(REFINEMENTS):
        between = np.linspace(low, high, 65)
        first = int(np.argmax(sides(between)[side][:, 0] > along))
        low, high = (between[first - 1], between[first]) if first else (between[-2], between[-1])
    return float(sides(np.array([0.5 * (low + high)]))[side][0, 1])


def _on_polygon(side: Reals, along: float) -> float:
    """Ordinate of a polygon (k, 2) where it first reaches an abscissa, or of its first segment extended."""
    x = side[:, 0]
    past = np.flatnonzero((x[:-1] <= along) & (along <= x[1:]))
    i = int(past[0]) if len(past) else 0
    share = (along - x[i]) / (x[i + 1] - x[i])
    return float(side[i, 1] + share * (side[i + 1, 1] - side[i, 1]))


def _polygon_centroid(upper: Reals, lower: Reals) -> Reals:
    """The centroid as T-Blade3 computes it, by the midpoints of a polygon's edges: sums of x y dx and y y dx / 2."""
    around = np.concatenate([upper[::-1], lower[1:]])
    following = np.roll(around, -1, axis=0)
    x, y = (0.5 * (around + following)).T
    areas = y * (around - following)[:, 0]
    found: Reals = np.array([np.sum(x * areas), 0.5 * np.sum(y * areas)]) / np.sum(areas)
    return found


def _exact_centroid(upper: Reals, lower: Reals) -> Reals:
    """The exact centroid of a fine polygon."""
    around = np.concatenate([upper, lower[::-1]])
    following = np.roll(around, -1, axis=0)
    areas = cross2(around, following)
    found: Reals = np.sum((around + following) * areas[:, None], axis=0) / (3.0 * np.sum(areas))
    return found
