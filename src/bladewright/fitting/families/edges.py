"""Where the edges of a closed outline are: the middle of what turns around the ends of the line between its sides.

A thick nose has its leading edge where a description of it puts it; families that lay a thickness on a mean line have
it at the mean line's end.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals

SAMPLES = 600
"""points of an outline, in equal steps"""
FACING = -0.2
"""cosine between the normals of two touching places below which they are on two sides, not on one edge"""
FLAT = 1e-3
"""by how much the cosine of a normal with the direction of an edge may be off where it is as good as along it"""
OFF = 0.02
"""distance of an edge from there, of the chord, from which it is moved there"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Inscribed:
    """The largest circles inside an outline that touch at its points (n, 2)."""

    points: Reals
    normals: Reals
    """(n, 2) inward"""
    radii: Reals
    """(n,)"""
    other: NDArray[np.intp]
    """(n,) the other point where each touches"""

    @property
    def centres(self) -> Reals:
        """Their centres (n, 2)."""
        return self.points + self.radii[:, None] * self.normals

    @property
    def between(self) -> NDArray[np.bool_]:
        """(n,) whether a circle touches both sides."""
        return np.sum(self.normals * self.normals[self.other], axis=1) < FACING


def split(upper: Reals, lower: Reals) -> tuple[Reals, Reals, tuple[float, float] | None]:
    """Both sides (n, 2) from edge to edge, and the edges' radii where they are others than those given."""
    along = upper[-1] - upper[0]
    chord = float(np.sqrt(np.sum(along**2)))
    circles = inscribed(_even(np.concatenate([upper, lower[::-1]])))
    around = circles.points
    ends = [_edge(circles, along, sign) for sign in (-1.0, 1.0)]
    given = 0.5 * (upper[0] + lower[0]), 0.5 * (upper[-1] + lower[-1])
    off = [0.0 if end is None else _apart(around[end], old) for end, old in zip(ends, given, strict=True)]
    if max(off) < OFF * chord:
        return upper, lower, None
    first, last = (
        end if end is not None and away >= OFF * chord else int(np.argmin(np.sum((around - old) ** 2, axis=1)))
        for end, away, old in zip(ends, off, given, strict=True)
    )
    turned = np.roll(around, -first, axis=0)
    count = (last - first) % len(around)
    above, below = turned[: count + 1], np.concatenate([turned[:1], turned[: count - 1 : -1]])
    return above, below, (float(circles.radii[first]), float(circles.radii[last]))


def inscribed(around: Reals) -> Inscribed:
    """The circles of an outline whose points (n, 2) go once around."""
    tangent = np.roll(around, -1, axis=0) - np.roll(around, 1, axis=0)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1)
    normal = normal / (np.sqrt(np.sum(normal**2, axis=1))[:, None] + 1e-300)
    x, y = around.T
    inward = normal if float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) > 0.0 else -normal
    apart = around[None] - around[:, None]
    ahead = np.einsum("ijk,ik->ij", apart, inward)
    square = np.sum(apart**2, axis=-1)
    met = ahead > 1e-9 * np.sqrt(np.max(square))
    radius = np.where(met, square / (2.0 * np.where(met, ahead, 1.0)), np.inf)
    other = np.argmin(radius, axis=1)
    least = radius[np.arange(len(around)), other]
    return Inscribed(
        points=around, normals=inward, radii=np.where(np.isfinite(least), least, np.max(square) ** 0.5), other=other
    )


def _edge(circles: Inscribed, along: Reals, sign: float) -> int | None:
    """The point in the middle of the turn around the end of the middle line downstream (1) or upstream (-1)."""
    kept = np.flatnonzero(circles.between)
    if len(kept) == 0:
        return None
    count = len(circles.points)
    last = int(kept[np.argmax(sign * (circles.centres[kept] @ along))])
    pair = sorted((last, int(circles.other[last])))
    arcs = np.arange(pair[0], pair[1] + 1), np.arange(pair[1], pair[0] + count + 1) % count
    cap = max(arcs, key=lambda arc: float(np.mean(sign * (circles.points[arc] @ along))))
    across = circles.normals[pair[0]] - circles.normals[pair[1]]
    middle = np.array([-across[1], across[0]])
    # inward at an edge is away from it
    middle = -sign * middle if middle @ along > 0.0 else sign * middle
    cosine = circles.normals[cap] @ (middle / np.sqrt(np.sum(middle**2)))
    best = np.flatnonzero(cosine > np.max(cosine) - FLAT)
    return int(cap[best[len(best) // 2]])


def _even(around: Reals) -> Reals:
    """Points of an outline in equal steps."""
    steps = np.sqrt(np.sum(np.diff(around, axis=0, append=around[:1]) ** 2, axis=1))
    way = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, way[-1], SAMPLES, endpoint=False)
    closed = np.concatenate([around, around[:1]])
    return np.stack([np.interp(at, way, closed[:, i]) for i in (0, 1)], axis=-1)


def _apart(a: Reals, b: Reals) -> float:
    return float(np.sqrt(np.sum((a - b) ** 2)))
