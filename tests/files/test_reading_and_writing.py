"""A design file and a design are one thing in two forms."""

import math
import os
import re
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Stations
from bladewright.errors import DesignError, FileError
from bladewright.files.examples import example_text, examples
from bladewright.files.families import FAMILIES, family_of
from bladewright.files.reading import design_from, parsed, read_design
from bladewright.files.validation_messages import key_paths
from bladewright.files.writing import text_of, updated, write_design
from bladewright.section.planar import PlanarSection
from bladewright.section.unified import UnifiedSection

TEXT = example_text("fan-rotor")


def number(low, high):
    return st.floats(low, high, exclude_min=True, exclude_max=True)


def stations(low, high):
    """Laws at stations that stay between their values."""
    inner = st.lists(st.tuples(st.integers(1, 999), number(low, high)), max_size=3, unique_by=lambda pair: pair[0])

    def made(inner, first, last, interpolation):
        places, values = zip(*sorted(inner), strict=True) if inner else ((), ())
        span = (0.0, *(place / 1000 for place in places), 1.0)
        return Stations(span=span, values=(first, *values, last), interpolation=interpolation)

    return st.builds(made, inner, number(low, high), number(low, high), st.sampled_from(["monotone", "linear"]))


def law(low, high):
    several = st.lists(number(low, high), min_size=1, max_size=6).map(tuple)
    return number(low, high) | several | stations(low, high)


def chordwise(low, high):
    return st.lists(law(low, high), min_size=1, max_size=5).map(tuple)


def points(least):
    coordinate = st.floats(allow_nan=False, allow_infinity=False)
    return st.lists(st.tuples(coordinate, coordinate), min_size=least, max_size=5).map(tuple)


words = st.text(st.characters(categories=["L", "N", "P", "S", "Zs"]), max_size=30).filter(str.isprintable)
names = words.filter(lambda text: text.strip() and not set(text) & set('/\\:*?"<>|'))
channels = st.builds(
    Channel, leading_edge=points(2), trailing_edge=points(2), hub=points(0), shroud=points(0), degree=st.integers(1, 5)
)
labels = {
    "name": names,
    "length_unit": st.sampled_from(["m", "cm", "mm", "um", "in", "ft"]),
    "samples": st.integers(3, 60),
    "clustering": st.floats(0, 1),
    "description": words,
}
length = st.floats(0, 1e300, exclude_min=True)


def shape(law, chordwise):
    """Strategies for the fields of the unified families, whatever a law is."""
    return {
        **dict.fromkeys(["stagger", "metal_angle_in", "metal_angle_out"], law(-90, 90)),
        **dict.fromkeys(["tangent_in", "tangent_out", "leading_edge_radius", "trailing_edge_radius"], law(0, 1)),
        **dict.fromkeys(["thickness_upper", "thickness_lower"], chordwise(0, 10)),
        **dict.fromkeys(["weights_upper", "weights_lower"], st.just(()) | chordwise(0, 1e6)),
    }


def blades(**fields):
    mapping = st.sampled_from(["conformal", "paper"])
    return st.builds(UnifiedBlade, **labels, **shape(law, chordwise), channel=channels, mapping=mapping, **fields)


place = st.none() | law(-1e3, 1e3)
clearance = st.none() | length | st.tuples(length, length)
DESIGNS = {
    "unified": blades(blade_count=st.integers(1, 10_000), leading_edge_theta=place, tip_clearance=clearance)
    | blades(arrangement=st.just("linear"), pitch=length, leading_edge_y=place, hub_clearance=clearance),
    "unified-section": st.builds(
        UnifiedSection,
        **labels,
        **shape(number, lambda low, high: st.lists(number(low, high), min_size=1, max_size=6).map(tuple)),
        axial_chord=length,
        leading_edge_x=st.floats(-1e300, 1e300),
        pitch=st.none() | length,
        span=st.none() | length,
    ),
}
# the families that are one part are written and read among the shared contract tests of sections and their blades
designs = st.one_of(
    [DESIGNS[family] for family, kind in FAMILIES.items() if not issubclass(kind, PlanarSection | SectionedBlade)]
)


