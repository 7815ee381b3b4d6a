import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from bladewright.numerics.roots import bracketed_root


def test_roots_of_many_equations_are_found_at_once():
    targets = np.linspace(-0.9, 0.9, 50)
    found = bracketed_root(lambda x: (np.sin(x) - targets, np.cos(x)), np.full(50, -1.5), 1.5)
    assert np.allclose(found, np.arcsin(targets), rtol=0.0, atol=1e-15)


def test_falling_functions_have_roots_too():
    assert np.isclose(bracketed_root(lambda x: (2.0 - x**3, -3.0 * x**2), 0.0, 5.0), 2.0 ** (1.0 / 3.0), rtol=1e-15)


@given(power=st.sampled_from([1, 3, 5, 9, 15]), root=st.floats(-0.99, 0.99))
def test_flat_roots_are_reached_by_bisection(power, root):
    found = bracketed_root(lambda x: ((x - root) ** power, power * (x - root) ** (power - 1)), -1.0, 1.0)
    # (x - root)^15 is zero in doubles within 1e-21 of the root
    assert abs(found - root) < 1e-12


def test_a_slope_that_is_wrong_only_slows_the_search():
    found = bracketed_root(lambda x: (x**3 - 0.2, np.full_like(x, -1.0)), 0.0, 1.0)
    assert np.isclose(found, 0.2 ** (1.0 / 3.0), rtol=1e-14)


def test_the_imaginary_part_of_a_root_is_its_derivative():
    target = np.array([0.3, 0.8]) + 1e-30j
    found = bracketed_root(lambda x: (np.sin(x) - target, np.cos(x)), 0.0, 1.5)
    assert np.allclose(found.imag / 1e-30, 1.0 / np.sqrt(1.0 - target.real**2), rtol=1e-13)


def test_a_root_at_an_end_is_found():
    assert np.isclose(bracketed_root(lambda x: (x, np.ones_like(x)), 0.0, 1.0), 0.0, atol=1e-15)
