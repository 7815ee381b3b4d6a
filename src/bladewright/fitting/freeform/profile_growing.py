"""A profile with more control points of its camber or its thickness, until it keeps a tolerance."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from bladewright.errors import FitError

if TYPE_CHECKING:
    from bladewright.fitting.freeform.profile import ProfileFit

MORE = ((1, 0), (0, 1), (1, 1))
"""control points of camber and thickness that are added at a time"""
GROWTHS = 8
NOISE = 3.0
"""deviations of the points' noise that the largest of many distances has by chance"""
WORTH = 0.97
"""ratio of largest distances below which further control points are worth it"""


def within(fitted: "Callable[[int, int], ProfileFit]", camber: int, thickness: int, tolerance: float) -> "ProfileFit":
    """The fit that keeps a tolerance with few control points, from so many on, or the nearest, which says why."""
    found = fitted(camber, thickness)
    evaluations = found.iterations
    reason = f"the tolerance is not reached after {GROWTHS} rounds of control points"
    for _ in range(GROWTHS):
        if found.maximum <= tolerance:
            break
        if found.maximum <= NOISE * found.noise:
            reason = "what is left is the noise of the points: more control points would follow it"
            break
        tried = []
        for more in MORE:
            try:
                tried.append((more, fitted(camber + more[0], thickness + more[1])))
            except FitError as refusal:
                reason = str(refusal)
        evaluations += sum(each.iterations for _, each in tried)
        more, nearest = min(tried, key=lambda each: each[1].maximum, default=((0, 0), found))
        if nearest.maximum > WORTH * found.maximum:
            reason = reason if not tried else "further control points bring the profile no nearer"
            break
        camber, thickness, found = camber + more[0], thickness + more[1], nearest
    notes = found.notes if found.maximum <= tolerance else (*found.notes, reason)
    return replace(found, iterations=evaluations, notes=notes)
