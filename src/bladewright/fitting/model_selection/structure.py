"""How many control points the laws and curves of a design have, apart from their values, and designs with more."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, singledispatch
from itertools import pairwise
from typing import Any

import numpy as np

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Stations
from bladewright.errors import DesignError
from bladewright.fitting.free_parameters import EDGES, WALLS, sliding_coordinate
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.model_selection.laws import (
    COMPARED_PLACES,
    FEWEST_ON_WALL,
    MOST_CHORD,
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
from bladewright.fitting.models.designs import SINGLE_SECTION
from bladewright.fitting.models.model import model_of
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
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES, WEIGHTS
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
RICH_SECTION = {2: 12, 3: 8}
"""control points along the chord of a rich structure of sections of other families, by dimension"""
RICH_SECTION_SPAN = 5
"""control points along the span of their laws (design/matching_constants.md)"""


@singledispatch
def chordwise_rows(part: Any) -> dict[str, Row]:  # noqa: ARG001 - most parts have none
    """The rows along the chord of a part whose number of control points may change: those without given places."""
    return {}


@chordwise_rows.register
def _(part: UnifiedSection | UnifiedBlade) -> dict[str, Row]:
    return dict.fromkeys(THICKNESSES, _row_of_thicknesses(part.samples, part.clustering))


@cache
def _row_of_thicknesses(samples: int, clustering: float) -> Row:
    # where the samples of the sides stand, a thickness matters most
    compared = np.sort(np.concatenate([sample_places(samples, clustering)[2:-2], COMPARED_PLACES]))
    return Row(fewest=FEWEST_THICKNESSES, most=MOST_SAMPLES - SPARE_SAMPLES, compared=compared)


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
    return [ChannelCurves(name="channel", degree=design.channel.degree)]


@resizable_curves.register
def _(design: SectionedBlade) -> list[ResizableLaw]:
    found = list[ResizableLaw]()
    for edge in EDGES:
        if isinstance(getattr(design, edge), ThroughPoints):
            found.append(CurvePoints(name=edge, axes="x" if sliding_coordinate(design, edge) == "r" else "r"))
    for wall in WALLS:
        curve = getattr(design.flow_path, wall)
        if isinstance(curve, ThroughPoints) and len(curve.points) >= FEWEST_ON_WALL:
            way = cumulative_length(np.real(np.array(curve.points)))
            found.append(WallPoints(name=f"flow_path.{wall}", stations=tuple((way / way[-1]).tolist())))
    return found


@resizable_curves.register
def _(design: SegmentedSection) -> list[ResizableLaw]:
    """The inner control points of the segments, but for those whose skin morphs."""
    found = list[ResizableLaw]()
    part = design.section
    for sign, side in ((1.0, "upper"), (-1.0, "lower")):
        given = getattr(part, side)
        joints = [0 if part.nose is None else part.nose.continuity, given.front_joint.continuity]
        joints += [given.rear_joint.continuity, 0]
        for segment, (front, rear) in zip(SEGMENTS, pairwise(joints), strict=True):
            if getattr(given, segment).skin is None:
                name, held = f"section.{side}.{segment}", (1 + front, 1 + rear)
                fewest = (max(1, DEGREE + 1 - sum(held)),)
                found.append(SegmentPoints(name=name, fewest=fewest, sign=sign, held=held))
    return found


def sized_laws(design: Any) -> list[ResizableLaw]:
    """The laws and curves of a design whose numbers of control points are its structure."""
    part = getattr(design, "section", design)
    stem, rich = ("", RICH_CHORDWISE) if part is design else ("section.", RICH_SECTION)
    rows = chordwise_rows(part)
    found = list[ResizableLaw]()
    for name, row in rows.items():
        path = f"{stem}{name}"
        fewest = 0 if row.optional else row.fewest, 1
        most = row.most, MOST_SPAN if design.dimension == 3 else 1
        rich_counts = rich[design.dimension], _rich_span(stem, name)
        kind = HeightsLaw if name.endswith("_heights") else SpanLaw
        # of the control points of a second derivative only the ratios count, so that the largest is held
        found.append(
            kind(name=path, fewest=fewest, most=most, rich=rich_counts, row=row, holds_corners=name == "curvature")
        )
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


FIRST_ANGLES, FIRST_TANGENTS, FIRST_RADII = 4, 3, 2
"""control points along the span of a first blade's angles and position, tangents and radii: free enough to find its
edges (design/matching_constants.md)"""
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
"""of a twisted and swept blade, with which a match begins (design/matching_constants.md)"""


def _determined(own: Structure, law: ResizableLaw, place: int) -> int:
    """The most control points of a law that a structure's samples determine, where it is sampled."""
    sampled = own.samples and law.name in THICKNESSES and place == 0
    return own.samples - SPARE_SAMPLES if sampled else law.most[place]


