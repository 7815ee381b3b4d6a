"""`bladewright fit`: what is asked for reaches the fit, and what it finds is written, whatever it is."""

import json
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import bladewright as bw
from bladewright.errors import FitError
from bladewright.files.examples import example_text
from bladewright.fitting.assessment.measurement import Estimate
from bladewright.fitting.assessment.result import Fit
from bladewright.nurbs.closest import closest_on_curve


@pytest.fixture(scope="module")
def design(tmp_path_factory):
    path = tmp_path_factory.mktemp("design") / "section.toml"
    path.write_text(example_text("turbine-section"))
    return bw.read_design(path).changed({"description": "", "author": "", "organisation": ""})


@pytest.fixture(scope="module")
def points(design):
    u = (1 - np.cos(np.pi * np.linspace(0.0, 1.0, 80))) / 2
    curves = design.build().curves
    return np.concatenate([curves["upper"](u), curves["lower"](u[1:-1])])


def fit_of(design, cloud, **changes):
    built = design.build()
    feet = {name: closest_on_curve(curve, cloud) for name, curve in built.curves.items()}
    upper = feet["upper"].distances <= feet["lower"].distances
    near = np.where(upper, feet["upper"].u, feet["lower"].u)
    regions = np.where(near < 0.03, "leading edge", np.where(near > 0.97, "trailing edge", "sides"))
    given = {
        "design": design,
        "built": built,
        "cloud": cloud,
        "places": np.where(upper, "upper", "lower"),
        "u": near,
        "v": np.zeros(len(cloud)),
        "deviations": np.minimum(feet["upper"].distances, feet["lower"].distances),
        "regions": regions,
        "inliers": np.ones(len(cloud), dtype=bool),
        "set_aside": np.full(len(cloud), ""),
        "estimates": (
            Estimate(
                path="stagger", value=design.stagger, deviation=0.1, low=-60, high=-50, identified=True, at_bound=False
            ),
        ),
        "covariance": np.array([[0.01]]),
        "rank": 1,
        "condition": 1.0,
        "noise": 1e-7,
        "extrema": {"upper": 3, "lower": 2},
        "tolerance": None,
        "failures": (),
        "notes": ("a note of the fit",),
        "evaluations": 5,
    }
    return Fit(**given | changes)


@pytest.fixture
def stub(design, monkeypatch, tmp_path):
    """Stands in the place of the fit; hands back the design as it is, and keeps what it was called with."""
    monkeypatch.chdir(tmp_path)
    calls = SimpleNamespace(cloud=None, given=None, changes={}, error=None)

    def fit(cloud, *, name, **given):
        calls.cloud, calls.given = cloud, given | {"name": name}
        given["progress"]("going on")
        if calls.error:
            raise calls.error
        return fit_of(design.changed("name", name or design.name), cloud, **calls.changes)

    module = sys.modules.get("bladewright.fitting.fit")
    if module is None:
        monkeypatch.setitem(sys.modules, "bladewright.fitting.fit", SimpleNamespace(fit=fit))
    else:
        monkeypatch.setattr(module, "fit", fit)
    return calls


@pytest.fixture
def cloud_file(points, tmp_path):
    path = tmp_path / "vane scan.txt"
    np.savetxt(path, points * 1e3, fmt="%.17g")
    return path


def test_design_report_picture_and_deviations_are_written(run, stub, cloud_file, points, design, tmp_path):
    found = run("fit", cloud_file, "--unit", "mm", "--deviations", "off.csv")
    assert found.status == 0, found.err
    assert stub.cloud == pytest.approx(points, rel=1e-15)
    assert stub.given["name"] == "vane-scan"
    assert bw.read_design("vane-scan.toml") == design.changed("name", "vane-scan")
    report = json.loads((tmp_path / "vane-scan.fit.json").read_text())
    assert report["passed"]
    assert report["cloud"]["columns"] == ["x", "y"]
    assert (tmp_path / "vane-scan.fit.png").read_bytes().startswith(b"\x89PNG")
    header, *rows = (tmp_path / "off.csv").read_text().splitlines()
    assert header == "x,y,nearest,u,v,deviation,region,inlier"
    assert len(rows) == len(points)
    assert rows[5].split(",")[2] == "upper"
    assert [float(word) for word in rows[5].split(",")[:2]] == pytest.approx(points[5], rel=1e-14)
    for name in ("vane-scan.toml", "vane-scan.fit.json", "vane-scan.fit.png", "off.csv"):
        assert name in found.out


