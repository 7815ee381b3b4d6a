"""Blades cut off near hub or tip by a surface of revolution, or by the clearance surface beside it.

With S(u, v) a side and l(u), h(u) the places at which its line of constant u meets the cuts, or its ends where it is
not cut, the cut side is W(u, w) = S(u, V(w; l(u), h(u))), V the stretch of `stretch.py`, refitted within the design's
tolerance.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.exact.clearance import clearance_of
from bladewright.blade.native.blade import Blade
from bladewright.blade.native.cut_checks import about, between_cuts, check_end_cut, meridian_of_cut, met, mirrored_edges
from bladewright.blade.native.cut_clearance import cleared_meridian
from bladewright.blade.native.cut_faces import inner_knots, wall_normals
from bladewright.blade.native.cut_lines import Crossing, Lines, crossing_rates
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.recut import native_faces, recut
from bladewright.blade.native.stretch import CutChoices, stretch_between
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.section.outline import EdgeDerivatives

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

ENDS = ("hub", "tip")
"""Keys of the cuts of ends."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EndCutRows:
    """Curves of constant place along the span of a blade whose ends are cut."""

    v: Reals
    cut: "EndCut"

    def points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = (self._points(name, s) for name in ("upper", "lower"))
        return upper, lower

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Points, and unit normals of the walls at both ends; zero between."""
        both = self.points(s)
        upper, lower = (np.zeros(np.shape(points)) for points in both)
        for normals, points in zip((upper, lower), both, strict=True):
            for row, wall in zip((0, -1), self.cut.walls, strict=True):
                normals[row] = wall_normals(wall, points[row], revolved=self.cut.revolved)
        return both, (upper, lower)

    def leading_edge(self) -> EdgeDerivatives:
        return self._edge("upper", 0.0)

    def trailing_edge(self) -> EdgeDerivatives:
        return self._edge("upper", 1.0)

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        first, last = (
            None if same else self._edge("lower", at)
            for same, at in zip(self.cut.choices.mirrored, (0.0, 1.0), strict=True)
        )
        return first, last

    def faces(self, w: Reals) -> dict[str, Array]:
        return {name: self._points(name, w) for name in native_faces(self.cut.blade)}

    def _points(self, name: str, s: Reals) -> Array:
        places = self.cut.places(self.v, *(each.place for each in self.cut.met(name, s)))
        return self.cut.face(name)(s, places)

    def _edge(self, name: str, at: float) -> EdgeDerivatives:
        """W and its derivatives by u, (m, 3) each, from those of S and of l and h."""
        cut, s = self.cut, np.array([at])
        place, rate, turn = (self._stretched(name, s, order)[:, 0] for order in range(3))
        face, u = cut.face(name), np.full(len(self.v), at)
        along, across = face.derivative(u, place, 1, 0), face.derivative(u, place, 0, 1)
        second = face.derivative(u, place, 2, 0) + 2.0 * face.derivative(u, place, 1, 1) * rate[:, None]
        second = second + face.derivative(u, place, 0, 2) * rate[:, None] ** 2 + across * turn[:, None]
        return EdgeDerivatives(face(u, place), along + across * rate[:, None], second)

    def _stretched(self, name: str, s: Reals, order: int) -> Array:
        """V and its derivatives by u (m, k): V is linear in l and h."""
        ends = self.cut.met_with_rates(name, s)
        if order == 0:
            return self.cut.places(self.v, ends[0][0], ends[1][0])
        none = self.cut.places(self.v, np.zeros(len(s)), np.zeros(len(s)))
        return self.cut.places(self.v, ends[0][order], ends[1][order]) - none


@dataclass(frozen=True, kw_only=True, eq=False)
class EndCut:
    """A blade whose ends are cut, as native sides interpolate it."""

    blade: Blade
    meridians: Mapping[str, Curve]
    """of the cuts, by `hub` and `tip`, along the flow"""
    choices: CutChoices
    walls: tuple[Curve, Curve]
    """meridians of both ends"""

    @property
    def revolved(self) -> bool:
        """Whether the row is annular."""
        return self.blade.plain.exact.mapping.revolved

    def face(self, name: str) -> Surface:
        """A native face of the blade."""
        sides = dict(zip(("upper", "lower"), self.blade.sides, strict=True))
        return sides[name] if name in sides else native_faces(self.blade)[name]

    @cached_property
    def survey(self) -> EndCutRows:
        """Curves from end to end on which knots along u are chosen."""
        return self.sections(np.linspace(0.0, 1.0, 9))

    @property
    def given_spans(self) -> Reals:
        return np.empty(0)

    def breaks_along_u(self) -> Reals:
        return self.blade.knots.u[DEGREE + 1 : -DEGREE - 1]

    def breaks_along_v(self) -> Reals:
        knots = self.choices.stretch.knots(self.blade.knots.v, DEGREE)
        return knots[DEGREE + 1 : -DEGREE - 1]

    def sections(self, v: Reals) -> EndCutRows:
        """Curves at places (m,) from the cut blade's one end to its other."""
        return EndCutRows(v=v, cut=self)

    def places(self, w: Reals, low: Array, high: Array) -> Array:
        """V (m, k) at w (m,) on lines that begin and end at l and h (k,)."""
        return self.choices.stretch.places(w[:, None], low, high, (low, high))

    def met(self, name: str, s: Reals) -> tuple[Crossing, Crossing]:
        """Where a face's lines at s (k,) begin and end."""
        first, last = (self._end(name, end, s)[0] for end in ENDS)
        return first, last

    def met_with_rates(self, name: str, s: Reals) -> tuple[tuple[Array, Array, Array], tuple[Array, Array, Array]]:
        """l and h (k,), with their first and second derivatives by s."""
        found = []
        for end in ENDS:
            crossing, lines = self._end(name, end, s)
            none = np.zeros(len(s))
            rates = crossing_rates(lines, self.meridians[end], crossing) if end in self.meridians else (none, none)
            found.append((crossing.place, *rates))
        return found[0], found[1]

    def _end(self, name: str, end: str, s: Reals) -> tuple[Crossing, Lines]:
        lines = self._lines(name, s)
        if end not in self.meridians:
            return Crossing(np.full(len(s), float(ENDS.index(end))), np.zeros(len(s))), lines
        return met(lines, self.meridians[end], about(s, self.choices.near[end][name]), f"cut.{end}"), lines

    def _lines(self, name: str, s: Reals) -> Lines:
        return Lines(face=self.face(name), along="v", at=s, revolved=self.revolved)


