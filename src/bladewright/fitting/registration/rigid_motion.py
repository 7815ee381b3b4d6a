"""Rigid motions in the plane and in space, and the freedoms in which they may change."""

import numpy as np
from scipy.spatial.transform import Rotation

from bladewright.errors import FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.nurbs.basis import Reals

FREEDOMS = ("turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z")
"""of a motion in space: right-handed turns about the machine's axes, then shifts along them"""
PLANE_FREEDOMS = ("turn", "shift_x", "shift_y")
"""of a motion in the plane"""
SEPARABLE = {"annular": ("turn_y", "turn_z", "shift_y", "shift_z"), "linear": ("turn_x", "turn_y")}
"""The freedoms that no free parameter of a design stands for, by arrangement.

A shift along x moves an annular blade as its channel does, a turn about x as `leading_edge_theta` does. In a cascade
the shifts are those of channel and `leading_edge_y`, and a turn about the span changes `stagger` and both metal angles.
"""
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


def inverted(motion: Motion) -> Motion:
    """The motion back."""
    return Motion(rotation=motion.rotation.T, translation=-motion.rotation.T @ motion.translation)


def identity_motion(dimension: int) -> Motion:
    """The motion that leaves everything where it is."""
    return Motion(rotation=np.eye(dimension), translation=np.zeros(dimension))


def free_columns(dimension: int, freedoms: tuple[str, ...] | None) -> list[int]:
    """Which of the freedoms are free, all where None; FitError where one does not exist."""
    known = FREEDOMS if dimension == 3 else PLANE_FREEDOMS
    strange = [name for name in freedoms or () if name not in known]
    if strange:
        raise FitError(f"freedom '{strange[0]}' of a rigid motion does not exist: known are {', '.join(known)}")
    return [known.index(name) for name in (known if freedoms is None else freedoms)]
