"""Clouds as users bring them: made of the examples, varied in many ways, matched by the command line alone.

    python design/fit_clouds.py [NAME ...] [--list] [--directory DIR]

Each case writes a file of points, runs `bladewright fit` on it, reads the design that it wrote, and measures 8,000
places of the true sides from the found ones and the reverse, of the chord. NAME is a case, a machine (`fan`) or a
variation (`noise`). The results are recorded in design/fit_clouds.md.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy.spatial.transform import Rotation

from bladewright.files.clouds import read_cloud
from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed, read_design
from bladewright.files.writing import write_design
from bladewright.fitting.matching.footpoints import nearest_footpoints

EXAMPLES = {
    "aachen": "aachen-stator",
    "compressor": "compressor-stator",
    "turbine": "radial-turbine",
    "impeller": "centrifugal-impeller",
    "fan": "fan-rotor",
    "propeller": "propeller",
}
SPACE = tuple(EXAMPLES)
SHARED = Path("/work/shared/data/clouds")
WHOLE = (0.0, 1.0, 0.0, 1.0)
PLACED = Rotation.from_rotvec([0.7, -1.1, 0.4]), np.array([0.3, -0.2, 0.5])


@dataclass(frozen=True, kw_only=True)
class Truth:
    """What a cloud is made of."""

    machine: str
    sides: tuple
    draw: np.random.Generator
    directory: Path


@dataclass(frozen=True, kw_only=True)
class Case:
    """A cloud, and the options of the command line for it."""

    points: np.ndarray
    options: tuple[str, ...] = ()
    shown: tuple[float, float, float, float] = WHOLE
    """u and v between which the cloud shows the blade"""
    placed: bool = False
    """whether the points lie elsewhere than the machine"""
    unit: float = 1e-3
    """length in which the points are written [m]"""


def design_of(machine):
    """An example without clearance."""
    design = design_from(parsed(example_text(EXAMPLES[machine]), machine), machine)
    return replace(design, tip_clearance=None, hub_clearance=None)


def sides_of(built):
    """The two sides of a blade or section."""
    return built.sides if hasattr(built, "surfaces") else (built.curves["upper"], built.curves["lower"])


def true_sides(machine):
    if machine != "ls89":
        return sides_of(design_of(machine).build())
    name = "vki-ls89"
    return sides_of(design_from(parsed(example_text(name), name), name).build().sections[0])


def on(sides, u, v):
    """Points of both sides at places (2, n)."""
    flat = not hasattr(sides[0], "knots_u")
    return np.concatenate(
        [side(*((each,) if flat else (each, at))) for side, each, at in zip(sides, u, v, strict=True)]
    )


def scattered(sides, count, draw, shown=WHOLE):
    """Points at random on both sides, denser at the edges."""
    u = (1.0 - np.cos(np.pi * draw.random((2, count // 2)))) / 2.0
    v = draw.random((2, count // 2))
    return on(sides, shown[0] + u * (shown[1] - shown[0]), shown[2] + v * (shown[3] - shown[2]))


def rows(sides, across=21, along=80, shown=WHOLE):
    """Points in rows along the chord, as meshes and measurements have them."""
    if not hasattr(sides[0], "knots_u"):
        across, along = 1, 300
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, along))) / 2.0
    u, v = np.meshgrid(shown[0] + u * (shown[1] - shown[0]), np.linspace(*shown[2:], across))
    return on(sides, [u.ravel()] * 2, [v.ravel()] * 2)


def noisy(points, draw, noise=0.02e-3):
    return points + noise * draw.normal(size=points.shape)


def turned(points, axis, angle):
    return points @ Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix().T


def with_outliers(points, draw):
    """With 3 % of the points up to a twentieth of the extent off."""
    off = draw.random(len(points)) < 0.03
    return points + off[:, None] * draw.uniform(-0.05, 0.05, points.shape) * np.ptp(points)


def uneven(points, draw):
    """Thinned to a tenth over one half."""
    first = points[:, 0] < np.median(points[:, 0])
    return points[first | (draw.random(len(points)) < 0.1)]


def elsewhere(points):
    return points @ PLACED[0].as_matrix().T + PLACED[1]


def start_beside(of):
    """A file of the true design with every law shaken by 3 %."""
    design = design_of(of.machine)
    values = {k: v * (1.0 + 0.03 * of.draw.normal()) for k, v in design.parameters().items() if not k.startswith("ch")}
    path = of.directory / f"{of.machine}-start.toml"
    write_design(design.changed(values), path)
    return str(path)


def _moved(of, *, started):
    options = ("--start", start_beside(of)) if started else ()
    return Case(points=elsewhere(rows(of.sides)), options=("--align", *options), placed=True)


VARIATIONS = {
    # name: machines, and the case of one
    "rows": ((*SPACE, "ls89"), lambda of: Case(points=rows(of.sides))),
    "scattered": ((*SPACE, "ls89"), lambda of: Case(points=scattered(of.sides, 5000, of.draw))),
    "noise": ((*SPACE, "ls89"), lambda of: Case(points=noisy(rows(of.sides), of.draw))),
    "outliers": ((*SPACE, "ls89"), lambda of: Case(points=with_outliers(noisy(rows(of.sides), of.draw), of.draw))),
    "part": (
        SPACE,
        lambda of: Case(points=noisy(rows(of.sides, shown=(0, 1, 0.2, 0.8)), of.draw), shown=(0, 1, 0.2, 0.8)),
    ),
    "duplicated": (("aachen", "ls89"), lambda of: Case(points=np.repeat(noisy(rows(of.sides), of.draw), 3, axis=0))),
    "uneven": (
        ("compressor", "fan", "ls89"),
        lambda of: Case(points=uneven(scattered(of.sides, 8000, of.draw), of.draw)),
    ),
    "open": (
        ("aachen", "fan", "ls89"),
        lambda of: Case(points=noisy(rows(of.sides, shown=(0, 0.9, 0, 1)), of.draw), shown=(0, 0.9, 0, 1)),
    ),
    "axis-y": (
        ("aachen", "turbine"),
        lambda of: Case(points=noisy(rows(of.sides), of.draw)[:, [2, 0, 1]], options=("--columns", "z,x,y")),
    ),
    "axis-unsaid": (("aachen", "turbine"), lambda of: Case(points=noisy(rows(of.sides), of.draw)[:, [1, 2, 0]])),
    "align": (SPACE, lambda of: _moved(of, started=False)),
    "align-start": (SPACE, lambda of: _moved(of, started=True)),
    "annulus": (
        ("aachen", "impeller"),
        lambda of: Case(points=np.concatenate([turned(rows(of.sides, 11, 40), 0, t) for t in np.arange(36) * 10])),
    ),
    "two": (
        ("aachen", "fan", "impeller"),
        lambda of: Case(points=np.concatenate([turned(rows(of.sides), 0, t) for t in (0.0, 0.35)])),
    ),
    "half": (("aachen", "fan", "ls89"), lambda of: Case(points=rows(of.sides, shown=(0, 0.5, 0, 1)))),
    "suction": (("aachen", "fan", "impeller", "ls89"), lambda of: Case(points=np.split(rows(of.sides), 2)[0])),
    "inches": (("aachen", "ls89"), lambda of: Case(points=rows(of.sides), unit=0.0254)),
    "metres": (("aachen", "ls89"), lambda of: Case(points=rows(of.sides), unit=1.0)),
    "hundred": (("aachen", "ls89"), lambda of: Case(points=noisy(scattered(of.sides, 100, of.draw), of.draw))),
    "many": (("aachen", "ls89"), lambda of: Case(points=noisy(scattered(of.sides, 200_000, of.draw), of.draw))),
    "tolerance": (
        ("compressor", "fan", "impeller"),
        lambda of: Case(
            points=noisy(scattered(of.sides, 8000, of.draw), of.draw, 0.005e-3), options=("--tolerance", "0.05mm")
        ),
    ),
}


def shared(name, draw):
    """A measured cloud, a third of it at random, shuffled, with noise, and its own points [m]."""
    columns = ("skip", "x", "y") if name.endswith("_2D") else ("skip", "z", "y", "x")
    points = read_cloud(SHARED / f"{name}.txt", columns=columns).points * (100.0 if name == "t106eiz_2D" else 1.0)
    some = draw.permutation(len(points))[: max(len(points) // 3, 100)]
    return noisy(points[some], draw, 0.01e-3), points


def ran(path, unit, options, directory):
    """Exit status, the JSON of the command, what it printed on standard error, and seconds of processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "bladewright", "fit", str(path), *(("--unit", unit) if unit else ()), *options]
    done = subprocess.run(
        [*command, "-o", str(directory / f"{path.stem}.toml"), "--json"], capture_output=True, text=True, check=False
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    report = json.loads(done.stdout) if done.stdout.strip() else {}
    if "deviation" not in report:
        return done.returncode, {}, done.stderr.strip().replace("\n", " "), after.ru_utime - before.ru_utime
    return done.returncode, report, "", after.ru_utime - before.ru_utime


def apart(case, sides, path, report):
    """Mean and largest distance of the true sides from the found ones, and of those from the true, of the chord."""
    found = sides_of(read_design(path).build())
    draw = np.random.default_rng(7)
    there, back = scattered(sides, 8000, draw, case.shown), scattered(found, 8000, draw)
    if case.placed:
        motion = report["motion"]
        rotation, translation = np.array(motion["rotation"]), np.array(motion["translation_m"])
        there = elsewhere(there) @ rotation.T + translation
        back = (((back - translation) @ rotation) - PLACED[1]) @ PLACED[0].as_matrix()
    return [
        each(nearest_footpoints(points, onto, converged=1e-10).distances) / report["chord_m"]
        for points, onto in ((there, found), (back, sides))
        for each in (np.mean, np.max)
    ]


def row(machine, name, directory):
    """A line of the table."""
    draw = np.random.default_rng(len(machine) + len(name))
    of = Truth(machine=machine, sides=true_sides(machine), draw=draw, directory=directory)
    case = VARIATIONS[name][1](of)
    path = directory / f"{machine}-{name}.csv"
    np.savetxt(path, draw.permutation(case.points) / case.unit, delimiter=",", fmt="%.15g")
    status, report, error, spent = ran(path, "mm", case.options, directory)
    start = f"| {machine} {name} | {len(case.points)} | {status} |"
    if not report:
        return f"{start} | | | | {spent:.0f} | {error} |"
    away = apart(case, of.sides, path.with_suffix(".toml"), report)
    figures = " | ".join(f"{mean:.1e} / {most:.1e}" for mean, most in (away[:2], away[2:]))
    own = report["deviation"]["all"]["of_chord"]["mean"]
    return (
        f"{start} {report['parameters']} | {own:.1e} | {figures} | {spent:.0f} | "
        f"{'; '.join(report['failures']) or '; '.join(report['notes'])} |"
    )


def shared_row(name, directory):
    """A line of the table for a measured cloud, by the distances of all of its points."""
    some, points = shared(name, np.random.default_rng(5))
    path = directory / f"{name}-third.csv"
    np.savetxt(path, some * 1e3, delimiter=",", fmt="%.15g")
    status, report, error, spent = ran(path, "mm", (), directory)
    start = f"| {name} third | {len(some)} | {status} |"
    if not report:
        return f"{start} | | | | {spent:.0f} | {error} |"
    away = (
        nearest_footpoints(points, sides_of(read_design(path.with_suffix(".toml")).build())).distances
        / report["chord_m"]
    )
    own = report["deviation"]["all"]["of_chord"]["mean"]
    return (
        f"{start} {report['parameters']} | {own:.1e} | {np.mean(away):.1e} / {np.max(away):.1e} | | {spent:.0f} | "
        f"{'; '.join(report['failures']) or '; '.join(report['notes'])} |"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--directory", type=Path, default=Path("fit-clouds"))
    options = parser.parse_args()
    cases = [(machine, name) for name, (machines, _) in VARIATIONS.items() for machine in machines]
    cases += [(each.stem, "third") for each in sorted(SHARED.glob("*.txt"))]
    wanted = [each for each in cases if not options.names or {*each, " ".join(each)} & {*options.names}]
    if options.list:
        print("\n".join(" ".join(each) for each in wanted))
        sys.exit()
    options.directory.mkdir(parents=True, exist_ok=True)
    print("| cloud | points | status | parameters | said | true to found | found to true | s | words |")
    print("|---|---|---|---|---|---|---|---|---|")
    for machine, name in wanted:
        line = shared_row(machine, options.directory) if name == "third" else row(machine, name, options.directory)
        print(line, flush=True)
