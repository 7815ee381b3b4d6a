"""The rigid motion of least true distances from a target, with outliers left out step by step.

It is Gauss and Newton's method on the distances along the target's normals, and past an edge also along the side, with
Tukey's weights (Beaton and Tukey 1974). Their width starts wide and shrinks to what the inliers' own noise needs, as in
graduated non-convexity (Blake and Zisserman 1987), so that the few points at the ends, which alone hold a prismatic
blade along its span, take part before they could be taken for outliers.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.registration.rigid_motion import GENERATORS, composed, rotation_by
from bladewright.fitting.registration.target import Contact, RegistrationTarget
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation, tukey_weights
from bladewright.nurbs.basis import Reals

FIRST_WIDTH = 0.04
"""first width of the weights, of the target's extent."""
WIDTH_FACTOR = 8.0
"""factor by which the width shrinks, and its cube below `FAST_WIDTH`."""
FAST_WIDTH = 1e-3
"""width, of the extent, below which it shrinks three times as fast."""
NEWTON_STEP = 1e-3
"""step, of the extent, below which nearest places are followed by Newton steps instead of searched anew."""
LEAST_WIDTH = 1e-13
"""least width, of the target's extent: rounding."""
SETTLED_STEP = 1e-13
"""step, of the target's extent, that ends the descent: rounding."""
MOST_STEPS = 60
"""steps of a descent at most"""
LONGEST_STEP = 0.2
"""longest step, of the extent"""
WEAKEST_FREEDOM = 1e-5
"""singular value, of the largest, below which the points do not determine a degree of freedom."""


@dataclass(frozen=True, kw_only=True)
class RobustMotion:
    """Where a descent ends."""

    motion: Motion
    contact: Contact
    """contact of the moved points with the target"""
    weights: Reals
    """(n,) of the points in the last step, 0 for outliers"""
    undetermined: tuple[Reals, ...]
    """directions in the space of the degrees of freedom, scaled to lengths, that the points do not determine"""
    covariance: Reals
    """(k, k) of the degrees of freedom, [rad] and [m]"""
    settled: bool
    """whether the last step was below `SETTLED_STEP`"""


def robust_motion(
    target: RegistrationTarget,
    points: Reals,
    motion: Motion,
    *,
    width: float = FIRST_WIDTH,
    steps: int = MOST_STEPS,
) -> RobustMotion:
    """The motion of points (n, d) near `motion` that brings them onto the target."""
    extent = target.extent
    wide, least = width * extent, LEAST_WIDTH * extent
    settled, small = False, np.inf
    contact: Contact | None = None
    for _ in range(steps):
        moved = motion(points)
        contact = target.contact(moved, contact if small < NEWTON_STEP * extent else None)
        distances = contact.distances
        noise_width = TUKEY_WIDTH * median_deviation(distances[distances < wide]) if np.any(distances < wide) else wide
        weights = tukey_weights(distances, max(wide, least))
        pivot = np.mean(moved, axis=0)
        rows, right = equations(moved, contact, weights, pivot)
        step = _step(rows, right, pivot, moved, extent)
        motion = composed(_about(pivot, step), motion)
        small = float(np.max(np.abs(motion(points) - moved)))
        if wide <= max(noise_width, least) * (1.0 + 1e-9) and small < SETTLED_STEP * extent:
            settled = True
            break
        if small < wide / 10.0:
            shrinking = WIDTH_FACTOR if wide > FAST_WIDTH * extent else WIDTH_FACTOR**3
            wide = max(wide / shrinking, min(noise_width, wide), least)
    moved = motion(points)
    contact = target.contact(moved, contact if small < NEWTON_STEP * extent else None)
    weights = tukey_weights(contact.distances, max(wide, least))
    pivot = np.mean(moved, axis=0)
    undetermined, _ = _determined(*equations(moved, contact, weights, pivot), extent)
    _, covariance = _determined(*equations(moved, contact, weights, 0.0 * pivot), extent)
    return RobustMotion(
        motion=motion,
        contact=contact,
        weights=weights,
        undetermined=undetermined,
        covariance=covariance,
        settled=settled,
    )


def equations(moved: Reals, contact: Contact, weights: Reals, pivot: Reals) -> tuple[Reals, Reals]:
    """Weighted rows (m, k) of the effects of turns about a pivot and of shifts on the distances, and right sides."""
    dimension = moved.shape[1]
    past = np.flatnonzero(np.any(contact.beyond != 0.0, axis=1))
    directions = np.concatenate([contact.normals, contact.beyond[past]])
    which = np.concatenate([np.arange(len(moved)), past])
    turns = np.einsum("nd,kde,ne->nk", directions, GENERATORS[dimension], moved[which] - pivot)
    root = np.sqrt(weights[which])
    miss = np.sum(directions * contact.miss[which], axis=1)
    return np.concatenate([turns, directions], axis=1) * root[:, None], -miss * root


def _step(rows: Reals, right: Reals, pivot: Reals, moved: Reals, extent: float) -> Reals:
    """Changes (k,) of the degrees of freedom that the rows determine, by least squares."""
    dimension = moved.shape[1]
    turns = len(GENERATORS[dimension])
    radius = float(np.sqrt(np.max(np.sum((moved - pivot) ** 2, axis=1))))
    scale = np.where(np.arange(rows.shape[1]) < turns, 1.0 / radius, 1.0)
    found = np.linalg.lstsq(rows * scale, right, rcond=WEAKEST_FREEDOM)[0]
    longest = float(np.sqrt(np.max(found**2)))
    shortened = LONGEST_STEP * extent / longest if longest > LONGEST_STEP * extent else 1.0
    return np.asarray(found * scale * shortened)


def _about(pivot: Reals, step: Reals) -> Motion:
    """A turn about a point, then a shift."""
    turns = len(GENERATORS[len(pivot)])
    rotation = rotation_by(step[:turns])
    return Motion(rotation=rotation, translation=pivot - rotation @ pivot + step[turns:])


def _determined(rows: Reals, right: Reals, extent: float) -> tuple[tuple[Reals, ...], NDArray[np.float64]]:
    turns = len(GENERATORS[2 if rows.shape[1] == 3 else 3])
    scale: Reals = np.where(np.arange(rows.shape[1]) < turns, 1.0 / extent, 1.0)
    _, values, across = np.linalg.svd(rows * scale, full_matrices=False)
    weak = values <= WEAKEST_FREEDOM * values[0]
    spread = float(np.sum(right**2)) / max(1, int(np.count_nonzero(right)) - rows.shape[1])
    inverse = np.where(weak, 0.0, 1.0 / np.where(weak, 1.0, values))
    half = scale[:, None] * across.T * inverse
    return tuple(across[weak]), spread * half @ half.T
