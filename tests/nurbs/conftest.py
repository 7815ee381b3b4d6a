"""The curves and surfaces that every test of the room runs over, and witnesses that share no code with it."""

from math import factorial

import numpy as np
import pytest

from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolution import arc, circle, revolved
from bladewright.nurbs.surface import Surface


def _draws(*shape, seed=7):
    return np.random.default_rng(seed).random(shape)


def _tilted(n_u, n_v, seed=3):
    u, v = np.meshgrid(np.linspace(0.0, 2.0, n_u), np.linspace(0.0, 1.0, n_v), indexing="ij")
    return np.stack([u, v, np.zeros_like(u)], axis=-1) + 0.3 * _draws(n_u, n_v, 3, seed=seed)


GENTLE = [1.0, 1.2, 0.9, 1.1, 0.8, 1.05, 1.0]
"""weights that stay positive a tenth of the domain past its ends"""
CURVES = {
    "segment": Curve(control_points=[[0.0, 1.0], [2.0, -1.0]], knots=[0, 0, 1, 1], degree=1),
    "scalar": Curve(control_points=_draws(6, 1), knots=uniform_knots(6, 3), degree=3),
    "repeated knots": Curve(control_points=_draws(9, 2), knots=[0] * 4 + [0.2, 0.5, 0.5, 0.5, 0.8] + [1] * 4, degree=3),
    "other domain": Curve(control_points=_draws(8, 3), knots=[-1] * 6 + [0.3, 1.0] + [2.5] * 6, degree=5),
    "rational": Curve(control_points=_draws(7, 3), knots=uniform_knots(7, 4), degree=4, weights=GENTLE),
    "circle": circle((1.0, 2.0), 3.0),
    "complex": Curve(
        control_points=_draws(6, 2) + 1j * _draws(6, 2, seed=8),
        knots=uniform_knots(6, 3),
        degree=3,
        weights=1.0 + 0.2 * _draws(6) + 0.1j * _draws(6, seed=9),
    ),
}
SURFACES = {
    "bilinear": Surface(
        control_points=_tilted(2, 2), knots_u=[0, 0, 1, 1], knots_v=[0, 0, 1, 1], degree_u=1, degree_v=1
    ),
    "smooth": Surface(
        control_points=_tilted(8, 6), knots_u=uniform_knots(8, 4), knots_v=uniform_knots(6, 3), degree_u=4, degree_v=3
    ),
    "other domain": Surface(
        control_points=_tilted(5, 7),
        knots_u=[-2, -2, -2, -1, 0.5, 1, 1, 1],
        knots_v=[0, 0, 0, 0, 2, 2, 2, 5, 5, 5, 5],
        degree_u=2,
        degree_v=3,
    ),
    "rational": Surface(
        control_points=_tilted(6, 5),
        knots_u=uniform_knots(6, 3),
        knots_v=uniform_knots(5, 2),
        degree_u=3,
        degree_v=2,
        weights=0.9 + 0.2 * _draws(6, 5),
    ),
    "sphere": revolved(arc((0.0, 0.0, 0.0), 2.0, 0.0, np.pi, axes=((-1, 0, 0), (0, 1, 0)))),
    "torus": revolved(circle((0.0, 3.0, 0.0), 1.0, axes=((1, 0, 0), (0, 1, 0)))),
    "complex": Surface(
        control_points=_tilted(5, 4) + 1j * _tilted(5, 4, seed=4),
        knots_u=uniform_knots(5, 2),
        knots_v=uniform_knots(4, 3),
        degree_u=2,
        degree_v=3,
        weights=1.0 + 0.2 * _draws(5, 4) + 0.1j * _draws(5, 4, seed=5),
    ),
}


@pytest.fixture(params=CURVES.values(), ids=CURVES)
def curve(request):
    return request.param


@pytest.fixture(params=SURFACES.values(), ids=SURFACES)
def surface(request):
    return request.param


@pytest.fixture(params=[name for name, shape in CURVES.items() if not np.iscomplexobj(shape.homogeneous)])
def real_curve(request):
    return CURVES[request.param]