def cut_ends(blade: Blade, design: "RowDesign", knots: Knots | None, *, fine: bool) -> Blade:
    """The blade with the ends cut that the design's `cut` names, each as far from its cut as a clearance asks."""
    walls, meridians = dict(blade.walls), {}
    tip_knots = None if knots is None else knots.tip
    for end, wall, face in zip(ENDS, ("hub", "shroud"), design.ends, strict=True):
        if getattr(design.cut, end) is None:
            continue
        meridian = meridian_of_cut(blade, design, end)
        walls[wall] = meridian, inner_knots(meridian)
        clearance = clearance_of(design) if face == "tip" else None
        if clearance is not None:
            held = None if knots is None or knots.cut is None else knots.cut.near[end]
            near = check_end_cut(blade, design, end, meridian) if held is None else held
            meridian = cleared_meridian(blade, end, meridian, clearance, near, tip_knots)
            inner = inner_knots(meridian)
            # at a single knot the fitted meridian is smooth up to what it misses
            walls[face] = meridian, inner[np.sum(inner[:, None] == inner, axis=0) > 1]
            tip_knots = meridian.knots
        meridians[end] = meridian
    choices = _chosen(blade, design, meridians) if knots is None or knots.cut is None else knots.cut
    own = [walls[wall][0] if wall in walls else blade.end_wall(wall)[0] for wall in design.ends]
    shape = EndCut(blade=blade, meridians=meridians, choices=choices, walls=(own[0], own[1]))
    return recut(shape, blade, design, knots, walls=walls, choices=choices, fine=fine, tip=tip_knots)


def _chosen(blade: Blade, design: "RowDesign", meridians: Mapping[str, Curve]) -> CutChoices:
    near = {end: check_end_cut(blade, design, end, meridian) for end, meridian in meridians.items()}
    low, high = between_cuts(design, ENDS, near)
    straight = blade.plain.exact.survey.skinning != "sections"
    stretch = stretch_between(low, high, blade.knots.v, straight=straight)
    return CutChoices(stretch=stretch, mirrored=mirrored_edges(blade, {}), near=near)
