"""The line off which the heights of free control points are measured: the chord line, or a pseudo skeleton line."""

from dataclasses import dataclass

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated, cross2, dot, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.camber import turned_left
from bladewright.section.power_series import polynomial_points


@dataclass(frozen=True, kw_only=True, eq=False)
class Skeleton:
    """A polynomial line from (0, 0) at fraction 0 to (1, 0) at fraction 1, which continues beyond both."""

    coefficients: Array
    """(..., 4, 2) of the powers of the fraction"""

    def placed(self, fractions: Array, heights: Array) -> Array:
        """Points (..., k, 2) at heights (..., k) off the line, positive to its left, at fractions (..., k)."""
        return polynomial_points(self.coefficients, fractions) + heights[..., None] * turned_left(
            self._tangents(fractions)
        )

    def places(self, points: Reals, fractions: Reals) -> tuple[Reals, Reals]:
        """Fractions and heights (k,) of real points (k, 2) off one line, by Newton's method from fractions (k,)."""
        found = np.array(fractions, dtype=np.float64)
        slope, bend = _derived(self.coefficients), _derived(_derived(self.coefficients))
        for _ in range(30):
            along = polynomial_points(slope, found)
            off = points - polynomial_points(self.coefficients, found)
            step = dot(off, along) / (dot(along, along) - dot(off, polynomial_points(bend, found)))
            found = found + step
            if np.max(np.square(step)) < 1e-30:
                break
        else:
            raise DesignError(
                "skeleton is 'pseudo': a control point lies so far off the pseudo skeleton line that it has no place "
                "along it; refine the design nearer to the line, or use skeleton = 'chord'"
            )
        off = points - polynomial_points(self.coefficients, found)
        return found, cross2(self._tangents(found), off)

    def at(self, section: int) -> "Skeleton":
        """The line of one of the real sections (m,)."""
        return Skeleton(coefficients=np.real(self.coefficients[section]))

    def _tangents(self, fractions: Array) -> Array:
        return unit(polynomial_points(_derived(self.coefficients), fractions))


def chord_line(shape: tuple[int, ...]) -> Skeleton:
    """The chord line as the skeleton of sections (...)."""
    line = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    return Skeleton(coefficients=np.broadcast_to(line, (*shape, 4, 2)))


def pseudo_line(angle_in: Array, angle_out: Array) -> Skeleton:
    """The cubic with the angles (...) [rad] of both edges against the chord line.

    Its arms are those with which a cubic Bezier curve approximates a circular arc of the same turning, so that the
    fraction is close to that of the arc length; without turning it is the chord line. Voss et al. 2025, section 3.1,
    say only that the line is made from the edge angles.
    """
    arm = 1.0 / (3.0 * np.cos(0.25 * (angle_in - angle_out)) ** 2)
    first = arm[..., None] * np.stack([np.cos(angle_in), np.sin(angle_in)], axis=-1)
    end = np.array([1.0, 0.0])
    second = end - arm[..., None] * np.stack([np.cos(angle_out), np.sin(angle_out)], axis=-1)
    rows = [np.zeros_like(first), 3.0 * first, 3.0 * (second - 2.0 * first), end + 3.0 * (first - second)]
    return Skeleton(coefficients=concatenated([row[..., None, :] for row in rows], axis=-2))


def _derived(coefficients: Array) -> Array:
    powers = np.arange(1.0, coefficients.shape[-2])
    return coefficients[..., 1:, :] * powers[:, None]
