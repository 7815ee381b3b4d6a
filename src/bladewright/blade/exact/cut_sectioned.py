"""Blades of sections that stand off a wall: cut off at the stated distance from it, the blade below as it is uncut.

The clearance surface's meridian is the wall's, moved along its normals n into the flow path by d:

    C(t) = S(t) + d(u(t)) n(t),

t the flow path's parameter, u linear in it, 0 at the leading and 1 at the trailing edge that the uncut blade has on the
wall, and d linear in u.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.exact.clearance import clearance_of
from bladewright.blade.exact.cut_curves import CutSections, cut_sections, spans_of_cut
from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.exact.meridional_extent import FlowPathExtent
from bladewright.blade.exact.meridional_view import COUNT, MeridionalView
from bladewright.blade.exact.offset_wall import OffsetWall, check_folds
from bladewright.blade.exact.sectioned import ENDS, ExactSectionedBlade, exact_sectioned_blade
from bladewright.blade.exact.span_cut import BENT, SpanCut
from bladewright.blade.exact.unified import SURVEY
from bladewright.blade.flow_path.channel import ChannelCurve
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first
from bladewright.blade.flow_path.quasi_orthogonals import parameters_at
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.blade.native.knots import DEGREE, Knots, refined
from bladewright.errors import DesignError
from bladewright.numerics.elementary import angle, length
from bladewright.nurbs.basis import Reals, basis, greville, knots_with_joints
from bladewright.nurbs.curve import Curve
from bladewright.section.section import Section
from bladewright.section.smoothness import Smoothness

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade

REACHED = 1e-10
"""Distance of the fitted meridian from the exact one, of the mean meridional length, to which knots are refined: at
places between those looked at it is up to four times that."""
PLACES = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, 25)) ** 2
"""Parameters along the sides at which the blade's distance from the wall is looked at, denser at the edges."""
SAMPLES = 1001
"""Points of the wall among which the nearest begins the search."""
MARGIN = 0.05
"""How far the meridian reaches past the blade at both edges, as a share of its stretch."""
MOST_POLES = 400
"""Control points of the meridian up to which knots are added: a wall through many points has knots at each."""


@dataclass(frozen=True, kw_only=True)
class ExactCutBlade(ExactBlade):
    """A blade of sections, cut off at its clearance; v up to where its curves bend to the cut is the span fraction."""

    design: "SectionedBlade"
    whole: ExactSectionedBlade
    """the same from wall to wall"""
    offset: OffsetWall
    cut: SpanCut

    @cached_property
    def survey(self) -> CutSections:
        """Curves from end to end on which the shape is judged."""
        return self.sections(SURVEY)

    def sections(self, v: Reals) -> CutSections:
        """The blade's curves at v (m,), from its one end to its other."""
        return cut_sections(self.whole.sections(spans_of_cut(v, self.cut)), v, self.cut)

    def moved_to(self, design: "SectionedBlade") -> "ExactCutBlade":
        whole = self.whole.moved_to(_without_clearance(design))
        offset = _offset(design, whole)
        meridian = _meridian(offset, self.cut.meridian.knots)
        return replace(self, design=design, whole=whole, offset=offset, cut=replace(self.cut, meridian=meridian))

    def check(self) -> None:
        self.whole.check()

    def breaks_along_u(self) -> Reals:
        return self.whole.breaks_along_u()

    def breaks_along_v(self) -> Reals:
        return np.empty(0) if self.cut.straight else self.cut.uncut_breaks(self.whole.breaks_along_v(), DEGREE)

    @property
    def given_spans(self) -> Reals:
        spans = self.whole.given_spans
        return np.union1d(spans[self.cut.bend(spans) == 0.0], ENDS)

    @property
    def section_spans(self) -> tuple[float, ...]:
        return self.whole.section_spans

    def meridional_channel(self, noses: tuple[float, float], ends: tuple[float, float]) -> StreamSurfaces:
        return self.whole.meridional_channel(noses, ends)

    @property
    def meridional_extent(self) -> FlowPathExtent:
        return self.whole.meridional_extent

    @cached_property
    def meridional_view(self) -> MeridionalView:
        """That of the uncut blade with the clearance surface."""
        real = self.offset.real()
        t = np.linspace(float(real.leading), float(real.trailing), COUNT)
        distances = tuple(float(each) for each in real.distance(t[[0, -1]]))
        return replace(self.whole.meridional_view, tip=real.points(t), clearance=distances)

    def without_clearance(self) -> ExactSectionedBlade:
        return self.whole

    @property
    def uncut(self) -> ExactSectionedBlade:
        return self.whole

    def wall(self, name: str) -> ChannelCurve | MeridionalCurve:
        return self.cut.meridian if name == self.offset.clearance.wall else self.whole.wall(name)

    def end_wall(self, row: int) -> tuple[Curve, Reals]:
        if self.design.ends[row] != "tip":
            return self.whole.end_wall(row)
        curve = self.cut.meridian.curve()
        inner = curve.knots[DEGREE + 1 : -DEGREE - 1]
        # at a single knot the fitted meridian is smooth up to what it misses
        return curve, inner[np.sum(inner[:, None] == inner, axis=0) > 1]

    def wall_parameters(self, u: Reals) -> Reals:
        return self.whole.wall_parameters(u)

    def end_places(self, s: Reals) -> tuple[Reals, Reals]:
        own, across = (np.array(each) for each in super().end_places(s))
        points, met = self.survey.ends(s)
        row, point = self.cut.end, real_first(points, 2)
        own[row] = real_first(met.t, 1)
        if not self.mapping.revolved:
            across[row] = point[:, 1]
            return own, across
        theta = angle(point[:, 1], point[:, 2])
        across[row] = theta + 2.0 * np.pi * np.round((across[row] - theta) / (2.0 * np.pi))
        return own, across

    def wall_points(self, name: str, u: Reals) -> Reals:
        return self.whole.wall_points(name, u)

    @property
    def clearance_range(self) -> tuple[float, float]:
        return self.cut.meridian.curve().domain

    def clearance_error(self, u: Reals, points: Reals) -> Reals:
        real = self.offset.real()
        t = real.nearest(points, u)
        return np.abs(length(points - real.wall.values(t)) - real.distance(t))  # real: a measured distance

    @property
    def tip_knots(self) -> Reals:
        return self.cut.meridian.knots

    @property
    def bent_from(self) -> float:
        return self.cut.bent_from

    def _section(self, v: float) -> Section:
        return self.whole.section(v)

    def smoothness(self, v: float) -> Smoothness:
        return self.whole.smoothness(v)


