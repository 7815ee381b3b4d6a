"""The sides of the unified section: quartic B-splines around the camber line, with edge radii by construction.

At an edge both sides have its radius of curvature, but different speeds. Inside the knot span next to the edge a side's
own parameter a therefore becomes a polynomial of the section's parameter s,

    a(s) = s + (alpha - 1) h p(s / h) + beta h^2 q(s / h),    p(x) = x (1 - x)^4 (1 + 4 x),    q(x) = x^2 (1 - x)^4 / 2,

with a' = alpha and a'' = beta at the edge, and value and three derivatives unchanged at the span's other end h. alpha
and beta are such that the two sides have opposite first and equal second derivatives at the edge.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import factorial

import numpy as np

from bladewright.numerics.elementary import Array, concatenated, dot, turned_left
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.section.camber import camber_points, camber_tangents
from bladewright.section.power_series import polynomial_points

DEGREE = 4
"""degree of the sides (Agromayor et al. 2021)"""
BRAKE = 20.0
"""square of the rise (second derivative over first, in knot spans) from which the sides are slowed at an edge

With alpha = (1 + rise^2 / BRAKE)^(-1/3) and beta h = -rise alpha^2 the parametrisation is monotone for every rise: its
slope stays above 0.56 alpha, also where the sides' speeds differ by a quarter and their rises by half
(design/edge_parametrisation.py).
"""


def sample_places(samples: int, clustering: float) -> Reals:
    """Camber parameters (samples + 5,) of a side's control points, of which the inner `samples` carry thickness.

    Two control points belong to each edge: the edge itself and the one that sets its radius (Agromayor et al. 2021,
    eq. 14). Between them the places are uniform for clustering 0 and cosine-spaced for 1.
    """
    uniform = np.linspace(0.0, 1.0, samples + 2)
    cosine = (1.0 - np.cos(np.pi * uniform)) / 2.0
    inner = (1.0 - clustering) * uniform + clustering * cosine
    inner[-1] = 1.0
    return np.concatenate([[0.0], inner, [1.0]])


def advances(line: Array, places: Reals, thickness: Array, upper: bool) -> tuple[Array, Array]:
    """How far the third control point from each edge lies inside the blade, along the edge's camber tangent (...).

    Both must be positive, or no edge radius can be set: the side would leave the edge outwards.
    """
    inner = _thickened(line, places, thickness, upper)
    tangents = camber_tangents(line, np.array([0.0, 1.0]))
    at_start = dot(inner[..., 0, :] - line[..., 0, :], tangents[..., 0, :])
    at_end = dot(line[..., 3, :] - inner[..., -1, :], tangents[..., 1, :])
    return at_start, at_end


def edge_height(advance: Array, curvature: Array, ratio: float | Array = 1.0) -> Array:
    """Distance of the second control point from the edge that gives the side the curvature at its end.

    `ratio` is w0 w2 / w1^2 of the weights. Uniform knots: the end's two knot spans are equal.
    Reference: Agromayor et al. 2021, eq. A.7.
    """
    return np.sqrt((DEGREE - 1) / DEGREE * 0.5 * ratio * advance / curvature)


def side(
    line: Array,
    places: Reals,
    thickness: Array,
    curvature_in: Array,
    curvature_out: Array,
    *,
    upper: bool,
    weights: Array | None = None,
) -> Array:
    """Control points (..., n, 2) of a side, or (..., n, 3) homogeneous (w x, w y, w) where weights are given.

    `line` (..., 4, 2) camber line; `places` (n,) camber parameters; `thickness` (..., n - 4) half thicknesses at the
    inner places; curvatures (...) at the edges; `weights` (..., n). Reference: Agromayor et al. 2021, eqs. 12, 13.
    """
    inner = _thickened(line, places, thickness, upper)
    ends = line[..., [0, 3], :]
    normals = turned_left(camber_tangents(line, np.array([0.0, 1.0]))) * (1.0 if upper else -1.0)
    at_start, at_end = advances(line, places, thickness, upper)
    ratio_in: float | Array = 1.0
    ratio_out: float | Array = 1.0
    if weights is not None:
        ratio_in = weights[..., 0] * weights[..., 2] / weights[..., 1] ** 2
        ratio_out = weights[..., -1] * weights[..., -3] / weights[..., -2] ** 2
    second = ends[..., 0, :] + edge_height(at_start, curvature_in, ratio_in)[..., None] * normals[..., 0, :]
    before_last = ends[..., 1, :] + edge_height(at_end, curvature_out, ratio_out)[..., None] * normals[..., 1, :]
    rows = [ends[..., :1, :], second[..., None, :], inner, before_last[..., None, :], ends[..., 1:, :]]
    points = concatenated(rows, axis=-2)
    if weights is None:
        return points
    return concatenated([points * weights[..., None], weights[..., None]], axis=-1)


def _thickened(line: Array, places: Reals, thickness: Array, upper: bool) -> Array:
    inner = places[2:-2]
    normals = turned_left(camber_tangents(line, inner)) * (1.0 if upper else -1.0)
    return camber_points(line, inner) + thickness[..., None] * normals


@dataclass(frozen=True, kw_only=True)
class EdgeParametrisation:
    """One edge of a section, seen from the edge into the blade."""

    normal_speed: Array
    """(...) common speed d|C|/ds of both sides"""
    tangential: Array
    """(...) second derivative along the camber's normal, common to both sides"""
    upper: tuple[Array, Array]
    """alpha, beta (...) of the upper side"""
    lower: tuple[Array, Array]
    """alpha, beta (...) of the lower side"""


