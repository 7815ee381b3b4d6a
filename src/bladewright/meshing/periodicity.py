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
"""Largest distance of a node from its partner's image, in pitches: nodes are moved to the image itself, so that only
the rounding of the file's digits is left, 1e-15 in the examples of design/meshes.md."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Periodicity:
    """A rotation about the machine axis, or a translation, from `periodic_lower` to `periodic_upper`."""

    angle: float
    """angle of the rotation, right-handed about +x [rad]; zero for a translation"""
    translation: Reals
    """(3,) vector of the translation [m]; zero for a rotation"""
    pitch: float
    """mean distance between partners [m]"""

    def matrix(self, unit: float = 1.0) -> Reals:
        """(4, 4) affine matrix of the motion, with lengths in `unit` metres."""
        matrix = np.eye(4)
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        matrix[1:3, 1:3] = [[cosine, -sine], [sine, cosine]]
        matrix[:3, 3] = self.translation / unit
        return matrix

    def moved(self, points: Reals) -> Reals:
        """Points (..., 3) [m] of the lower boundary, moved onto the upper one."""
        matrix = self.matrix()
        return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def periodicity(faces: Faces) -> Periodicity:
    """The motion between the periodic boundaries of a passage, from their control points.

    Raises MeshError where there are none, or where no rotation or translation takes one to the other.
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
        motion = Periodicity(angle=0.0, translation=steps.mean(axis=0), pitch=pitch)
    else:
        cosine = np.sum(lower[:, 1:] * upper[:, 1:])
        sine = np.sum(lower[:, 1] * upper[:, 2] - lower[:, 2] * upper[:, 1])
        motion = Periodicity(angle=float(np.arctan2(sine, cosine)), translation=np.zeros(3), pitch=pitch)
    error = float(length(motion.moved(lower) - upper).max())
    if error > MISMATCH * pitch:
        raise MeshError(
            f"the periodic boundaries are {error / pitch:.2g} of the pitch off any rotation about x or translation: at "
            f"most {MISMATCH:g} is allowed; build the passage with bladewright.passage"
        )
    return motion


def _poles(faces: Faces, group: str) -> Reals:
    """Control points (n, 3) of the faces of a group."""
    poles = [
        face.control_points.real.reshape(-1, 3)
        for name, face in sorted(faces.items())
        if group_of(name) == group and not isinstance(face, TrimmedSurface)
    ]
    return np.concatenate(poles) if poles else np.zeros((0, 3))


@dataclass(frozen=True, kw_only=True)
class PeriodicMatch:
    """How well the nodes of the two periodic boundaries of a mesh correspond."""

    nodes: int
    """number of pairs"""
    mismatch: float
    """largest distance of a node from its partner's image, in pitches; infinite where a node has no partner"""
    triangles: bool
    """whether the triangles correspond as well"""


def match_periodic(motion: Periodicity, nodes: Reals, lower: np.ndarray, upper: np.ndarray) -> PeriodicMatch:
    """Compare the triangles (k, 3) of the lower boundary with those of the upper one, on nodes (n, 3) [m]."""
    lower_nodes, upper_nodes = np.unique(lower), np.unique(upper)
    distances, place = cKDTree(nodes[upper_nodes]).query(motion.moved(nodes[lower_nodes]))
    paired = len(lower_nodes) == len(upper_nodes) == len(np.unique(place))
    if not paired:
        return PeriodicMatch(nodes=0, mismatch=float("inf"), triangles=False)
    partner = np.zeros(len(nodes), dtype=np.intp)
    partner[lower_nodes] = upper_nodes[place]
    images, others = (np.unique(np.sort(each, axis=1), axis=0) for each in (partner[lower], upper))
    return PeriodicMatch(
        nodes=len(lower_nodes),
        mismatch=float(distances.max()) / motion.pitch,
        triangles=images.shape == others.shape and bool((images == others).all()),
    )