def exact_blade_of_sections(
    design: "SectionedBlade", knots: Knots | None = None, *, checked: bool = True
) -> ExactSectionedBlade | ExactCutBlade:
    """The exact blade of a design of sections, cut off where it has a clearance.

    `knots` hold those of the clearance surface's meridian. Raises DesignError where there is no such blade.
    """
    clearance = clearance_of(design)
    uncut = exact_sectioned_blade(_without_clearance(design), checked=checked)
    if clearance is None:
        return uncut
    offset = _offset(design, uncut)
    end, real = 0 if clearance.wall == "hub" else 1, offset.real()
    t, spans = _reached(uncut, real, end)
    straight = design.skinning == "ruled"
    if knots is None or knots.tip is None or knots.bent_from is None:
        tip, bent_from = _knots(uncut, real, t), 0.0
        if not straight:
            bent_from = max(0.0, 1.0 - BENT * float(np.max((end - spans) * (2 * end - 1))))
    else:
        tip, bent_from = knots.tip, knots.bent_from
    cut = SpanCut(
        meridian=_meridian(offset, tip),
        end=end,
        level=float(np.mean(spans)),
        straight=straight,
        bent_from=bent_from,
        breaks=np.unique(uncut.breaks_along_v()),
        mapping=uncut.mapping,
    )
    return ExactCutBlade(design=design, mapping=uncut.mapping, whole=uncut, offset=offset, cut=cut)


def _without_clearance(design: "SectionedBlade") -> "SectionedBlade":
    given = [name for name in ("tip_clearance", "hub_clearance") if getattr(design, name) is not None]
    return design.changed(dict.fromkeys(given)) if given else design


def _offset(design: "SectionedBlade", uncut: ExactSectionedBlade) -> OffsetWall:
    clearance = clearance_of(design)
    if clearance is None:
        raise DesignError("tip_clearance and hub_clearance are missing: nothing says where the blade is cut off")
    row = 0 if clearance.wall == "hub" else -1
    lines = uncut.sections(ENDS[[row]]).lines
    return OffsetWall(
        wall=uncut.surfaces.matched[row],
        clearance=clearance,
        leading=np.asarray(lines.leading[..., 0]),
        trailing=np.asarray(lines.trailing[..., 0]),
    )


