"""How many control points the laws and curves of a design have, apart from their values."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import singledispatch
from itertools import pairwise
from typing import Any

import numpy as np

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Stations
from bladewright.errors import FitError
from bladewright.fitting.free_parameters import EDGES, WALLS, sliding_coordinate
from bladewright.fitting.model_selection.laws import (
    COMPARED_PLACES,
    FEWEST_ON_WALL,
    MOST_CHORD,
    MOST_CURVE,
    MOST_SPAN,
    ChannelCurves,
    Counts,
    CurvePoints,
    HeightsLaw,
    ResizableLaw,
    Row,
    SegmentPoints,
    SpanLaw,
    WallPoints,
)
from bladewright.fitting.models.sectioned import SINGLE_SECTION
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import named_laws
from bladewright.section.segmented.part import SegmentedSection
from bladewright.section.segmented.segment import DEGREE
from bladewright.section.segmented.skin import SEGMENTS
from bladewright.section.suction_pressure.part import SuctionPressure
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import THICKNESSES, WEIGHTS
from bladewright.section.unified_sides import sample_places

FEWEST_THICKNESSES = 3
"""control points of a thickness along the chord at least (design/matching_constants.md)"""
SPARE_SAMPLES = 4
"""samples along the chord that determine a thickness, beyond its control points (design/matching_constants.md)"""
MOST_SAMPLES = 60
"""samples along the chord at most (design/matching_constants.md)"""
POSITIONS = ("leading_edge_theta", "leading_edge_y")
"""fields of the position of the leading edge"""
RICH_CHORDWISE = {2: 24, 3: 9}
"""control points along the chord of a rich structure of the unified family, by dimension: nine hold cubic laws of 4, 5
and 6 (design/matching.md)"""
RICH_SPAN = {"thickness": 6, "radius": 4, "": 9}
"""control points along the span of its laws, by what their names say: six hold cubic laws of 4, nine of 4, 5 and 6."""
RICH_CHANNEL = (9, 9, 6, 6)
"""control points of the edges, of hub and of shroud, which hold cubic curves likewise (design/matching_constants.md)"""
RICH_SECTION = {2: 12, 3: 8}
"""control points along the chord of a rich structure of sections of other families, by dimension"""
RICH_SECTION_SPAN = 5
"""control points along the span of their laws (design/matching_constants.md)"""
RICH_CURVE = 8
"""points on an edge curve or a wall of a rich structure (design/matching_constants.md)"""
RICH_SEGMENT = 5
"""inner control points of a segment in a rich structure: they hold segments of one (design/matching_constants.md)"""


@singledispatch
def chordwise_rows(part: Any) -> dict[str, Row]:  # noqa: ARG001 - most parts have none
    """The rows along the chord of a part whose number of control points may change: those without given places."""
    return {}


@chordwise_rows.register
def _(part: UnifiedSection | UnifiedBlade) -> dict[str, Row]:
    # where the samples of the sides stand, a thickness matters most
    samples = sample_places(part.samples, part.clustering)[2:-2]
    compared = np.sort(np.concatenate([samples, COMPARED_PLACES]))
    row = Row(fewest=FEWEST_THICKNESSES, most=MOST_SAMPLES - SPARE_SAMPLES, compared=compared)
    return dict.fromkeys(THICKNESSES, row)


@chordwise_rows.register
def _(part: CamberAngle) -> dict[str, Row]:
    found = {"camber_angle": Row(fewest=1, most=MOST_CHORD)}
    if not (part.thickness_places or part.thickness_weights):

        def places(count: int) -> Reals:
            outline = replace(part, half_thickness=(0.01,) * count).outline(SINGLE_SECTION)
            return np.asarray(np.real(outline.places.controls)[0])

        held = 1, 0 if part.trailing_edge == "blunt" else 1
        found["half_thickness"] = Row(fewest=3, most=MOST_CHORD, held=held, places=places)
    return found


@chordwise_rows.register
def _(part: CurvatureMeanline) -> dict[str, Row]:
    found = {}
    if part.curvature and not part.curvature_places:
        found["curvature"] = Row(fewest=2, most=MOST_CHORD)
    if not part.thickness_multiplier_places:
        found["thickness_multiplier"] = Row(fewest=3, most=MOST_CHORD, optional=True)
    return found


@chordwise_rows.register
def _(part: SuctionPressure) -> dict[str, Row]:
    found = {}
    for side in ("suction", "pressure"):
        given = getattr(part, f"{side}_places") or getattr(part, f"{side}_knots")
        if getattr(part, f"{side}_heights") and not given:
            found[f"{side}_heights"] = Row(fewest=1, most=MOST_CHORD, held=(2, 2))
    return found


@singledispatch
def resizable_curves(design: Any) -> list[ResizableLaw]:  # noqa: ARG001 - most designs have none
    """The curves of a design whose number of control points or points may change."""
    return []


@resizable_curves.register
def _(design: UnifiedBlade) -> list[ResizableLaw]:
    fewest, most = (2,) * 4, (MOST_CURVE,) * 4
    return [ChannelCurves(name="channel", fewest=fewest, most=most, rich=RICH_CHANNEL, degree=design.channel.degree)]


@resizable_curves.register
def _(design: SectionedBlade) -> list[ResizableLaw]:
    found, most, rich = list[ResizableLaw](), (MOST_CURVE,), (RICH_CURVE,)
    for edge in EDGES:
        if isinstance(getattr(design, edge), ThroughPoints):
            axes = "x" if sliding_coordinate(design, edge) == "r" else "r"
            found.append(CurvePoints(name=edge, fewest=(2,), most=most, rich=rich, axes=axes))
    for wall in WALLS:
        curve = getattr(design.flow_path, wall)
        if isinstance(curve, ThroughPoints) and len(curve.points) >= FEWEST_ON_WALL:
            way = cumulative_length(np.real(np.array(curve.points)))
            name, fewest, stations = f"flow_path.{wall}", (FEWEST_ON_WALL,), tuple((way / way[-1]).tolist())
            found.append(WallPoints(name=name, fewest=fewest, most=most, rich=rich, axes="xr", stations=stations))
    return found


@resizable_curves.register
def _(design: SegmentedSection) -> list[ResizableLaw]:
    """The inner control points of the segments, but for those whose skin morphs."""
    found, part, most, rich = list[ResizableLaw](), design.section, (MOST_CHORD,), (RICH_SEGMENT,)
    for sign, side in ((1.0, "upper"), (-1.0, "lower")):
        given = getattr(part, side)
        joints = [0 if part.nose is None else part.nose.continuity, given.front_joint.continuity]
        joints += [given.rear_joint.continuity, 0]
        for segment, (front, rear) in zip(SEGMENTS, pairwise(joints), strict=True):
            if getattr(given, segment).skin is None:
                name, held = f"section.{side}.{segment}", (1 + front, 1 + rear)
                fewest = (max(1, DEGREE + 1 - sum(held)),)
                found.append(SegmentPoints(name=name, fewest=fewest, most=most, rich=rich, sign=sign, held=held))
    return found


def sized_laws(design: Any) -> list[ResizableLaw]:
    """The laws and curves of a design whose numbers of control points are its structure."""
    if not isinstance(design, Design):
        raise FitError(
            f"a {type(design).__name__} has no laws that a fit knows: give a design of the unified family, or another"
        )
    part = getattr(design, "section", design)
    stem, rich = ("", RICH_CHORDWISE) if part is design else ("section.", RICH_SECTION)
    rows, most_span, found = chordwise_rows(part), MOST_SPAN if design.dimension == 3 else 1, list[ResizableLaw]()
    for name, row in rows.items():
        fewest, most = (0 if row.optional else row.fewest, 1), (row.most, most_span)
        numbers, path = (rich[design.dimension], _rich_span(stem, name)), f"{stem}{name}"
        kind = HeightsLaw if name.endswith("_heights") else SpanLaw
        # of the control points of a second derivative only the ratios count, so that the largest is held
        held = name == "curvature"
        found.append(kind(name=path, fewest=fewest, most=most, rich=numbers, row=row, holds_corners=held))
    for path, _ in named_laws(design) if design.dimension == 3 else ():
        in_row = path.removeprefix(stem).partition("[")[0] in rows
        if (path.startswith(stem) or path in POSITIONS) and not (in_row or path.startswith(WEIGHTS)):
            found.append(SpanLaw(name=path, fewest=(1, 1), most=(1, MOST_SPAN), rich=(1, _rich_span(stem, path))))
    return [*found, *resizable_curves(design)]


def _rich_span(stem: str, name: str) -> int:
    """Control points along the span of a law of a rich structure."""
    return RICH_SECTION_SPAN if stem else next(most for word, most in RICH_SPAN.items() if word in name)


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
    changes: dict[str, Any] = {}
    laws = sized_laws(design)
    for law in laws:
        counts = structure.counts.get(law.name, law.counts_of(design))
        changes[law.name] = law.resized(design, counts, structure.stations.get(law.name))
    if structure.samples:
        changes |= {"samples": structure.samples, "clustering": structure.clustering}
    found = design.changed(changes)
    for law in laws:
        found = law.settled(design, found)
    return found
