"""Sections on the stream surfaces of a rough channel, and the channel cut at their ends."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bladewright.fitting.initial_guess.camber import assigned_sides, first_laws
from bladewright.fitting.initial_guess.channel import SPAN, RoughChannel, rough_channel
from bladewright.fitting.initial_guess.section_match import SectionMatch, matched_sections, nearest_places
from bladewright.fitting.initial_guess.section_shape import (
    EXTENT,
    FIRST_THICKNESS,
    ROOT_IN,
    ROOT_OUT,
    START,
    SectionShape,
    UnwrappedPoints,
    numbers_at,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis

DIRECTION_BANDS, DIRECTION_POINTS, DIRECTION_COUNT = 9, 12, 3
"""bands along the span whose points show the direction of the chord there, the points that a band needs
(`DIRECTION_POINTS`), and control points of the resulting law (`DIRECTION_COUNT`)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionsInChannel:
    """A channel, and sections on its stream surfaces."""

    channel: RoughChannel
    shape: SectionShape
    unwrapped: UnwrappedPoints
    match: SectionMatch


def unwrapped_in(machine: Reals, channel: RoughChannel) -> UnwrappedPoints:
    """Points (n, 3) in x, r and theta, or x, z and y, in the planes of a channel's stream surfaces."""
    u, v = channel.places(machine[:, :2])
    a = channel.abscissa(u, v)
    size = 1.0 / machine[:, 1] if channel.revolved else np.ones(len(machine))
    length = float(np.median(channel.extents()[1]))
    return UnwrappedPoints(
        points=np.stack([a, machine[:, 2]], axis=-1), v=np.clip(v, 0.0, 1.0), size=size, chord=length, ratio=1.0
    )


def section_shape_in(
    channel: RoughChannel, chordwise: tuple[int, int], samples: int, clustering: float
) -> SectionShape:
    """The family's sections on a channel's stream surfaces."""
    return SectionShape(
        chordwise=chordwise, samples=samples, clustering=clustering, scale=channel.size, extent=channel.extent
    )


def first_sections(
    machine: Reals, channel: RoughChannel, chordwise: tuple[int, int], count: int, *, turns: int
) -> SectionsInChannel:
    """Sections in a channel without a guess, with `count` control points of the laws along the span."""
    unwrapped = unwrapped_in(machine, channel)
    shape = section_shape_in(channel, chordwise, 16, 1.0)
    turn, stacking, chord = _direction(unwrapped)
    unwrapped = replace(unwrapped, chord=chord, ratio=chord / unwrapped.chord)
    known = assigned_sides(shape, unwrapped, turn, stacking)
    unwrapped = replace(unwrapped, upper=known.upper, sure=known.sure)
    match = matched_sections(shape, unwrapped, first_laws(shape, unwrapped, turn, stacking, count), turns=turns)
    return SectionsInChannel(channel=channel, shape=shape, unwrapped=unwrapped, match=match)


def transferred_sections(
    machine: Reals,
    channel: RoughChannel,
    before: SectionsInChannel,
    shape: SectionShape,
    count: int,
    *,
    ends: bool,
    hold_sides: bool,
) -> SectionsInChannel:
    """Sections in another channel, from those found in the one before.

    `hold_sides` holds points to the side that they seem to belong to.
    """
    old = numbers_at(before.match.laws, SPAN)
    numbers = np.zeros((len(SPAN), shape.columns))
    numbers[:, :FIRST_THICKNESS] = old[:, :FIRST_THICKNESS]
    numbers[:, START], numbers[:, EXTENT] = 0.0, 1.0
    lengths = before.channel.extents()[1] / channel.extents()[1]
    numbers[:, [ROOT_IN, ROOT_OUT]] *= np.sqrt(lengths)[:, None]
    u = np.linspace(0.0, 1.0, 15)
    for now, then in ((shape.upper, before.shape.upper), (shape.lower, before.shape.lower)):
        values = lengths[:, None] * (old[:, then] @ law_basis(then.stop - then.start, u).T)
        numbers[:, now] = np.linalg.lstsq(law_basis(now.stop - now.start, u), values.T, rcond=None)[0].T
    laws = np.asarray(np.linalg.lstsq(law_basis(count, SPAN), numbers, rcond=None)[0])
    unwrapped = unwrapped_in(machine, channel)
    unwrapped = replace(unwrapped, chord=before.unwrapped.chord, ratio=before.unwrapped.chord / unwrapped.chord)
    if hold_sides:
        turn, stacking, _ = _direction(unwrapped)
        known = assigned_sides(shape, unwrapped, turn, stacking)
        unwrapped = replace(unwrapped, upper=known.upper, sure=known.sure)
    match = matched_sections(shape, unwrapped, laws, turns=10, stiff=0.3, ends=ends, draw_in=True)
    return SectionsInChannel(channel=channel, shape=shape, unwrapped=unwrapped, match=match)


