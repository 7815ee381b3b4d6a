"""Points of hub and shroud beside a blade: told from the blade's own, set aside, and used for where it ends."""

from functools import cache

import numpy as np
import pytest

import bladewright as bw
from bladewright.blade.design.fillet import Fillet
from bladewright.fitting.clouds.walls import walls_of
from bladewright.fitting.fit import fit
from bladewright.fitting.matching.footpoints import nearest_footpoints
from machines import COARSE, built, example

STATOR = example("compressor-stator").changed({"tolerance": COARSE, "hub_clearance": None})
FILLETED = STATOR.changed("hub_fillet", Fillet(radius=1.3))
MACHINES = ("compressor-stator", "radial-turbine", "inlet-guide-vane", "mixed-flow-pump")


def scattered(sides, count, seed=0):
    random = np.random.default_rng(seed)
    u = (1.0 - np.cos(np.pi * random.random((len(sides), count)))) / 2.0
    return np.concatenate([side(each, random.random(count)) for side, each in zip(sides, u, strict=True)])


def in_rows(sides, along=80, across=21):
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, along))) / 2.0
    u, v = (each.ravel() for each in np.meshgrid(u, np.linspace(0.0, 1.0, across)))
    return np.concatenate([side(u, v) for side in sides])


@cache
def hub(blade, count, clear=0.0):
    """Points of the hub within 0.4 chords of a blade, no nearer to its sides than is said, in chords."""
    random, chord = np.random.default_rng(1), float(blade.chord)
    x, r = blade.plain.exact.wall("hub").values(random.uniform(-0.05, 1.05, 8 * count)).T
    row = np.concatenate([side(np.linspace(0.0, 1.0, 50), np.zeros(50)) for side in blade.plain.sides])
    order = np.argsort(row[:, 0])
    middle = np.interp(x, row[order, 0], np.arctan2(row[order, 1], row[order, 2]))
    angle = middle + random.uniform(-0.4, 0.4, len(x)) * chord / np.median(r)
    points = np.stack([x, r * np.sin(angle), r * np.cos(angle)], axis=-1)
    return points[nearest_footpoints(points, blade.plain.sides).heights > clear * chord][:count]


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("cloud", [scattered, in_rows])
def test_no_point_of_a_blade_alone_is_on_a_wall(name, cloud):
    sides = built(example(name).plain).sides
    points = cloud(sides, 2000 if cloud is scattered else 80)
    points += 1e-4 * float(np.ptp(points[:, 0])) * np.random.default_rng(2).normal(size=points.shape)
    assert not np.any(walls_of(points, None).kinds != "")


@pytest.mark.parametrize("angle", [30.0, *(pytest.param(angle, marks=pytest.mark.slow) for angle in (60.0, 90.0))])
@pytest.mark.parametrize("cloud", [scattered, in_rows])
@pytest.mark.parametrize("name", ["booster-stator", "compressor-stator"])
def test_no_point_of_a_blade_at_the_side_of_the_axis_is_on_a_wall(name, cloud, angle):
    # a cascade is tried too, in which it is seen along its span
    x, y, z = cloud(built(example(name).plain).sides, 2500 if cloud is scattered else 80).T
    cosine, sine = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turned = np.stack([x, cosine * y + sine * z, cosine * z - sine * y], axis=-1)
    assert not np.any(walls_of(turned, None).kinds != "")


def test_a_side_seen_along_the_span_that_goes_past_a_thicker_end_on_one_side_is_no_wall():
    chord, span = np.random.default_rng(0).random((2, 3000))
    side = np.arange(3000) < 1500
    points = np.stack([chord, span, np.where(side, 0.0, 0.05 + 0.3 * span)], axis=-1)
    assert not np.any(walls_of(points, "linear").kinds != "")


@pytest.mark.parametrize("name", ["compressor-stator", pytest.param("inlet-guide-vane", marks=pytest.mark.slow)])
def test_the_points_of_a_hub_are_told(name):
    blade = built(example(name).changed({"hub_clearance": None}).plain)
    sides, beside = scattered(blade.sides, 1500), hub(blade, 1000)
    walls = walls_of(np.concatenate([sides, beside]), None)
    assert np.mean(walls.kinds[len(sides) :] == "wall") > 0.99
    # the blade's own points at its end stand on the wall too
    assert np.count_nonzero(walls.kinds[: len(sides)]) < 10
    assert len(walls.places) == 1


def test_the_points_of_a_fillet_above_a_wall_are_told():
    blade = built(FILLETED)
    sides = scattered(blade.sides, 1500)
    fillet = scattered([blade.surfaces[f"hub_fillet_{side}"] for side in ("upper", "lower")], 150)
    kinds = walls_of(np.concatenate([sides, fillet, hub(blade, 1000, clear=0.04)]), "annular").kinds
    told = np.split(kinds, [len(sides), len(sides) + len(fillet)])
    assert np.mean(told[1] != "") > 0.99
    assert np.mean(told[0] != "") < 0.01
    assert np.mean(told[2] == "wall") > 0.98


def test_a_blade_with_its_hub_is_matched_by_its_sides_and_ends_on_the_hub():
    blade = built(STATOR)
    points = np.concatenate([scattered(blade.sides, 200), hub(blade, 200)])
    walls = {
        path: value
        for path, value in STATOR.parameters().items()
        if path.startswith("channel.") and path.endswith("[0].r")
    }
    start = STATOR.changed(
        {path: value + 1.5 for path, value in walls.items()} | {"stagger[1]": STATOR.stagger[1] + 0.5}
    )
    found = fit(points, start, free=["stagger*", *walls])
    assert isinstance(found.design, bw.UnifiedBlade)
    assert found.passed
    assert found.by_kind_set_aside["hub"].count > 195
    assert found.maximum < 1e-6 * found.chord
    assert found.design.parameters() == pytest.approx(STATOR.parameters(), abs=1e-4)
