"""Smoothness of sections: exact derivatives, jumps by closed forms, and where the families are smooth and where not."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bladewright.section.chebyshev_pieces import ChebyshevPieces, inverse
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.smoothness import outline_smoothness, smoothness
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom
from bladewright.section.unified import UnifiedSection
from machines.sections import EXAMPLES

NACA = ModifiedNaca(
    leading_edge_index=5.0,
    maximum_thickness=0.1,
    maximum_thickness_at=0.42,
    trailing_edge_thickness=0.02,
    trailing_edge_slope=-0.12,
)
QUARTIC = QuarticSpline(
    maximum_thickness=0.08,
    maximum_thickness_at=0.3,
    leading_edge_thickness=0.03,
    trailing_edge_thickness=0.02,
    trailing_edge="sharp",
)
WENNERSTROM = Wennerstrom(
    maximum_thickness=0.08,
    maximum_thickness_at=0.45,
    leading_edge_thickness=0.015,
    trailing_edge="blunt",
    trailing_edge_thickness=0.012,
)
CAMBERED = CurvatureMeanline(
    metal_angle_in=45.0,
    metal_angle_out=10.0,
    curvature=(0.2, 0.6, 0.5, 0.2, 0.1),
    curvature_places=(0.15, 0.5, 0.8),
    thickness=NACA,
)
FLAT = replace(CAMBERED, metal_angle_in=0.0, metal_angle_out=0.0)
EXACT = {
    "curvature meanline": lambda: outline_of(CAMBERED),
    "camber angle": lambda: outline_of(EXAMPLES["camber-angle"].part()),
    "points": lambda: outline_of(EXAMPLES["points-blunt"].part()),
}


def outline_of(part):
    return part.outline(Span(np.zeros(1)))


def joints_at(line, place):
    return next(jump for jump in line.jumps if jump.at == pytest.approx(place, abs=0.02))


@pytest.mark.parametrize("name", list(EXACT))
def test_derivatives_in_closed_form_are_those_of_the_points(name):
    outline, s = EXACT[name](), np.linspace(0.003, 0.997, 31)
    for exact, series in zip(outline.derivatives(s, 3), Outline.derivatives(outline, s, 3), strict=True):
        off = np.abs(np.real(exact).reshape(series.shape) - series).max(axis=(0, 1))
        # a third derivative of a series of 25 terms keeps seven digits of the largest
        assert (off < [1e-14, 1e-10, 1e-8, 1e-6] * np.abs(series).max(axis=(0, 1))).all()


def test_camber_lines_by_their_abscissa_are_those_in_closed_form():
    outline, t = outline_of(CAMBERED), np.linspace(0.01, 0.99, 21)
    series = Outline.camber_derivatives(outline, t, 3)
    exact = outline.camber_derivatives(t, 3)[0]
    assert np.abs(exact - series).max() < 1e-6 * np.abs(exact).max()  # as above


def test_the_modified_naca_thickness_jumps_as_its_polynomials_say():
    half, at, end, slope = 0.05, 0.42, 0.01, -0.12
    steep = np.sqrt(1.0 + slope**2)
    rear = 1.0 - at - end / (steep - slope)
    second, third = np.linalg.solve([[rear**2, rear**3], [2.0 * rear, 3.0 * rear**2]], [end - half, slope])
    root = np.sqrt(2.0 * 1.1019 * (0.1 * 5.0 / 6.0) ** 2)
    powers = np.array([[at, at**2, at**3], [1.0, 2.0 * at, 3.0 * at**2], [0.0, 2.0, 6.0 * at]])
    right = [half - root * at**0.5, -0.5 * root * at**-0.5, 2.0 * second + 0.25 * root * at**-1.5]
    front = np.linalg.solve(powers, right)
    upper = outline_smoothness(outline_of(FLAT)).upper
    assert (upper.jumps[0].place, upper.jumps[-1].place) == ("leading_edge", "trailing_edge")
    # rounding of third derivatives
    thickest, circle = (jump for jump in upper.jumps[1:-1] if jump.continuous != (True, True))
    assert thickest.continuous == (True, False)
    assert thickest.curvature == pytest.approx((2.0 * second, 2.0 * second), rel=1e-9)
    assert thickest.slope == pytest.approx((6.0 * front[2] + 0.375 * root * at**-2.5, 6.0 * third), rel=1e-6)
    before = (2.0 * second + 6.0 * third * rear) / steep**3
    assert circle.continuous == (False, False)
    assert circle.curvature == pytest.approx((before, -1.0 / (end * steep)), rel=1e-9)
    assert circle.slope[1] == pytest.approx(0.0, abs=1e-6 / end**2)  # a circle's, against its curvature squared
    assert upper.curvature_jump == circle.of_curvature / np.abs(upper.curvature).max()


def test_a_curvature_meanline_is_smooth_whatever_the_thickness():
    for thickness in (NACA, QUARTIC, WENNERSTROM):
        camber = outline_smoothness(outline_of(replace(CAMBERED, thickness=thickness))).camber
        assert len(camber.jumps) == 3
        assert camber.continuous == (True, True)
        assert (camber.curvature_jump, camber.slope_jump) == (0.0, 0.0)


def test_a_quartic_thickness_on_it_keeps_curvature_and_slope_around_the_leading_edge():
    found = outline_smoothness(outline_of(replace(CAMBERED, thickness=QUARTIC)))
    assert [line.continuous for line in found.lines] == [(True, True)] * 3
    assert found.upper.jumps[0].place == "leading_edge"
    assert len(found.lower.jumps) > 5


def test_the_other_thickness_laws_are_not_as_smooth():
    naca, wennerstrom = (
        outline_smoothness(outline_of(replace(CAMBERED, thickness=law))) for law in (NACA, WENNERSTROM)
    )
    assert joints_at(naca.lower, 0.43).continuous == (True, False)
    assert naca.lower.continuous == (False, False)
    assert joints_at(wennerstrom.upper, 0.46).continuous == (True, False)
    assert wennerstrom.upper.curvature_jump > 0.01  # where the ellipse ends


def test_straight_ends_of_a_mixed_camber_line_are_found():
    camber = outline_smoothness(outline_of(EXAMPLES["mixed camber line"].part())).camber
    assert [jump.continuous for jump in camber.jumps] == [(False, False)] * 2
    assert camber.jumps[0].curvature[0] == 0.0


def test_arcs_have_constant_curvature():
    found = outline_smoothness(outline_of(EXAMPLES["double-circular-arc-sharp"].part()))
    for line in found.lines:
        assert np.ptp(line.curvature) < 1e-9 * np.abs(line.curvature).max()  # rounding of second derivatives
        assert line.continuous == (True, True)


def test_a_native_section_without_an_outline_is_measured_on_its_curves():
    design = UnifiedSection(
        name="vane",
        length_unit="mm",
        axial_chord=30.0,
        stagger=-40.0,
        metal_angle_in=0.0,
        metal_angle_out=-65.0,
        tangent_in=0.5,
        tangent_out=0.6,
        leading_edge_radius=0.05,
        trailing_edge_radius=0.02,
        thickness_upper=(0.14, 0.2, 0.12, 0.05),
        thickness_lower=(0.1, 0.1, 0.08, 0.03),
    )
    section = design.build()
    found = smoothness(section)
    for jump, radius in zip((found.upper.jumps[0], found.upper.jumps[-1]), section.edge_radii, strict=True):
        assert jump.continuous[0]
        assert jump.curvature[0] == pytest.approx(-section.chord / radius, rel=1e-6)  # that of the built radius
    # a quartic spline has three derivatives at its knots
    assert all(jump.continuous == (True, True) for jump in found.lower.jumps)


def test_a_section_of_a_family_is_measured_on_its_exact_outline():
    design = EXAMPLES["naca-2412"].design
    found, exact = smoothness(design.build()).to_dict(), outline_smoothness(outline_of(design.section)).to_dict()
    assert found == exact
    assert json.loads(json.dumps(found)) == found
    assert found["camber"]["curvature_continuous"] is False


def test_pieces_differentiate_across_steep_functions():
    t = np.linspace(-0.9, 0.9, 7)
    found = ChebyshevPieces(
        lambda x: np.stack([np.exp(3.0 * x), 1.0 / (0.02 + x * x)], axis=-1), [-1.0, 1.0]
    ).derivatives(t, 1)
    assert found[:, 0, 1] == pytest.approx(3.0 * np.exp(3.0 * t), rel=1e-10)
    assert found[:, 1, 1] == pytest.approx(-2.0 * t / (0.02 + t * t) ** 2, rel=1e-9, abs=1e-7)


def test_an_inverse_keeps_its_digits_where_the_function_has_no_slope():
    place = inverse(lambda s: np.sin(0.5 * np.pi * s) ** 2, np.array([0.0, 1.0]))
    x = np.array([1e-8, 1e-3, 0.4, 0.7, 1.0 - 1e-6])
    assert np.sin(0.5 * np.pi * place(x)) ** 2 == pytest.approx(x, rel=1e-12)
