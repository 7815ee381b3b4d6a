"""Which pieces of a cloud's meridional outline are its walls, and which its edges."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from bladewright.fitting.initial_guess.channel import FirstChannel, channel_through
from bladewright.fitting.initial_guess.meridional_outline import alpha_boundary, corner_sets
from bladewright.fitting.initial_guess.slices import PlanePoints, Slices, chord_direction, slices_of
from bladewright.fitting.model_selection.structure import INITIAL_BLADES
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals

STATIONS: Reals = np.linspace(0.0, 1.0, 9)
"""v of the slices"""
MOST_TRIM = 0.2
"""most by which an edge moves to the ends of the cambers, in u (design/first_guesses.md)"""
CLEAR_DISTANCE = 2e-3
"""mean distance of the points, in chords, with which no other outline is tried (design/first_guesses.md)"""
CHANNEL = INITIAL_BLADES[1].channel
"""control points of the channel's curves"""
LAW_COUNT = 4
"""control points of their laws along the span (design/first_guesses.md)"""
BORDER_SHARE, BORDER_POINTS, CORNER_MARGIN = 0.06, 24, 0.12
"""share of the points (and at least `BORDER_POINTS`) beside a piece of the outline that show whether the sides meet
there; they keep clear of its ends by `CORNER_MARGIN` of it (design/first_guesses.md)."""
WALL_OPENING_RATIO = 1.4
"""ratio of the openings from which two opposite pieces are the walls (design/first_guesses.md)."""
RADIAL_SHARE = 0.05
"""axial share of the way from edge to edge below which the rounder edge leads (design/first_guesses.md)."""
ROUNDER_RATIO = 1.2
"""ratio of radii from which one edge is the rounder one (design/first_guesses.md)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SlicedChannel:
    """A channel, the points on its stream surfaces, and slices of them."""

    channel: FirstChannel
    plane: PlanePoints
    slices: Slices
    outside: float
    """mean distance of the points from the channel, past its walls, in chords"""

    @property
    def mean_distance(self) -> float:
        """Mean distance of the points from the slices and from the channel, in chords."""
        return self.slices.mean_distance + self.outside


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


def ranked_channels(machine: Reals, *, revolved: bool) -> list[SlicedChannel]:
    """The channel and slices for each likely choice of walls and edges, those nearest to the points first."""
    found = []
    for pieces in corner_sets(alpha_boundary(machine[:, :2])):
        for turn in pairings(machine, pieces, revolved=revolved):
            named = _named(pieces, turn)
            sliced = sliced_channel(machine, named, revolved=revolved)
            if _radial(named) and _rounder_at_end(sliced.slices):
                sliced = sliced_channel(machine, _reversed(named), revolved=revolved)
            found.append(sliced)
        if min(each.mean_distance for each in found) < CLEAR_DISTANCE:
            break
    return sorted(found, key=lambda each: each.mean_distance)


def sliced_channel(machine: Reals, named: dict[str, Reals], *, revolved: bool) -> SlicedChannel:
    """The slices in the channel of one outline; their cambers begin and end at its edges.

    Noses of staggered sections reach past the ends of their camber, so that the edges are moved to these once.
    """
    channel = channel_through(named, CHANNEL, revolved=revolved)
    slices = _sliced(machine, channel).slices
    channel = channel_through(_trimmed(channel, slices), CHANNEL, revolved=revolved)
    sliced = _sliced(machine, channel)
    line = sliced.slices.camber.copy()
    first, last = line[:, :1, 0], line[:, 3:, 0]
    line[..., 0] = (line[..., 0] - first) / np.maximum(last - first, 0.2)
    return replace(sliced, slices=replace(sliced.slices, camber=line))


def _sliced(machine: Reals, channel: FirstChannel) -> SlicedChannel:
    """The points in the planes of a channel's stream surfaces, and their slices."""
    u, v = channel.places(machine[:, :2])
    v = np.clip(v, 0.0, 1.0)
    past = machine[:, :2] - channel.position(u, v)
    extent, length = channel.extents(v)
    plane = PlanePoints(points=np.stack([channel.abscissa(u, v), machine[:, 2]], axis=-1) / extent[:, None], v=v)
    slices = slices_of(plane, chord_direction(plane), STATIONS, LAW_COUNT)
    outside = float(np.mean(np.sqrt(np.sum(past**2, axis=-1)) / length)) / float(np.mean(slices.chords))
    return SlicedChannel(channel=channel, plane=plane, slices=slices, outside=outside)


def _trimmed(channel: FirstChannel, slices: Slices) -> dict[str, Reals]:
    """The four curves of a channel between the ends of the cambers."""
    ends = channel.u_at(slices.camber[:, [0, 3], 0] * channel.extents(slices.v)[0][:, None], slices.v)
    first, last = np.clip(ends[:, 0], -MOST_TRIM, MOST_TRIM), np.clip(ends[:, 1], 1.0 - MOST_TRIM, 1.0 + MOST_TRIM)
    pieces = {name: channel.position(u, slices.v) for name, u in (("leading_edge", first), ("trailing_edge", last))}
    for name, row in (("hub", 0), ("shroud", -1)):
        u = np.linspace(first[row], last[row], 41)
        pieces[name] = channel.position(u, slices.v[row])
    return pieces


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


def _radial(named: dict[str, Reals]) -> bool:
    """Whether the stream lines hardly lead along x, so that x does not show where they start."""
    step = np.mean(named["trailing_edge"], axis=0) - np.mean(named["leading_edge"], axis=0)
    return abs(float(step[0])) < RADIAL_SHARE * float(np.sqrt(np.sum(step**2)))


def _rounder_at_end(slices: Slices) -> bool:
    first, last = slices.radii
    return float(np.mean(last)) > ROUNDER_RATIO * float(np.mean(first))


def _reversed(named: dict[str, Reals]) -> dict[str, Reals]:
    """The same outline for flow in the other direction."""
    return {
        "hub": named["shroud"][::-1],
        "shroud": named["hub"][::-1],
        "leading_edge": named["trailing_edge"][::-1],
        "trailing_edge": named["leading_edge"][::-1],
    }
