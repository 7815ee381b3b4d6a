"""Laws of evolution along the span."""

import numpy as np
import pytest

from bladewright.section.laws import Span, joints_of, law_basis

V = np.linspace(0.0, 1.0, 23)


@pytest.mark.parametrize("count", range(1, 9))
def test_a_laws_basis_sums_to_one_and_is_positive(count):
    matrix = law_basis(count, V)
    assert matrix.sum(axis=1) == pytest.approx(np.ones(len(V)), abs=1e-14)
    assert np.min(matrix) >= 0.0


@pytest.mark.parametrize("count", range(2, 9))
def test_a_law_starts_and_ends_at_its_outer_control_points(count):
    law = tuple(float(k * k + 1) for k in range(count))
    values = Span(V).values(law)
    assert values[[0, -1]] == pytest.approx([law[0], law[-1]], abs=1e-13)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_a_law_of_up_to_four_control_points_is_a_bernstein_polynomial(count):
    from math import comb

    law = tuple(np.sin(3.0 * k) for k in range(count))
    degree = count - 1
    bernstein = sum(law[k] * comb(degree, k) * V**k * (1 - V) ** (degree - k) for k in range(count))
    assert Span(V).values(law) == pytest.approx(bernstein, abs=1e-14)


def test_a_constant_has_its_value_everywhere():
    assert np.all(Span(V).values(3.25) == 3.25)


def test_a_law_carries_a_batch_of_imaginary_steps():
    batch = np.array([1.0, 1.0 + 1e-30j])
    values = Span(V).values((batch, 2.0))
    assert values.shape == (2, len(V))
    assert np.imag(values[1]) / 1e-30 == pytest.approx(1.0 - V, abs=1e-15)


def test_inner_knots_appear_from_five_control_points_on():
    laws = [1.0, *(tuple(np.arange(count, dtype=float)) for count in range(2, 8))]
    assert [len(list(joints_of(law))) for law in laws] == [0, 0, 0, 0, 1, 2, 3]
    assert list(joints_of(laws[4])) == [(pytest.approx(0.5), 2)]


def test_a_chordwise_law_of_constants_is_a_law_along_the_chord():
    u = np.linspace(0.0, 1.0, 11)
    values = Span(V).chordwise((0.1, 0.3, 0.2), u)
    assert values.shape == (len(V), len(u))
    assert values[7] == pytest.approx(0.1 * (1 - u) ** 2 + 0.6 * u * (1 - u) + 0.2 * u**2, abs=1e-15)
