"""Camber lines from inlet to outlet: the sections' own, continued up- and downstream.

A continuation keeps the slope d theta / dm' of the camber line at its end, or turns to a stated one as the square of
the way: theta = theta_0 + extent (slope t + (turned - slope) t^3 / 3), with t from 0 at the edge to 1 at inlet or
outlet. Where a line must not wind far, it straightens: theta = theta_0 + extent slope s atan(t / s), which keeps slope
and second derivative at the edge and never winds by more than pi / 2 s of the way.
"""

from dataclasses import dataclass

import numpy as np

from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import Taylor
from bladewright.blade.flow_path.streamlines import StreamLines
from bladewright.domain.camber_correspondence import (
    CAMBER_SHARES,
    SIDE_SHARES,
    CamberCorrespondence,
    fitted_correspondence,
)
from bladewright.domain.duct import Duct
from bladewright.domain.middle_shift import MiddleShift
from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True)
class CamberLines:
    """Continued camber lines (..., m) in the planes (m', theta) of their stream surfaces, (m, y) in a cascade.

    The leading edge and what lies upstream of it have the number 0 in all that is by edge, the trailing edge and what
    lies downstream the number 1.
    """

    stations: SectionStack
    duct: Duct
    lines: StreamLines
    """the duct's stream lines, at the stations' v"""
    slopes: tuple[Array, Array]
    """(..., m) d theta / dm' at the leading and the trailing edge"""
    turned: tuple[Array | None, Array | None]
    """() d theta / dm' at inlet and outlet where an angle is stated"""
    correspondence: CamberCorrespondence
    """which point of the camber line belongs to a point of the sides"""
    joints: Reals
    """where, along the span, laws of evolution and the channel's edges lose derivatives"""
    shift: MiddleShift | None = None
    """what is added to theta, or y, so that the lines are those of a middle surface"""
    straightening: float | None = None
    """s, a share of the way, where the lines straighten"""

    def points(self, piece: str, t: Reals, sign: int = 0) -> Array:
        """Points (..., m, k, 2) at t (k,) in [0, 1] along `inlet`, `blade` or `outlet`.

        Upstream and downstream of a blunt edge, `sign` +1 or -1 gives the line that continues the end of the upper or
        the lower side instead of that of the camber line.
        """
        plane = self._camber_points(piece, t, sign)
        return plane if self.shift is None or sign else plane + self._beside(self.shift, piece, t, plane)

    def _beside(self, shift: MiddleShift, piece: str, t: Reals, plane: Array) -> Array:
        """How far (..., m, k, 2) the middle lines stand beside camber lines, at points of those."""
        upwards = np.array([0.0, 1.0])
        if piece == "blade":
            return shift(self.stations.v, self.correspondence(t))[..., None] * upwards
        edge = 0 if piece == "inlet" else 1
        way = plane[..., 0] - self.edge_points(edge)[..., 0]
        sign = 1.0 if edge else -1.0
        less = sign * self.slopes[edge][..., None] * shift.past(edge, sign * way)
        return (shift(self.stations.v, np.full(len(t), float(edge))) - less)[..., None] * upwards

    def _camber_points(self, piece: str, t: Reals, sign: int) -> Array:
        if piece == "blade":
            return self.in_plane(self.stations.camber(self.correspondence(t)))
        edge = 0 if piece == "inlet" else 1
        start = self.edge_points(edge, sign)
        end = np.array([self.duct.high if edge else self.duct.low])
        extent = self.lines.abscissa(end) - start[..., 0]
        share = t if edge else 1.0 - t
        slope, turn = self.slopes[edge][..., None], self.turned[edge]
        s = self.straightening
        rise = slope * (share if s is None else s * np.arctan(share / s))
        if turn is not None:
            rise = rise + (turn - slope) * share**3 / 3.0
        return np.stack([start[..., 0] + extent * share, start[..., 1] + extent * rise], axis=-1)

    def edge_points(self, edge: int, sign: int = 0) -> Array:
        """Ends (..., m, 1, 2) of camber lines at an edge; where it is blunt, of the upper (+1) or lower side (-1)."""
        if sign == 0 or not self.blunt[edge]:
            return self._camber_points("blade", np.array([float(edge)]), 0)
        return self.side(np.array([float(edge)]), sign)

    @property
    def blunt(self) -> tuple[bool, bool]:
        """Whether a face lies between the sides' ends at the leading, and at the trailing edge: a back face counts."""
        first, last = (kind == "blunt" for kind in self.stations.edge_kinds)
        return first, last or self.stations.back is not None

    def side(self, t: Reals, sign: int) -> Array:
        """Points (..., m, k, 2) at shares t (k,) of the upper (+1) or the lower side (-1) without its back face."""
        whole = 1.0 if self.stations.back is None else self.stations.back
        return self.in_plane(self.stations.plane_points(whole * t)[0 if sign > 0 else 1])

    def direction(self, edge: int) -> Array:
        """Unit vectors (..., m, 2) along the camber lines, downstream, at the leading (0) or trailing (1) edge."""
        slope = self.slopes[edge]
        return unit(np.stack([np.ones_like(slope), slope], axis=-1))

    def in_plane(self, section: Array) -> Array:
        """Points (..., m, k, 2) in (m', theta) of points in the sections' own planes."""
        stations = self.stations
        if type(stations.mapping) is type(self.lines.mapping):
            start = self.lines.abscissa(stations.channel_parameter(np.zeros(1)))
            return np.stack(np.broadcast_arrays(start + section[..., 0], section[..., 1]), axis=-1)
        u, _, tangential = stations.on_lines(section)
        return np.stack([self.lines.abscissa(stations.channel_parameter(u)), tangential], axis=-1)

    def fitted_correspondence(self, edge_slope: float) -> CamberCorrespondence:
        """The correspondence that suits all stations, for the real design: see `camber_correspondence`."""
        camber = _abscissae(self.in_plane(self.stations.camber(CAMBER_SHARES)))
        sides = 0.5 * (_abscissae(self.side(SIDE_SHARES, 1)) + _abscissae(self.side(SIDE_SHARES, -1)))
        first, last = (kind == "round" for kind in self.stations.edge_kinds)
        return fitted_correspondence(camber, sides, (first, last), edge_slope)


