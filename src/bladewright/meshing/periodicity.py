"""The motion that takes one periodic boundary onto the other, and how well the nodes of a mesh follow it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from bladewright.blade.native.blade import Faces
from bladewright.errors import MeshError
from bladewright.meshing.names import group_of
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.trimmed import TrimmedSurface

MISMATCH = 1e-9
"""of the pitch: how far a node may lie off the motion of its partner"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Periodicity:
    """A rotation about the machine axis, or a translation, from `periodic_lower` to `periodic_upper`."""

    angle: float
    """right-handed about +x [rad]; zero for a translation"""
    translation: Reals
    """(3,) [m]"""
    pitch: float
    """mean distance of partners [m]"""

    def matrix(self, unit: float = 1.0) -> Reals:
        """(4, 4) affine matrix of the motion, with lengths in `unit` metres."""
        made = np.eye(4)
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        made[1:3, 1:3] = [[cosine, -sine], [sine, cosine]]
        made[:3, 3] = self.translation / unit
        return made

    def moved(self, points: Reals) -> Reals:
        """Points (..., 3) [m] of the lower boundary, moved onto the upper one."""
        made = self.matrix()
        return np.asarray(points @ made[:3, :3].T + made[:3, 3])


def periodicity(faces: Faces) -> Periodicity:
    """The motion between the periodic boundaries of a passage, from their control points.

    Raises MeshError where there are none, or where they are no motion of each other.
    """
    lower, upper = (_poles(faces, name) for name in ("periodic_lower", "periodic_upper"))
    if lower.shape != upper.shape or len(lower) == 0:
        raise MeshError(
            f"the periodic boundaries have {len(lower)} and {len(upper)} control points: a passage with equal "
            "boundaries 'periodic_lower' and 'periodic_upper' is needed; build it with bladewright.passage"
        )
    steps = upper - lower
    pitch = float(length(steps).mean())
    if np.ptp(steps, axis=0).max() <= MISMATCH * pitch:
        found = Periodicity(angle=0.0, translation=steps.mean(axis=0), pitch=pitch)
    else:
        cosine = np.sum(lower[:, 1:] * upper[:, 1:])
        sine = np.sum(lower[:, 1] * upper[:, 2] - lower[:, 2] * upper[:, 1])
        found = Periodicity(angle=float(np.arctan2(sine, cosine)), translation=np.zeros(3), pitch=pitch)
    off = float(length(found.moved(lower) - upper).max())
    if off > MISMATCH * pitch:
        raise MeshError(
            f"the periodic boundaries are {off / pitch:.2g} of the pitch off any rotation about x or translation: at "
            f"most {MISMATCH:g} is allowed; build the passage with bladewright.passage"
        )
    return found


def _poles(faces: Faces, group: str) -> Reals:
    found = [
        face.control_points.real.reshape(-1, 3)
        for name, face in sorted(faces.items())
        if group_of(name) == group and not isinstance(face, TrimmedSurface)
    ]
    return np.concatenate(found) if found else np.zeros((0, 3))


@dataclass(frozen=True, kw_only=True)
class PeriodicMatch:
    """How the nodes of the periodic boundaries of a mesh are each other's partners."""

    nodes: int
    """pairs"""
    mismatch: float
    """largest distance of a node from its partner's image, of the pitch; infinite where some have no partner"""
    triangles: bool
    """whether the triangles are partners too"""


def match_periodic(motion: Periodicity, nodes: Reals, lower: np.ndarray, upper: np.ndarray) -> PeriodicMatch:
    """How triangles (k, 3) of the lower boundary meet those of the upper one; nodes (n, 3) [m] in common."""
    below, above = np.unique(lower), np.unique(upper)
    distances, place = cKDTree(nodes[above]).query(motion.moved(nodes[below]))
    paired = len(below) == len(above) == len(np.unique(place))
    if not paired:
        return PeriodicMatch(nodes=0, mismatch=float("inf"), triangles=False)
    partner = np.zeros(len(nodes), dtype=np.intp)
    partner[below] = above[place]
    images, others = (np.unique(np.sort(each, axis=1), axis=0) for each in (partner[lower], upper))
    return PeriodicMatch(
        nodes=len(below),
        mismatch=float(distances.max()) / motion.pitch,
        triangles=images.shape == others.shape and bool((images == others).all()),
    )
