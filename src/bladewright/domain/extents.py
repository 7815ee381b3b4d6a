"""How far a duct must reach past the blade so that no patch of its walls folds."""

from dataclasses import replace

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.domain.camber_lines import CamberLines, camber_lines
from bladewright.domain.duct import BEND, Duct
from bladewright.domain.kinks import kink_shares, skew_reach
from bladewright.domain.walls import STEEPEST_FADE, CrossLines, departure, edge_skew
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import number

USUAL = 0.5
"""Extent, in mean meridional lengths of the blade, where none is given, there is no flow path to follow so far, and the
pitch needs no more: half a blade."""
STEP = 0.25
"""Extents that the pitch needs are rounded up to multiples of this, in mean meridional lengths, so that most small
changes of a design leave them as they are. Half or twice as much is the same for design/passage_constants.md, whose
machines need less than USUAL."""
MAX_EXTENT = 20.0
"""Extent, in mean meridional lengths (axial chords in 2D), above which a duct is refused: it is a slip of the pen, and
takes many knots."""
BULGE_MARGIN = 1.25
"""Least extent over the bulge of cross-lines at an edge: with 1 the last cross-line would touch inlet or outlet. It
decides only where the pitch needs more than USUAL: none of design/passage_constants.md."""
CLEARANCE = 0.05
"""Least distance from the blade's foremost or rearmost point to inlet or outlet, in mean meridional lengths. It decides
only in ducts that must be short (design/passage_constants.md)."""
LIMIT_SHARE = 0.8
"""Share of the extent at which the duct folds or meets the axis that a usual extent may take: cells near it are thin.
With 0.6 or 0.95 the worst wall is as far from folding (design/passage_constants.md)."""


def extents(
    exact: ExactBlade, half_pitch: Array, cross_lines: CrossLines, upstream: float | None, downstream: float | None
) -> tuple[float, float]:
    """Extents up- and downstream in mean meridional lengths: those given, else those of the flow path or usual ones.

    Usual ones are taken without a flow path, and where one ends before the blade and its pitch allow; they are more
    than USUAL if needed. All but those given are shortened where the duct would fold over or meet the axis. Raises
    DesignError where a given one is not a number, or less than the blade and its pitch need.
    """
    found, ends = [], end_camber_lines(exact)
    for edge, (name, given) in enumerate((("upstream", upstream), ("downstream", downstream))):
        needed = _needed(exact, ends, half_pitch, cross_lines, edge)
        if given is None:
            found.append(_usual(exact, edge, needed))
            continue
        value = float(np.real(number(name, given)))
        if not needed <= value <= MAX_EXTENT:
            raise DesignError(
                f"{name} is {value:g} meridional lengths of the blade: it must be at least {needed:.4g}, so "
                f"that the walls' patches hold the blade's nose and do not fold beside it, and at most {MAX_EXTENT:g}"
            )
        found.append(value)
    return found[0], found[1]


def shortest_duct(exact: ExactBlade) -> Duct:
    """The duct that ends at the blade's foremost and rearmost points."""
    extent = exact.meridional_extent
    return Duct(
        channel=extent.channel,
        start=extent.start,
        end=extent.end,
        edges=extent.edges,
        length=extent.length,
        unit=extent.unit,
        bend=BEND * extent.unit if extent.path_end(0) is None else 0.0,
        low=extent.blade_range[0],
        high=extent.blade_range[1],
        revolved=exact.mapping.revolved,
    )


def end_camber_lines(exact: ExactBlade) -> CamberLines:
    """Camber lines on hub and shroud, hardly continued."""
    return camber_lines(exact.sections(np.array([0.0, 1.0])), shortest_duct(exact))


