"""A channel cut at the ends of the camber lines, and widened to all points."""

from collections.abc import Callable

import numpy as np

from bladewright.fitting.first.channel import SPAN, Rough, rough_channel
from bladewright.fitting.first.found import Found, laid_in
from bladewright.fitting.first.laid import numbers_at
from bladewright.fitting.first.matching import nearest
from bladewright.fitting.first.shape import (
    EXTENT,
    START,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis


def trimmed(found: Found, counts: dict[str, int], machine: Reals, past: float) -> Rough:
    """The channel between the ends of the camber lines, and between the points furthest in and out."""
    numbers = numbers_at(found.match.laws, SPAN)
    extents = found.channel.extents()[0]
    first = extents * numbers[:, START]
    last = first + extents * numbers[:, EXTENT]
    starts, ends = (found.channel.u_at(a) for a in (first, last))
    ends = np.maximum(ends, starts + 0.05)
    low, high = _reached(found, machine)
    across = np.linspace(0.0, 1.0, 41)

    def edge(u: Reals) -> Reals:
        first, last = low(u[:1])[0], high(u[-1:])[0]
        v = first + (last - first) * across
        return found.channel.position(np.interp(v, SPAN, u), v)

    pieces = {"leading_edge": edge(starts), "trailing_edge": edge(ends)}
    for name, row, wall in (("hub", 0, low), ("shroud", -1, high)):
        u = np.linspace(starts[row], ends[row], 41)
        pieces[name] = found.channel.position(u, wall(u))
    return rough_channel(pieces, counts, revolved=found.channel.revolved, past=past)


def _reached(found: Found, machine: Reals) -> tuple[Callable[[Reals], Reals], Callable[[Reals], Reals]]:
    """Lowest and highest v of the points by u, as parabolas."""
    u, v = found.channel.places(machine[:, :2])
    distances = nearest(found.shape, laid_in(machine, found.channel), found.match.laws)[2]
    good = distances < 4.0 * np.median(distances) + 0.02 * found.laid.chord
    u, v = u[good], v[good]
    walls = []
    for sign in (1.0, -1.0):
        parts = np.clip((u * 6.0).astype(int), 0, 5)
        index = [np.flatnonzero(parts == part) for part in range(6)]
        chosen = np.array([rows[np.argmin(sign * v[rows])] for rows in index if len(rows)])
        wall = 0.0 if sign > 0.0 else 1.0
        away = np.clip(v[chosen] - wall, -0.15, 0.15)
        tame = 0.3 * np.diff(np.eye(3), n=2, axis=0)
        matrix = np.concatenate([law_basis(3, np.clip(u[chosen], 0.0, 1.0)), tame])
        law = np.linalg.lstsq(matrix, np.concatenate([away, [0.0]]), rcond=None)[0]
        walls.append(lambda at, law=law, wall=wall: wall + law_basis(3, np.clip(at, 0.0, 1.0)) @ law)
    return walls[0], walls[1]
