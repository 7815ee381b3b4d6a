"""The channel that a blade's edge curves cut out of a flow path: its hub and shroud go on along those of the path.

Points of hub and shroud at equal fractions of their lengths between the edges have the same u. Past the ends of the
flow path both go on straight, along their tangents there.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from bladewright.blade.design.flow_path import Channel, FlowPath
from bladewright.blade.flow_path.channel import ChannelCurve, ChannelLine, TransfiniteChannel, control_points
from bladewright.blade.flow_path.intersections import meeting
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, PiecewisePolynomial, real_first, spline_on
from bladewright.blade.flow_path.quasi_orthogonals import matched_curve, straight_match
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

SAME = 1e-12
"""Distance in u below which a joint is at an edge but for rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FlowPathWall(ChannelLine):
    """Hub or shroud of a flow path by the u of a blade's channel: 0 on its leading and 1 on its trailing edge."""

    given_by: ClassVar[str] = "flow_path"

    line: MeridionalCurve
    """the whole wall by its own parameter"""
    at_edges: tuple[Array, Array]
    """(...) fractions of its length, or of what its parameter counts, on the leading and on the trailing edge"""
    pieces: PiecewisePolynomial
    """(x, r) by u, with a straight piece past each end"""

    @property
    def ends(self) -> tuple[float, float]:
        """u at which the flow path starts and ends."""
        return float(self.pieces.breaks[1]), float(self.pieces.breaks[-2])

    @property
    def degree(self) -> int:
        return self.pieces.powers.shape[-2] - 1

    @property
    def corners(self) -> tuple[Array, Array]:
        both = self.values(np.array([0.0, 1.0]))
        return both[..., 0, :], both[..., 1, :]

    def values(self, at: Reals, order: int = 0) -> Array:
        return self.pieces.values(at, order)

    def joints(self) -> Reals:
        inner = self.pieces.breaks[1:-1]
        return inner[np.min(np.square(inner[:, None] - [0.0, 1.0]), axis=1) > SAME**2]

    def smoothness(self) -> list[tuple[float, int]]:
        levels, kept = self.line.smoothness()
        start, end = (float(real_first(each, 0)) for each in self.at_edges)
        u = (real_first(self.line.fraction_at(levels), 1) - start) / (end - start)
        pairs = zip(u.tolist(), kept.tolist(), strict=True)
        return [(place, smooth) for place, smooth in pairs if SAME < place < 1.0 - SAME]

    def powers(self, centres: Reals, count: int) -> Array:
        found = self.pieces.around(centres)
        padding = [(0, 0)] * (found.ndim - 2) + [(0, count - found.shape[-2]), (0, 0)]
        return np.pad(found, padding)

    def real(self) -> "FlowPathWall":
        pieces = replace(self.pieces, powers=real_first(self.pieces.powers, 3))
        return replace(self, pieces=pieces)

    def curve(self) -> Curve:
        return self.line.curve()

    def own_parameters(self, u: Reals) -> Reals:
        """Own parameters (k,) of the whole wall at u (k,), of the real design; past its ends by the length there."""
        start, end = (float(real_first(each, 0)) for each in self.at_edges)
        low, high = self.ends
        inside = np.clip(u, low, high)
        own = real_first(self.line.parameter_at(start + (end - start) * inside), 1)
        speeds = [length(real_first(each, 2)) for each in (self.values(inside, 1), self.line.values(own, 1))]
        return np.asarray(own + (u - inside) * speeds[0] / speeds[1])

    def curve_over(self, low: float, high: float) -> Curve:
        """The whole wall as a native curve over its own parameter, with straight ends where u goes past its own."""
        first, last = self.own_parameters(np.array([low, high]))
        return straight_past(self.curve(), max(0.0, -float(first)), max(0.0, float(last) - 1.0))


