import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from bladewright.errors import GeometryError
from bladewright.nurbs.basis import basis, greville, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.transform import transformed

ROUNDING = 1e-13  # some hundred operations on numbers of order one


def test_the_basis_functions_are_those_of_the_recursion(curve, spread, witness):
    u = spread(curve.domain)
    expected = [witness.basis(curve.knots, curve.degree, x, x) for x in u]
    assert np.allclose(basis(curve.knots, curve.degree, u), expected, rtol=0.0, atol=ROUNDING)


def test_the_basis_functions_sum_to_one_and_their_derivatives_to_zero(curve, spread):
    u = spread(curve.domain)
    assert np.allclose(basis(curve.knots, curve.degree, u).sum(axis=1), 1.0, rtol=0.0, atol=ROUNDING)
    # derivatives on spans of a tenth are of order a hundred, and cancel
    assert np.allclose(basis(curve.knots, curve.degree, u, 1).sum(axis=1), 0.0, rtol=0.0, atol=1e-11)


def test_greville_abscissae_are_the_control_points_of_the_parameter_itself(curve, spread):
    u = spread(curve.domain)
    line = basis(curve.knots, curve.degree, u) @ greville(curve.knots, curve.degree)
    assert np.allclose(line, u, rtol=0.0, atol=ROUNDING)


def test_a_curve_is_the_weighted_mean_of_its_control_points(curve, spread, witness):
    u = spread(curve.domain)
    expected = [witness.curve(curve, x, x) for x in u]
    assert np.allclose(curve(u), expected, rtol=0.0, atol=ROUNDING * 10)


def test_the_first_and_last_greville_abscissae_are_the_ends_to_the_bit():
    for low, width in np.random.default_rng(0).uniform(0.1, 1.0, (200, 2)):
        high = low + width
        sites = greville(np.repeat([low, high], 6), 5)
        assert (sites[0], sites[-1]) == (low, high)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 6])
def test_derivatives_of_any_order_are_those_of_the_definition(curve, witness, order):
    first, last = curve.domain
    for fraction in (0.11, 0.37, 0.93):
        u = first + fraction * (last - first)
        expected, rounding = witness.curve_derivative(curve, u, order)
        assert np.allclose(curve.derivative(u, order), expected, rtol=0.0, atol=rounding)


def test_derivatives_come_together_as_they_come_alone(curve, spread):
    u = spread(curve.domain)
    together = curve.derivatives(u, 3)
    for order, found in enumerate(together):
        assert np.array_equal(found, curve.derivative(u, order))


def test_a_b_spline_curve_is_scipys(spread):
    control = np.random.default_rng(0).random((9, 3))
    curve = Curve(control_points=control, knots=uniform_knots(9, 4), degree=4)
    u = spread(curve.domain)
    for order in range(6):
        assert np.array_equal(curve.derivative(u, order), BSpline(curve.knots, control, 4)(u, order))


def test_a_curve_starts_and_ends_at_its_end_control_points(curve):
    ends = curve(np.array(curve.domain))
    assert np.allclose(ends, curve.control_points[[0, -1]], rtol=0.0, atol=ROUNDING)


def test_past_its_ends_a_curve_continues_the_taylor_series_of_the_end():
    curve = Curve(control_points=np.random.default_rng(1).random((7, 2)), knots=uniform_knots(7, 3), degree=3)
    for end, step in ((0.0, -0.3), (1.0, 0.2)):
        series = sum(curve.derivative(end, k) * step**k / [1, 1, 2, 6][k] for k in range(4))
        assert np.allclose(curve(end + step), series, rtol=1e-13)


def test_parameters_of_any_shape_give_points_of_that_shape(curve):
    u = np.full((2, 3), 0.5)
    assert curve(u).shape == (2, 3, curve.control_points.shape[1])
    assert curve(0.5).shape == (curve.control_points.shape[1],)


def test_an_imaginary_step_of_a_parameter_is_carried_to_first_order(curve, spread):
    u = spread(curve.domain)
    assert np.allclose(curve(u + 1e-3j), curve(u) + 1e-3j * curve.derivative(u), rtol=0.0, atol=ROUNDING)


