"""Where a blade ends, as far as its cloud shows it: a row of points does, points scattered near the end do not."""

from bladewright.fitting.matching.search import Found
from bladewright.fitting.matching.walls import ENDS

LOOSE = 1e-4
"""spread of the points at an end, of the chord, from which they stand in no row"""
NOISY = 2.0
"""the same, of the cloud's noise"""
GAP = 2.7
"""distance of evenly scattered values over their deviation by the median, times their number"""


def loose_ends(found: Found) -> dict[str, float]:
    """The ends of a blade that no row of points shows, and how far apart the points are there [m].

    Empty for sections, and where the channel is not sought: the sides of a blade that goes on a little further are the
    same, so that only its outermost points tell where it ends.
    """
    if found.state.shape.exact is None or not any(path.startswith("channel.") for path in found.problem.paths):
        return {}
    chord, walls = found.model.chord, found.ends.walls
    loose = {}
    for name in ENDS:
        wall = walls.get(name)
        if wall is None:
            loose[name] = chord
        elif wall.spread > max(LOOSE * chord, NOISY * found.scatter.noise):
            loose[name] = GAP * wall.spread / len(wall.places)
    return loose
