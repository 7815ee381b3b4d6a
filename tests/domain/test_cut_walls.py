"""Passages of blades whose ends are cut: the cuts are hub and shroud, and the share of the ring is filled."""

import numpy as np
import pytest

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.cut import AtRadius, AtX, Cut
from bladewright.blade.design.fillet import Fillet
from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.errors import DesignError
from machines import built, coarse

HUB = ThroughPoints(points=((-120.0, 122.0), (40.0, 124.0), (220.0, 132.0)))
TIP = ThroughPoints(points=((-120.0, 228.0), (40.0, 226.0), (220.0, 222.0)))
CUT = {
    "both ends and the trailing edge": coarse.ROTOR.changed("cut", Cut(hub=HUB, tip=TIP, trailing_edge=AtX(x=68.0))),
    "a tip with its clearance": coarse.CLEARED.changed("cut", Cut(tip=TIP)),
    "a tip beside a fillet": coarse.ROTOR.changed({"cut": Cut(tip=TIP), "hub_fillet": Fillet(radius=2.0)}),
    "a cascade": coarse.CASCADE.changed("cut", Cut(hub=AtRadius(radius=10.0), tip=AtRadius(radius=70.0))),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name == "a tip with its clearance" else []) for name in CUT]
)
def test_passage_and_blade_fill_the_ring_between_cuts(name):
    design = CUT[name]
    passage = bw.passage(built(design))
    assert abs(passage.ring_error) < 1e-8
    assert passage.wall_error < 1e-7
    wall = passage.surfaces["shroud"]
    points = wall(*wall.interior_points(30))
    if design.arrangement == "linear":
        assert np.max(np.abs(points[:, 2] - 0.07)) < 1e-12
    else:
        t = np.linspace(0.0, 1.0, 20001)
        r = np.hypot(points[:, 1], points[:, 2])
        on = np.stack([points[:, 0], r], axis=-1)[:, None] - TIP.line(1e-3).curve()(t)
        inside = (points[:, 0] > -0.12) & (points[:, 0] < 0.22)
        assert np.max(np.min(np.linalg.norm(on, axis=-1), axis=1)[inside]) < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("name", list(CUT))
def test_a_passage_between_cuts_survives_its_files(name, tmp_path):
    trip = cad.write(bw.passage(built(CUT[name])), tmp_path / "passage.step", samples=400)
    assert trip.passed, trip.failures


def test_a_cut_that_leaves_the_duct_is_refused_as_a_wall():
    steep = ThroughPoints(points=((0.0, 120.0), (80.0, 232.0)))
    with pytest.raises(DesignError, match=r"cut.hub: it is the hub of the passage"):
        bw.passage(built(coarse.ROTOR.changed("cut", Cut(hub=steep))))
