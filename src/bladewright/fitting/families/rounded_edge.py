"""The edge of a section by suction and pressure side that lies nearest to the end of a section's samples."""

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
    EdgePoints,
    characteristic_points,
    opening,
)

CORNER_MISS, DIRECTION_MISS = 0.1, np.radians(5.0)
"""what a miss of a corner, of the edge's radius, and of its side's direction there count"""
CURVATURE_SPREAD, STRETCH_SPREAD, SKEW_SPREAD = 0.5, 0.4, 0.3
"""spread of the logarithms of the nose's curvature and of the stretch, and of the skewness"""
WEDGE_SPREAD, DIRECTION_SPREAD = np.radians(4.0), np.radians(15.0)
"""spread of the wedge angle about the one wanted, and of the edge's direction about the normal of the nose"""
LARGEST_OPENING = 0.95
"""part of the largest opening that a first edge has"""
LOWEST, HIGHEST = (-1.5, np.log(4e-4), np.log(0.2), -0.8, 0.0), (1.5, np.log(0.2), np.log(6.0), 0.8, 1.5)
"""bounds of the angle, the logarithms of radius and stretch, the skewness and the wedge angle"""


@dataclass(frozen=True, kw_only=True)
class RoundedEdge:
    """An edge's numbers, of the chord and from the chord line."""

    angle: float
    """of the edge's direction [rad]"""
    radius: float
    stretch: float
    skew: float
    """positive where the edge is longer on the upper side"""
    wedge: float
    """[rad]"""


def edge_through(section: SampledSection, end: int, wedge: float, continuity: Continuity) -> RoundedEdge:
    """The leading (0) or trailing (1) edge about so wide [rad] whose corners lie on the sides and leave along them."""
    nose = np.array([float(end), 0.0])
    sides = [side if end == 0 else side[::-1] for side in (section.upper, section.lower)]
    radius = float(np.clip(section.radii[end], 8e-4, 0.15))
    angle = _normal_angle(sides, 0.5 * radius)
    first = np.array([angle, np.log(radius), 0.0, 0.0, wedge])

    def misses(unknowns: Reals) -> Reals:
        at = _points(unknowns, nose, end, continuity)
        rows = []
        for side, corner in zip(sides, (at.upper, at.lower), strict=True):
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


def _points(unknowns: Reals, nose: Reals, end: int, continuity: Continuity) -> EdgePoints:
    return characteristic_points(
        nose,
        np.asarray(unknowns[0]),
        inward=1.0 if end == 0 else -1.0,
        radius=np.exp(unknowns[1]),
        stretch=np.exp(unknowns[2]),
        skew=np.asarray(unknowns[3]),
        wedge=np.asarray(unknowns[4]),
        continuity=continuity,
    )


def _normal_angle(sides: list[Reals], beside: float) -> float:
    """The angle of the normal of the line between the sides, so far behind the nose along them."""
    across = _point_along(sides[0], beside) - _point_along(sides[1], beside)
    return float(np.clip(np.arctan2(-across[0], across[1]), -1.4, 1.4))


def _point_along(side: Reals, way: float) -> Reals:
    """The point of a side (n, 2) so far along it."""
    steps = cumulative_length(side)
    return np.array([np.interp(way, steps, side[:, i]) for i in (0, 1)])
