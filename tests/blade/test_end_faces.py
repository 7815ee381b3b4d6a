"""Blades continued past their walls: caps that close them, whatever their edges."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright import cad
from bladewright.blade.native.end_faces import WallSurface, followed
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.refine import inserted
from bladewright.section.profiles.flat_plate import FlatPlate
from machines.sectioned import DIFFUSER, VANE

COARSE = 1e-4
"""tolerance of the blades, of the chord: what caps keep does not depend on it"""
FORMS = {
    "round and round": VANE,
    "blunt and blunt": replace(VANE, section=FlatPlate(thickness=0.1, leading_edge="blunt", trailing_edge="blunt")),
    "round and blunt": replace(VANE, section=FlatPlate(thickness=0.1, trailing_edge="blunt", stagger_angle=20.0)),
    "round and back face": DIFFUSER,
}


@pytest.fixture(params=list(FORMS), scope="module")
def blade(request):
    return FORMS[request.param].changed("tolerance", COARSE).build()


@pytest.mark.parametrize(
    "blade",
    [pytest.param(name, marks=pytest.mark.slow if name == "round and back face" else ()) for name in FORMS],
    indirect=True,
    scope="module",
)
def test_a_blade_past_its_walls_is_a_closed_solid_whatever_its_edges(blade, tmp_path):
    longer = blade.extended(0.1)
    assert set(longer.surfaces) == set(blade.surfaces)
    trip = cad.write(longer, tmp_path / "longer.step", samples=400)
    assert trip.passed, trip.failures
    assert longer.properties.openness < 1e-13


def test_its_sides_and_faces_go_on_as_they_were(blade):
    longer, at = blade.extended(0.1), np.linspace(0.0, 1.0, 9)
    for name in set(blade.surfaces) - {"hub", "shroud"}:
        before, after = (body.surfaces[name] for body in (blade, longer))
        miss = after.grid(at, (0.1 + at) / 1.2) - before.grid(at, at)
        assert np.max(np.abs(miss)) < 1e-12 * blade.chord


def test_a_cap_never_turns_over(blade):
    """The caps of blades whose sections are convex; along a degenerate edge a normal has no direction."""
    at = np.linspace(0.01, 0.99, 41)
    for name in ("hub", "shroud"):
        normals = blade.extended(0.1).surfaces[name].normal(at[:, None], at)
        assert np.min(normals @ normals[20, 20]) > 0.99


def test_an_end_is_followed_past_knots_that_differ_by_their_rounding():
    line = Curve(control_points=np.array([[0.0, 0.2], [0.1, 0.2]]), knots=np.array([0.0, 0.0, 1.0, 1.0]), degree=1)
    wall = WallSurface(meridian=line, inner=np.empty(0), revolved=False, low=-0.1, high=0.1)
    x = np.linspace(0.0, 0.1, 6)
    points = np.stack([x, 4.0 * x * (0.1 - x), np.full(6, 0.2)], axis=-1)
    plain = Curve(control_points=points, knots=np.repeat([0.0, 1.0], 6), degree=5)
    end = inserted(plain, [0.58] * 4 + [float(np.nextafter(0.58, 1.0))])
    places = np.linspace(0.0, 1.0, 11)
    near = places, places, np.real(plain(places))[:, 1]
    found = followed(wall, end, near, 0.1)
    t = np.linspace(0.0, 1.0, 101)
    assert np.real(wall.surface(*found(t).T)) == pytest.approx(np.real(plain(t)), abs=1e-12)
