"""What a study file says, and what is refused in it."""

from pathlib import Path

import pytest

from bladewright.errors import BladewrightError
from bladewright.files.examples import example_text
from bladewright.studies.study import read_study
from bladewright.studies.variables import changed_designs


def test_a_study_file_is_read(study_file: Path) -> None:
    study = read_study(study_file)
    [design] = study.designs.values()
    stagger, thickness = study.variables
    assert (study.name, design.name) == ("vane-study", "turbine-section")
    # what is relative to one parameter is given as its values, what sets several keeps its factor
    assert (stagger.lower, stagger.upper, stagger.start) == (-33.0, -29.0, -31.0)
    assert (thickness.lower, thickness.upper, thickness.start, len(thickness.targets)) == (0.9, 1.1, 1.0, 5)
    assert study.sweep.quantities == ("area", "chord", "turning")


def test_a_value_of_a_variable_changes_its_parameters_alone(study_file: Path) -> None:
    study = read_study(study_file)
    before = study.designs["turbine-section"].parameters()
    changed = changed_designs(study.designs, study.variables, {"stagger": -30.0, "thickness_upper*": 1.1})
    after = changed["turbine-section"].parameters()
    expected = {
        path: -30.0 if path == "stagger" else value * (1.1 if path.startswith("thickness_upper") else 1.0)
        for path, value in before.items()
    }
    assert after == expected


def test_the_values_at_the_start_change_nothing(study_file: Path) -> None:
    study = read_study(study_file)
    variables = study.variables
    assert changed_designs(study.designs, variables, {each.name: each.start for each in variables}) == study.designs


@pytest.fixture
def two_designs(tmp_path: Path) -> Path:
    for name in ("fan-rotor", "compressor-stator"):
        (tmp_path / f"{name}.toml").write_text(example_text(name))
    path = tmp_path / "stage.toml"
    path.write_text('[designs]\nrotor = "fan-rotor.toml"\nstator = "compressor-stator.toml"\n[variables]\n')
    return path


def test_a_path_is_of_every_design_that_has_it_and_with_a_name_of_one(two_designs: Path) -> None:
    with two_designs.open("a") as file:
        file.write(
            '"rotor:stagger[0]" = { lower = 10, upper = 14 }\n"rotor:blade_count" = { lower = 20, upper = 22 }\n'
        )
        file.write("tip_clearance = { values = [0.1, 0.2] }\n")
    study = read_study(two_designs)
    stagger, count, clearance = study.variables
    assert stagger.targets == (("rotor", "stagger[0]"),)
    assert [count.at(fraction) for fraction in (0.0, 0.3, 0.4, 0.99, 1.0)] == [20, 20, 21, 22, 22]
    assert {design for design, _ in clearance.targets} == {"rotor", "stator"}
    assert [each.name for each in study.quantities("volume")] == ["rotor:volume", "stator:volume"]
    assert [each.name for each in study.quantities("stator:solidity@0.2")] == ["stator:solidity@0.2"]


VARIABLES = {
    "stager = { lower = 0, upper = 1 }": "did you mean 'stagger'",
    "stagger = { lower = 3, upper = 1 }": "change them round",
    "stagger = { lower = 3 }": "no upper",
    "stagger = { lower = 1, upper = inf }": "give finite bounds",
    'stagger = { lower = "a", upper = 1 }': 'variables.stagger.lower is "a"',
    "stagger = { lower = 1, upper = 2, values = [1] }": "both bounds and values",
    "stagger = { lowr = 1, upper = 2 }": "did you mean 'lower'",
    "thickness_upper = { lower = 1, upper = 2 }": r"thickness_upper\[\*\]",
    "name = { lower = 1, upper = 2, relative = true }": "no number",
    'stagger = {lower=1,upper=2}\n"stag*" = {lower=1,upper=2}': "both set",
    '"rotor:stagger" = { lower = 1, upper = 2 }': "no design 'rotor'",
    "": "varies nothing",
}
FILES = {
    "[swep]": "did you mean 'sweep'",
    '[sweep]\nsampling = "sobl"': "sweep.sampling",
    "[sweep]\nsamples = 0": "greater than or equal to 1",
    '[designs]\na = "turbine-section.toml"': "leave one out",
}
WHOLE = {
    'design = "no.toml"': "there is no file",
    'design = "vki-ls89.toml"': "bladewright new vki-ls89",
    "": "design is missing",
    "design =": "not valid TOML",
}
DESIGN = 'design = "turbine-section.toml"\n'
BAD = {f"{DESIGN}[variables]\n{text}": words for text, words in VARIABLES.items()}
BAD |= {DESIGN + text: words for text, words in FILES.items()} | WHOLE


@pytest.mark.parametrize("text", BAD)
def test_a_wrong_study_file_is_refused_with_its_cure(text: str, study_file: Path) -> None:
    study_file.write_text(text)
    with pytest.raises(BladewrightError, match=BAD[text]):
        _ = read_study(study_file).variables


def test_an_unknown_quantity_is_refused_with_the_nearest(study_file: Path) -> None:
    study = read_study(study_file)
    (study_file.parent / "figures.py").write_text("def bending(section): return 1.0\n")
    (study_file.parent / "broken.py").write_text("1 / 0\n")
    bad = {
        "aera": "did you mean 'area'",
        "area@0.5": "of the whole blade",
        "turning@2": "fraction from 0 to 1",
        "nothere:bending": "no module 'nothere'",
        "figures:bendin": "did you mean 'bending'",
        "broken:bending": "ZeroDivisionError",
        7: "give a name",
    }
    for asked, words in bad.items():
        with pytest.raises(BladewrightError, match=words):
            study.quantities(asked)
