"""Power series: closed forms of sums, products, quotients, roots and sines."""

from math import factorial

import numpy as np
import pytest

from bladewright.section.power_series import Series, joined_series, polynomial, sine_and_cosine, variable

ORDER = 5
AT = np.array([0.3, 0.7])
X = variable(AT, ORDER)
POWERS = range(ORDER + 1)


def same(series: Series, derivatives) -> None:
    np.testing.assert_allclose(series.derivatives(), np.stack(derivatives, axis=-1), rtol=1e-12, atol=1e-12)


def test_a_sine_has_the_derivatives_of_the_sine():
    same(sine_and_cosine(X * 2.0)[0], [2.0**k * np.sin(2.0 * AT + k * np.pi / 2.0) for k in POWERS])


def test_a_quotient_has_the_derivatives_of_the_reciprocal():
    same(1.0 / X, [(-1.0) ** k * factorial(k) / AT ** (k + 1) for k in POWERS])
    same((X * X) / X, X.derivatives().T.reshape(ORDER + 1, -1))


def test_the_square_of_a_root_is_what_it_was():
    same((X.sqrt() * X.sqrt()) - X + 1.0, (0.0 * X + 1.0).derivatives().T)


def test_a_polynomial_has_its_derivatives():
    same(
        polynomial([1.0, 0.0, 2.0, -1.0], X),
        [1 + 2 * AT**2 - AT**3, 4 * AT - 3 * AT**2, 4 - 6 * AT, 0 * AT - 6, 0 * AT, 0 * AT],
    )


@pytest.mark.parametrize("array", [np.array([2.0, 3.0]), np.array([[2.0], [3.0]])])
def test_an_array_on_the_left_leaves_the_operation_to_the_series(array):
    for found, other in ((array * X, X * array), (array + X, X + array), (array - X, -(X - array))):
        assert isinstance(found, Series)
        np.testing.assert_array_equal(found.derivatives(), other.derivatives())


def test_series_joined_along_their_places_broadcast():
    both = joined_series([X, Series([np.array([[5.0]])] + [np.zeros((1, 1))] * ORDER)])
    np.testing.assert_array_equal(both.value, [[0.3, 0.7, 5.0]])
