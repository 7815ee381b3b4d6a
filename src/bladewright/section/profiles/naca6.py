"""NACA 6-series profiles (Abbott, von Doenhoff and Stivers 1945, NACA Report 824)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Law, Limits, parameter
from bladewright.numerics.elementary import Array
from bladewright.section import checks
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.power_series import Series, logarithm, relative_log_series
from bladewright.section.profiles.mean_line import ChebyshevForm, MeanLineOutline, ProfileMeanLine, TrailingEdge
from bladewright.section.profiles.profile import PublishedProfile

ROUNDING = 0.005
"""distance e over which ln|u| is rounded to ln(u^2 + e^2) / 2: the mean line begins with the slope that the published
one has at 0.005 chords, where NACA Report 824 (1945) places the slope of the leading edge's radius [chords]"""
SHARE = 0.08
"""by how much of 1 - a the rounding at x = a, and of the term in 1 - x, is wider: a wider one takes fewer knots and
lies farther from the published line, which has a kink in its load at a [-]"""
CLUSTERING = 0.8
"""clustering of s at the nose, where the mean line bends within 0.005 chords [-]"""
STRETCHING = 3.5
"""k of the hyperbolic tangent that clusters s at a sharp or blunt trailing edge, where the mean line bends as well
[-]"""
END_THICKNESS = 0.01
"""thickness of a blunt or round trailing edge where the design gives none, of the maximum thickness; the published
coordinates (NACA Report 824, 1945) end in a point [-]"""
FORMS: dict[str, tuple[tuple[float, ...], ...]] = {
    "63": (
        (1.028022, -0.329215, -0.277989, -0.083716, 0.00396, -0.008659, 0.017303, 0.004198, 0.015196, 0.002404,
         0.008359, 0.001326, 0.002791),
        (-0.265288, -0.456507, 0.183715, 0.341459, 0.211682, 0.091238, 0.072445, 0.043746, 0.029254, 0.019333,
         0.022057, 0.008135, 0.005061),
        (-0.686731, 0.308504, -1.495808, -0.333392, -1.357923, -0.377665, -0.830171, -0.245458, -0.479705, -0.133649,
         -0.250275, -0.061735, -0.080126),
    ),
    "64": (
        (1.05364, -0.250597, -0.260729, -0.08172, 0.022179, -0.00423, 0.024604, 0.011424, 0.023093, 0.006433,
         0.011329, 0.004166, 0.00416),
        (-0.299588, -0.478864, 0.110069, 0.32828, 0.208193, 0.098563, 0.083674, 0.065347, 0.035603, 0.020344,
         0.022911, 0.011777, -0.001369),
        (-0.326567, 0.424596, -0.782255, -0.207462, -0.8001, -0.302907, -0.444487, -0.217705, -0.253258, -0.112867,
         -0.103948, -0.066114, -0.023261),
    ),
    "65": (
        (1.06979, -0.184605, -0.32091, -0.156959, -0.022517, -0.036093, 0.002572, -0.012755, 0.014556, -0.001325,
         0.008562, -0.000108, 0.004096),
        (-0.192821, -0.234302, 0.269089, 0.53896, 0.437794, 0.29222, 0.201918, 0.167611, 0.113013, 0.065933,
         0.037282, 0.022169, 0.011434),
        (-0.389763, 0.579764, -0.876032, -0.10732, -0.903517, -0.307664, -0.541293, -0.185161, -0.298509, -0.104828,
         -0.107003, -0.021335, -0.03203),
    ),
    "66": (
        (1.219781, 0.08776, -0.219113, -0.147162, 0.009572, 0.018808, 0.060072, 0.020044, 0.038804, 0.017891,
         0.02564, 0.008703, 0.006703),
        (-0.533361, -0.873102, -0.37129, 0.082973, 0.19574, 0.146231, 0.033935, 0.005754, 0.00811, 0.016168,
         0.000337, -0.014785, -0.015012),
        (-0.195489, 0.742227, -0.388209, 0.064082, -0.565088, -0.34654, -0.476556, -0.246609, -0.203215, -0.148035,
         -0.109529, -0.062013, 0.00427),
    ),
}  # fmt: skip
"""half thickness over the thickness t: Chebyshev coefficients of the powers 1, t and t^2; see design/six_series.py"""

