"""Morphing of whole sections: leading and trailing edge turned about the middles of their cuts."""

from dataclasses import replace

import numpy as np

from bladewright.numerics.elementary import Array, concatenated, radians
from bladewright.section.laws import Span
from bladewright.section.segmented.outline import SegmentedSide
from bladewright.section.segmented.parts import Morph


def morphed(
    morph: Morph, upper: SegmentedSide, lower: SegmentedSide, span: Span
) -> tuple[SegmentedSide, SegmentedSide]:
    """The upper and the lower side with leading and trailing edge turned; what a cut keeps continuous stays so.

    The control points that decide a cut's continuous derivatives stay where they are, and so do these derivatives; the
    other control points of a segment turn. Reference: Tortora et al. 2023, section 4.2 and Figure 30.
    """
    sides = [upper, lower]
    for end, law in ((0, morph.leading_edge), (1, morph.trailing_edge)):
        # the first control point of the central box is at the front cut, its last at the rear one
        joints = [side.controls[1][..., -end, :] for side in sides]
        middle = 0.5 * (joints[0] + joints[1])
        angle = radians(span.values(law))
        for k, side in enumerate(sides):
            controls = list(side.controls)
            controls[2 * end] = _turned(controls[2 * end], middle, angle, 1 + side.continuity[end], end)
            sides[k] = replace(side, controls=(controls[0], controls[1], controls[2]))
    return sides[0], sides[1]


def _turned(controls: Array, middle: Array, angle: Array, kept: int, end: int) -> Array:
    """Control points (..., m, n, 2) turned about a point (..., m, 2), but for those kept at the cut."""
    offset = controls - middle[..., None, :]
    cosine, sine = np.cos(angle)[..., None], np.sin(angle)[..., None]
    x, y = offset[..., 0], offset[..., 1]
    turned = np.stack(np.broadcast_arrays(x * cosine - y * sine, x * sine + y * cosine), axis=-1)
    turned = turned + middle[..., None, :]
    if end == 0:
        return concatenated([turned[..., :-kept, :], controls[..., -kept:, :]], axis=-2)
    return concatenated([controls[..., :kept, :], turned[..., kept:, :]], axis=-2)
