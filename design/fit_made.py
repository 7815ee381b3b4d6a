"""Made clouds, whose truth is known: how near the fit comes to the design that they were drawn from.

    python design/fit_made.py sections [--given] [--seeds 0:20]
    python design/fit_made.py blades [--given] [--random] [--seeds 0:8]

A design is drawn at random, and 5,000 points on its surface: at random, and of blades 100 in a row at each end of each
side, as meshes and measurements of sections have them (`--random`: none, so that only the outermost points show where
the blade ends). `--given` gives the fit the structure of the design, otherwise it has the points alone. Deviations are
those of 20,000 other points of the true surface from the found one, of the chord; seconds are of one processor. The
results are recorded in design/fit_made.md.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import time
from dataclasses import replace

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.errors import BladewrightError, DesignError
from bladewright.files.examples import example_text, examples
from bladewright.files.reading import design_from, parsed
from bladewright.fitting.fit import fit
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.section.unified import UnifiedSection

POINTS, OTHERS, ROW = 5_000, 20_000, 100
SHAKEN = 0.04
"""relative change of a blade's parameters"""


def section(seed):
    """A section drawn at random: a vane, a compressor's or a turbine's."""
    draw = np.random.default_rng(seed)
    while True:
        stagger = draw.uniform(-60.0, 60.0)
        turn = draw.uniform(0.0, 55.0) * draw.choice([-1.0, 1.0])
        thickness = np.exp(draw.uniform(np.log(0.04), np.log(0.2)))
        bulge = [np.sin(np.pi * np.linspace(0.12, 0.95, draw.integers(4, 8))) ** 0.7 for _ in range(2)]
        share = draw.uniform(0.3, 1.0, 2)
        try:
            design = UnifiedSection(
                name=f"section-{seed}",
                length_unit="mm",
                axial_chord=draw.uniform(30.0, 90.0),
                stagger=stagger,
                metal_angle_in=np.clip(stagger + turn + draw.uniform(-8.0, 8.0), -75.0, 75.0),
                metal_angle_out=np.clip(stagger - 0.6 * turn + draw.uniform(-8.0, 8.0), -78.0, 78.0),
                tangent_in=draw.uniform(0.2, 0.6),
                tangent_out=draw.uniform(0.2, 0.6),
                leading_edge_radius=0.5 * thickness * draw.uniform(0.15, 0.6),
                trailing_edge_radius=0.5 * thickness * draw.uniform(0.05, 0.25),
                thickness_upper=tuple(thickness * share[0] * bulge[0] * draw.uniform(0.85, 1.15, len(bulge[0]))),
                thickness_lower=tuple(thickness * share[1] * bulge[1] * draw.uniform(0.85, 1.15, len(bulge[1]))),
            )
            design.build()
        except DesignError:
            continue
        return design


def blade(seed):
    """One of the examples of the unified family with every parameter shaken, but for the channel, without clearance."""
    draw = np.random.default_rng(seed)
    bases = [design_from(parsed(example_text(name), name), name) for name in examples()]
    # those that a seed has always meant: the ones that leave as wheels came later
    bases = [base for base in bases if isinstance(base, UnifiedBlade) and base.disc is None]
    base = replace(bases[seed % len(bases)], tip_clearance=None, hub_clearance=None)
    values = base.parameters()
    while True:
        changes = {
            path: value * (1.0 + SHAKEN * draw.normal())
            for path, value in values.items()
            if not path.startswith(("channel.", "pitch", "tip_", "hub_"))
        }
        try:
            design = base.changed(changes)
            design.build()
        except DesignError:
            continue
        return design


def rows_of(built, draw):
    """A row of points at each end of each side of a blade."""
    u = (1.0 - np.cos(np.pi * draw.random((2, 2, ROW)))) / 2.0
    return np.concatenate(
        [s(u[i, j], np.full(ROW, v)) for i, s in enumerate(built.sides) for j, v in enumerate((0.0, 1.0))]
    )


def points_of(built, count, draw):
    """Points at random on both sides, even by area or length."""
    if not hasattr(built, "surfaces"):
        parts = []
        for curve in built.curves.values():
            u = draw.random(8 * count)
            speed = np.sqrt(np.sum(np.asarray(curve.derivative(u)) ** 2, axis=-1))
            parts.append(curve(draw.choice(u, count // 2, p=speed / speed.sum())))
        return np.concatenate(parts)
    parts = []
    for side in built.sides:
        u, v = draw.random((2, 8 * count))
        u = (1.0 - np.cos(np.pi * u)) / 2.0
        area = np.sqrt(np.sum(np.cross(side.derivative(u, v, 1, 0), side.derivative(u, v, 0, 1)) ** 2, axis=-1))
        weight = area * np.sqrt(u * (1.0 - u))
        chosen = draw.choice(len(u), count // 2, p=weight / weight.sum())
        parts.append(side(u[chosen], v[chosen]))
    return np.concatenate(parts)


def cloud_of(built, seed, *, ends):
    """The points that a fit sees, with rows at the `ends` of a blade if wanted, and those that measure it."""
    draw = np.random.default_rng(1000 + seed)
    cloud, others = points_of(built, POINTS, draw), points_of(built, OTHERS, draw)
    if hasattr(built, "surfaces") and ends:
        cloud = np.concatenate([draw.permutation(cloud)[: POINTS - 4 * ROW], rows_of(built, draw)])
    return cloud, others


def row(kind, seed, *, given, ends):
    """A line of the table."""
    design = section(seed) if kind == "sections" else blade(seed)
    built = design.build()
    cloud, others = cloud_of(built, seed, ends=ends)
    start = time.process_time()
    try:
        found = fit(cloud, like=design if given else None)
    except BladewrightError as error:
        return f"| {design.name} {seed} | refused after {time.process_time() - start:.0f} s: {error} |"
    spent = time.process_time() - start
    sides = found.built.sides if hasattr(found.built, "surfaces") else tuple(found.built.curves.values())
    chord = float(np.real(built.chord))
    away = nearest_footpoints(others, sides, converged=1e-12).distances / chord
    return (
        f"| {design.name} {seed} | {len(found.estimates)} | {np.mean(away):.1e} | {np.max(away):.1e} | "
        f"{'yes' if found.passed else 'no'} | {spent:.0f} |"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=("sections", "blades"))
    parser.add_argument("--given", action="store_true")
    parser.add_argument("--random", action="store_true")
    parser.add_argument("--seeds", default="0:10")
    options = parser.parse_args()
    print("| design, seed | parameters | mean | max | passed | s |\n|---|---|---|---|---|---|")
    for each in range(*map(int, options.seeds.split(":"))):
        print(row(options.kind, each, given=options.given, ends=not options.random), flush=True)
