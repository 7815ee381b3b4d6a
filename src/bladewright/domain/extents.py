"""How far a duct must reach past the blade so that no patch of its walls folds."""

from dataclasses import replace

import numpy as np

from bladewright.blade.exact import ExactBlade
from bladewright.domain.camber import CamberLines, camber_lines
from bladewright.domain.crossing import Crossing
from bladewright.domain.duct import Duct
from bladewright.domain.wall import lean, opening
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.section.checks import number

USUAL = 0.5
"""extent, in u, where none is given and the pitch needs no more"""
STEP = 0.25
"""extents that the pitch needs are rounded up to multiples of this, so that small changes of a design keep them"""
MOST = 20.0
"""extent, in u, above which a duct is refused"""
ROOM = 1.25
"""extents of the walls' patches in which lines of equal v lie, over the bulge of the cross-lines at the edge"""


def extents(
    full: ExactBlade, half_pitch: Array, crossing: Crossing, upstream: float | None, downstream: float | None
) -> tuple[float, float]:
    """Extents up- and downstream in u: those given where they suffice, else the usual or the needed ones.

    A usual one is shortened where the duct would fold over or meet the axis. Raises DesignError where one is not a
    number above what the nose and the pitch need.
    """
    found = []
    for past, (name, given) in enumerate((("upstream", upstream), ("downstream", downstream))):
        needed = _needed(full, half_pitch, crossing, past)
        if given is None:
            found.append(_usual(full, name, needed))
            continue
        value = float(np.real(number(name, given)))
        if not needed <= value <= MOST:
            raise DesignError(
                f"{name} is {value:g} meridional lengths of the blade: it must be at least {needed:.4g}, so "
                f"that the walls' patches hold the blade's nose and do not fold beside it, and at most {MOST:g}"
            )
        found.append(value)
    return found[0], found[1]


def _usual(full: ExactBlade, name: str, needed: float) -> float:
    """The usual extent; more where it is needed, less where the duct ends before that."""
    wanted = max(USUAL, STEP * float(np.ceil(needed / STEP)))
    duct = _camber(full).duct
    limit = replace(
        duct,
        upstream=wanted if name == "upstream" else duct.upstream,
        downstream=wanted if name == "downstream" else duct.downstream,
    ).limit(name)
    return wanted if limit is None else max(needed, 0.8 * limit.most)


def mean_length(exact: ExactBlade) -> float:
    """Mean meridional length of the blade's sections [m]."""
    lengths = np.real(exact.survey.lines.lengths)
    return float(np.mean(lengths.reshape(-1, lengths.shape[-1])[0]))


def openings(full: ExactBlade, half_pitch: float) -> tuple[float, float]:
    """The share of the width at which cross-lines leave the blade, on hub and shroud."""
    hub, shroud = np.real(_camber(full).lines.abscissa(np.array([1.0])))[..., 0].reshape(-1, 2)[0]
    return opening(half_pitch, hub), opening(half_pitch, shroud)


def _needed(full: ExactBlade, half_pitch: Array, crossing: Crossing, past: int) -> float:
    """The extension must outlast the bulge of the cross-lines, and reach past the nose."""
    return max((full.before, full.after)[past] + 0.05, ROOM * _bulge(full, half_pitch, crossing, past))


def _bulge(full: ExactBlade, half_pitch: Array, crossing: Crossing, past: int) -> float:
    """How far, in u, cross-lines from an edge reach past it."""
    camber = _camber(full)
    direction = np.real(camber.direction(past))
    at = np.array([float(past)])
    density = np.real(camber.lines.mapping.density(camber.lines.position(at), camber.lines.position(at, 1)))[..., 0]
    half = float(np.real(half_pitch).flat[0])
    share = np.array(openings(full, half))
    bulges = [
        np.max(
            crossing.bulge
            * share
            * lean(direction[..., 1], half, sign, past, crossing.lean)
            * direction[..., 0]
            / density
        )
        for sign in (1, -1)
    ]
    return max(float(each) for each in bulges)


def _camber(full: ExactBlade) -> CamberLines:
    duct = Duct(
        channel=full.channel,
        start=-full.before,
        end=1.0 + full.after,
        upstream=full.before,
        downstream=full.after,
        revolved=full.mapping.revolved,
        length=mean_length(full),
    )
    stations = full.stations(np.array([0.0, 1.0]))
    return camber_lines(stations, duct)
