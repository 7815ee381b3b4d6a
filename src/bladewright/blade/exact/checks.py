"""Shapes that cannot be: a channel that folds, sides that cross, neighbours that intersect."""

from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.flow_path.channel import TransfiniteChannel
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.errors import DesignError
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.crossing import PLACES, check_outlines, outlines_of, touching

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade
    from bladewright.blade.exact.sectioned import ExactSectionedBlade
    from bladewright.blade.exact.unified import ExactUnifiedBlade


def check_channel(exact: "ExactUnifiedBlade") -> None:
    """Refuse a channel whose map (u, v) -> (x, r) is not one to one, from nose to nose; the blade's own, too."""
    check_folds(exact.full_channel, exact.before, exact.after)
    if exact.clearance is not None:
        try:
            check_folds(exact.channel, exact.before, exact.after)
        except DesignError as error:
            name = exact.clearance.name
            raise DesignError(
                f"{name} bounds the blade's own {error}; or lower {name}, or bring its two values nearer to each other"
            ) from error


def check_folds(channel: TransfiniteChannel, before: float = 0.0, after: float = 0.0) -> None:
    """The same for a channel from `before` its leading to `after` its trailing edge, in u."""
    u, v = np.linspace(-before, 1.0 + after, 41), np.linspace(0.0, 1.0, 21)
    along, across = (np.real(part) for part in channel.slopes(u, v))
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


def check_clearance(exact: "ExactUnifiedBlade") -> None:
    """Refuse a clearance that ends on the nose of the blade, past the edge at which it is smaller."""
    clearance = exact.clearance
    if clearance is None:
        return
    row = exact.design.ends.index("tip") * (len(exact.survey.v) - 1)
    outline = outlines_of(*exact.survey.plane.points(PLACES))[..., [row], :, :]
    u = np.real(exact.survey.lines.rows([row]).u_at(outline[..., 0]))
    for place, edge in ((float(np.min(u)), "leading"), (float(np.max(u)), "trailing")):
        distance = float(clearance.real().distance(np.array([place]))[0])
        if distance <= 0.0:
            raise DesignError(
                f"{clearance.name} is linear in u and falls to {clearance.said(distance)} at u = {place:.3f}, the nose "
                f"past the {edge} edge: the blade would meet the {clearance.wall} there; bring its two values nearer "
                "to each other"
            )


def check_sections(exact: "ExactUnifiedBlade") -> None:
    """Refuse sections whose sides cross or touch, and neighbouring blades that intersect."""
    stations = exact.survey
    outlines = outlines_of(*stations.plane.points(PLACES))
    first = (0,) * (outlines.ndim - 3)
    check_outlines(np.real(outlines)[first], [f"at v = {v:.3f}, " for v in stations.v])
    if not exact.mapping.keeps_ordinate:
        u, _, across = stations.on_lines(outlines)
        outlines = np.stack([u, across], axis=-1)
    _check_neighbours(exact.design, stations.v, np.real(outlines)[first])


def check_pitch(exact: "ExactSectionedBlade") -> None:
    """Refuse neighbouring blades of sections that intersect."""
    stations = exact.survey
    outlines = stations.outlines()
    if not exact.mapping.keeps_ordinate:
        u, _, across = stations.on_lines(outlines)
        outlines = np.stack([real_first(u, 2), real_first(across, 2)], axis=-1)
    _check_neighbours(exact.design, stations.v, outlines)


def _check_neighbours(design: "UnifiedBlade | SectionedBlade", places: Reals, outlines: Reals) -> None:
    """Refuse a pitch by which an outline (m, n, 2) whose ordinate is theta, or y, meets itself."""
    metre = UNITS[design.length_unit]
    pitch = 2.0 * np.pi / design.blade_count if design.blade_count else metre * _first(design.pitch)
    found = touching(outlines, pitch)
    if found is not None:
        what = f"blade_count is {design.blade_count}" if design.blade_count else f"pitch is {pitch / metre:g}"
        much = f"{np.degrees(pitch):.4g} deg" if design.blade_count else f"{pitch / metre:.4g} {design.length_unit}"
        cure = "fewer blades" if design.blade_count else "a larger pitch"
        raise DesignError(
            f"{what}: neighbouring blades intersect at v = {places[found]:.3f}, where they stand {much} apart; take "
            f"{cure}, thinner sections or less stagger there"
        )


def _first(value: Any) -> float:
    return float(np.real(np.ravel(value))[0])
