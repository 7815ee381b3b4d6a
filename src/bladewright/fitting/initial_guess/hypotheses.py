"""Which pieces of a cloud's meridional outline are its walls, and which its edges."""

import numpy as np
from scipy.spatial import cKDTree

from bladewright.fitting.initial_guess.channel import needed_counts, rough_channel
from bladewright.fitting.initial_guess.meridional_outline import alpha_boundary, corner_sets
from bladewright.fitting.initial_guess.section_match import nearest_places
from bladewright.fitting.initial_guess.section_shape import ROOT_IN, ROOT_OUT
from bladewright.fitting.initial_guess.sections_in_channel import (
    SectionsInChannel,
    first_sections,
    mean_distance,
    unwrapped_in,
)
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals

DECIDING_POINTS = 450
"""points by which outlines are compared; it bounds the time."""
MOST_CURVE_POINTS = 5
"""control points of a piece of the outline at most"""
BORDER_SHARE, BORDER_POINTS, CORNER_MARGIN = 0.06, 24, 0.12
"""share of the points (and at least `BORDER_POINTS`) beside a piece of the outline that show whether the sides meet
there; they keep clear of its ends by `CORNER_MARGIN` of it."""
WALL_OPENING_RATIO = 1.4
"""ratio of the openings from which two opposite pieces are the walls."""
CLEAR_DISTANCE = 3e-3
"""mean distance, of the chord, that settles the outline where the other pairing lies three times as far off."""
NEARER_RATIO = 0.9
"""ratio of mean distances below which an outline without the distant points is taken; otherwise these belong to the
blade, and lie off as the channel does not follow it yet."""
RADIAL_SHARE = 0.05
"""axial share of the way from edge to edge below which the rounder edge leads."""


def machine_coordinates(points: Reals, arrangement: str) -> Reals:
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


def ranked_outlines(machine: Reals, *, revolved: bool) -> tuple[Reals, list[SectionsInChannel]]:
    """The points that count, and the blades for each choice of walls and edges, the nearest first."""
    found = _likely_outlines(machine, revolved=revolved)
    best = found[0]
    distances = nearest_places(best.shape, unwrapped_in(machine, best.channel), best.match.laws)[2]
    kept = distances < 5.0 * np.median(distances) + 0.03 * best.unwrapped.chord
    if np.mean(kept) < 0.995:
        other = _likely_outlines(machine[kept], revolved=revolved)
        if other[0].match.mean / other[0].unwrapped.chord < NEARER_RATIO * best.match.mean / best.unwrapped.chord:
            return machine[kept], other
    return machine, found


def _likely_outlines(machine: Reals, *, revolved: bool) -> list[SectionsInChannel]:
    """The blades for each likely choice of walls and edges, the nearest first."""
    few = machine[np.random.default_rng(1).permutation(len(machine))[:DECIDING_POINTS]]
    tried = []
    for pieces in corner_sets(alpha_boundary(machine[:, :2])):
        for turn in pairings(machine, pieces, revolved=revolved):
            named = _named(pieces, turn)
            found = _sections_of_outline(few, named, revolved=revolved)
            if _radial(named) and _rounder_at_end(found):
                found = _sections_of_outline(few, _reversed(named), revolved=revolved)
            tried.append(found)
        away = sorted(mean_distance(found, few) for found in tried)
        if away[0] < min([CLEAR_DISTANCE * tried[0].unwrapped.chord, *(each / 3.0 for each in away[1:2])]):
            break
    return sorted(tried, key=lambda found: mean_distance(found, few))


def pairings(machine: Reals, pieces: list[Reals], *, revolved: bool) -> tuple[int, ...]:
    """Which of the two ways to pair the pieces to try: at walls the sides stand apart, at edges they meet."""
    openings = [_opening(machine, piece, revolved=revolved) for piece in pieces]
    pairs = [[opening for opening in openings[start::2] if opening is not None] for start in (0, 1)]
    if not all(pairs):
        return (0, 1)
    even, odd = (float(np.mean(pair)) for pair in pairs)
    if even > WALL_OPENING_RATIO * odd:
        return (0,)
    return (1,) if odd > WALL_OPENING_RATIO * even else (0, 1)


def _opening(machine: Reals, piece: Reals, *, revolved: bool) -> float | None:
    """Root mean square tangential distance [m] of the points beside a piece of the outline from one surface.

    None where too few points are beside it.
    """
    way = cumulative_length(piece)
    t = np.linspace(0.0, 1.0, 400)
    line = np.stack([np.interp(t * way[-1], way, piece[:, i]) for i in (0, 1)], axis=-1)
    away, index = cKDTree(line).query(machine[:, :2])
    along = t[index]
    beside = np.flatnonzero((along > CORNER_MARGIN) & (along < 1.0 - CORNER_MARGIN))
    beside = beside[np.argsort(away[beside])[: max(BORDER_POINTS, int(BORDER_SHARE * len(machine)))]]
    if len(beside) < BORDER_POINTS:
        return None
    across = machine[beside, 2] * (machine[beside, 1] if revolved else 1.0)
    depth = away[beside] / max(float(np.max(away[beside])), 1e-300)
    sheet = np.column_stack([np.vander(along[beside], 4), depth, depth * along[beside]])
    left = across - sheet @ np.linalg.lstsq(sheet, across, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2)))


def _named(pieces: list[Reals], turn: int) -> dict[str, Reals]:
    """Four pieces of an anticlockwise boundary by their names, for one of the two ways to pair them.

    Anticlockwise in (x, r) they are hub, trailing edge, shroud, leading edge; the flow goes towards +x.
    """
    hub, trailing, shroud, leading = (pieces[(i + turn) % 4] for i in range(4))
    if np.mean(leading[:, 0]) > np.mean(trailing[:, 0]):
        hub, trailing, shroud, leading = shroud, leading, hub, trailing
    return {"hub": hub, "trailing_edge": trailing, "shroud": shroud[::-1], "leading_edge": leading[::-1]}


def _sections_of_outline(few: Reals, named: dict[str, Reals], *, revolved: bool) -> SectionsInChannel:
    """The sections found in the channel of one outline."""
    channel = rough_channel(named, needed_counts(named, MOST_CURVE_POINTS, len(few)), revolved=revolved)
    return first_sections(few, channel, (4, 4), 3, turns=10)


def _radial(named: dict[str, Reals]) -> bool:
    """Whether the stream lines hardly lead along x, so that x does not show where they start."""
    step = np.mean(named["trailing_edge"], axis=0) - np.mean(named["leading_edge"], axis=0)
    return abs(float(step[0])) < RADIAL_SHARE * float(np.sqrt(np.sum(step**2)))


def _rounder_at_end(found: SectionsInChannel) -> bool:
    return float(np.mean(found.match.laws[:, ROOT_OUT])) > 1.1 * float(np.mean(found.match.laws[:, ROOT_IN]))


def _reversed(named: dict[str, Reals]) -> dict[str, Reals]:
    """The same outline for flow in the other direction."""
    return {
        "hub": named["shroud"][::-1],
        "shroud": named["hub"][::-1],
        "leading_edge": named["trailing_edge"][::-1],
        "trailing_edge": named["leading_edge"][::-1],
    }
