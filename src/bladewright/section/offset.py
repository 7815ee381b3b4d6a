"""Sections on a meanline: a half thickness to both sides, normal to it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.chord_spline import ChordSpline
from bladewright.section.meanline import Meanline
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.power_series import Series, point_derivatives, polynomial, variable
from bladewright.section.thickness.law import EdgeKind, Thickness

SAME_PLACE = 1e-9
"""difference by s, or by the chord fraction, below which two joints are one: above rounding of a root [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class OffsetOutline(Outline):
    """Sides (u - t sin a, v + t cos a) and (u + t sin a, v - t cos a), tan a = v'(u), t the half thickness.

    Reference: Nemnem et al. 2014, eqs. 20 to 22.
    """

    meanline: Meanline
    thickness: Thickness
    multiplier: ChordSpline | None = None
    """by what fraction the half thickness grows along the chord; None: not at all"""
    other_joints: Callable[[], Sequence[Joint]] = tuple
    """joints of meanline and multiplier, where they are at the same s in all sections; found on first use"""

    @cached_property
    def leading_edge(self) -> Edge:
        return self._edge(0.0, self.thickness.leading)

    @cached_property
    def trailing_edge(self) -> Edge:
        return self._edge(1.0, self.thickness.trailing)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        return merged_joints([*self.thickness.joints, *self.other_joints()])

    def points(self, s: Reals) -> tuple[Array, Array]:
        order = np.argsort(s, kind="stable")
        sides = self.at(*self._placed(s[order]))
        back = np.argsort(order)
        return sides[0][..., back, :], sides[1][..., back, :]

    def at(self, u: Array, half: Array) -> tuple[Array, Array]:
        """Points (..., m, k, 2) of both sides at chord fractions u with half thicknesses there."""
        v, slope, _, _ = self.meanline.derivatives(u)
        across = half / np.sqrt(1.0 + slope**2)
        along = slope * across
        return _stacked(u - along, v + across), _stacked(u + along, v - across)

    def half_at(self, u: Reals) -> Array:
        """Half thicknesses (..., m, k) at chord fractions u (k,), the multiplier included."""
        half = self.thickness.half_at(u)
        return half if self.multiplier is None else half * (1.0 + self.multiplier.derivatives(u)[0])

    def camber(self, s: Reals) -> Array:
        order = np.argsort(s, kind="stable")
        u = self.thickness.u(s[order])[..., np.argsort(order)]
        return _stacked(u, self.meanline.derivatives(u)[0])

    def _placed(self, s: Reals) -> tuple[Array, Array]:
        u, half = (each.value for each in self.thickness.series(s, 0))
        return u, half if self.multiplier is None else half * (1.0 + self.multiplier.derivatives(u)[0])

    @property
    def breaks(self) -> Reals:
        """Joints of thickness, meanline and multiplier of a single section."""
        found = [*self.thickness.joints, *fixed_joints(self.thickness, self.meanline.joints, self.meanline.smooth - 1)]
        if self.multiplier is not None:
            found += fixed_joints(self.thickness, self.multiplier.joints, 3)
        return np.array([joint.s for joint in merged_joints(found)])

    @property
    def has_exact_derivatives(self) -> bool:
        """Not with a multiplier, which is not known to third order in closed form."""
        return self.multiplier is None

    def derivatives(self, s: Reals, order: int) -> tuple[Array, Array]:
        """Points and derivatives by s (..., m, k, 2, order + 1) of both sides, exact; s rises, and order is 3 at most.

        With a multiplier, those of the base class.
        """
        if not self.has_exact_derivatives:
            return super().derivatives(s, order)
        upper, lower = self._series(s, order)
        return point_derivatives(*upper), point_derivatives(*lower)

    @property
    def camber_breaks(self) -> Reals:
        """Joints of the meanline, by u."""
        rows = np.real(self.meanline.joints)
        return rows[(0,) * (rows.ndim - 1)]

    def camber_derivatives(self, t: Reals, order: int) -> Array:
        """Points and derivatives by u (..., m, k, 2, order + 1) of the meanline, exact; order is 4 at most."""
        values = np.stack(np.broadcast_arrays(*self.meanline.derivatives(t), self.meanline.fourth(t)), axis=-1)
        u = variable(t, order).derivatives()
        return np.stack(np.broadcast_arrays(u, values[..., : order + 1]), axis=-2)

    def _edge(self, s: float, kind: EdgeKind) -> Edge:
        upper, lower = self._series(np.array([s]), 2)
        starts = [EdgeDerivatives.of_side(point_derivatives(*side)) for side in (upper, lower)]
        return Edge(kind=kind, upper=starts[0], lower=starts[1])

    def _series(self, s: Reals, order: int) -> tuple[tuple[Series, Series], tuple[Series, Series]]:
        """Coordinates of both sides as series of s, the third order without a multiplier only."""
        u, half = self.thickness.series(s, order)
        if self.multiplier is not None:
            half = half * (1.0 + self.multiplier.series(u))
        rates = [*self.meanline.derivatives(u.value)]
        if order > 2:
            rates.append(self.meanline.fourth(u.value))
        step = u - u.value
        v = polynomial([each / factorial(k) for k, each in enumerate(rates[: order + 1])], step)
        tangent = polynomial([each / factorial(k) for k, each in enumerate(rates[1 : order + 2])], step)
        across = half / (1.0 + tangent * tangent).sqrt()
        along = tangent * across
        return (u - along, v + across), (u + along, v - across)


def merged_joints(joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """Joints in order; of several at one place the least smooth, those at an edge left out."""
    found: list[Joint] = []
    for each in sorted(joints):
        if not SAME_PLACE < each.s < 1.0 - SAME_PLACE:
            continue
        if found and each.s - found[-1].s < SAME_PLACE:
            found[-1] = Joint(found[-1].s, min(found[-1].derivatives, each.derivatives))
        else:
            found.append(each)
    return tuple(found)


def fixed_joints(thickness: Thickness, places: Array, derivatives: int) -> tuple[Joint, ...]:
    """The joints at chord fractions (..., m, j) that are at the same s in all sections."""
    if places.shape[-1] == 0:
        return ()
    rows = np.real(places).reshape(-1, places.shape[-1])
    rows = rows[:, np.ptp(rows, axis=0) <= SAME_PLACE]
    if rows.shape[-1] == 0:
        return ()
    table = np.linspace(0.0, 1.0, 129)
    first = np.real(thickness.u(table)).reshape(-1, len(table))[0]
    s = np.interp(rows[0], first, table)
    for _ in range(8):
        value, slope = (np.real(each).reshape(-1, len(s))[0] for each in thickness.series(s, 1)[0].coefficients)
        s = np.clip(s - (value - rows[0]) / np.maximum(slope, SAME_PLACE), 0.0, 1.0)
    u = np.real(thickness.u(s)).reshape(-1, len(s))
    same = np.all(np.square(u - rows[0]) < SAME_PLACE**2, axis=0)
    return tuple(Joint(float(each), derivatives) for each in s[same])


def _stacked(x: Array, y: Array) -> Array:
    return np.stack(np.broadcast_arrays(x, y), axis=-1)
