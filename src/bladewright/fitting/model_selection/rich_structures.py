"""Structures with control points to spare, from which others are chosen."""

from dataclasses import replace
from functools import singledispatch
from typing import Any

from bladewright.designs import Design
from bladewright.fitting.model_selection.reshaping import reshaped, resizable_laws
from bladewright.fitting.model_selection.structure import structure_of

RICH_CHORDWISE = {2: 24, 3: 10}
"""control points along the chord of a rich structure, by dimension."""
RICH_SPAN = {"thickness": 6, "radius": 4, "tangent": 6, "": 8}
"""control points along the span of its laws, by what their names hold."""
SHARES = (1.0, 0.8, 0.6, 0.4, 0.2, 0.0)
"""shares of the further control points of a rich structure that are tried where points are few."""
POINTS_PER_PARAMETER = 2
"""points for each parameter of a rich structure at least: published profiles have few points."""
RICH_CHANNEL = (8, 8, 6, 6)
"""control points of the edges, of hub and of shroud."""


def rich_structure(design: Design, points: int) -> Any:
    """A structure with more control points in every law than a match of so many points is likely to need."""
    return _towards(richest(design), design, points)


def wider_structure(design: Design, points: int) -> Any:
    """A rich structure with a third as many control points again in every law of a design."""
    own, wide = structure_of(design), richest(design)
    for law in resizable_laws(design):
        counts = zip(law.counts(own), law.counts(wide), law.limits()[1], strict=True)
        wide = law.resized(wide, tuple(max(rich, min(count + count // 3, most)) for count, rich, most in counts))
    return _towards(wide, design, points)


def _towards(whole: Any, design: Design, points: int) -> Any:
    """A structure with more control points than a design's own, or as large a share of them as the points allow."""
    own = structure_of(design)
    for share in SHARES:
        rich = own
        for law in resizable_laws(design):
            counts = zip(law.counts(own), law.counts(whole), strict=True)
            rich = law.resized(rich, tuple(count + round(share * (most - count)) for count, most in counts))
        rich = rich.with_samples(own.samples)
        if len(reshaped(design, rich).parameters()) * POINTS_PER_PARAMETER <= points:
            break
    return rich


@singledispatch
def richest(design: Design) -> Any:
    """The structure with all the control points that a match may begin with."""
    own = structure_of(design)
    least = RICH_CHORDWISE[3 if own.channel else 2]
    span = {
        name: max(count, 0 if name in own.stations else next(most for word, most in RICH_SPAN.items() if word in name))
        for name, count in own.span.items()
    }
    channel = {name: max(count, most) for (name, count), most in zip(own.channel.items(), RICH_CHANNEL, strict=False)}
    chordwise = max(own.chordwise[0], least), max(own.chordwise[1], least)
    return replace(own, chordwise=chordwise, span=span, channel=channel)
