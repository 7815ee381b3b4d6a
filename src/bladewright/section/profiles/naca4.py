"""NACA four-digit profiles (Jacobs, Ward and Pinkerton 1933, NACA Report 460)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.power_series import Series
from bladewright.section.profiles.mean_line import MeanLineOutline, PowerForm, ProfileMeanLine
from bladewright.section.profiles.profile import PublishedProfile

FORM = {1: 1.4845, 2: -0.6300, 4: -1.7580, 6: 1.4215, 8: -0.5075}
"""half thickness over the thickness: coefficients of the powers of sqrt(x) (NACA Report 460, 1933), shared with the
five-digit profiles"""
END_THICKNESS = 0.021
"""thickness of the published trailing edge, of the maximum thickness (NACA Report 460, 1933) [-]"""

CAMBER = Limits(-0.3, 0.3, "camber must lie between -0.3 and 0.3 chords")
POSITION = Limits(0.02, 0.98, "the place of the largest camber must lie above 0.02 and below 0.98 chords")


@dataclass(frozen=True, kw_only=True)
class Naca4(PublishedProfile):
    """A NACA four-digit profile: 2412 has camber 0.02 at 0.4 and thickness 0.12.

    Half thickness 5 t (0.2969 sqrt(x) - 0.1260 x - 0.3516 x^2 + 0.2843 x^3 - a x^4), a = 0.1015 at the published
    trailing edge and 0.1036 at a sharp one; the profile is 1.0003 t or 1.0001 t thick. At the place of the largest
    camber the mean line has a jump of curvature, and both sides a slight corner, as published; with the largest camber
    at 0.5 it has none.
    """

    kind: Literal["naca-4"] = "naca-4"
    """which kind of profile this is"""
    camber: Law | None = parameter("-", limits=CAMBER, default=None)
    """largest distance of the mean line from the chord line, of the chord; none: a symmetric profile [-]"""
    camber_position: Law | None = parameter("-", limits=POSITION, default=None)
    """place of the largest camber, of the chord; given where camber is [-]"""

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.camber is None) != (self.camber_position is None):
            missing = "camber" if self.camber is None else "camber_position"
            raise DesignError(f"{missing} is missing: a cambered profile needs camber and camber_position, or neither")

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        line: ProfileMeanLine = ChordLine(count=len(span.v))
        if self.camber is not None and self.camber_position is not None:
            camber, position = (span.values(law)[..., None] for law in (self.camber, self.camber_position))
            line = FourDigitLine(camber=camber, joint=position)
        return MeanLineOutline(
            mean_line=line,
            thickness=PowerForm(coefficients=self.form_coefficients(span, FORM, END_THICKNESS)),
            end=self.trailing_edge,
        )


@dataclass(frozen=True, kw_only=True)
class ChordLine(ProfileMeanLine):
    """The mean line of symmetric profiles."""

    count: int
    """number of sections"""

    def ordinate(self, x: Series, aft: NDArray[np.bool_]) -> Series:  # noqa: ARG002 - one piece
        """0 at x."""
        return x * np.zeros((self.count, 1))


@dataclass(frozen=True, kw_only=True)
class FourDigitLine(ProfileMeanLine):
    """Two parabolas that meet at the largest camber."""

    camber: Array
    """(..., 1)"""
    joint: Array
    """(..., 1)"""

    def ordinate(self, x: Series, aft: NDArray[np.bool_]) -> Series:
        """m (2 p x - x^2) / p^2, and m (1 - 2 p + 2 p x - x^2) / (1 - p)^2 behind p."""
        m, p = self.camber, self.joint
        square = np.where(aft, (1.0 - p) ** 2, p**2)
        start = np.where(aft, 1.0 - 2.0 * p, 0.0)
        return ((p * 2.0 - x) * x + start) * (m / square)