def to_the_bit(design):
    """Everything in a design, floats in the shortest form that gives the same bits back."""
    return repr(design)


@given(designs)
def test_what_is_written_reads_back_to_the_bit(design):
    assert to_the_bit(design_from(parsed(text_of(design), "file"), "file")) == to_the_bit(design)


@given(designs)
@settings(max_examples=50)
def test_what_is_written_into_any_file_reads_back_to_the_bit(design):
    text = updated(design, TEXT, "file")
    assert to_the_bit(design_from(parsed(text, "file"), "file")) == to_the_bit(design)
    assert tomllib.loads(text)["family"] == family_of(design)
    assert list(tomllib.loads(text))[:3] == ["family", "length_unit", "name"]


@pytest.mark.parametrize("name", examples())
def test_writing_an_example_back_changes_nothing(name, tmp_path):
    path = tmp_path / "design.toml"
    path.write_text(example_text(name))
    write_design(read_design(path), path)
    assert path.read_text() == example_text(name)


def test_changed_values_keep_comments_and_layout(tmp_path):
    path = tmp_path / "design.toml"
    path.write_text(TEXT)
    changes = {
        "stagger[1]": -52.0,
        "tangent_in": 0.25,
        "thickness_upper[0][1]": 0.5,
        "thickness_lower": (0.1, (0.2, 0.3), 0.1, 0.1),
        "channel.hub[0].x": 1e-6,
        "channel.shroud": ((30.0, 256.0),),
        "samples": 20,
        "weights_upper": ((1.0, 2.0), 3.0),
    }
    design = read_design(path).changed(changes)
    write_design(design, path)
    assert to_the_bit(read_design(path)) == to_the_bit(design)
    before, after = TEXT.splitlines(), path.read_text().splitlines()
    for line in before:
        if "#" in line:
            assert line.partition("#")[2] in [other.partition("#")[2] for other in after]
    changed = ("stagger", "tangent_in", "thickness", "hub", "shroud", "samples", "weights")
    unchanged = [line for line in before if not line.startswith(changed)]
    assert [line for line in after if not line.startswith(changed)] == unchanged
    assert "stagger              = [12.8, -52.0, 48.9, 57.5, 63.1]  # deg" in after


def test_comments_between_the_entries_of_a_list_survive(tmp_path):
    path = tmp_path / "design.toml"
    stagger = "stagger = [\n  12.8, # hub\n  # in between\n  60, # tip\n]"
    path.write_text(TEXT.replace("stagger              = [12.8, 23.8, 48.9, 57.5, 63.1]", stagger))
    write_design(read_design(path).changed("stagger[0]", 10.5), path)
    assert stagger.replace("12.8", "10.5") in path.read_text()


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_line_ends_stay_as_they_are(end, tmp_path):
    path = tmp_path / "design.toml"
    path.write_bytes(TEXT.replace("\n", end).encode())
    write_design(read_design(path).changed("stagger[0]", 12.5), path)
    assert path.read_bytes().decode() == TEXT.replace("12.8", "12.5").replace("\n", end)


def test_a_byte_order_mark_is_no_part_of_the_design(tmp_path):
    path = tmp_path / "design.toml"
    path.write_bytes(b"\xef\xbb\xbf" + TEXT.encode())
    assert read_design(path).name == "fan-rotor"


def test_a_whole_number_stands_for_the_same_float_and_is_left_as_it_is_written(tmp_path):
    path = tmp_path / "design.toml"
    text = TEXT.replace("leading_edge_theta   = 0.0", "leading_edge_theta   = 7")
    path.write_text(text)
    design = read_design(path)
    assert design.leading_edge_theta == 7.0
    assert isinstance(design.leading_edge_theta, float)
    write_design(design, path)
    assert path.read_text() == text


def test_the_sign_of_zero_survives(tmp_path):
    path = tmp_path / "design.toml"
    path.write_text(TEXT)
    write_design(read_design(path).changed("leading_edge_theta", -0.0), path)
    assert math.copysign(1.0, read_design(path).leading_edge_theta) == -1.0


