"""The edge of a section by suction and pressure side that is nearest to the end of a section's samples."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from bladewright.fitting.families.polyline import nearest_on
from bladewright.fitting.families.section_samples import SampledSection
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals
from bladewright.section.suction_pressure.edges import (
    MAX_OPENING,
    Continuity,
    Corners,
    characteristic_points,
    opening,
)

CORNER_MISS, DIRECTION_MISS = 0.1, np.radians(5.0)
"""miss of a corner, of the edge's radius, that counts 1 in the least squares, and error of its side's direction there
(`DIRECTION_MISS`) [rad]."""
CURVATURE_SPREAD, STRETCH_SPREAD, SKEW_SPREAD = 0.5, 0.4, 0.3
"""spread of the logarithm of the edge's curvature, of that of its stretch (`STRETCH_SPREAD`) and of its skewness
(`SKEW_SPREAD`); they hold what the corners leave open."""
WEDGE_SPREAD, DIRECTION_SPREAD = np.radians(4.0), np.radians(15.0)
"""spread of the wedge angle about the one asked for, and of the edge's direction about the normal of its end
(`DIRECTION_SPREAD`) [rad]."""
LARGEST_OPENING = 0.95
"""share of the largest opening that a first edge may have, so that a search can change it both ways."""
LOWEST, HIGHEST = (-1.5, np.log(4e-4), np.log(0.2), -0.8, 0.0), (1.5, np.log(0.2), np.log(6.0), 0.8, 1.5)
"""bounds of the direction [rad], the logarithms of radius and stretch, the skewness and the wedge angle [rad]"""


@dataclass(frozen=True, kw_only=True)
class RoundedEdge:
    """An edge's numbers, of the chord and relative to the chord line."""

    angle: float
    """direction of the edge from the chord line [rad]"""
    radius: float
    """radius of curvature at the edge, of the chord"""
    stretch: float
    """of the edge's ellipses along its direction; 1 is a circle"""
    skew: float
    """positive where the edge is longer on the upper side"""
    wedge: float
    """angle between the sides where they leave the edge [rad]"""


def edge_through(section: SampledSection, end: int, wedge: float, continuity: Continuity) -> RoundedEdge:
    """The leading (0) or trailing (1) edge of about this wedge angle [rad] whose sides are tangent to the section."""
    tip = np.array([float(end), 0.0])
    sides = [side if end == 0 else side[::-1] for side in (section.upper, section.lower)]
    radius = float(np.clip(section.radii[end], 8e-4, 0.15))
    angle = _normal_angle(sides, 0.5 * radius)
    first = np.array([angle, np.log(radius), 0.0, 0.0, wedge])

    def misses(unknowns: Reals) -> Reals:
        at = _points(unknowns, tip, end, continuity)
        rows = []
        for side, corner in zip(sides, (at["upper"], at["lower"]), strict=True):
            on = nearest_on(side, corner.point[None])
            along = on.tangents[0]
            turn = along[0] * corner.direction[1] - along[1] * corner.direction[0]
            rows += [on.heights[0] / (CORNER_MISS * radius), turn / DIRECTION_MISS]
        stretch, skew, wide = np.exp(unknowns[2]), unknowns[3], unknowns[4]
        longest = float(opening(stretch * (1.0 + np.sqrt(skew**2)), wide))
        return np.array(
            [
                *rows,
                (unknowns[2] + np.log(radius) - unknowns[1]) / CURVATURE_SPREAD,
                unknowns[2] / STRETCH_SPREAD,
                skew / SKEW_SPREAD,
                (wide - wedge) / WEDGE_SPREAD,
                (unknowns[0] - angle) / DIRECTION_SPREAD,
                max(0.0, longest - LARGEST_OPENING * MAX_OPENING[continuity]) / 0.01,
            ]
        )

    low, high = np.array(LOWEST), np.array(HIGHEST)
    found = least_squares(misses, np.clip(first, low + 1e-6, high - 1e-6), bounds=(low, high), max_nfev=60).x
    return RoundedEdge(
        angle=float(found[0]),
        radius=float(np.exp(found[1])),
        stretch=float(np.exp(found[2])),
        skew=float(found[3]),
        wedge=float(found[4]),
    )


def _points(unknowns: Reals, tip: Reals, end: int, continuity: Continuity) -> Corners:
    return characteristic_points(
        tip,
        np.asarray(unknowns[0]),
        inward=1.0 if end == 0 else -1.0,
        radius=np.exp(unknowns[1]),
        stretch=np.exp(unknowns[2]),
        skew=np.asarray(unknowns[3]),
        wedge=np.asarray(unknowns[4]),
        continuity=continuity,
    )


def _normal_angle(sides: list[Reals], beside: float) -> float:
    """The direction of the edge: normal to the line between the sides at this distance along them."""
    across = _point_along(sides[0], beside) - _point_along(sides[1], beside)
    return float(np.clip(np.arctan2(-across[0], across[1]), -1.4, 1.4))


def _point_along(side: Reals, way: float) -> Reals:
    """The point of a side (n, 2) at this distance along it."""
    steps = cumulative_length(side)
    return np.array([np.interp(way, steps, side[:, i]) for i in (0, 1)])
