"""Further knots of a curve or surface where its points are too far off for other reasons than noise."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bladewright.errors import FitError
from bladewright.fitting.freeform.net import Net
from bladewright.fitting.freeform.search import STIFFNESSES, Options, ShapeMatch, matched_by_stages, placed
from bladewright.nurbs.basis import Reals, breaks

KNOT_ROUNDS = 25
"""times that knots are added at most; it bounds the time."""
NOISE_RATIO = 1.25
"""root mean square of a knot span's distances, of the noise, up to which they are noise: three standard errors of the
root mean square of 70 distances (design/freeform.md)"""


def matched_within(net: Net, points: Reals, options: Options, *, warm: bool) -> tuple[ShapeMatch[Net], tuple[str, ...]]:
    """The match within the largest distance that is asked for, and a note why it is not reached."""
    unknowns = int(net.free.sum()) * (points.shape[1] if len(net.knots) == 1 else 1)
    unknowns += len(net.points) - 1 if options.weights_free else 0
    rows = len(np.unique(points, axis=0)) * (points.shape[1] - len(net.knots))
    if unknowns > rows:
        counts = " x ".join(str(count) for count in net.counts)
        raise FitError(
            f"{len(points)} points, which give {rows} distances, were to determine {unknowns} unknowns of {counts} "
            "control points: take fewer control points, fixed weights, or more points"
        )
    match = matched_by_stages(placed(net, points), options, () if warm else STIFFNESSES)
    limit = np.inf if options.tolerance is None else options.tolerance / options.extent
    for _ in range(KNOT_ROUNDS):
        if match.largest <= limit:
            return match, ()
        finer, reason = _finer(match, limit)
        if finer is None:
            reason = reason or f"noise of about {match.noise * options.extent:.3g} stops further knots"
            break
        options.report(f"{len(finer.points)} control points")
        match = matched_by_stages(replace(match, shape=finer, weights=np.ones(len(points))), options, ())
    else:
        reason = f"{KNOT_ROUNDS} rounds of knots do not reach it"
    far = match.largest * options.extent
    return match, (f"the largest distance is {far:.3g} where {options.tolerance:.3g} was asked for: {reason}",)


def _finer(match: ShapeMatch[Net], limit: float) -> tuple[Net | None, str]:
    """The net with a knot in each span that is too far off, or None and the reason where that is not noise.

    Of a surface, along the direction of which each new control point is predicted to gain more.
    """
    net, distances = match.shape, match.distances
    found: list[tuple[float, Net]] = []
    reason = ""
    for direction, own in enumerate(net.knots):
        at = match.parameters[:, direction]
        knots = []
        for low, high in pairwise(breaks(own)):
            rows = match.inliers & (at >= low) & (at <= high)
            if distances[rows].max(initial=0.0) > limit and _above_noise(match, rows):
                knots.append(_middle(at[rows], distances[rows], low, high))
        if not knots:
            continue
        finer = net.refined(knots, direction)
        if 2 * len(finer.points) > len(at):
            reason = "the points are too few for further knots"
            continue
        trial = replace(match, shape=finer)
        step = np.linalg.lstsq(trial.jacobian, trial.residuals, rcond=1e-6)[0]
        gain = float(trial.residuals @ trial.residuals - np.sum((trial.residuals - trial.jacobian @ step) ** 2))
        found.append((gain / (len(finer.points) - len(net.points)), finer))
    return max(found, key=lambda each: each[0])[1] if found else None, reason


def _above_noise(match: ShapeMatch[Net], rows: NDArray[np.bool_]) -> bool:
    return float(np.sqrt(np.mean(match.distances[rows] ** 2) / match.codimension)) > NOISE_RATIO * match.noise


def _middle(at: Reals, distances: Reals, low: float, high: float) -> float:
    """Where half of the squared distances of a span lie on either side, within its middle half."""
    order = np.argsort(at)
    square = np.cumsum(distances[order] ** 2)
    middle = float(at[order][np.searchsorted(square, 0.5 * square[-1])])
    return float(np.clip(middle, 0.75 * low + 0.25 * high, 0.25 * low + 0.75 * high))
