import numpy as np
import pytest

from bladewright.numerics.quadrature import LAST_ORDER, adaptive, converged_quadrature, gauss, panels, quadrature_orders


@pytest.mark.parametrize("order", [1, 2, 5, 12])
def test_gauss_quadrature_is_exact_to_twice_its_order_and_no_further(order):
    nodes, weights = gauss(order)
    for power in range(2 * order):
        assert np.isclose(weights @ nodes**power, 1.0 / (power + 1), rtol=1e-13)
    if order < 6:
        assert not np.isclose(weights @ nodes ** (2 * order), 1.0 / (2 * order + 1), rtol=1e-9)


def test_panels_cover_their_breaks():
    nodes, weights = panels([0.0, 0.5, 2.0], 3)
    assert np.isclose(weights.sum(), 2.0)
    assert np.isclose(weights @ nodes**5, 64.0 / 6.0)


def test_a_kink_and_a_cusp_cost_no_accuracy():
    assert np.isclose(adaptive(lambda x: np.abs(x - 1.0 / 3.0), [0.0, 1.0]), 5.0 / 18.0, rtol=1e-13)
    assert np.isclose(adaptive(lambda x: np.abs(x - 0.3) ** 0.5, [0.0, 1.0]), (0.7**1.5 + 0.3**1.5) / 1.5, rtol=1e-11)


def test_falling_breaks_give_the_negative():
    assert np.isclose(adaptive(np.exp, [1.0, 0.4, 0.0]), 1.0 - np.e, rtol=1e-14)


def test_an_imaginary_step_of_the_function_passes():
    assert np.isclose(adaptive(lambda x: np.exp((1.0 + 1e-30j) * x), [0.0, 1.0]).imag / 1e-30, 1.0, rtol=1e-13)


def test_orders_rise_until_the_value_settles():
    asked = []

    def value(order):
        asked.append(order)
        nodes, weights = gauss(order)
        return weights @ np.cos(30.0 * nodes)

    assert np.isclose(converged_quadrature(value, 4), np.sin(30.0) / 30.0, rtol=1e-12)
    assert asked == quadrature_orders(4)[: len(asked)]
    assert asked[-1] < LAST_ORDER
