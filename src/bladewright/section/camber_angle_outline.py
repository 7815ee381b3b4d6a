"""Sections on camber lines of given angle: the camber line is an exact integral, the half thickness a NURBS."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_by_angle import CamberByAngle, SplinePieces
from bladewright.section.offset import merged_joints
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.power_series import Series, composed, point_derivatives, sine_and_cosine, variable

SAME_PLACE = 1e-9
"""difference by s below which a joint is at the same place in all sections: above rounding of a root, below any
movement that a design shows [-]"""
STEEPEST = 6.0
"""largest h'' / (2 h') times the width of a piece beside a round edge, h the half thickness, for which s is bent the
other way: the bent parameter is monotone up to 7.3, and at this limit its slope stays above 0.18 [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberAngleOutline(Outline):
    """Sections (...) whose sides follow the thickness NURBS by its own parameter t.

    Beside a round edge s is bent into t, so that the thickness has no second derivative by s there: then the sides'
    second derivatives are equal.
    """

    line: CamberByAngle
    places: SplinePieces
    """w x of the thickness, x the fraction of m'"""
    heights: SplinePieces
    """w h of the thickness, h the half thickness in chords"""
    weights: SplinePieces
    """w of the thickness"""
    end: Literal["sharp", "blunt", "round"]

    @cached_property
    def leading_edge(self) -> Edge:
        """Round."""
        return self._edge(0.0, "round")

    @cached_property
    def trailing_edge(self) -> Edge:
        """Sharp, blunt or round."""
        return self._edge(1.0, self.end)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Knots of the thickness, and those of the camber angle that are at the same s in all sections."""
        found = [Joint(float(each), 2) for each in self.places.ends[1:-1]]
        knots = self.line.knots
        count = knots.shape[-1]
        for j in range(count):
            s = self._where(knots[..., j])
            if np.ptp(s) <= SAME_PLACE:
                found.append(Joint(float(np.mean(s)), 2))
        return merged_joints(found)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        upper, lower = self._sides(s, 0)
        return upper[..., 0], lower[..., 0]

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the camber line."""
        x, _ = self._thickness(s, 0)
        return np.stack(np.broadcast_arrays(*(each.value for each in self._in_chords(x))), axis=-1)

    @property
    def has_exact_derivatives(self) -> bool:
        return True

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
        return point_derivatives(*self._in_chords(variable(t, order)))

    def _sides(self, s: Reals, order: int) -> list[Array]:
        """Points and their derivatives by s, (..., k, 2, order + 1), of both sides."""
        x, height = self._thickness(s, order)
        along, across = self._in_chords(x)
        # beta is smooth by x, but not at a knot that an edge touches: composed there from its own side
        turning = composed(self.line.turning(variable(x.value, order)), x) - self.line.stagger[..., None]
        sine, cosine = sine_and_cosine(turning)
        offset = sine * height, cosine * height
        return [point_derivatives(along - offset[0] * sign, across + offset[1] * sign) for sign in (1.0, -1.0)]

    def _in_chords(self, x: Series) -> tuple[Series, Series]:
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

    def _parameter(self, s: Reals, piece: NDArray[np.intp], order: int) -> Series:
        """The NURBS's parameter: s, bent in the pieces beside round edges."""
        at = variable(s, order)
        first, last = self.bends
        width = float(self.places.ends[1])
        near = at * (1.0 / width)
        rest = 1.0 - near
        found = at - near * near * rest * rest * rest * (first[..., None] * width) * np.where(piece == 0, 1.0, 0.0)
        if last is None:
            return found
        near = (1.0 - at) * (1.0 / width)
        rest = 1.0 - near
        in_last_piece = np.where(piece == len(self.places.ends) - 2, 1.0, 0.0)
        return found + near * near * rest * rest * rest * (last[..., None] * width) * in_last_piece

    @cached_property
    def bends(self) -> tuple[Array, Array | None]:
        """h'' / (2 h') times the width of a piece, at the leading and at a round trailing edge (...)."""
        width = float(self.places.ends[1])
        return self._bend(0.0, width), self._bend(1.0, -width) if self.end == "round" else None

    def _bend(self, place: float, width: float) -> Array:
        at, piece = variable(np.array([place]), 2), self.places.piece(np.array([place]))
        height = self.heights.values(at, piece) / self.weights.values(at, piece)
        return np.asarray((height.coefficients[2] / height.coefficients[1])[..., 0] * width)

    def check_limits(self, where: Sequence[str]) -> None:
        for name, bend in zip(("leading", "trailing"), self.bends, strict=True):
            if bend is None or not np.any(np.real(bend) > STEEPEST):
                continue
            steepest = np.broadcast_to(np.real(bend), len(where))
            worst = int(np.argmax(steepest))
            raise DesignError(
                f"half_thickness rises beside the {name} edge{where[worst]} to {2.0 * steepest[worst] + 3.0:.3g} times "
                f"its value at the edge: at most {2.0 * STEEPEST + 3.0:g} times; raise the value at the edge"
            )

    def _where(self, x: Reals) -> Reals:
        """s (...) of real fractions (...) of m'."""
        shape = np.broadcast_shapes(x.shape, self.places.controls.shape[:-1], self.bends[0].shape)
        own = np.arange(int(np.prod(shape)))

        def residual(s: Array) -> tuple[Array, Array]:
            found, _ = self._thickness(s, 1)
            rows = [np.broadcast_to(np.real(each), (*shape, len(s))).reshape(-1, len(s)) for each in found.coefficients]
            # each section at its own s
            return rows[0][own, own] - np.broadcast_to(x, shape).ravel(), rows[1][own, own]

        return bracketed_root(residual, np.zeros(len(own)), np.ones(len(own))).reshape(shape)

    def _edge(self, s: float, kind: Literal["sharp", "blunt", "round"]) -> Edge:
        upper, lower = (EdgeDerivatives.of_side(side) for side in self._sides(np.array([s]), 2))
        return Edge(kind=kind, upper=upper, lower=lower)
