"""Passages that are refused: a duct that folds or meets the axis, a blade outside its pitch, patches that fold."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from bladewright.blade.exact.meridional_extent import MeridionalExtent
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.native.blade import Blade
from bladewright.domain.camber_lines import CamberLines
from bladewright.domain.duct import Duct
from bladewright.domain.knots import BLADE_AT, PIECES
from bladewright.domain.walls import WallHalf
from bladewright.errors import DesignError
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

SIDES = np.concatenate([np.linspace(0.0, 0.05, 25)[:-1], np.linspace(0.05, 0.95, 121), np.linspace(0.95, 1.0, 25)[1:]])
"""Shares of a side at which its distance from the periodic boundaries is taken: closer at the edges, where it turns."""
AMPLE_JACOBIAN = 0.06
"""Least Jacobian of a wall's half, over its median, above which no other way of cross-lines is tried: the passages of
design/passages.md have 0.02 to 0.45, and with twice as much passages take longer to build and are hardly further from
folding (design/passage_constants.md)."""
EVEN = np.linspace(0.0, 1.0, 31)
"""Shares of inlet and outlet piece at which the Jacobian is sampled."""
BESIDE_BLADE = np.unique(np.concatenate([np.linspace(0.0, 1.0, 61), 0.1 * EVEN**2, 1.0 - 0.1 * EVEN**2]))
"""Shares of the piece beside the blade at which it is sampled: closer at the edges, where patches fold first."""
ACROSS = np.concatenate([np.linspace(0.0, 0.1, 8)[:-1], np.linspace(0.1, 1.0, 22)])
"""Shares of the width at which it is sampled: closer at the blade."""


def check_duct(duct: Duct, extent: MeridionalExtent) -> None:
    """Refuse extents over which the continued channel folds over or meets the axis."""
    for edge, name in enumerate(("upstream", "downstream")):
        found = duct.limit(name)
        if found is None:
            continue
        what = "meets the machine axis" if found.sunk else "folds back on itself, as hub and shroud cross"
        raise DesignError(
            f"{name} is {extent.extent(edge, (duct.low, duct.high)[edge]):g} meridional lengths of the blade: the "
            f"continued channel {what} at u = {found.u:.3f}; at most {extent.extent(edge, found.last):.3g} is "
            "possible, or let hub and shroud leave the blade more parallel"
        )


def check_pitch(camber: CamberLines, blade: Blade, half_pitch: float) -> None:
    """Refuse a pitch so small that a side of the blade lies more than half of it from the camber lines.

    `camber` continues the blade's own stations.
    """
    v = camber.stations.v
    lines = [np.concatenate([real_first(camber.points(piece, SIDES), 3) for piece in PIECES], axis=-2)]
    sides = [real_first(camber.in_plane(side), 3) for side in camber.stations.plane_points(SIDES)]
    design = blade.design
    worst, where = -np.inf, (0, 0.0)
    for side, sign in zip(sides, (1.0, -1.0), strict=True):
        for row in range(len(v)):
            away = sign * (side[row, :, 1] - np.interp(side[row, :, 0], *lines[0][row].T))
            outside = float(np.max(away) - half_pitch)
            if outside > worst:
                worst, where = outside, (row, float(side[row, int(np.argmax(away)), 0]))
    if worst < 0.0:
        return
    row, abscissa = where
    u = camber.lines.rows([row]).u_at(np.array([[abscissa]]))
    radius = float(np.real(camber.lines.rows([row]).position(u))[..., 1].flat[0]) if design.blade_count else 1.0
    metre = UNITS[design.length_unit]
    what = f"blade_count is {design.blade_count}" if design.blade_count else f"pitch is {2 * half_pitch / metre:g}"
    raise DesignError(
        f"{what}: at v = {v[row]:.3f} the blade stands {worst * radius / metre:.4g} {design.length_unit} outside its "
        f"passage, which reaches {half_pitch * radius / metre:.4g} {design.length_unit} to each side of the camber "
        f"line there; take {'fewer blades' if design.blade_count else 'a larger pitch'} or thinner sections"
    )


def check_folds(shares: dict[str, tuple[float, float, float]]) -> None:
    """Refuse a wall patch whose Jacobian is not positive: `shares` are least over median, u and v by face."""
    for name, (share, u, v) in shares.items():
        if not share > 0.0:
            raise DesignError(
                f"passage: its face {name} folds over at u = {u:.3f}, v = {v:.3f} (Jacobian {share:.3g} of its median, "
                "it must be positive): thin the blade beside its edges, take a larger pitch, lengthen upstream or "
                "downstream, or lower the angle to which the flow turns there"
            )


class LeastJacobian(NamedTuple):
    """The place of a wall's half at which it is nearest to folding."""

    share: float
    """the Jacobian in (m', theta) there, over the median of its piece"""
    name: str
    u: float
    v: float


def least_jacobian(walls: Mapping[str, WallHalf]) -> LeastJacobian:
    """The least Jacobian of the exact halves, by differences between samples, before anything is built."""
    return min(_least(name, wall, index) for name, wall in walls.items() for index in range(len(PIECES)))


def _least(name: str, wall: WallHalf, index: int) -> LeastJacobian:
    piece = PIECES[index]
    t: Reals = BESIDE_BLADE if piece == "blade" else EVEN
    points = real_first(wall.in_plane(piece, t, ACROSS), 3)
    along = np.gradient(points, t, axis=0, edge_order=2)
    across = np.gradient(points, ACROSS, axis=1, edge_order=2)
    jacobian = wall.sign * cross2(along, across)
    i, j = np.unravel_index(int(np.argmin(jacobian)), jacobian.shape)
    low, high = (0.0, *BLADE_AT, 1.0)[index : index + 2]
    u = float(low + (high - low) * t[i])
    return LeastJacobian(float(jacobian[i, j] / np.median(jacobian)), name, u, float(ACROSS[j]))
