"""Panels along the chord and the span show what the station table measures; arrows point where the design says."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.views.along_the_blade import camber_line
from bladewright.views.flow_marks import bow


@pytest.mark.parametrize("v", [0.0, 0.5, 1.0])
def test_a_camber_line_begins_and_ends_at_the_metal_angles(blade_drawn, v):
    line, section = camber_line(blade_drawn.built, v), blade_drawn.built.section(v)
    # angles are those of chords between 101 points, drawn only: 0.2 deg at the ends
    assert np.degrees(line.angle[0]) == pytest.approx(np.degrees(section.metal_angle_in), abs=0.2)
    assert np.degrees(line.angle[-1]) == pytest.approx(np.degrees(section.metal_angle_out), abs=0.2)


def test_the_wrap_drawn_is_that_of_the_station_table(blade_drawn):
    table = blade_drawn.built.report([0.5])
    line = camber_line(blade_drawn.built, 0.5)
    wrap = line.tangential[-1] - line.tangential[0]
    assert wrap == pytest.approx(float(np.real(table.wrap[0])), rel=1e-4)


def test_throat_and_pitch_are_drawn_from_hub_to_shroud(blade_drawn):
    panel = blade_drawn.panel("Throat and pitch")
    table = blade_drawn.built.report([0.0, 1.0])
    drawn = {line.get_label(): line.get_xdata() for line in panel.get_lines()}
    ends = np.real(table.throat) * blade_drawn.per_metre
    assert drawn["throat"][[0, -1]] == pytest.approx(ends, rel=1e-9)


def test_the_arrow_of_the_rotation_goes_the_way_the_row_turns(blade_drawn):
    point = np.array([0.01, 0.02, 0.3])
    for turns in (-1, 1):
        way = bow(blade_drawn.built, point, turns)
        if blade_drawn.name == "cascade":
            assert np.sign(way[-1, 1] - way[0, 1]) == turns
        else:
            theta = np.arctan2(way[:, 1], way[:, 2])
            assert (np.sign(np.diff(theta)) == turns).all()


def test_a_row_whose_rotation_is_not_known_has_no_arrow_of_it(blade_drawn):
    standing = replace(blade_drawn.design, rotation="none")
    assert standing.turns == 0
