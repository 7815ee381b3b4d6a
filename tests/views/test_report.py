"""The report page: one file that holds all of it, loads nothing, and says where a round trip is of another design."""

import re
from importlib import import_module

import pytest

from bladewright import views
from bladewright.errors import FileError
from bladewright.origin import parameters_hash
from bladewright.views.report import parameter_rows, report_page
from bladewright.views.round_trip import round_trip_figure
from machines import built
from machines.coarse import BLADES
from machines.families import FAMILIES
from machines.unified import VANE

from .page import Page

ROTOR = BLADES["cascade"].changed({"description": "a <i>prismatic</i> vane & more", "author": "A. <b>Author</b>"})


def trip_of(design):
    """A round trip as JSON, of one face."""
    pair = {"cad": 2.0, "native": 2.0, "relative_error": 1e-12}
    face = {"name": "upper", "samples": 9, "max_deviation_mm": 7e-12, "mean_deviation_mm": 2e-12, "area_mm2": pair}
    return {
        "file": "rotor.step", "format": "STEP", "schema": "AP242", "unit": "mm", "passed": True, "failures": [],
        "limits": {"side_mm": 1e-6, "end_mm": 1e-5, "edge_mm": 1e-6}, "solids": 1, "shells": 1, "free_edges": 0,
        "valid": True, "faces": [face], "edges": {"count": 6, "max_gap_mm": 1e-9, "max_tolerance_mm": 1e-7},
        "kernel_check": [{"fault": "a crooked edge", "count": 3}],
        "volume_mm3": {**pair, "kernel_default": {"cad": 2.5, "relative_error": 0.25}},
        "area_mm2": pair, "centroid_mm": {"distance": 1e-12},
        "design": {"name": design.name, "parameters_hash": parameters_hash(design)},
    }  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def small_sheet():
    """The sheet of pages, which other files ask of, is a small figure here."""
    with pytest.MonkeyPatch.context() as small:
        small.setattr(import_module("bladewright.views.report"), "sheet", lambda *_: round_trip_figure(trip_of(ROTOR)))
        yield


@pytest.fixture(scope="module")
def page():
    return report_page(ROTOR, built(ROTOR), trip_of(ROTOR))


def test_a_report_is_one_whole_page_that_loads_nothing(page):
    read = Page(page)
    assert [tag for tag, _ in read.tags][:4] == ["html", "head", "meta", "title"]
    assert read.loaded
    assert all(address.startswith("data:image/") for address in read.loaded)
    assert not re.search(r"url\(|@import|//", read.styles)
    assert "http" not in re.sub(r"data:[^\"]*", "", page)
    assert read.scene["unit"] == "mm"
    headings = [tag for tag, _ in read.tags].count("h2")
    assert headings == 4
    assert all(word in read.words for word in ("Stations", "Pictures", "Round trip", "Parameters"))


def test_a_report_says_what_the_blade_is(page):
    words = Page(page).words
    blade = built(ROTOR)
    volume, chord = float(blade.properties.volume) * 1e9, blade.report().values("chord")[0]
    for word in (ROTOR.name, ROTOR.description, ROTOR.author, f"{volume:.6g} mm³", f"{chord:.5g}", "rotor.step"):
        assert word in words
    assert parameters_hash(ROTOR) in words
    assert "2.5 mm³, 2.5e-01 off" in words
    assert "a crooked edge (3)" in words
    assert "another state" not in words


def test_a_round_trip_of_another_design_is_said_to_be_one():
    other = trip_of(ROTOR.changed("stagger", 31.0))
    assert "another state of the design" in Page(report_page(ROTOR, built(ROTOR), other)).words
    assert "Round trip" not in Page(report_page(ROTOR, built(ROTOR))).words


def test_a_report_of_a_section_has_no_view_in_space(tmp_path):
    views.report(VANE, tmp_path / "vane.html", built=built(VANE))
    read = Page((tmp_path / "vane.html").read_text(encoding="utf-8"))
    assert not [attrs for _, attrs in read.tags if "data-scene" in attrs]
    assert "maximum thickness" in read.words
    assert [each.name for each in tmp_path.iterdir()] == ["vane.html"]


@pytest.mark.parametrize("name", list(FAMILIES))
def test_every_number_of_a_design_is_among_the_parameters(name):
    rows = dict(parameter_rows(FAMILIES[name]))
    text = " ".join(rows.values())
    for path, value in FAMILIES[name].parameters().items():
        row = re.sub(r"(\[\d+\])+(\.[xr])?", "", path)
        table, _, key = row.rpartition(".")
        assert row in rows or f"{key} = " in rows[table], "a row of its own, or an entry of its inline table"
        assert f"{value:.10g}" in text


@pytest.mark.parametrize(("name", "reason"), [("page.pdf", r"ends in '.pdf': a report"), ("page", "has no ending")])
def test_a_report_of_another_ending_is_refused_before_anything_is_built(name, reason, tmp_path):
    with pytest.raises(FileError, match=reason):
        views.report(None, tmp_path / name)
    assert not list(tmp_path.iterdir())