def test_a_design_replaces_one_of_the_other_arrangement(tmp_path):
    path = tmp_path / "design.toml"
    path.write_text(TEXT)
    values = {
        key: value for key, value in vars(read_design(path)).items() if key not in ("blade_count", "leading_edge_theta")
    }
    linear = UnifiedBlade(**{**values, "arrangement": "linear", "pitch": 40.0})
    write_design(linear, path)
    assert to_the_bit(read_design(path)) == to_the_bit(linear)
    assert "blade_count" not in tomllib.loads(path.read_text())


@pytest.mark.parametrize(
    ("text", "said"),
    [("[tool.ruff]\nselect = []\n", "holds no design"), ("Dear reader,\n", "not valid TOML"), ("", "holds no design")],
)
def test_a_file_that_holds_something_else_is_not_overwritten(text, said, tmp_path):
    path = tmp_path / "notes.toml"
    path.write_text(text)
    with pytest.raises(FileError, match=said) as refusal:
        write_design(design_from(tomllib.loads(TEXT), "file"), path)
    assert "not overwritten" in str(refusal.value)
    assert "another file" in str(refusal.value)
    assert path.read_text() == text


def test_a_design_that_a_file_holds_wrongly_is_mended(tmp_path):
    path = tmp_path / "design.toml"
    path.write_text(TEXT.replace("tangent_in ", "tangent_inn "))
    design = design_from(tomllib.loads(TEXT), "file")
    write_design(design, path)
    assert to_the_bit(read_design(path)) == to_the_bit(design)


def test_a_complex_parameter_is_not_written(tmp_path):
    design = design_from(tomllib.loads(TEXT), "file").changed("stagger[1]", 23.8 + 1e-30j)
    with pytest.raises(DesignError, match=r"stagger\[1\] is .*j"):
        write_design(design, tmp_path / "design.toml")
    assert list(tmp_path.iterdir()) == []


def test_a_design_without_a_file_format_is_not_written(tmp_path):
    with pytest.raises(FileError, match="Channel has no file format"):
        write_design(design_from(tomllib.loads(TEXT), "file").channel, tmp_path / "channel.toml")


def test_writing_follows_a_link_and_keeps_the_rights_of_a_file(tmp_path):
    real, link = tmp_path / "real.toml", tmp_path / "link.toml"
    real.write_text(TEXT)
    real.chmod(0o640)
    link.symlink_to(real)
    write_design(read_design(link).changed("stagger[0]", 1.0), link)
    assert link.is_symlink()
    assert read_design(real).stagger[0] == 1.0
    assert real.stat().st_mode & 0o777 == 0o640


def test_a_new_file_has_the_rights_that_the_process_gives(tmp_path):
    before = os.umask(0o027)
    try:
        write_design(design_from(tomllib.loads(TEXT), "file"), tmp_path / "design.toml")
    finally:
        os.umask(before)
    assert (tmp_path / "design.toml").stat().st_mode & 0o777 == 0o640


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "design.toml"
    path.write_text(TEXT)

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(FileError, match=r"design\.toml.*no space left"):
        write_design(read_design(path).changed("stagger[0]", 1.0), path)
    assert path.read_text() == TEXT
    assert list(tmp_path.iterdir()) == [path]


def test_a_path_that_is_text_reads_like_a_path(tmp_path):
    path = tmp_path / "design.toml"
    path.write_text(TEXT)
    assert read_design(str(path)) == read_design(Path(path))


def refusal(tmp_path, example, *changes):
    """The message with which the file of an example is refused after these replacements of its text."""
    path, text = tmp_path / "design.toml", example_text(example)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)
    with pytest.raises(DesignError) as caught:
        read_design(path)
    return str(caught.value).removeprefix(f"{path}: ")


def test_a_refusal_names_everything_that_is_to_be_corrected(tmp_path):
    text = refusal(
        tmp_path,
        "fan-rotor",
        ("stagger  ", "stager  "),
        ("blade_count = 22", 'blade_count = "22"'),
        ("[22.8, 100.5]", '[22.8, "x"]'),
        ("tangent_in           = [0.34,", 'tangent_in = ["a",'),
    )
    beginnings = [
        "5 things to correct: (1) stager does not exist; did you mean 'stagger'?",
        '(2) blade_count is "22": a whole number is needed',
        '(3) tangent_in[0] is "a"',
        '(4) channel.hub[0].r is "x": a number [length] is needed',
        "(5) stagger is missing: ",
    ]
    assert [text.find(each) >= 0 for each in beginnings] == [True] * 5
    assert text.startswith(beginnings[0])


