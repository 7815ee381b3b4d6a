"""A design's section becomes a polar, or a paragraph that says why not."""

import shutil

import pytest

AIRFOIL = """family = "profile-section"
name = "naca-23012"
length_unit = "m"
chord = 0.245

[section]
kind = "naca-5"
thickness = 0.12
trailing_edge = "blunt"
"""


@pytest.fixture
def airfoil_file(tmp_path):
    path = tmp_path / "naca-23012.toml"
    path.write_text(AIRFOIL)
    return path


@pytest.fixture
def xfoil():
    if shutil.which("xfoil") is None:
        pytest.skip("XFOIL is not installed: apt-get install xfoil")


@pytest.mark.usefixtures("xfoil")
def test_a_polar_is_printed_and_written_with_its_segments(run, airfoil_file, tmp_path):
    table, picture = tmp_path / "made" / "polar.csv", tmp_path / "polar.svg"
    words = ("--reynolds", "3.5e6", "--alpha", "2:4:2", "--segments", "-o", table, "-o", picture)
    found = run("polar", airfoil_file, *words)
    assert found.status == 0
    assert "naca-23012: XFOIL 6.99, Reynolds number 3.5e+06, Mach number 0" in found.out
    assert "3 upper leading edge" in found.out
    assert len(table.read_text().splitlines()) == 3
    assert picture.stat().st_size > 10_000


@pytest.mark.usefixtures("xfoil")
def test_an_angle_that_does_not_converge_is_a_failure_of_the_command(run, airfoil_file):
    found = run("polar", airfoil_file, "--reynolds", "3.5e6", "--alpha", "4,60", "--json", "--reference-length", "1m")
    assert found.status == 1
    assert found.json["cl"][1] is None
    assert found.json["reynolds"] == 3.5e6
    assert "alpha 60: XFOIL did not converge" in found.err


@pytest.mark.usefixtures("xfoil")
def test_the_polar_of_a_cascade_s_section_says_what_it_is(run, vane_file):
    found = run("polar", vane_file, "--reynolds", "5e5", "--alpha", "0", "--span", "0.3", "--time-limit", "20")
    assert found.status in {0, 1}
    assert "is a section of a cascade" in found.out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--alpha", "4:0:2"), "'4:0:2' counts 0 angles: from 4 in steps of 2 to 0"),
        (("--alpha", "0:10:0"), "'0:10:0' counts 0 angles"),
        (("--alpha", "0:1e9:1e-3"), "write FIRST:LAST:STEP with at most 1000"),
        (("--alpha", "four"), "'four' are no angles: write them like 4, or -5,0,5, or -5:15:0.5"),
        (("--transition", "1"), "'1' are no two numbers"),
        (("--reference-length", "1"), "is not a length"),
        (("-o", "polar.txt"), "'polar.txt' is neither a table nor a picture: end its name in .csv, .png"),
        (("--mach", "3"), "mach is 3: it must lie between 0 and 0.75"),
        (("--set", "section.thickness=2"), "section.thickness"),
    ],
)
def test_what_is_asked_wrongly_is_a_paragraph(run, airfoil_file, words, message):
    found = run("polar", airfoil_file, "--reynolds", "1e6", *words)
    assert found.status == 2
    assert message in found.err
    assert len(found.err.splitlines()) == 1


def test_nothing_is_left_where_there_is_no_xfoil(run, airfoil_file, tmp_path, monkeypatch):
    monkeypatch.setenv("BLADEWRIGHT_XFOIL", "/no/xfoil")
    found = run("polar", airfoil_file, "--reynolds", "1e6", "-o", tmp_path / "made" / "polar.csv")
    assert found.status == 2
    assert found.err.startswith("bladewright: BLADEWRIGHT_XFOIL is '/no/xfoil', which is no program")
    assert not (tmp_path / "made").exists()
