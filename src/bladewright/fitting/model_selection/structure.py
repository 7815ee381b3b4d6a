"""How many control points the laws of a design have, apart from their values; and those that a match begins with."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import singledispatch
from typing import Any

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Stations
from bladewright.errors import FitError
from bladewright.fitting.model_selection.laws import (
    COMPARED_PLACES,
    MOST_SPAN,
    ChannelCurves,
    Chordwise,
    Counts,
    ResizableLaw,
    SpanLaw,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES
from bladewright.section.unified_sides import sample_places

FEWEST_THICKNESSES = 3
"""control points of a thickness along the chord at least: half and twice change nothing measured
(design/matching_constants.md)"""
SPARE_SAMPLES = 4
"""samples along the chord beyond a thickness's control points: fewer leave its law undetermined
(design/matching_constants.md)."""
MOST_SAMPLES = 60
"""samples along the chord at most: half and twice change nothing measured (design/matching_constants.md)"""
SPANWISE = (*ANGLES, *TANGENTS, *RADII)
"""laws along the span of the unified family, besides the position of the leading edge and the thicknesses"""
POSITIONS = ("leading_edge_theta", "leading_edge_y")
"""fields of the position of the leading edge"""


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Numbers of control points: chosen before a fit, which finds the values."""

    counts: Mapping[str, Counts]
    """of each law, by its name"""
    stations: Mapping[str, Stations] = field(default_factory=dict)
    """those of the laws that are given at stations, which stay; their values do not count"""
    samples: int = 0
    """along the chord; 0 of sections that have none"""
    clustering: float = 1.0

    def resized(self, law: str, counts: Counts) -> "Structure":
        """The structure with other numbers of control points of a law."""
        return replace(self, counts={**self.counts, law: counts})

    def with_samples(self, least: int) -> "Structure":
        """The structure with as many samples along the chord as its thicknesses need, and at least so many."""
        if not self.samples:
            return self
        needed = max(self.counts[name][0] for name in THICKNESSES) + SPARE_SAMPLES
        return replace(self, samples=min(MOST_SAMPLES, max(least, needed)))


@singledispatch
def sized_laws(design: Any) -> list[ResizableLaw]:
    """The laws of a design whose numbers of control points are its structure."""
    raise FitError(
        f"a {type(design).__name__} has no laws that a fit knows: give a design of the unified family, or another"
    )


def structure_of(design: Design) -> Structure:
    """The structure of a design."""
    laws = sized_laws(design)
    return Structure(
        counts={law.name: law.counts_of(design) for law in laws},
        stations={law.name: found for law in laws if (found := law.stations_of(design))},
        samples=getattr(design, "samples", 0),
        clustering=getattr(design, "clustering", 1.0),
    )


def resizable_laws(design: Design) -> list[ResizableLaw]:
    """The laws of a design whose numbers of control points may change: stations stay."""
    return [law for law in sized_laws(design) if law.stations_of(design) is None]


def reshaped(design: Design, structure: Structure) -> Any:
    """A design of another structure whose laws and curves are nearest to those of `design`, by least squares."""
    laws = sized_laws(design)
    changes: dict[str, Any] = {}
    for law in laws:
        counts = structure.counts.get(law.name, law.counts_of(design))
        changes[law.name] = law.resized(design, counts, structure.stations.get(law.name))
    if structure.samples:
        changes |= {"samples": structure.samples, "clustering": structure.clustering}
    found = design.changed(changes)
    for law in laws:
        found = law.settled(design, found)
    return found


def richest(design: Design) -> Structure:
    """The structure with all the control points that a match may begin with."""
    found = structure_of(design)
    for law in resizable_laws(design):
        counts = zip(found.counts[law.name], law.rich, law.limits()[1], strict=True)
        found = found.resized(law.name, tuple(max(own, min(rich, most)) for own, rich, most in counts))
    return found


