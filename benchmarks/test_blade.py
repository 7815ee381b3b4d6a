"""From design to measured CAD files, and how fast the package starts."""

import subprocess
import sys
import time

import pytest

import bladewright as bw
from bladewright.files.examples import example_text


@pytest.fixture(scope="module")
def design(tmp_path_factory):
    path = tmp_path_factory.mktemp("design") / "nasa-rotor-67.toml"
    path.write_text(example_text("nasa-rotor-67"), encoding="utf-8")
    return bw.read_design(path)


def judged(benchmark, what, reach):
    best = benchmark.stats.stats.min
    benchmark.extra_info.update(to_reach=reach)
    print(f"\n{what}: {best:.3f} s, to reach {reach:g} s")
    assert best <= reach


def test_a_native_blade_at_given_knots(benchmark, design):
    knots = design.build().knots
    benchmark.pedantic(design.build, kwargs={"knots": knots}, rounds=15, warmup_rounds=3)
    judged(benchmark, f"native Rotor 67 at given knots, {knots.poles[0]} x {knots.poles[1]} poles a side", 0.040)


def test_a_native_blade_with_refinement_and_its_error_check(benchmark, design):
    benchmark.pedantic(design.build, rounds=9, warmup_rounds=2)
    judged(benchmark, "native Rotor 67 with refinement and error check", 0.150)


def test_a_solid_written_as_step_and_iges_and_both_measured(benchmark, design, tmp_path):
    from bladewright import cad

    blade = design.build()
    assert blade.properties.volume > 0.0

    def round_trip():
        trips = [cad.write(blade, tmp_path / f"blade.{suffix}") for suffix in ("step", "igs")]
        assert all(trip.passed for trip in trips)

    benchmark.pedantic(round_trip, rounds=4, warmup_rounds=1)
    judged(benchmark, "solid, STEP and IGES, both reopened and measured at 10,000 points a face", 2.0)


@pytest.mark.parametrize(
    ("what", "words", "reach"),
    [
        ("import bladewright", ["-c", "import bladewright"], 0.2),
        ("bladewright --help", ["-m", "bladewright", "--help"], 0.5),
    ],
)
def test_starting(what, words, reach):
    def seconds(arguments):
        start = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
        return time.perf_counter() - start

    bare = min(seconds(["-c", "pass"]) for _ in range(7))
    whole = min(seconds(words) for _ in range(7))
    spent = whole - bare if "import" in what else whole
    print(f"\n{what}: {spent:.3f} s ({bare:.3f} s of Python alone), to reach {reach:g} s")
    assert spent <= reach
