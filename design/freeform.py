"""What plain fits of curves, surfaces and profiles reach, and what their constants decide: `freeform.md`.

    python design/freeform.py [--only NAME ...] [--with FILE.NAME=VALUE ...] [--save FILE] [--beside FILE]

Each row: distances of the points, and of the noise-free shape, from the fit, in millionths of the extent; control
points and weights that were free; rank; evaluations; and processor seconds.
"""

import argparse
import ast
import importlib
import json
import time
from pathlib import Path

import numpy as np

import bladewright as bw
from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.closest import closest_on_curve, closest_on_surface

X = np.linspace(0.0, 1.0, 81)
BENT = np.stack([X, 0.3 * np.sin(3.0 * X) + 0.1 * X**2], axis=-1)
TURN = np.linspace(0.0, 2.0 * np.pi, 160, endpoint=False)
ELLIPSE = np.stack([np.cos(TURN), 0.5 * np.sin(TURN)], axis=-1)
HELIX = np.stack([np.cos(7.0 * X), np.sin(7.0 * X), 2.0 * X], axis=-1)
U, V = np.random.default_rng(0).random((2, 300))
HILL = np.stack([1.3 * U, V, 0.2 * np.sin(2.0 * U + V)], axis=-1)
WAVE = np.stack([1.3 * U, V, 0.1 * np.sin(7.0 * U)], axis=-1)
PIPE = np.stack([np.cos(1.5 * U), np.sin(1.5 * U), 1.2 * V], axis=-1)


def random(seed=7):
    return np.random.default_rng(seed)


def noisy(points, size, seed=3):
    return points + size * random(seed).normal(size=points.shape)


def with_outliers(points, share=0.03, height=0.1, seed=5):
    rng, points = random(seed), points.copy()
    rows = rng.choice(len(points), int(share * len(points)), replace=False)
    points[rows, -1] += height * (0.2 + rng.random(len(rows)))
    return points


def rational_curve(dimension, seed):
    rng = random(seed)
    net = np.concatenate([np.linspace(0.0, 1.0, 6)[:, None], 0.25 * rng.normal(size=(6, dimension - 1))], axis=1)
    weights = np.exp(0.4 * rng.normal(size=6))
    curve = bw.Curve(control_points=net, weights=weights, knots=uniform_knots(6, 3), degree=3)
    points = curve(np.concatenate([[0.0, 1.0], rng.random(150)]))
    return points[np.argsort(points[:, 0])]


def airfoil(count, camber=0.04, *, blunt):
    """NACA 4412 by its formulas, around from the trailing edge (Jacobs, Ward and Pinkerton 1933)."""
    x = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count))
    y = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - (0.1015 if blunt else 0.1036) * x**4)
    line = np.where(x < 0.4, camber / 0.16 * (0.8 * x - x**2), camber / 0.36 * (0.2 + 0.8 * x - x**2))
    slope = np.where(x < 0.4, camber / 0.16 * (0.8 - 2.0 * x), camber / 0.36 * (0.8 - 2.0 * x))
    size = np.hypot(1.0, slope)
    upper, lower = (np.stack([x - s * y * slope / size, line + s * y / size], axis=-1) for s in (1.0, -1.0))
    return np.concatenate([upper[::-1], lower[1:]])


EDGES = np.array([[0.0, 0.0], [1.0, 0.0]])
FOIL, BLUNT = airfoil(50, blunt=False), airfoil(50, blunt=True)
SKEW = HILL @ np.array([[1.0, 0.3, 0.2], [0.2, 1.0, -0.4], [0.0, 0.1, 1.0]])

