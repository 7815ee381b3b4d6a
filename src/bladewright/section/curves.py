"""Camber line and sides as native curves."""

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.section.sides import DEGREE


def camber_curve(control_points: Array) -> Curve:
    """The cubic camber line of control points (4, 2)."""
    return Curve(control_points=control_points, knots=uniform_knots(4, 3), degree=3)


def side_curve(controls: Array) -> Curve:
    """The quartic side of control points (n, 2), or rational of homogeneous ones (n, 3)."""
    knots = uniform_knots(len(controls), DEGREE)
    if controls.shape[-1] == 2:
        return Curve(control_points=controls, knots=knots, degree=DEGREE)
    weights = controls[:, 2]
    return Curve(
        control_points=controls[:, :2] / weights[:, None], knots=knots, degree=DEGREE, weights=np.array(weights)
    )
