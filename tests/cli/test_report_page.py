"""`bladewright show --report`: the page, with the round trip beside it or one that is made for it."""

import json

import pytest


@pytest.fixture
def pages(monkeypatch):
    """What the pages that are asked for would hold."""
    from bladewright import views

    asked = []

    def report(design, path, *, built, round_trip, stations):
        asked.append((built.design is design, stations, round_trip))
        path.write_text("page")

    monkeypatch.setattr(views, "report", report)
    return asked


def test_a_report_takes_the_round_trip_beside_the_design_or_the_page(run, vane_file, tmp_path, pages):
    (tmp_path / "out").mkdir()
    page = tmp_path / "out" / "vane.html"
    words = ("show", vane_file, "--report", page)
    assert run(*words, "--json").json["report"] == str(page)
    trip = {"faces": [], "volume_mm3": {}, "limits": {}, "passed": True}
    (tmp_path / "vane.roundtrip.json").write_text(json.dumps(trip))
    assert f"wrote {page}" in run(*words).out
    (page.parent / "vane.roundtrip.json").write_text(json.dumps({**trip, "passed": False}))
    assert run(*words).status == 0
    (page.parent / "vane.roundtrip.json").write_text("{")
    assert run(*words).status == 0
    found = [None if each is None else each["passed"] for _, _, each in pages]
    assert found == [None, True, False, True]


def test_a_round_trip_is_made_where_it_is_asked_for(run, vane_file, tmp_path, pages):
    assert run("show", vane_file, "--report", tmp_path / "vane.html", "--round-trip", "--stations", "0,1").status == 0
    assert pages[0][:2] == (True, (0.0, 1.0))
    assert pages[0][2]["passed"]
    assert sorted(each.name for each in tmp_path.iterdir()) == ["vane.html", "vane.toml"]


def test_a_report_that_cannot_be_is_refused_before_anything_is_built(run, vane_file, tmp_path):
    found = run("show", vane_file, "--report", tmp_path / "vane.pdf")
    assert (found.status, found.err.count("\n")) == (2, 1)
    assert "end its name in .html" in found.err
    found = run("show", vane_file, "--round-trip")
    assert found.status == 2
    assert "--report FILE.html" in found.err


@pytest.mark.slow
def test_show_writes_a_page(run, design_file, tmp_path):
    assert run("show", design_file, "--report", tmp_path / "fan.html").status == 0
    assert (tmp_path / "fan.html").read_text().startswith("<!DOCTYPE html>")
