"""Thickness laws made of pieces along the chord, each a closed formula of the chord fraction."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.chord_map import Breakpoint, ChordMap, ChordPlace
from bladewright.section.laws import Span
from bladewright.section.outline import Joint
from bladewright.section.power_series import Series, joined_series, polynomial
from bladewright.section.thickness.law import EdgeKind, Thickness

Formula = Callable[[ChordPlace], Series]
"""half thickness at a place; one that pickles, not a function inside another"""

PLACES = np.linspace(0.0, 1.0, 97)[1:-1]
"""s at which the half thickness must be positive: 95 places for formulas of a few pieces, each without waves of its
own"""


class PiecewiseThickness(Thickness):
    """One formula for each piece between the breaks of the chord map."""

    def __init__(
        self, chord_map: ChordMap, pieces: Sequence[Formula], *, leading: EdgeKind, trailing: EdgeKind
    ) -> None:
        self._chord_map, self._formulas = chord_map, tuple(pieces)
        self._leading, self._trailing = leading, trailing

    @property
    def joints(self) -> tuple[Joint, ...]:
        return self._chord_map.joints

    @property
    def leading(self) -> EdgeKind:
        return self._leading

    @property
    def trailing(self) -> EdgeKind:
        return self._trailing

    def series(self, s: Reals, order: int) -> tuple[Series, Series]:
        found = [(k, self._chord_map.place(k, part, order)) for k, part in self._chord_map.pieces_of(s)]
        half = joined_series([self._formulas[k](place) for k, place in found])
        return joined_series([place.u for _, place in found]), half

    def half_at(self, u: Reals) -> Array:
        zero = Series([np.zeros(())])
        place = ChordPlace(zero + u, zero + (1.0 - u), zero + np.sqrt(u), zero + np.sqrt(1.0 - u))
        half = _safely(self._formulas[0], place)
        for k, each in enumerate(self._chord_map.breaks):
            later = np.real(u) > np.real(each.u)[..., None]
            half = np.where(later, _safely(self._formulas[k + 1], place), half)
        return half

    def with_breakpoints(self, further: Sequence[Breakpoint]) -> Thickness:
        own = self._chord_map.breaks
        breaks = sorted((*own, *further), key=lambda each: each.sigma)
        places = np.stack(np.broadcast_arrays(*[np.real(each.u) for each in breaks]))
        if np.any(np.diff(places, axis=0) <= 0.0):
            raise ValueError("breaks change their order")
        owners = [sum(each.sigma <= start for each in own) for start in (0.0, *(each.sigma for each in breaks))]
        ends = self._chord_map
        chord_map = ChordMap(breaks, leading_round=ends.leading_round, trailing_round=ends.trailing_round)
        last = len(owners) - 1
        formulas = [_anywhere(self._formulas[k], front=i > 0, rear=i < last) for i, k in enumerate(owners)]
        return PiecewiseThickness(chord_map, formulas, leading=self._leading, trailing=self._trailing)


def _anywhere(formula: Formula, *, front: bool, rear: bool) -> Formula:
    """A formula for a part of its piece that no longer touches the edge: it takes the root of the distance itself."""
    return partial(_with_roots, formula, front, rear)


def _with_roots(formula: Formula, front: bool, rear: bool, place: ChordPlace) -> Series:
    place = place._replace(root=place.u.sqrt()) if front else place
    return formula(place._replace(rest_root=place.rest.sqrt()) if rear else place)


def _safely(formula: Formula, place: ChordPlace) -> Array:
    """Values of a formula outside its piece as well, where they are not used."""
    with np.errstate(invalid="ignore"):
        return formula(place).value


def polynomial_from(coefficients: Sequence[Array], start: Array, place: ChordPlace) -> Series:
    """The polynomial of the distance from a chord fraction."""
    return polynomial(coefficients, place.u - start)


def ellipse(length: Array, height: Array, *, leading: bool) -> Formula:
    """The round end of semi-axes `length` along the chord and `height` across (..., m), its tip at the edge."""
    ratio, diameter = (height / length)[..., None], 2.0 * length[..., None]
    return partial(_leading_ellipse if leading else _trailing_ellipse, ratio, diameter)


def _leading_ellipse(ratio: Array, diameter: Array, place: ChordPlace) -> Series:
    return ratio * place.leading_root() * (diameter - place.u).sqrt()


def _trailing_ellipse(ratio: Array, diameter: Array, place: ChordPlace) -> Series:
    return ratio * place.trailing_root() * (diameter - place.rest).sqrt()


def check_positive(thickness: Thickness, path: str, span: Span) -> None:
    """Refuse a half thickness that is not positive inside a section; raises DesignError with the place."""
    u, half = (np.real(each.value) for each in thickness.series(PLACES, 0))
    u, half = np.broadcast_arrays(u, half)
    if np.all(half > 0.0):
        return
    worst = np.unravel_index(np.argmin(half), half.shape)
    place = span.v[worst[-2]] if half.shape[-2] == len(span.v) else span.v[0]
    raise DesignError(
        f"{path} gives a half thickness of {half[worst]:.3g} chords at u = {u[worst]:.3g}, span fraction {place:.4g}: "
        f"it must be positive; raise the maximum thickness or the thickness of the edge nearby"
    )
