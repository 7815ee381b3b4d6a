"""Further knots of a curve or surface where its points are too far off for other reasons than noise."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.freeform.net import Net
from bladewright.fitting.freeform.search import Options, ShapeMatch, Target, matched_by_stages
from bladewright.nurbs.basis import Reals, breaks

KNOT_ROUNDS = 25
"""times that knots are added at most; it bounds the time."""
NOISE_RATIO = 1.25
"""root mean square of a knot span's distances, of the noise, up to which they are noise: three standard errors of the
root mean square of 70 distances"""
POINTS_FOR_A_CONTROL_POINT = 2
"""points that a control point needs: one more than determines it"""


def matched_within(
    net: Net, target: Target, options: Options, *, warm: bool, near: Reals | None = None
) -> tuple[ShapeMatch[Net], NDArray[np.bool_], tuple[str, ...]]:
    """The match within the largest distance that is asked for, the inliers, and a note why it is not reached.

    Places descend from `near` (m, k) where they are given, and in each round from those of the round before.
    """
    total, reason = 0, ""
    for _ in range(KNOT_ROUNDS):
        match, inliers = matched_by_stages(net, target, options, warm=warm, near=near)
        total += match.evaluations
        largest = float(match.distances.max())
        if options.tolerance is None or largest * options.extent <= options.tolerance:
            return replace(match, evaluations=total), inliers, ()
        finer, reason = _finer(match, options.tolerance / options.extent, options.extent)
        if finer is None:
            break
        net, warm, reason = finer, True, f"{KNOT_ROUNDS} rounds of knots do not reach it"
        near = match.parameters if len(match.parameters) == len(target.points) else None
        options.report(f"{len(net.points)} control points")
    far = f"the largest distance is {largest * options.extent:.3g} where {options.tolerance:.3g} was asked for"
    return replace(match, evaluations=total), inliers, (f"{far}: {reason}",)


def _finer(match: ShapeMatch[Net], limit: float, extent: float) -> tuple[Net | None, str]:
    """The net with a knot in each span that is too far off, or None and the reason.

    Of a surface, along the direction of which each new control point is predicted to gain more.
    """
    net = match.shape
    found: list[tuple[float, Net]] = []
    reason = f"noise of a standard deviation of about {match.noise * extent:.3g} stops further knots"
    for direction, own in enumerate(net.knots):
        at = match.parameters[:, direction]
        spans = [(at >= low) & (at <= high) for low, high in pairwise(breaks(own))]
        knots = [
            _middle(at[rows], match.distances[rows], low, high)
            for rows, (low, high) in zip(spans, pairwise(breaks(own)), strict=True)
            if match.distances[rows].max(initial=0.0) > limit and _above_noise(match, rows)
        ]
        if not knots:
            continue
        finer = net.refined(knots, direction)
        if POINTS_FOR_A_CONTROL_POINT * len(finer.points) > len(at):
            reason = "the points are too few for further knots"
            continue
        trial = replace(match, shape=finer)
        rows = np.asarray(np.linalg.qr(np.column_stack([trial.jacobian, trial.residuals]), mode="r"))
        step = np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=1e-6)[0]
        gain = float(rows[:, -1] @ rows[:, -1] - np.sum((rows[:, -1] - rows[:, :-1] @ step) ** 2))
        found.append((gain / (len(finer.points) - len(net.points)), finer))
    return max(found, key=lambda each: each[0])[1] if found else None, reason


def _above_noise(match: ShapeMatch[Net], rows: NDArray[np.bool_]) -> bool:
    codimension = match.target.points.shape[1] - match.parameters.shape[1]
    return float(np.sqrt(np.mean(match.distances[rows] ** 2) / codimension)) > NOISE_RATIO * match.noise


def _middle(at: Reals, distances: Reals, low: float, high: float) -> float:
    """Where half of the squared distances of a span lie on either side, within its middle half."""
    order = np.argsort(at)
    square = np.cumsum(distances[order] ** 2)
    middle = float(at[order][np.searchsorted(square, 0.5 * square[-1])])
    return float(np.clip(middle, low + 0.25 * (high - low), high - 0.25 * (high - low)))
