"""The design that a file was made from: in its header, in its round trip, and the same for the same input."""

import dataclasses
import re
from types import SimpleNamespace

import pytest

import bladewright
from bladewright import cad
from bladewright.cad.native_body import origin_of
from bladewright.cad.reading import read_cad_file
from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed
from bladewright.origin import Origin, parameters_hash, unwrapped, wrapped

ORIGIN = Origin(
    name="Schaufel Ø5 'ß'",
    parameters_hash="5c" * 32,
    changes=("stagger[1]=-52.0", f"thickness_upper={[[0.1] * 9] * 8}", 'name="翼\'\\n"'),
    file="../rotor.toml",
    text='family = "unified"\n',
)


@pytest.mark.parametrize("ending", ["step", "igs"])
def test_the_header_names_the_design_its_hash_and_its_changes(bodies, tmp_path, ending):
    path = tmp_path / f"vane.{ending}"
    trip = cad.write(bodies["linear"], path, origin=ORIGIN, samples=100)
    assert trip.passed
    assert trip.origin == ORIGIN
    # a header has no room for the text, and no path that would be wrong elsewhere
    assert read_cad_file(path).origin == dataclasses.replace(ORIGIN, file=None, text=None)
    assert cad.verify(path, bodies["linear"], samples=100).origin == read_cad_file(path).origin


def test_no_line_of_the_header_is_longer_than_its_format_allows(bodies, tmp_path):
    for ending in ("step", "igs"):
        cad.write(bodies["linear"], tmp_path / f"vane.{ending}", origin=ORIGIN, samples=100)
    head = (tmp_path / "vane.step").read_text("ascii").split("DATA;")[0]
    texts = re.findall(r"'((?:[^']|'')*)'", head.replace("\n", ""))
    assert max(len(text) for text in texts) > 200
    assert max(len(re.sub(r"\\X2\\((?:.{4})+?)\\X0\\", "?", text)) for text in texts) <= 256
    start = [line for line in (tmp_path / "vane.igs").read_text("ascii").splitlines() if line[72] == "S"]
    assert len(start) > 5
    assert {len(line) for line in start} == {80}


def test_the_report_holds_design_and_version(bodies, tmp_path):
    report = cad.write(bodies["linear"], tmp_path / "vane.step", origin=ORIGIN, samples=100).to_dict()
    assert report["version"] == bladewright.__version__
    assert Origin.from_dict(report["design"]) == ORIGIN
    assert report["design"]["text"] == ORIGIN.text


def test_a_blade_and_its_passage_name_their_design_without_being_told():
    design = design_from(parsed(example_text("fan-rotor"), ""), "")
    made = Origin(name="fan-rotor", parameters_hash=parameters_hash(design))
    blade = SimpleNamespace(name="fan-rotor", design=design)
    assert origin_of(blade) == origin_of(SimpleNamespace(name="fan-rotor-passage", blade=blade)) == made
    assert origin_of(SimpleNamespace(name="foreign")) is None


def test_only_the_time_differs_between_two_files_of_a_blade(bodies, tmp_path):
    texts = []
    for name in ("one.step", "two.step"):
        cad.write(bodies["linear"], tmp_path / name, origin=ORIGIN, samples=100)
        texts.append(re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "", (tmp_path / name).read_text()))
    assert texts[0] == texts[1]


def test_long_lines_are_continued_and_joined():
    lines = ["", "short", "x" * 300, "y" * 72]
    pieces = [piece for line in lines for piece in wrapped(line, 72)]
    assert max(map(len, pieces)) == 72
    assert unwrapped(pieces) == lines


def test_the_hash_is_that_of_what_shapes_the_blade():
    design = design_from(parsed(example_text("fan-rotor"), ""), "")
    named = design.changed({"name": "other", "description": "", "author": "me"})
    whole = design.changed("tolerance", design.tolerance)
    assert parameters_hash(design) == parameters_hash(named) == parameters_hash(whole)
    assert re.fullmatch("[0-9a-f]{64}", parameters_hash(design))
    changed = [design.changed(path, value * (1.0 + 1e-15) + 1e-300) for path, value in design.parameters().items()]
    hashes = {parameters_hash(each) for each in [design, design.changed("blade_count", 23), *changed]}
    assert len(hashes) == 2 + len(changed)
    assert parameters_hash(design.changed("stagger", 12)) == parameters_hash(design.changed("stagger", 12.0))