def test_an_imaginary_step_of_a_control_point_gives_its_rational_basis_function():
    weights = np.array([1.0, 2.0, 0.5, 1.5])
    control = np.random.default_rng(2).random((4, 2))
    u = np.linspace(0.0, 1.0, 7)
    own = basis(uniform_knots(4, 3), 3, u) * weights
    for i in range(4):
        moved = control.astype(complex)
        moved[i, 0] += 1e-30j
        curve = Curve(control_points=moved, knots=uniform_knots(4, 3), degree=3, weights=weights)
        assert np.allclose(curve(u)[:, 0].imag / 1e-30, own[:, i] / own.sum(axis=1), rtol=1e-13)


def test_an_imaginary_step_of_a_weight_gives_the_derivative_by_the_quotient_rule():
    weights = np.array([1.0, 2.0, 0.5, 1.5])
    control = np.random.default_rng(2).random((4, 2))
    u = np.linspace(0.0, 1.0, 7)
    values = basis(uniform_knots(4, 3), 3, u)
    for i in range(4):
        moved = weights + 1e-30j * (np.arange(4) == i)
        curve = Curve(control_points=control, knots=uniform_knots(4, 3), degree=3, weights=moved)
        expected = values[:, i, None] * (control[i] - curve(u).real) / (values @ weights)[:, None]
        assert np.allclose(curve(u).imag / 1e-30, expected, rtol=1e-12, atol=1e-15)


def test_affine_maps_of_control_points_map_the_curve(curve, spread):
    dimension = curve.control_points.shape[1]
    matrix = np.random.default_rng(5).random((dimension, dimension))
    offset = np.arange(1.0, dimension + 1.0)
    u = spread(curve.domain)
    assert np.allclose(transformed(curve, matrix, offset)(u), curve(u) @ matrix.T + offset, rtol=0.0, atol=1e-12)


@given(
    degree=st.integers(1, 6),
    extra=st.integers(0, 8),
    rational=st.booleans(),
    u=st.floats(0.0, 1.0),
    seed=st.integers(0, 10_000),
)
def test_a_curve_stays_in_the_box_of_its_control_points(degree, extra, rational, u, seed):
    random = np.random.default_rng(seed)
    count = degree + 1 + extra
    inner = np.sort(random.random(extra))
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    control = random.normal(size=(count, 2))
    weights = 0.1 + 5.0 * random.random(count) if rational else None
    point = Curve(control_points=control, knots=knots, degree=degree, weights=weights)(u)
    assert (point >= control.min(axis=0) - 1e-12).all()
    assert (point <= control.max(axis=0) + 1e-12).all()


GOOD = {"control_points": np.zeros((4, 2)), "knots": [0.0, 0, 0, 0.5, 1, 1, 1], "degree": 2}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"degree": 3}, "need"),
        ({"degree": 0}, "at least 1"),
        ({"control_points": np.zeros((2, 2))}, "at least 3"),
        ({"control_points": np.float64(1.0)}, "shape"),
        ({"knots": [0.0, 0, 0, 0.5, 1, 1]}, "shape"),
        ({"knots": [0.0, 0, 0.1, 0.5, 1, 1, 1]}, "clamped"),
        ({"knots": [0.0, 0, 0, 1.5, 1, 1, 1]}, "non-decreasing"),
        ({"knots": [0.0, 0, 0, 1.0, 1, 1, 1]}, "too often"),
        ({"knots": [0.0, 0, 0, np.nan, 1, 1, 1]}, "finite"),
        ({"knots": [0.0, 0, 0, 0.5j, 1, 1, 1]}, "real"),
        ({"weights": [1.0, 1.0]}, "weights"),
        ({"weights": [1.0, 1.0, 0.0, 1.0]}, "positive"),
        ({"weights": [1.0, np.nan, 1.0, 1.0]}, "positive"),
    ],
)
def test_a_curve_that_cannot_be_is_refused_with_the_reason(change, says):
    Curve(**GOOD)
    with pytest.raises(GeometryError, match=says):
        Curve(**{**GOOD, **change})


def test_a_curve_cannot_be_changed_in_place():
    curve = Curve(**GOOD)
    with pytest.raises(ValueError, match="read-only"):
        curve.control_points[0] = 1.0