def _meridian(offset: OffsetWall, knots: Reals) -> ChannelCurve:
    sites = greville(knots, DEGREE)
    return ChannelCurve(points=np.linalg.solve(basis(knots, DEGREE, sites), offset.points(sites)), knots=knots)


def _reached(uncut: ExactSectionedBlade, offset: OffsetWall, end: int) -> tuple[tuple[float, float], Reals]:
    """Least and greatest t of the clearance surface's feet beneath the blade, and span fractions (k,) where it is met.

    Roughly, by where the distance of the sections' points from the wall passes the stated one. Raises DesignError where
    it never does.
    """
    points = np.concatenate([real_first(side, 3) for side in uncut.survey.points(PLACES)], axis=1)
    r = length(points[..., 1:]) if uncut.mapping.revolved else points[..., 2]
    places = np.stack([points[..., 0], r], axis=-1)
    samples = np.linspace(uncut.surfaces.low, uncut.surfaces.high, SAMPLES)
    wall = offset.wall.values(samples)
    flat = places.reshape(-1, 2)
    near = samples[[int(np.argmin(np.sum((wall - place) ** 2, axis=-1))) for place in flat]]
    t = offset.nearest(flat, near)
    away = length(flat - offset.wall.values(t)).reshape(r.shape)
    t = t.reshape(r.shape)
    free = away - offset.distance(t.ravel()).reshape(r.shape)
    order = np.arange(len(SURVEY)) if end == 0 else np.arange(len(SURVEY))[::-1]
    offset.clearance.check_span(offset.u(t[order[-1]]), away[order[-1]])
    after = np.argmax(free[order] > 0.0, axis=0)
    both = np.stack([order[np.maximum(after - 1, 0)], order[after]])
    columns = np.arange(r.shape[1])
    beside = free[both, columns]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(after > 0, -beside[0] / (beside[1] - beside[0]), 0.0)
    spans = SURVEY[both[0]] + share * (SURVEY[both[1]] - SURVEY[both[0]])
    feet = t[both, columns]
    feet = feet[0] + share * (feet[1] - feet[0])
    low, high = float(np.min(feet)), float(np.max(feet))
    margin = MARGIN * (high - low)
    for place, edge in ((low, "leading"), (high, "trailing")):
        offset.clearance.check_nose(float(offset.u(np.array([place]))[0]), edge)
    return (low - margin, high + margin), spans


def _knots(uncut: ExactSectionedBlade, offset: OffsetWall, stretch: tuple[float, float]) -> Reals:
    """Knots of the meridian over t: where the wall loses derivatives, and wherever else the distance asks for them."""
    low, high = stretch
    clearance, surfaces = offset.clearance, uncut.surfaces
    row = 0 if clearance.wall == "hub" else -1
    curve, match = surfaces.curves[row], surfaces.matches[row]

    def along(own: Reals) -> Reals:
        fractions = real_first(curve.fraction_at(own), 1)
        return parameters_at(match, fractions, surfaces.low, surfaces.high)

    levels, kept = curve.smoothness()
    sharp = along(np.array(curve.corners)) if curve.corners else np.empty(0)
    inside = sharp[(sharp > low) & (sharp < high)]
    if len(inside):
        x, r = offset.wall.values(inside[:1])[0]
        raise DesignError(
            f"{clearance.name}: the {clearance.wall} has a corner beside the blade at (x, r) = ({x:.5g}, {r:.5g}) m, "
            f"where no surface keeps a distance from it; round the corner, or end it before the blade"
        )
    joints = [
        (float(place), max(int(smooth) - 1, 0))
        for level, smooth in zip(levels, kept, strict=True)
        for place in along(np.array([level]))
    ]
    joints += [(float(place), 1) for place in match.breaks[1:-1]]
    chord = float(np.mean(real_first(uncut.survey.lines.lengths, 1)))
    check_folds(offset, stretch)

    def miss(knots: Reals, places: Reals) -> Reals:
        fitted = _meridian(offset, knots).values(places)
        return length(fitted - offset.points(places)) / (REACHED * chord)

    knots = refined(knots_with_joints(np.repeat([low, high], DEGREE + 1), DEGREE, joints), miss, MOST_POLES)
    places = np.linspace(low, high, 2 * SAMPLES)
    gap = REACHED * float(np.max(miss(knots, places)))
    clearance.real().check_met(gap, knots, "flow_path")
    return knots
