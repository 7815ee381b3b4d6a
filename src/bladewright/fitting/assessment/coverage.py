"""What a cloud does not show of a blade: where it ends, and edges around which no point lies."""

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.free_parameters import parameters_of_curve
from bladewright.fitting.matching.blade_ends import END_PARAMETERS
from bladewright.fitting.matching.footpoints import Footpoints, Side, footpoints_at
from bladewright.fitting.matching.search import Match
from bladewright.nurbs.basis import Reals

ROW_SPREAD = 1e-4
"""spread of the points at an end, of the chord, from which they stand in no row; and of the cloud's noise
(`ROW_SPREAD_OF_NOISE`): a noisy row is a row."""
ROW_SPREAD_OF_NOISE = 2.0
"""the same, of the cloud's noise: a noisy row is a row all the same."""
GAP_OVER_SPREAD = 2.7
"""mean distance of evenly scattered values times their number, over their deviation by the median."""


def loose_ends(match: Match) -> dict[str, float]:
    """The ends of a blade that no row of points shows, and how far apart the points are there [m].

    Empty for sections, and where the channel is held. The sides of a blade that goes on a little further are the same,
    so that without a row only its outermost points tell where it ends.
    """
    if match.state.shape.exact is None or not any(path.startswith("channel.") for path in match.problem.paths):
        return {}
    chord, walls = match.model.chord, match.ends.walls
    loose = {}
    for name in END_PARAMETERS:
        wall = walls.get(name)
        if not parameters_of_curve(match.design, name) & {*match.problem.paths}:
            continue
        if wall is None:
            loose[name] = chord
        elif wall.spread > max(ROW_SPREAD * chord, ROW_SPREAD_OF_NOISE * match.noise_estimate.noise):
            loose[name] = GAP_OVER_SPREAD * wall.spread / len(wall.places)
    return loose


EDGE_PARAMETERS = {"leading edge": 0.0, "trailing edge": 1.0}
"""u of the two edges"""
SPAN_PARTS = 5
"""parts of the span in each of which both sides are looked at"""
COVERED_SHARE = 0.5
"""share of these parts that must have a point on the edge's arc; below it the edge is uncovered."""
THICKNESS_SAMPLES = 25
"""places along a section among which it is thickest"""


def uncovered_edges(match: Match) -> dict[str, tuple[float, float]]:
    """Rounded edges without a point on their arc: the blade's width where the points end [m], and of its thickest.

    A point on the arc is nearer to its middle than the other side is, which no point before it is.
    """
    if not match.model.rounded:
        return {}
    footpoints, sides = match.state.footpoints, match.state.shape.sides
    uncovered = {}
    for name, end in EDGE_PARAMETERS.items():
        nearest = _nearest(footpoints, match.rows, end)
        if len(nearest) == 0 or not match.problem.cloud_residuals.overhang.looks_at(end):
            continue
        side, u, v = footpoints.side[nearest], footpoints.u[nearest], footpoints.v[nearest]
        near_end, tip, across = (
            _places(sides, *at) for at in ((side, u, v), (side, np.full(len(u), end), v), (1 - side, u, v))
        )
        width = np.sqrt(np.sum((near_end - across) ** 2, axis=-1))
        if np.mean(np.sqrt(np.sum((near_end - tip) ** 2, axis=-1)) <= width) < COVERED_SHARE:
            wide = float(np.median(width))
            uncovered[name] = wide, wide / _thickness(sides, float(np.median(v)))
    return uncovered


def least_thickness(match: Match) -> float:
    """The least over the span of the sections' largest thickness [m]; infinite for families with other edges."""
    if not match.model.rounded:
        return np.inf
    return min(_thickness(match.state.shape.sides, v) for v in (0.1, 0.3, 0.5, 0.7, 0.9))


def _nearest(footpoints: Footpoints, rows: NDArray[np.bool_], end: float) -> NDArray[np.intp]:
    """For each side and part of the span the point that is nearest to an edge."""
    away = np.where(rows, np.abs(footpoints.u - end), np.inf)
    part = np.minimum((SPAN_PARTS * footpoints.v).astype(int), SPAN_PARTS - 1) + SPAN_PARTS * footpoints.side
    found = [np.flatnonzero(part == each)[np.argmin(away[part == each])] for each in np.unique(part)]
    return np.array([each for each in found if np.isfinite(away[each])], dtype=np.intp)


def _thickness(sides: tuple[Side, ...], v: float) -> float:
    u = np.linspace(0.0, 1.0, THICKNESS_SAMPLES)
    upper, lower = (
        _places(sides, np.full(THICKNESS_SAMPLES, side), u, np.full(THICKNESS_SAMPLES, v)) for side in (0, 1)
    )
    return float(np.sqrt(np.max(np.sum((upper - lower) ** 2, axis=-1))))


def _places(sides: tuple[Side, ...], side: NDArray[np.intp], u: Reals, v: Reals) -> Reals:
    none = np.zeros((len(u), np.real(sides[0].control_points).shape[-1]))
    return footpoints_at(none, sides, side, u, v).points