def channel_in_flow_path(channel: Channel, path: FlowPath, metre: float) -> TransfiniteChannel:
    """The native channel between a design's edges in its flow path; its length unit is `metre` metres.

    An edge may end on hub and shroud, or past them, or up to `intersections.EXTENSION` of its own parameter short of
    them. Raises DesignError where it does not meet them, or meets one twice, or where the trailing edge is not
    downstream of the leading edge.
    """
    edges: dict[str, MeridionalCurve] = {}
    for name in ("leading_edge", "trailing_edge"):
        points = control_points(getattr(channel, name), metre)
        edges[name] = spline_on(points, min(points.shape[-2] - 1, channel.degree))
    walls: dict[str, FlowPathWall] = {}
    own: dict[str, list[Array]] = {name: [] for name in edges}
    for name in ("hub", "shroud"):
        line = getattr(path, name).line(metre)
        fractions = []
        for edge, curve in edges.items():
            at, place = meeting(line, curve, f"channel.{edge}", f"flow_path.{name}")
            fractions.append(line.fraction_at(at)[..., 0])
            own[edge].append(place[..., 0])
        walls[name] = _wall(name, line, fractions[0], fractions[1])
    ends = {
        edge: ChannelCurve(points=curve.net, knots=curve.knots, start=own[edge][0], end=own[edge][1])
        for edge, curve in edges.items()
    }
    return TransfiniteChannel(
        leading_edge=ends["leading_edge"], trailing_edge=ends["trailing_edge"], hub=walls["hub"], shroud=walls["shroud"]
    )


def _wall(name: str, line: MeridionalCurve, leading: Array, trailing: Array) -> FlowPathWall:
    start, end = (float(real_first(each, 0)) for each in (leading, trailing))
    if start >= end:
        raise DesignError(
            f"channel.leading_edge and channel.trailing_edge cross or are swapped: on flow_path.{name} the trailing "
            "edge is not downstream of the leading edge; exchange them, move them apart, or reverse hub and shroud"
        )
    low, high = -start / (end - start), (1.0 - start) / (end - start)
    pieces = matched_curve(line, straight_match(leading, trailing), low, high)
    return FlowPathWall(line=line, at_edges=(leading, trailing), pieces=with_straight_ends(pieces))


def with_straight_ends(pieces: PiecewisePolynomial) -> PiecewisePolynomial:
    """The same with a straight piece before the first and after the last, as long as all of them."""
    ends = pieces.breaks[[0, -1]]
    width = float(ends[1] - ends[0])
    point, slope = pieces.values(ends), pieces.values(ends, 1)
    middles = point + np.array([-0.5, 0.5])[:, None] * width * slope
    straight = np.zeros((*pieces.powers.shape[:-3], 2, *pieces.powers.shape[-2:]), dtype=pieces.powers.dtype)
    straight[..., 0, :], straight[..., 1, :] = middles, slope
    return PiecewisePolynomial(
        breaks=np.concatenate([[ends[0] - width], pieces.breaks, [ends[1] + width]]),
        powers=np.concatenate([straight[..., :1, :, :], pieces.powers, straight[..., 1:, :, :]], axis=-3),
    )


def straight_past(curve: Curve, before: float, after: float) -> Curve:
    """The same curve with straight ends, so much of its parameter before its start and after its end."""
    degree, knots, net = curve.degree, curve.knots, curve.control_points
    steps = np.arange(1, degree + 1)[:, None]
    if before > 0.0:
        ahead = net[..., :1, :] - steps[::-1] * (before / (knots[degree + 1] - knots[0])) * _first(net, 0, 1)
        net = np.concatenate([ahead, net[..., 1:, :]], axis=-2)
        low = np.full(degree + 1, knots[0] - before)
        knots = np.concatenate([low, np.full(degree - 1, knots[0]), knots[degree + 1 :]])
    if after > 0.0:
        behind = net[..., -1:, :] + steps * (after / (knots[-1] - knots[-degree - 2])) * _first(net, -2, -1)
        net = np.concatenate([net[..., :-1, :], behind], axis=-2)
        high = np.full(degree + 1, knots[-1] + after)
        knots = np.concatenate([knots[: -degree - 1], np.full(degree - 1, knots[-1]), high])
    return Curve(control_points=net, knots=knots, degree=degree)


def _first(net: Array, start: int, end: int) -> Array:
    """The step (..., 1, 2) between two control points."""
    return net[..., [end], :] - net[..., [start], :]
