"""Native curves in (x, r): splines through points or on control points, and straight pieces with rounded corners."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import comb, factorial, perm
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.flow_path.stream_surface_map import Cascade
from bladewright.blade.flow_path.streamlines import StreamLines, stream_lines
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, length, unit
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.nurbs.curve import Curve

ARC = np.pi / 8.0
"""Largest angle of one polynomial piece of an arc [rad]."""
ARC_DEGREE = 11
"""Degree of such a piece: the truncated series of sine and cosine are off by 1e-17 of the radius at its ends."""
DRAWN = 201
"""Points of a drawn curve beside the ends of its pieces."""
ROUNDING = 1e-9
"""Share of a straight piece by which the arcs on it may overlap, as rounding makes them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PiecewisePolynomial:
    """Polynomials of one real parameter, each over its piece; past an end the first and the last go on."""

    breaks: Reals
    """(p + 1,) ends of the pieces"""
    powers: Array
    """(..., p, k, d) coefficients in powers of the parameter less the middle of the piece"""

    def values(self, at: Reals, order: int = 0) -> Array:
        """Values, or derivatives (..., m, d), at real places (m,) of the parameter."""
        piece = np.clip(np.searchsorted(self.breaks, at, side="right") - 1, 0, len(self.breaks) - 2)
        away = (at - ((self.breaks[:-1] + self.breaks[1:]) / 2.0)[piece])[:, None]
        here = self.powers[..., piece, :, :]
        found = np.zeros_like(here[..., 0, :])
        for k in range(self.powers.shape[-2] - 1, order - 1, -1):
            found = found * away + perm(k, order) * here[..., k, :]
        return found

    def around(self, centres: Reals) -> Array:
        """Coefficients (..., c, k, d) in powers of the parameter less each of the centres (c,)."""
        piece = np.clip(np.searchsorted(self.breaks, centres, side="right") - 1, 0, len(self.breaks) - 2)
        away = centres - ((self.breaks[:-1] + self.breaks[1:]) / 2.0)[piece]
        return binomials(away, self.powers.shape[-2]) @ self.powers[..., piece, :, :]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeridionalCurve(PiecewisePolynomial):
    """A curve in (x, r) [m] by its own parameter, from 0 to 1, and the same as a B-spline.

    What a design's numbers decide may be complex and carry a leading batch axis. Where pieces join at places
    that move with the design, the real design's places bound the pieces: the joined polynomials agree there to as many
    derivatives as are continuous.
    """

    net: Array
    """(..., n, 2) control points of the same curve as a B-spline"""
    knots: Reals
    """(n + degree + 1,) its knots"""
    corners: tuple[float, ...] = ()
    """own parameters where the direction is not continuous"""
    counted: Array | None = None
    """(...) the sum of chords over mean radii, where the parameter counts it in equal steps; none elsewhere"""

    point_ends: Literal["smooth", "released"] | None = None
    """how the cubic spline through given points ends; None: a curve of another kind"""

    def real(self) -> "MeridionalCurve":
        """The same without imaginary parts and batch."""
        if not np.iscomplexobj(self.powers):
            return self
        counted = None if self.counted is None else real_first(self.counted, 0)
        return replace(self, powers=real_first(self.powers, 3), net=real_first(self.net, 2), counted=counted)

    @property
    def degree(self) -> int:
        """Degree of the B-spline."""
        return len(self.knots) - self.net.shape[-2] - 1

    def joints(self) -> Reals:
        """Where the curve loses derivatives."""
        return self.breaks[1:-1]

    @property
    def drawn_points(self) -> Reals:
        """Points (n, 2) of the real design, with the ends of all pieces, for pictures."""
        drawn: Reals = np.real(self.values(np.unique(np.concatenate([np.linspace(0.0, 1.0, DRAWN), self.breaks]))))
        return drawn

    def smoothness(self) -> tuple[Reals, NDArray[np.intp]]:
        """Own parameters (n,) at which the curve loses derivatives, and how many it keeps there (n,)."""
        levels, counts = np.unique(self.knots[self.degree + 1 : -self.degree - 1], return_counts=True)
        if self.point_ends is None:
            return levels, self.degree - counts
        # one cubic goes over the first two intervals, and one over the last two
        levels = levels[1:-1] if self.point_ends == "smooth" else levels
        # it keeps two derivatives, though its knots, which move with the points, would let it lose one
        return levels, np.full(len(levels), 2)

    def stream_polynomials(self, v: Reals, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of the powers of the parameter less each centre."""
        found = self.around(centres)[..., None, :, :, :]
        return np.broadcast_to(found, (*found.shape[:-4], len(v), *found.shape[-3:]))

    @cached_property
    def by_length(self) -> StreamLines | None:
        """The curve by its length; none where its own parameter counts the sum of chords over mean radii."""
        return stream_lines(self, Cascade(), np.zeros(1), 0.0, 0.0) if self.counted is None else None

    def parameter_at(self, fraction: Array) -> Array:
        """The own parameter (..., k) at fractions (..., k) of the length, or of what the parameter counts."""
        if self.by_length is None:
            return fraction
        whole = self.by_length.extents()[..., 0]
        return self.by_length.u_at((fraction * whole[..., None])[..., None, :])[..., 0, :]

    def fraction_at(self, own: Array) -> Array:
        """Fractions (..., k) of the length, or of what the parameter counts, at own parameters (..., k) or (k,)."""
        if self.by_length is None or own.shape[-1] == 0:
            return own
        return self.by_length.abscissa(own[..., None, :])[..., 0, :] / self.by_length.extents()

    def at_fraction(self, fraction: Array) -> Array:
        """(x, r) (..., k, 2) at fractions (..., k) of the length, or of what the parameter counts."""
        own = self.parameter_at(fraction)
        if self.by_length is not None:
            return self.by_length.position(own[..., None, :])[..., 0, :, :]
        real = real_first(own, 1)
        away = own - real
        value, slope = self.values(real), self.values(real, 1)
        return value + away[..., None] * slope if np.iscomplexobj(away) else value

    def curve(self) -> Curve:
        """The same as a native curve over its own parameter."""
        return Curve(control_points=self.net, knots=self.knots, degree=self.degree)


def binomials(away: Array, count: int) -> Array:
    """Matrices (..., count, count) that take powers of t to powers of t - away (...)."""
    j = np.arange(count)
    factors = np.array([[comb(a, b) for a in range(count)] for b in range(count)], dtype=np.float64)
    return factors * away[..., None, None] ** np.maximum(j[None, :] - j[:, None], 0)


def spline_on(points: Array, degree: int) -> MeridionalCurve:
    """The clamped uniform B-spline on control points (..., n, 2)."""
    knots = uniform_knots(points.shape[-2], degree)
    breaks = np.unique(knots)
    middles = (breaks[:-1] + breaks[1:]) / 2.0
    rows = np.stack([basis(knots, degree, middles, k) / factorial(k) for k in range(degree + 1)], axis=1)
    return MeridionalCurve(breaks=breaks, powers=rows @ points[..., None, :, :], net=points, knots=knots)


def spline_through(
    points: Array, *, conformal: bool = False, ends: Literal["smooth", "released"] = "smooth"
) -> MeridionalCurve:
    """The cubic spline through points (..., n, 2), its parameter in proportion to the chords' lengths.

    `conformal` divides each length by the mean radius of its ends; the sum is then an approximation of m'. `ends`
    "smooth" leaves out the first and last inner joint; "released" has no second derivative at the first and no third
    at the last point.
    """
    steps = length(np.diff(points, axis=-2))
    if conformal:
        steps = 2.0 * steps / (points[..., 1:, 1] + points[..., :-1, 1])
    total = np.sum(steps, axis=-1)
    sites, powers = cubic_pieces(steps / total[..., None], points, ends)
    breaks = real_first(sites, 1)
    breaks[-1] = 1.0
    middles = (breaks[:-1] + breaks[1:]) / 2.0
    powers = binomials(middles - sites[..., :-1], 4) @ powers
    # two derivatives are continuous, but only one of their change as the places of the points move
    net, knots = joined_net(powers, breaks, np.ones(len(breaks) - 2, dtype=int))
    return MeridionalCurve(
        breaks=breaks, powers=powers, net=net, knots=knots, counted=total if conformal else None, point_ends=ends
    )


def cubic_pieces(steps: Array, values: Array, ends: str = "smooth") -> tuple[Array, Array]:
    """Sites (..., n), from 0, and the C2 cubic through values (..., n, d) there.

    The cubic is (..., n - 1, 4, d), powers of the distance from the site at which a piece starts. By the second
    derivatives at the sites, Ahlberg, Nilson and Walsh 1967, eq. 2.1.7.
    """
    batch = np.broadcast_shapes(steps.shape[:-1], values.shape[:-2])
    steps = np.broadcast_to(steps, (*batch, steps.shape[-1]))
    bends = _bends(steps, values, ends)
    h = steps[..., None]
    first = np.diff(values, axis=-2) / h - h * (2.0 * bends[..., :-1, :] + bends[..., 1:, :]) / 6.0
    parts = [values[..., :-1, :], first, bends[..., :-1, :] / 2.0, np.diff(bends, axis=-2) / (6.0 * h)]
    sites = np.concatenate([np.zeros_like(steps[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)
    return sites, np.stack(np.broadcast_arrays(*parts), axis=-2)


def _bends(h: Array, values: Array, ends: str) -> Array:
    """Second derivatives (..., n, d) at the sites, the tridiagonal system eliminated in order."""
    count = h.shape[-1]
    shape = (*np.broadcast_shapes(h.shape[:-1], values.shape[:-2]), count + 1, values.shape[-1])
    found: Array = np.zeros(shape, dtype=np.result_type(h, values))
    if count == 1:
        return found
    chords = np.diff(values, axis=-2) / h[..., None]
    right = 6.0 * np.diff(chords, axis=-2)
    if count == 2:
        weight = 3.0 if ends == "smooth" else 2.0
        last = 0.0 if ends == "smooth" else 1.0
        middle = right[..., 0, :] / (weight * (h[..., 0] + h[..., 1]) + last * h[..., 1])[..., None]
        found[..., 1:, :] = middle[..., None, :]
        found[..., 0, :] = middle if ends == "smooth" else 0.0
        return found
    lower, upper = np.array(h[..., :-1]), np.array(h[..., 1:])
    own = np.asarray(2.0 * (h[..., :-1] + h[..., 1:]))
    if ends == "smooth":
        start = h[..., 0] / h[..., 1]
        end = h[..., -1] / h[..., -2]
        own[..., 0] += h[..., 0] * (1.0 + start)
        upper[..., 0] -= h[..., 0] * start
        own[..., -1] += h[..., -1] * (1.0 + end)
        lower[..., -1] -= h[..., -1] * end
    else:
        own[..., -1] += h[..., -1]
    right = np.array(np.broadcast_to(right, (*shape[:-2], count - 1, shape[-1])))
    for i in range(1, count - 1):
        factor = lower[..., i] / own[..., i - 1]
        own[..., i] -= factor * upper[..., i - 1]
        right[..., i, :] -= factor[..., None] * right[..., i - 1, :]
    found[..., count - 1, :] = right[..., -1, :] / own[..., -1, None]
    for i in range(count - 3, -1, -1):
        found[..., i + 1, :] = (right[..., i, :] - upper[..., i, None] * found[..., i + 2, :]) / own[..., i, None]
    if ends == "smooth":
        found[..., 0, :] = (1.0 + start)[..., None] * found[..., 1, :] - start[..., None] * found[..., 2, :]
        found[..., -1, :] = (1.0 + end)[..., None] * found[..., -2, :] - end[..., None] * found[..., -3, :]
    else:
        found[..., -1, :] = found[..., -2, :]
    return found


def joined_net(powers: Array, breaks: Reals, smooth: Reals) -> tuple[Array, Reals]:
    """Control points and knots of a B-spline whose joints keep `smooth` derivatives each, 0 or 1."""
    degree = powers.shape[-2] - 1
    width = np.diff(breaks)[:, None, None]
    k = np.arange(degree + 1)
    # powers of the parameter from the start of a piece, in units of its width, then Bernstein's
    scaled = binomials(-np.diff(breaks) / 2.0, degree + 1) @ powers * width ** k[:, None]
    rows = np.array(
        [[comb(i, j) / comb(degree, j) if j <= i else 0.0 for j in range(degree + 1)] for i in range(degree + 1)]
    )
    bezier = rows @ scaled
    parts = [bezier[..., 0, :1, :]]
    knots = [np.zeros(degree + 1)]
    for i in range(len(breaks) - 1):
        last = i == len(breaks) - 2
        kept = slice(1, None) if last or smooth[i] == 0 else slice(1, -1)
        parts.append(bezier[..., i, kept, :])
        if not last:
            knots.append(np.full(degree - int(smooth[i]), breaks[i + 1]))
    return np.concatenate(parts, axis=-2), np.concatenate([*knots, np.ones(degree + 1)])


def real_first(values: Array, axes: int) -> Reals:
    """Real parts of the first of a batch, as a copy; `axes` is what one of the batch has."""
    return np.array(np.real(values[(0,) * (np.ndim(values) - axes)]), dtype=np.float64)


def rounded_corners(points: Array, radii: Array, metre: float = 1.0) -> MeridionalCurve:
    """Straight pieces from point to point (..., n, 2), the inner ones rounded by tangent arcs of radii (..., n - 2).

    Raises DesignError where an arc does not fit between its neighbours, or the line turns back on itself. `metre` is
    the length unit of what it says.
    """
    along = unit(np.diff(points, axis=-2))
    sides = length(np.diff(points, axis=-2))
    turn = cross2(along[..., :-1, :], along[..., 1:, :])
    onwards = 1.0 + dot(along[..., :-1, :], along[..., 1:, :])
    _check_turns(real_first(onwards, 1))
    half = turn / onwards
    sign = np.where(np.real(turn) < 0.0, -1.0, 1.0)
    cut = radii * half * sign
    _check_room(real_first(sides, 1), real_first(cut, 1), metre)
    cut = np.broadcast_to(cut, (*np.broadcast_shapes(cut.shape[:-1], sides.shape[:-1]), cut.shape[-1]))
    none = np.zeros((*cut.shape[:-1], 1))
    before, after = np.concatenate([none, cut], axis=-1), np.concatenate([cut, none], axis=-1)
    starts = points[..., :-1, :] + before[..., None] * along
    straight = sides - before - after
    pieces, lengths, smooth = [], [], []
    whole = float(np.sum(real_first(sides, 1)))
    for i in range(sides.shape[-1]):
        if float(real_first(straight, 1)[i]) > ROUNDING * whole:
            middle = starts[..., i, :] + 0.5 * straight[..., i, None] * along[..., i, :]
            pieces.append([middle, straight[..., i, None] * along[..., i, :]])
            lengths.append(straight[..., i])
            smooth.append(1)
        if i == sides.shape[-1] - 1:
            continue
        if float(real_first(cut, 1)[i]) <= ROUNDING * whole:
            smooth[-1] = int(float(real_first(turn, 1)[i]) ** 2 < ROUNDING**2)
            continue
        angle = 2.0 * np.arctan(half[..., i])
        end = points[..., i + 1, :] - cut[..., i, None] * along[..., i, :]
        for piece in _arc(end, along[..., i, :], radii[..., i] * sign[..., i], angle):
            pieces.append(piece)
            lengths.append(radii[..., i] * angle * sign[..., i] / _parts(angle))
            smooth.append(1)
    steps = np.stack([real_first(each, 0) for each in lengths])
    breaks = np.concatenate([[0.0], np.cumsum(steps) / np.sum(steps)])
    breaks[-1] = 1.0
    widths = np.diff(breaks)
    degree = max(len(piece) for piece in pieces) - 1
    powers = np.stack(
        np.broadcast_arrays(*[_padded(piece, w, degree) for piece, w in zip(pieces, widths, strict=True)])
    )
    powers = np.moveaxis(powers, 0, -3)
    net, knots = joined_net(powers, breaks, np.zeros(len(widths) - 1, dtype=int))
    sharp = tuple(float(breaks[i + 1]) for i, kept in enumerate(smooth[:-1]) if kept == 0)
    return MeridionalCurve(breaks=breaks, powers=powers, net=net, knots=knots, corners=sharp)


def _arc(start: Array, along: Array, radius: Array, angle: Array) -> list[list[Array]]:
    """Pieces of an arc that leaves a point (..., 2) along a direction; powers of w from -1/2 to 1/2 of each."""
    count = _parts(angle)
    normal = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    centre = start + radius[..., None] * normal
    pieces = []
    for i in range(count):
        step = angle / count
        middle = (i + 0.5) * step
        out = np.sin(middle)[..., None] * along - np.cos(middle)[..., None] * normal
        on = np.cos(middle)[..., None] * along + np.sin(middle)[..., None] * normal
        terms = [
            (radius * step**k)[..., None] * ((-1.0) ** (k // 2) / factorial(k)) * (on if k % 2 else out)
            for k in range(ARC_DEGREE + 1)
        ]
        terms[0] = terms[0] + centre
        pieces.append(terms)
    return pieces


def _parts(angle: Array) -> int:
    size = float(real_first(angle, 0))
    return max(1, int(np.ceil(max(size, -size) / ARC - ROUNDING)))


def _padded(piece: list[Array], width: float, degree: int) -> Array:
    """Powers (..., degree + 1, 2) of the own parameter from those of w, which runs over one."""
    batch = np.broadcast_shapes(*[term.shape for term in piece])
    zero = np.zeros(batch)
    terms = [np.broadcast_to(term, batch) / width**k for k, term in enumerate(piece)]
    return np.stack(np.broadcast_arrays(*terms, *[zero] * (degree + 1 - len(terms))), axis=-2)


def _check_turns(onwards: Reals) -> None:
    for i, value in enumerate(onwards):
        if value < 1e-6:
            raise DesignError(
                f"corners[{i + 1}]: the line turns back on itself there; a corner must turn by less than 180 deg; "
                "put a further corner in"
            )


def _check_room(sides: Reals, cut: Reals, metre: float) -> None:
    """Refuse arcs that need more of a straight piece than there is."""
    ends = np.concatenate([[0.0], cut, [0.0]])
    needed = ends[:-1] + ends[1:]
    for i, (taken, given) in enumerate(zip(needed, sides, strict=True)):
        if taken > given * (1.0 + ROUNDING):
            beside = " and ".join(f"radii[{k - 1}]" for k in (i, i + 1) if 0 < k < len(ends) - 1)
            raise DesignError(
                f"{beside}: the arcs take {taken / metre:.6g} of the straight piece between corners[{i}] and "
                f"corners[{i + 1}], which is {given / metre:.6g} long; take smaller radii, or move the corners apart"
            )
