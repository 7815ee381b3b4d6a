"""A stator whose throat is opened to a target area with the least change of shape: a search of one's own, by scipy.

The change is measured where it is felt: as the mean square distance that the surface moves. For a small change p of the
parameters that is p . G p, with G from the surface's own derivatives; in the variables y = L^T p, G = L L^T, it is
y . y, and a search takes straight steps.
"""

import sys
from importlib import resources
from pathlib import Path

import numpy as np
from scipy.optimize import NonlinearConstraint, minimize

import bladewright as bw
from bladewright import cad

OPENED = 1.06
"""target area of the throat, of the present one"""
U, V = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 40)))[:, None] / 2.0, np.linspace(0.0, 1.0, 20)
"""where movements of the surface are looked at"""


def area(blade):
    """Area of the throat [cm2]."""
    return 1e4 * bw.throat(blade).area


def metric_of(start, space):
    """Mean square movement [mm2] of the surface by each pair of variables."""
    nets = bw.net_jacobian(start, free=space.paths, knots=space.knots)
    rates = 1e3 * np.stack([nets.points(name, U, V) for name in ("upper", "lower")], axis=1)
    rates = space.scale[:, None] * rates.reshape(len(space.paths), -1)
    return rates @ rates.T / (rates.shape[1] / 3)


def main():
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path.cwd()
    directory.mkdir(parents=True, exist_ok=True)
    with resources.as_file(resources.files("bladewright") / "examples" / "aachen-stator.toml") as path:
        start = bw.read_design(path).changed({"name": "stator-throat", "tolerance": 1e-5})
    # the thickness beside both edges, which holds their radii, stays
    inner = [
        f"thickness_{side}[{i}]"
        for side, law in (("upper", start.thickness_upper), ("lower", start.thickness_lower))
        for i in range(1, len(law) - 1)
    ]
    space = bw.variables(start, free=["stagger*", "metal_angle_*", "tangent_*", "leading_edge_theta*", *inner])
    opening, x0 = space.objective(area), space.x0
    target = OPENED * opening.value(x0)
    metric = metric_of(start, space)
    # a little of x . x, so that no parameter runs away along what hardly moves the surface
    lower = np.linalg.cholesky(metric + 1e-3 * np.trace(metric) * np.eye(len(metric)))

    def x_of(y):
        return x0 + np.linalg.solve(lower.T, y)

    found = minimize(
        lambda y: y @ y,
        np.zeros(len(x0)),
        jac=lambda y: 2.0 * y,
        method="SLSQP",
        options={"ftol": 1e-10},
        constraints=NonlinearConstraint(
            lambda y: opening.value(x_of(y)),
            target,
            target,
            jac=lambda y: np.linalg.solve(lower, opening.jacobian(x_of(y))),
        ),
    )
    before, after = (space.design(x).changed("tolerance", 1e-6).build() for x in (x0, x_of(found.x)))
    bw.write_design(after.design, directory / "stator-throat.toml")
    trip = cad.write(after, directory / "stator-throat.step")
    print(trip)

    # what turning the vane as a whole would take
    restaggered = bw.sensitivity(start, area, free="stagger*", knots=space.knots)
    turn = (target - opening.value(x0)) / float(sum(restaggered.values()))
    turned = np.array([turn if path.startswith("stagger") else 0.0 for path in space.paths]) / space.scale
    by_turning = np.sqrt(turned @ metric @ turned)
    steps = [1e3 * (after.surfaces[name](U, V) - before.surfaces[name](U, V)) for name in ("upper", "lower")]
    moved = np.sqrt(np.mean(np.sum(np.square(steps), axis=-1)))
    print(f"{found.nit} iterations, {len(space.paths)} parameters")
    print(f"throat {area(before):.3f} cm2 before, {area(after):.3f} cm2 after, target {target:.3f} cm2")
    print(
        f"surface moved by {moved:.3f} mm in the mean; "
        f"turning the vane by {turn:.2f} deg would move it by {by_turning:.3f} mm"
    )

    assert found.success, found.message
    assert trip.passed, trip.failures
    # between the tolerances of search and CAD file
    assert abs(area(after) / target - 1.0) < 1e-5
    assert moved < 0.8 * by_turning


if __name__ == "__main__":
    main()
