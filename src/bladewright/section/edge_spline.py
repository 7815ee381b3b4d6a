"""A leading edge of one quartic B-spline in place of a section's own, with droop and elongation.

The section's leading edge is removed up to a contact on each side. One uniform quartic B-spline of
nine control points closes the gap: at both contacts it has the sides' point and first three derivatives by s, so
curvature and its slope are continuous there, and it passes the tip in the middle of the third of its five segments.
That is nine conditions for nine control points. Reference: Nemnem et al. 2014, ASAT-16-142-PP, "Leading edge option",
figures 15 and 16; they match ratios of parametric derivatives (eq. 23) instead, which T-Blade3 takes from differences
that rounding decides: `design/edge_spline_tblade3.py`.
"""

from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import ClassVar

import numpy as np

from bladewright.designs import Law, Limits, Part, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, concatenated, unit
from bladewright.numerics.solving import solved
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.chord_spline import QUARTIC, segments
from bladewright.section.laws import Span
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline

SEGMENTS = 5
"""segments of the leading edge's spline: nine control points for the nine conditions at contacts and tip"""
SAME = 1e-9
"""difference by s below which a contact is at a joint, and the derivatives behind it count: above rounding [-]"""
WINDOW = 0.05
"""length by s behind the contact of the polynomial whose derivatives there are taken, where a section does not give
them exactly: short enough for degree nine to follow the side, long enough for rounding to stay small in three
derivatives [-]"""
DEGREE = 9
"""degree of that polynomial"""
NARROW = 0.01
"""length by s that this polynomial must have at least: on a fifth of the usual length the rounding of a third
derivative is 125 times as large [-]"""

MOVE = Limits(-2.0, 2.0, "the tip may move by less than twice half the distance between the contacts")


@dataclass(frozen=True, kw_only=True)
class EdgeSpline(Part):
    """The leading edge as a quartic B-spline between contacts with the sides, its tip moved by elongation and droop."""

    path: ClassVar[str] = "leading_edge_spline"
    """where a design holds it, for messages"""

    contact: float = 0.15
    """where the spline meets the sides: the outline's s, 0 at the leading edge; 0.15 is about 0.05 of the chord"""
    elongation: Law = parameter("-", limits=MOVE, default=0.0)
    """how far the tip lies ahead of the section's own, of half the distance between the contacts [-]"""
    droop: Law = parameter("-", limits=MOVE, default=0.0)
    """how far the tip lies towards the lower side, of half the distance between the contacts [-]"""

    def __post_init__(self) -> None:
        contact = checks.number(f"{self.path}.contact", self.contact)
        checks.between(f"{self.path}.contact", contact, 0.02, 0.5, "the contacts must lie between s = 0.02 and 0.5")
        object.__setattr__(self, "contact", contact)
        checks.parameters(self, f"{self.path}.")

    def applied(self, outline: Outline, span: Span) -> "SplinedOutline":
        """The outline with this leading edge, at the places of the span.

        Raises DesignError where a joint of the outline follows a contact closely, or the edge folds back on itself.
        """
        found = SplinedOutline(
            outline=outline,
            contact=self.contact,
            elongation=span.values(self.elongation),
            droop=span.values(self.droop),
        )
        found.check(self.path, span)
        return found


