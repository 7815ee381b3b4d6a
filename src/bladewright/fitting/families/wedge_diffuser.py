"""Where a vane of a wedge diffuser begins; it has no control points to add."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bladewright.fitting.families.section_samples import SampledSection
from bladewright.section.wedge_diffuser import WedgeDiffuser

TEMPLATES = (
    WedgeDiffuser(stagger_angle=0.0, leading_edge_radius=0.01, trailing_edge_radius=0.01, wedge_angle=8.0),
    WedgeDiffuser(stagger_angle=0.0, leading_edge_radius=0.01, trailing_edge_radius=0.05),
)
"""structures that are tried where none is given"""


def templates(section: SampledSection, parameters: int | None) -> Sequence[WedgeDiffuser]:  # noqa: ARG001 - the contract's
    """Structures that are tried where none is given."""
    return TEMPLATES


def starts(section: SampledSection, like: WedgeDiffuser) -> Sequence[WedgeDiffuser]:
    """The vane of a structure nearest to a section."""
    return [_start(section, like)]


def _start(section: SampledSection, like: WedgeDiffuser) -> WedgeDiffuser:
    """The vane of a structure nearest to a section: its stagger, the angle between its sides, and its edges."""
    opening = (section.half_at(0.8) - section.half_at(0.2)) / 0.6
    first = float(np.clip(section.half_at(0.2) - 0.2 * opening, 1e-3, 0.2))
    last = float(np.clip(section.half_at(0.8) + 0.2 * opening, 2e-3, 0.3))
    wedge = None if like.wedge_angle is None else float(np.clip(np.degrees(2.0 * np.arctan(opening)), 1.0, 60.0))
    return replace(
        like,
        stagger_angle=float(np.degrees(section.stagger)),
        leading_edge_radius=first,
        # the corners of a blunt face are rounded by much less than its half width
        trailing_edge_radius=last if wedge is None else 0.2 * last,
        wedge_angle=wedge,
    )


def extensions(part: WedgeDiffuser, section: SampledSection) -> Sequence[WedgeDiffuser]:  # noqa: ARG001 - what every family answers
    """None: the vane has three parameters."""
    return ()