def test_every_option_reaches_the_fit(run, stub, cloud_file, design, tmp_path):
    start = tmp_path / "start.toml"
    bw.write_design(design, start)
    words = ["--start", start, "--like", start, "--tolerance", "0.05mm", "--parameters", 22, "--align", "--no-picture"]
    words += ["--free", "stagger", "--free", "thickness_*", "--fix", "axial_chord", "--fix", "tangent_in=0.4"]
    words += ["--bound", "stagger=-60,-40", "--bound", "leading_edge_radius=0.01,"]
    words += ["--arrangement", "linear", "--pitch", "57.5mm", "--name", "vane", "--length-unit", "in"]
    found = run("fit", cloud_file, "--unit", "mm", "-o", "out/new.toml", *words)
    assert found.status == 0, found.err
    given = stub.given
    assert given["start"] == design
    assert given["like"] == design
    assert given["tolerance"] == pytest.approx(5e-5)
    assert given["parameters"] == 22
    assert given["align"]
    assert given["free"] == ("stagger", "thickness_*")
    assert given["fixed"] == {"axial_chord": design.axial_chord, "tangent_in": 0.4}
    assert given["bounds"] == {"stagger": (-60.0, -40.0), "leading_edge_radius": (0.01, np.inf)}
    assert given["arrangement"] == "linear"
    assert given["pitch"] == pytest.approx(0.0575)
    assert (given["name"], given["length_unit"]) == ("vane", "in")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["new.fit.json", "new.toml"]


@pytest.mark.parametrize(("word", "axis"), [("-z", "-z"), ("0,1,-0.5", (0.0, 1.0, -0.5))])
def test_an_axis_is_a_name_or_three_numbers(word, axis, run, stub, cloud_file):
    assert run("fit", cloud_file, "--axis", word, "--no-picture").status == 0
    assert stub.given["axis"] == axis


def test_patterns_without_values_are_held_at_the_start(run, stub, cloud_file, design, tmp_path):
    start = tmp_path / "start.toml"
    bw.write_design(design, start)
    assert run("fit", cloud_file, "--start", start, "--fix", "thickness_*", "--no-picture").status == 0
    assert stub.given["fixed"] == ["thickness_*"]
    # a start keeps its own
    assert [stub.given[name] for name in ("name", "length_unit")] == [None] * 2
    assert run("fit", cloud_file, "--no-picture", "--force").status == 0
    assert [stub.given[name] for name in ("start", "fixed", "free", "bounds", "tolerance")] == [None] * 5


def test_columns_and_units_are_those_of_the_file(run, stub, points, tmp_path):
    path = tmp_path / "cloud.txt"
    np.savetxt(path, np.column_stack([np.arange(len(points)), points[:, ::-1] * 1e3]), fmt="%.17g")
    found = run("fit", path, "--columns", "skip,y,x", "--unit", "mm", "--no-picture", "--json")
    assert found.status == 0, found.err
    assert stub.cloud == pytest.approx(points, rel=1e-15)
    assert found.json["cloud"]["columns"] == ["skip", "y", "x"]
    assert found.json["files"]["design"] == "cloud.toml"


