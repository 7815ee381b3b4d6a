"""Meridians brought to one common parameter t, in which points of different ones belong together."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, binomials, cubic_pieces, piecewise, real_first
from bladewright.blade.flow_path.stream_surface_map import Cascade
from bladewright.blade.flow_path.streamlines import StreamLines, stream_lines
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import level_crossings
from bladewright.nurbs.basis import Reals

NODES = 16
"""Chebyshev nodes of a line on a panel, where its length is not linear in its own parameter"""
FEW = 5
"""the same where it is: the pieces are cubics"""
SETTLED = 1e-15
"""last terms of the series, of the line's extent, below which panels are not halved any more"""
HALVINGS = 8


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredCurve:
    """A meridian with the measure along it: its length, or the sum of chords over radii where it counts that."""

    line: MeridionalCurve
    lines: StreamLines | None
    """the line by its length; none where its own parameter is the measure"""

    @property
    def whole(self) -> Array:
        """(...) the measure of all of it: metres, or as m'."""
        return self.line.counted if self.lines is None else self.lines.extents()[..., 0]  # type: ignore[return-value]

    def own(self, fraction: Array) -> Array:
        """The own parameter (..., k) at fractions (..., k) of the measure."""
        if self.lines is None:
            return fraction
        return self.lines.u_at((fraction * self.whole[..., None])[..., None, :])[..., 0, :]

    def fractions(self, own: Array) -> Array:
        """Fractions (..., k) of the measure at own parameters (..., k) or (k,)."""
        if self.lines is None or own.shape[-1] == 0:
            return own
        return self.lines.abscissa(own[..., None, :])[..., 0, :] / self.whole[..., None]

    def position(self, fraction: Array) -> Array:
        """(x, r) (..., k, 2) at fractions (..., k) of the measure."""
        own = self.own(fraction)
        if self.lines is not None:
            return self.lines.position(own[..., None, :])[..., 0, :, :]
        real = real_first(own, 1)
        away = own - real
        value, slope = self.line.values(real), self.line.values(real, 1)
        return value + away[..., None] * slope if np.iscomplexobj(away) else value


def measured_curve(line: MeridionalCurve) -> MeasuredCurve:
    """A meridian with its measure."""
    if line.counted is not None:
        return MeasuredCurve(line=line, lines=None)
    return MeasuredCurve(line=line, lines=stream_lines(line, Cascade(), np.zeros(1), 0.0, 0.0))


@dataclass(frozen=True, kw_only=True, eq=False)
class Match:
    """The fraction of a line's measure as a function of t: one straight piece, or a smooth curve of cubics."""

    breaks: Reals
    """(q + 1,) ends of the pieces in t"""
    powers: Array
    """(..., q, k, 1) coefficients in powers of t less the middle of the piece"""

    def fractions(self, t: Reals) -> Array:
        """Fractions (..., k) at real t (k,); past the ends the pieces go on."""
        return piecewise(self.powers, self.breaks, t)[..., 0]

    def places(self, levels: Reals, low: float, high: float) -> Reals:
        """t at which real fractions (k,) are passed."""
        if len(self.breaks) == 2 and self.powers.shape[-2] == 2:
            middle, slope = real_first(self.powers, 3)[0, :, 0]
            return np.asarray((levels - middle) / slope + 0.5 * (self.breaks[0] + self.breaks[1]))
        t = np.linspace(low, high, 513)

        def fractions(at: Reals) -> Reals:
            return real_first(self.fractions(at), 1)

        return level_crossings(fractions, t, fractions(t), levels)


def straight_match(start: Array, end: Array) -> Match:
    """Fractions from `start` (...) at t = 0 to `end` (...) at t = 1, and on past them."""
    pair = np.stack(np.broadcast_arrays((start + end) / 2.0, end - start), axis=-1)
    return Match(breaks=np.array([0.0, 1.0]), powers=pair[..., None, :, None])


