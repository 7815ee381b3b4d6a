import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from bladewright.errors import GeometryError
from bladewright.nurbs.basis import basis, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import approximated, averaged_knots, chord_sites, interpolated, interpolated_surface

CONDITIONS = [(0, 0), (1, 0), (0, 1), (1, 1), (2, 1), (2, 2)]


def wave(x, order=0):
    """(cos 3x, sin 3x) and its derivatives."""
    turned = 3.0 * np.asarray(x) + order * np.pi / 2.0
    return 3.0**order * np.stack([np.cos(turned), np.sin(turned)], axis=-1)


def through_wave(count, degree, start=0, end=0):
    sites = np.linspace(0.0, 1.0, count) ** 1.2
    return sites, interpolated(
        wave(sites),
        sites,
        degree=degree,
        start=[wave(0.0, k + 1) for k in range(start)],
        end=[wave(1.0, k + 1) for k in range(end)],
    )


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
@pytest.mark.parametrize(("start", "end"), CONDITIONS)
def test_an_interpolating_curve_goes_through_points_and_end_derivatives(degree, start, end):
    start, end = min(start, degree - 1), min(end, degree - 1)
    sites, curve = through_wave(9, degree, start, end)
    assert curve.control_points.shape == (9 + start + end, 2)
    assert np.allclose(curve(sites), wave(sites), rtol=0.0, atol=1e-13)
    for k in range(start):
        assert np.allclose(curve.derivative(0.0, k + 1), wave(0.0, k + 1), rtol=1e-11)
    for k in range(end):
        assert np.allclose(curve.derivative(1.0, k + 1), wave(1.0, k + 1), rtol=1e-11)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
@pytest.mark.parametrize(("start", "end"), CONDITIONS)
def test_a_polynomial_of_the_degree_is_reproduced(degree, start, end):
    start, end = min(start, degree - 1), min(end, degree - 1)
    polynomial = np.polynomial.Polynomial(np.arange(1.0, degree + 2.0))
    sites = np.linspace(0.0, 1.0, 8)
    curve = interpolated(
        polynomial(sites)[:, None],
        sites,
        degree=degree,
        start=[[polynomial.deriv(k + 1)(0.0)] for k in range(start)],
        end=[[polynomial.deriv(k + 1)(1.0)] for k in range(end)],
    )
    u = np.linspace(0.0, 1.0, 33)
    assert np.allclose(curve(u)[:, 0], polynomial(u), rtol=1e-12)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_the_error_falls_with_the_power_degree_plus_one_of_the_step(degree):
    u = np.linspace(0.0, 1.0, 1001)
    errors = []
    for count in (17, 33, 65):
        sites = np.linspace(0.0, 1.0, count)
        errors.append(np.max(np.abs(interpolated(wave(sites), sites, degree=degree)(u) - wave(u))))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # near the ends the averaged knots change with the count, so that the constant is not quite one
    assert np.allclose(orders, degree + 1, atol=0.35)


def test_a_cubic_through_points_is_scipys():
    sites = np.sort(np.random.default_rng(0).random(11))
    points = np.random.default_rng(1).random((11, 3))
    knots = averaged_knots(sites, 3)
    expected = make_interp_spline(sites, points, 3, t=knots)
    found = interpolated(points, sites, degree=3)
    assert np.allclose(found.control_points, expected.c, rtol=0.0, atol=1e-12)


def test_end_derivatives_and_points_carry_an_imaginary_step():
    sites = np.linspace(0.0, 1.0, 7)
    points, slope = wave(sites), wave(0.0, 1)
    moved, turned = np.sin(np.arange(14.0)).reshape(7, 2), np.array([0.3, -1.0])
    stepped = interpolated(points + 1e-30j * moved, sites, degree=4, start=[slope + 1e-30j * turned])
    linear = interpolated(moved, sites, degree=4, start=[turned])
    assert np.allclose(stepped.control_points.imag / 1e-30, linear.control_points, rtol=0.0, atol=1e-12)


def test_only_a_complex_end_derivative_makes_the_curve_complex():
    sites = np.linspace(0.0, 1.0, 5)
    assert np.iscomplexobj(interpolated(wave(sites), sites, degree=3, end=[wave(1.0, 1) + 1e-30j]).control_points)
    assert not np.iscomplexobj(interpolated(wave(sites), sites, degree=3, end=[wave(1.0, 1)]).control_points)


