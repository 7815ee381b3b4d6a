"""From a blade to what is made of its row: a fillet, the closed solid of a wheel, measured CAD files."""

import time
from importlib import resources

import numpy as np
import pytest

import bladewright as bw

OUTLINE = bw.Outline(
    points=((-7.0, 94.71), (-7.0, 80.0), (12.0, 40.0), (12.0, 32.0), (78.0, 32.0), (78.0, 40.0), (97.5, 100.0),
            (97.5, 118.37)),
    radii=(4.0, 6.0, 2.0, 2.0, 6.0, 4.0),
)  # fmt: skip
"""of a disc under NASA Rotor 67 [mm]"""


@pytest.fixture(scope="module")
def design():
    return bw.read_design(resources.files("bladewright") / "examples" / "nasa-rotor-67.toml")


@pytest.fixture(scope="module")
def filleted(design):
    return design.changed({"hub_fillet": bw.Fillet(radius=2.0), "disc": bw.Disc(outline=OUTLINE)})


def seconds(work, times=1):
    """Least seconds of the processor that the work takes, and what it gives."""
    spent = []
    for _ in range(times):
        start = time.process_time()
        found = work()
        spent.append(time.process_time() - start)
    return float(np.min(spent)), found


def test_a_fillet_adds_at_most_three_tenths_of_a_second_to_a_build(design, filleted):
    plain, _ = seconds(design.build, 5)
    whole, _ = seconds(filleted.build, 5)
    print(f"\nblade {plain:.2f} s, with a fillet {whole:.2f} s")
    assert whole - plain <= 0.3


def test_a_wheel_becomes_a_solid_in_five_seconds_and_a_measured_file_in_thirty(filleted, tmp_path):
    from bladewright import cad

    built, blade = seconds(filleted.build)
    native, wheel = seconds(lambda: bw.wheel(blade))
    solid, _ = seconds(lambda: cad.solid(wheel))
    both, trip = seconds(lambda: cad.write(wheel, tmp_path / "wheel.step"))
    assert trip.passed, trip.failures
    print(f"\nblade {built:.1f} s, faces {native:.1f} s, solid {solid:.1f} s; file and round trip {both:.1f} s")
    assert built + native + solid <= 5.0
    assert built + native + both <= 30.0


def test_a_row_takes_at_most_twice_as_long_as_its_blade(design, tmp_path):
    from bladewright import cad

    blade = design.build()
    row = bw.row(blade)
    alone, trip = seconds(lambda: cad.write(blade, tmp_path / "blade.step"), 2)
    together, trips = seconds(lambda: cad.write(row, tmp_path / "row.step"), 2)
    assert trip.passed
    assert trips.passed
    sizes = [(tmp_path / f"{name}.step").stat().st_size for name in ("blade", "row")]
    print(f"\nblade {alone:.2f} s, row of {len(row.placements)} {together:.2f} s, file {sizes[1] / sizes[0]:.2f} times")
    assert together <= 2.0 * alone
    assert sizes[1] <= 1.2 * sizes[0]
