"""Sections on camber lines by their angle: half thickness by a NURBS in place and height, normal to the camber."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_angle_line import AngleLine
from bladewright.section.offset import merged
from bladewright.section.outline import Edge, Joint, Outline, Start
from bladewright.section.profiles.analytic import composed, waves
from bladewright.section.spline_pieces import SplinePieces
from bladewright.section.thickness.series import Series, variable

APART = 1e-9
"""distance by s below which a joint stands at the same place in all sections"""
STEEPEST = 6.0
"""how much a thickness may bend upwards beside a round edge, for which s is bent the other way"""


@dataclass(frozen=True, kw_only=True, eq=False)
class AngleOutline(Outline):
    """Sections (...) whose sides follow the thickness NURBS by its own parameter t.

    Beside a round edge s is bent into t, so that the thickness has no second derivative by s there: then the sides'
    second derivatives are equal.
    """

    line: AngleLine
    places: SplinePieces
    """w x of the thickness, x the fraction of m'"""
    heights: SplinePieces
    """w h of the thickness, h the half thickness in chords"""
    weights: SplinePieces
    """w of the thickness"""
    end: Literal["sharp", "blunt", "round"]

    @property
    def leading_edge(self) -> Edge:
        """Round."""
        return self._edge(0.0, "round")

    @property
    def trailing_edge(self) -> Edge:
        """Sharp, blunt or round."""
        return self._edge(1.0, self.end)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Knots of the thickness, and those of the camber angle that stand at the same s in all sections."""
        found = [Joint(float(each), 2) for each in self.places.ends[1:-1]]
        knots = self.line.knots
        count = knots.shape[-1]
        for j in range(count):
            s = self._where(knots[..., j])
            if np.ptp(s) <= APART:
                found.append(Joint(float(np.mean(s)), 2))
        return merged(found)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        upper, lower = self._sides(s, 0)
        return upper[..., 0], lower[..., 0]

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the camber line."""
        x, _ = self._thickness(s, 0)
        return np.stack(np.broadcast_arrays(*(each.value for each in self._laid(x))), axis=-1)

    def derivatives(self, s: Reals, order: int) -> tuple[Array, Array]:
        """Points and derivatives by s (..., k, 2, order + 1) of both sides, exact."""
        upper, lower = self._sides(s, order)
        return upper, lower

    @property
    def camber_breaks(self) -> Reals:
        """Knots of the camber angle, by the fraction of m'."""
        rows = np.real(self.line.knots)
        return rows[(0,) * (rows.ndim - 1)]

    def camber_derivatives(self, t: Reals, order: int) -> Array:
        """Points and derivatives by the fraction of m' (..., k, 2, order + 1) of the camber line, exact."""
        pair = (each.derivatives() for each in self._laid(variable(t, order)))
        return np.stack(np.broadcast_arrays(*pair), axis=-2)

    def _sides(self, s: Reals, order: int) -> list[Array]:
        """Points and their derivatives by s, (..., k, 2, order + 1), of both sides."""
        x, height = self._thickness(s, order)
        along, across = self._laid(x)
        # beta is smooth by x, but not at a knot that an edge touches: composed there from its own side
        turning = composed(self.line.turning(variable(x.value, order)), x) - self.line.stagger[..., None]
        sine, cosine = waves(turning)
        sides = []
        for sign in (1.0, -1.0):
            pair = [(along - sine * height * sign).derivatives(), (across + cosine * height * sign).derivatives()]
            sides.append(np.stack(np.broadcast_arrays(*pair), axis=-2))
        return sides

    def _laid(self, x: Series) -> tuple[Series, Series]:
        """Camber points at x, turned and scaled so that the chord line runs from (0, 0) to (1, 0)."""
        total = self.line.total[..., None]
        rise = self.line.rise(x)
        square = 1.0 + total * total
        return (x + rise * total) / square, (rise - x * total) / square

    def _thickness(self, s: Reals, order: int) -> tuple[Series, Series]:
        """Fraction x of m' and half thickness [chords] at s (k,), (..., k) each."""
        piece = self.places.piece(s)
        t = self._parameter(s, piece, order)
        weight = self.weights.values(t, piece)
        return self.places.values(t, piece) / weight, self.heights.values(t, piece) / weight

    def _parameter(self, s: Reals, piece: Array, order: int) -> Series:
        """The NURBS's parameter: s, bent in the pieces beside round edges."""
        at = variable(s, order)
        first, last = self._bends
        width = float(self.places.ends[1])
        near = at * (1.0 / width)
        rest = 1.0 - near
        found = at - near * near * rest * rest * rest * (first[..., None] * width) * np.where(piece == 0, 1.0, 0.0)
        if last is None:
            return found
        near = (1.0 - at) * (1.0 / width)
        rest = 1.0 - near
        there = np.where(piece == len(self.places.ends) - 2, 1.0, 0.0)
        return found + near * near * rest * rest * rest * (last[..., None] * width) * there

    @cached_property
    def _bends(self) -> tuple[Array, Array | None]:
        """h'' / (2 h') times the width of a piece, at the leading and at a round trailing edge (...)."""
        width = float(self.places.ends[1])
        last = self._bend(1.0, -width, "trailing") if self.end == "round" else None
        return self._bend(0.0, width, "leading"), last

    def _bend(self, place: float, width: float, name: str) -> Array:
        at, piece = variable(np.array([place]), 2), self.places.piece(np.array([place]))
        height = self.heights.values(at, piece) / self.weights.values(at, piece)
        bend: Array = (height.coefficients[2] / height.coefficients[1])[..., 0] * width
        if np.any(np.real(bend) > STEEPEST):
            raise DesignError(
                f"half_thickness rises beside the {name} edge to {2.0 * np.max(np.real(bend)) + 3.0:.3g} times its "
                f"value at the edge: at most {2.0 * STEEPEST + 3.0:g} times; raise the value at the edge"
            )
        return bend

    def _where(self, x: Reals) -> Reals:
        """s (...) at which real fractions (...) of m' stand."""
        shape = np.broadcast_shapes(x.shape, self.places.controls.shape[:-1], self._bends[0].shape)
        own = np.arange(int(np.prod(shape)))

        def off(s: Array) -> tuple[Array, Array]:
            found, _ = self._thickness(s, 1)
            rows = [np.broadcast_to(np.real(each), (*shape, len(s))).reshape(-1, len(s)) for each in found.coefficients]
            # each section at its own s
            return rows[0][own, own] - np.broadcast_to(x, shape).ravel(), rows[1][own, own]

        return bracketed_root(off, np.zeros(len(own)), np.ones(len(own))).reshape(shape)

    def _edge(self, s: float, kind: Literal["sharp", "blunt", "round"]) -> Edge:
        starts = [Start(*(side[..., 0, :, k] for k in range(3))) for side in self._sides(np.array([s]), 2)]
        return Edge(kind=kind, upper=starts[0], lower=starts[1])