def test_a_start_may_be_a_parablade_configuration(run, stub, cloud_file, tmp_path):
    values = {"x_leading": "0", "y_leading": "0", "z_leading": "1, 1.1", "x_trailing": "0.05", "z_trailing": "1, 1.1"}
    values |= dict.fromkeys(("x_hub", "z_hub", "x_shroud", "z_shroud"), "")
    values |= {"stagger": "-30", "theta_in": "20", "theta_out": "-55", "radius_in": "0.02", "radius_out": "0.008"}
    values |= {"dist_in": "0.4", "dist_out": "0.5", "NDIM": "2", "CASCADE_TYPE": "LINEAR"}
    values |= {f"thickness_{side}_{i}": "0.05" for side in ("upper", "lower") for i in range(1, 7)}
    values["PARAMETRIZATION_TYPE"] = "CAMBER_THICKNESS"
    path = tmp_path / "start.cfg"
    path.write_text("".join(f"{key}={value}\n" for key, value in values.items()))
    assert run("fit", cloud_file, "--start", path, "--no-picture").status == 0
    assert stub.given["start"].stagger == pytest.approx(-30, abs=0.5)


def test_a_fit_that_does_not_pass_ends_with_1_and_is_written(run, stub, cloud_file, tmp_path):
    stub.changes = {"failures": ("the largest deviation is 0.2 mm, above the tolerance of 0.05 mm",)}
    found = run("fit", cloud_file, "--unit", "mm", "--no-picture")
    assert found.status == 1
    assert "above the tolerance" in found.err
    assert (tmp_path / "vane-scan.toml").is_file()


def test_an_interrupted_fit_ends_with_130_and_is_written(run, stub, cloud_file, tmp_path):
    stub.changes = {"interrupted": True, "failures": ("interrupted",)}
    found = run("fit", cloud_file, "--unit", "mm")
    assert found.status == 130
    assert "interrupted: the best design so far is written" in found.out
    assert bw.read_design("vane-scan.toml").name == "vane-scan"
    assert json.loads((tmp_path / "vane-scan.fit.json").read_text())["interrupted"]


@pytest.mark.usefixtures("stub")
def test_a_design_file_that_is_there_keeps_its_comments_and_texts(run, cloud_file, design, tmp_path):
    path = tmp_path / "vane.toml"
    bw.write_design(design.changed({"description": "stage 2", "stagger": -11.0}), path)
    path.write_text("# measured in Karlsruhe\n" + path.read_text())
    words = ("fit", cloud_file, "--unit", "mm", "-o", path, "--no-picture", "--name", design.name)
    assert run(*words, "--start", path).status == 0
    assert path.read_text().startswith("# measured in Karlsruhe\n")
    assert bw.read_design(path) == design.changed("description", "stage 2")
    path.write_text(path.read_text().replace("stagger = ", "stagger = 1.0 # was "))
    assert run(*words, "--force").status == 0
    assert path.read_text().startswith("# measured in Karlsruhe\n")
    assert bw.read_design(path) == design.changed("description", "stage 2")


@pytest.mark.usefixtures("stub")
def test_a_design_file_that_is_there_and_is_not_the_start_stays(run, cloud_file, design, tmp_path):
    path, start = tmp_path / "vane.toml", tmp_path / "start.toml"
    for each in (path, start):
        bw.write_design(design.changed("stagger", -11.0), each)
    before = path.read_bytes()
    for words in ((), ("--start", start), ("--like", path)):
        found = run("fit", cloud_file, "--unit", "mm", "-o", path, "--no-picture", *words)
        assert found.status == 2
        assert "exists already: name another file with -o, or overwrite it with --force" in found.err
    assert path.read_bytes() == before


def test_a_unit_that_cannot_be_is_said_with_the_result_and_with_a_refusal(run, stub, cloud_file):
    found = run("fit", cloud_file, "--no-picture")
    assert found.status == 0
    assert "taken to be in m" in found.out
    stub.error = FitError("all points lie on one line")
    found = run("fit", cloud_file, "--no-picture", "--force")
    assert found.status == 2
    assert "all points lie on one line" in found.err
    assert "taken to be in m" in found.err


