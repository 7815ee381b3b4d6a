"""The sides by suction and pressure side: cubic B-splines between corners, and the skeleton line of their heights.

Their parametrisation continues that of the edges to second order.
"""

from dataclasses import dataclass
from math import factorial

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated, cross2, dot, length, turned_left, unit
from bladewright.nurbs.basis import Reals, basis, greville, uniform_knots
from bladewright.section.outline import by_parts
from bladewright.section.power_series import polynomial_points
from bladewright.section.suction_pressure.edges import Corner

DEGREE = 3
"""degree of the sides (Voss et al. 2025, section 3)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Side:
    """A side by w in [0, 1] from the leading to the trailing edge, twice differentiable where it joins the edges.

    Pairs belong to the corners at both edges, leading first; in the knot spans next to them the side's own parameter
    is another than w.
    """

    controls: Array
    """(..., n, 2)"""
    knots: Reals
    widths: tuple[float, float]
    """lengths of the knot spans next to the corners"""
    taylor: tuple[Array, Array]
    """(..., 4, 2) coefficients of the polynomials there by the fraction of the knot span, from the corner on"""
    slopes: tuple[Array, Array]
    """(...) first derivatives of the own parameter by w at the corners, in fractions of the span"""
    rises: tuple[Array, Array]
    """(...) its second derivatives there, in the same units"""
    bends: tuple[Array, Array]
    """(..., 2) curvature vectors at the corners times the edge's speed squared"""

    def points(self, w: Reals) -> Array:
        """Points (..., len(w), 2)."""
        first, last = w < self.widths[0], w > 1.0 - self.widths[1]
        middle = ~first & ~last
        parts = [
            (first, self._beside_edge(0, w[first] / self.widths[0])),
            (middle, basis(self.knots, DEGREE, w[middle]) @ self.controls),
            (last, self._beside_edge(1, (1.0 - w[last]) / self.widths[1])),
        ]
        return by_parts(parts, len(w))

    def own_parameter(self, end: int, x: Reals, order: int = 0) -> Array:
        """The own parameter (..., len(x)) in the knot span at an end, or its slope, at fractions x of w's there.

        x - (1 - slope) x (1 - x)^3 (1 + 3 x) + rise x^2 (1 - x)^3 / 2: with value 0, first derivative `slope` and
        second `rise` at the corner, and no change of value and two derivatives at the span's other end.
        """
        y = 1.0 - x
        slower, rise = (1.0 - self.slopes[end])[..., None], self.rises[end][..., None]
        if order == 0:
            return x - slower * (x * y**3 * (1.0 + 3.0 * x)) + rise * (0.5 * x**2 * y**3)
        return 1.0 - slower * (y**2 * (1.0 + 5.0 * x) * (1.0 - 3.0 * x)) + rise * (0.5 * x * y**2 * (2.0 - 5.0 * x))

    def _beside_edge(self, end: int, x: Reals) -> Array:
        return polynomial_points(self.taylor[end], self.own_parameter(end, x))


def side_knots(free: int, inner: tuple[float, ...]) -> Reals:
    """Clamped knots over [0, 1]: uniform where no inner ones are given."""
    if not inner:
        return uniform_knots(free + 4, DEGREE)
    return np.array([0.0] * (DEGREE + 1) + list(inner) + [1.0] * (DEGREE + 1))


def default_places(knots: Reals) -> Reals:
    """Default places (free,) of the free control points: their Greville abscissae."""
    return greville(knots, DEGREE)[2:-2]


def control_points(start: Corner, end: Corner, tangent_in: Array, tangent_out: Array, free: Array) -> Array:
    """Control points (..., n, 2): corner, one on its tangent, the free ones, one on the other tangent, corner."""
    ends = [
        start.point,
        start.point + tangent_in[..., None] * start.direction,
        end.point + tangent_out[..., None] * end.direction,
        end.point,
    ]
    rows = [each[..., None, :] for each in ends]
    return concatenated([rows[0], rows[1], free, rows[2], rows[3]], axis=-2)


def interpolated_free(start: Corner, end: Corner, tangents: tuple[Array, Array], points: Array, knots: Reals) -> Array:
    """Free control points (..., n - 4, 2) of the side through points (..., n - 4, 2) at the default places."""
    matrix = basis(knots, DEGREE, default_places(knots))
    none = np.zeros_like(points)
    fixed = control_points(start, end, *tangents, none)
    return np.asarray(np.linalg.inv(matrix[:, 2:-2]) @ (points - matrix @ fixed))


