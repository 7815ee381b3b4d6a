"""Rotation, suction side and what does not fit together: by points, by machines whose sense is known, by mirroring."""

import numpy as np
import pytest

from bladewright.blade.design.row_design import TURNS
from bladewright.errors import DesignError
from bladewright.files.examples import examples
from machines import COARSE, built, example
from machines.coarse import CASCADE, RADIAL, ROTOR


def test_counterclockwise_seen_from_upstream_is_towards_larger_theta():
    # an observer upstream looks along +x; with z up, his right hand is forward x up
    forward, up = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    right = np.cross(forward, up)
    theta = 0.1
    point = np.array([0.0, np.sin(theta), np.cos(theta)])
    # a hand of a clock that stood at twelve has moved to the right where it moved clockwise
    clockwise = 1 if point @ right > 0.0 else -1
    assert TURNS["clockwise"] == clockwise
    assert TURNS["counterclockwise"] == -clockwise


SIDES = {
    "core-rotor": "lower",
    "mixed-flow-compressor": "lower",
    "mixed-flow-pump": "lower",
    "propeller": "lower",
    "pump-inducer": "lower",
    "centrifugal-impeller": "lower",
    "fan-rotor": "upper",
    "nasa-rotor-67": "upper",
    "radial-turbine": "upper",
    "aachen-stator": "upper",
    "compressor-stator": "upper",
    "vki-ls89": "upper",
    "wedge-diffuser": None,
}


@pytest.mark.parametrize("name", SIDES)
def test_the_examples_have_the_suction_side_of_their_machines_and_no_contradiction(name):
    blade = built(example(name).changed("tolerance", COARSE))
    assert blade.suction_side == SIDES[name]
    assert blade.flow_sense.warning is None


def test_every_example_in_space_says_how_it_turns():
    assert all(example(name).rotation in TURNS for name in examples() if example(name).dimension == 3)


def test_a_rotor_that_turns_with_its_relative_flow_is_warned_of_and_says_what_was_assumed():
    # the coarse rotor's flow comes towards +theta, so that it turns towards -theta
    good = built(ROTOR.changed("rotation", "clockwise"))
    wrong = built(ROTOR.changed("rotation", "counterclockwise"))
    assert good.flow_sense.warning is None
    assert "metal_angle_in is 49.5 deg at mid-span, along the rotation" in wrong.flow_sense.warning
    assert "rotation = 'clockwise'" in wrong.flow_sense.warning
    assert "taking the absolute flow for slower than the blades" in wrong.flow_sense.warning


def test_the_mirrored_blade_turns_the_other_way_and_has_the_other_suction_side():
    mirrored = CASCADE.changed(
        {
            "stagger": (35.0, 30.0),
            "metal_angle_in": (-20.0, -10.0),
            "metal_angle_out": 58.0,
            "leading_edge_y": (0.0, -2.0),
            "thickness_upper": CASCADE.thickness_lower,
            "thickness_lower": CASCADE.thickness_upper,
        }
    )
    assert (built(CASCADE).suction_side, built(mirrored).suction_side) == ("upper", "lower")
    for design, rotation in ((CASCADE, "counterclockwise"), (mirrored, "clockwise")):
        sense = built(design.changed("rotation", rotation)).flow_sense
        assert (sense.kind, sense.warning) == ("turbine", None)


def test_an_impeller_is_a_compressor_by_its_radii_and_turns_against_its_backsweep():
    sense = built(RADIAL.changed("rotation", "counterclockwise")).flow_sense
    assert (sense.kind, sense.suction_side) == ("compressor or pump", "lower")
    assert sense.sentence == (
        "seen from upstream the rotor turns counterclockwise, towards +theta; at mid-span the relative flow without "
        "incidence comes 49.5 deg towards -theta and is turned by 14.5 deg towards +theta; the lower side is the "
        "suction side, as of a compressor or pump"
    )


def test_rotation_changes_no_surface():
    one, other = built(ROTOR), built(ROTOR.changed("rotation", "clockwise"))
    assert np.array_equal(one.sides[0].control_points, other.sides[0].control_points)
    assert one.design.parameters() == other.design.parameters()


def test_another_rotation_is_refused():
    with pytest.raises(DesignError, match="rotation"):
        ROTOR.changed("rotation", "left")
