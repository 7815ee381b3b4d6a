"""A design becomes a mesh of its passage, or a paragraph that says why not."""

import sys

import pytest

from bladewright.files.examples import example_text


@pytest.fixture
def loaded_gmsh():
    try:
        import gmsh
    except (ImportError, OSError) as error:
        pytest.skip(f"gmsh does not load here: {error}")
    return gmsh


@pytest.fixture
def section_file(tmp_path):
    path = tmp_path / "section.toml"
    path.write_text(example_text("turbine-section"))
    return path


def left(directory):
    return sorted(each.name for each in directory.iterdir())


@pytest.mark.usefixtures("loaded_gmsh")
def test_a_design_becomes_a_mesh_with_its_figures(run, section_file, tmp_path):
    found = run("mesh", section_file, "-o", tmp_path / "made" / "passage.su2", "--size", "0.3", "--json")
    assert found.status == 0, found
    assert found.err == ""
    data = found.json
    assert data["passed"] is True
    assert data["failures"] == []
    assert data["name"] == "turbine-section-passage"
    assert data["format"] == "SU2"
    assert data["inverted"] == 0
    assert data["min_sicn"]["worst"] > 0.0
    assert data["limits"]["periodic_mismatch"] == 1e-9
    assert {face["name"] for face in data["faces"]} >= {"inlet", "hub_upper", "blade_lower", "periodic_upper"}
    assert data["su2"].startswith("MARKER_PERIODIC= ( periodic_lower, periodic_upper,")
    assert left(tmp_path / "made") == ["passage.su2"]


@pytest.mark.usefixtures("loaded_gmsh")
def test_a_mesh_that_fails_a_check_stays_and_ends_with_1(run, section_file, tmp_path, monkeypatch):
    monkeypatch.setattr("bladewright.meshing.verification.DEVIATION_LIMIT", (0.0, 0.0))
    monkeypatch.chdir(tmp_path)
    found = run("mesh", section_file, "--size", "0.4", "--quiet")
    assert found.status == 1
    assert found.out == ""
    assert "off the native surface" in found.err
    assert left(tmp_path) == ["section.toml", "turbine-section-passage.msh"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--size", "0"], ["size is 0", "above 0"]),
        (["--size", "-1"], ["size is -1", "above 0"]),
        (["--smallest", "2"], ["smallest is 2", "at most 1"]),
        (["--curvature", "0"], ["curvature is 0"]),
        (["--size", "thin"], ["thin", "--size"]),
        (["-o", "passage.vtk"], [".vtk", ".msh, .su2, .cgns"]),
        (["--unit", "inch"], ["inch", "--unit"]),
    ],
    ids=str,
)
def test_a_call_that_no_mesh_answers_is_refused_and_leaves_nothing(words, said, run, section_file):
    found = run("mesh", section_file, *words)
    assert found.status == 2
    assert found.out == ""
    assert "Traceback" not in found.err
    for word in said:
        assert word in found.err
    assert left(section_file.parent) == [section_file.name]


@pytest.mark.usefixtures("loaded_gmsh")
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--size", "1e-4"], ["tetrahedra are expected", "at most 5,000,000", "raise size to"]),
        (["--upstream", "-1"], ["section.toml", "upstream", "-1"]),
        (["--set", "pitch=3"], ["section.toml", "pitch"]),
    ],
    ids=str,
)
def test_a_passage_that_cannot_be_meshed_is_refused_and_leaves_nothing(words, said, run, section_file):
    found = run("mesh", section_file, "-o", section_file.parent / "deep" / "passage.msh", *words)
    assert found.status == 2, found
    for word in said:
        assert word in found.err
    assert left(section_file.parent) == [section_file.name]


def test_without_gmsh_one_paragraph_names_the_extra(run, section_file, monkeypatch):
    monkeypatch.setitem(sys.modules, "gmsh", None)
    found = run("mesh", section_file)
    assert found.status == 2
    assert found.err.count("\n") == 1
    assert "pip install 'bladewright[mesh]'" in found.err
    assert left(section_file.parent) == [section_file.name]


@pytest.mark.usefixtures("loaded_gmsh")
def test_an_interruption_ends_with_130_and_leaves_nothing(run, section_file, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("bladewright.meshing.passage_mesh.run_gmsh", interrupted)
    found = run("mesh", section_file, "-o", section_file.parent / "passage.msh", "--size", "0.4")
    assert found.status == 130
    assert left(section_file.parent) == [section_file.name]
