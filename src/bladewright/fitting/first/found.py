"""What is found of a blade on the way to its design: a channel, and sections on its stream surfaces."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bladewright.fitting.first.camber import first_laws, parted
from bladewright.fitting.first.channel import SPAN, Rough
from bladewright.fitting.first.laid import Laid, numbers_at
from bladewright.fitting.first.matching import Match, matched
from bladewright.fitting.first.shape import (
    EXTENT,
    FIRST_THICKNESS,
    ROOT_IN,
    ROOT_OUT,
    START,
    Shape,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis

BANDS, FEWEST, TOLD = 9, 12, 3
"""bands along the span whose points tell the direction of the chord there, the least of them, and control points of
what is told"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """A channel, and sections on its stream surfaces."""

    channel: Rough
    shape: Shape
    laid: Laid
    match: Match


def laid_in(machine: Reals, channel: Rough) -> Laid:
    """Points (n, 3) in x, r and theta, or x, z and y, laid in the planes of a channel's stream surfaces."""
    u, v = channel.places(machine[:, :2])
    a = channel.abscissa(u, v)
    size = 1.0 / machine[:, 1] if channel.revolved else np.ones(len(machine))
    length = float(np.median(channel.extents()[1]))
    return Laid(
        points=np.stack([a, machine[:, 2]], axis=-1), v=np.clip(v, 0.0, 1.0), size=size, chord=length, ratio=1.0
    )


def shape_in(channel: Rough, chordwise: tuple[int, int], samples: int, clustering: float) -> Shape:
    """The family's sections on a channel's stream surfaces."""
    return Shape(chordwise=chordwise, samples=samples, clustering=clustering, scale=channel.size, extent=channel.extent)


def matched_in(machine: Reals, channel: Rough, chordwise: tuple[int, int], count: int, *, turns: int) -> Found:
    """What is found in a channel without a guess: `count` control points of the laws along the span."""
    laid = laid_in(machine, channel)
    shape = shape_in(channel, chordwise, 16, 1.0)
    turn, lean, chord = _direction(laid)
    laid = replace(laid, chord=chord, ratio=chord / laid.chord)
    known = parted(shape, laid, turn, lean)
    laid = replace(laid, upper=known.upper, sure=known.sure)
    match = matched(shape, laid, first_laws(shape, laid, turn, lean, count), turns=turns)
    return Found(channel=channel, shape=shape, laid=laid, match=match)


def continued_in(
    machine: Reals,
    channel: Rough,
    before: Found,
    shape: Shape,
    count: int,
    *,
    ends: bool,
    parting: bool,
) -> Found:
    """What is found in another channel from the sections found in the one before.

    `parting` holds points to the side that they are seen to belong to.
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
    laid = laid_in(machine, channel)
    laid = replace(laid, chord=before.laid.chord, ratio=before.laid.chord / laid.chord)
    if parting:
        turn, lean, _ = _direction(laid)
        known = parted(shape, laid, turn, lean)
        laid = replace(laid, upper=known.upper, sure=known.sure)
    match = matched(shape, laid, laws, turns=10, stiff=0.3, ends=ends, among=True)
    return Found(channel=channel, shape=shape, laid=laid, match=match)


def _direction(laid: Laid) -> tuple[Callable[[Reals], Reals], Reals, float]:
    """Angle of the chord by place along the span, law of the middle ordinate, and the typical chord [m]."""
    rows = law_basis(TOLD, laid.v) / laid.size[:, None]
    lean = np.asarray(np.linalg.lstsq(rows, laid.points[:, 1] / laid.size, rcond=None)[0])
    places, angles, chords = [], [], []
    for middle in np.linspace(0.0, 1.0, BANDS):
        band = (laid.v - middle) ** 2 < (1.5 / BANDS) ** 2
        if np.count_nonzero(band) < FEWEST:
            continue
        metres = laid.points[band] / np.median(laid.size[band])
        trend = np.column_stack([np.ones(len(metres)), laid.v[band]])
        metres = metres - trend @ np.linalg.lstsq(trend, metres, rcond=None)[0]
        _, turned = np.linalg.eigh(metres.T @ metres)
        along = metres @ turned[:, 1]
        places.append(float(np.mean(laid.v[band])))
        angles.append(float(np.arctan2(*(turned[::-1, 1] * np.sign(turned[0, 1] + 1e-300)))))
        chords.append(float(np.percentile(along, 98.0) - np.percentile(along, 2.0)))
    count = min(TOLD, len(places))
    law = np.linalg.lstsq(law_basis(count, np.array(places)), np.array(angles), rcond=None)[0]

    def turn(v: Reals) -> Reals:
        return np.clip(law_basis(count, v) @ law, -np.radians(86.0), np.radians(86.0))

    return turn, lean, float(np.median(chords))


def apart(found: Found, machine: Reals) -> float:
    """Mean distance [m] of most points from the sections, and from the channel where they lie outside its walls."""
    u, v = found.channel.places(machine[:, :2])
    outside = machine[:, :2] - found.channel.position(u, np.clip(v, 0.0, 1.0))
    distances = np.sqrt(found.match.distances**2 + np.sum(outside**2, axis=-1))
    return float(np.mean(np.sort(distances)[: max(1, int(0.94 * len(distances)))]))