def skew_reaches(camber: CamberLines, half_pitch: Array, cross_lines: CrossLines) -> tuple[float, float]:
    """Shares of the ways to inlet and outlet over which the skew of cross-lines fades; `camber` reaches to both."""
    found = []
    for edge in (0, 1):
        start = _at_edge(camber, edge)[:, 0]
        end = real_first(camber.lines.abscissa(np.array([camber.duct.high if edge else camber.duct.low])), 2)[:, 0]
        bulge = _bulge(camber, half_pitch, cross_lines, edge)
        least = STEEPEST_FADE * float(np.max(bulge / np.where(end > start, end - start, start - end)))
        found.append(skew_reach(kink_shares(camber, edge), least))
    return found[0], found[1]


def departures(ends: CamberLines, half_pitch: float) -> tuple[float, float]:
    """The rates o at which cross-lines leave the blade on hub and shroud."""
    edges = [_at_edge(ends, edge) for edge in (0, 1)]
    hub, shroud = edges[1][:, 0] - edges[0][:, 0]
    return departure(half_pitch, hub), departure(half_pitch, shroud)


def _at_edge(camber: CamberLines, edge: int) -> Reals:
    """Real points (m, 2) of the camber lines at an edge."""
    return real_first(camber.points("blade", np.array([float(edge)]))[..., 0, :], 2)


def _usual(exact: ExactBlade, edge: int, needed: float) -> float:
    """The flow path's extent, else the usual one, or more if needed; less where the duct must end before that.

    Where it must end before even what is needed, half way from the blade's foremost or rearmost point.
    """
    extent = exact.meridional_extent
    path_end = extent.path_end(edge)
    wanted = max(USUAL, STEP * float(np.ceil(needed / STEP)))
    if path_end is not None and path_end >= needed:
        wanted = path_end
    duct, end = shortest_duct(exact), extent.place(edge, wanted)
    longer = replace(duct, high=end) if edge else replace(duct, low=end)
    limit = longer.limit("downstream" if edge else "upstream")
    if limit is None:
        return wanted
    nose, last = extent.extent(edge, extent.blade_range[edge]), extent.extent(edge, limit.last)
    return 0.5 * (nose + last) if nose < last < needed else max(needed, LIMIT_SHARE * last)


def _needed(exact: ExactBlade, ends: CamberLines, half_pitch: Array, cross_lines: CrossLines, edge: int) -> float:
    """The least extent: past the bulge of the cross-lines, and past the blade's foremost or rearmost point."""
    extent = exact.meridional_extent
    sign = 1.0 if edge else -1.0
    nose = extent.blade_range[edge] + sign * CLEARANCE * extent.unit
    places = _bulges(ends, half_pitch, cross_lines, edge)
    return extent.extent(edge, float(np.max([nose, *places]) if edge else np.min([nose, *places])))


def _bulges(camber: CamberLines, half_pitch: Array, cross_lines: CrossLines, edge: int) -> Reals:
    """u (2,) on hub and shroud that the duct must reach for the cross-lines from an edge."""
    u = np.broadcast_to(np.real(camber.stations.channel_parameter(np.array([float(edge)]))), (2, 1))
    density = np.real(camber.lines.densities(u)[0])
    extension = _bulge(camber, half_pitch, cross_lines, edge) / density.reshape(-1, 2)[0]
    return np.asarray(u[:, 0] + (extension if edge else -extension))


def _bulge(camber: CamberLines, half_pitch: Array, cross_lines: CrossLines, edge: int) -> Reals:
    """The way in m' (2,) on hub and shroud that the cross-lines from an edge take, with a margin."""
    direction = np.real(camber.direction(edge)).reshape(-1, 2, 2)[0]
    half = float(np.real(half_pitch).flat[0])
    size = np.max([edge_skew(direction[:, 1], half, each, edge, cross_lines.skew) for each in (1, -1)], axis=0)
    if camber.stations.edge_kinds[edge] != "round":
        size = 0.0 * size
    bulge = cross_lines.bulge * np.array(departures(camber, half)) * size * direction[:, 0]
    return np.asarray(BULGE_MARGIN * bulge)
