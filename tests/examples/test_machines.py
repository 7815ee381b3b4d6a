"""The built-in machines: every one can be built, keeps its promises, and is the machine that its file says."""

import numpy as np
import pytest

from bladewright.blade.design.families import prismatic
from bladewright.files.examples import examples
from machines import built, example

NAMES = sorted(examples())
REAL = ("aachen-stator", "morphing-airfoil", "nasa-rotor-67", "radial-turbine", "vki-ls89")
OWN = tuple(name for name in NAMES if name not in REAL)


def blade(name):
    found = example(name)
    return built(prismatic(found) if found.dimension == 2 else found)


def edges(name, v):
    """x, r and theta of the leading and of the trailing edge at v."""
    found = []
    for u in (0.0, 1.0):
        x, y, z = np.moveaxis(blade(name).surfaces["upper"](u, v), -1, 0)
        found.append((x, np.hypot(y, z), np.arctan2(y, z)))
    return found


def relative_flow(radius, *, turns_per_second, meridional):
    """Angle [deg] of an inflow without swirl, seen from a blade that turns towards +theta."""
    return -np.degrees(np.arctan(2.0 * np.pi * turns_per_second * radius / meridional))


@pytest.mark.parametrize("name", NAMES)
def test_every_machine_keeps_every_promise(name):
    promises = blade(name).conformance
    assert promises.kept, promises


@pytest.mark.parametrize("name", NAMES)
def test_every_machine_holds_the_default_tolerance_with_a_moderate_number_of_poles(name):
    columns, rows = blade(name).plain.knots.poles
    assert blade(name).design.tolerance <= 1e-6
    # a STEP file takes about 105 bytes a pole and two sides: half a megabyte
    assert columns * rows * 2 * 105 < 5e5


@pytest.mark.parametrize("name", NAMES)
def test_every_machine_is_named_as_its_file_and_described_in_a_line(name):
    assert example(name).name == name
    assert len(example(name).description) > 20


@pytest.mark.parametrize("name", OWN)
def test_a_machine_of_our_own_says_so(name):
    assert "not a real one" in example(name).description


def test_the_propeller_stands_on_its_pitch_axis():
    (x_in, radius, theta_in), (x_out, _, theta_out) = edges("propeller", np.linspace(0.0, 1.0, 41))
    chord = np.hypot(x_out - x_in, radius * (theta_out - theta_in))
    # 40 % of the chord at x = 0 and theta = 0: its control points are rounded to half a millimetre and to 0.01 deg
    assert np.max(np.abs(0.6 * x_in + 0.4 * x_out)) < 1.5e-3
    assert np.max(np.abs(radius * (0.6 * theta_in + 0.4 * theta_out))) < 0.02 * np.max(chord)


def test_the_propeller_tapers_to_a_thin_tip():
    sections = [blade("propeller").section(v) for v in (0.0, 0.5, 1.0)]
    share = [section.maximum_thickness[0] / section.chord for section in sections]
    assert share[0] > share[1] > share[2]
    assert share[2] == pytest.approx(0.06, abs=0.01)
    assert sections[2].chord < 0.4 * sections[1].chord


def test_the_propeller_meets_the_air_at_a_small_positive_angle_everywhere():
    v = np.linspace(0.0, 1.0, 21)
    (x_in, radius, theta_in), (x_out, _, theta_out) = edges("propeller", v)
    chord_line = np.degrees(np.arctan2(radius * (theta_out - theta_in), x_out - x_in))
    attack = chord_line - relative_flow(radius, turns_per_second=40.0, meridional=66.0)
    # between no lift and the stall of a section of 2 to 3 % camber
    assert np.all((attack > 1.0) & (attack < 6.0))


