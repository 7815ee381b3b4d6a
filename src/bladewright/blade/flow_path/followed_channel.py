"""The duct that a blade in a flow path stands in: its own channel, and past its noses the flow path to its ends.

There hub and shroud end at one u, and each stream line between them moves to the straight line that joins their points
of equal u, which the edges' bows leave.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.polynomial import Polynomial

from bladewright.blade.flow_path.channel import TransfiniteChannel
from bladewright.blade.flow_path.cut_channel import FlowPathWall, with_straight_ends
from bladewright.blade.flow_path.meridional_curve import PiecewisePolynomial, binomials, real_first
from bladewright.blade.flow_path.quasi_orthogonals import matched_curve
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

FADE = 1.0
"""Most of u, in meridional lengths of the blade, over which the bows of the edges fade out: as long as the blade they
come from."""
FADING = Polynomial([1.0, 0.0, 0.0, -10.0, 15.0, -6.0])
"""From 1 at 0 to 0 at 1, with two zero derivatives at both."""
NEAR = 0.05
"""Distance in u from a nose to the end of a wall below which hub and shroud are not brought to end together: they would
have to run many times as fast as each other. The one that ends first goes on straight."""
SAME = 1e-12
"""Distance in u below which joints are one but for rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FollowedChannel:
    """A `MeridionalChannel` by the u of a blade's channel, with which it agrees between the noses."""

    channel: TransfiniteChannel
    """the blade's own"""
    walls: tuple[PiecewisePolynomial, PiecewisePolynomial]
    """hub and shroud by u"""
    noses: tuple[float, float]
    """u between which it is the blade's own channel"""
    ends: tuple[float, float]
    """u at which the flow path starts and ends"""

    def along(self, v: Reals) -> Self:
        """The same: all of its joints are those of all stream lines."""
        del v
        return self

    def real(self) -> "FollowedChannel":
        """The same without imaginary parts and batch."""
        hub, shroud = (replace(wall, powers=real_first(wall.powers, 3)) for wall in self.walls)
        return replace(self, channel=self.channel.real(), walls=(hub, shroud))

    def joints(self) -> Reals:
        """Where the polynomials of stream lines end, u inside the ends, 0 and 1 apart."""
        fades = [self.noses[0] - self._fade(0), *self.noses, self.noses[1] + self._fade(1)]
        own = np.unique(np.concatenate([wall.breaks for wall in self.walls] + [np.array(fades)]))
        own = own[(own > self.ends[0]) & (own < self.ends[1])]
        apart = np.min(np.square(own[:, None] - [0.0, 1.0]), axis=1) > SAME**2
        return own[apart & (np.diff(own, prepend=-np.inf) > SAME)]

    def stream_polynomials(self, v: Reals, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of the stream lines' powers of u - centre."""
        bows = self.channel.bows(v)
        shares = np.stack([self._shares(float(centre)) for centre in centres])
        count = max(wall.powers.shape[-2] for wall in self.walls)
        count = max(count, shares.shape[-1])
        total: Array = np.zeros(())
        for wall, share in zip(self.walls, (1.0 - v, v), strict=True):
            powers = wall.around(centres)
            powers = np.pad(powers, [(0, 0)] * (powers.ndim - 2) + [(0, count - powers.shape[-2]), (0, 0)])
            total = total + share[:, None, None, None] * powers[..., None, :, :, :]
        shares = np.pad(shares, [(0, 0), (0, 0), (0, count - shares.shape[-1])])
        for end, bow in enumerate(bows):
            total = total + shares[:, end, :, None] * bow[..., None, None, :]
        return total

    def _fade(self, end: int) -> float:
        """Extent in u over which the bows fade, upstream (0) or downstream (1)."""
        room = self.noses[0] - self.ends[0] if end == 0 else self.ends[1] - self.noses[1]
        return min(FADE, room)

    def _shares(self, centre: float) -> Reals:
        """Coefficients (2, k) by powers of u - centre of the shares of the leading and the trailing edge's bow."""
        u = Polynomial([centre, 1.0])
        fading = Polynomial([1.0])
        for end, sign in enumerate((-1.0, 1.0)):
            past, fade = sign * (centre - self.noses[end]), self._fade(end)
            if past > 0.0 and fade > 0.0:
                fading = FADING(sign * (u - self.noses[end]) / fade) if past < fade else Polynomial([0.0])
        found = np.zeros((2, len(FADING.coef) + 1))
        for end, share in enumerate((1.0 - u, u)):
            own = (share * fading).coef
            found[end, : len(own)] = own
        return found


def path_ends(walls: tuple[FlowPathWall, FlowPathWall], noses: tuple[float, float]) -> tuple[float, float]:
    """u at which both walls shall end upstream and downstream of the noses, for the real design."""
    found = []
    for end, sign in enumerate((-1.0, 1.0)):
        rooms = _rooms(walls, noses, end)
        room = min(rooms) if min(rooms) > NEAR else max(*rooms, 0.0)
        found.append(noses[end] + sign * room)
    return found[0], found[1]


def followed_channel(
    channel: TransfiniteChannel,
    walls: tuple[FlowPathWall, FlowPathWall],
    noses: tuple[float, float],
    ends: tuple[float, float],
) -> FollowedChannel:
    """The duct of a channel whose walls are cut out of a flow path, its noses and ends by `path_ends` or held."""
    together = [min(_rooms(walls, noses, end)) > NEAR for end in (0, 1)]
    lines = [_to_ends(wall, noses, ends, together) for wall in walls]
    return FollowedChannel(channel=channel, walls=(lines[0], lines[1]), noses=noses, ends=ends)


def _rooms(walls: tuple[FlowPathWall, FlowPathWall], noses: tuple[float, float], end: int) -> list[float]:
    """From a nose to the ends of hub and shroud, in u."""
    return [noses[0] - wall.ends[0] if end == 0 else wall.ends[1] - noses[1] for wall in walls]


def _to_ends(
    wall: FlowPathWall, noses: tuple[float, float], ends: tuple[float, float], together: list[bool]
) -> PiecewisePolynomial:
    """A wall by u that is linear in its length between the noses, and ends at the ends where both walls do."""
    start, stop = wall.at_edges
    speed = stop - start
    breaks = [noses[end] if together[end] else wall.ends[end] for end in (0, 1)]
    none = np.zeros_like(speed)
    pieces = [[start + speed * (0.5 * (breaks[0] + breaks[1])), speed, none, none]]
    for end, sign in enumerate((-1.0, 1.0)):
        if not together[end]:
            continue
        # by the share x of the way from the nose: as fast as beside the blade at 0, at the wall's end at 1
        room = sign * (ends[end] - noses[end])
        at_nose, step = start + speed * noses[end], sign * speed * room
        by_share = np.stack([at_nose, step, none, float(end) - at_nose - step], axis=-1)
        about_middle = (binomials(np.asarray(0.5), 4) @ by_share[..., None])[..., 0]
        piece = [about_middle[..., k] * (sign / room) ** k for k in range(4)]
        pieces.insert(end * len(pieces), piece)
        breaks.insert(end * len(breaks), ends[end])
    powers = np.stack([np.stack(piece, axis=-1) for piece in pieces], axis=-2)
    match = PiecewisePolynomial(breaks=np.array(breaks), powers=powers[..., None])
    return with_straight_ends(matched_curve(wall.line, match, breaks[0], breaks[-1]))
