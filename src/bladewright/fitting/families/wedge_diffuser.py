"""Where a vane of a wedge diffuser begins."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bladewright.fitting.families.section_shape import SectionShape
from bladewright.section.wedge_diffuser import WedgeDiffuser

TEMPLATES = (
    WedgeDiffuser(stagger_angle=0.0, leading_edge_radius=0.01, trailing_edge_radius=0.01, wedge_angle=8.0),
    WedgeDiffuser(stagger_angle=0.0, leading_edge_radius=0.01, trailing_edge_radius=0.05),
)
"""parts whose structures are tried where none is given: with a back face, and without"""


def first_parts(shape: SectionShape, like: WedgeDiffuser | None) -> Sequence[WedgeDiffuser]:
    """The vanes nearest to a section: its stagger, the line through its half thickness, and its edges."""
    straight = np.linspace(0.2, 0.8, 31)
    opening, first = np.polyfit(straight, shape.half(straight), 1)
    last = float(np.clip(first + opening, 2e-3, 0.3))
    angle = float(np.clip(np.degrees(2.0 * np.arctan(opening)), 1.0, 60.0))
    return [
        replace(
            each,
            stagger_angle=float(np.degrees(shape.stagger)),
            leading_edge_radius=float(np.clip(first, 1e-3, 0.2)),
            # the corners of a back face are rounded by much less than its half width
            trailing_edge_radius=last if each.wedge_angle is None else 0.2 * last,
            wedge_angle=None if each.wedge_angle is None else angle,
        )
        for each in (TEMPLATES if like is None else [like])
    ]
