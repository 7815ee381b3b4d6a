"""Skin morphing: segments whose scale factors and inner control points change within a band about their skin."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, length, turned_left
from bladewright.nurbs.basis import Reals
from bladewright.section.segmented.segment import powers

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

    def check(self, old: Sequence[Array], new: Array, where: Sequence[str]) -> None:
        """Refuse new control points (..., m, n, 2) whose curve leaves the band of the side's old ones.

        `old` are the control points of the side's three segments, `where` (m,) names the sections.
        """
        outward = 1.0 if self.side == 0 else -1.0
        name = f"{SIDES[self.side]}.{SEGMENTS[self.segment]}.skin"
        before, after = [_sections(each, 3) for each in old], _sections(new, 3)
        inner, outer = _sections(self.inner, 1), _sections(self.outer, 1)
        for i, place in enumerate(where):
            off = outward * _distances([_one(each, i) for each in before], _one(after, i))
            found = ("outer", "outside", _largest(off), outer), ("inner", "inside", _largest(-off), inner)
            for field, word, value, limits in found:
                limit = float(_one(limits, i))
                if value > limit + SLACK:
                    raise DesignError(
                        f"{name}.{field} is {limit:g}: the morphed skin{place} lies {value:.4g} chords {word} the old "
                        f"one: take smaller changes of control points and scale factors, or a larger {field}"
                    )


def _sections(values: Array, rank: int) -> Reals:
    """The real values of sections (m, ...), of the first of a batch."""
    real = np.real(values)
    return np.asarray(real.reshape(-1, *real.shape[-rank:])[0])


def _one(values: Reals, i: int) -> Reals:
    """Those of one section, also where all have the same."""
    return np.asarray(values[min(i, len(values) - 1)])


def _distances(old: Sequence[Reals], new: Reals) -> Reals:
    """Distances (k,) of a segment's curve from a side of three, positive on its left."""
    point, first, second = (np.concatenate(each) for each in zip(*map(_along, old), strict=True))
    tangent = first / length(first)[:, None]
    bend = cross2(first, second) / length(first) ** 3
    points = _along(new)[0]
    nearest = cKDTree(point).query(points)[1]
    offset, tangent, bend = points - point[nearest], tangent[nearest], bend[nearest]
    across, aside = dot(offset, turned_left(tangent)), dot(offset, tangent)
    # to the circle of curvature of the nearest place
    return np.asarray(across - 0.5 * bend * aside**2 / (1.0 - bend * across))


def _along(controls: Reals) -> tuple[Reals, Reals, Reals]:
    """Points and two derivatives (k, 2) along the spans of a segment with control points (n, 2)."""
    c = powers(controls)[:, None]
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
