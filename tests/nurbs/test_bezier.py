"""Bernstein polynomials and their derivatives."""

import numpy as np
import pytest

from bladewright.nurbs.bezier import bernstein, bernsteins


@pytest.mark.parametrize("degree", range(6))
def test_bernstein_polynomials_from_the_triangle_are_those_by_powers(degree):
    s = np.linspace(0.0, 1.0, 21)
    found = bernsteins(degree, s)
    for order in range(3):
        # rounding of sums of at most four terms of this size
        scale = 4.0 * max(degree, 1) ** order
        np.testing.assert_allclose(found[:, order], bernstein(degree, s, order), rtol=0.0, atol=1e-15 * scale)