LIFT = Limits(-2.0, 2.0, "a lift coefficient must lie between -2 and 2")
LOAD = Limits(0.0, 1.0, "the load is uniform up to a place from 0 to 1 chord", closed=True)


@dataclass(frozen=True, kw_only=True)
class Naca6(PublishedProfile):
    """A NACA 6-series profile: 64-212 has series 64, design lift 0.2 and thickness 0.12.

    The published profiles are conformal maps without a formula. Here the half thickness is an approximation, a
    polynomial of degree 12 times sqrt(x) (1 - x), quadratic in t, that meets the published ordinates of thickness 0.06
    to 0.21 within 2.3e-4 chords (series 63 to 65) and 3.3e-4 chords (66), at 0.12 and below within 1.6e-4. The mean
    line is the published one, its logarithms rounded over 0.005 chords: per unit of lift it lies within 3.3e-4 chords,
    between the first and the last 2 % within 1.9e-4; its own lift is up to 6 % below the nominal one.
    """

    kind: Literal["naca-6"] = "naca-6"
    """which kind of profile this is"""
    series: Literal["63", "64", "65", "66"]
    """the first two digits: the second is where the pressure is lowest, of the chord, times ten"""
    design_lift: Law = parameter("-", limits=LIFT, default=0.0)
    """lift coefficient at the ideal angle of attack, the first digit behind the hyphen over ten [-]"""
    uniform_load: Law = parameter("-", limits=LOAD, default=1.0)
    """a of the mean line: the load is uniform up to there, of the chord, and falls linearly behind [-]"""

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.choice("series", self.series, tuple(FORMS))

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        thickness = span.values(self.thickness)[..., None]
        rows = [a + thickness * (b + thickness * c) for a, b, c in zip(*FORMS[self.series], strict=True)]
        lift, load = (span.values(law)[..., None] for law in (self.design_lift, self.uniform_load))
        return MeanLineOutline(
            mean_line=LoadedLine(lift=lift, load=load),
            thickness=ChebyshevForm(
                coefficients=[thickness * row for row in rows],
                end=0.5 * thickness * self.trailing_edge_share(span, END_THICKNESS),
                opening=self.trailing_edge_opening,
            ),
            end=self.trailing_edge,
            clustering=clustering(self.trailing_edge),
            stretching=STRETCHING,
        )


def clustering(end: TrailingEdge) -> float:
    """Clustering of s at the nose, more where stretching at a sharp or blunt trailing edge thins the steps there."""
    return CLUSTERING if end == "round" else 1.0 - (1.0 - CLUSTERING) / STRETCHING


@dataclass(frozen=True, kw_only=True)
class LoadedLine(ProfileMeanLine):
    """The mean line whose load is uniform up to a and falls linearly to nothing at the trailing edge."""

    lift: Array
    """its lift coefficient at the ideal angle (..., 1)"""
    load: Array
    """a (..., 1)"""

    def ordinate(self, x: Series, aft: NDArray[np.bool_]) -> Series:  # noqa: ARG002 - one piece
        """y at x: (f(x) - f(0) - x (f(1) - f(0))) lift / (2 pi (1 + a)), zero at both ends whatever the rounding."""
        start, end = (self._shape(Series([np.full((1,), at)])).value for at in (0.0, 1.0))
        return (self._shape(x) - start - x * (end - start)) * (self.lift / (2.0 * np.pi * (1.0 + self.load)))

    def _shape(self, x: Series) -> Series:
        """f: the published brackets without what is linear in x.

        With u = a - x and d = 1 - x it is (u^2 ln|u| / 2 - d^2 ln d / 2 + d^2 / 4 - u^2 / 4) / (1 - a) - x ln x; the
        quotient is written without the difference of its terms, so that a may be 1.
        """
        gap = 1.0 - self.load
        rest = 1.0 - x
        ahead = rest - gap
        both = rest + ahead
        wide = ROUNDING**2 + (SHARE * gap) ** 2
        size = ahead * ahead + wide
        ratio = both / size
        log = logarithm(rest * rest + wide) * 0.5
        quotient = (both * log + ahead * ahead * ratio * relative_log_series(ratio * gap) * 0.5) * 0.5 - both * 0.25
        return -quotient - x * logarithm(x * x + ROUNDING**2) * 0.5