def edge_parametrisation(upper: Array, lower: Array, normal: Array, span: float) -> EdgeParametrisation:
    """The common parametrisation of both sides at an edge.

    `upper` and `lower` (..., k, 2) are the sides' Taylor coefficients at the edge by their own parameter (value,
    first derivative, half the second...), `normal` (..., 2) the camber's normal towards the upper side, `span` the
    length h of the knot span next to the edge.
    """
    speed_upper = dot(upper[..., 1, :], normal)
    speed_lower = -dot(lower[..., 1, :], normal)
    second_upper = 2.0 * dot(upper[..., 2, :], normal)
    second_lower = 2.0 * dot(lower[..., 2, :], normal)
    rise = span * (second_upper / speed_upper - second_lower / speed_lower) / 2.0
    brake = (1.0 + rise**2 / BRAKE) ** (-1.0 / 3.0)
    speed = np.sqrt(speed_upper * speed_lower) * brake
    alpha_upper = speed / speed_upper
    alpha_lower = speed / speed_lower
    along_upper = alpha_upper**2 * second_upper
    along_lower = alpha_lower**2 * second_lower
    common = (along_upper + along_lower) / 2.0
    return EdgeParametrisation(
        normal_speed=speed,
        tangential=common,
        upper=(alpha_upper, (common - along_upper) / speed_upper),
        lower=(alpha_lower, (along_lower - common) / speed_lower),
    )


def reparametrised(s: Reals, alpha: Array, beta: Array, span: float) -> Array:
    """The side's own parameter a (..., len(s)) at distances s in [0, span] from the edge."""
    x = s / span
    return (
        s
        + (alpha - 1.0)[..., None] * (span * x * (1 - x) ** 4 * (1 + 4 * x))
        + beta[..., None] * (span**2 * x**2 * (1 - x) ** 4 / 2)
    )


