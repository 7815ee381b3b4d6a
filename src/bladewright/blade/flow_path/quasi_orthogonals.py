"""Meridians brought to one common parameter t, in which points of different ones belong together."""

from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.blade.flow_path.meridional_curve import (
    MeridionalCurve,
    PiecewisePolynomial,
    binomials,
    cubic_pieces,
    real_first,
)
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import level_crossings
from bladewright.nurbs.basis import Reals

NODES = 16
"""Chebyshev nodes of a curve on a panel, where its length is not linear in its own parameter. Panels are halved
until the series ends in rounding."""
FEW_NODES = 5
"""The same where it is linear: the pieces are cubics, which four nodes hold exactly."""
CONVERGED = 1e-15
"""Last terms of the series, as a share of the curve's extent, below which a panel is not halved any more: rounding."""
HALVINGS = 8


def fractions_at(match: PiecewisePolynomial, t: Reals) -> Array:
    """Fractions (..., k) of a curve at real t (k,); past the ends the pieces go on."""
    return match.values(t)[..., 0]


def parameters_at(match: PiecewisePolynomial, levels: Reals, low: float, high: float) -> Reals:
    """The t between `low` and `high` at which real fractions (k,) of a curve are passed."""
    if len(match.breaks) == 2 and match.powers.shape[-2] == 2:
        middle, slope = real_first(match.powers, 3)[0, :, 0]
        return np.asarray((levels - middle) / slope + 0.5 * (match.breaks[0] + match.breaks[1]))
    t = np.linspace(low, high, 513)

    def fractions(at: Reals) -> Reals:
        return real_first(fractions_at(match, at), 1)

    return level_crossings(fractions, t, fractions(t), levels)


def straight_match(start: Array, end: Array) -> PiecewisePolynomial:
    """Fractions from `start` (...) at t = 0 to `end` (...) at t = 1, and on past them."""
    pair = np.stack(np.broadcast_arrays((start + end) / 2.0, end - start), axis=-1)
    return PiecewisePolynomial(breaks=np.array([0.0, 1.0]), powers=pair[..., None, :, None])


def curved_matches(pairs: Array) -> tuple[PiecewisePolynomial, PiecewisePolynomial]:
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
    found = [PiecewisePolynomial(breaks=t, powers=powers[..., k : k + 1]) for k in (0, 1)]
    for match, name in zip(found, ("hub", "shroud"), strict=True):
        at = np.linspace(0.0, 1.0, 513)
        steps = np.diff(real_first(fractions_at(match, at), 1))
        if np.min(steps) <= 0.0:
            near = int(np.argmin(np.abs(t[1:-1] - at[int(np.argmin(steps))])))  # real: places
            raise DesignError(
                f"quasi_orthogonals[{near}]: the smooth curve through the fractions of the {name} turns back near "
                "there, so that quasi-orthogonals cross; spread the pairs more evenly, or give fewer"
            )
    return found[0], found[1]


def matched_curve(curve: MeridionalCurve, match: PiecewisePolynomial, low: float, high: float) -> PiecewisePolynomial:
    """(x, r) of a curve by t from `low` to `high`, to rounding: panels are halved until the series settle."""
    levels = real_first(curve.fraction_at(curve.joints()), 1)
    own = np.sort(np.concatenate([parameters_at(match, levels, low, high), match.breaks[1:-1]]))
    ends = np.concatenate([[low], distinct(own, low, high), [high]])
    count = FEW_NODES if curve.counted is not None and match.powers.shape[-2] == 2 else NODES
    powers, tail = _fitted(curve, match, ends, count)
    for _ in range(0 if count == FEW_NODES else HALVINGS):
        poor = tail > CONVERGED
        if not np.any(poor):
            break
        ends = np.sort(np.concatenate([ends, ((ends[:-1] + ends[1:]) / 2.0)[poor]]))
        powers, tail = _fitted(curve, match, ends, count)
    return PiecewisePolynomial(breaks=ends, powers=powers)


def distinct(places: Reals, low: float, high: float) -> Reals:
    """Increasing places inside (low, high), those that differ by rounding taken once."""
    margin = 1e-12 * (high - low)
    inside = np.sort(places[(places > low + margin) & (places < high - margin)])
    return inside[np.concatenate([[True], np.diff(inside) > margin])] if len(inside) else inside


def _fitted(curve: MeridionalCurve, match: PiecewisePolynomial, ends: Reals, count: int) -> tuple[Array, Reals]:
    """Powers (..., p, count, 2) on each panel, and what their last terms are of the line's extent."""
    places, to_series, to_powers = _rules(count)
    middles, halves = (ends[:-1] + ends[1:]) / 2.0, np.diff(ends) / 2.0
    t = (middles[:, None] + halves[:, None] * places).ravel()
    points = curve.at_fraction(fractions_at(match, t))
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
