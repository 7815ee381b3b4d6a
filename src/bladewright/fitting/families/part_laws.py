"""The laws of designs of one part, whose numbers of control points a match may choose: along the chord and the span."""

from dataclasses import dataclass, replace
from functools import singledispatch
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.designs import Stations, value_at
from bladewright.fitting.free_parameters import EDGES, WALLS, sliding_coordinate
from bladewright.fitting.model_selection.laws import (
    COMPARED_PLACES,
    FEWEST_ON_WALL,
    Chordwise,
    Counts,
    CurvePoints,
    HeightsLaw,
    RatioLaw,
    ResizableLaw,
    SpanLaw,
    WallPoints,
)
from bladewright.fitting.model_selection.structure import POSITIONS, sized_laws
from bladewright.fitting.models.sectioned import SINGLE_SECTION
from bladewright.numerics.elementary import cumulative_length, length
from bladewright.nurbs.basis import Reals, basis
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import named_laws, stations_of
from bladewright.section.planar import PlanarSection
from bladewright.section.segmented.part import Segmented, side_joints
from bladewright.section.segmented.segment import DEGREE, control_points, segment_knots
from bladewright.section.segmented.skin import SEGMENTS
from bladewright.section.suction_pressure.part import SuctionPressure

RICH_CHORDWISE = {2: 12, 3: 8}
"""control points of a law along the chord in a rich structure, by dimension."""
RICH_SPAN = 5
"""control points of a law along the span in a rich structure."""
RICH_CURVE = 8
"""points on an edge curve or a wall of a rich structure: as many as on a channel's edges"""
RICH_SEGMENT = 5
"""inner control points of a segment in a rich structure, of a section that stands alone: they hold segments of one"""
MOST = 24
"""control points of a law along the chord at most; it bounds the time: half and twice change nothing
(design/matching_constants.md)."""


@singledispatch
def chordwise_rows(part: Any) -> dict[str, Chordwise]:  # noqa: ARG001 - most parts have none
    """The rows of a part whose number of control points may change, by field: those without given places."""
    return {}


@chordwise_rows.register
def _(part: CamberAngle) -> dict[str, Chordwise]:
    found = {"camber_angle": Chordwise(fewest=1, most=MOST)}
    if not (part.thickness_places or part.thickness_weights):

        def places(count: int) -> Reals:
            outline = replace(part, half_thickness=(0.01,) * count).outline(SINGLE_SECTION)
            return np.asarray(np.real(outline.places.controls)[0])

        held = 1, 0 if part.trailing_edge == "blunt" else 1
        found["half_thickness"] = Chordwise(fewest=3, most=MOST, held=held, places=places)
    return found


@chordwise_rows.register
def _(part: CurvatureMeanline) -> dict[str, Chordwise]:
    found = {}
    if part.curvature and not part.curvature_places:
        found["curvature"] = Chordwise(fewest=2, most=MOST, by_ratio=True)
    if not part.thickness_multiplier_places:
        found["thickness_multiplier"] = Chordwise(fewest=3, most=MOST, optional=True)
    return found


@chordwise_rows.register
def _(part: SuctionPressure) -> dict[str, Chordwise]:
    heights = {name: getattr(part, f"{name}_heights") for name in ("suction", "pressure")}
    return {
        f"{name}_heights": Chordwise(fewest=1, most=MOST, held=(2, 2))
        for name, row in heights.items()
        if row and not (getattr(part, f"{name}_places") or getattr(part, f"{name}_knots"))
    }


