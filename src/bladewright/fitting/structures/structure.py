"""How many control points the laws of a design have, apart from their values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.section.limits import ANGLES, RADII, TANGENTS, THICKNESSES
from bladewright.section.unified import UnifiedSection

EDGES = ("leading_edge", "trailing_edge", "hub", "shroud")
SPANWISE = (*ANGLES, *TANGENTS, *RADII)
"""laws along the span, besides the position of the leading edge and the thicknesses"""


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Numbers and places of control points: what is chosen before a fit, where its values are found by it."""

    chordwise: tuple[int, int] = (6, 6)
    """control points of the upper and the lower thickness along the chord"""
    span: Mapping[str, int] = field(default_factory=dict)
    """control points along the span by field: those of SPANWISE, `place` of the leading edge, and `thickness_upper` and
    `thickness_lower`; empty for a section"""
    channel: Mapping[str, int] = field(default_factory=dict)
    """control points of the four curves, corners among them; empty for a section"""
    samples: int = 16
    clustering: float = 1.0


def structure_of(design: Design) -> Structure:
    """The structure of a design."""
    if isinstance(design, UnifiedSection):
        return Structure(
            chordwise=(len(design.thickness_upper), len(design.thickness_lower)),
            samples=design.samples,
            clustering=design.clustering,
        )
    if not isinstance(design, UnifiedBlade):
        raise FitError(f"a {type(design).__name__} has no laws of the unified family; give a design of that family")
    place = design.leading_edge_theta if design.arrangement == "annular" else design.leading_edge_y
    span = {name: _count(getattr(design, name)) for name in SPANWISE} | {"place": _count(place)}
    for name in THICKNESSES:
        span[name] = max(_count(law) for law in getattr(design, name))
    channel = design.channel
    return Structure(
        chordwise=(len(design.thickness_upper), len(design.thickness_lower)),
        span=span,
        channel={
            "leading_edge": len(channel.leading_edge),
            "trailing_edge": len(channel.trailing_edge),
            "hub": len(channel.hub) + 2,
            "shroud": len(channel.shroud) + 2,
        },
        samples=design.samples,
        clustering=design.clustering,
    )


def _count(law: object) -> int:
    return len(law) if isinstance(law, tuple) else 1
