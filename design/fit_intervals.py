"""How often the 95 % intervals of fitted sections contain the true values.

    python design/fit_intervals.py [POINTS] [FIRST_SEED] [RUNS]

Sections drawn about the built-in turbine section, sampled evenly in u with normal noise of 0.02 mm in x and y, are
fitted with their structure given and nothing else. The linear theory's share is that of the same noise taken through
the derivatives at the truth: where that has 95 % inside and the fits have not, the problem is nonlinear. The gain is by
how much the sum of squares falls below that at the truth, in variances of the noise: as many as there are parameters,
if the search ends at the minimum. The record is in design/fit_intervals.md.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys

import numpy as np
from scipy.stats import norm

from bladewright.designs import Design
from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed
from bladewright.fitting.fit import fit
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.models.model import model_of
from bladewright.nurbs.basis import Reals

NOISE = 2e-5
"""[m]"""
BASE = design_from(parsed(example_text("turbine-section"), "vane"), "vane")


def drawn(seed: int) -> Design:
    """A section about the example."""
    random = np.random.default_rng(seed)
    changes = {
        "stagger": BASE.stagger + random.uniform(-8.0, 8.0),
        "metal_angle_in": BASE.metal_angle_in + random.uniform(-10.0, 10.0),
        "metal_angle_out": BASE.metal_angle_out + random.uniform(-4.0, 4.0),
        "leading_edge_radius": BASE.leading_edge_radius * random.uniform(0.8, 1.2),
        "leading_edge_x": random.normal(),
        "leading_edge_y": random.normal(),
    }
    for name in ("thickness_upper", "thickness_lower"):
        changes |= {f"{name}[{i}]": v * random.uniform(0.9, 1.1) for i, v in enumerate(getattr(BASE, name))}
    return BASE.changed(changes)


def sampled(truth: Design, count: int, seed: int) -> Reals:
    """Noisy points (n, 2) of both sides."""
    random, curves = np.random.default_rng(seed), truth.build().curves
    points = np.concatenate([curves[side](random.random(count // 2)) for side in ("upper", "lower")])
    return random.permutation(points + NOISE * random.normal(size=points.shape))


def linear(truth: Design, points: Reals, paths: tuple[str, ...]) -> tuple[Reals, float]:
    """Errors (k,) over their standard deviations by the linear theory at the truth, and the sum of squares there."""
    model = model_of(truth)
    shape = model.shape(truth)
    on = nearest_footpoints(points, shape.sides)
    slopes = -model.along(shape, on, on.normals, paths)
    size = np.sqrt(np.sum(slopes**2, axis=0))
    step = -np.linalg.lstsq(slopes / size, on.heights, rcond=None)[0]
    deviation = NOISE * np.sqrt(np.diag(np.linalg.inv((slopes / size).T @ (slopes / size))))
    return step / deviation, float(np.sum(on.heights**2))


def main(count: int, first: int, runs: int) -> None:
    """Prints a row for each cloud and the pooled shares."""
    shares, held, ideal, gains, widths, worst = [], [], [], [], [], {}
    reach = norm.ppf(0.975)
    for seed in range(first, first + runs):
        truth = drawn(seed)
        points, values = sampled(truth, count, 100 + seed), truth.parameters()
        found = fit(points, like=BASE)
        known = np.array([each.identified for each in found.estimates])
        inside = np.array([each.low <= values[each.path] <= each.high for each in found.estimates])
        theory, squares = linear(truth, points, tuple(each.path for each in found.estimates))
        gain = (squares - float(np.sum(found.distances**2))) / NOISE**2
        for each, yes in zip(found.estimates, inside, strict=True):
            worst.setdefault(each.path, []).append(yes or not each.identified)
        shares.append(float(np.mean(inside[known])))
        held += list(inside[known])
        ideal += list(np.abs(theory[known]) < reach)
        gains.append(gain)
        widths.append(found.deviation.rms / NOISE)
        print(f"{seed:4d} inside {shares[-1]:.3f} of {np.count_nonzero(known)} gain {gain:.1f}", flush=True)
    error = float(np.std(shares)) / np.sqrt(runs)
    print(
        f"{count} points, {runs} clouds: {np.mean(held):.3f} +- {error:.3f} inside, linear theory {np.mean(ideal):.3f}"
    )
    print(f"gain {np.mean(gains):.1f} for {len(worst)} parameters; rms {np.mean(widths):.3f} of the noise")
    least = sorted(worst, key=lambda path: np.mean(worst[path]))[:4]
    print("least often:", ", ".join(f"{path} {np.mean(worst[path]):.2f}" for path in least))


if __name__ == "__main__":
    given = [int(word) for word in sys.argv[1:]]
    main(*given, *(1000, 0, 30)[len(given) :])