@dataclass(frozen=True, eq=False)
class SegmentPoints(ResizableLaw):
    """The inner control points of a segment of an airfoil that stands alone, between ends that its joints give."""

    sign: float
    """1 on the upper side, -1 on the lower one"""
    held: Counts
    """control points that its joints give at its ends"""
    along_span: ClassVar[tuple[int, ...]] = ()

    def counts_of(self, design: Any) -> Counts:
        return (len(value_at(design, self.name).abscissas),)

    def limits(self) -> tuple[Counts, Counts]:
        return (max(1, DEGREE + 1 - sum(self.held)),), (MOST,)

    def paths(self, design: Any) -> list[str]:
        inner = range(*self.counts_of(design))
        return [f"{self.name}.{axis}[{i}]" for i in inner for axis in ("abscissas", "ordinates")]

    def _basis(self, count: int) -> tuple[Reals, slice]:
        """Values (m, n) of the basis functions of all control points, and which of these are so many inner ones."""
        rows = basis(segment_knots(count + sum(self.held)), DEGREE, COMPARED_PLACES)
        return rows, slice(self.held[0], self.held[0] + count)

    def embedding(self, counts: Counts, other: Counts) -> Reals:
        (own, inner), (known, others) = self._basis(*counts), self._basis(*other)
        return np.asarray(np.kron(np.linalg.lstsq(own[:, inner], known[:, others], rcond=None)[0], np.eye(2)))

    def offset(self, design: Any, counts: Counts, other: Counts) -> Reals:
        number, segment = SEGMENTS.index(self.name.rpartition(".")[2]), value_at(design, self.name)
        joints = side_joints(design.section, self.sign, SINGLE_SECTION)[number : number + 2]
        distance = length(joints[1].point - joints[0].point)
        scales = (np.array([each or 1.0]) for each in (segment.front_scale, segment.rear_scale))
        first, last = (joint.end(distance, scale) for joint, scale in zip(joints, scales, strict=True))
        ends = [control_points(first, np.zeros((1, *each, 2)), last)[0] for each in (counts, other)]
        (own, inner), (known, _) = self._basis(*counts), self._basis(*other)
        return np.linalg.lstsq(own[:, inner], known @ ends[1] - own @ ends[0], rcond=None)[0].ravel()

    def resized(self, design: Any, counts: Counts, stations: Stations | None) -> Any:  # noqa: ARG002 - the contract's
        segment, own = value_at(design, self.name), self.counts_of(design)
        if counts == own:
            return segment
        values = np.array([segment.abscissas, segment.ordinates]).T.ravel()
        points = (self.embedding(counts, own) @ values + self.offset(design, counts, own)).reshape(-1, 2)
        return replace(segment, abscissas=tuple(points[:, 0].tolist()), ordinates=tuple(points[:, 1].tolist()))


def _segments(part: Any) -> list[ResizableLaw]:
    """The inner control points of the segments of an airfoil, but for those whose skin morphs."""
    found: list[ResizableLaw] = []
    for sign, side in ((1.0, "upper"), (-1.0, "lower")):
        given = getattr(part, side)
        joints = [0 if part.nose is None else part.nose.continuity, given.front_joint.continuity]
        joints += [given.rear_joint.continuity, 0]
        for name, (front, rear) in zip(SEGMENTS, pairwise(joints), strict=True):
            if getattr(given, name).skin is None:
                found.append(SegmentPoints(f"section.{side}.{name}", (RICH_SEGMENT,), sign, (1 + front, 1 + rear)))
    return found


def _laws_of_part(part: Any, *, spanwise: bool) -> list[ResizableLaw]:
    """Those of a part, rows first; of a section the rows alone, as it has no span. Those at stations stay."""
    stationary = {path.partition("[")[0] for path, law in named_laws(part) if stations_of(law) is not None}
    rich, rows = (RICH_CHORDWISE[3 if spanwise else 2], RICH_SPAN), chordwise_rows(part)
    found: list[ResizableLaw] = []
    for name, row in rows.items():
        kind = RatioLaw if row.by_ratio else HeightsLaw if name.endswith("_heights") else SpanLaw
        if name not in stationary:
            found.append(kind(f"section.{name}", rich, row, spanwise))
    if spanwise:
        others = [path for path, _ in named_laws(part) if path.partition("[")[0] not in {*stationary, *rows}]
        found += [SpanLaw(f"section.{path}", rich) for path in others]
    return found


@sized_laws.register
def _(design: PlanarSection) -> list[ResizableLaw]:
    segments = _segments(design.section) if isinstance(design.section, Segmented) else []
    return [*_laws_of_part(design.section, spanwise=False), *segments]


@sized_laws.register
def _(design: SectionedBlade) -> list[ResizableLaw]:
    found = _laws_of_part(design.section, spanwise=True)
    for name in POSITIONS:
        law = getattr(design, name)
        if law is not None and stations_of(law) is None:
            found.append(SpanLaw(name, (1, RICH_SPAN)))
    for edge in EDGES:
        if isinstance(getattr(design, edge), ThroughPoints):
            axes = "x" if sliding_coordinate(design, edge) == "r" else "r"
            found.append(CurvePoints(edge, (RICH_CURVE,), axes))
    for wall in WALLS:
        curve = getattr(design.flow_path, wall)
        if isinstance(curve, ThroughPoints) and len(curve.points) >= FEWEST_ON_WALL:
            way = cumulative_length(np.real(np.array([tuple(each) for each in curve.points])))
            found.append(WallPoints(f"flow_path.{wall}", (RICH_CURVE,), "xr", tuple((way / way[-1]).tolist())))
    return found
