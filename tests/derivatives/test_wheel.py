"""Derivatives of sectors and wheels: of masses, and of the control points of their faces."""

from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright.blade.design.disc import Disc, Outline
from machines.coarse import ROTOR

OUTLINE = Outline(points=((-8.0, 94.0), (-8.0, 30.0), (97.0, 30.0), (97.0, 118.5)), radii=(5.0, 4.0))
DESIGN = replace(ROTOR, blade_count=5, density=4430.0, disc=Disc(outline=OUTLINE))
STEPS = {
    "density": 1.0,
    "stagger[1]": 1e-3,
    "channel.hub[0].r": 1e-3,
    "disc.outline.points[0].x": 1e-3,
    "disc.outline.points[1].x": 1e-3,
    "disc.outline.radii[1]": 1e-3,
}


@pytest.fixture(scope="module")
def blade():
    return DESIGN.build()


@pytest.fixture(scope="module")
def sector(blade):
    return bw.sector(blade)


def both_sides(blade, path):
    value, step = DESIGN.parameters()[path], STEPS[path]
    return [DESIGN.changed(path, value + sign * step).build(knots=blade.knots) for sign in (-1.0, 1.0)]


def test_the_mass_and_the_moment_of_inertia_of_a_wheel(blade):
    knots = bw.wheel(blade).knots

    def quantity(built):
        wheel = bw.wheel(built, knots=knots)
        return np.append(wheel.mass, wheel.mass_report().inertia_about_axis[0, 0])

    found = bw.sensitivity(DESIGN, quantity, free=list(STEPS), knots=blade.knots)
    for path, step in STEPS.items():
        low, high = (quantity(built) for built in both_sides(blade, path))
        np.testing.assert_allclose(found[path], (high - low) / (2.0 * step), rtol=1e-5, err_msg=path)


def test_the_control_points_of_a_sector(blade, sector):
    paths = ["stagger[1]", "disc.outline.points[1].x", "disc.outline.radii[1]"]
    jacobian = bw.net_jacobian(DESIGN, free=paths, knots=blade.knots, of=bw.sector)
    assert {"blade_upper", "bore", "rim_front", "cyclic_low", "cyclic_high"} <= set(jacobian.shapes)
    for place, path in enumerate(jacobian.paths):
        low, high = (bw.sector(built, knots=sector.knots).surfaces for built in both_sides(blade, path))
        for name, rates in jacobian.nets.items():
            change = (high[name].control_points - low[name].control_points) / (2.0 * STEPS[path])
            np.testing.assert_allclose(rates[place], change, atol=2e-8, err_msg=f"{name} by {path}")


def test_a_pullback_of_a_sector_goes_by_the_disc(blade):
    u, v = np.array([0.3, 0.6]), np.array([0.5, 0.5])
    bar = np.array([[0.0, 0.0, 1.0]] * 2)
    found = bw.pullback(DESIGN, {"bore": (u, v, bar)}, free="disc.outline.points[1].r", knots=blade.knots, of=bw.sector)
    [rate] = found.values()
    # between its rounded corners the bore is a line, of which this raises one end of two
    assert 0.0 < rate < 2e-3