def test_an_interpolating_surface_goes_through_its_grid():
    u, v = np.linspace(0.0, 1.0, 7) ** 1.3, np.linspace(0.0, 1.0, 6)
    points = np.stack([*np.meshgrid(u, v, indexing="ij"), np.sin(2 * u)[:, None] * np.cos(3 * v)], axis=-1)
    surface = interpolated_surface(points, u, v, degree_u=4, degree_v=3)
    assert np.allclose(surface.grid(u, v), points, rtol=0.0, atol=1e-13)
    assert np.allclose(surface(0.37, 0.81)[:2], [0.37, 0.81], rtol=0.0, atol=1e-13)


def test_chord_sites_of_points_on_a_line_are_their_distances():
    line = np.array([[0.0, 0.0], [3.0, 4.0], [3.6, 4.8], [6.0, 8.0]])
    assert np.allclose(chord_sites(line), [0.0, 0.5, 0.6, 1.0])
    assert np.allclose(chord_sites(line, 0.5)[1], np.sqrt(5.0) / (np.sqrt(5.0) + 1.0 + 2.0))


def test_least_squares_return_a_spline_that_is_already_there():
    truth = Curve(control_points=np.random.default_rng(0).random((9, 2)), knots=uniform_knots(9, 4), degree=4)
    sites = np.random.default_rng(1).random(300)
    found = approximated(truth(sites), sites, degree=4, knots=truth.knots)
    assert np.allclose(found.control_points, truth.control_points, rtol=0.0, atol=1e-11)


def test_least_squares_leave_a_residual_perpendicular_to_the_basis():
    random = np.random.default_rng(0)
    sites, points, weights = np.sort(random.random(80)), random.random((80, 2)), 0.1 + random.random(80)
    knots = uniform_knots(8, 3)
    curve = approximated(points, sites, degree=3, knots=knots, weights=weights)
    residual = weights[:, None] * (curve(sites) - points)
    assert np.allclose(basis(knots, 3, sites).T @ residual, 0.0, atol=1e-13)


def test_least_squares_may_hold_the_ends():
    random = np.random.default_rng(0)
    sites, points = np.linspace(0.0, 1.0, 50), random.random((50, 2))
    curve = approximated(points, sites, degree=3, knots=uniform_knots(8, 3), ends=True)
    assert np.array_equal(curve.control_points[[0, -1]], points[[0, -1]])
    residual = curve(sites) - points
    assert np.allclose((basis(curve.knots, 3, sites).T @ residual)[1:-1], 0.0, atol=1e-13)


def test_least_squares_carry_an_imaginary_step():
    random = np.random.default_rng(0)
    sites, points, change = random.random(50), random.random((50, 2)), random.random((50, 2))
    knots = uniform_knots(7, 3)
    stepped = approximated(points + 1e-30j * change, sites, degree=3, knots=knots)
    linear = approximated(change, sites, degree=3, knots=knots)
    assert np.allclose(stepped.control_points.imag / 1e-30, linear.control_points, rtol=0.0, atol=1e-13)


X = np.linspace(0.0, 1.0, 6)


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: interpolated(wave(X), X[::-1], degree=3), "above the one before"),
        (lambda: interpolated(wave(X), X[:5], degree=3), "one site a point"),
        (lambda: interpolated(wave(X[:3]), X[:3], degree=3), "lower the degree"),
        (lambda: interpolated(wave(X), X, degree=1, end=[wave(1.0, 1)]), "raise the degree"),
        (lambda: interpolated(wave(X), X, degree=3, knots=uniform_knots(7, 3)), "shape"),
        (lambda: interpolated(wave(X), X, degree=3, knots=2 * uniform_knots(6, 3)), "share their ends"),
        (
            lambda: interpolated(wave(X), X, degree=3, knots=np.array([0, 0, 0, 0, 0.01, 0.02, 1, 1, 1, 1])),
            "control point needs a site",
        ),
        (lambda: approximated(wave(X), X[:5], degree=3, knots=uniform_knots(5, 3)), "one site a point"),
        (lambda: approximated(wave(X / 4), X / 4, degree=3, knots=uniform_knots(9, 3)), "fewer knots"),
        (lambda: approximated(wave(X), X, degree=3, knots=uniform_knots(12, 3)), "fewer knots"),
        (lambda: chord_sites([[0.0, 0.0], [0.0, 0.0]]), "coincide"),
    ],
)
def test_what_does_not_determine_a_curve_is_refused_with_the_reason(ask, says):
    with pytest.raises(GeometryError, match=says):
        ask()
