"""The lightest fan blade of given chord, thickness and stacking: minimum volume by SLSQP with exact gradients."""

import time

import numpy as np
from _change import example, export
from scipy.optimize import NonlinearConstraint, minimize

import bladewright as bw
from bladewright.numerics.elementary import angle, degrees, length

SPANS = np.linspace(0.0, 1.0, 5)
"""hub to tip: where chord, thickness and stacking are held"""
ALONG = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
LEAST = np.outer([1.5, 3.2, 3.8, 3.2, 1.5], 1.0 - 0.68 * SPANS)
"""thickness [mm] at those places along the chord, falling to a third of itself at the tip"""
LEAN, SWEEP = 0.5, 3.0
"""how far a section's centroid may lie from the hub section's, around the axis [deg] and along it [mm]"""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


def volume(blade):
    """In cm3."""
    return 1e6 * blade.properties.volume


def chords(blade):
    """Straight distance (5,) from leading to trailing edge [mm]."""
    return 1e3 * length(blade.surfaces["upper"](1.0, SPANS) - blade.surfaces["upper"](0.0, SPANS))


def thicknesses(blade):
    """Distance (25,) of both sides at the same part of the chord [mm]."""
    upper, lower = (side.grid(ALONG, SPANS) for side in blade.sides)
    return 1e3 * length(upper - lower).ravel()


def stacking(blade):
    """Lean [deg] and sweep [mm] (8,) of the sections' skins against the hub section's, in units of what is allowed."""
    skin = sum(side.grid((NODES + 1.0) / 2.0, SPANS) for side in blade.sides) / 2.0
    x, y, z = np.tensordot(WEIGHTS / 2.0, skin, axes=(0, 0)).T
    lean, sweep = degrees(angle(y, z)), 1e3 * x
    return np.concatenate([(lean - lean[0])[1:] / LEAN, (sweep - sweep[0])[1:] / SWEEP])


started = time.perf_counter()
# a coarse blade to search on; a lean law of three control points instead of one number
start = example("fan-rotor").changed({"name": "lightest-fan", "tolerance": 1e-4, "leading_edge_theta": (0.0, 0.0, 0.0)})
space = bw.variables(
    start,
    free=["thickness*", "leading_edge_theta*", "stagger*", "channel.*_edge[1].x", "channel.leading_edge[2].x"],
    bounds={"thickness*": (0.004, 0.08)},
    changes={"leading_edge_theta*": (-8.0, 8.0), "stagger*": (-1.5, 1.5), "channel*": (-10.0, 10.0)},
)
mass, chord, thick, stacked = (space.objective(quantity) for quantity in (volume, chords, thicknesses, stacking))
given = chord.value(space.x0)
found = minimize(
    mass.value,
    space.x0,
    jac=mass.jacobian,
    bounds=space.bounds,
    method="SLSQP",
    options={"maxiter": 60, "ftol": 1e-7},
    constraints=[
        NonlinearConstraint(chord.value, given, given, jac=chord.jacobian),
        NonlinearConstraint(thick.value, LEAST.ravel(), np.inf, jac=thick.jacobian),
        NonlinearConstraint(stacked.value, -1.0, 1.0, jac=stacked.jacobian),
    ],
)
spent = time.perf_counter() - started
# the accepted design, at knots of its own and the tolerance of its CAD files
before, after = (space.design(x).changed("tolerance", 1e-6).build() for x in (space.x0, found.x))
export(after, before, "lightest-fan")

lean, sweep = np.split(np.abs(stacking(after)), 2)
slack = thicknesses(after) - LEAST.ravel()
print(f"{found.nit} iterations, {len(space.paths)} parameters, {spent:.1f} s")
print(
    f"volume {volume(before):.2f} cm3 before, {volume(after):.2f} cm3 after; "
    f"chords within {np.ptp(chords(after) - given):.1e} mm"
)
print(
    f"thickness {slack.min():+.4f} mm or more above the least, at it in {np.sum(slack < 1e-3)} of {len(slack)} places"
)
print(f"lean {LEAN * lean.max():.3f} of {LEAN} deg, sweep {SWEEP * sweep.max():.3f} of {SWEEP} mm")

assert found.success, found.message
assert volume(after) < 0.85 * volume(before)
# what the coarse surfaces miss: a ten-thousandth of the chord
assert np.abs(chords(after) / given - 1.0).max() < 1e-4
assert slack.min() > -5e-3
assert max(lean.max(), sweep.max()) < 1.0 + 5e-3
