"""The line that crosses all stream lines at right angles: each of its points is the nearest to the one below it."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import Reals

NODES = 24
"""Chebyshev nodes at which the differential equation holds, on each piece of the span."""
PIECES = 8
"""Pieces of the span to begin with, before those that end at joints of the stream lines: so short that the
polynomial through the nodes is exact to rounding on smooth flow paths."""
STEPS = 30
"""Newton steps on a piece; mostly five suffice."""
SAME = 1e-9
"""Span fraction within which a joint of the stream lines counts as the end of a piece: rounding."""
ROUNDING = 1e-9
"""Share of the flow path by which the trajectory may run past its ends, as rounding makes it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OrthogonalTrajectory:
    """t(v) of the line through a point of the hub at right angles to the stream lines, in pieces."""

    ends: Reals
    """(p + 1,) of the pieces in v: where stream lines lose derivatives along it, among them"""
    series: Array
    """(..., p, NODES) Chebyshev series of t on each piece"""
    joints: Reals
    """v where it passes joints of the stream lines"""

    def t(self, v: Reals) -> Array:
        """t (..., m) at v (m,)."""
        piece = np.clip(np.searchsorted(self.ends, v, side="right") - 1, 0, len(self.ends) - 2)
        low, high = self.ends[piece], self.ends[piece + 1]
        values = chebyshev.chebvander((2.0 * v - low - high) / (high - low), NODES - 1)
        return np.asarray(np.einsum("mk,...mk->...m", values, self.series[..., piece, :]))


def orthogonal_trajectory(surfaces: StreamSurfaces, start: Array) -> OrthogonalTrajectory:
    """The line from t = `start` (...) of the hub, integrated to rounding.

    The nearest point of the stream line at v + dv to one at (t, v) lies where dt/dv = -(P_v . P_t) / (P_t . P_t), with
    P(t, v) = (x, r); solved by collocation at Chebyshev points, piece by piece, pieces ending where stream lines lose
    derivatives. Raises DesignError where it leaves the flow path.
    """
    real = surfaces.real()
    levels = np.concatenate([surfaces.joints(), [0.0, 1.0]])
    levels = levels[(levels > surfaces.low) & (levels < surfaces.high)]
    pending = np.unique([*np.linspace(0.0, 1.0, PIECES + 1), *surfaces.span_joints()]).tolist()
    at: Array = np.asarray(start)
    ends, pieces, joints = [0.0], [], []
    while len(pending) > 1:
        low, high = pending[0], pending[1]
        for _ in range(STEPS):
            places = _solved(real, float(real_first(at, 0)), low, high)
            _check(surfaces, places, low, high)
            met = _first_met(places, levels, low, high)
            if met is None or high - met < SAME:
                break
            high = met
            joints.append(met)
        values = _carried(surfaces, at, places, low, high)
        pieces.append(values @ _TO_SERIES.T)
        at = values[..., -1]
        ends.append(high)
        pending = [high, *(end for end in pending if end > high + SAME)]
    return OrthogonalTrajectory(
        ends=np.array(ends), series=np.stack(pieces, axis=-2), joints=np.array([j for j in joints if j in ends])
    )


def _solved(surfaces: StreamSurfaces, start: float, low: float, high: float) -> Reals:
    """Real t at the places of a piece."""
    v = low + (high - low) * _PLACES
    t = np.full(NODES, start)
    for _ in range(STEPS):
        rate, growth = _rate(surfaces, t, v)
        miss = t - start - (high - low) * (_INTEGRAL @ np.real(rate))
        step = np.linalg.solve(np.eye(NODES) - (high - low) * _INTEGRAL * growth, miss)
        # what overshoots is brought back to where there are stream lines
        t = np.clip(t - step, surfaces.low - 1.0, surfaces.high + 1.0)
        if np.max(np.square(step)) < 1e-30 * (surfaces.high - surfaces.low) ** 2:
            break
    return t


def _carried(surfaces: StreamSurfaces, start: Array, t: Reals, low: float, high: float) -> Array:
    """The same with the derivatives that start and surfaces carry: one more of Newton's steps, in complex numbers."""
    v = low + (high - low) * _PLACES
    rate, growth = _rate(surfaces, t, v)
    miss = t - start[..., None] - (high - low) * (rate @ _INTEGRAL.T)
    if not np.iscomplexobj(miss):
        return t
    inverse = np.linalg.inv(np.eye(NODES) - (high - low) * _INTEGRAL * growth)
    return np.asarray(t - 1j * (np.imag(miss) @ inverse.T))


def _rate(surfaces: StreamSurfaces, t: Reals, v: Reals) -> tuple[Array, Reals]:
    """dt/dv (..., m), and its real derivative by t (m,)."""
    _, along, across = surfaces.at(t, v)
    bend, mixed = (real_first(each, 2) for each in surfaces.bends(t, v))
    rate = -dot(across, along) / dot(along, along)
    a, b = real_first(along, 2), real_first(across, 2)
    growth = -(dot(mixed, a) + dot(b, bend) + 2.0 * real_first(rate, 1) * dot(a, bend)) / dot(a, a)
    return rate, growth


def _first_met(places: Reals, levels: Reals, low: float, high: float) -> float | None:
    """The first v inside a piece, past its start, at which t passes a level."""
    series = _TO_SERIES @ places
    found = []
    for level in levels:
        roots = chebyshev.chebroots(np.concatenate([[series[0] - level], series[1:]]))
        near = np.real(roots[np.abs(np.imag(roots)) < 1e-9])  # real: places are the real design's
        inside = low + (high - low) * (1.0 + near) / 2.0
        found += [v for v in inside if low + SAME < v <= high]
    return float(min(found)) if found else None


def _check(surfaces: StreamSurfaces, places: Reals, low: float, high: float) -> None:
    margin = ROUNDING * (surfaces.high - surfaces.low)
    past = np.maximum(surfaces.low - places, places - surfaces.high)
    if np.max(past) <= margin:
        return
    i = int(np.argmax(past > margin))
    end = "upstream" if places[i] < surfaces.low else "downstream"
    raise DesignError(
        f"stacking.onwards is 'least-distance', and the line from the hub's reference point that crosses the stream "
        f"lines at right angles leaves the flow path at its {end} end, at v = {low + (high - low) * _PLACES[i]:.3f}: "
        "move the point at the hub away from that end, or lengthen hub and shroud there"
    )


def _integral() -> Reals:
    """Integrals (NODES, NODES) from 0 to the places of [0, 1] of the polynomial through values there."""
    rows = [chebyshev.chebint(row, lbnd=-1.0) for row in _TO_SERIES.T]
    return np.stack([chebyshev.chebval(_ON, row) / 2.0 for row in rows], axis=1)


_ON = -np.cos(np.pi * np.arange(NODES) / (NODES - 1))
_PLACES = (1.0 + _ON) / 2.0
_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_ON, NODES - 1))
_INTEGRAL = _integral()
