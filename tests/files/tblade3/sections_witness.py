"""T-Blade3's way from a case to its sections in space, written down a second time with scipy's splines and roots.

What the sections are in chords is asked of the family, whose parts have their own tests against T-Blade3's numbers.
"""

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.optimize import brentq

from bladewright.files.tblade3 import section_values
from bladewright.section.laws import Span

ONE = Span(np.zeros(1))


def spline(parameter, values):
    ends = ([(2, np.zeros(values.shape[1:]))], [(3, np.zeros(values.shape[1:]))])
    return make_interp_spline(parameter, values, k=min(3, len(values) - 1), bc_type=ends if len(values) > 2 else None)


class Line:
    """A stream line by its counted m'."""

    def __init__(self, points):
        self.points = np.array(points, dtype=float)
        steps = np.hypot(*np.diff(self.points, axis=0).T)
        self.m = np.append(0.0, np.cumsum(2.0 * steps / (self.points[1:, 1] + self.points[:-1, 1])))
        self.at = spline(self.m, self.points)
        self.rate = self.at.derivative()

    def offset(self, by):
        x, r = self.rate(self.m).T
        return Line(self.points + by * np.stack([r, -x], -1) / np.hypot(x, r)[:, None])

    def crossing(self, curve):
        """m' at an edge curve, which here has an x for each r."""
        points = np.array(curve, dtype=float)
        length = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
        edge = spline(length, points)
        room = 0.3 * length[-1]

        def miss(m):
            r = self.at(m)[1]
            own = brentq(lambda s: edge(s)[1] - r, -room, length[-1] + room, xtol=1e-15)
            return self.at(m)[0] - edge(own)[0]

        return brentq(miss, self.m[0], self.m[-1], xtol=1e-15)


class Witness:
    """Places of a case's sections, lengths of the scale."""

    def __init__(self, case, numbers):
        self.case, self.numbers = case, numbers
        self.lines = [Line(points) for points in case.streamlines]
        if case.hub_offset:
            self.lines[0] = self.lines[0].offset(case.hub_offset)
        if case.tip_offset:
            self.lines[-1] = self.lines[-1].offset(-case.tip_offset)
        self.leading = np.array([line.crossing(case.leading_curve) for line in self.lines])
        self.trailing = np.array([line.crossing(case.trailing_curve) for line in self.lines])
        radius = np.array([line.at(m)[1] for line, m in zip(self.lines, self.leading, strict=True)])
        self.span = (radius - radius[0]) / (radius[-1] - radius[0])
        self.values = section_values(case, self.span)

    def slopes(self, places):
        rates = np.array([line.rate(m) for line, m in zip(self.lines, places, strict=True)])
        return np.arctan2(rates[:, 1], rates[:, 0])

    def points(self, index, s):
        """Points (2, k, 3) of a section's upper and lower side at the outline's s."""
        part = self.numbers.of(index)
        outline, turn = part.outline(ONE), float(part.stagger(ONE)[0])
        chord = (self.trailing - self.leading)[index] * self.values.chord_multiplier[index] / np.cos(turn)
        if self.values.chord is not None:
            chord = self.values.chord[index]
        sweep, lean = self.values.sweep[index], self.values.lean[index]
        believed = 0.0 if self.case.chord == "meridional" else self.values.angle_in[index]
        cosine, sine = abs(np.cos(believed)), abs(np.sin(believed))
        match self.case.true_sweep, self.case.true_lean:
            case True, True:
                sweep, lean = sweep * cosine, lean * cosine
            case True, False:
                sweep, lean = sweep * cosine, sweep * cosine * sine
            case False, True:
                sweep, lean = lean * sine, lean * cosine
        u_stack, v_stack = self.stack(outline, self.case.stackings[index])
        found = []
        for side in outline.points(s):
            u, v = side[0].T
            m = self.leading[index] + sweep
            m = m + chord * (u * np.cos(turn) - v * np.sin(turn))
            theta = chord * ((u - u_stack) * np.sin(turn) + (v - v_stack) * np.cos(turn))
            theta = theta + lean + self.values.theta_offset
            x, r = self.lines[index].at(m).T
            found.append(np.stack([x, r * np.sin(theta), r * np.cos(theta)], -1))
        return np.array(found)

    @staticmethod
    def stack(outline, stacking):
        s = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, 4001))
        upper, lower = (side[0] for side in outline.points(s))
        if stacking.centroid:
            x, y = np.concatenate([upper, lower[::-1]]).T
            area = x * np.roll(y, -1) - y * np.roll(x, -1)
            return [np.sum((each + np.roll(each, -1)) * area) / (3.0 * np.sum(area)) for each in (x, y)]
        u = stacking.along * upper[-1, 0]
        above, below = (np.interp(u, *side[np.argmin(side[:, 0]) :].T) for side in (upper, lower))
        middle = 0.5 * (above + below)
        reach = abs(above - middle)
        return u, (middle + stacking.above * reach if stacking.above else 0.0)