@dataclass(frozen=True, kw_only=True, eq=False)
class SplinedOutline(Outline):
    """An outline whose leading edge, up to s = `contact`, is a quartic B-spline.

    The tip is where the chord line begins: the section is turned by `turned` and stretched so that the chord line runs
    from (0, 0) to (1, 0) again, as a design has to turn its stagger back.
    """

    outline: Outline
    contact: float
    elongation: Array
    """(..., m)"""
    droop: Array
    """(..., m)"""

    @cached_property
    def control_points(self) -> Array:
        """The spline's control points (..., m, 9, 2), from the lower to the upper side, in the chords of `outline`."""
        upper, lower = self._at_contact
        step = 2.0 * self.contact / SEGMENTS
        scale = step ** np.arange(4)[:, None]
        sign = (-1.0) ** np.arange(4)[:, None]
        right = concatenated([lower * scale * sign, self.tip[..., None, :], upper * scale], axis=-2)
        return solved(_conditions(), right)

    @cached_property
    def tip(self) -> Array:
        """The leading edge's new tip (..., m, 2), in the chords of `outline`."""
        upper, lower = (each[..., 0, :] for each in self._at_contact)
        old = self.outline.leading_edge.upper.point
        middle = 0.5 * (upper + lower)
        along = unit(old - middle)
        left = np.stack([-along[..., 1], along[..., 0]], axis=-1)
        across = upper - lower
        half = 0.5 * np.sqrt(np.sum(across * across, axis=-1))
        # seen ahead, the upper side is on the right
        return old + half[..., None] * (self.elongation[..., None] * along + self.droop[..., None] * left)

    @property
    def turned(self) -> Array:
        """Angle (..., m) [rad] from the old chord line to the new one."""
        chord = np.array([1.0, 0.0]) - self.tip
        return angle(chord[..., 1], chord[..., 0])

    @cached_property
    def leading_edge(self) -> Edge:
        powers = segments(np.swapaxes(self.control_points, -1, -2))[..., 2, :]
        step = SEGMENTS / (2.0 * self.contact)
        half = 0.5 ** np.arange(5)
        first = np.sum(powers[..., 1:] * (np.arange(1, 5) * half[:4]), axis=-1) * step
        second = np.sum(powers[..., 2:] * (np.array([2, 6, 12]) * half[:3]), axis=-1) * step**2
        origin = np.zeros_like(first)
        first, second = (self._turned(each[..., None, :])[..., 0, :] for each in (first, second))
        return Edge.rounded(EdgeDerivatives(origin, first, second))

    @cached_property
    def trailing_edge(self) -> Edge:
        edge = self.outline.trailing_edge
        upper, lower = (
            EdgeDerivatives(
                self._placed(side.point[..., None, :])[..., 0, :],
                self._turned(side.first[..., None, :])[..., 0, :],
                self._turned(side.second[..., None, :])[..., 0, :],
            )
            for side in (edge.upper, edge.lower)
        )
        return Edge(kind=edge.kind, upper=upper, lower=lower)

    @property
    def joints(self) -> tuple[Joint, ...]:
        own = (Joint(self.contact * share, 3) for share in (0.2, 0.6, 1.0))
        return (*own, *(joint for joint in self.outline.joints if joint.s > self.contact + SAME))

    def points(self, s: Reals) -> tuple[Array, Array]:
        inside = s < self.contact
        # beyond the contact the outline, within it the spline; each is evaluated where it is defined
        sides = self.outline.points(np.maximum(s, self.contact))
        near = np.minimum(s, self.contact)
        found = (
            np.where(inside[:, None], self._spline(sign * near), side)
            for sign, side in zip((1.0, -1.0), sides, strict=True)
        )
        upper, lower = (self._placed(each) for each in found)
        return upper, lower

    def camber(self, s: Reals) -> Array:
        # the tip's way fades out with three derivatives
        fade = np.maximum(1.0 - (s / self.contact) ** 2, 0.0) ** 4
        moved = (self.tip - self.outline.leading_edge.upper.point)[..., None, :] * fade[:, None]
        return self._placed(self.outline.camber(s) + moved)

    def check(self, path: str, span: Span) -> None:
        """Refuse an edge that folds back: whose ordinate across the line from tip to contacts does not rise."""
        upper, lower = (each[..., 0, :] for each in self._at_contact)
        across = np.real(upper - lower)
        s = np.linspace(-self.contact, self.contact, 81)
        along = np.sum(np.real(self._spline(s)) * across[..., None, :], axis=-1)
        rising = np.all(np.diff(along, axis=-1) > 0.0, axis=-1)
        if not np.all(rising):
            worst = np.argwhere(~rising)[0]
            place = span.v[worst[-1]] if rising.shape[-1] == len(span.v) else span.v[0]
            raise DesignError(
                f"{path} folds back on itself at span fraction {place:.4g}: take less elongation or droop, or contacts "
                f"further from the edge than s = {self.contact:g}"
            )

    @cached_property
    def _at_contact(self) -> tuple[Array, Array]:
        """Point and three derivatives by s (..., m, 4, 2) of the upper and the lower side at the contact."""
        outline, contact = self.outline, self.contact
        joints = [joint.s for joint in outline.joints]
        if outline.has_exact_derivatives and not any((place - contact) ** 2 < SAME**2 for place in joints):
            sides = outline.derivatives(np.array([contact]), 3)
            upper, lower = (np.swapaxes(each[..., 0, :, :], -1, -2) for each in sides)
            return upper, lower
        after = [place for place in joints if place > contact + SAME]
        window = min([WINDOW, 1.0 - contact, *(place - contact for place in after)])
        if window < NARROW:
            raise DesignError(
                f"contact is {contact:g}: the section is not smooth at s = {contact + window:.4g}, too near behind it; "
                "move the contact beyond"
            )
        places, weights = _differences(window)
        upper, lower = (weights @ side for side in outline.points(contact + places))
        return upper, lower

    def _spline(self, s: Reals) -> Array:
        """Points (..., m, k, 2) of the spline, s below zero on the lower side."""
        tau = (s / self.contact + 1.0) * (0.5 * SEGMENTS)
        index = np.clip(np.floor(tau), 0, SEGMENTS - 1).astype(np.intp)
        powers = (tau - index)[:, None] ** np.arange(5)
        basis = np.zeros((len(s), SEGMENTS + 4))
        for k in range(5):
            basis[np.arange(len(s)), index + k] = powers @ QUARTIC[:, k]
        return basis @ self.control_points

    def _placed(self, points: Array) -> Array:
        """Points (..., m, k, 2) in chords of the section from those in chords of `outline`."""
        return self._turned(points - self.tip[..., None, :])

    def _turned(self, vectors: Array) -> Array:
        """Vectors (..., m, k, 2) divided, as complex numbers are, by that from the tip to the trailing edge."""
        chord = (np.array([1.0, 0.0]) - self.tip)[..., None, :]
        square = np.sum(chord * chord, axis=-1)
        x = (vectors[..., 0] * chord[..., 0] + vectors[..., 1] * chord[..., 1]) / square
        y = (vectors[..., 1] * chord[..., 0] - vectors[..., 0] * chord[..., 1]) / square
        return np.stack([x, y], axis=-1)


def _conditions() -> Reals:
    """Matrix (9, 9): derivatives 0 to 3 at the first contact, the tip, derivatives 0 to 3 at the second."""
    matrix = np.zeros((9, 9))
    for k in range(4):
        matrix[k, :5] = factorial(k) * QUARTIC[k]
        falling = np.array([factorial(power) / factorial(power - k) if power >= k else 0.0 for power in range(5)])
        matrix[5 + k, 4:] = falling @ QUARTIC
    matrix[4, 2:7] = 0.5 ** np.arange(5) @ QUARTIC
    return matrix


def _differences(window: float) -> tuple[Reals, Reals]:
    """Places (n,) in [0, reach] and the weights (4, n) of value and three derivatives at 0 of the polynomial there."""
    nodes = 0.5 * (1.0 - np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE))
    powers = np.linalg.inv(np.vander(nodes, increasing=True))[:4]
    scale = np.array([factorial(k) / window**k for k in range(4)])
    return nodes * window, powers * scale[:, None]