def within_rows(structure: Structure, design: Design, rows: int) -> Structure:
    """A structure with no more control points along the span than rows, but the fewest that its laws may have."""
    for law in resizable_laws(design):
        counts, least = list(structure.counts[law.name]), law.limits()[0]
        for place in law.along_span:
            counts[place] = max(min(counts[place], rows), least[place])
        structure = structure.resized(law.name, tuple(counts))
    return structure


def rows_shown(v: Reals) -> int:
    """How many control points along the span points at v (n,) show: the most equal parts of it of which each has some.

    A spline's control points are determined where each basis function has a place of its own (Schoenberg and Whitney
    1953): a blade that is measured in four sections determines four.
    """
    counts = range(MOST_SPAN, 1, -1)
    return next((n for n in counts if len(np.unique(np.minimum((n * v).astype(int), n - 1))) == n), 1)


RICH_CHORDWISE = {2: 24, 3: 9}
"""control points along the chord of a rich structure, by dimension. Nine have six spans, whose knots include those of
one, two and three: cubic laws of 4, 5 and 6 control points are special cases of theirs (design/matching.md)."""
RICH_SPAN = {"thickness": 6, "radius": 4, "": 9}
"""control points along the span of its laws, by what their names say: six hold cubic laws of 4, nine of 4, 5 and 6."""
RICH_CHANNEL = (9, 9, 6, 6)
"""control points of the edges, of hub and of shroud: six hold cubic curves of 4, nine of 4, 5 and 6."""
ALLOWED = {
    **dict.fromkeys(ANGLES, (-88.0, 88.0)),
    **dict.fromkeys(TANGENTS, (0.03, 0.99)),
    **dict.fromkeys(RADII, (1e-4, 0.9)),
}
"""within which a law is kept that another number of control points would carry past the family's own limits"""


@sized_laws.register
def _(design: UnifiedSection | UnifiedBlade) -> list[ResizableLaw]:
    spanwise = isinstance(design, UnifiedBlade)
    # where the samples of the sides stand, a thickness matters most
    samples = sample_places(design.samples, design.clustering)[2:-2]
    row = Chordwise(
        fewest=FEWEST_THICKNESSES,
        most=MOST_SAMPLES - SPARE_SAMPLES,
        compared=np.sort(np.concatenate([samples, COMPARED_PLACES])),
    )
    rich = RICH_CHORDWISE[3 if spanwise else 2], RICH_SPAN["thickness"]
    laws: list[ResizableLaw] = [SpanLaw(name, rich, row, spanwise) for name in THICKNESSES]
    if not isinstance(design, UnifiedBlade):
        return laws
    for name in (*SPANWISE, POSITIONS[0] if design.arrangement == "annular" else POSITIONS[1]):
        count = next(most for word, most in RICH_SPAN.items() if word in name)
        laws.append(SpanLaw(name, (1, count), allowed=ALLOWED.get(name, (-np.inf, np.inf))))
    return [*laws, ChannelCurves("channel", RICH_CHANNEL, design.channel.degree)]


FIRST_ANGLES, FIRST_TANGENTS, FIRST_RADII = 4, 3, 2
"""control points along the span of a first blade's angles and position, tangents and radii: free enough to find its
edges"""
FIRST_SECTION = Structure(counts=dict.fromkeys(THICKNESSES, (6, 1)), samples=16)
"""of a section with which a match begins"""
FIRST_BLADE = Structure(
    counts={
        **dict.fromkeys((*ANGLES, *POSITIONS), (1, FIRST_ANGLES)),
        **dict.fromkeys(TANGENTS, (1, FIRST_TANGENTS)),
        **dict.fromkeys(RADII, (1, FIRST_RADII)),
        **dict.fromkeys(THICKNESSES, (6, 3)),
        "channel": (4, 5, 4, 4),
    },
    samples=16,
)
"""of a twisted and swept blade, with which a match begins: with three and two control points for angles and tangents a
propeller, whose slices are within 2 deg of its metal angles, was searched away from these to 89 deg
(design/matching.md)"""