def spline_points(controls: Array, knots: Reals, w: Array, order: int = 0) -> Array:
    """Derivatives (..., k, 2) of the B-spline at parameters w (..., k) that may be complex and differ by section."""
    real, step = np.real(w), 1j * np.imag(w) if np.iscomplexobj(w) else None
    count = controls.shape[-2]

    def at(derivative: int) -> Array:
        rows = basis(knots, DEGREE, real.ravel(), derivative).reshape(*real.shape, count)
        return np.asarray(rows @ controls)

    found = at(order)
    if step is not None:
        for k in range(1, DEGREE - order + 1):
            found = found + at(order + k) * (step**k / factorial(k))[..., None]
    return found


def continuing_edges(controls: Array, knots: Reals, start: Corner, end: Corner, share: float) -> Side:
    """The side with the parametrisation that continues the edges' to second order.

    `share` is the part of s that an edge takes, over the part of a side.
    """
    widths = float(knots[DEGREE + 1]), float(1.0 - knots[-DEGREE - 2])
    taylor = _taylor(controls, knots, 0.0, widths[0]), _taylor(controls, knots, 1.0, -widths[1])
    slopes, rises, bends = [], [], []
    for powers, corner, width in zip(taylor, (start, end), widths, strict=True):
        speed = length(powers[..., 1, :])
        second = 2.0 * powers[..., 2, :]
        along = dot(second, corner.direction)
        slope = corner.speed * (width / share) / speed
        across = second - along[..., None] * corner.direction
        slopes.append(slope)
        rises.append(-(slope**2) * along / speed)
        bends.append(across * ((corner.speed / speed) ** 2)[..., None])
    return Side(
        controls=controls,
        knots=knots,
        widths=widths,
        taylor=taylor,
        slopes=(slopes[0], slopes[1]),
        rises=(rises[0], rises[1]),
        bends=(bends[0], bends[1]),
    )


def _taylor(controls: Array, knots: Reals, place: float, width: float) -> Array:
    """Coefficients (..., 4, 2) of the powers of the way from a place, in widths."""
    at = np.array([place])
    rows = [basis(knots, DEGREE, at, order) * (width**order / factorial(order)) for order in range(4)]
    return np.asarray(np.concatenate(rows) @ controls)


def chord_line(shape: tuple[int, ...]) -> Array:
    """The chord line as the skeleton line of sections (...): see `pseudo_line`."""
    line = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    return np.broadcast_to(line, (*shape, 4, 2))


def pseudo_line(angle_in: Array, angle_out: Array) -> Array:
    """The cubic skeleton line with the angles (...) [rad] of both edges against the chord line.

    Its coefficients (..., 4, 2) are those of the powers of a fraction, at which it runs from (0, 0) for 0 to (1, 0) for
    1 and on beyond both. Its arms are those with which a cubic Bezier curve approximates a circular arc of the same
    turning, so that the fraction is close to that of the arc length; without turning it is the chord line. Voss et al.
    2025, section 3.1, say only that the line is made from the edge angles.
    """
    arm = 1.0 / (3.0 * np.cos(0.25 * (angle_in - angle_out)) ** 2)
    first = arm[..., None] * np.stack([np.cos(angle_in), np.sin(angle_in)], axis=-1)
    end = np.array([1.0, 0.0])
    second = end - arm[..., None] * np.stack([np.cos(angle_out), np.sin(angle_out)], axis=-1)
    rows = [np.zeros_like(first), 3.0 * first, 3.0 * (second - 2.0 * first), end + 3.0 * (first - second)]
    return concatenated([row[..., None, :] for row in rows], axis=-2)


def points_off_line(line: Array, fractions: Array, heights: Array) -> Array:
    """Points (..., k, 2) at heights (..., k) off a skeleton line, positive to its left, at fractions (..., k)."""
    return polynomial_points(line, fractions) + heights[..., None] * turned_left(_tangents(line, fractions))


def places_off_line(line: Reals, points: Reals, fractions: Reals) -> tuple[Reals, Reals]:
    """Fractions and heights (k,) of points (k, 2) off one skeleton line, by Newton's method from fractions (k,)."""
    found = np.array(fractions, dtype=np.float64)
    slope, bend = _derived(line), _derived(_derived(line))
    for _ in range(30):
        along = polynomial_points(slope, found)
        offset = points - polynomial_points(line, found)
        step = dot(offset, along) / (dot(along, along) - dot(offset, polynomial_points(bend, found)))
        found = found + step
        if np.max(np.square(step)) < 1e-30:
            break
    else:
        raise DesignError(
            "skeleton is 'pseudo': a control point lies so far off the pseudo skeleton line that it has no place "
            "along it; refine the design nearer to the line, or use skeleton = 'chord'"
        )
    return found, cross2(_tangents(line, found), points - polynomial_points(line, found))


def _tangents(line: Array, fractions: Array) -> Array:
    return unit(polynomial_points(_derived(line), fractions))


def _derived(coefficients: Array) -> Array:
    powers = np.arange(1.0, coefficients.shape[-2])
    return coefficients[..., 1:, :] * powers[:, None]