def test_values_outside_their_limits_are_named_together_with_their_whole_paths(tmp_path):
    text = refusal(
        tmp_path,
        "core-rotor",
        ("maximum_thickness_at = 0.45", "maximum_thickness_at = 1.45"),
        ("leading_edge_index = 4.0", "leading_edge_index = -4.0"),
        ("blade_count = 29", "blade_count = 2.5"),
    )
    assert text.startswith("3 things to correct: (1) blade_count is 2.5")
    assert "(2) section.thickness.leading_edge_index is -4: it must be between 0 and 12" in text
    assert "(3) section.thickness.maximum_thickness_at is 1.45: the maximum must stand between" in text


def test_a_change_names_the_whole_path_too():
    design = design_from(tomllib.loads(example_text("core-rotor")), "rotor.toml")
    with pytest.raises(DesignError, match=r"^section\.thickness\.maximum_thickness_at is 1\.45: "):
        design.changed("section.thickness.maximum_thickness_at", 1.45)
    with pytest.raises(DesignError, match=r"^section\.curvature_places"):
        design.changed("section.curvature_places", (0.5,))


def test_what_is_found_while_building_has_its_whole_path():
    design = design_from(tomllib.loads(example_text("core-rotor")), "rotor.toml")
    with pytest.raises(DesignError, match=r"^section\.metal_angle_out less metal_angle_in is "):
        design.changed({"section.curvature": (-1.0, 1.0), "section.curvature_places": ()}).build()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("metal_angle_in  =", "lean = 1\nmetal_angle_in =", "section.lean does not exist: in this family it is lean"),
        ("[flow_path]", "stagger = 3\n[flow_path]", "stagger does not exist in this family: it is a key of unified"),
        ("[flow_path]", "metal_angle_in = 3\n[flow_path]", "in this family it is section.metal_angle_in"),
        ('"modified-naca"', '"quartic-spline"', 'leading_edge_index does not exist here: it belongs to law = "modif'),
        ("blade_count =", "blade_cuont =", "blade_cuont does not exist; did you mean 'blade_count'?"),
    ],
)
def test_a_key_of_another_place_or_family_is_said_to_belong_there(tmp_path, old, new, said):
    assert said in refusal(tmp_path, "core-rotor", (old, new))


@pytest.mark.parametrize("name", examples())
def test_every_parameter_of_an_example_is_a_key_of_its_family(name):
    design = design_from(tomllib.loads(example_text(name)), name)
    paths = {re.sub(r"\[\d+\]", "", path) for path in design.parameters()}
    assert {re.sub(r"\.[xr]$", "", path) for path in paths} <= {*key_paths(type(design))}


def test_limits_are_checked_beside_what_is_wrong_in_the_same_table_and_below():
    document = tomllib.loads(example_text("core-rotor"))
    document["flow_path"]["matchd"] = "ends"
    document["blade_count"] = 0
    document["section"]["metal_angle_in"] = [-44, -95, -57]
    document["section"]["thicknes"] = 3
    document["section"]["thickness"]["maximum_thickness"] = [0.09, 1.7]
    with pytest.raises(DesignError, match="5 things to correct") as refused:
        design_from(document, "rotor.toml")
    for said in (
        "flow_path.matchd does not exist",
        "blade_count is 0",
        "section.thicknes does not exist",
        "section.thickness.maximum_thickness[1] is 1.7",
        "section.metal_angle_in[1] is -95",
    ):
        assert str(refused.value).count(said) == 1


def test_what_is_beyond_its_limits_is_said_once():
    document = tomllib.loads(example_text("core-rotor")) | {"blade_count": 0}
    with pytest.raises(DesignError) as refused:
        design_from(document, "rotor.toml")
    assert str(refused.value).count("blade_count") == 1