THINNER_EDGES, MOST_THINNINGS = 0.7, 12
"""ratio by which the thickness beside the edges is reduced, and how often at most (design/matching_constants.md)"""


def with_feasible_edges(design: Design) -> Design:
    """The design, or with thinner edges where it has no shape: its third control points may lie outside the edges."""
    if not isinstance(design, UnifiedSection | UnifiedBlade):
        return design
    for _ in range(MOST_THINNINGS):
        if _has_shape(design):
            break
        ends = tuple(f"{name}[{place}]" for name in THICKNESSES for place in (0, len(getattr(design, name)) - 1))
        values = design.parameters().items()
        design = design.changed({path: THINNER_EDGES * value for path, value in values if path.startswith(ends)})
    return design


def widened_where_feasible(design: Design, structure: Structure) -> Design:
    """The design of a wider structure, or where that has no shape, with those laws wider that leave it one alone."""
    whole = with_feasible_edges(reshaped(design, structure))
    if _has_shape(whole):
        return whole
    own = structure_of(design)
    for law in resizable_laws(design):
        wider = own.resized(law.name, structure.counts[law.name]).with_samples(structure.samples)
        own = wider if _has_shape(reshaped(design, wider)) else own
    return reshaped(design, own)


def _has_shape(design: Design) -> bool:
    try:
        with np.errstate(all="ignore"):
            return model_of(design, EXACT).shape(design).finite
    except DesignError:
        return False


SHARES = (1.0, 0.8, 0.6, 0.4, 0.2, 0.0)
"""shares of a rich structure's further control points tried where points are few (design/matching_constants.md)"""
POINTS_PER_PARAMETER = 2
"""points for each parameter of a rich structure at least, also of published profiles (design/matching_constants.md)"""


def rich_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, sampled: bool = False
) -> Structure:
    """A structure with more control points in every law than a match of so many points is likely to need.

    Along the span it has no more of them than `rows` of points, and along the chord, where it is `sampled`, no more
    than the design's samples determine. Laws of which nothing is `free` keep theirs.
    """
    own = structure_of(design)

    def rich(law: ResizableLaw, place: int, count: int) -> int:
        most = _determined(own, law, place) if sampled else law.most[place]
        return max(count, min(law.rich[place], most))

    return _grown(design, rich, free, points, rows)


def wider_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, slim: bool = False
) -> Structure:
    """A structure with a third as many control points again in every law of a design, and a rich one at least.

    Along the span it has no more of them than `rows` of points, and along the chord no more than the design's samples
    determine, unless it has as many (design/matching.md). Of a structure that is `slim`, which has lost what it does
    not need, half as many again and no more.
    """
    own = structure_of(design)

    def wider(law: ResizableLaw, place: int, count: int) -> int:
        determined = _determined(own, law, place)
        most = determined if count < determined else law.most[place]
        least = count if slim else max(count, min(law.rich[place], law.most[place]))
        return max(least, min(count + max(1, count // (2 if slim else 3)), most))

    return _grown(design, wider, free, points, rows)


def _grown(
    design: Design, aim: Callable[[ResizableLaw, int, int], int], free: Collection[str], points: int, rows: int
) -> Structure:
    """A structure with as many control points as `aim` says of each law, place and count, as far as points allow."""
    own, laws = structure_of(design), resizable_laws(design)
    freed = {law.name for law in laws if not set(free).isdisjoint(law.paths(design) or free)}

    def grown(law: ResizableLaw, place: int, count: int, share: float) -> int:
        aimed = aim(law, place, count)
        if place in law.along_span:
            # no more of them than rows, but the fewest that a law may have
            most = max(rows, law.fewest[place])
            count, aimed = min(count, most), min(aimed, most)
        return count + round(share * (aimed - count)) if law.name in freed else count

    for share in SHARES:
        counts = {law.name: tuple(grown(law, *each, share) for each in enumerate(own.counts[law.name])) for law in laws}
        rich = replace(own, counts={**own.counts, **counts}).with_samples(own.samples)
        if len(reshaped(design, rich).parameters()) * POINTS_PER_PARAMETER <= points:
            break
    return rich
