"""Matching keeps the stations of laws given by values: the values are the variables."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.fitting.model_selection.structure import reshaped, rich_structure, structure_of
from bladewright.section.laws import law_points, named_laws, stations_of
from machines import built
from machines.stations import AXIAL, SPAN, TABLE, at_stations, moved

U, V = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 17))) / 2.0, np.linspace(0.0, 1.0, 7)


def cloud(design):
    sides = built(design).surfaces
    return np.concatenate([sides[name](U[:, None], V).reshape(-1, 3) for name in ("upper", "lower")])


def test_a_match_finds_the_values_at_the_stations_of_its_start():
    start = AXIAL["unified"]
    truth = start.changed("metal_angle_out", moved(TABLE, lambda value: value + np.sin(value)))
    fit = bw.fit(cloud(truth), start=start, free="metal_angle_out*")
    assert fit.design.metal_angle_out.span == TABLE.span
    assert fit.design.metal_angle_out.values == pytest.approx(truth.metal_angle_out.values, abs=1e-7)
    assert fit.maximum < 1e-10


def test_a_structure_keeps_stations():
    design = at_stations(AXIAL["unified"], "monotone")
    structure = structure_of(design)
    assert reshaped(design, structure) == design
    # with more control points of the thickness along the chord these are given at the same stations
    wider = reshaped(design, structure.resized("thickness_upper", (5, 1)).resized("thickness_lower", (4, 1)))
    assert [(law.span, law.interpolation) for law in wider.thickness_upper] == [(SPAN, "monotone")] * 5


def test_a_like_design_says_which_laws_are_given_at_stations():
    plain = AXIAL["unified"].changed({"metal_angle_out": (-8.0, -30.0, -48.0), "stagger": (6.0, -14.0)})
    found = reshaped(plain, structure_of(AXIAL["unified"]))
    assert (found.metal_angle_out.span, found.stagger.span) == (TABLE.span, TABLE.span)
    assert stations_of(found.metal_angle_in) is None
    plain = AXIAL["profile"].changed("section.stagger_angle", (-8.0, -30.0, -48.0))
    part = reshaped(plain, structure_of(AXIAL["profile"])).section
    assert part.stagger_angle.values == pytest.approx([-8.0, -18.75, -29.0, -38.75, -48.0], abs=1e-12)
    assert part.thickness == plain.section.thickness


def test_a_law_at_stations_keeps_them_where_other_laws_get_control_points():
    design = AXIAL["profile"]
    wider = reshaped(design, rich_structure(design, design.parameters(), 10_000))
    assert dict(named_laws(wider.section))["stagger_angle"] == TABLE
    assert len(wider.section.thickness) > len(law_points(design.section.thickness))
