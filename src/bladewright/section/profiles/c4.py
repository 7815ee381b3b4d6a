"""The British C4 profile (Howell 1942, R. & M. 2095), on a circular-arc mean line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Law, Limits, parameter
from bladewright.numerics.elementary import Array, radians
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.power_series import Series
from bladewright.section.profiles.mean_line import MeanLineOutline, PowerForm, ProfileMeanLine
from bladewright.section.profiles.profile import PublishedProfile

POLYNOMIAL = {1: 0.3048, 2: -0.0914, 4: -0.8614, 6: 2.1236, 8: -2.9163, 10: 1.9744, 12: -0.5231}
"""half thickness of a profile of nominally 0.2 chords: coefficients of the powers of sqrt(x)"""
LARGEST = 0.1001319496141312
"""maximum of that polynomial, by which it is scaled to the thickness asked for [-]"""
FORM = {power: value * 0.5 / LARGEST for power, value in POLYNOMIAL.items()}
"""half thickness over the thickness: coefficients of the powers of sqrt(x)"""
END_THICKNESS = 0.1058603
"""thickness that the polynomial has at x = 1, of the maximum thickness [-]"""

CAMBER = Limits(-120.0, 120.0, "the camber angle must lie between -120 and 120 deg")


@dataclass(frozen=True, kw_only=True)
class C4(PublishedProfile):
    """A C4 profile: 10C4/30C50 has thickness 0.1, camber angle 30 deg, its largest thickness at 0.3.

    The half thickness is the usual polynomial in sqrt(x) for the published ordinates, scaled to the thickness asked
    for, normal to the mean line; it meets the ordinates of the profile of 0.1 chords within 2e-4 chords.
    """

    kind: Literal["c4"] = "c4"
    """which kind of profile this is"""
    camber_angle: Law = parameter("deg", limits=CAMBER, default=0.0)
    """turning of the mean line, a circular arc [deg]"""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        return MeanLineOutline(
            mean_line=ArcLine(angle=radians(span.values(self.camber_angle))[..., None]),
            thickness=PowerForm(coefficients=self.form_coefficients(span, FORM, END_THICKNESS)),
            end=self.trailing_edge,
        )


@dataclass(frozen=True, kw_only=True)
class ArcLine(ProfileMeanLine):
    """A circular arc, above the chord line where its angle is positive."""

    angle: Array
    """the arc's angle (..., 1) [rad]"""

    def ordinate(self, x: Series, aft: NDArray[np.bool_]) -> Series:  # noqa: ARG002 - one piece
        """k x (1 - x) / (cos(angle / 2) + sqrt(1 - k^2 (x - 1/2)^2)), k = 2 sin(angle / 2) the curvature."""
        curvature = 2.0 * np.sin(0.5 * self.angle)
        from_middle = (x - 0.5) * curvature
        return x * (1.0 - x) * curvature / ((1.0 - from_middle * from_middle).sqrt() + np.cos(0.5 * self.angle))
