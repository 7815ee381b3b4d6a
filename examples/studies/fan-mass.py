"""The lightest fan blade of given throat, chord, thickness and stacking, by exact derivatives, and its STEP file."""

import sys
from importlib import resources
from pathlib import Path

import numpy as np

import bladewright as bw
from bladewright import cad
from bladewright.numerics.elementary import angle, degrees, length
from bladewright.views.optimum import draw_optimum

SPANS = np.linspace(0.0, 1.0, 5)
"""hub to tip: where chord, thickness and stacking are kept"""
ALONG = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
LEAST = np.outer([1.5, 3.2, 3.8, 3.2, 1.5], 1.0 - 0.68 * SPANS)
"""thickness [mm] at those places along the chord, falling to a third of itself at the tip"""
LEAN, SWEEP = 0.5, 3.0
"""how far the middle of a section's skin may lie from the hub section's, around the axis [deg] and along it [mm]"""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


def spare(blade):
    """Distance (25,) of both sides at the same part of the chord, less what is needed [mm]."""
    upper, lower = (side.grid(ALONG, SPANS) for side in blade.sides)
    return 1e3 * length(upper - lower).ravel() - LEAST.ravel()


def chords(blade):
    """Straight distance (5,) from leading to trailing edge [mm]."""
    upper = blade.surfaces["upper"]
    return 1e3 * length(upper(1.0, SPANS) - upper(0.0, SPANS))


def stacking(blade):
    """Lean and sweep (8,) of the sections against the hub section, in units of what is allowed."""
    skin = sum(side.grid((NODES + 1.0) / 2.0, SPANS) for side in blade.sides) / 2.0
    x, y, z = np.tensordot(WEIGHTS / 2.0, skin, axes=(0, 0)).T
    lean, sweep = degrees(angle(y, z)), 1e3 * x
    return np.concatenate([(lean - lean[0])[1:] / LEAN, (sweep - sweep[0])[1:] / SWEEP])


def main():
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path.cwd()
    directory.mkdir(parents=True, exist_ok=True)
    with resources.as_file(resources.files("bladewright") / "examples" / "fan-rotor.toml") as path:
        fan = bw.read_design(path)
    # titanium; a lean law of three control points; coarse surfaces for the search
    start = fan.changed(
        {"name": "lightest-fan", "density": 4430.0, "leading_edge_theta": (0.0,) * 3, "tolerance": 1e-5}
    )
    found = bw.optimise(
        start,
        {
            "thickness*": {"lower": 0.004, "upper": 0.08},
            "leading_edge_theta*": {"lower": -8.0, "upper": 8.0},
            "stagger*": {"lower": -1.5, "upper": 1.5, "offset": True},
            "channel.*_edge[1].x": {"lower": -10.0, "upper": 10.0, "offset": True},
            "channel.leading_edge[2].x": {"lower": -10.0, "upper": 10.0, "offset": True},
        },
        "mass",
        [
            {"quantity": "throat_area", "lower": 1.0, "upper": 1.0, "relative": True},
            {"quantity": chords, "lower": 1.0, "upper": 1.0, "relative": True},
            {"quantity": spare, "lower": 0.0},
            {"quantity": stacking, "lower": -1.0, "upper": 1.0},
        ],
    )
    print(found)
    draw_optimum(found, directory / "fan-mass.png")
    # the accepted design at the tolerance of its CAD file
    best = found.design.changed("tolerance", 1e-6).build()
    bw.write_design(best.design, directory / "lightest-fan.toml")
    trip = cad.write(best, directory / "lightest-fan.step")
    print(trip)

    assert found.passed, found.failures
    assert trip.passed, trip.failures
    assert found.figures["mass"] < 0.9 * found.start_figures["mass"]
    areas = [bw.throat(each.build()).area for each in (start.changed("tolerance", 1e-6), best.design)]
    assert abs(areas[1] / areas[0] - 1.0) < 2e-4  # what the coarse surfaces miss
    assert spare(best).min() > -5e-3


if __name__ == "__main__":
    main()