def curved_matches(pairs: Array) -> tuple[Match, Match]:
    """Matches of hub and shroud whose fractions meet in pairs (..., n, 2), with 0 and 1 added; t is their mean.

    Raises DesignError where a curve through the fractions does not increase.
    """
    batch = pairs.shape[:-2]
    ends = [np.broadcast_to(value, (*batch, 1, 2)) for value in (0.0, 1.0)]
    all_pairs = np.concatenate([ends[0], pairs, ends[1]], axis=-2)
    means = np.mean(all_pairs, axis=-1)
    sites, powers = cubic_pieces(np.diff(means), all_pairs)
    t = real_first(means, 1)
    powers = binomials((t[:-1] + t[1:]) / 2.0 - sites[..., :-1], 4) @ powers
    found = [Match(breaks=t, powers=powers[..., k : k + 1]) for k in (0, 1)]
    for match, name in zip(found, ("hub", "shroud"), strict=True):
        at = np.linspace(0.0, 1.0, 513)
        steps = np.diff(real_first(match.fractions(at), 1))
        if np.min(steps) <= 0.0:
            near = int(np.argmin(np.abs(t[1:-1] - at[int(np.argmin(steps))])))  # real: places
            raise DesignError(
                f"quasi_orthogonals[{near}]: the smooth curve through the fractions of the {name} turns back near "
                "there, so that quasi-orthogonals cross; spread the pairs more evenly, or give fewer"
            )
    return found[0], found[1]


@dataclass(frozen=True, kw_only=True, eq=False)
class MatchedLine:
    """A line as polynomials of t."""

    breaks: Reals
    """(p + 1,) ends of the panels in t"""
    powers: Array
    """(..., p, k, 2) coefficients of (x, r) in powers of t less the middle of the panel"""

    def values(self, t: Reals, order: int = 0) -> Array:
        """Points, or derivatives by t (..., m, 2), at real t (m,)."""
        return piecewise(self.powers, self.breaks, t, order)


def matched_line(along: MeasuredCurve, match: Match, low: float, high: float) -> MatchedLine:
    """A line as polynomials of t from `low` to `high`, to rounding: panels are halved until the series settle."""
    levels = real_first(along.fractions(along.line.joints()), 1)
    own = np.sort(np.concatenate([match.places(levels, low, high), match.breaks[1:-1]]))
    ends = np.concatenate([[low], distinct(own, low, high), [high]])
    count = FEW if along.lines is None and match.powers.shape[-2] == 2 else NODES
    powers, tail = _fitted(along, match, ends, count)
    for _ in range(0 if count == FEW else HALVINGS):
        poor = tail > SETTLED
        if not np.any(poor):
            break
        ends = np.sort(np.concatenate([ends, ((ends[:-1] + ends[1:]) / 2.0)[poor]]))
        powers, tail = _fitted(along, match, ends, count)
    return MatchedLine(breaks=ends, powers=powers)


def distinct(places: Reals, low: float, high: float) -> Reals:
    """Increasing places inside (low, high), those that differ by rounding taken once."""
    room = 1e-12 * (high - low)
    inside = np.sort(places[(places > low + room) & (places < high - room)])
    return inside[np.concatenate([[True], np.diff(inside) > room])] if len(inside) else inside


def _fitted(along: MeasuredCurve, match: Match, ends: Reals, count: int) -> tuple[Array, Reals]:
    """Powers (..., p, count, 2) on each panel, and what their last terms are of the line's extent."""
    places, to_series, to_powers = _rules(count)
    middles, halves = (ends[:-1] + ends[1:]) / 2.0, np.diff(ends) / 2.0
    t = (middles[:, None] + halves[:, None] * places).ravel()
    points = along.position(match.fractions(t))
    points = points.reshape(*points.shape[:-2], len(middles), count, 2)
    series = to_series @ points
    real = real_first(series, 3)
    extent = float(np.max(np.ptp(real_first(points, 3).reshape(-1, 2), axis=0)))
    tail = np.max(np.square(real[:, -2:]), axis=(1, 2)) ** 0.5 / extent
    return (to_powers @ series) / (halves[:, None] ** np.arange(count))[..., None], tail


@cache
def _rules(count: int) -> tuple[Reals, Reals, Reals]:
    """Chebyshev places, the matrix from values there to the series, and from the series to powers."""
    places = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    to_series = np.asarray(np.linalg.inv(chebyshev.chebvander(places, count - 1)), dtype=np.float64)
    rows = [chebyshev.cheb2poly(row) for row in np.eye(count)]
    to_powers = np.array([np.pad(row, (0, count - len(row))) for row in rows], dtype=np.float64).T
    return places, to_series, to_powers
