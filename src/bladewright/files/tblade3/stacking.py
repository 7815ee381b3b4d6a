"""Where T-Blade3's stacking puts the sections of a case around the axis."""

import numpy as np

from bladewright.files.tblade3.records import Stacking
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.edge_spline import SplinedOutline
from bladewright.section.laws import Span
from bladewright.section.outline import Outline

ALONG = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 2001))) / 2.0
"""places along the sides between which the centre of area is that of polygons: exact to 1e-7 chords"""
STEPS = 60
"""bisections of the place at which a side passes a chord fraction"""


def stacking_point(part: CurvatureMeanline, stacking: Stacking) -> Reals:
    """The stacking point (2,) of a section in chords, its leading edge at (0, 0), its chord line along the first axis.

    Where a leading edge is a spline, that is the section's chord line without it, which T-Blade3 goes on to count from.
    Along the chord it is a share of the upper side's end; across, on the chord line, or from the mean of both sides
    towards one of them; or it is the centre of area. `part` holds numbers, not laws.
    """
    sides = _Sides(part)
    if stacking.centroid:
        return _centre(sides)
    along = float(sides(np.ones(1))[0][0, 0]) * stacking.along
    if stacking.above == 0.0:
        return np.array([along, 0.0])
    upper, lower = (_ordinate(sides, along, side) for side in (0, 1))
    middle = 0.5 * (upper + lower)
    reach = abs((upper if stacking.above > 0.0 else lower) - middle)
    return np.array([along, middle + stacking.above * reach])


class _Sides:
    """Points (k, 2) of a section's sides in chords of the section without a leading edge that is a spline."""

    def __init__(self, part: CurvatureMeanline) -> None:
        self._outline = part.outline(Span(np.zeros(1)))

    def __call__(self, s: Reals) -> tuple[Reals, Reals]:
        upper, lower = (unturned(self._outline, np.real(side)[0]) for side in self._outline.points(s))
        return upper, lower


def unturned(outline: Outline, points: Reals) -> Reals:
    """Points (k, 2) in chords of a section without its leading edge spline, from those in chords of the section."""
    if not isinstance(outline, SplinedOutline):
        return points
    tip = np.real(outline.tip)[0]
    along, up = np.array([1.0, 0.0]) - tip
    x, y = points.T
    return tip + np.stack([x * along - y * up, x * up + y * along], axis=-1)


def _ordinate(sides: "_Sides", along: float, side: int) -> float:
    """Ordinate of a side where its abscissa first passes a value, or at its end."""
    s = np.linspace(0.0, 1.0, 513)
    x = sides(s)[side][:, 0]
    past = np.flatnonzero((x[:-1] <= along) & (along <= x[1:]))
    if len(past) == 0:
        at = 0.0 if along <= x[0] else 1.0
        return float(sides(np.array([at]))[side][0, 1])
    low, high = s[past[0]], s[past[0] + 1]
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        below = sides(np.array([middle]))[side][0, 0] < along
        low, high = (middle, high) if below else (low, middle)
    return float(sides(np.array([low]))[side][0, 1])


def _centre(sides: "_Sides") -> Reals:
    upper, lower = sides(ALONG)
    around = np.concatenate([upper, lower[::-1]])
    following = np.roll(around, -1, axis=0)
    areas = cross2(around, following)
    found: Reals = np.sum((around + following) * areas[:, None], axis=0) / (3.0 * np.sum(areas))
    return found
