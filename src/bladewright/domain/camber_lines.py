"""Camber lines from inlet to outlet: the sections' own, continued up- and downstream."""

from dataclasses import dataclass

import numpy as np

from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.stream_surface_map import Taylor
from bladewright.blade.flow_path.streamlines import StreamLines
from bladewright.domain.camber_correspondence import CamberCorrespondence
from bladewright.domain.duct import Duct
from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True)
class CamberLines:
    """Continued camber lines (..., m) in the planes (m', theta) of their stream surfaces, (m, y) in a cascade."""

    stations: SectionStack
    duct: Duct
    lines: StreamLines
    """of the duct, at the stations' v"""
    slopes: tuple[Array, Array]
    """(..., m) d theta / dm' at the leading and the trailing edge"""
    turned: tuple[Array | None, Array | None]
    """() d theta / dm' at inlet and outlet where an angle is stated"""
    correspondence: CamberCorrespondence
    """how `points` follow the sides"""
    joints: Reals
    """where, along the span, laws of evolution and the channel's edges lose derivatives"""

    def points(self, piece: str, t: Reals, sign: int = 0) -> Array:
        """Points (..., m, k, 2) at t (k,) in [0, 1] along `inlet`, `blade` or `outlet`.

        With `sign` +1 or -1, up- or downstream of the blade: of the line that starts where the upper or the lower side
        ends, which is another where the edge is blunt.
        """
        if piece == "blade":
            return self.in_plane(self.stations.camber(self.correspondence(t)))
        past = 0 if piece == "inlet" else 1
        edge = self.start(past, sign)
        end = np.array([self.duct.high if past else self.duct.low])
        reach = self.lines.abscissa(end) - edge[..., 0]
        share = 1.0 - t if past == 0 else t
        slope, turn = self.slopes[past][..., None], self.turned[past]
        rise = slope * share
        if turn is not None:
            rise = rise + (turn - slope) * share**3 / 3.0
        return np.stack([edge[..., 0] + reach * share, edge[..., 1] + reach * rise], axis=-1)

    def start(self, past: int, sign: int = 0) -> Array:
        """The end (..., m, 1, 2) of the camber at an edge; of the upper (+1) or lower side (-1) where it is blunt."""
        if sign == 0 or not self.parted[past]:
            return self.points("blade", np.array([float(past)]))
        return self.side(np.array([float(past)]), sign)

    @property
    def parted(self) -> tuple[bool, bool]:
        """Whether a face stands between the sides' ends at the leading, and at the trailing edge."""
        first, last = (kind == "blunt" for kind in self.stations.kinds)
        return first, last or self.stations.back is not None

    def side(self, t: Reals, sign: int) -> Array:
        """Points (..., m, k, 2) of the upper (+1) or the lower side (-1) at shares t (k,) of it, a back face apart."""
        whole = 1.0 if self.stations.back is None else self.stations.back
        return self.in_plane(self.stations.plane.points(whole * t)[0 if sign > 0 else 1])

    def direction(self, past: int) -> Array:
        """Unit vectors (..., m, 2) along the camber, downstream, at the leading (0) or trailing (1) edge."""
        slope = self.slopes[past]
        return unit(np.stack([np.ones_like(slope), slope], axis=-1))

    def in_plane(self, section: Array) -> Array:
        """Points (..., m, k, 2) in (m', theta) of points in the sections' own planes."""
        stations = self.stations
        if type(stations.mapping) is type(self.lines.mapping):
            start = self.lines.abscissa(stations.channel_parameter(np.zeros(1)))
            return np.stack(np.broadcast_arrays(start + section[..., 0], section[..., 1]), axis=-1)
        u, _, tangential = stations.on_lines(section)
        return np.stack([self.lines.abscissa(stations.channel_parameter(u)), tangential], axis=-1)


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


def _slope(stations: SectionStack, lines: StreamLines, past: int) -> Array:
    """d theta / dm' (..., m) of the camber at an edge."""
    at = np.array([float(past)])
    along, point = stations.camber_ends()[past], stations.camber(at)[..., 0, :]
    position, slope = (stations.lines.position(at, order)[..., 0, :] for order in range(2))
    by_u = along[..., 0] / stations.lines.densities(at)[0][..., 0]
    nothing = np.zeros_like(by_u)
    tangential = stations.mapping.tangential_series(
        Taylor(point[..., 1], along[..., 1], nothing),
        Taylor(position[..., 1], slope[..., 1] * by_u, nothing),
        stations.lines.lengths,
    )
    return tangential.first / (lines.mapping.density(position, slope) * by_u)
