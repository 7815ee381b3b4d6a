"""Knots of the native sides: where the exact blade loses derivatives, and wherever else the tolerance asks for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bladewright.blade.native.stretch import CutChoices
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import frozen
from bladewright.nurbs.basis import Reals, greville

DEGREE = 5
"""Degree of the native sides along u and v: four derivatives are continuous at single knots, and the error falls
with the sixth power of the knot spacing, as tests/blade/test_native.py observes. A higher one would need more poles
in each knot span."""
MOST_POLES = (200, 100)
"""Control points of a side along u and v above which a design is refused: CAD files and programs slow down with
their number. Of 2,000 random designs 31 were refused for it (design/random_designs.md)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Knots(FrozenRecord):
    """Knots of both sides of a blade, over [0, 1]; they fix the interpolation sites."""

    u: Reals
    v: Reals
    tip: Reals | None = None
    """of the meridian of its clearance surface, where it has one"""
    sections: Reals | None = None
    """places along v that are interpolated besides, as far as there are sites near them"""

    bent_from: float | None = None
    """height from the uncut end, in v, at which curves of constant v begin to bend to a cut, where there is one"""
    cut: CutChoices | None = None
    """what the cut of the blade before chose, where there is one"""
    before: Knots | None = None
    """of the blade that this one was cut or filleted from; None of a plain one"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "u", frozen(self.u))
        object.__setattr__(self, "v", frozen(self.v))
        if self.tip is not None:
            object.__setattr__(self, "tip", frozen(self.tip))
        if self.sections is not None:
            object.__setattr__(self, "sections", frozen(self.sections))

    @property
    def chain(self) -> tuple[Knots, ...]:
        """Those of the plain blade, of the blade after its first cut, and so on to its own."""
        return (self,) if self.before is None else (*self.before.chain, self)

    @property
    def sites_u(self) -> Reals:
        """Places along u where the sides are interpolated, besides two derivatives at each edge."""
        return greville(self.u, DEGREE)[3:-3]

    @property
    def sites_v(self) -> Reals:
        """Places along v where the sides are interpolated."""
        return sites_through(self.v, self.sections)

    @property
    def poles(self) -> tuple[int, int]:
        """Control points along u and v."""
        return len(self.u) - DEGREE - 1, len(self.v) - DEGREE - 1


def sites_through(knots: Reals, places: Reals | None) -> Reals:
    """Places where a spline is interpolated: Greville's abscissae, of which the nearest are moved to given places.

    One is not moved where it would leave the stretch on which its basis function is not zero, without which there is no
    spline, or where another place has moved it already.
    """
    sites = np.array(greville(knots, DEGREE))
    moved = {0, len(sites) - 1}
    for place in () if places is None else np.sort(places):
        if place in sites:
            continue
        i = int(np.argmin(np.square(sites - place)))
        if i not in moved and knots[i] < place < knots[i + DEGREE + 1] and sites[i - 1] < place < sites[i + 1]:
            sites[i] = place
            moved.add(i)
    return sites


def clamped(inner: Reals) -> Reals:
    """A clamped knot vector over [0, 1] with the given inner knots."""
    return np.concatenate([np.zeros(DEGREE + 1), np.sort(inner), np.ones(DEGREE + 1)])


def refined(knots: Reals, miss: Callable[[Reals, Reals], Reals], most: int) -> Reals:
    """Knots whose spans are divided until `miss`, evaluated inside each, is below 1 everywhere.

    `miss(knots, places)` gives the error over the tolerance at places (k,). A span is cut in as many pieces as
    the order of convergence, DEGREE + 1, predicts. Stops at `most` poles, or where cutting does not help.
    """
    for _ in range(8):
        spans = np.unique(knots)
        places = np.concatenate([spans[:-1] + share * np.diff(spans) for share in _SHARES])
        order = np.argsort(places)
        errors = np.empty_like(places)
        errors[order] = miss(knots, places[order])
        worst = np.max(errors.reshape(len(_SHARES), -1), axis=0)
        if np.all(worst < 1.0) or len(knots) - DEGREE - 1 > most:
            return knots
        pieces = np.where(worst < 1.0, 1, np.ceil((worst / 0.5) ** (1.0 / (DEGREE + 1)))).astype(int)
        pieces = np.clip(pieces, 1, 4)
        added = [
            start + (end - start) * np.arange(1, count) / count
            for start, end, count in zip(spans[:-1], spans[1:], pieces, strict=True)
        ]
        knots = np.sort(np.concatenate([knots, *added]))
    return knots


_SHARES = (0.2, 0.5, 0.8)
"""Places in a knot span at which the error is looked at."""
