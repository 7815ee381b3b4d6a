"""Skin morphing: segments whose scale factors and inner control points change within a band about their skin."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, length, turned_left
from bladewright.nurbs.basis import Reals

SAMPLES = 100
"""places in a knot span at which a skin is compared with its band: between them its distance is taken by a parabola,
which misses the largest one by less than a millionth of it [-]"""
SLACK = 1e-9
"""by how far a skin may leave its band, of the chord: rounding of its distances [-]"""
SIDES, SEGMENTS = ("upper", "lower"), ("leading_edge", "central_box", "trailing_edge")


@dataclass(frozen=True, kw_only=True, eq=False)
class Band:
    """Where a morphed skin may lie: between the offsets of the segment that it was, in chords."""

    side: int
    """0 upper, 1 lower"""
    segment: int
    """0 leading edge, 1 central box, 2 trailing edge"""
    inner: Array
    """(..., m) how far inside the old skin"""
    outer: Array
    """(..., m) how far outside it"""

    def check(self, off: Reals, i: int, place: str) -> None:
        """Refuse distances (k,) of the morphed segment from the old side, positive on its left, beyond the band's.

        `i` is the number of the section, which `place` names.
        """
        outward = off if self.side == 0 else -off
        name = f"{SIDES[self.side]}.{SEGMENTS[self.segment]}.skin"
        found = (("outer", "outside", outward, self.outer), ("inner", "inside", -outward, self.inner))
        for field, word, distances, limits in found:
            value, limit = _largest(distances), float(_one(_sections(limits, 1), i))
            if value > limit + SLACK:
                raise DesignError(
                    f"{name}.{field} is {limit:g}: the morphed skin{place} lies {value:.4g} chords {word} the old "
                    f"one: take smaller changes of control points and scale factors, or a larger {field}"
                )


def check_bands(bands: Sequence[Band], counts: Sequence[int], old: Array, new: Array, where: Sequence[str]) -> None:
    """Refuse a side that leaves its bands about the old one; `where` (m,) names the sections.

    Both are given by coefficients (..., m, p, 4, 2) of their spans, of which each segment has one of `counts`.
    """
    before, after = _sections(old, 4), _sections(new, 4)
    for i, place in enumerate(where):
        off = _distances(_one(before, i), _one(after, i)).reshape(sum(counts), -1)
        segments = np.split(off, np.cumsum(counts)[:-1])
        for band in bands:
            band.check(segments[band.segment].ravel(), i, place)


def _sections(values: Array, rank: int) -> Reals:
    """The real values of sections (m, ...), of the first of a batch."""
    real = np.real(values)
    return np.asarray(real.reshape(-1, *real.shape[-rank:])[0])


def _one(values: Reals, i: int) -> Reals:
    """Those of one section, also where all have the same."""
    return np.asarray(values[min(i, len(values) - 1)])


def _distances(old: Reals, new: Reals) -> Reals:
    """Distances (k,) of one side from another, positive on its left, both by coefficients (p, 4, 2) of their spans."""
    point, first, second = _along(old)
    tangent = first / length(first)[:, None]
    bend = cross2(first, second) / length(first) ** 3
    points = _along(new)[0]
    nearest = cKDTree(point).query(points)[1]
    offset, tangent, bend = points - point[nearest], tangent[nearest], bend[nearest]
    across, aside = dot(offset, turned_left(tangent)), dot(offset, tangent)
    # to the circle of curvature of the nearest place
    return np.asarray(across - 0.5 * bend * aside**2 / (1.0 - bend * across))


def _along(coefficients: Reals) -> tuple[Reals, Reals, Reals]:
    """Points and two derivatives (k, 2) along spans with coefficients (p, 4, 2)."""
    c = coefficients[:, None]
    t = np.linspace(0.0, 1.0, SAMPLES + 1)[:, None]
    found = (
        c[..., 0, :] + t * (c[..., 1, :] + t * (c[..., 2, :] + t * c[..., 3, :])),
        c[..., 1, :] + t * (2.0 * c[..., 2, :] + t * 3.0 * c[..., 3, :]),
        2.0 * c[..., 2, :] + 6.0 * t * c[..., 3, :],
    )
    point, first, second = (each.reshape(-1, 2) for each in found)
    return point, first, second


def _largest(values: Reals) -> float:
    """The largest of values along a smooth curve, between them by parabolas."""
    before, at, behind = values[:-2], values[1:-1], values[2:]
    bend = before - 2.0 * at + behind
    peak = (at >= before) & (at >= behind) & (bend < 0.0)
    between = at[peak] - (behind[peak] - before[peak]) ** 2 / (8.0 * bend[peak])
    return float(max(np.max(values), np.max(between, initial=-np.inf)))
