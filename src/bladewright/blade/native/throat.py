"""The throat: where neighbouring blades come closest, at each place along the span, and the area that it leaves.

The outline of a blade at v is one closed curve, twice differentiable across both edges, run through by s in [0, 2): the
lower side from leading to trailing edge, then the upper side back. The throat's ends P on the outline and Q on the
neighbour's make |w|, w = Q - P, the shortest distance. The flow through the strip dv sees the area t . (w x S_v) dv of
it, t the unit direction of the outlines there and S_v the mean of both outlines' derivatives by v: how P and Q wander
along the outlines with v adds nothing, as that is along t.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.native.knots import DEGREE
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, dot, length, magnitude, unit
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.surface import Surface
from bladewright.section.checks import UNITS
from bladewright.section.closest_pair import Held, Outline, closest_pair, newton_step

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade

PER_SPAN = 4
"""Gauss points in a knot span along v, at which the throat is located."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Throat:
    """The narrowest gap between a blade and its neighbour; complex where the blade is."""

    v: Reals
    """(m,) places along the span, of a Gauss quadrature"""
    width: Array
    """(m,) shortest distance to the neighbour [m]"""
    ends: tuple[Array, Array]
    """its ends (m, 3) on the blade and on the neighbour [m]"""
    places: tuple[Array, Array]
    """where these lie on the outlines (m,): on the lower side at u = s up to s = 1, then on the upper at u = 2 - s"""
    area: Array
    """() of the gap, normal to the flow along the blades, from one end of the blade to the other [m^2]"""


def throat(blade: Blade) -> Throat:
    """The throat between a blade and the next one, one pitch on in theta or y.

    The closest pair is found in real numbers; where the control points or the pitch are complex, one more of Newton's
    steps carries the derivative. Raises DesignError where there is one blade only or neighbours touch.
    """
    v, weight = panels(breaks(blade.knots.v), PER_SPAN)
    row, (own, other) = _row(blade), throat_places(blade, v)
    ends = row.own(own, v), row.neighbour(other, v)
    across = ends[1] - ends[0]
    width = length(across)
    directions = unit(row.own(own, v, 1)), unit(row.neighbour(other, v, 1))
    same = np.where(np.real(dot(*directions)) < 0.0, -1.0, 1.0)[:, None]
    flow = unit(directions[0] + same * directions[1])
    height = (row.own(own, v, 0, 1) + row.neighbour(other, v, 0, 1)) / 2.0
    area = np.sum(weight * magnitude(dot(flow, np.cross(across, height))))
    return Throat(v=v, width=width, ends=ends, places=(own, other), area=np.asarray(area))


def throat_ends(blade: Blade, v: Reals) -> tuple[Array, Array]:
    """The ends (m, 3) [m] of the throat at places v (m,) along the span; raises as `throat` does."""
    row, (own, other) = _row(blade), throat_places(blade, v)
    return row.own(own, v), row.neighbour(other, v)


def throat_places(blade: Blade, v: Reals) -> tuple[Array, Array]:
    """Where these ends lie on the outlines (m,), as `Throat.places` has them."""
    row = _row(blade)
    own, other, held = _closest(*_key(row), v.tobytes())
    across = np.real(row.neighbour(other, v) - row.own(own, v))
    if np.min(length(across)) <= 1e-9 * blade.chord:
        raise DesignError("neighbouring blades touch: they leave no throat; take fewer blades or thinner sections")
    if np.iscomplexobj(row.upper.control_points) or np.iscomplexobj(row.pitch):
        steps = newton_step(*row.outlines(v), (own, other), held)
        own, other = own - steps[0], other - steps[1]
    return own, other


@dataclass(frozen=True, kw_only=True, eq=False)
class _Row:
    """A blade's outline and that of the next blade."""

    upper: Surface
    lower: Surface
    pitch: Array
    """() angle [rad], or distance [m] in a cascade"""
    revolved: bool

    def own(self, s: Array, v: Reals, ds: int = 0, dv: int = 0) -> Array:
        """Points, or derivatives by s and v (m, 3), of the outline at s, v (m,)."""
        s = s - 2.0 * np.floor(np.real(s) / 2.0)
        below = np.real(s) <= 1.0
        lower = self.lower.derivative(s[below], v[below], ds, dv)
        upper = self.upper.derivative(2.0 - s[~below], v[~below], ds, dv)
        found = np.empty((len(s), *lower.shape[1:]), dtype=np.result_type(lower, upper))
        found[below], found[~below] = lower, (-1.0) ** ds * upper
        return found

    def neighbour(self, s: Array, v: Reals, ds: int = 0, dv: int = 0) -> Array:
        """The same of the next blade's outline."""
        return self._moved(self.own(s, v, ds, dv), point=ds + dv == 0)

    def outlines(self, v: Reals) -> tuple[Outline, Outline]:
        """The own and the neighbour's outline at v (m,), by s (..., m) and the order of the derivative."""

        def at(which: Callable[[Array, Reals, int], Array]) -> Outline:
            return lambda s, order: which(s.ravel(), np.broadcast_to(v, s.shape).ravel(), order).reshape(*s.shape, 3)

        return at(self.own), at(self.neighbour)

    def _moved(self, vectors: Array, *, point: bool) -> Array:
        x, y, z = np.moveaxis(vectors, -1, 0)
        if not self.revolved:
            return vectors + np.array([0.0, 1.0, 0.0]) * self.pitch if point else vectors
        sine, cosine = np.sin(self.pitch), np.cos(self.pitch)
        return np.stack([x, y * cosine + z * sine, z * cosine - y * sine], axis=-1)


def _row(blade: Blade) -> _Row:
    design = blade.design
    if design.blade_count == 1:
        raise DesignError("blade_count is 1: a throat lies between two blades; take 2 at least")
    angle = 2.0 * np.pi / design.blade_count if design.blade_count else None
    pitch = UNITS[design.length_unit] * np.asarray(design.pitch) if angle is None else np.asarray(angle)
    upper, lower = blade.sides
    return _Row(upper=upper, lower=lower, pitch=pitch, revolved=angle is not None)


def _key(row: _Row) -> tuple[bytes, bytes, bytes, bytes, float, bool]:
    """The real row, so that builds that carry steps on one design share its search."""
    nets = [np.ascontiguousarray(side.control_points.real).tobytes() for side in (row.upper, row.lower)]
    knots = row.upper.knots_u.tobytes(), row.upper.knots_v.tobytes()
    return nets[0], nets[1], *knots, float(np.real(row.pitch)), row.revolved


@lru_cache(maxsize=8)
def _closest(
    upper: bytes, lower: bytes, knots_u: bytes, knots_v: bytes, pitch: float, revolved: bool, places: bytes
) -> tuple[Reals, Reals, Held]:
    """s (m,) on a real blade's outline and on the next one's, of their closest pair at each v, and which are held."""
    knots = np.frombuffer(knots_u), np.frombuffer(knots_v)
    shape = (*(len(each) - DEGREE - 1 for each in knots), 3)
    sides = [
        Surface(
            control_points=np.frombuffer(net).reshape(shape),
            knots_u=knots[0],
            knots_v=knots[1],
            degree_u=DEGREE,
            degree_v=DEGREE,
        )
        for net in (upper, lower)
    ]
    row, v = _Row(upper=sides[0], lower=sides[1], pitch=np.asarray(pitch), revolved=revolved), np.frombuffer(places)
    own, other, held = closest_pair(*row.outlines(v), len(v))
    for each in (own, other, *held):
        each.setflags(write=False)
    return own, other, held
