"""The flow domain about a 2D section."""

import numpy as np
import pytest

from bladewright.domain.build import passage
from bladewright.domain.section import section_passage
from bladewright.errors import DesignError
from machines import built, example


@pytest.fixture(scope="module")
def section():
    return built(example("turbine-section"))


def test_the_area_is_pitch_times_extent_less_the_section(section):
    made = section_passage(section, 0.05, upstream=0.6, downstream=0.9, outlet_angle=-50.0)
    chord = section.camber.control_points[-1, 0] - section.camber.control_points[0, 0]
    assert made.area == pytest.approx(0.05 * 2.5 * chord - section.area, rel=1e-13)


def test_periodic_boundaries_are_the_camber_line_half_a_pitch_away(section):
    made = section_passage(section, 0.05)
    for name, sign in (("periodic_lower", -1.0), ("periodic_upper", 1.0)):
        curve = made.curves[name]
        assert curve.degree == 3
        on_camber = curve(np.linspace(1.0, 2.0, 21)) - np.array([0.0, sign * 0.025])
        np.testing.assert_allclose(on_camber, section.camber(np.linspace(0, 1, 21)), rtol=0, atol=1e-16)


def test_the_slope_is_kept_or_turned_to_the_stated_angle(section):
    made = section_passage(section, 0.05, inlet_angle=-10.0)
    curve = made.curves["periodic_upper"]
    angles = [np.degrees(np.arctan2(*curve.derivative(u)[::-1])) for u in (0.0, 1.0 - 1e-12, 2.0 + 1e-12, 3.0)]
    wanted = [-10.0, np.degrees(section.metal_angle_in), *[np.degrees(section.metal_angle_out)] * 2]
    np.testing.assert_allclose(angles, wanted, rtol=0, atol=1e-8)


def test_the_boundary_closes(section):
    curves = section_passage(section, 0.05).curves
    for name, at in (("inlet", 0), ("outlet", -1)):
        ends = curves[name].control_points
        np.testing.assert_array_equal(ends[0], curves["periodic_lower"].control_points[at])
        np.testing.assert_array_equal(ends[-1], curves["periodic_upper"].control_points[at])


def test_the_area_follows_the_pitch(section):
    made = section_passage(section, 0.05 + 1e-30j)
    chord = section.camber.control_points[-1, 0] - section.camber.control_points[0, 0]
    assert np.imag(made.area) / 1e-30 == pytest.approx(2.0 * chord, rel=1e-13)


def test_a_pitch_that_the_section_does_not_keep_within_is_refused(section):
    with pytest.raises(DesignError, match=r"pitch is 0\.002 m: the upper side .* stands 0\.\d+ m outside its passage"):
        section_passage(section, 0.002)


def test_a_section_has_no_passage_in_space(section):
    with pytest.raises(DesignError, match="a 2D section was given: use section_passage"):
        passage(section)


@pytest.mark.parametrize("asked", [{"upstream": -1.0}, {"downstream": 0.0}])
def test_an_extent_that_is_not_positive_is_refused(section, asked):
    with pytest.raises(DesignError, match="must be positive"):
        section_passage(section, 0.05, **asked)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"upstream": -1.0}, r"upstream is -1: it must be positive and below 20"),
        ({"downstream": 21.0}, r"downstream is 21: it must be positive and below 20"),
        ({"inlet_angle": 95.0}, r"inlet_angle is 95: it must lie between -89 and 89 deg"),
        ({"outlet_angle": -90.0}, r"outlet_angle is -90: it must lie between -89 and 89 deg"),
    ],
)
def test_extents_and_angles_out_of_bounds_are_refused(section, asked, said):
    with pytest.raises(DesignError, match=said):
        section_passage(section, 0.05, **asked)
