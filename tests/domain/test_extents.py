"""Extents, angles and pitches that cannot be, each refused with its limit and cure."""

import re
from dataclasses import replace

import numpy as np
import pytest

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.domain.build import passage
from bladewright.domain.checks import check_duct
from bladewright.domain.walls import CROSS_LINES
from bladewright.errors import DesignError


@pytest.mark.parametrize("name", ["upstream", "downstream"])
@pytest.mark.parametrize("value", [-0.5, 0.0, 1e-3, 21.0])
def test_an_extent_out_of_range_is_refused_with_its_limits(rotor, name, value):
    with pytest.raises(DesignError, match=rf"{name} is .*at least 0\.\d+.*at most 20"):
        passage(rotor.blade, **{name: value})


def test_the_least_extent_that_a_refusal_names_is_enough(rotor):
    with pytest.raises(DesignError) as refused:
        passage(rotor.blade, upstream=0.01, downstream=0.5, walls="patches")
    least = float(re.search(r"at least ([\d.]+)", str(refused.value))[1])
    made = passage(rotor.blade, upstream=least * 1.001, downstream=0.5, walls="patches")
    assert min(share for share, _, _ in made.folds.values()) > 0.0


@pytest.mark.parametrize(("value", "said"), [("far", "a number is needed"), (np.nan, "finite"), (True, "a number")])
def test_what_is_no_number_is_no_extent(rotor, value, said):
    with pytest.raises(DesignError, match=f"upstream.*{said}"):
        passage(rotor.blade, upstream=value)


def test_extents_that_contradict_held_knots_are_refused(rotor):
    with pytest.raises(DesignError, match=r"upstream is 2\.0, but the knots given hold 0\.5: leave one of them out"):
        passage(rotor.blade, upstream=2.0, knots=rotor.passage.knots)


@pytest.mark.parametrize("name", ["inlet_angle", "outlet_angle"])
def test_an_angle_against_the_flow_is_refused(rotor, name):
    with pytest.raises(DesignError, match=f"{name} is 95 deg: it must lie between -89 and 89"):
        passage(rotor.blade, **{name: 95.0})


def test_a_duct_whose_walls_cross_is_refused_with_the_extent_that_is_possible(fan):
    with pytest.raises(DesignError, match=r"upstream is 12 .*axis|upstream is 12 .*folds back") as refused:
        passage(fan.blade, upstream=12.0)
    most = float(re.search(r"at most ([\d.]+) is possible", str(refused.value))[1])
    assert 0.5 < most < 12.0
    check_duct(replace(fan.passage.duct, low=-0.95 * most), fan.blade.exact.meridional_extent)


def test_a_blade_outside_its_passage_is_refused_with_span_and_distance(cascade):
    """A pitch at which neighbours do not yet touch, but each stands in the other's half."""
    design = cascade.blade.design
    upper = design.thickness_upper
    stout = tuple(2.0 * value if 1 < i < len(upper) - 1 else value for i, value in enumerate(upper))
    blade = design.changed({"thickness_upper": stout, "pitch": 38.0}).build()
    with pytest.raises(DesignError, match=r"pitch is 38: at v = [\d.]+ the blade stands [\d.]+ mm outside its passage"):
        passage(blade, walls="patches")


def test_where_cross_lines_that_turn_back_early_fold_others_are_taken():
    """A stout vane with a blunt trailing edge; the usual way for cross-lines alone would refuse it."""
    vane = UnifiedBlade(
        name="vane",
        length_unit="mm",
        arrangement="linear",
        pitch=45.0,
        stagger=-40.0,
        metal_angle_in=0.0,
        metal_angle_out=-65.0,
        tangent_in=0.4,
        tangent_out=0.4,
        leading_edge_radius=0.05,
        trailing_edge_radius=0.02,
        thickness_upper=(0.09, 0.12, 0.07),
        thickness_lower=(0.05, 0.05, 0.05),
        channel=Channel(leading_edge=((0.0, 0.0), (0.0, 50.0)), trailing_edge=((40.0, 0.0), (40.0, 50.0))),
    )
    made = passage(vane.build())
    assert made.knots.cross_lines in CROSS_LINES[1:]
    assert min(share for share, _, _ in made.folds.values()) > 0.0
