"""Planes on the ends of a blade's cloud, piece by piece, and first axes of revolution from them.

The velocities of a turn about the axis are tangential to the ends, so that the planes' normals are perpendicular to
them (Pottmann and Wallner 2001, section 4). Some planes are not on an end at all, so small draws of them are tried.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.registration.isomap import UnrolledSheet
from bladewright.fitting.registration.rigid_motion import GENERATORS
from bladewright.fitting.registration.robust_motion import tukey_weights
from bladewright.nurbs.basis import Reals

END_PIECES = 20
"""pieces of an end"""
LOOKED_INSIDE = 2.5
"""depth up to which points inside the side are looked at, of the points' spacing"""
FIRST_WIDTH, LAST_WIDTH, NARROWINGS = 1.5, 0.03, 24
"""first and last (`LAST_WIDTH`) width of the weights, of the points' spacing, and how often they narrow
(`NARROWINGS`)"""
ON_PLANE = 0.1
"""distance, of the points' spacing, within which points lie on the plane."""
TILT_DAMPING = 1e-3
"""weight that holds the tilt across a loop that is thin for its points' spacing"""


@dataclass(frozen=True, kw_only=True)
class EndPlane:
    """The plane on a short piece of an end."""

    point: Reals
    """(3,) mean of the points on the plane"""
    normal: Reals
    """(3,) unit normal of the plane"""
    rows: NDArray[np.intp]
    """indices of the sheet's points on the plane"""
    along: Reals
    """(m,) their places along the side, 0 to 1"""


def end_planes(sheet: UnrolledSheet, side: int) -> list[EndPlane]:
    """Planes on the pieces of a side of the sheet.

    The weights are one-sided, 1 outside and Tukey's inside, and narrow: the plane moves out to the last points.
    """
    along, inside = sheet.along(side)
    found = []
    for place in (np.arange(END_PIECES) + 0.5) / END_PIECES:
        rows = np.flatnonzero(
            (np.abs(along - place) < 0.7 / END_PIECES) & (np.abs(inside) < LOOKED_INSIDE * sheet.spacing)
        )
        if len(rows) >= 12:
            piece = _end_plane(sheet, rows, along[rows], inside[rows])
            if piece is not None:
                found.append(piece)
    return found


def _end_plane(sheet: UnrolledSheet, rows: NDArray[np.intp], along: Reals, inside: Reals) -> EndPlane | None:
    points, spacing = sheet.points[rows], sheet.spacing
    local = points - points.mean(axis=0)
    inward = np.linalg.lstsq(local, inside - inside.mean(), rcond=1e-3)[0]
    size = np.sqrt(np.sum(inward**2))
    if not size > 0.0:
        return None
    frame = np.linalg.svd((inward / size)[None])[2]
    frame[0] = inward / size
    height, across = local @ frame[0], local @ frame[1:].T
    plane = np.array([float(np.quantile(height, 0.05)), 0.0, 0.0])
    design = np.concatenate([np.ones((len(height), 1)), across], axis=1)
    damping = np.diag([0.0, 1.0, 1.0]) * TILT_DAMPING * spacing**2 * len(height)
    for width in spacing * np.geomspace(FIRST_WIDTH, LAST_WIDTH, NARROWINGS):
        residuals = height - design @ plane
        weight = np.where(residuals < 0.0, 1.0, tukey_weights(np.abs(residuals), width))
        plane = np.linalg.solve((design.T * weight) @ design + damping, (design.T * weight) @ height)
    residuals = height - design @ plane
    on_plane = np.abs(residuals) < ON_PLANE * spacing
    if np.count_nonzero(on_plane) < 4:
        return None
    normal = frame[0] - plane[1] * frame[1] - plane[2] * frame[2]
    return EndPlane(
        point=points[on_plane].mean(axis=0),
        normal=normal / np.sqrt(np.sum(normal**2)),
        rows=rows[on_plane],
        along=along[on_plane],
    )


AGREEING_SHARE = 0.6
"""share of the planes that must agree on an axis"""
TRIALS, PLANES_DRAWN = 400, 7
"""draws of a few planes, and how many planes each has (`PLANES_DRAWN`)"""
MOST_AXES = 10
"""axes that are handed on"""
DISTINCT_COSINE = 0.996
"""cosine of the angle from which directions count as different."""
FARTHEST_AXIS = 25.0
"""distance of an axis from the blade, of the ends' extent, beyond which it cannot be told from a translation."""


def first_axes(pieces: list[EndPlane]) -> list[tuple[float, Motion]]:
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
        if all(abs(each[1] @ other[1]) < DISTINCT_COSINE for other in chosen):
            chosen.append(each)
        if len(chosen) == MOST_AXES:
            break
    return [(miss, _into_axis(direction, pivot + size * footpoint)) for miss, direction, footpoint in chosen]


def _miss(direction: Reals, footpoint: Reals, at: Reals, facing: Reals) -> float:
    """Angle [rad] that the agreeing share of the planes keeps."""
    return float(np.quantile(np.abs(_angles(direction, footpoint, at, facing)), AGREEING_SHARE))


def _angles(direction: Reals, footpoint: Reals, at: Reals, facing: Reals) -> Reals:
    """Angles (n,) between planes and the circles around an axis [rad]."""
    speed = np.cross(direction, at - footpoint)
    return np.sum(facing * speed, axis=1) / np.sqrt(np.sum(speed**2, axis=1) + 1e-12)


def _starts(at: Reals, facing: Reals) -> list[tuple[float, Reals, Reals]]:
    """Misses, directions and footpoints of axes through a few planes each, drawn at random, and through all.

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
    subsets = [np.arange(count)] + [random.choice(count, PLANES_DRAWN, replace=False) for _ in range(TRIALS)]
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
            footpoint = np.cross(direction, field[3:] / size)
            if footpoint @ footpoint < FARTHEST_AXIS**2:
                starts.append((_miss(direction, footpoint, at, facing), direction, footpoint))
    return starts


def _into_axis(direction: Reals, footpoint: Reals) -> Motion:
    """A motion that brings a line onto the x axis."""
    other = np.eye(3)[np.argmin(np.abs(direction))]
    second = np.cross(direction, other)
    second /= np.sqrt(np.sum(second**2))
    rotation = np.stack([direction, second, np.cross(direction, second)])
    return Motion(rotation=rotation, translation=-rotation @ footpoint)
