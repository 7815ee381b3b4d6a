"""How many control points the laws of a design have, apart from their values; and those that a match begins with."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import singledispatch
from typing import Any

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Law, Stations
from bladewright.errors import FitError
from bladewright.section.laws import law_points, stations_of
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES

CHANNEL_CURVES = ("leading_edge", "trailing_edge", "hub", "shroud")
"""the four curves of a channel"""
FEWEST_THICKNESSES = 3
"""control points of a thickness along the chord at least"""
SPARE_SAMPLES = 4
"""samples along the chord beyond a thickness's control points: fewer leave its law undetermined."""
MOST_SAMPLES = 60
"""samples along the chord at most"""
MOST_CHORDWISE, MOST_SPAN, MOST_CURVE = MOST_SAMPLES - SPARE_SAMPLES, 12, 12
"""control points along the chord, along the span and of a curve of the channel at most; they bound the time."""
SPANWISE = (*ANGLES, *TANGENTS, *RADII)
"""laws along the span, besides the position of the leading edge and the thicknesses"""


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Numbers of control points: chosen before a fit, which finds the values."""

    chordwise: tuple[int, int] = (6, 6)
    """control points of the upper and the lower thickness along the chord"""
    span: Mapping[str, int] = field(default_factory=dict)
    """control points along the span by field: those of SPANWISE, `place` of the leading edge, and `thickness_upper` and
    `thickness_lower`; empty for a section"""
    stations: Mapping[str, Stations] = field(default_factory=dict)
    """those of the fields of `span` that are given at stations, which stay; their values do not count"""
    channel: Mapping[str, int] = field(default_factory=dict)
    """control points of the four curves, corners among them; empty for a section"""
    samples: int = 16
    clustering: float = 1.0

    def with_samples(self, least: int) -> "Structure":
        """The structure with as many samples along the chord as its thicknesses need, and at least so many."""
        return replace(self, samples=min(MOST_SAMPLES, max(least, max(self.chordwise) + SPARE_SAMPLES)))


@singledispatch
def structure_of(design: Design) -> Any:
    """The structure of a design."""
    raise FitError(
        f"a {type(design).__name__} has no laws that a fit knows: give a design of the unified family, or another"
    )


@structure_of.register
def _(design: UnifiedSection) -> Structure:
    return Structure(
        chordwise=(len(design.thickness_upper), len(design.thickness_lower)),
        samples=design.samples,
        clustering=design.clustering,
    )


@structure_of.register
def _(design: UnifiedBlade) -> Structure:
    place = design.leading_edge_theta if design.arrangement == "annular" else design.leading_edge_y
    span = {name: _count(getattr(design, name)) for name in SPANWISE} | {
        "place": _count(0.0 if place is None else place)
    }
    rows = {name: (getattr(design, name),) for name in SPANWISE} | {"place": () if place is None else (place,)}
    for name in THICKNESSES:
        rows[name] = getattr(design, name)
        span[name] = max(_count(law) for law in rows[name])
    found = {name: [each for law in row if (each := stations_of(law))] for name, row in rows.items()}
    channel = design.channel
    return Structure(
        chordwise=(len(design.thickness_upper), len(design.thickness_lower)),
        span=span,
        stations={name: replace(row[0], values=(0.0,) * len(row[0].span)) for name, row in found.items() if row},
        channel={
            "leading_edge": len(channel.leading_edge),
            "trailing_edge": len(channel.trailing_edge),
            "hub": len(channel.hub) + 2,
            "shroud": len(channel.shroud) + 2,
        },
        samples=design.samples,
        clustering=design.clustering,
    )


def _count(law: Law) -> int:
    return len(law_points(law))


def _blade(
    chordwise: int, thickness: int, angles: int, tangents: int, radii: int, channel: tuple[int, ...]
) -> Structure:
    span = {name: angles if name == "stagger" or "angle" in name else tangents for name in SPANWISE}
    span |= {name: radii for name in SPANWISE if name.endswith("radius")}
    return Structure(
        chordwise=(chordwise, chordwise),
        span={**span, "place": angles, "thickness_upper": thickness, "thickness_lower": thickness},
        channel=dict(zip(("leading_edge", "trailing_edge", "hub", "shroud"), channel, strict=True)),
    )


INITIAL_BLADES = (
    _blade(4, 1, 1, 1, 1, (2, 2, 2, 2)),
    _blade(5, 2, 3, 2, 1, (3, 3, 4, 4)),
    _blade(6, 3, 4, 3, 2, (4, 5, 4, 4)),
)
"""from a prismatic blade to a twisted and swept one; the last one's laws are free enough to find its edges"""
