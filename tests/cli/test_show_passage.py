"""`bladewright show --body passage`: figures and a picture of a flow passage, or a paragraph that says why not."""

import pytest

from bladewright.files.examples import example_text
from bladewright.files.reading import read_design


@pytest.fixture
def cascade_file(tmp_path):
    path = tmp_path / "vki-ls89.toml"
    path.write_text(example_text("vki-ls89"))
    return path


@pytest.fixture
def section_file(tmp_path):
    path = tmp_path / "turbine-section.toml"
    path.write_text(example_text("turbine-section"))
    return path


def test_show_gives_the_figures_of_a_passage_and_what_it_is_held_to(run, cascade_file):
    found = run("show", cascade_file, "--body", "passage", "--downstream", "0.75", "--json")
    assert (found.status, found.err) == (0, "")
    data = found.json
    assert data["name"] == "vki-ls89-passage"
    blade = read_design(cascade_file).build()
    length = data["meridional_length_m"]
    ring = 0.0575 * 0.1 * length * (0.5 + 1.0 + 0.75)
    assert data["ring_m3"] == pytest.approx(ring, rel=1e-9)  # a box: pitch x span x extent
    assert data["properties"]["volume"] == pytest.approx(ring - float(blade.properties.volume), rel=1e-9)
    assert (data["upstream"], data["downstream"]) == (0.5, 0.75)
    assert set(data["least_jacobian"]) == {"hub_upper", "hub_lower", "shroud_upper", "shroud_lower"}
    assert data["promises"]["kept"] is True
    assert data["promises"]["limits"] == {"ring_filled": 1e-6, "walls": 1e-7}
    assert len(data["surfaces"]) == 10
    text = run("show", cascade_file, "--body", "passage", "--downstream", "0.75").out
    assert f"{ring * 1e9:.6g} mm3" in text
    assert "at most 1e-07 allowed" in text
    least = min(each["share"] for each in data["least_jacobian"].values())
    assert f"{least:.2g} of its median, on " in text


def test_walls_that_miss_their_limit_give_status_one(run, cascade_file, monkeypatch):
    from bladewright.cli import summary

    monkeypatch.setitem(summary.PASSAGE_LIMITS, "walls", 1e-18)
    found = run("show", cascade_file, "--body", "passage")
    assert found.status == 1
    assert "the check of ends on their walls ('walls') failed: " in found.err
    assert "chords off, at most 1e-18 allowed" in found.err
    assert "FAILED" in found.out


def test_the_passage_of_a_section_is_drawn_as_curves(run, section_file, tmp_path):
    picture = tmp_path / "passage.svg"
    found = run("show", section_file, "--body", "passage", "--outlet-angle", "-60", "-o", picture, "--json")
    assert (found.status, found.err) == (0, "")
    data, section = found.json, read_design(section_file).build()
    chord = float(section.camber.control_points[-1, 0] - section.camber.control_points[0, 0])
    assert data["properties"]["pitch"] == pytest.approx(0.027)
    assert data["properties"]["area"] == pytest.approx(0.027 * 2.0 * chord - float(section.area), rel=1e-9)
    assert set(data["curves"]) == {"inlet", "outlet", "periodic_lower", "periodic_upper", "upper", "lower"}
    assert picture.read_bytes().startswith(b"<?xml")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--upstream", "1"], ["--upstream", "--body passage"]),
        (["--body", "passages"], ["passages", "'passage'"]),
        (["--body", "passage", "--split"], ["--split", "2D section"]),
        (["--body", "passage", "--upstream", "-1"], ["turbine-section.toml", "upstream", "-1", "positive"]),
        (["--body", "passage", "--upstream", "nan"], ["turbine-section.toml", "upstream", "nan"]),
        (["--body", "passage", "--outlet-angle", "x"], ["--outlet-angle", "x"]),
        (["--body", "passage", "--outlet-angle", "95"], ["turbine-section.toml", "outlet_angle", "95", "89 deg"]),
        (["--body", "passage", "--set", "pitch=9"], ["turbine-section.toml", "pitch"]),
        (["--body", "passage", "-o", "there.gif"], [".gif", ".png, .svg, .pdf"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_what_shows_no_passage_is_refused_and_leaves_nothing(words, said, run, section_file, tmp_path):
    found = run("show", section_file, *words)
    assert (found.status, found.out, found.err.count("\n")) == (2, "", 1), found
    assert "fault of bladewright" not in found.err
    for word in said:
        assert word in found.err
    assert list(tmp_path.iterdir()) == [section_file]


def test_a_section_without_a_pitch_has_no_passage_to_show(run, section_file):
    section_file.write_text("\n".join(each for each in section_file.read_text().splitlines() if "pitch" not in each))
    found = run("show", section_file, "--body", "passage")
    assert (found.status, found.err.count("\n")) == (2, 1)
    assert "pitch is missing" in found.err
