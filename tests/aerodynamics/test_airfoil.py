"""Sections of any family become airfoils in chords, level, with what a solver can take at the trailing edge."""

from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright.aerodynamics.airfoil import airfoil_of, exact_airfoil
from bladewright.errors import PolarError
from machines import built
from machines.sections import EXAMPLES
from machines.unified import VANE

DESIGNS = {
    "unified": VANE,
    **{
        name: EXAMPLES[name].design
        for name in (
            "oval",
            "suction and pressure side of a stator",
            "curvature meanline that bends back, blunt behind",
            "curvature meanline without camber, sharp behind",
            "segmented-morphed",
            "naca-2412",
        )
    },
}


@pytest.mark.parametrize("name", DESIGNS)
def test_the_airfoil_of_a_section_is_its_outline_in_chords(name):
    section = built(DESIGNS[name])
    airfoil = airfoil_of(section)
    x, y = airfoil.points.T
    area = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2.0
    assert area * airfoil.chord**2 == pytest.approx(float(section.area), rel=0.01)
    start, end = airfoil.points[[0, -1]]
    assert start[1] >= end[1] - 1e-12
    assert np.hypot(*(airfoil.points[len(x) // 2] - airfoil.nose)) < 1e-3


@pytest.mark.parametrize("name", [name for name in DESIGNS if name != "unified"])
def test_the_exact_outline_alone_gives_the_same_airfoil(name):
    design = DESIGNS[name]
    exact, own = exact_airfoil(design, design.exact()), airfoil_of(built(design))
    assert np.array_equal(exact.points, own.points)
    assert exact.chord == pytest.approx(own.chord, rel=1e-9)
    assert (exact.nose, exact.cuts, exact.remarks) == (own.nose, own.cuts, own.remarks)


def test_a_morphed_airfoil_is_by_the_chord_and_along_the_line_of_the_airfoil_that_is_not():
    design = DESIGNS["segmented-morphed"]
    morphed, plain = (airfoil_of(built(each)) for each in (design, design.changed("section.morph.trailing_edge", 0.0)))
    assert morphed.chord == pytest.approx(plain.chord, rel=1e-9) == pytest.approx(0.245, rel=1e-9)
    assert morphed.points[0, 1] < plain.points[0, 1] - 0.05
    assert morphed.cuts == pytest.approx((0.3, 0.7), abs=1e-12)


def test_a_round_trailing_edge_is_cut_off_square_to_the_camber_line():
    section = built(DESIGNS["oval"])
    airfoil = airfoil_of(section)
    radius = section.edge_radii[1] / float(section.chord)
    upper, lower = airfoil.points[0], airfoil.points[-1]
    along = np.angle([1.0, 1.0j] @ section.camber.derivative(np.array([1.0]))[0]) - section.stagger
    across = np.angle([1.0, 1.0j] @ (upper - lower))
    assert across - along == pytest.approx(np.pi / 2.0, abs=0.02)
    assert np.hypot(*((upper + lower) / 2.0 - [1.0, 0.0])) == pytest.approx(radius, rel=0.02)
    assert "cut off" in airfoil.remarks[-1]


def test_the_section_of_a_cascade_says_so():
    assert any("section of a cascade at a solidity of" in each for each in airfoil_of(built(VANE)).remarks)
    assert airfoil_of(replace(DESIGNS["naca-2412"], pitch=None).build()).remarks == ()


def test_points_in_the_other_order_are_turned_round():
    points = airfoil_of(built(DESIGNS["naca-2412"])).points
    np.testing.assert_array_equal(bw.Airfoil(points=points[::-1]).points, points)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"points": np.zeros((30, 3))}, r"shape \(30, 3\): give \(n, 2\)"),
        ({"points": np.full((30, 2), np.nan)}, "finite coordinates"),
        ({"points": np.zeros((5, 2))}, "at least 20"),
        ({"points": np.zeros((30, 2)), "chord": 0.0}, "chord is 0 m"),
    ],
)
def test_points_that_are_no_airfoil_are_refused(fields, message):
    with pytest.raises(PolarError, match=message):
        bw.Airfoil(**fields)
