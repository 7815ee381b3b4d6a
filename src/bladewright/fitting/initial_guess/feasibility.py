"""Sections made simpler until they can be built."""

import numpy as np

from bladewright.fitting.initial_guess.section_shape import (
    ANGLE_IN,
    ANGLE_OUT,
    ROOT_IN,
    ROOT_OUT,
    STAGGER,
    TANGENT_IN,
    TANGENT_OUT,
    SectionShape,
)
from bladewright.nurbs.basis import Reals

SHARPENINGS = 8
"""times that edges are made sharper before anything else is changed"""


def with_sharper_edges(numbers: Reals, shape: SectionShape) -> Reals:
    """Numbers (n, q) of sections with smaller edge radii, and thinner beside the edges."""
    numbers = np.array(numbers)
    numbers[:, [ROOT_IN, ROOT_OUT]] *= 0.72
    for side in (shape.upper, shape.lower):
        numbers[:, [side.start, side.stop - 1]] *= 0.88
    return numbers


def simplified(numbers: Reals, shape: SectionShape) -> Reals:
    """Numbers (n, q) of sections that turn less, with sharper edges, longer tangents and more even thickness."""
    numbers = np.array(numbers)
    stagger = numbers[:, STAGGER]
    for column in (ANGLE_IN, ANGLE_OUT):
        numbers[:, column] = stagger + 0.85 * (numbers[:, column] - stagger)
    for column in (TANGENT_IN, TANGENT_OUT):
        numbers[:, column] += 0.3 * (0.35 - numbers[:, column])
    numbers[:, [ROOT_IN, ROOT_OUT]] *= 0.8
    for side in (shape.upper, shape.lower):
        thickness = numbers[:, side]
        numbers[:, side] = thickness + 0.1 * (np.mean(thickness, axis=1, keepdims=True) - thickness)
    return numbers
