"""Extrema of curvature: as many as a law of curvature has, at any size and any number of samples."""

from types import MappingProxyType

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from bladewright.blade.native.extrema import extrema_of
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.transform import translated
from bladewright.section.curvature_extrema import curvature_extrema, turning_places, turning_points
from bladewright.section.section import Section
from bladewright.section.unified_sides import camber_curve
from machines import built, example

ARC = np.linspace(0.0, 1.0, 801)
WIDTH = 0.03
"""of the curvature's peaks at the edges"""


def law(waves, height, level):
    """Curvature along the arc: a peak at each edge that turns by 70 deg, a level, and waves between."""
    peak = np.radians(70.0) / (WIDTH * np.sqrt(np.pi) / 2.0)
    noses = np.exp(-((ARC / WIDTH) ** 2)) + np.exp(-(((1.0 - ARC) / WIDTH) ** 2))
    return peak * noses + level - height * np.cos(2.0 * np.pi * waves * ARC) * (1.0 - np.exp(-((ARC / 0.1) ** 4)))


def section_of(curvature, size=1.0):
    """A section whose upper side has the given convex curvature along the arc, and the lower one its mirror image."""
    angle = np.pi / 2.0 - make_interp_spline(ARC, curvature, k=5).antiderivative()(ARC)
    along, across = (make_interp_spline(ARC, part(angle), k=5).antiderivative()(ARC) for part in (np.cos, np.sin))
    spline = make_interp_spline(ARC, size * np.stack([along, across], axis=-1), k=5)
    sides = {
        name: Curve(control_points=spline.c * [1.0, sign], knots=spline.t, degree=5)
        for name, sign in (("upper", 1.0), ("lower", -1.0))
    }
    end = spline(1.0)
    return Section(
        span=0.0,
        plane="x-y",
        curves=MappingProxyType(sides),
        camber=camber_curve(np.linspace(0.0, 1.0, 4)[:, None] * end),
        stagger=0.0,
        metal_angle_in=0.0,
        metal_angle_out=0.0,
        scale=np.ones_like,
    )


def turns_of(curvature):
    """Extrema of the law between the edges, by the signs of its differences."""
    steps = np.sign(np.diff(curvature))
    return int(np.count_nonzero(steps[1:] * steps[:-1] < 0.0))


LAWS = {
    "valley": law(0.0, 0.0, 0.8),
    "hump": law(1.0, 0.6, 0.8),
    "waves": law(4.0, 0.5, 0.8),
    "ripples": law(9.0, 0.3, -0.5),
}


@pytest.mark.parametrize("name", list(LAWS))
def test_a_side_has_as_many_extrema_as_its_law_of_curvature(name):
    expected = max(turns_of(LAWS[name]), 1)
    assert extrema_of(section_of(LAWS[name])) == {"upper": expected, "lower": expected}


def test_extrema_stand_where_the_law_has_them():
    curvature = LAWS["waves"]
    steps = np.diff(curvature)
    expected = ARC[1:-1][steps[1:] * steps[:-1] < 0.0]
    # the law is sampled 800 times; the parameter is the arc
    assert turning_places(section_of(curvature), "upper") == pytest.approx(expected, abs=2.0 / 800)


@pytest.mark.parametrize("size", [1e-3, 1.0, 50.0])
def test_size_and_samples_change_no_count(size):
    section = section_of(LAWS["ripples"], size)
    counts = {curvature_extrema(section, "upper", per_span=samples) for samples in (1, 2, 16)}
    assert counts == {turns_of(LAWS["ripples"])}


def test_waves_below_the_prominence_are_smooth():
    assert extrema_of(section_of(law(4.0, 0.015, 0.8))) == {"upper": 1, "lower": 1}


def test_a_straight_side_does_not_wave_by_rounding():
    section = section_of(law(0.0, 0.0, 0.0), 1e-3)
    shifted = {name: translated(curve, np.array([1.0, 1.0])) for name, curve in section.curves.items()}
    moved = Section(**{**vars(section), "curves": shifted})
    assert extrema_of(moved) == {"upper": 1, "lower": 1}


def test_turning_points_are_those_that_stand_out():
    height = np.array([5.0, 1.0, 1.04, 0.9, 3.0, 2.97, 3.1, 0.0, 4.0])
    assert turning_points(height, 0.1) == [3, 6, 7]
    assert turning_points(height, 0.01) == [1, 2, 3, 4, 5, 6, 7]
    assert turning_points(height, 10.0) == []


def test_a_blade_has_the_most_of_its_sections_an_odd_number():
    blade = built(example("radial-turbine"))
    spans = (0.0, 0.6, 1.0)
    each = [extrema_of(blade.section(v)) for v in spans]
    assert all(count % 2 == 1 for counts in each for count in counts.values())
    assert extrema_of(blade, spans) == {name: max(counts[name] for counts in each) for name in ("upper", "lower")}


@pytest.mark.parametrize("name", ["upper", "lower"])
def test_four_hundred_and_four_thousand_samples_of_a_design_count_the_same(name):
    section = built(example("turbine-section"))
    assert curvature_extrema(section, name, per_span=20) == curvature_extrema(section, name, per_span=200)