@pytest.mark.parametrize(("words", "count"), [([], 10_000), (["--samples", "500"], 500)])
def test_the_faces_of_a_cad_file_are_sampled(words, count, run, stub, points, tmp_path, monkeypatch):
    asked = []

    def sample(path, count):
        asked.append((path.name, count))
        return points

    # by its entry, as asking for the name would load OpenCASCADE
    monkeypatch.setitem(vars(bw), "cad", SimpleNamespace(sample=sample))
    (tmp_path / "vane.STEP").write_text("faces")
    assert run("fit", tmp_path / "vane.STEP", "--no-picture", *words).status == 0
    assert asked == [("vane.STEP", count)]
    assert stub.cloud is points
    assert run("fit", tmp_path / "vane.STEP", "--unit", "mm").status == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--columns", "x,y,w"], "'w' is not known"),
        (["--columns", "x,y,z"], "they are too few"),
        (["--tolerance", "0.05"], "is not a length"),
        (["--bound", "stagger=3"], "is not PATH=LOW,HIGH"),
        (["--bound", "stagger=nan,1"], "is not PATH=LOW,HIGH"),
        (["--bound", "stagger=5,1"], "'stagger=5,1' has its lowest value 5 above its highest 1: exchange them"),
        (["--fix", "stagger=steep"], "is not PATH or PATH=VALUE"),
        (["--axis", "0,1,up"], "is no axis"),
        (["--fix", "stagger"], "give the value, or a design with --start"),
        (["--samples", "1000"], "points of the faces of a CAD file"),
        (["--picture", "a.txt"], "a picture is drawn as"),
        (["--picture", "a.png", "--no-picture"], "leave one out"),
        (["--start", "absent.toml"], "there is no file 'absent.toml'"),
        (["-o", "vane scan.txt"], "so it is not overwritten"),
        (["--name", "a/b"], "it names files"),
    ],
)
@pytest.mark.usefixtures("stub")
def test_a_call_that_makes_no_sense_is_refused_and_leaves_nothing(words, message, run, cloud_file, tmp_path):
    before = sorted(tmp_path.iterdir())
    found = run("fit", cloud_file, *words)
    assert found.status == 2
    assert message in found.err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["--deviations", "./vane scan.txt"],
            "--deviations would be written to 'vane scan.txt', which is the cloud",
        ),
        (["--deviations", "vane-scan.toml"], "which is the design as well"),
        (["--deviations", "vane-scan.fit.json"], "which is the report as well"),
        (["--deviations", "vane-scan.fit.png"], "which is the picture as well"),
        (["--start", "start.toml", "--deviations", "start.toml"], "which is the design of --start as well"),
        (["--like", "start.toml", "-o", "start.toml"], "which is the design of --like"),
        (["--start", "start.toml", "-o", "start.toml", "--deviations", "start.toml"], "which is the design as well"),
        (
            ["--start", "start.toml", "--like", "start.toml", "-o", "start.toml"],
            "which is the design of --like as well",
        ),
        (["--start", "start.toml", "-o", "start.toml", "--picture", "vane.png", "--deviations", "vane.png"], "picture"),
    ],
)
@pytest.mark.usefixtures("stub")
def test_no_file_is_written_in_the_place_of_another(words, message, run, cloud_file, design, tmp_path):
    bw.write_design(design, tmp_path / "start.toml")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    found = run("fit", cloud_file, "--unit", "mm", "--force", *words)
    assert found.status == 2
    assert message in found.err
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.usefixtures("stub")
def test_a_table_of_deviations_takes_no_other_files_place_without_force(run, cloud_file, design, tmp_path):
    other = tmp_path / "other.toml"
    bw.write_design(design, other)
    before = other.read_bytes()
    found = run("fit", cloud_file, "--unit", "mm", "--deviations", str(other))
    assert found.status == 2
    assert "exists already: name another file with --deviations" in found.err
    assert other.read_bytes() == before


@pytest.mark.usefixtures("stub")
def test_bad_clouds_are_refused_in_one_paragraph(run, tmp_path):
    for content, message in (("", "is empty"), ("1 2\n3 nan\n", "line 2"), ("1 2\n3 x\n", "'x' at line 2, column 2")):
        path = tmp_path / "cloud.txt"
        path.write_text(content)
        found = run("fit", path)
        assert found.status == 2
        assert message in found.err
        assert len(found.err.splitlines()) == 1
    found = run("fit", tmp_path / "absent.step")
    assert found.status == 2
    assert "there is no file" in found.err
