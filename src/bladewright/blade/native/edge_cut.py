"""Blades whose leading or trailing edge is cut off by a surface of revolution: native sides and blunt faces.

With S(u, v) a side and l(v), h(v) the places at which its line of constant v meets the cuts, or its edges where it is
not cut, the cut side is

    W(s, v) = S(V(s; l(v), h(v)), v),

V the stretch of `stretch.py`, refitted within the design's tolerance. The face of a cut edge is a piece of the surface
of revolution.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.cut_checks import (
    about,
    between_cuts,
    check_edge_cut,
    meridian_of_cut,
    met,
    mirrored_edges,
)
from bladewright.blade.native.cut_faces import inner_knots, wall_normals
from bladewright.blade.native.cut_lines import Lines
from bladewright.blade.native.end_faces import EDGES
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.recut import ON_CUT, native_faces, recut, survey_places
from bladewright.blade.native.stretch import CutChoices, Stretch, stretch_between
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.section.outline import EdgeDerivatives

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgeCutRows:
    """Curves of constant v of a blade whose edges are cut."""

    v: Reals
    sides: tuple[Surface, Surface]
    native: Mapping[str, Surface]
    """the faces of blunt edges that stay"""
    mirrored: tuple[bool, bool]
    """whether the lower side mirrors the upper one at the edges: where they are round and stay"""
    stretch: Stretch
    starts: tuple[Array, Array]
    """(m,) l of both sides"""
    stops: tuple[Array, Array]
    """(m,) h of both sides"""
    walls: tuple[Curve, Curve]
    """meridians of both ends"""
    revolved: bool

    def places(self, side: int, s: Reals, order: int = 0) -> Array:
        """V, or a derivative by s (m, k), of a side."""
        levels = tuple(((both[0] + both[1]) / 2.0)[:, None] for both in (self.starts, self.stops))
        low, high = self.starts[side][:, None], self.stops[side][:, None]
        return self.stretch.places(s, low, high, (levels[0], levels[1]), order)

    def points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = (face(self.places(i, s), self.v[:, None]) for i, face in enumerate(self.sides))
        return upper, lower

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Points, and unit normals of the walls at both ends; zero between."""
        both = self.points(s)
        upper, lower = (np.zeros(np.shape(points)) for points in both)
        for normals, points in zip((upper, lower), both, strict=True):
            for row, wall in zip((0, -1), self.walls, strict=True):
                normals[row] = wall_normals(wall, points[row], revolved=self.revolved)
        return both, (upper, lower)

    def leading_edge(self) -> EdgeDerivatives:
        return self._edge(0, 0.0)

    def trailing_edge(self) -> EdgeDerivatives:
        return self._edge(0, 1.0)

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        first, last = (None if same else self._edge(1, at) for same, at in zip(self.mirrored, (0.0, 1.0), strict=True))
        return first, last

    def faces(self, w: Reals) -> dict[str, Array]:
        return {name: np.swapaxes(face.grid(w, self.v), 0, 1) for name, face in self.native.items()}

    def _edge(self, side: int, at: float) -> EdgeDerivatives:
        s = np.array([at])
        place, rate, turn = (self.places(side, s, order)[:, 0] for order in range(3))
        point, slope, bend = (self.sides[side].derivative(place, self.v, order, 0) for order in range(3))
        first = slope * rate[:, None]
        return EdgeDerivatives(point, first, bend * rate[:, None] ** 2 + slope * turn[:, None])


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgeCut:
    """A blade whose edges are cut, as native sides interpolate it."""

    blade: Blade
    meridians: Mapping[str, Curve]
    """of the cuts, by edge, from hub to tip"""
    choices: CutChoices

    @cached_property
    def survey(self) -> EdgeCutRows:
        """Curves from end to end on which knots along u are chosen."""
        return self.sections(survey_places(self.blade.knots.v))

    @property
    def given_spans(self) -> Reals:
        return np.empty(0)

    def breaks_along_u(self) -> Reals:
        knots = self.choices.stretch.knots(self.blade.knots.u, DEGREE)
        return knots[DEGREE + 1 : -DEGREE - 1]

    def breaks_along_v(self) -> Reals:
        return self.blade.knots.v[DEGREE + 1 : -DEGREE - 1]

    def sections(self, v: Reals) -> EdgeCutRows:
        """Curves of constant v (m,)."""
        blade = self.blade
        ends = [
            [self._met(edge, side, v) if edge in self.meridians else np.full(len(v), at) for side in (0, 1)]
            for edge, at in zip(EDGES, (0.0, 1.0), strict=True)
        ]
        first, last = blade.design.ends
        return EdgeCutRows(
            v=v,
            sides=blade.sides,
            native={name: face for name, face in native_faces(blade).items() if name not in self.meridians},
            mirrored=self.choices.mirrored,
            stretch=self.choices.stretch,
            starts=(ends[0][0], ends[0][1]),
            stops=(ends[1][0], ends[1][1]),
            walls=(blade.end_wall(first)[0], blade.end_wall(last)[0]),
            revolved=blade.plain.exact.mapping.revolved,
        )

    def _met(self, edge: str, side: int, v: Reals) -> Array:
        near = self.choices.near[edge][("upper", "lower")[side]]
        return met(self._lines(v)[side], self.meridians[edge], about(v, near), f"cut.{edge}").place

    def _lines(self, v: Reals) -> tuple[Lines, Lines]:
        revolved = self.blade.plain.exact.mapping.revolved
        upper, lower = (Lines(face=side, along="u", at=v, revolved=revolved) for side in self.blade.sides)
        return upper, lower


def cut_edges(blade: Blade, design: "RowDesign", knots: Knots | None, *, fine: bool) -> Blade:
    """The blade with the edges cut that the design's `cut` names."""
    meridians = {edge: meridian_of_cut(blade, design, edge) for edge in EDGES if getattr(design.cut, edge) is not None}
    choices = _chosen(blade, design, meridians) if knots is None or knots.cut is None else knots.cut
    shape = EdgeCut(blade=blade, meridians=meridians, choices=choices)
    walls = {**blade.walls, **{edge: (meridian, inner_knots(meridian)) for edge, meridian in meridians.items()}}
    return recut(shape, blade, design, knots, walls=walls, choices=choices, fine=fine, edges=ON_CUT)


def _chosen(blade: Blade, design: "RowDesign", meridians: Mapping[str, Curve]) -> CutChoices:
    near = {edge: check_edge_cut(blade, design, edge, meridian) for edge, meridian in meridians.items()}
    low, high = between_cuts(design, EDGES, near)
    stretch = stretch_between(low, high, blade.knots.u)
    return CutChoices(stretch=stretch, mirrored=mirrored_edges(blade, meridians), near=near)
