"""Shapes that cannot be: a channel that folds, sides that cross, neighbours that intersect."""

import numpy as np

from bladewright.blade.exact import ExactBlade, Stations
from bladewright.errors import DesignError
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.crossing import self_crossings, touches


def check_channel(exact: ExactBlade) -> None:
    """Refuse a channel whose map (u, v) -> (x, r) is not one to one, from nose to nose."""
    u, v = np.linspace(-exact.before, 1.0 + exact.after, 41), np.linspace(0.0, 1.0, 21)
    along, across = (np.real(part) for part in exact.channel.slopes(u, v))
    jacobian = cross2(along, across)
    size = np.median(np.sqrt(np.sum(along**2, axis=-1) * np.sum(across**2, axis=-1)))
    share = jacobian / size
    if np.all(share < 0.0):
        raise DesignError(
            "channel: its ends are swapped: with u from leading to trailing edge and v from hub to shroud it must turn "
            "like x to r; exchange leading_edge with trailing_edge, or reverse the order from hub to shroud"
        )
    if np.min(share) <= 1e-4:
        i, j = np.unravel_index(int(np.argmin(share)), share.shape)
        raise DesignError(
            f"channel: it folds over at u = {u[j]:.3f}, v = {v[i]:.3f} (Jacobian {share[i, j]:.3g} of its median, it "
            "must be positive): move the control points of hub and shroud, or of the edges, apart there"
        )


def check_sections(exact: ExactBlade) -> None:
    """Refuse sections whose sides cross or touch, and neighbouring blades that intersect."""
    stations = exact.survey
    s = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 65))) / 2.0
    first = (0,) * (stations.plane.camber.ndim - 3)
    upper, lower = (np.real(points)[first] for points in stations.plane.points(s))
    for v, above, below in zip(stations.v, upper, lower, strict=True):
        place = self_crossings(np.concatenate([above, below[-2:0:-1]]))
        if place is not None:
            at = min(place, 2 * (len(s) - 1) - place)
            raise DesignError(
                f"the sides cross at v = {v:.3f}, near s = {s[int(at)]:.3f} along the section: raise the thickness there, "
                "lower an edge radius that is larger than the thickness beside it, or lower the turning of the camber"
            )
    _check_neighbours(exact, stations, upper, lower)


def _check_neighbours(exact: ExactBlade, stations: Stations, upper: Reals, lower: Reals) -> None:
    design = exact.design
    pitch = 2.0 * np.pi / design.blade_count if design.blade_count else float(np.ravel(np.real(design.pitch))[0])
    pitch = pitch if design.blade_count else pitch * UNITS[design.length_unit]
    for i, v in enumerate(stations.v):
        outline = np.concatenate([upper[i], lower[i][-2:0:-1]])
        scale = float(np.ravel(np.real(stations.mapping.tangential(
            np.ones(1), np.real(stations.lines.position(np.array([0.0])))[..., i, :, 1], np.real(stations.lines.lengths)[..., i, None]
        )))[0])
        if touches(outline, pitch / scale):
            what = f"blade_count is {design.blade_count}" if design.blade_count else f"pitch is {design.pitch:g}"
            cure = "fewer blades" if design.blade_count else "a larger pitch"
            raise DesignError(
                f"{what}: neighbouring blades intersect at v = {v:.3f}, where the pitch is {pitch / scale:.4g} in the "
                f"section's plane; take {cure}, thinner sections or less stagger there"
            )
