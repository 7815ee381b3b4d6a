"""Where straight lines in space cross stream surfaces, with derivatives along what the lines start from."""

from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from bladewright.blade.meridian_line import real_first
from bladewright.blade.stream_surfaces import StreamSurfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import Reals

STEPS = 60
"""Newton's steps after which no crossing is expected; mostly five do"""
LONGEST = 0.5
"""largest step in t, of the flow path, and in shares of a line"""


class Rate(NamedTuple):
    """How a crossing moves with its line's start."""

    point: Array
    """(..., m, 3)"""
    t: Array
    """(..., m)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossed:
    """Where lines start + share * direction cross the stream surfaces at v (m,)."""

    surfaces: StreamSurfaces
    v: Reals
    direction: Array
    """(..., 3)"""
    point: Array
    """(..., m, k, 3)"""
    t: Array
    """(..., m, k) along the stream surface"""
    revolved: bool

    def carried(self, first: Array, second: Array) -> tuple[Rate, Rate]:
        """First and second derivatives of the first of the lines' crossings, from those of its start (..., 1, 3).

        By differentiating W(t) = start + share * direction, W on the stream surface, twice.
        """
        point, direction = self.point[..., 0, :], self.direction[..., None, :]
        t = self.t[..., :1]
        place, slope, bend = (at_complex(partial(self.surfaces.position, self.v), t, k)[..., 0, :] for k in range(3))
        matrix = _matrix(place, slope, point, direction, revolved=self.revolved)
        share, rate = _solved(matrix, _height(point, first, revolved=self.revolved))
        step = first + share[..., None] * direction
        right = _height(point, second, revolved=self.revolved) - np.stack(
            [bend[..., 0] * rate**2, _lifted(place, slope, bend, revolved=self.revolved) * rate**2], axis=-1
        )
        if self.revolved:
            right = right + np.stack([np.zeros_like(rate), dot(step[..., 1:], step[..., 1:])], axis=-1)
        again, rate_again = _solved(matrix, right)
        return Rate(step, rate), Rate(second + again[..., None] * direction, rate_again)


def crossed_surfaces(
    surfaces: StreamSurfaces, v: Reals, start: Array, direction: Array, near: Reals, *, revolved: bool
) -> Crossed:
    """Where lines from points (..., k, 3) of the hub, near t (k,), in a direction (..., 3) cross the stream surfaces.

    Raises DesignError where one leaves the flow path before.
    """
    position = partial(surfaces.position, v)
    begin, along = real_first(start, 2), real_first(direction, 1)
    share = np.broadcast_to(v[:, None], (len(v), len(near))).copy()
    t = np.broadcast_to(near, share.shape).copy()
    low, high = surfaces.extent
    for _ in range(STEPS):
        point = begin + share[..., None] * along
        place, slope = (real_first(position(t, k), 3) for k in (0, 1))
        miss = _miss(place, point, revolved=revolved)
        by_share, by_t = _solved(_matrix(place, slope, point, along, revolved=revolved), miss)
        share = share + np.clip(by_share, -LONGEST, LONGEST)
        t = np.clip(t + np.clip(by_t, -LONGEST * (high - low), LONGEST * (high - low)), low, high)
        if np.max(np.square(by_share)) < 1e-28:
            break
    _check(v, begin, along, by_share, t, (low, high))
    if not (np.iscomplexobj(start) or np.iscomplexobj(direction) or np.iscomplexobj(position(t, 0))):
        return Crossed(surfaces=surfaces, v=v, direction=direction, point=point, t=t, revolved=revolved)
    point = start[..., None, :, :] + share[..., None] * direction[..., None, None, :]
    place, slope = position(t, 0), position(t, 1)
    miss = _miss(place, point, revolved=revolved)
    by_share, by_t = _solved(_matrix(place, slope, point, direction[..., None, None, :], revolved=revolved), miss)
    moved = share + by_share
    point = start[..., None, :, :] + moved[..., None] * direction[..., None, None, :]
    return Crossed(surfaces=surfaces, v=v, direction=direction, point=point, t=t + by_t, revolved=revolved)


def at_complex(position: partial[Array], t: Array, order: int) -> Array:
    """Points or derivatives (..., m, k, 2) at t (..., m, k) that may carry an imaginary step."""
    real = real_first(t, 2)
    found: Array = position(real, order)
    if not np.iscomplexobj(t):
        return found
    return found + (t - real)[..., None] * position(real, order + 1)


def _height(point: Array, vector: Array, *, revolved: bool) -> Array:
    """What a vector (..., 3) at a point adds to (x, r^2 / 2), or (x, z) in a cascade (..., 2)."""
    rise = dot(point[..., 1:], vector[..., 1:]) if revolved else vector[..., 2] + 0.0 * point[..., 2]
    return np.stack(np.broadcast_arrays(vector[..., 0], rise), axis=-1)


def _miss(place: Array, point: Array, *, revolved: bool) -> Array:
    rise = (
        (dot(point[..., 1:], point[..., 1:]) - place[..., 1] ** 2) / 2.0 if revolved else point[..., 2] - place[..., 1]
    )
    return np.stack(np.broadcast_arrays(point[..., 0] - place[..., 0], rise), axis=-1)


def _matrix(place: Array, slope: Array, point: Array, direction: Array, *, revolved: bool) -> tuple[Array, Array]:
    """Derivatives (..., 2) of x and r^2 / 2, or z, by the share of the line and by t."""
    lift = slope[..., 1] * (place[..., 1] if revolved else 1.0)
    return _height(point, direction, revolved=revolved), np.stack([slope[..., 0], lift], axis=-1)


def _lifted(place: Array, slope: Array, bend: Array, *, revolved: bool) -> Array:
    """The second derivative of r^2 / 2, or z, by t."""
    return slope[..., 1] ** 2 + place[..., 1] * bend[..., 1] if revolved else bend[..., 1]


def _solved(matrix: tuple[Array, Array], miss: Array) -> tuple[Array, Array]:
    """Steps of share and t for which share * first - t * second = -miss."""
    first, second = matrix
    turn = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    with np.errstate(all="ignore"):
        share = (miss[..., 1] * second[..., 0] - miss[..., 0] * second[..., 1]) / turn
        t = (first[..., 0] * miss[..., 1] - first[..., 1] * miss[..., 0]) / turn
    return share, t


def _check(v: Reals, begin: Reals, along: Reals, steps: Reals, t: Reals, extent: tuple[float, float]) -> None:
    lost = ~(np.square(steps) < 1e-18)
    if not np.any(lost):
        return
    row, at = np.argwhere(lost)[0]
    where = ", ".join(f"{each:.5g}" for each in begin[at])
    run = ", ".join(f"{each:.4g}" for each in along)
    past = "past the end of the flow path" if t[row, at] in extent else "nowhere"
    raise DesignError(
        f"skinning is 'developable', and the straight line from the hub's section at ({where}) m in the direction "
        f"({run}) m meets the stream surface at v = {v[row]:.3f} {past}: all its lines run parallel to that from the "
        "hub's to the shroud's reference point; let them stand steeper on the walls by lean, sweep or stacking, "
        "lengthen hub and shroud, or take skinning = 'ruled'"
    )