@dataclass(frozen=True, kw_only=True)
class PlaneSections:
    """Sections (...) whose sides are B-splines, rational where the control points are homogeneous."""

    camber: Array
    """(..., 4, 2) control points of the camber lines"""
    upper: Array
    """(..., n, 2) or homogeneous (..., n, 3)"""
    lower: Array
    """(..., n, 2) or homogeneous (..., n, 3)"""
    leading_edge: EdgeParametrisation
    trailing_edge: EdgeParametrisation

    @property
    def span(self) -> float:
        """Length of a knot span of the sides."""
        return 1.0 / (self.upper.shape[-2] - DEGREE)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side at s in [0, 1], increasing."""
        upper = _side_points(self.upper, s, self.span, self.leading_edge.upper, self.trailing_edge.upper)
        return upper, _side_points(self.lower, s, self.span, self.leading_edge.lower, self.trailing_edge.lower)


def plane_sections(camber: Array, upper: Array, lower: Array) -> PlaneSections:
    """Sections from camber lines and the control points of their sides."""
    span = 1.0 / (upper.shape[-2] - DEGREE)
    normals = turned_left(camber_tangents(camber, np.array([0.0, 1.0])))
    ends = [
        edge_parametrisation(taylor(upper, flip), taylor(lower, flip), normals[..., i, :], span)
        for i, flip in enumerate((False, True))
    ]
    return PlaneSections(camber=camber, upper=upper, lower=lower, leading_edge=ends[0], trailing_edge=ends[1])


def matched(upper: Array, lower: Array) -> tuple[Array, Array]:
    """Both sides' control points, made homogeneous where those of one side are."""
    if upper.shape[-1] == lower.shape[-1]:
        return upper, lower
    sides = [np.concatenate([c, np.ones_like(c[..., :1])], axis=-1) if c.shape[-1] == 2 else c for c in (upper, lower)]
    return sides[0], sides[1]


def taylor(controls: Array, from_end: bool) -> Array:
    """Taylor coefficients (..., 5, 2) of a side at its start, or at its end by the distance from it.

    A rational side's series is that of the quotient, cut after the fourth power: only its first three serve.
    """
    series = _taylor_matrix(controls.shape[-2], from_end=from_end) @ controls
    return series if controls.shape[-1] == 2 else _quotient(series)


def _quotient(series: Array) -> Array:
    weight = series[..., 2]
    terms: list[Array] = []
    for k in range(series.shape[-2]):
        value = series[..., k, :2]
        for i in range(k):
            value = value - weight[..., k - i, None] * terms[i]
        terms.append(value / weight[..., 0, None])
    return np.stack(terms, axis=-2)


@lru_cache(maxsize=64)
def _taylor_matrix(count: int, from_end: bool) -> Reals:
    knots = uniform_knots(count, DEGREE)
    at = np.array([1.0 if from_end else 0.0])
    sign = -1.0 if from_end else 1.0
    rows = [basis(knots, DEGREE, at, order)[0] * sign**order / factorial(order) for order in range(DEGREE + 1)]
    return np.stack(rows)


def _side_points(controls: Array, s: Reals, span: float, start: tuple[Array, Array], end: tuple[Array, Array]) -> Array:
    first = int(np.searchsorted(s, span, side="left"))
    last = max(first, int(np.searchsorted(s, 1.0 - span, side="right")))
    knots = uniform_knots(controls.shape[-2], DEGREE)
    middle = basis(knots, DEGREE, s[first:last]) @ controls
    at_start = polynomial_points(
        _taylor_matrix(controls.shape[-2], from_end=False) @ controls, reparametrised(s[:first], *start, span)
    )
    distance = reparametrised(1.0 - s[last:], *end, span)
    at_end = polynomial_points(_taylor_matrix(controls.shape[-2], from_end=True) @ controls, distance)
    points = concatenated([at_start, middle, at_end], axis=-2)
    return points if points.shape[-1] == 2 else points[..., :2] / points[..., 2:]


def camber_curve(control_points: Array) -> Curve:
    """The cubic camber line of control points (4, 2)."""
    return Curve(control_points=control_points, knots=uniform_knots(4, 3), degree=3)


def side_curve(controls: Array) -> Curve:
    """The quartic side of control points (n, 2), or rational of homogeneous ones (n, 3)."""
    knots = uniform_knots(len(controls), DEGREE)
    if controls.shape[-1] == 2:
        return Curve(control_points=controls, knots=knots, degree=DEGREE)
    weights = controls[:, 2]
    return Curve(
        control_points=controls[:, :2] / weights[:, None], knots=knots, degree=DEGREE, weights=np.array(weights)
    )
