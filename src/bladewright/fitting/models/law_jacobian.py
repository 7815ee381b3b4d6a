"""How places on a blade of the unified family move with whole laws, from which all derivatives are products.

A law acts on the section at v by its value there alone, and so do the edges of the channel. The motion by law and by
section therefore gives the derivatives by the control points of any law in its place, with more control points or
fewer.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.unified import ExactUnifiedBlade
from bladewright.blade.flow_path.channel import ChannelCurve, TransfiniteChannel
from bladewright.blade.native.interpolation import lower_edges
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.derivatives.complex_step import STEP, data_from_rates, interpolation_rates, law_point, stepped_design
from bladewright.designs import Design
from bladewright.fitting.free_parameters import EDGES
from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.checks import UNITS
from bladewright.section.native import interpolated_along_u

AT_ONCE = 40
"""complex steps in one rebuild; it bounds the memory."""
PRODUCT_SIZE = 4_000_000
"""numbers of one product; it bounds the memory."""
AXES = {"x": 0, "r": 1}
"""coordinates of a channel's control point"""

ChannelShift = tuple[str, int | None, int]
"""a curve of the channel, the control point of it that moves (None: all of them, and no wall), and the axis, x or r"""


@dataclass(frozen=True, kw_only=True, eq=False)
class LawJacobian:
    """How n places move along given directions with steps of laws and of the channel's curves, by section."""

    design: UnifiedBlade
    sites: Reals
    """(m,) v of the sections along the span"""
    moves: dict[str | ChannelShift, Reals]
    """(n, m) by step: motion for a unit of the step's value at each section [m per unit of the field]"""

    def columns(self, paths: Sequence[str]) -> Reals:
        """Derivatives (n, k) by parameters."""
        count = len(next(iter(self.moves.values())))
        found = np.zeros((count, len(paths)))
        together: dict[str | ChannelShift, list[tuple[int, Reals]]] = {}
        for column, path in enumerate(paths):
            for step, row in law_shares(self.design, path, self.sites):
                together.setdefault(step, []).append((column, row))
        for step, pairs in together.items():
            found[:, [column for column, _ in pairs]] += self.moves[step] @ np.stack([row for _, row in pairs], axis=1)
        return found


def law_shares(design: UnifiedBlade, path: str, sites: Reals) -> Iterator[tuple[str | ChannelShift, Reals]]:
    """The steps that a parameter consists of, and its share (m,) in each at the sites."""
    if not (path.startswith("channel.") and stands_on_channel(design)):
        source = law_point(design, path)
        share = source.factor(sites)
        yield source.step, share
        return
    metre = UNITS[design.length_unit]
    for curve, point, axis in channel_shifts(design, path):
        if curve in EDGES and point is not None:
            points = len(getattr(design.channel, curve))
            yield (curve, None, axis), metre * edge_basis(points, design.channel.degree, sites)[:, point]
        else:
            yield (curve, point, axis), metre * np.ones(len(sites))


def stands_on_channel(design: Design) -> bool:
    """Whether a blade is of the unified family and ends on the channel's own hub and shroud, without clearance."""
    return isinstance(design, UnifiedBlade) and design.ends == ("hub", "shroud") and design.flow_path is None


def edge_basis(count: int, degree: int, v: Reals) -> Reals:
    """Values (len(v), count) of the basis functions of an edge's curve with `count` control points."""
    own = min(count - 1, degree)
    return np.asarray(basis(uniform_knots(count, own), own, v))


def law_jacobian(
    exact: ExactUnifiedBlade, knots: Knots, footpoints: Footpoints, directions: Reals, paths: Sequence[str]
) -> LawJacobian:
    """How places move along directions (n, 3) with what the parameters at `paths` consist of; knots are held."""
    design, sites = exact.design, knots.sites_v
    steps = list(dict.fromkeys(step for path in paths for step, _ in law_shares(design, path, sites)))
    across = basis(knots.v, DEGREE, footpoints.v) @ np.linalg.inv(basis(knots.v, DEGREE, sites))
    moves: dict[str | ChannelShift, Reals] = {}
    for some, other in _stepped(exact, steps):
        moves |= dict(
            zip(some, _motion(_along_u(other, knots, len(some)), knots, footpoints, directions, across), strict=True)
        )
    return LawJacobian(design=design, sites=sites, moves=moves)


