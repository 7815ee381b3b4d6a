"""Rows: one blade and its placements, a pitch apart, with the mass of all of them."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.errors import DesignError
from bladewright.nurbs.mass_properties import mass_properties
from machines.coarse import CASCADE, ROTOR


@pytest.fixture(scope="module")
def rotor():
    return ROTOR.changed("density", 4430.0).build()


@pytest.fixture(scope="module")
def cascade():
    return CASCADE.build()


def test_a_row_has_all_blades_of_the_design_a_pitch_apart(rotor):
    row = bw.row(rotor)
    assert [place.name for place in row.placements] == [f"blade_{k:02d}" for k in range(1, 18)]
    for k, name in enumerate(("blade_01", "blade_02", "blade_17")):
        number = (0, 1, 16)[k]
        points = row.surfaces[f"{name}_upper"](0.3, [0.0, 0.4, 1.0])
        own = rotor.surfaces["upper"](0.3, [0.0, 0.4, 1.0])
        theta = np.arctan2(points[:, 1], points[:, 2]) - np.arctan2(own[:, 1], own[:, 2])
        away = np.exp(1j * (theta - 2.0 * np.pi * number / 17)) - 1.0
        np.testing.assert_allclose(away, 0.0, atol=1e-13)
        np.testing.assert_allclose(points[:, 0], own[:, 0], rtol=0, atol=0)


def test_a_cascade_takes_the_number_of_blades_and_shifts_them_along_y(cascade):
    row = bw.row(cascade, 3)
    pitch = CASCADE.pitch * 1e-3
    shift = row.surfaces["blade_03_lower"](0.5, 0.5) - cascade.surfaces["lower"](0.5, 0.5)
    np.testing.assert_allclose(shift, [0.0, 2.0 * pitch, 0.0], atol=1e-16)


def test_a_cascade_without_a_number_and_too_many_blades_are_refused(rotor, cascade):
    with pytest.raises(DesignError, match="has no end: say how many blades"):
        bw.row(cascade)
    with pytest.raises(DesignError, match="blades is 18: a row has a whole number of blades"):
        bw.row(rotor, 18)


@pytest.mark.parametrize("blades", [1, 3])
def test_properties_of_a_row_are_those_of_all_its_surfaces(rotor, blades):
    row = bw.row(rotor, blades)
    found = row.properties
    naive = mass_properties([(row.surfaces[name], sign) for name, sign in row.orientations.items()])
    size = rotor.properties.volume
    np.testing.assert_allclose(found.volume, naive.volume, rtol=1e-7)
    np.testing.assert_allclose(found.centroid, naive.centroid, atol=1e-7)
    np.testing.assert_allclose(found.inertia, naive.inertia, atol=1e-7 * size * blades * 0.2**2)
    np.testing.assert_allclose(found.area, blades * rotor.properties.area, rtol=1e-14)


def test_a_whole_row_is_balanced(rotor):
    report = bw.row(rotor).mass_report()
    np.testing.assert_allclose(report.centre[1:], 0.0, atol=1e-15)
    np.testing.assert_allclose(report.inertia_about_axis[0, 1:], 0.0, atol=1e-13 * report.inertia_about_axis[0, 0])
    np.testing.assert_allclose(report.mass, 17 * rotor.mass, rtol=1e-14)
    np.testing.assert_allclose(report.inertia_about_axis[0, 0], 17 * rotor.mass_report().inertia_about_axis[0, 0])


def test_the_mass_of_a_row_has_derivatives(rotor):
    design = rotor.design
    paths = ["density", "stagger[1]", "channel.hub[0].r"]

    def quantity(blade):
        report = bw.row(blade).mass_report()
        return np.append(report.mass, report.inertia_about_axis[0, 0])

    found = bw.sensitivity(design, quantity, free=paths, knots=rotor.knots)
    report = bw.row(rotor).mass_report()
    own = np.append(report.mass, report.inertia_about_axis[0, 0])
    np.testing.assert_allclose(found["density"], own / 4430.0, rtol=1e-12)
    for path in paths[1:]:
        step = 1e-3
        ends = [
            quantity(design.changed(path, design.parameters()[path] + sign * step).build(knots=rotor.knots))
            for sign in (-1, 1)
        ]
        np.testing.assert_allclose(found[path], (ends[1] - ends[0]) / (2.0 * step), rtol=1e-5)


def test_a_mass_without_a_density_is_refused(cascade):
    with pytest.raises(DesignError, match="density is missing: the mass of 'cascade' needs that of the metal"):
        _ = cascade.mass