CASES = {
    "curve: exact": (bw.fit_curve, BENT, BENT, {}),
    "curve: power 4": (bw.fit_curve, BENT, BENT, {"power": 4}),
    "curve: power 8, free weights": (bw.fit_curve, BENT, BENT, {"power": 8, "weights": "free"}),
    "curve: tolerance": (bw.fit_curve, BENT, BENT, {"tolerance": 1e-5}),
    "curve: noise, in no order": (
        bw.fit_curve, random().permutation(noisy(np.repeat(BENT, 4, axis=0), 1e-3)), BENT, {"ends": "free"}),
    "curve: noise, tolerance below it": (bw.fit_curve, noisy(BENT, 1e-3), BENT, {"tolerance": 1e-4, "ends": "free"}),
    "curve: noise, tolerance above it": (
        bw.fit_curve, noisy(HELIX, 1e-3), HELIX, {"tolerance": 5e-3, "ends": "free"}),
    "curve: outliers": (
        bw.fit_curve, with_outliers(noisy(np.repeat(BENT, 3, axis=0), 1e-4)), BENT, {"robust": True, "ends": "free"}),
    "curve: outliers, 10 %": (
        bw.fit_curve, with_outliers(noisy(np.repeat(BENT, 3, axis=0), 1e-3), 0.1, 0.3), BENT,
        {"robust": True, "ends": "free"}),
    "curve: outliers, 20 %": (
        bw.fit_curve, with_outliers(noisy(np.repeat(BENT, 3, axis=0), 1e-3), 0.2), BENT, {"robust": True}),
    "curve: free weights in the plane": (bw.fit_curve, *[rational_curve(2, 8)] * 2, {"weights": "free"}),
    "curve: free weights in space": (bw.fit_curve, *[rational_curve(3, 9)] * 2, {"weights": "free"}),
    "curve: helix, tolerance": (bw.fit_curve, HELIX, HELIX, {"tolerance": 1e-4}),
    "curve: closed, in no order": (
        bw.fit_curve, random().permutation(ELLIPSE), ELLIPSE, {"closed": True, "control_points": 12}),
    "curve: closed, outliers": (
        bw.fit_curve, with_outliers(noisy(ELLIPSE, 2e-3)), ELLIPSE,
        {"closed": True, "control_points": 12, "robust": True}),
    "curve: gap": (bw.fit_curve, BENT[(X < 0.35) | (X > 0.6)], BENT, {"control_points": 20}),
    "curve: airfoil, in no order": (
        bw.fit_curve, random().permutation(noisy(FOIL, 2e-4)), FOIL,
        {"degree": 4, "control_points": 16, "ends": (FOIL[0], FOIL[-1])}),
    "surface: exact": (bw.fit_surface, HILL, HILL, {"control_points": (4, 4)}),
    "surface: noise": (bw.fit_surface, noisy(HILL, 1e-3), HILL, {"control_points": (4, 4)}),
    "surface: skew": (bw.fit_surface, SKEW, SKEW, {"control_points": (5, 5)}),
    "surface: tolerance": (bw.fit_surface, WAVE, WAVE, {"control_points": (4, 4), "tolerance": 2e-3}),
    "surface: outliers": (
        bw.fit_surface, with_outliers(noisy(HILL, 3e-4)), HILL, {"control_points": (4, 4), "robust": True}),
    "surface: corners": (bw.fit_surface, HILL, HILL, {"control_points": (5, 4), "boundary": "corners"}),
    "surface: gap": (bw.fit_surface, HILL[(U < 0.45) | (U > 0.7)], HILL, {"control_points": (8, 4)}),
    "surface: free weights": (
        bw.fit_surface, PIPE, PIPE, {"degrees": (2, 1), "control_points": (3, 2), "weights": "free"}),
    "profile: blunt": (bw.fit_profile, BLUNT, BLUNT, {}),
    "profile: blunt, power 4": (bw.fit_profile, BLUNT, BLUNT, {"power": 4, "ends": EDGES}),
    "profile: round": (bw.fit_profile, FOIL, FOIL, {"trailing_edge": "round", "thickness": 8}),
    "profile: noise": (bw.fit_profile, noisy(BLUNT, 5e-4), BLUNT, {}),
    "profile: tolerance": (bw.fit_profile, BLUNT, BLUNT, {"camber": 4, "thickness": 5, "tolerance": 1e-3}),
    "profile: tolerance below noise": (
        bw.fit_profile, noisy(BLUNT, 2e-3), BLUNT, {"camber": 4, "thickness": 5, "tolerance": 1e-3}),
}  # fmt: skip


def from_truth(fit, truth):
    """The mean distance of noise-free points from a fit."""
    if hasattr(fit, "curve"):
        return float(np.mean(closest_on_curve(fit.curve, truth).distances))
    if hasattr(fit, "surface"):
        return float(np.mean(closest_on_surface(fit.surface, truth).distances))
    t = np.linspace(0.0, 1.0, 2001) ** 2
    sides = np.concatenate([fit.side(t, upper=True)[::-1], fit.side(t, upper=False)])
    step = np.diff(sides, axis=0)
    away = truth[:, None] - sides[:-1]
    share = np.clip(np.sum(away * step, axis=-1) / np.maximum(np.sum(step**2, axis=-1), 1e-300), 0.0, 1.0)
    return float(np.mean(np.sqrt(np.min(np.sum((away - share[..., None] * step) ** 2, axis=-1), axis=1))))


def measured(name):
    function, points, truth, asked = CASES[name]
    begun = time.process_time()
    fit = function(points, **asked)
    seconds = time.process_time() - begun
    extent = 1e-6 * float(np.ptp(points, axis=0).max())
    return {
        "mean": fit.mean / extent, "rms": fit.rms / extent, "largest": fit.maximum / extent,
        "truth": from_truth(fit, truth) / extent, "outliers": int(np.sum(~fit.inliers)), "free": fit.unknowns,
        "rank": fit.rank, "evaluations": fit.iterations, "seconds": round(seconds, 2), "passed": bool(fit.passed),
    }  # fmt: skip


def changed(changes):
    """Other values of constants, where the modules take them from."""
    for change in changes:
        place, value = change.split("=")
        file, name = place.split(".")
        module = importlib.import_module(f"bladewright.fitting.freeform.{file}")
        setattr(module, name, type(getattr(module, name))(ast.literal_eval(value)))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", nargs="*", default=[""])
    parser.add_argument("--with", dest="changes", nargs="*", default=[], metavar="FILE.NAME=VALUE")
    parser.add_argument("--save", type=Path)
    parser.add_argument("--beside", type=Path, help="what was saved before: what differs by 2 % is shown")
    asked = parser.parse_args()
    changed(asked.changes)
    before = json.loads(asked.beside.read_text()) if asked.beside else {}
    found = {}
    for name in (each for each in CASES if any(word in each for word in asked.only)):
        row, old = measured(name), before.get(name, {})
        if not found:
            print("| case |", " | ".join(row), "|\n|---|" + "---|" * len(row))
        found[name] = row
        differs = {key: value for key, value in old.items() if 50.0 * abs(value - row[key]) > abs(value) + 0.05}
        words = "".join(
            f" {key} {value:.4g}" for key, value in differs.items() if key not in ("evaluations", "seconds")
        )
        cells = (format(value, ".4g") for value in row.values())
        print(f"| {name} | {' | '.join(cells)} |", f"before:{words}" if words else "", flush=True)
    print(f"{sum(row['seconds'] for row in found.values()):.1f} s, before", end=" ")
    print(f"{sum(row['seconds'] for name, row in before.items() if name in found):.1f} s")
    if asked.save:
        asked.save.write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