def _stepped(
    exact: ExactUnifiedBlade, steps: Sequence[str | ChannelShift]
) -> Iterator[tuple[Sequence[str | ChannelShift], ExactUnifiedBlade]]:
    """Some of the steps at a time, and the exact blade with these in a batch."""
    laws = [step for step in steps if isinstance(step, str)]
    shifts = [step for step in steps if not isinstance(step, str)]
    for first in range(0, len(laws), AT_ONCE):
        part = laws[first : first + AT_ONCE]
        yield part, exact.moved_to(stepped_design(exact.design, part))
    for first in range(0, len(shifts), AT_ONCE):
        some = shifts[first : first + AT_ONCE]
        channel = shifted_channel(exact.channel, [[step] for step in some])
        yield some, replace(exact, channel=channel, full_channel=channel, known_survey=None)


def _along_u(other: ExactUnifiedBlade, knots: Knots, count: int) -> tuple[Array, Array]:
    """Derivatives (count, n_u, m, 3) of the sides' control points along u, for each section by itself."""
    rates = interpolation_rates(other.sections(knots.sites_v), knots, count)
    data = data_from_rates(rates, (True, True))
    upper = data.leading_edge, data.trailing_edge
    sides = (data.upper, upper), (data.lower, lower_edges(upper, data.lower_edges))
    first, second = (interpolated_along_u(np.swapaxes(points, -3, -2), *edges, knots.u) for points, edges in sides)
    return first, second


def _motion(
    lines: tuple[Array, Array], knots: Knots, footpoints: Footpoints, directions: Reals, across: Reals
) -> Reals:
    """(k, n, m) motion of the places along their directions."""
    steps, _, sites, _ = lines[0].shape
    found = np.zeros((steps, len(footpoints.u), sites))
    for number, side in enumerate(lines):
        rows = np.flatnonzero(footpoints.side == number)
        flat = np.moveaxis(side, 1, 0).reshape(side.shape[1], -1)
        for part in np.array_split(rows, max(1, -(-len(rows) * flat.shape[1] // PRODUCT_SIZE))):
            if len(part) == 0:
                continue
            matrix = BSpline.design_matrix(np.clip(footpoints.u[part], 0.0, 1.0), knots.u, DEGREE)
            places = (matrix @ flat).reshape(len(part), steps, sites, 3)
            along = np.matmul(places, directions[part, None, :, None])[..., 0]
            found[:, part] = np.moveaxis(along * across[part, None], 1, 0)
    return found


def shifted_channel(channel: TransfiniteChannel, groups: Sequence[Sequence[ChannelShift]]) -> TransfiniteChannel:
    """A channel with a batch (len(groups),) of imaginary steps, each of some control points together."""
    curves = {name: channel.curve(name) for name in (*EDGES, "hub", "shroud")}
    kicks = {name: np.zeros((len(groups), *curve.control_points.shape)) for name, curve in curves.items()}
    for number, group in enumerate(groups):
        for curve, place, axis in group:
            kicks[curve][number, slice(None) if place is None else place, axis] = STEP
    lines: dict[str, Any] = {name: channel.line(name) for name in kicks}
    for name, kick in kicks.items():
        if np.any(kick):
            own = curves[name]
            lines[name] = ChannelCurve(points=own.control_points + 1j * kick, knots=own.knots)
    return TransfiniteChannel(**lines)


def channel_shifts(design: UnifiedBlade, path: str) -> list[ChannelShift]:
    """The control points of the channel's curves that a parameter of it moves."""
    _, curve, place, axis = re.findall(r"\w+", path)
    if curve not in EDGES:
        return [(curve, int(place) + 1, AXES[axis])]
    found: list[ChannelShift] = [(curve, int(place), AXES[axis])]
    for wall, end in (("hub", 0), ("shroud", len(getattr(design.channel, curve)) - 1)):
        if int(place) == end:
            found.append((wall, 0 if curve == EDGES[0] else len(getattr(design.channel, wall)) + 1, AXES[axis]))
    return found
