"""The motion that brings a cloud from anywhere onto the blade or section of a design."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from bladewright.errors import FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.registration.global_search import TARGET_SAMPLES, found_motions
from bladewright.fitting.registration.rigid_motion import FREEDOMS, PLANE_FREEDOMS
from bladewright.fitting.registration.robust_motion import RobustMotion, robust_motion
from bladewright.fitting.registration.target import RegistrationTarget, target_of
from bladewright.nurbs.basis import Reals

if TYPE_CHECKING:
    from bladewright.blade.design.unified import UnifiedBlade
    from bladewright.section.unified import UnifiedSection

DECIDING_POINTS = 3_000
"""points whose true distances decide"""
SEARCH_POINTS = 600
"""points whose true distances choose among the motions of the global search"""
ALL_TURNS_DISTANCE = 2e-3
"""systematic distance, of the chord, above which all turns are tried."""
OTHER_BLADE_DISTANCE = 5e-3
"""systematic distance, of the chord, above which the cloud is of another blade."""
FINAL_WIDTH = 0.01
"""first width of the weights in the last descent, of the extent"""
TRIAL_STEPS = 8
"""steps of the descent that chooses"""
LEAST_SHARE = 0.7
"""share of the points that must take part; with fewer the cloud is of another blade."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Registration:
    """A motion that brings a cloud onto a blade or section, and how well it lies there."""

    motion: Motion
    rms: float
    """root mean square of the true distances of the points that took part [m]"""
    systematic: float
    """part of it that neighbouring points have in common, which is not noise [m]"""
    share: float
    """share of the points that took part; the others are outliers"""
    undetermined: tuple[str, ...]
    """degrees of freedom that the points do not determine"""
    covariance: Reals
    """(k, k) of the degrees of freedom, turns about the origin of the machine's axes [rad], then shifts [m]"""
    same: bool
    """whether it may be this blade, by the systematic distance and the outliers"""
    notes: tuple[str, ...]
    """what else there is to know, each a sentence"""


def registration(points: Reals, design: "UnifiedBlade | UnifiedSection") -> Registration:
    """The motion of points (n, d) [m] that lie anywhere onto what a design builds, found without a guess.

    The search starts from all proper choices of principal axes and, where none leads to small distances, from turns all
    over; then true distances are minimised with Tukey's weights (see `robust_motion`). Raises FitError where the points
    do not have the dimension of the design, or are too few.
    """
    return registered(points, target_of(design.build()))


def registered(points: Reals, target: RegistrationTarget) -> Registration:
    """As `registration`, onto a target."""
    cloud = _checked(points, target)
    samples, normals = target.evenly(TARGET_SAMPLES[cloud.shape[1]])
    few = cloud[random_subset(len(cloud), SEARCH_POINTS)]
    best: tuple[float, RobustMotion] | None = None
    for everywhere in (False, True):
        for motion in found_motions(cloud, samples, normals, everywhere=everywhere):
            descent = robust_motion(target, few, motion, steps=TRIAL_STEPS)
            score = float(np.mean(np.minimum(descent.contact.distances, 0.02 * target.extent)))
            if best is None or score < best[0]:
                best = score, descent
            if _is_good(few, best[1], target):
                break
        if best is not None and _is_good(few, best[1], target):
            break
    if best is None:
        raise FitError(f"no motion of the {len(points)} points was found; are they of a blade?")
    some = cloud[random_subset(len(cloud), DECIDING_POINTS)]
    return _reported(cloud, target, robust_motion(target, some, best[1].motion, width=FINAL_WIDTH))


def _checked(points: Reals, target: RegistrationTarget) -> Reals:
    cloud = np.asarray(points, dtype=np.float64)
    dimension = target.sides[0].control_points.shape[-1]
    if cloud.ndim != 2 or cloud.shape[1] != dimension:
        raise FitError(
            f"a cloud of shape {cloud.shape} was given for a design in {dimension} dimensions; give (n, {dimension})"
        )
    cloud = cloud[np.isfinite(cloud).all(axis=1)]
    if len(cloud) < 12:
        raise FitError(f"{len(cloud)} points were given: at least 12 are needed to find where they lie")
    return cloud


def _reported(cloud: Reals, target: RegistrationTarget, descent: RobustMotion) -> Registration:
    """The registration of a descent, with its figures and notes."""
    dimension = cloud.shape[1]
    cloud = cloud[random_subset(len(cloud), DECIDING_POINTS)]
    distances, taking = descent.contact.distances, descent.weights > 0.0
    rms = float(np.sqrt(np.mean(distances[taking] ** 2))) if taking.any() else float("inf")
    systematic, share = _systematic(cloud, descent), _share(descent)
    known = FREEDOMS if dimension == 3 else PLANE_FREEDOMS
    weak = tuple(
        name for k, name in enumerate(known) if any(abs(direction[k]) > 0.1 for direction in descent.undetermined)
    )
    same = systematic <= OTHER_BLADE_DISTANCE * target.chord and share >= LEAST_SHARE
    notes = []
    if weak:
        notes.append(f"the points do not determine {', '.join(weak)} of the motion: they stay where the search ended")
    if not same:
        notes.append(
            f"the cloud does not lie on the design's blade: {1.0 - share:.0%} of its points are away from it, the "
            f"others miss it systematically by {systematic:.3g} m, {systematic / target.chord:.2%} of its chord; it is "
            "another blade, a mirrored one, or in another unit"
        )
    if not descent.settled:
        notes.append("the motion did not settle")
    return Registration(
        motion=descent.motion,
        rms=rms,
        systematic=systematic,
        share=share,
        undetermined=weak,
        covariance=descent.covariance,
        same=same,
        notes=tuple(notes),
    )


def _is_good(points: Reals, descent: RobustMotion, target: RegistrationTarget) -> bool:
    return _systematic(points, descent) < ALL_TURNS_DISTANCE * target.chord and _share(descent) > LEAST_SHARE


def _share(descent: RobustMotion) -> float:
    return float(np.mean(descent.weights > 0.0))


def _systematic(points: Reals, descent: RobustMotion) -> float:
    """Root of the mean product of neighbours' signed distances [m]; of pure noise it is about 0.

    Only the nearest nine tenths of the points count, so that outliers have no part in it; a shape that fits only in
    places does not pass.
    """
    distances = descent.contact.distances
    taking = np.flatnonzero(distances <= np.quantile(distances, 0.9))
    if len(taking) < 3:
        return float("inf")
    heights = np.sum(descent.contact.normals * descent.contact.miss, axis=1)[taking]
    other = cKDTree(points[taking]).query(points[taking], k=3)[1][:, 1:]
    return float(np.sqrt(max(0.0, float(np.mean(heights[:, None] * heights[other])))))
