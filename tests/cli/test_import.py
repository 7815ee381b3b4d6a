"""`bladewright import`: another program's design is written as a design file, with what changed and how far it lies."""

import pytest

import bladewright as bw

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
    assert run("import", configuration).status == 0
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
