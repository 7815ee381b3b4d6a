"""Meridians of straight pieces and the arcs that round the corners between them."""

from math import factorial

import numpy as np

from bladewright.blade.meridian_line import MeridianLine, joined_net, real_first
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, length, unit
from bladewright.nurbs.basis import Reals

ARC = np.pi / 8.0
"""largest angle of a piece of an arc [rad]"""
ARC_DEGREE = 11
"""degree of a piece of an arc: the series of sine and cosine leaves 1e-17 of the radius"""
ROOM = 1e-9
"""share of a straight piece by which arcs may overlap on it: rounding"""


def rounded_corners(points: Array, radii: Array, metre: float = 1.0) -> MeridianLine:
    """Straight pieces from point to point (..., n, 2), the inner ones rounded by tangent arcs of radii (..., n - 2).

    Raises DesignError where an arc does not fit between its neighbours, or the line turns back on itself. `metre` is
    the length unit of what it says.
    """
    along = unit(np.diff(points, axis=-2))
    sides = length(np.diff(points, axis=-2))
    turn = cross2(along[..., :-1, :], along[..., 1:, :])
    onwards = 1.0 + dot(along[..., :-1, :], along[..., 1:, :])
    _check_turns(real_first(onwards, 1))
    half = turn / onwards
    sign = np.where(np.real(turn) < 0.0, -1.0, 1.0)
    cut = radii * half * sign
    _check_room(real_first(sides, 1), real_first(cut, 1), metre)
    cut = np.broadcast_to(cut, (*np.broadcast_shapes(cut.shape[:-1], sides.shape[:-1]), cut.shape[-1]))
    none = np.zeros_like(cut[..., :1])
    before, after = np.concatenate([none, cut], axis=-1), np.concatenate([cut, none], axis=-1)
    starts = points[..., :-1, :] + before[..., None] * along
    straight = sides - before - after
    pieces, lengths, smooth = [], [], []
    whole = float(np.sum(real_first(sides, 1)))
    for i in range(sides.shape[-1]):
        if float(real_first(straight, 1)[i]) > ROOM * whole:
            middle = starts[..., i, :] + 0.5 * straight[..., i, None] * along[..., i, :]
            pieces.append([middle, straight[..., i, None] * along[..., i, :]])
            lengths.append(straight[..., i])
            smooth.append(1)
        if i == sides.shape[-1] - 1:
            continue
        if float(real_first(cut, 1)[i]) <= ROOM * whole:
            smooth[-1] = int(float(real_first(turn, 1)[i]) ** 2 < ROOM**2)
            continue
        angle = 2.0 * np.arctan(half[..., i])
        end = points[..., i + 1, :] - cut[..., i, None] * along[..., i, :]
        for piece in _arc(end, along[..., i, :], radii[..., i] * sign[..., i], angle):
            pieces.append(piece)
            lengths.append(radii[..., i] * angle * sign[..., i] / _parts(angle))
            smooth.append(1)
    steps = np.stack([real_first(each, 0) for each in lengths])
    breaks = np.concatenate([[0.0], np.cumsum(steps) / np.sum(steps)])
    breaks[-1] = 1.0
    widths = np.diff(breaks)
    degree = max(len(piece) for piece in pieces) - 1
    powers = np.stack(
        np.broadcast_arrays(*[_padded(piece, w, degree) for piece, w in zip(pieces, widths, strict=True)])
    )
    powers = np.moveaxis(powers, 0, -3)
    net, knots = joined_net(powers, breaks, np.zeros(len(widths) - 1, dtype=int))
    sharp = tuple(float(breaks[i + 1]) for i, kept in enumerate(smooth[:-1]) if kept == 0)
    return MeridianLine(breaks=breaks, powers=powers, net=net, knots=knots, corners=sharp)


def _arc(start: Array, along: Array, radius: Array, angle: Array) -> list[list[Array]]:
    """Pieces of an arc that leaves a point (..., 2) along a direction; powers of w from -1/2 to 1/2 of each."""
    count = _parts(angle)
    normal = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    centre = start + radius[..., None] * normal
    pieces = []
    for i in range(count):
        step = angle / count
        middle = (i + 0.5) * step
        out = np.sin(middle)[..., None] * along - np.cos(middle)[..., None] * normal
        on = np.cos(middle)[..., None] * along + np.sin(middle)[..., None] * normal
        terms = [
            (radius * step**k)[..., None] * ((-1.0) ** (k // 2) / factorial(k)) * (on if k % 2 else out)
            for k in range(ARC_DEGREE + 1)
        ]
        terms[0] = terms[0] + centre
        pieces.append(terms)
    return pieces


def _parts(angle: Array) -> int:
    size = float(real_first(angle, 0))
    return max(1, int(np.ceil(max(size, -size) / ARC - ROOM)))


def _padded(piece: list[Array], width: float, degree: int) -> Array:
    """Powers (..., degree + 1, 2) of the own parameter from those of w, which runs over one."""
    batch = np.broadcast_shapes(*[term.shape for term in piece])
    zero = np.zeros(batch)
    terms = [np.broadcast_to(term, batch) / width**k for k, term in enumerate(piece)]
    return np.stack(np.broadcast_arrays(*terms, *[zero] * (degree + 1 - len(terms))), axis=-2)


def _check_turns(onwards: Reals) -> None:
    for i, value in enumerate(onwards):
        if value < 1e-6:
            raise DesignError(
                f"corners[{i + 1}]: the line turns back on itself there; a corner must turn by less than 180 deg; "
                "put a further corner in"
            )


def _check_room(sides: Reals, cut: Reals, metre: float) -> None:
    """Refuse arcs that need more of a straight piece than there is."""
    ends = np.concatenate([[0.0], cut, [0.0]])
    needed = ends[:-1] + ends[1:]
    for i, (asked, there) in enumerate(zip(needed, sides, strict=True)):
        if asked > there * (1.0 + ROOM):
            beside = " and ".join(f"radii[{k - 1}]" for k in (i, i + 1) if 0 < k < len(ends) - 1)
            raise DesignError(
                f"{beside}: the arcs take {asked / metre:.6g} of the straight piece between corners[{i}] and "
                f"corners[{i + 1}], which is {there / metre:.6g} long; take smaller radii, or move the corners apart"
            )
