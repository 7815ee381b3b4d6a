"""Native stream surfaces of a flow path: hub, shroud and the surfaces between them, by a parameter t along the flow."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import Meridian
from bladewright.blade.flow_path.intersections import meeting
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, PiecewisePolynomial, real_first
from bladewright.blade.flow_path.quasi_orthogonals import (
    curved_matches,
    distinct,
    fractions_at,
    matched_curve,
    straight_match,
)
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import stacked

SAME = 1e-12
"""Span fractions nearer than this are the same: rounding."""
FOLDED = 1e-4
"""Jacobian of the map (t, v) -> (x, r), as a share of its median, below which the surfaces count as folded. It is
positive so that cells thinner than the grid on which it is looked for are refused too."""
KEPT = 0.1
"""How far before and behind the blade, in t, surfaces that are matched at its edges must not fold: a tenth of the
blade, for its rounded edges. Beyond, the flow path ends where they fold."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StreamSurfaces:
    """The map (t, v) -> (x, r) in metres of a flow path: v from 0 at the hub to 1 at the shroud.

    It is a `MeridionalChannel`: `stream_lines(surfaces, mapping, v, -low, high - 1)` gives its stream lines,
    t in place of u.
    """

    matched: tuple[PiecewisePolynomial, ...]
    """hub, given stream surfaces, shroud by t"""
    spans: Reals
    """(j,) their span fractions"""
    low: float
    """t at which the flow path starts: 0, or less where t counts from a leading edge"""
    high: float
    """t at which it ends: 1, or more where t counts to a trailing edge"""
    curves: tuple[MeridionalCurve, ...]
    """hub, given stream surfaces, shroud by their own parameters"""
    matches: tuple[PiecewisePolynomial, ...]
    """by t the fraction of each one's length, or of what its parameter counts"""
    chosen: tuple[int, ...] | None = None
    """the only curves whose joints count, where just some span fractions are of interest; none: all"""

    def wall(self, name: str) -> MeridionalCurve:
        """Hub or shroud by its own parameter."""
        return self.curves[0 if name == "hub" else -1]

    @property
    def extent(self) -> tuple[float, float]:
        """t at which the flow path starts and ends."""
        return self.low, self.high

    def joints(self) -> Reals:
        """Where the polynomials of stream lines end, t inside (low, high), 0 and 1 apart."""
        which = range(len(self.matched)) if self.chosen is None else self.chosen
        places = distinct(np.concatenate([self.matched[j].breaks for j in which]), self.low, self.high)
        ends = np.array([0.0, 1.0])
        return places[np.min(np.square(places[:, None] - ends), axis=1) > SAME**2]

    def along(self, v: Reals) -> "StreamSurfaces":
        """The same for v (m,) alone: joints of lines that have no part in these stream lines are left out."""
        parts = np.any(self.shares(v) != 0.0, axis=0)
        return replace(self, chosen=tuple(int(j) for j in np.flatnonzero(parts)))

    def real(self) -> "StreamSurfaces":
        """The same without imaginary parts and batch, its measures as they are."""
        matched = tuple(replace(each, powers=real_first(each.powers, 3)) for each in self.matched)
        return replace(self, matched=matched)

    def span_joints(self) -> Reals:
        """Inner v at which two derivatives across the stream surfaces are continuous only."""
        return np.unique(self._cardinals.t)[1:-1]

    def shares(self, v: Array, order: int = 0) -> Array:
        """Shares (len(v), j) of the lines in the stream lines at v (m,), or their derivatives by v."""
        at = np.real(v)
        if np.min(at, initial=0.0) < -SAME or np.max(at, initial=1.0) > 1.0 + SAME:
            worst = float(at[np.argmax(np.maximum(-at, at - 1.0))])
            raise DesignError(
                f"a stream surface was asked at v = {worst:g}: v runs from 0 at the hub to 1 at the shroud"
            )
        found: Array = self._cardinals(at, nu=order)
        if order == 0:
            near = np.square(at[:, None] - self.spans) < SAME**2
            found = np.where(np.any(near, axis=1)[:, None], near.astype(float), found)
        if np.iscomplexobj(v):
            found = found + 1j * np.imag(v)[:, None] * self.shares(at, order + 1)
        return found

    def stream_polynomials(self, v: Array, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of (x, r) in powers of t - centre, around each centre."""
        shares = self.shares(v)
        count = max(each.powers.shape[-2] for each in self.matched)
        total: Array = np.zeros(())
        for j, each in enumerate(self.matched):
            if not np.any(shares[:, j]):
                continue
            part = shares[:, j, None, None, None] * each.around(centres)[..., None, :, :, :]
            padding = [(0, 0)] * (part.ndim - 2) + [(0, count - part.shape[-2]), (0, 0)]
            total = total + np.pad(part, padding)
        return total

    def at(self, t: Reals, v: Reals) -> tuple[Array, Array, Array]:
        """(x, r) at pairs of real t and v (m,), and its derivatives by t and by v, (..., m, 2) each."""
        rows, slopes = (self._rows(t, order) for order in (0, 1))
        shares, by_v = self.shares(v), self.shares(v, 1)
        point, along, across = (
            np.einsum("mj,...jmd->...md", weights, parts)
            for weights, parts in ((shares, rows), (shares, slopes), (by_v, rows))
        )
        return point, along, across

    def bends(self, t: Reals, v: Reals) -> tuple[Array, Array]:
        """Second derivatives (..., m, 2) of (x, r) by t, and by t and v, at pairs of real t and v (m,)."""
        slopes, bends = (self._rows(t, order) for order in (1, 2))
        along, mixed = (
            np.einsum("mj,...jmd->...md", weights, parts)
            for weights, parts in ((self.shares(v), bends), (self.shares(v, 1), slopes))
        )
        return along, mixed

    def grid(self, t: Reals, v: Reals) -> tuple[Array, Array, Array]:
        """(x, r) on a grid of real t (k,) and v (m,), and its derivatives by t and by v, (..., k, m, 2) each."""
        rows, slopes = (self._rows(t, order) for order in (0, 1))
        shares, by_v = self.shares(v), self.shares(v, 1)
        point, along, across = (
            np.einsum("mj,...jkd->...kmd", weights, parts)
            for weights, parts in ((shares, rows), (shares, slopes), (by_v, rows))
        )
        return point, along, across

    def position(self, v: Reals, t: Reals, order: int = 0) -> Array:
        """(x, r) or derivatives by t (..., m, k, 2) on the stream lines at v (m,), at real t (m, k)."""
        shares = np.repeat(self.shares(v), t.shape[1], axis=0)
        found = np.einsum("mj,...jmd->...md", shares, self._rows(t.ravel(), order))
        return found.reshape(*found.shape[:-2], *t.shape, 2)

    def _rows(self, t: Reals, order: int) -> Array:
        """Points, or derivatives by t (..., j, k, 2), of the lines."""
        return np.stack(np.broadcast_arrays(*[each.values(t, order) for each in self.matched]), axis=-3)

    def counted(self, v: Reals) -> tuple[Array, Array]:
        """m' (..., m) as lines with `spacing` "conformal" count it: at t = 0, and its increase by t; linear in t.

        Raises DesignError where a line counts its length instead.
        """
        wholes = [each.counted for each in self.curves]
        if any(whole is None for whole in wholes):
            raise DesignError(
                "hub, shroud or stream_surfaces: m' was asked as the points' spacing counts it, which needs all of "
                "them given by points with spacing 'conformal'; give them so, or ask for the exact m'"
            )
        shares, ends = self.shares(v), np.array([0.0, 1.0])
        total: Array = np.zeros(())
        for j, whole in enumerate(wholes):
            both = np.asarray(whole)[..., None] * fractions_at(self.matches[j], ends)
            total = total + both[..., None, :] * shares[:, j, None]
        return total[..., 0], total[..., 1] - total[..., 0]

    def wall_parameter(self, name: str, t: Reals) -> Reals:
        """Own parameters (k,) of the hub's or shroud's curve at real t (k,), of the real design."""
        j = 0 if name == "hub" else -1
        return real_first(self.curves[j].parameter_at(fractions_at(self.matches[j], t)), 1)

    @cached_property
    def _cardinals(self) -> BSpline:
        degree = min(len(self.spans) - 1, 3)
        return make_interp_spline(self.spans, np.eye(len(self.spans)), degree)


def stream_surfaces(
    path: FlowPath, metre: float, edges: tuple[Meridian, Meridian] | None = None, *, revolved: bool = True
) -> StreamSurfaces:
    """The native stream surfaces of a flow path whose length unit is `metre` metres.

    `edges` are the leading- and the trailing-edge curve of the blade, needed where the path is matched at them. Raises
    DesignError where the stream lines fold over, or an edge does not meet one that is given. Matched at the edges, they
    end where they start to fold well before or behind the blade, as lines do that start or end at odds.
    """
    designs = [path.hub, *path.stream_surfaces, path.shroud]
    names = ["hub", *(f"stream_surfaces[{i}]" for i in range(len(path.stream_surfaces))), "shroud"]
    curves = [each.line(metre) for each in designs]
    starts: list[Array] = [np.asarray(0.0)] * len(curves)
    ends: list[Array] = [np.asarray(1.0)] * len(curves)
    low, high = 0.0, 1.0
    if path.matched == "edges":
        if edges is None:
            raise DesignError(
                "matched is 'edges', but no leading- and trailing-edge curves are given: give the blade's edges as "
                "curves in (x, r), or take matched = 'ends'"
            )
        for into, edge, what in ((starts, edges[0], "leading_edge"), (ends, edges[1], "trailing_edge")):
            line = edge.line(metre)
            into[:] = [_meets(each, line, what, name) for each, name in zip(curves, names, strict=True)]
        low, high = _common(starts, ends)
    if path.quasi_orthogonals:
        matches = list(curved_matches(_pairs(path)))
    else:
        matches = [straight_match(start, end) for start, end in zip(starts, ends, strict=True)]
    surfaces = StreamSurfaces(
        matched=tuple(matched_curve(each, match, low, high) for each, match in zip(curves, matches, strict=True)),
        spans=np.array(path.spans),
        low=low,
        high=high,
        curves=tuple(curves),
        matches=tuple(matches),
    )
    if path.matched == "edges":
        surfaces = _unfolded(surfaces)
    check_stream_surfaces(surfaces, revolved=revolved)
    return surfaces


def check_stream_surfaces(surfaces: StreamSurfaces, *, revolved: bool = True) -> None:
    """Refuse stream surfaces whose map (t, v) -> (x, r) is not one to one, or that reach the axis where revolved."""
    t, v = _grid(surfaces)
    point, along, across = (part.reshape(-1, 2) for part in surfaces.real().grid(t, v))
    grid_v = np.tile(v, len(t))
    if revolved and np.min(point[:, 1]) <= 0.0:
        lowest = int(np.argmin(point[:, 1]))
        x, r = (round(float(each), 9) + 0.0 for each in point[lowest])
        raise DesignError(
            f"the flow path has radius {r:.4g} m at x = {x:.5g} m, v = {grid_v[lowest]:.3f}: every radius must be "
            "positive around the axis; move or shorten the hub so that it keeps clear of the axis"
        )
    share = _jacobian(along, across)
    if np.all(share < 0.0):
        raise DesignError(
            "hub and shroud are swapped, or both run upstream: with the flow from their first to their last points, "
            "the shroud must lie to the left of the hub in the (x, r) plane; exchange them, or reverse both"
        )
    worst = int(np.argmin(share))
    if share[worst] <= FOLDED:
        inner = "stream_surfaces" if len(surfaces.matched) > 2 else "quasi_orthogonals"
        raise DesignError(
            f"the stream surfaces fold over at (x, r) = ({point[worst, 0]:.5g}, {point[worst, 1]:.5g}) m, v = "
            f"{grid_v[worst]:.3f} (Jacobian {share[worst]:.3g} of its median, it must be positive): hub and shroud "
            "cross, or points at equal fractions of their lengths do not lie beside each other there; let both "
            "start and end "
            + (
                "beside each other, or give quasi_orthogonals"
                if inner == "quasi_orthogonals"
                else "beside the stream_surfaces, correct their order, or take matched = 'edges'"
            )
        )


def _grid(surfaces: StreamSurfaces) -> tuple[Reals, Reals]:
    """The t and v at which folds are looked for."""
    return np.linspace(surfaces.low, surfaces.high, 101), np.linspace(0.0, 1.0, 41)


def _jacobian(along: Reals, across: Reals) -> Reals:
    """The Jacobian of the map (t, v) -> (x, r), of the median of the derivatives' product."""
    found: Reals = cross2(along, across)
    return found / np.median(np.sqrt(np.sum(along**2, axis=-1) * np.sum(across**2, axis=-1)))


def _unfolded(surfaces: StreamSurfaces) -> StreamSurfaces:
    """The part of the surfaces around the blade in which they do not fold."""
    t, v = _grid(surfaces)
    _, along, across = surfaces.real().grid(t, v)
    folded = t[np.min(_jacobian(along, across), axis=1) <= FOLDED]
    before, behind = folded[folded < -KEPT], folded[folded > 1.0 + KEPT]
    step = t[1] - t[0]
    low = float(before[-1] + step) if len(before) else surfaces.low
    high = float(behind[0] - step) if len(behind) else surfaces.high
    return replace(surfaces, low=min(low, -KEPT), high=max(high, 1.0 + KEPT)) if len(folded) else surfaces


def _meets(curve: MeridionalCurve, edge: MeridionalCurve, what: str, name: str) -> Array:
    """The fraction (...) of a curve at which an edge curve crosses it."""
    place = meeting(curve, edge, what, f"the stream line of the {name}")[0]
    return curve.fraction_at(place)[..., 0]


def _common(starts: list[Array], ends: list[Array]) -> tuple[float, float]:
    """t from the latest start of a line to the earliest end of one."""
    pairs = [(float(real_first(a, 0)), float(real_first(b, 0))) for a, b in zip(starts, ends, strict=True)]
    for a, b in pairs:
        if a >= b:
            raise DesignError(
                "leading_edge and trailing_edge cross, or are swapped: the trailing edge must lie downstream of the "
                "leading edge on hub, shroud and every stream surface; exchange them, or reverse hub and shroud"
            )
    return max(-a / (b - a) for a, b in pairs), min((1.0 - a) / (b - a) for a, b in pairs)


def _pairs(path: FlowPath) -> Array:
    flat = stacked([value for pair in path.quasi_orthogonals for value in pair])
    return flat.reshape(*flat.shape[:-1], len(path.quasi_orthogonals), 2)
