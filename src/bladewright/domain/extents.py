"""How far a duct must reach past the blade so that no patch of its walls folds."""

from dataclasses import replace

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.exact.meridional_extent import MeridionalExtent
from bladewright.domain.camber_lines import CamberLines, camber_lines
from bladewright.domain.duct import Duct
from bladewright.domain.walls import CrossLines, departure, edge_skew
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import number

USUAL = 0.5
"""extent, in mean meridional lengths, where none is given and the pitch needs no more"""
STEP = 0.25
"""extents that the pitch needs are rounded up to multiples of this, so that small changes of a design keep them"""
MOST = 20.0
"""extent, in mean meridional lengths, above which a duct is refused"""
ROOM = 1.25
"""extents of the walls' patches in which lines of equal v lie, over the bulge of the cross-lines at the edge"""
NOSE = 0.05
"""how much further than the nose, in mean meridional lengths, a duct reaches"""


def extents(
    full: ExactBlade, half_pitch: Array, crossing: CrossLines, upstream: float | None, downstream: float | None
) -> tuple[float, float]:
    """Extents up- and downstream in mean meridional lengths: those given where they suffice, else usual or needed ones.

    A usual one is shortened where the duct would fold over or meet the axis. Raises DesignError where one is not a
    number above what the nose and the pitch need.
    """
    found, ends = [], end_cambers(full)
    for past, (name, given) in enumerate((("upstream", upstream), ("downstream", downstream))):
        needed = _needed(full.meridional_extent, ends, half_pitch, crossing, past)
        if given is None:
            found.append(_usual(full, past, needed))
            continue
        value = float(np.real(number(name, given)))
        if not needed <= value <= MOST:
            raise DesignError(
                f"{name} is {value:g} meridional lengths of the blade: it must be at least {needed:.4g}, so "
                f"that the walls' patches hold the blade's nose and do not fold beside it, and at most {MOST:g}"
            )
        found.append(value)
    return found[0], found[1]


def shortest_duct(full: ExactBlade) -> Duct:
    """The duct that reaches just past the noses."""
    course = full.meridional_extent
    return Duct(
        channel=course.channel,
        start=course.start,
        end=course.end,
        edges=course.edges,
        length=course.length,
        unit=course.unit,
        low=course.noses[0],
        high=course.noses[1],
        revolved=full.mapping.revolved,
    )


def openings(ends: CamberLines, half_pitch: float) -> tuple[float, float]:
    """The share of the width at which cross-lines leave the blade, on hub and shroud."""
    edges = [_at_edge(ends, past) for past in (0, 1)]
    hub, shroud = edges[1][:, 0] - edges[0][:, 0]
    return departure(half_pitch, hub), departure(half_pitch, shroud)


def _at_edge(camber: CamberLines, past: int) -> Reals:
    """Real points (m, 2) of the camber at an edge."""
    points = np.real(camber.points("blade", np.array([float(past)])))[..., 0, :]
    return np.asarray(points.reshape(-1, *points.shape[-2:])[0])


def _usual(full: ExactBlade, past: int, needed: float) -> float:
    """The usual extent; more where it is needed, less where the duct ends before that."""
    course = full.meridional_extent
    wanted = max(USUAL, STEP * float(np.ceil(needed / STEP)))
    duct, end = shortest_duct(full), course.place(past, wanted)
    longer = replace(duct, high=end) if past else replace(duct, low=end)
    limit = longer.limit("downstream" if past else "upstream")
    return wanted if limit is None else max(needed, 0.8 * course.extent(past, limit.last))


def _needed(
    meridional_extent: MeridionalExtent, ends: CamberLines, half_pitch: Array, crossing: CrossLines, past: int
) -> float:
    """The extension must outlast the bulge of the cross-lines, and reach past the nose."""
    sign = 1.0 if past else -1.0
    nose = meridional_extent.noses[past] + sign * NOSE * meridional_extent.unit
    places = _bulges(ends, half_pitch, crossing, past)
    return meridional_extent.extent(past, float(np.max([nose, *places]) if past else np.min([nose, *places])))


def _bulges(camber: CamberLines, half_pitch: Array, crossing: CrossLines, past: int) -> Reals:
    """u (2,) on hub and shroud up to which a duct must reach past cross-lines from an edge."""
    direction = np.real(camber.direction(past)).reshape(-1, 2, 2)[0]
    u = np.broadcast_to(np.real(camber.stations.channel_parameter(np.array([float(past)]))), (2, 1))
    density = np.real(camber.lines.densities(u)[0])
    half = float(np.real(half_pitch).flat[0])
    size = np.max([edge_skew(direction[:, 1], half, each, past, crossing.lean) for each in (1, -1)], axis=0)
    if camber.stations.kinds[past] != "round":
        size = 0.0 * size
    bulge = crossing.bulge * np.array(openings(camber, half)) * size * direction[:, 0]
    reach = ROOM * bulge / density.reshape(-1, 2)[0]
    return np.asarray(u[:, 0] + (reach if past else -reach))


def end_cambers(full: ExactBlade) -> CamberLines:
    """Camber lines on hub and shroud, barely continued."""
    return camber_lines(full.stations(np.array([0.0, 1.0])), shortest_duct(full))
