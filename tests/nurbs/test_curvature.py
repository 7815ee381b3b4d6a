import numpy as np
import pytest

from bladewright.errors import GeometryError
from bladewright.nurbs.curvature import curvature, curvature_vector, surface_curvature
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed  # noqa: A004
from bladewright.nurbs.measure import surface_integral
from bladewright.nurbs.revolution import arc, circle, revolved, segment
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.transform import scaled

U = np.linspace(0.0, 1.0, 33)
PARABOLA = Curve(control_points=[[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]], knots=[0, 0, 0, 1, 1, 1], degree=2)
"""y = x^2 with u = x"""
HALF = arc((0.0, 0.0, 0.0), 2.0, 0.0, np.pi, axes=((-1, 0, 0), (0, 1, 0)))
TORUS = revolved(circle((0.0, 3.0, 0.0), 1.0, axes=((1, 0, 0), (0, 1, 0))))


def test_a_circle_bends_left_by_one_over_its_radius():
    assert np.allclose(curvature(circle((1.0, 2.0), 4.0), U), 0.25, rtol=1e-13)
    assert np.allclose(curvature(reversed(circle((1.0, 2.0), 4.0)), U), -0.25, rtol=1e-13)


def test_the_curvature_of_a_parabola_is_that_of_the_calculus():
    assert np.allclose(curvature(PARABOLA, U), 2.0 / (1.0 + 4.0 * U**2) ** 1.5, rtol=1e-13)


def test_the_curvature_vector_of_a_circle_points_to_its_centre():
    for centre, axes in (((1.0, 2.0), ((1, 0), (0, 1))), ((1.0, 2.0, 3.0), ((0, 1, 0), (0, 0, 1)))):
        curve = circle(centre, 4.0, axes=axes)
        assert np.allclose(curvature_vector(curve, U), (centre - curve(U)) / 16.0, rtol=0.0, atol=1e-14)


def test_in_space_curvature_is_the_length_of_its_vector():
    curve = circle((1.0, 2.0, 3.0), 4.0, axes=((0, 1, 0), (0, 0, 1)))
    assert np.allclose(curvature(curve, U), 0.25, rtol=1e-13)


def test_curvature_carries_an_imaginary_step():
    stepped = scaled(PARABOLA, 1.0 + 1e-30j, (0.0, 0.0))
    assert np.allclose(curvature(stepped, U).imag / 1e-30, -curvature(PARABOLA, U), rtol=1e-12)


def test_a_sphere_has_one_curvature_everywhere():
    found = surface_curvature(revolved(HALF), U[1:-1, None], U)
    for principal in (found.maximum, found.minimum, found.mean):
        assert np.allclose(principal, 0.5, rtol=1e-11)
    assert np.allclose(found.gaussian, 0.25, rtol=1e-11)


def test_the_principal_curvatures_of_a_torus_are_those_of_its_circles():
    u, v = U[:-1, None], U[:-1]
    point = TORUS(u, v)
    radius = np.linalg.norm(point[..., 1:], axis=-1)
    around = (radius - 3.0) / radius
    found = surface_curvature(TORUS, u, v)
    sign = np.sign(found.mean[0, 0] * 1.0)
    assert np.allclose(sign * found.mean, 0.5 * (1.0 + around), rtol=1e-11)
    assert np.allclose(found.gaussian, around, rtol=0.0, atol=1e-12)
    assert np.allclose(found.maximum - found.minimum, 1.0 - around, rtol=1e-11)


@pytest.mark.parametrize(("shape", "turns"), [(TORUS, 0.0), (revolved(HALF), 4.0 * np.pi)], ids=["torus", "sphere"])
def test_the_integral_of_gaussian_curvature_is_that_of_gauss_and_bonnet(shape, turns):
    nodes, weights = np.polynomial.legendre.leggauss(24)
    total = 0.0
    for a, b in zip(np.unique(shape.knots_u)[:-1], np.unique(shape.knots_u)[1:], strict=True):
        for c, d in zip(np.unique(shape.knots_v)[:-1], np.unique(shape.knots_v)[1:], strict=True):
            u, v = (a + (b - a) * (nodes[:, None] + 1) / 2), (c + (d - c) * (nodes + 1) / 2)
            size = np.linalg.norm(np.cross(shape.derivative(u, v, 1, 0), shape.derivative(u, v, 0, 1)), axis=-1)
            values = surface_curvature(shape, u, v).gaussian * size
            total += (b - a) * (d - c) / 4 * weights @ values @ weights
    assert np.isclose(total, turns, rtol=0.0, atol=1e-10)
    assert surface_integral(shape, lambda p, *_: np.ones(p.shape[:-1])) == pytest.approx(1.0)


def test_a_saddle_has_opposite_curvatures_at_its_middle():
    net = np.stack([*np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], indexing="ij"), np.zeros((3, 3))], axis=-1)
    net[..., 2] = [[0, -2, 0], [2, 0, 2], [0, -2, 0]]
    knots = [0, 0, 0, 1, 1, 1]
    found = surface_curvature(
        Surface(control_points=net, knots_u=knots, knots_v=knots, degree_u=2, degree_v=2), 0.5, 0.5
    )
    # z = y^2 - x^2 in these coordinates, up to the sign of the axes
    assert np.isclose(found.maximum, 2.0)
    assert np.isclose(found.minimum, -2.0)
    assert np.isclose(found.mean, 0.0, atol=1e-14)
    assert np.isclose(found.gaussian, -4.0)


def test_surface_curvature_carries_an_imaginary_step():
    u, v = 0.13, 0.31
    stepped, plain = (surface_curvature(scaled(TORUS, factor, (0, 0, 0)), u, v) for factor in (1.0 + 1e-30j, 1.0))
    for name, power in (("maximum", 1), ("minimum", 1), ("mean", 1), ("gaussian", 2)):
        assert np.isclose(getattr(stepped, name).imag / 1e-30, -power * getattr(plain, name), rtol=1e-10)


def test_curvature_of_a_plane_patch_without_space_is_refused():
    flat = Surface(
        control_points=np.zeros((2, 2, 2)), knots_u=[0, 0, 1, 1], knots_v=[0, 0, 1, 1], degree_u=1, degree_v=1
    )
    with pytest.raises(GeometryError, match="not 3"):
        surface_curvature(flat, 0.5, 0.5)


def test_a_straight_line_has_no_curvature():
    assert np.array_equal(curvature(segment((0.0, 0.0), (1.0, 2.0)), U), np.zeros(33))
