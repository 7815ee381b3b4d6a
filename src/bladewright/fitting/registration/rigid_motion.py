"""Rigid motions in the plane and in space, and their degrees of freedom."""

import numpy as np
from scipy.spatial.transform import Rotation

from bladewright.fitting.assessment.result import Motion
from bladewright.nurbs.basis import Reals

FREEDOMS = {
    2: ("turn", "shift_x", "shift_y"),
    3: ("turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z"),
}
"""degrees of freedom by dimension: right-handed turns about the machine's axes, then shifts along them"""
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
    """The rotation (d, d) by an angle (1,) in the plane, or a rotation vector (3,) in space [rad]."""
    if len(turns) == 3:
        return np.asarray(Rotation.from_rotvec(turns).as_matrix())
    c, s = np.cos(turns[0]), np.sin(turns[0])
    return np.array([[c, -s], [s, c]])


def composed(second: Motion, first: Motion) -> Motion:
    """The motion that does `first`, then `second`."""
    return Motion(
        rotation=second.rotation @ first.rotation,
        translation=second.rotation @ first.translation + second.translation,
    )
