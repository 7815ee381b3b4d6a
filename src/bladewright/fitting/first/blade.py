"""A first blade from points in space."""

from itertools import product

import numpy as np

from bladewright.blade.unified import UnifiedBlade
from bladewright.errors import FitError
from bladewright.fitting.clouds.thinning import spread
from bladewright.fitting.first.arrangement import Arrangement, found_arrangement
from bladewright.fitting.first.channel import EDGES, curve_counts
from bladewright.fitting.first.designed import Unit, built_blade
from bladewright.fitting.first.found import Found, apart, continued_in, shape_in
from bladewright.fitting.first.hypotheses import coordinates, ranked
from bladewright.fitting.first.inliers import usual
from bladewright.fitting.first.trimming import trimmed
from bladewright.fitting.structures.structure import Structure
from bladewright.nurbs.basis import Reals

MOST = 1200
"""points that a first blade is drawn through"""
GOOD = 4e-3
"""of the chord: a mean distance with which no other outline is tried"""


def first_blade(
    points: Reals,
    *,
    arrangement: Arrangement | None = None,
    structure: Structure | None = None,
    blade_count: int | None = None,
    pitch: float | None = None,
    name: str = "blade",
    length_unit: Unit = "mm",
) -> UnifiedBlade:
    """A blade of the unified family near points (n, 3) [m] in the machine's axes, found from them alone.

    `pitch` [m] of a linear cascade. Where blade_count or pitch is not given, one at which neighbours stand apart is
    taken. Raises FitError where no blade that can be built lies near the points.
    """
    points = usual(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    points = points[spread(points, MOST)]
    structure = structure or Structure()
    arrangement = arrangement or found_arrangement(points)
    machine, outlines = ranked(coordinates(points, arrangement), revolved=arrangement == "annular")
    wide = float(np.ptp(machine[:, 2]))
    best: tuple[float, UnifiedBlade] | None = None
    refusal = FitError("no blade was found near the points")
    for outline, parting in product(outlines[:3], (True, False)):
        found = _refined(outline, machine, structure, parting=parting)
        away = apart(found, machine)
        if best is not None and away > best[0]:
            continue
        try:
            design, tamings = built_blade(found, arrangement, structure, blade_count, pitch, wide, name, length_unit)
        except FitError as error:
            refusal = error
            continue
        # a design that had to be tamed lies further from the points than its sections did
        away += 0.004 * tamings * found.laid.chord
        if best is None or away < best[0]:
            best = away, design
        if best[0] < GOOD * found.laid.chord:
            break
    if best is None:
        raise refusal
    return best[1]


def _refined(rough: Found, machine: Reals, structure: Structure, *, parting: bool) -> Found:
    """The blade between the ends of its own camber lines, in the numbers of control points that are asked for.

    `parting` holds points to the side that they are seen to belong to.
    """
    count = 4 if len(machine) > 400 else 3
    found = rough
    for step in range(3):
        counts = dict.fromkeys(EDGES, 6) if step == 0 else dict(structure.channel) or curve_counts(found.channel)
        channel = trimmed(found, counts, machine, 0.05 if step == 0 else 0.15)
        shape = shape_in(channel, structure.chordwise, structure.samples, structure.clustering)
        found = continued_in(machine, channel, found, shape, count, ends=step == 2, parting=parting)
    return found
