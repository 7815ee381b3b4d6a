"""Which pieces of a cloud's meridional outline are its walls, and which its edges."""

import numpy as np

from bladewright.fitting.first.channel import EDGES, rough_channel
from bladewright.fitting.first.found import Found, apart, laid_in, matched_in
from bladewright.fitting.first.matching import nearest
from bladewright.fitting.first.outline import boundary, corner_sets
from bladewright.fitting.first.shape import ROOT_IN, ROOT_OUT
from bladewright.nurbs.basis import Reals

FEW = 450
"""points that decide which of several outlines it is"""

CLEAR = 3e-3
"""of the chord: a mean distance that settles the outline where the other pairing lies three times as far off"""
RADIAL = 0.05
"""axial share of the way from edge to edge below which the rounder edge leads"""


def coordinates(points: Reals, arrangement: str) -> Reals:
    """Coordinates (n, 3): x, r and theta [rad] without a jump, or x, z and y of a cascade."""
    x, y, z = points.T
    if arrangement == "linear":
        return np.stack([x, z, y], axis=-1)
    theta = np.sort(np.arctan2(y, z))
    gaps = np.diff(np.concatenate([theta, theta[:1] + 2.0 * np.pi]))
    i = int(np.argmax(gaps))
    cut = theta[i] + gaps[i] / 2.0
    wrapped = (np.arctan2(y, z) - cut) % (2.0 * np.pi) + cut
    wrapped -= 2.0 * np.pi * np.round(np.median(wrapped) / (2.0 * np.pi))
    return np.stack([x, np.sqrt(y**2 + z**2), wrapped], axis=-1)


def ranked(machine: Reals, *, revolved: bool) -> tuple[Reals, list[Found]]:
    """The points that count, and the blades whose walls and edges are pieces of the outline, the closest first."""
    found = _likely(machine, revolved=revolved)
    best = found[0]
    distances = nearest(best.shape, laid_in(machine, best.channel), best.match.laws)[2]
    kept = distances < 5.0 * np.median(distances) + 0.03 * best.laid.chord
    if np.mean(kept) < 0.995:
        machine = machine[kept]
        found = _likely(machine, revolved=revolved)
    return machine, found


def _likely(machine: Reals, *, revolved: bool) -> list[Found]:
    few = machine[np.random.default_rng(1).permutation(len(machine))[:FEW]]
    tried = []
    for pieces in corner_sets(boundary(machine[:, :2])):
        for turn in (0, 1):
            named = _named(pieces, turn)
            found = _tried(few, named, revolved=revolved)
            if _radial(named) and _rounder_at_end(found):
                found = _tried(few, _reversed(named), revolved=revolved)
            tried.append(found)
        away = sorted(apart(found, few) for found in tried)
        if away[0] < min(CLEAR * tried[0].laid.chord, away[1] / 3.0):
            break
    return sorted(tried, key=lambda found: apart(found, few))


def _named(pieces: list[Reals], turn: int) -> dict[str, Reals]:
    """Four pieces of an anticlockwise boundary by their names, for one of the two ways to pair them.

    Anticlockwise in (x, r) come hub, trailing edge, shroud, leading edge; the flow goes on towards +x.
    """
    hub, trailing, shroud, leading = (pieces[(i + turn) % 4] for i in range(4))
    if np.mean(leading[:, 0]) > np.mean(trailing[:, 0]):
        hub, trailing, shroud, leading = shroud, leading, hub, trailing
    return {"hub": hub, "trailing_edge": trailing, "shroud": shroud[::-1], "leading_edge": leading[::-1]}


def _tried(few: Reals, named: dict[str, Reals], *, revolved: bool) -> Found:
    channel = rough_channel(named, dict.fromkeys(EDGES, 5), revolved=revolved)
    return matched_in(few, channel, (4, 4), 3, turns=10)


def _radial(named: dict[str, Reals]) -> bool:
    """Whether the stream lines hardly lead along x, so that x does not tell where they start."""
    step = np.mean(named["trailing_edge"], axis=0) - np.mean(named["leading_edge"], axis=0)
    return abs(float(step[0])) < RADIAL * float(np.sqrt(np.sum(step**2)))


def _rounder_at_end(found: Found) -> bool:
    return float(np.mean(found.match.laws[:, ROOT_OUT])) > 1.1 * float(np.mean(found.match.laws[:, ROOT_IN]))


def _reversed(named: dict[str, Reals]) -> dict[str, Reals]:
    """The same outline with the flow the other way."""
    return {
        "hub": named["shroud"][::-1],
        "shroud": named["hub"][::-1],
        "leading_edge": named["trailing_edge"][::-1],
        "trailing_edge": named["leading_edge"][::-1],
    }
