"""Broken input is taken, or refused in one paragraph that names its file; `design/bad_input.py` breaks all there is."""

import tomllib
import warnings

import bad_input
import numpy as np
import pytest

from bladewright.errors import DesignError, FileError
from bladewright.files.examples import example_text
from bladewright.files.parablade import import_parablade
from bladewright.files.reading import design_from
from bladewright.files.tblade3 import import_tblade3
from machines import example

from .tblade3.inputs import SPANWISE, lines

ONE_OF_A_FAMILY = (
    *("nasa-rotor-67", "core-rotor", "booster-stator", "pump-inducer", "inlet-guide-vane"),
    *("exhaust-strut", "vaned-diffuser", "turbine-section", "vki-ls89"),
)
CASE = {"3dbgbinput.7.dat": "\n".join(lines().values()) + "\n", "spancontrolinputs.7.dat": SPANWISE}


def drawn(of, count, seed=0):
    """So many of broken inputs, the same ones every time."""
    of = list(of)
    return [of[i] for i in np.random.default_rng(seed).choice(len(of), count, replace=False)]


def wrong(of):
    found = [(broken, bad_input.outcome_of(broken)) for broken in of]
    return [(broken.of, broken.change, *vars(each).values()) for broken, each in found if each.kind not in FINE]


FINE = bad_input.FINE


@pytest.mark.parametrize("name", ONE_OF_A_FAMILY)
def test_a_design_file_with_a_wrong_key_is_read_or_refused_in_one_paragraph(name):
    assert wrong(drawn(bad_input.broken_designs(name, example_text(name), build=False), 60)) == []


@pytest.mark.parametrize("name", ["core-rotor", "booster-stator", "turbine-section"])
def test_a_part_of_a_design_that_is_no_table_is_refused_in_one_paragraph(name):
    of = bad_input.broken_designs(name, example_text(name), build=False)
    parts = [broken for broken in of if broken.change.startswith(("flow_path", "leading_edge", "section", "thickness"))]
    assert len(parts) > 30
    assert wrong(parts[::5]) == []


def test_a_design_file_with_a_wrong_key_is_built_or_refused_in_one_paragraph():
    for name in ("booster-stator", "turbine-section"):
        assert wrong(drawn(bad_input.broken_designs(name, example_text(name)), 4)) == []


def test_parts_with_a_wrong_key_are_read_or_refused_in_one_paragraph():
    assert wrong(drawn(bad_input.broken_parts(build=False), 100)) == []


def test_a_broken_case_of_tblade3_is_imported_or_refused_in_one_paragraph(tmp_path):
    run = bad_input.imported(tmp_path, "3dbgbinput.7.dat", import_tblade3, build=False)
    assert wrong(drawn(bad_input.broken_files(CASE, str(tmp_path), run), 25)) == []


def test_a_broken_configuration_of_parablade_is_imported_or_refused_in_one_paragraph(tmp_path):
    from .test_parablade import SECTION

    run = bad_input.imported(tmp_path, "blade.cfg", import_parablade, build=False)
    assert wrong(drawn(bad_input.broken_files({"blade.cfg": SECTION}, "blade.cfg", run), 10)) == []


def test_every_key_every_line_and_every_kind_of_change_is_among_the_broken_ones():
    of = list(bad_input.broken_designs("core-rotor", example_text("core-rotor"), build=False))
    changes = {broken.change for broken in of}
    assert {"without section.thickness.law", "blade_count = -1", "flow_path.hub.points.0.1 = nan"} <= changes
    files = list(bad_input.broken_files({"a": "one 1 2\n\nthree\n"}, "a", lambda files: files))
    # three changes for each of three lines, and as many words for the first and the last number of one
    assert len(files) == 3 * 3 + 2 * len(bad_input.WORDS)
    texts = {broken.tried()["a"] for broken in files}
    assert {"\n", "one 1 2\n\n", "one nan 2\n\nthree\n", "\nthree\n"} <= texts


def refusing(message):
    def run():
        raise FileError(message)

    return run


def warning():
    warnings.warn("something overflows", RuntimeWarning, stacklevel=1)


def endless():
    while True:
        pass


@pytest.mark.parametrize(
    ("tried", "kind"),
    [
        (dict, "taken"),
        (refusing("'a.dat' is cut short"), "refused"),
        (refusing("something is cut short"), "unclear"),
        (refusing("'a.dat' is cut short\nhere"), "unclear"),
        (refusing("'a.dat'" + 1500 * "!"), "unclear"),
        ({}.popitem, "crashed"),
        (warning, "crashed"),
        (endless, "slow"),
    ],
)
def test_what_becomes_of_broken_input_is_told_apart(tried, kind):
    assert bad_input.outcome_of(bad_input.Broken("a.dat", "", tried), limit=0.2).kind == kind


def test_laws_that_ask_for_too_many_poles_are_refused_for_their_number(monkeypatch):
    monkeypatch.setattr("bladewright.blade.native.blade.MOST_POLES", (200, 5))
    design = example("exhaust-strut")
    with pytest.raises(DesignError, match="give the laws along the span fewer control points"):
        design.build()


@pytest.mark.parametrize(
    ("put", "said"),
    [
        ({"stacking": {"sweep": 5.0}}, "stacking.sweep does not exist: in this family it is sweep"),
        ({"leading_edge": 7.0}, "leading_edge is 7.0: a table of points, spacing, ends or a table of"),
        ({"section": 7.0}, "section is 7.0: a table of "),
    ],
)
def test_what_stands_in_the_place_of_a_part_is_said_with_what_belongs_there(put, said):
    with pytest.raises(DesignError) as caught:
        design_from(tomllib.loads(example_text("core-rotor")) | put, "rotor.toml")
    assert str(caught.value).startswith(f"rotor.toml: {said}")