def test_the_impeller_turns_from_axial_to_radial_and_its_trailing_edge_is_not_leaned():
    v = np.linspace(0.0, 1.0, 21)
    (_, radius_in, _), (_, radius_out, theta_out) = edges("centrifugal-impeller", v)
    lines = blade("centrifugal-impeller").exact.sections(v).lines
    slope = lines.position(np.array([0.0, 1.0]), 1)
    climb = np.degrees(np.arctan2(slope[..., 1], slope[..., 0]))
    # the clearance falls by 0.1 mm, and at both ends the shroud moves on by 80 mm a unit of u, the tip by within 2 %
    slope = np.degrees(np.arctan(0.1 / 80.0))
    assert climb[0] == pytest.approx([0.0, 90.0], abs=1e-9)
    assert climb[-1] == pytest.approx([slope, 90.0 + slope], abs=0.03 * slope)
    assert np.all(np.diff(climb, axis=0) > 0.0)
    assert radius_out == pytest.approx(np.full(21, 0.1), abs=1e-8)
    assert np.all(radius_in < radius_out)
    # the staggers are rounded to 0.1 deg, which on the hub's m' of 2.9 is 0.3 deg
    assert np.ptp(np.degrees(theta_out)) < 0.5


@pytest.mark.parametrize(
    ("name", "turns_per_second", "meridional", "incidence"),
    [("centrifugal-impeller", 520.0 / (2.0 * np.pi * 0.1), 150.0, 3.0), ("mixed-flow-pump", 1450.0 / 60.0, 3.6, 3.0)],
)
def test_a_wheel_meets_the_flow_that_its_file_states(name, turns_per_second, meridional, incidence):
    v = np.linspace(0.0, 1.0, 21)
    (_, radius, _), _ = edges(name, v)
    metal = np.degrees(np.real(blade(name).exact.sections(v).metal_angles[0]))
    flow = relative_flow(radius, turns_per_second=turns_per_second, meridional=meridional)
    # the flow comes at a larger angle than the metal, by no more than such a wheel bears
    assert np.all((metal - flow > 0.0) & (metal - flow < incidence))


def test_the_pump_leaves_at_about_45_deg_and_raises_the_angular_momentum():
    v = np.linspace(0.0, 1.0, 21)
    stations = blade("mixed-flow-pump").exact.sections(v)
    slope = stations.lines.position(np.array([1.0]), 1)[:, 0]
    assert np.degrees(np.arctan2(slope[:, 1], slope[:, 0])) == pytest.approx(np.full(21, 45.0), abs=4.0)
    (_, radius_in, _), (_, radius_out, _) = edges("mixed-flow-pump", v)
    assert np.all(radius_out > 1.3 * radius_in)
    # the blade turns the relative flow towards the meridional direction
    assert np.all(np.real(stations.metal_angles[1]) > np.real(stations.metal_angles[0]))


def test_the_stator_takes_the_swirl_of_the_rotor_before_it_and_hangs_from_the_casing():
    v = np.linspace(0.0, 1.0, 21)
    stations = blade("compressor-stator").exact.sections(v)
    (_, radius, _), (_, _, _) = edges("compressor-stator", v)
    flow = np.degrees(np.arctan(0.95 * 206e-3 / radius))
    incidence = flow - np.degrees(np.real(stations.metal_angles[0]))
    assert np.all((incidence > 0.5) & (incidence < 2.0))
    assert blade("compressor-stator").design.ends == ("tip", "shroud")
    height = radius[-1] - 182e-3
    assert radius[0] - 182e-3 == pytest.approx(0.01 * height, rel=0.1)


@pytest.mark.parametrize(("name", "share"), [("fan-rotor", 0.005), ("centrifugal-impeller", 0.03)])
def test_a_wheel_without_a_shroud_stands_off_it_by_a_small_part_of_its_height(name, share):
    exact = blade(name).exact
    places = np.array([0.0, 1.0])
    hub, shroud = (exact.full_channel.curve(wall)(places) for wall in ("hub", "shroud"))
    clearance = exact.clearance.distance(places)
    assert np.all(clearance < share * np.linalg.norm(shroud - hub, axis=-1))
    assert "tip" in blade(name).surfaces
