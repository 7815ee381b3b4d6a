"""A patch of a wall in its plane (m', theta), and its way onto the wall's surface of revolution."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from bladewright.blade.streamlines import StreamLines
from bladewright.domain.camber import CamberLines
from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True)
class WallPatch(ABC):
    """A part of hub or shroud, of one or more of the three pieces along the flow."""

    camber: CamberLines
    line: StreamLines
    """the duct's stream line along the wall"""
    row: int
    """which of the camber's stations"""

    @abstractmethod
    def plane(self, piece: str, t: Reals, v: Reals) -> Array:
        """Points (..., k, l, 2) in the plane at t (k,) along a piece and v (l,) across."""

    def in_space(self, piece: str, t: Reals, v: Reals) -> tuple[Array, Array]:
        """Points (..., k, l, 3) in metres, and the wall's unit normals there, towards the shroud."""
        plane = self.plane(piece, t, v)
        flat = plane.reshape(*plane.shape[:-3], 1, -1, 2)
        lines = self.line
        u = lines.u_at(flat[..., 0])
        position, slope = lines.position(u), unit(lines.position(u, 1))
        mapping, tangential = lines.mapping, flat[..., 1]
        points = mapping.in_space(position[..., 0], position[..., 1], tangential)
        upright = mapping.in_space(-slope[..., 1], slope[..., 0], tangential if mapping.revolved else 0.0 * tangential)
        shape = (*plane.shape[:-1], 3)
        return points.reshape(shape), upright.reshape(shape)
