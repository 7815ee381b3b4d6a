"""Which parameters a fit may change."""

import pytest

import bladewright as bw
from bladewright.fitting.free_parameters import free_parameters_of
from machines import example

DESIGN = example("turbine-section")
CLEARANCE = {"tip_clearance": None, "hub_clearance": 0.5}


def test_all_is_free_but_what_a_cloud_of_one_blade_says_nothing_of():
    found = free_parameters_of(None, None, started=False)(DESIGN)
    assert set(DESIGN.parameters()) - set(found) == {"pitch", "span"} & set(DESIGN.parameters())
    assert "pitch" not in found


def test_patterns_choose_what_is_free_and_what_is_held():
    assert free_parameters_of("thickness_upper[*]", "*[0]", started=True)(DESIGN) == tuple(
        f"thickness_upper[{i}]" for i in range(1, len(DESIGN.thickness_upper))
    )
    assert free_parameters_of(["stagger", "*chord"], None, started=True)(DESIGN) == ("axial_chord", "stagger")


def test_a_pattern_of_others_too_frees_nothing_that_no_point_shows():
    found = free_parameters_of("*", None, started=True)(DESIGN)
    assert "stagger" in found
    assert "pitch" not in found


@pytest.mark.parametrize("free", ["pitch", ["stagger", "pitch"], "pitc*"])
def test_what_no_point_shows_is_not_freed_by_its_name(free):
    with pytest.raises(bw.FitError, match=r"free names pitc.*, which the points of one blade do not show"):
        free_parameters_of(free, None, started=True)(DESIGN)
    with pytest.raises(bw.FitError, match="free names hub_clearance"):
        free_parameters_of("hub_clearance", None, started=True)(example("fan-rotor").changed(CLEARANCE))


def test_values_are_given_to_what_is_held():
    freedom = free_parameters_of(None, {"metal_angle_*": 12.0, "stagger": -3}, started=False)
    design = freedom.applied(DESIGN)
    assert (design.metal_angle_in, design.metal_angle_out, design.stagger) == (12.0, 12.0, -3.0)
    assert not {"metal_angle_in", "metal_angle_out", "stagger"} & set(freedom(DESIGN))
    assert free_parameters_of(None, None, started=True).applied(DESIGN) is DESIGN


@pytest.mark.parametrize(
    ("free", "fixed", "started", "words"),
    [
        (None, "stagger", False, "stagger is to be held"),
        ("stagger", None, False, "what is not free is to be held"),
        ("staggr", None, True, "'stagger'"),
        (None, "staggr", True, "'stagger'"),
        ("stagger", "stag*", True, "no parameter is left"),
        (None, {"colour": 1.0}, True, "colour"),
    ],
)
def test_freedoms_that_make_no_sense_are_refused(free, fixed, started, words):
    with pytest.raises(bw.FitError, match=words.replace("*", r"\*")):
        free_parameters_of(free, fixed, started=started)(DESIGN)


def test_a_value_that_no_design_can_have_is_refused():
    with pytest.raises(bw.FitError, match="stagger"):
        free_parameters_of(None, {"stagger": 120.0}, started=False).applied(DESIGN)
    with pytest.raises(bw.FitError, match="colour"):
        free_parameters_of(None, {"colour": 1.0}, started=False).applied(DESIGN)
