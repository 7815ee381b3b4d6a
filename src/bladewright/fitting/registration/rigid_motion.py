"""Rigid motions in the plane and in space, and their degrees of freedom."""

import numpy as np
from scipy.spatial.transform import Rotation

from bladewright.fitting.assessment.result import Motion
from bladewright.nurbs.basis import Reals

FREEDOMS = ("turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z")
"""degrees of freedom in space: right-handed turns about the machine's axes, then shifts along them"""
PLANE_FREEDOMS = ("turn", "shift_x", "shift_y")
"""degrees of freedom in the plane"""
GENERATORS = {
    2: np.array([[[0.0, -1.0], [1.0, 0.0]]]),
    3: np.array(
        [
            [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
            [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]],
            [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        ]
    ),
}
"""(k, d, d) rates of change of the rotation by a turn, in d dimensions"""


def rotation_by(turns: Reals) -> Reals:
    """Rotations (..., d, d) by angles (..., 1) in the plane, or rotation vectors (..., 3) in space [rad]."""
    if turns.shape[-1] == 3:
        return Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix().reshape(*turns.shape[:-1], 3, 3)
    c, s = np.cos(turns[..., 0]), np.sin(turns[..., 0])
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)


def composed(second: Motion, first: Motion) -> Motion:
    """The motion that does `first`, then `second`."""
    return Motion(
        rotation=second.rotation @ first.rotation,
        translation=second.rotation @ first.translation + second.translation,
    )