def _direction(unwrapped: UnwrappedPoints) -> tuple[Callable[[Reals], Reals], Reals, float]:
    """Angle of the chord by place along the span, law of the middle ordinate, and the typical chord [m]."""
    rows = law_basis(DIRECTION_COUNT, unwrapped.v) / unwrapped.size[:, None]
    stacking = np.asarray(np.linalg.lstsq(rows, unwrapped.points[:, 1] / unwrapped.size, rcond=None)[0])
    places, angles, chords = [], [], []
    for middle in np.linspace(0.0, 1.0, DIRECTION_BANDS):
        band = (unwrapped.v - middle) ** 2 < (1.5 / DIRECTION_BANDS) ** 2
        if np.count_nonzero(band) < DIRECTION_POINTS:
            continue
        metres = unwrapped.points[band] / np.median(unwrapped.size[band])
        trend = np.column_stack([np.ones(len(metres)), unwrapped.v[band]])
        metres = metres - trend @ np.linalg.lstsq(trend, metres, rcond=None)[0]
        _, turned = np.linalg.eigh(metres.T @ metres)
        along = metres @ turned[:, 1]
        places.append(float(np.mean(unwrapped.v[band])))
        angles.append(float(np.arctan2(*(turned[::-1, 1] * np.sign(turned[0, 1] + 1e-300)))))
        chords.append(float(np.percentile(along, 98.0) - np.percentile(along, 2.0)))
    count = min(DIRECTION_COUNT, len(places))
    law = np.linalg.lstsq(law_basis(count, np.array(places)), np.array(angles), rcond=None)[0]

    def turn(v: Reals) -> Reals:
        return np.clip(law_basis(count, v) @ law, -np.radians(86.0), np.radians(86.0))

    return turn, stacking, float(np.median(chords))


def mean_distance(found: SectionsInChannel, machine: Reals) -> float:
    """Mean distance [m] of most points from the sections, and from the channel where they lie outside its walls."""
    u, v = found.channel.places(machine[:, :2])
    outside = machine[:, :2] - found.channel.position(u, np.clip(v, 0.0, 1.0))
    distances = np.sqrt(found.match.distances**2 + np.sum(outside**2, axis=-1))
    return float(np.mean(np.sort(distances)[: max(1, int(0.94 * len(distances)))]))


def trimmed_channel(found: SectionsInChannel, counts: dict[str, int], machine: Reals, past: float) -> RoughChannel:
    """The channel between the ends of the camber lines, and between the points furthest in and out."""
    numbers = numbers_at(found.match.laws, SPAN)
    extents = found.channel.extents()[0]
    first = extents * numbers[:, START]
    last = first + extents * numbers[:, EXTENT]
    starts, ends = (found.channel.u_at(a) for a in (first, last))
    ends = np.maximum(ends, starts + 0.05)
    low, high = _reached_span(found, machine)
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


def _reached_span(
    found: SectionsInChannel, machine: Reals
) -> tuple[Callable[[Reals], Reals], Callable[[Reals], Reals]]:
    """Lowest and highest v of the points by u, as parabolas."""
    u, v = found.channel.places(machine[:, :2])
    distances = nearest_places(found.shape, unwrapped_in(machine, found.channel), found.match.laws)[2]
    good = distances < 4.0 * np.median(distances) + 0.02 * found.unwrapped.chord
    u, v = u[good], v[good]
    walls = []
    for sign in (1.0, -1.0):
        parts = np.clip((u * 6.0).astype(int), 0, 5)
        index = [np.flatnonzero(parts == part) for part in range(6)]
        chosen = np.array([rows[np.argmin(sign * v[rows])] for rows in index if len(rows)])
        wall = 0.0 if sign > 0.0 else 1.0
        away = np.clip(v[chosen] - wall, -0.15, 0.15)
        bending = 0.3 * np.diff(np.eye(3), n=2, axis=0)
        matrix = np.concatenate([law_basis(3, np.clip(u[chosen], 0.0, 1.0)), bending])
        law = np.linalg.lstsq(matrix, np.concatenate([away, [0.0]]), rcond=None)[0]
        walls.append(lambda at, law=law, wall=wall: wall + law_basis(3, np.clip(at, 0.0, 1.0)) @ law)
    return walls[0], walls[1]
