"""First axes of revolution from planes on the ends of a blade.

The velocities of a turn about the axis are tangential to the ends, so that the planes' normals are perpendicular to
them (Pottmann and Wallner 2001, section 4). Some planes are not on an end at all, so small draws of them are tried.
"""

import numpy as np

from bladewright.fitting.alignment.pieces import Piece
from bladewright.fitting.alignment.rigid import GENERATORS
from bladewright.fitting.judgement.result import Motion
from bladewright.nurbs.basis import Reals

SHARE = 0.6
"""of the planes that must agree on an axis"""
TRIALS, DRAWN = 400, 7
"""draws of a few planes, and how many each"""
MOST = 10
"""axes that are handed on"""
DISTINCT = 0.996
"""cosine of the angle from which on directions are different"""
FARTHEST = 25.0
"""distance of an axis from the blade, of the ends' extent: further away it is no longer told from none"""


def first_axes(pieces: list[Piece]) -> list[tuple[float, Motion]]:
    """Different axes for the planes of two ends, best first, and the angle [rad] by which the planes miss each."""
    if len(pieces) < 8:
        return []
    at, facing = np.array([each.point for each in pieces]), np.array([each.normal for each in pieces])
    pivot, size = at.mean(axis=0), float(np.ptp(at, axis=0).max())
    at = (at - pivot) / size
    starts = _starts(at, facing)
    starts.sort(key=lambda each: each[0])
    chosen: list[tuple[float, Reals, Reals]] = []
    for each in starts:
        if all(abs(each[1] @ other[1]) < DISTINCT for other in chosen):
            chosen.append(each)
        if len(chosen) == MOST:
            break
    return [(miss, _into_axis(direction, pivot + size * foot)) for miss, direction, foot in chosen]


def _miss(direction: Reals, foot: Reals, at: Reals, facing: Reals) -> float:
    """Angle [rad] that the better share of the planes keeps."""
    return float(np.quantile(np.abs(_angles(direction, foot, at, facing)), SHARE))


def _angles(direction: Reals, foot: Reals, at: Reals, facing: Reals) -> Reals:
    """Angles (n,) between planes and the circles around an axis [rad]."""
    speed = np.cross(direction, at - foot)
    return np.sum(facing * speed, axis=1) / np.sqrt(np.sum(speed**2, axis=1) + 1e-12)


def _starts(at: Reals, facing: Reals) -> list[tuple[float, Reals, Reals]]:
    """Misses, directions and feet of axes through a few planes each, drawn at random, and through all.

    A velocity field c' + c x p of least (n . v)^2 over v^2 belongs to the smallest generalised eigenvalues of 6 x 6
    matrices; of a cylinder two are zero, as it also slides along itself.
    """
    count = len(at)
    moment = np.concatenate([np.cross(at, facing), facing], axis=1)
    normal = np.einsum("ni,nj->nij", moment, moment)
    spin = np.concatenate(
        [-np.einsum("kde,ne->ndk", -GENERATORS[3], at), np.broadcast_to(np.eye(3), (count, 3, 3))], axis=2
    )
    speed = np.einsum("ndi,ndj->nij", spin, spin)
    random = np.random.default_rng(0)
    subsets = [np.arange(count)] + [random.choice(count, DRAWN, replace=False) for _ in range(TRIALS)]
    starts = []
    for subset in subsets:
        below = speed[subset].mean(axis=0) + 1e-9 * np.eye(6)
        half = np.linalg.inv(np.linalg.cholesky(below))
        vectors = half.T @ np.linalg.eigh(half @ normal[subset].mean(axis=0) @ half.T)[1][:, :3]
        for field in vectors.T:
            size = np.sqrt(field[:3] @ field[:3])
            if not size > 1e-6:
                continue
            direction = field[:3] / size
            foot = np.cross(direction, field[3:] / size)
            if foot @ foot < FARTHEST**2:
                starts.append((_miss(direction, foot, at, facing), direction, foot))
    return starts


def _into_axis(direction: Reals, foot: Reals) -> Motion:
    """A motion that brings a line onto the x axis."""
    other = np.eye(3)[np.argmin(np.abs(direction))]
    second = np.cross(direction, other)
    second /= np.sqrt(np.sum(second**2))
    rotation = np.stack([direction, second, np.cross(direction, second)])
    return Motion(rotation=rotation, translation=-rotation @ foot)