def camber_lines(
    stations: SectionStack,
    duct: Duct,
    turned: tuple[Array | None, Array | None] = (None, None),
    joints: Reals | None = None,
    correspondence: CamberCorrespondence | None = None,
) -> CamberLines:
    """Continued camber lines of stations; `turned` holds d theta / dm' at inlet and outlet, None to keep the edge's."""
    lines = duct.lines(stations.v)
    slopes = _slope(stations, lines, 0), _slope(stations, lines, 1)
    return CamberLines(
        stations=stations,
        duct=duct,
        lines=lines,
        slopes=slopes,
        turned=turned,
        correspondence=CamberCorrespondence() if correspondence is None else correspondence,
        joints=np.empty(0) if joints is None else joints,
    )


def _slope(stations: SectionStack, lines: StreamLines, edge: int) -> Array:
    """d theta / dm' (..., m) of the camber at an edge."""
    at = np.array([float(edge)])
    along, point = stations.camber_ends()[edge], stations.camber(at)[..., 0, :]
    position, slope = (stations.lines.position(at, order)[..., 0, :] for order in range(2))
    by_u = along[..., 0] / stations.lines.densities(at)[0][..., 0]
    nothing = np.zeros_like(by_u)
    tangential = stations.mapping.tangential_series(
        Taylor(point[..., 1], along[..., 1], nothing),
        Taylor(position[..., 1], slope[..., 1] * by_u, nothing),
        stations.lines.lengths,
    )
    return tangential.first / (lines.mapping.density(position, slope) * by_u)


def _abscissae(points: Array) -> Reals:
    """Real abscissae (m, k) of points (..., m, k, 2)."""
    return real_first(points[..., 0], 2)
