"""NACA five-digit profiles (Jacobs and Pinkerton 1935, NACA Report 537)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Law, Limits, parameter
from bladewright.numerics.elementary import Array, angle
from bladewright.numerics.quadrature import gauss
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.power_series import Series
from bladewright.section.profiles.mean_line import MeanLineOutline, PowerForm, ProfileMeanLine
from bladewright.section.profiles.naca4 import END_THICKNESS, FORM
from bladewright.section.profiles.profile import PublishedProfile

ORDER = 24
"""Gauss points on each piece of a mean line: its lift is then within 3e-13, with 8 points within 2e-9
(design/section_constants.py)"""
STEP = 1e-30
"""imaginary step that differentiates the moment by the joint: so small that its square vanishes [chords]"""

LIFT = Limits(-2.0, 2.0, "a lift coefficient must lie between -2 and 2")
POSITION = Limits(0.02, 0.4, "the place of the largest camber must lie above 0.02 and below 0.4 chords")


@dataclass(frozen=True, kw_only=True)
class Naca5(PublishedProfile):
    """A NACA five-digit profile: 23012 has a lift coefficient of 0.3, its largest camber at 0.15, and thickness 0.12.

    The mean line is a cubic up to the joint r and straight behind it, or a second cubic where it is reflexed, scaled so
    that thin-aerofoil theory gives the design lift, the joint of a reflexed line so that it gives no moment about the
    quarter chord. Of lines of lift 0.3 the published factors k1 are these within 0.3 %, but for the one at 0.05 (361.4,
    here 350.3); of reflexed lines the published joints are these within 0.001, the factors within 1.7 %. The thickness
    is that of the four-digit profiles.
    """

    kind: Literal["naca-5"] = "naca-5"
    """which kind of profile this is"""
    design_lift: Law = parameter("-", limits=LIFT, default=0.3)
    """lift coefficient at the ideal angle of attack, 0.15 times the first digit [-]"""
    camber_position: Law = parameter("-", limits=POSITION, default=0.15)
    """place of the largest camber, of the chord, half the second digit over ten [-]"""
    reflexed: bool = False
    """whether the mean line turns up again, so that the moment about the quarter chord vanishes (third digit 1)"""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        lift, position = (span.values(law)[..., None] for law in (self.design_lift, self.camber_position))
        joint = _reflexed_joint(position) if self.reflexed else _joint(position)
        ratio = _ratio(joint, position) if self.reflexed else 0.0 * joint
        return MeanLineOutline(
            mean_line=FiveDigitLine(factor=lift / _integral(joint, ratio, _lift), joint=joint, ratio=ratio),
            thickness=PowerForm(coefficients=self.form_coefficients(span, FORM, END_THICKNESS)),
            end=self.trailing_edge,
        )


@dataclass(frozen=True, kw_only=True)
class FiveDigitLine(ProfileMeanLine):
    """k1 / 6 ((x - r)^3 - q (1 - r)^3 x - r^3 x + r^3), and q (x - r)^3 for the first term behind r."""

    factor: Array
    """k1 (..., 1)"""
    joint: Array
    """r (..., 1)"""
    ratio: Array
    """q = k2 / k1 (..., 1), 0 where the rear part is straight"""
    joint_derivatives: int = 1

    def ordinate(self, x: Series, aft: NDArray[np.bool_]) -> Series:
        """y at x, by pieces."""
        r, q = self.joint, self.ratio
        from_joint = x - r
        cubic = from_joint * from_joint * from_joint * np.where(aft, q, 1.0)
        return (cubic - x * (q * (1.0 - r) ** 3 + r**3) + r**3) * (self.factor / 6.0)


def _joint(position: Array) -> Array:
    """r with r (1 - sqrt(r / 3)) = p: the cubic is level at p."""
    root = np.sqrt(position)
    for _ in range(60):
        # y = sqrt(r): y^2 - y^3 / sqrt(3) = p, rising below r = 4 / 3
        root = root - (root**2 - root**3 / np.sqrt(3.0) - position) / (2.0 * root - np.sqrt(3.0) * root**2)
    return root * root


def _reflexed_joint(position: Array) -> Array:
    """r at which the moment about the quarter chord vanishes, the camber being largest at p."""
    real = np.real(position)
    low, high = real, real + 0.4
    for _ in range(60):
        middle = 0.5 * (low + high)
        above = np.real(_integral(middle, _ratio(middle, real), _moment)) > 0.0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    root = 0.5 * (low + high)
    stepped = root + STEP * 1j
    slope = np.imag(_integral(stepped, _ratio(stepped, real), _moment)) / STEP
    found: Array = root - _integral(root, _ratio(root, position), _moment) / slope
    return found


def _ratio(joint: Array, position: Array) -> Array:
    """k2 / k1 with which the front cubic is level at the place of the largest camber."""
    ratio: Array = (3.0 * (joint - position) ** 2 - joint**3) / (1.0 - joint) ** 3
    return ratio


def _lift(phase: Array) -> Array:
    """Weight of y' in the lift coefficient at the ideal angle (Glauert 1926, with the angle that makes A0 vanish)."""
    return 2.0 * np.cos(phase)


def _moment(phase: Array) -> Array:
    """Weight of y' in the moment about the quarter chord, but for a factor."""
    return np.cos(phase) - np.cos(2.0 * phase)


def _integral(r: Array, q: Array, weight: Callable[[Array], Array]) -> Array:
    """Integral (..., 1) of weight(phi) y' over phi from 0 to pi, x = (1 - cos(phi)) / 2, k1 being 1."""
    share, gauss_weight = gauss(ORDER)
    middle = angle(np.sqrt(r * (1.0 - r)), 0.5 - r)
    total: Array = np.zeros(())
    for start, end, factor in ((0.0 * middle, middle, 1.0 + 0.0 * q), (middle, np.pi + 0.0 * middle, q)):
        phase = start + (end - start) * share
        x = (1.0 - np.cos(phase)) / 2.0
        rise = (3.0 * factor * (x - r) ** 2 - q * (1.0 - r) ** 3 - r**3) / 6.0
        total = total + np.sum(gauss_weight * rise * weight(phase), axis=-1, keepdims=True) * (end - start)
    return total
