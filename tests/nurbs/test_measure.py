import numpy as np
import pytest

from bladewright.errors import GeometryError
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import split
from bladewright.nurbs.measure import arc_length, area, parameters_at_length, surface_integral
from bladewright.nurbs.revolution import arc, circle, revolved, segment
from bladewright.nurbs.skinning import ruled
from bladewright.nurbs.transform import scaled

PARABOLA = Curve(control_points=[[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]], knots=[0, 0, 0, 1, 1, 1], degree=2)
HALF = arc((0.0, 0.0, 0.0), 2.0, 0.0, np.pi, axes=((-1, 0, 0), (0, 1, 0)))
# quadrature stops at a change of 1e-13
SETTLED = {"rtol": 1e-12}


def test_a_circle_is_two_pi_radii_long():
    assert np.isclose(arc_length(circle((1.0, 2.0), 3.0)), 6.0 * np.pi, **SETTLED)


def test_a_parabola_has_the_length_of_the_closed_form():
    assert np.isclose(arc_length(PARABOLA), np.sqrt(5.0) / 2.0 + np.arcsinh(2.0) / 4.0, **SETTLED)


def test_lengths_of_pieces_add_up(real_curve):
    a, b = real_curve.domain
    middle = a + 0.37 * (b - a)
    whole = arc_length(real_curve)
    assert np.isclose(arc_length(real_curve, a, middle) + arc_length(real_curve, middle, b), whole, **SETTLED)
    assert np.isclose(sum(arc_length(part) for part in split(real_curve, middle)), whole, **SETTLED)
    assert np.isclose(arc_length(real_curve, b, a), -whole, **SETTLED)


def test_parameters_at_length_cut_off_what_they_say():
    for shape in (PARABOLA, circle((0.0, 0.0), 1.0)):
        u = parameters_at_length(shape, [0.0, 0.1, 0.5, 0.83, 1.0])
        cut = [arc_length(shape, 0.0, x) for x in u]
        assert np.allclose(cut, np.array([0.0, 0.1, 0.5, 0.83, 1.0]) * arc_length(shape), rtol=1e-11, atol=1e-14)


def test_parameters_at_length_carry_an_imaginary_step():
    def bent(height):
        return Curve(control_points=[[0.0, 0.0], [0.5, 0.0], [1.0, height]], knots=[0, 0, 0, 1, 1, 1], degree=2)

    stepped = parameters_at_length(bent(1.0 + 1e-30j), [0.3, 0.8])
    up, down = (parameters_at_length(bent(1.0 + h), [0.3, 0.8]) for h in (1e-5, -1e-5))
    # a central difference at 1e-5 is good to about 1e-9
    assert np.allclose(stepped.imag / 1e-30, (up - down) / 2e-5, rtol=0.0, atol=1e-8)


def test_length_carries_an_imaginary_step():
    stepped = scaled(PARABOLA, 1.0 + 1e-30j, (0.0, 0.0))
    assert np.isclose(arc_length(stepped).imag / 1e-30, arc_length(PARABOLA), **SETTLED)


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        (revolved(HALF), 16.0 * np.pi),
        (revolved(circle((0.0, 3.0, 0.0), 1.0, axes=((1, 0, 0), (0, 1, 0)))), 12.0 * np.pi**2),
        (revolved(segment((0.0, 2.0, 0.0), (5.0, 2.0, 0.0))), 20.0 * np.pi),
        (revolved(segment((0.0, 0.0, 0.0), (4.0, 3.0, 0.0))), 15.0 * np.pi),
        (ruled(circle((0, 0, 0), 2.0, axes=((1, 0, 0), (0, 1, 0))), segment((0, 0, 0), (1e-9, 0, 0))), 4.0 * np.pi),
    ],
    ids=["sphere", "torus", "cylinder", "cone", "disc"],
)
def test_areas_are_those_of_the_closed_forms(shape, expected):
    # the disc's hub is a segment of 1e-9
    assert np.isclose(area(shape), expected, rtol=1e-12 if expected != 4.0 * np.pi else 1e-8)


def test_area_carries_an_imaginary_step():
    sphere = scaled(revolved(HALF), 1.0 + 1e-30j, (0.0, 0.0, 0.0))
    assert np.isclose(area(sphere).imag / 1e-30, 2.0 * 16.0 * np.pi, **SETTLED)


def test_a_polynomial_density_is_integrated_exactly_by_enough_points(real_surface):
    (a, b), (c, d) = real_surface.domain_u, real_surface.domain_v
    assert np.isclose(
        surface_integral(real_surface, lambda p, *_: np.ones(p.shape[:-1]), 1), (b - a) * (d - c), rtol=1e-14
    )


def test_fractions_of_a_length_outside_the_curve_are_refused():
    with pytest.raises(GeometryError, match=r"\[0, 1\]"):
        parameters_at_length(PARABOLA, 1.1)