@pytest.fixture(params=[name for name, shape in SURFACES.items() if not np.iscomplexobj(shape.homogeneous)])
def real_surface(request):
    return SURFACES[request.param]


def cox_de_boor(knots, degree, i, u, span):
    """N_i(u) by its recursion, on the polynomial piece of knot span number `span`; u may be complex."""
    if degree == 0:
        return np.ones_like(u) if i == span else np.zeros_like(u)
    total = np.zeros_like(u)
    if knots[i + degree] > knots[i]:
        total = total + (u - knots[i]) / (knots[i + degree] - knots[i]) * cox_de_boor(knots, degree - 1, i, u, span)
    if knots[i + degree + 1] > knots[i + 1]:
        fraction = (knots[i + degree + 1] - u) / (knots[i + degree + 1] - knots[i + 1])
        total = total + fraction * cox_de_boor(knots, degree - 1, i + 1, u, span)
    return total


def span_of(knots, degree, u):
    inside = [j for j in range(degree, len(knots) - degree - 1) if knots[j] < knots[j + 1] and knots[j] <= u]
    return max(inside, default=degree)


def naive_basis(knots, degree, u, at):
    """All basis functions (n,) at u, real or complex, on the piece that holds the real parameter `at`."""
    span = span_of(knots, degree, at)
    return np.array([cox_de_boor(knots, degree, i, np.asarray(u), span) for i in range(len(knots) - degree - 1)])


def naive_curve(curve, u, at):
    """Points (..., d) at u (...) of the piece that holds the real parameter `at`."""
    values = np.moveaxis(naive_basis(curve.knots, curve.degree, u, at), 0, -1)
    weights = np.ones(values.shape[-1]) if curve.weights is None else curve.weights
    return (values * weights) @ curve.control_points / (values @ weights)[..., None]


def naive_surface(surface, u, v, at):
    """Points (len(u), len(v), d) at u and v of the piece that holds the real parameters `at`."""
    rows = naive_basis(surface.knots_u, surface.degree_u, u, at[0])
    columns = naive_basis(surface.knots_v, surface.degree_v, v, at[1])
    weights = np.ones(surface.control_points.shape[:2]) if surface.weights is None else surface.weights
    weighted = np.einsum("ia,jb,ij,ijd->abd", rows, columns, weights, surface.control_points, optimize=True)
    return weighted / np.einsum("ia,jb,ij->ab", rows, columns, weights)[..., None]


RADIUS, COUNT = 0.1, 64
TURN = np.exp(2j * np.pi * np.arange(COUNT) / COUNT)


def contour_factor(order):
    """Weights (COUNT,) of values on a circle that sum to a derivative at its centre, by Cauchy's integral formula.

    What they leave out falls as the 64th power of the radius over the distance of the nearest pole.
    """
    return factorial(order) / RADIUS**order * TURN**-order / COUNT


@pytest.fixture
def witness():
    return Witness


class Witness:
    """Evaluation by the definition, and derivatives of it by contour integrals."""

    basis = staticmethod(naive_basis)
    curve = staticmethod(naive_curve)
    surface = staticmethod(naive_surface)

    @staticmethod
    def curve_derivative(curve, u, order):
        """The derivative (d,) and a bound for its rounding."""
        values = naive_curve(curve, u + RADIUS * TURN, u)
        factor = contour_factor(order)
        return factor @ values, 1e-14 * np.abs(factor).sum() * np.abs(values).max()

    @staticmethod
    def surface_derivative(surface, u, v, du, dv):
        """The derivative (d,) and a bound for its rounding."""
        values = naive_surface(surface, u + RADIUS * TURN, v + RADIUS * TURN, (u, v))
        along, across = contour_factor(du), contour_factor(dv)
        rounding = 1e-14 * np.abs(along).sum() * np.abs(across).sum() * np.abs(values).max()
        return np.einsum("a,b,abd->d", along, across, values), rounding


@pytest.fixture
def spread():
    """Parameters over a domain, ends and inner points, none on an inner knot of the shapes above."""

    def of(domain, count=23):
        first, last = domain
        return first + (last - first) * np.concatenate([[0.0], (np.arange(count) + 0.417) / count, [1.0]])

    return of
