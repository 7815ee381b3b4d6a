"""Sharp edges of a cloud end where they do, though the edges of the unified family are round."""

import numpy as np

import bladewright as bw
from bladewright.fitting.model_selection.selection import SHARP_RADIUS
from bladewright.section.profiles.kinds import ProfileSection
from bladewright.section.profiles.naca4 import Naca4

CHORD = 0.08


def test_the_tip_of_a_wedge_is_met_beyond_its_last_points():
    part = Naca4(thickness=0.12, camber=0.02, camber_position=0.4)
    curves = ProfileSection(name="wedge", length_unit="m", chord=CHORD, section=part).build().curves
    u = (np.arange(120) + 0.5) / 120
    cloud = np.concatenate([np.real(curve(u)) for curve in (curves["upper"], curves["lower"])])
    tip = np.real(curves["upper"](np.ones(1)))
    gap = np.min(np.hypot(*(cloud - tip).T))
    assert gap > 1e-3 * CHORD
    found = bw.fit(cloud)
    assert found.design.trailing_edge_radius == SHARP_RADIUS
    assert found.design.leading_edge_radius > 1e-3
    assert any("the points tell the trailing edge from no sharp one" in note for note in found.notes)
    sides = [curve(np.linspace(0.9, 1.0, 2000)) for curve in found.built.curves.values()]
    assert np.min(np.hypot(*(np.concatenate(sides) - tip).T)) < 0.5 * gap
