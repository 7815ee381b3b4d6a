import numpy as np
import pytest
from scipy.interpolate import NdBSpline

from bladewright.errors import GeometryError
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolution import revolved
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.transform import transformed

PLACES = ((0.13, 0.29), (0.61, 0.08), (0.93, 0.77))


def parameters(surface, place):
    (a, b), (c, d) = surface.domain_u, surface.domain_v
    return a + place[0] * (b - a), c + place[1] * (d - c)


def test_a_surface_is_the_weighted_mean_of_its_control_points(surface, witness):
    for place in PLACES:
        u, v = parameters(surface, place)
        assert np.allclose(surface(u, v), witness.surface(surface, [u], [v], (u, v))[0, 0], rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("orders", [(1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 3), (5, 0)])
def test_derivatives_of_any_order_are_those_of_the_definition(surface, witness, orders):
    for place in PLACES:
        u, v = parameters(surface, place)
        expected, rounding = witness.surface_derivative(surface, u, v, *orders)
        assert np.allclose(surface.derivative(u, v, *orders), expected, rtol=0.0, atol=rounding)


def test_derivatives_come_together_as_they_come_alone(surface, spread):
    u, v = spread(surface.domain_u), spread(surface.domain_v)
    for (du, dv), found in surface.derivatives(u, v, 3).items():
        alone = surface.derivative(u, v, du, dv)
        assert np.allclose(found, alone, rtol=1e-12, atol=1e-12 * np.max(np.abs(alone)))


@pytest.mark.parametrize("orders", [(0, 0), (1, 0), (0, 1), (2, 2)])
def test_a_grid_holds_what_scattered_parameters_give(surface, spread, orders):
    u, v = spread(surface.domain_u), spread(surface.domain_v, 11)
    scattered = surface.derivative(u[:, None], v, *orders)
    assert np.allclose(
        surface.grid(u, v, *orders), scattered, rtol=0.0, atol=1e-12 * max(1.0, np.max(np.abs(scattered)))
    )


def test_a_b_spline_surface_is_scipys(spread):
    control = np.random.default_rng(0).random((7, 6, 3))
    knots_u, knots_v = [0.0] * 5 + [0.3, 0.7] + [1.0] * 5, [0.0] * 4 + [0.4, 0.4] + [1.0] * 4
    surface = Surface(control_points=control, knots_u=knots_u, knots_v=knots_v, degree_u=4, degree_v=3)
    sites = np.stack(np.meshgrid(spread((0, 1)), spread((0, 1)), indexing="ij"), axis=-1)
    expected = NdBSpline((np.array(knots_u), np.array(knots_v)), control, (4, 3))(sites)
    assert np.array_equal(surface(sites[..., 0], sites[..., 1]), expected)


def test_the_corners_are_control_points(surface):
    (a, b), (c, d) = surface.domain_u, surface.domain_v
    net = surface.control_points
    corners = surface(np.array([[a, a], [b, b]]), np.array([[c, d], [c, d]]))
    assert np.allclose(corners, net[[0, -1]][:, [0, -1]], rtol=0.0, atol=1e-13)


def test_affine_maps_of_control_points_map_the_surface(surface, spread):
    matrix, offset = np.random.default_rng(5).random((3, 3)), np.array([1.0, 2.0, 3.0])
    u, v = spread(surface.domain_u), spread(surface.domain_v)
    mapped = transformed(surface, matrix, offset)(u, v)
    assert np.allclose(mapped, surface(u, v) @ matrix.T + offset, rtol=0.0, atol=1e-12)


def test_an_imaginary_step_of_a_parameter_gives_the_derivative(real_surface):
    u, v = parameters(real_surface, PLACES[0])
    step = 1e-25
    assert np.allclose(real_surface(u + 1j * step, v).imag / step, real_surface.derivative(u, v, 1, 0), rtol=1e-13)
    assert np.allclose(real_surface(u, v + 1j * step).imag / step, real_surface.derivative(u, v, 0, 1), rtol=1e-13)
    both = real_surface(u + 1j * step, v + 2j * step).imag / step
    along = real_surface.derivative(u, v, 1, 0) + 2.0 * real_surface.derivative(u, v, 0, 1)
    assert np.allclose(both, along, rtol=1e-13)


def test_an_imaginary_step_of_a_control_point_reaches_points_and_normals():
    control = np.random.default_rng(1).random((5, 4, 3)) + np.arange(5.0)[:, None, None] * [1, 0, 0]
    control = control + np.arange(4.0)[:, None] * [0, 1, 0]
    shape = {"knots_u": [0, 0, 0, 0.3, 0.7, 1, 1, 1], "knots_v": [0, 0, 0, 0, 1, 1, 1, 1], "degree_u": 2, "degree_v": 3}
    change = np.zeros_like(control)
    change[2, 1] = [0.3, -0.2, 1.0]
    stepped = Surface(control_points=control + 1e-30j * change, **shape)
    up, down = (Surface(control_points=control + h * change, **shape) for h in (1e-6, -1e-6))
    for name in ("__call__", "normal"):
        difference = (getattr(up, name)(0.4, 0.6) - getattr(down, name)(0.4, 0.6)) / 2e-6
        # a central difference at 1e-6 is good to about 1e-10
        assert np.allclose(getattr(stepped, name)(0.4, 0.6).imag / 1e-30, difference, rtol=0.0, atol=1e-8)


def test_normals_are_unit_and_perpendicular(real_surface, spread):
    u, v = np.meshgrid(spread(real_surface.domain_u)[1:-1], spread(real_surface.domain_v)[1:-1])
    normal = real_surface.normal(u, v)
    assert np.allclose(np.linalg.norm(normal, axis=-1), 1.0, rtol=1e-14)
    for orders in ((1, 0), (0, 1)):
        tangent = real_surface.derivative(u, v, *orders)
        assert np.allclose(np.sum(normal * tangent, axis=-1), 0.0, atol=1e-12 * np.max(np.abs(tangent)))


def test_the_normal_of_a_sphere_is_its_radius_also_at_the_poles():
    theta = np.pi / 4
    half = Curve(
        control_points=[[-1, 0, 0], [-1, 1, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
        knots=[0, 0, 0, 0.5, 0.5, 1, 1, 1],
        degree=2,
        weights=[1, np.cos(theta), 1, np.cos(theta), 1],
    )
    sphere = revolved(half)
    u, v = np.array([0.0, 0.2, 0.5, 0.9, 1.0])[:, None], np.array([0.1, 0.4, 0.85])
    assert np.allclose(sphere.normal(u, v), -sphere(u, v), rtol=0.0, atol=1e-12)


def test_complex_parameters_of_normals_are_refused():
    surface = Surface(
        control_points=np.zeros((2, 2, 3)), knots_u=[0, 0, 1, 1], knots_v=[0, 0, 1, 1], degree_u=1, degree_v=1
    )
    with pytest.raises(GeometryError, match="real"):
        surface.normal(0.5j, 0.5)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"control_points": np.zeros((4,))}, "n_u, n_v, d"),
        ({"knots_u": [0.0, 0, 1]}, "knots_u"),
        ({"knots_v": [0.0, 1, 0, 1]}, "knots_v"),
        ({"degree_v": 2}, "knots_v"),
        ({"weights": np.ones((2, 3))}, "weights"),
        ({"weights": -np.ones((2, 2))}, "positive"),
    ],
)
def test_a_surface_that_cannot_be_is_refused_with_the_reason(change, says):
    good = {
        "control_points": np.zeros((2, 2, 3)),
        "knots_u": [0.0, 0, 1, 1],
        "knots_v": [0.0, 0, 1, 1],
        "degree_u": 1,
        "degree_v": 1,
    }
    Surface(**good)
    with pytest.raises(GeometryError, match=says):
        Surface(**{**good, **change})
