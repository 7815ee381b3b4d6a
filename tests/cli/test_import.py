"""`bladewright import`: another program's design is written as a design file, with what changed and how far it lies."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest

import bladewright as bw

_SPEC = spec_from_file_location("tblade3_inputs", Path(__file__).parents[1] / "files" / "tblade3" / "inputs.py")
inputs = module_from_spec(_SPEC)
_SPEC.loader.exec_module(inputs)

CONFIGURATION = """\
NDIM = 2
CASCADE_TYPE = LINEAR
PARAMETRIZATION_TYPE = CAMBER_THICKNESS
N_BLADES = 50
x_leading = 0.0
y_leading = 0.0
z_leading = 1.0, 1.1
x_trailing = 0.05
z_trailing = 1.0, 1.1
x_hub =
z_hub =
x_shroud =
z_shroud =
stagger = -30
theta_in = 20
theta_out = -55
radius_in = 0.02
radius_out = 0.008
dist_in = 0.4
dist_out = 0.5
""" + "".join(f"thickness_{side}_{i} = 0.05\n" for side in ("upper", "lower") for i in range(1, 7))


@pytest.fixture
def configuration(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "vane.cfg"
    path.write_text(CONFIGURATION)
    return path


def test_a_design_is_written_and_its_distance_said(run, configuration):
    found = run("import", configuration)
    assert found.status == 0, found.err
    design = bw.read_design("vane.toml")
    assert design.name == "vane"
    assert design.stagger == pytest.approx(-30, abs=0.5)
    for part in ("kept: the camber line", "changed: ", "mm in the mean", "wrote vane.toml"):
        assert part in found.out


def test_the_json_has_what_people_are_told(run, configuration, tmp_path):
    found = run("import", configuration, "-o", tmp_path / "other.toml", "--chordwise", 8, "--json").json
    assert found["program"] == "ParaBlade"
    assert found["design"].endswith("other.toml")
    assert found["parameters"] == 26
    assert found["deviation"]["maximum_m"] < 3e-3 * found["deviation"]["chord_m"]
    assert found["kept"]
    assert found["changed"]


def test_a_design_file_that_is_there_keeps_its_comments(run, configuration):
    assert run("import", configuration).status == 0
    path = configuration.with_suffix(".toml")
    path.write_text("# our vane\n" + path.read_text().replace("stagger = ", "stagger = 1.0 # was "))
    before = path.read_text()
    refused = run("import", configuration)
    assert refused.status == 2
    assert "exists already" in refused.err
    assert path.read_text() == before
    assert run("import", configuration, "--force").status == 0
    text = path.read_text()
    assert text.startswith("# our vane")
    assert bw.read_design(path).stagger == pytest.approx(-30, abs=0.5)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("1 2 3\n4 5 6\n", "is of no format that can be imported: known are ParaBlade's .cfg"),
        ('family = "unified"\n', "is of no format that can be imported"),
        (CONFIGURATION.replace("stagger = -30\n", ""), "stagger is missing"),
        (CONFIGURATION.replace("CAMBER_THICKNESS", "CONNECTING_ARCS"), "wedge_in is missing"),
        (None, "there is no file"),
    ],
)
def test_what_cannot_be_imported_is_refused_and_leaves_nothing(content, message, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "vane.cfg"
    if content is not None:
        path.write_text(content)
    before = sorted(tmp_path.iterdir())
    found = run("import", path)
    assert found.status == 2
    assert message in found.err
    assert sorted(tmp_path.iterdir()) == before


@pytest.fixture
def windmill(tmp_path, monkeypatch):
    """The path of a T-Blade3 case in a folder of its own, which is the current one."""
    monkeypatch.chdir(tmp_path)
    return inputs.written(tmp_path).relative_to(tmp_path)


def test_a_case_of_tblade3_becomes_a_design_and_that_a_verified_solid(run, windmill):
    found = run("import", windmill)
    assert found.status == 0, found.err
    for part in ("kept: all 3 sections", "changed: ", "note: ", "by its formulas", "wrote windmill-7.toml"):
        assert part in found.out
    assert bw.read_design("windmill-7.toml").plane == "counted-m'-theta"
    built = run("build", "windmill-7.toml", "--as", "step", "--set", "tolerance=1e-3", "--json").json
    assert built["passed"], built
    assert Path("windmill-7.step").stat().st_size < 600e3


def test_points_that_tblade3_has_written_beside_its_input_are_measured(run, windmill):
    from bladewright.files.tblade3 import read_tblade3
    from bladewright.files.tblade3.importing import section_points
    from bladewright.files.tblade3.translation import case_sections

    sections = case_sections(read_tblade3(windmill))
    places = np.linspace(0.0, 1.0, 121)
    rows = ["  241  3"]
    for i in range(3):
        upper, lower = (side / 1e-3 for side in section_points(sections, i, places))
        rows += [" ".join(f"{value:.16e}" for value in point) for point in [*upper[::-1], *lower[1:]]]
    Path("blade3d.windmill.dat").write_text("\n".join(rows) + "\n")
    deviation = run("import", windmill, "--json").json["deviation"]
    assert deviation["source"] == "blade3d.windmill.dat"
    assert deviation["maximum_m"] < 1e-6 * deviation["chord_m"]


@pytest.mark.parametrize(
    ("name", "spoilt", "message"),
    [
        ("3dbgbinput.7.dat", lambda text: text[:400], "the file is cut short"),
        ("3dbgbinput.7.dat", lambda text: text.replace("  250.0", "  large"), "line 8: the scaling factor"),
        ("3dbgbinput.7.dat", lambda text: text.replace("sect1", "s809m", 1), "sections 1 are of the type 's809m'"),
        ("spancontrolinputs.7.dat", lambda text: text, "holds control points only: name the main input file"),
        ("spancontrolinputs.7.dat", None, "there is none"),
    ],
)
def test_cases_of_tblade3_that_cannot_be_are_refused_and_leave_nothing(name, spoilt, message, run, windmill):
    path = Path(name)
    if spoilt is None:
        path.unlink()
        path = windmill
    else:
        path.write_text(spoilt(path.read_text()))
    before = sorted(Path().iterdir())
    found = run("import", path)
    assert found.status == 2
    assert message in found.err
    assert found.err.count("\n") == 1
    assert sorted(Path().iterdir()) == before
