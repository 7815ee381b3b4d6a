"""Whether closed outlines cross themselves or their neighbours."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bladewright.errors import DesignError
from bladewright.numerics.elementary import concatenated
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import Outline

PLACES = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 49))) / 2.0
"""s of the points by which outlines of the unified family are judged, dense at the edges where the sides come close: 49
a side keep the quadratic number of pairs small for many spans at once"""
FINE = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 201))) / 2.0
"""s of the points by which outlines of other families are judged: more, because an offset side that folds back does so
in a small loop between points"""


def outlines_of(upper: Reals, lower: Reals) -> Reals:
    """Closed outlines (..., n, 2) of two sides (..., m, 2) each."""
    return concatenated([upper, lower[..., -2:0:-1, :]], axis=-2)


def check_outlines(outlines: Reals, where: Sequence[str]) -> None:
    """Refuse closed outlines (k, n, 2) of sides at `PLACES` that cross themselves; `where` (k,) names each."""
    found = self_crossings(outlines)
    if found is not None:
        section, segment = found
        at = PLACES[min(segment, outlines.shape[1] - segment)]
        raise DesignError(
            f"thickness_upper and thickness_lower: the sides cross {where[section]}near s = {at:.3f} along the "
            "section: raise the thickness there, lower an edge radius that is larger than the thickness beside it, or "
            "lower the turning of the camber"
        )


def closed_outlines(outline: Outline) -> Reals:
    """Closed real outlines (m, n, 2) of sections at `FINE`, along the upper side and back along the lower side.

    A point that both sides share occurs once; of a blunt edge both points occur.
    """
    upper, lower = (np.real(side).reshape(-1, *side.shape[-2:]) for side in outline.points(FINE))
    upper, lower = np.broadcast_arrays(upper, lower)
    back = lower[:, ::-1]
    back = back[:, 1:] if outline.trailing_edge.kind != "blunt" else back
    back = back[:, :-1] if outline.leading_edge.kind != "blunt" else back
    return concatenated([upper, back], axis=-2)


def check_outline(outline: Outline, where: Sequence[str]) -> None:
    """Refuse sections (m,) of a family that cross themselves or fold back; `where` (m,) names each."""
    outline.check_limits(where)
    outlines = closed_outlines(outline)
    for kind, found in (("crosses itself", self_crossings(outlines)), ("folds back on itself", _folding(outlines))):
        if found is None:
            continue
        section, segment = found
        upper = segment < len(FINE)
        at = FINE[segment] if upper else FINE[max(outlines.shape[1] - segment, 0)]
        raise DesignError(
            f"the section{where[section]} {kind} on its {'upper' if upper else 'lower'} side near s = {at:.3f} (0 is "
            f"the leading, 1 the trailing edge): {outline.crossing_cure}"
        )


def _folding(outlines: Reals) -> tuple[int, int] | None:
    """Outline and point of the first place where one turns by more than a right angle, but for the edges."""
    steps = np.roll(outlines, -1, axis=1) - outlines
    turned_back = np.sum(steps * np.roll(steps, 1, axis=1), axis=-1) < 0.0
    edges = [0, len(FINE) - 1, len(FINE) % outlines.shape[1], -1]
    turned_back[:, edges] = False
    found = np.argwhere(turned_back)
    return (int(found[0, 0]), int(found[0, 1])) if len(found) else None


def self_crossings(outlines: Reals) -> tuple[int, int] | None:
    """Outline and segment of the first of closed outlines (k, n, 2) that crosses itself; None where none does."""
    section, own, other = _crossings(outlines, outlines)
    gap = (own - other) % outlines.shape[1]
    found = np.flatnonzero((gap > 1) & (gap < outlines.shape[1] - 1))
    return (int(section[found[0]]), int(own[found[0]])) if len(found) else None


def touching(outlines: Reals, pitch: float) -> int | None:
    """The first of closed outlines (k, n, 2) that meets itself moved by `pitch` along its ordinate, or None."""
    high = np.flatnonzero(np.ptp(outlines[..., 1], axis=1) >= pitch)
    if len(high) == 0:
        return None
    found = _crossings(outlines[high], outlines[high] + np.array([0.0, pitch]))[0]
    return int(high[found[0]]) if len(found) else None


Places = NDArray[np.intp]


def _crossings(first: Reals, second: Reals) -> tuple[Places, Places, Places]:
    """Section and both segments (c,), in order, of the crossings of closed outlines (k, n, 2) with others (k, m, 2).

    Segments whose extents do not overlap are left out: on one straight line they would cross by rounding alone.
    """
    after, behind = np.roll(first, -1, axis=1), np.roll(second, -1, axis=1)
    low, high = np.minimum(first, after), np.maximum(first, after)
    other_low, other_high = np.minimum(second, behind), np.maximum(second, behind)
    x = (low[:, :, None, 0] <= other_high[:, None, :, 0]) & (other_low[:, None, :, 0] <= high[:, :, None, 0])
    section, i, j = np.nonzero(x)
    y = (low[section, i, 1] <= other_high[section, j, 1]) & (other_low[section, j, 1] <= high[section, i, 1])
    section, i, j = section[y], i[y], j[y]
    own, other = (first[section, i], after[section, i]), (second[section, j], behind[section, j])
    crossed = _parted(own, other) & _parted(other, own)
    return section[crossed], i[crossed], j[crossed]


def _parted(line: tuple[Reals, Reals], ends: tuple[Reals, Reals]) -> NDArray[np.bool_]:
    """Whether the line through two points (c, 2) parts two others."""
    along = line[1] - line[0]
    heights = [along[:, 0] * point[:, 1] - along[:, 1] * point[:, 0] for point in (line[0], *ends)]
    return np.asarray((heights[1] > heights[0]) != (heights[2] > heights[0]))
