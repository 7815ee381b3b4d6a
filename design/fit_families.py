"""Matches of clouds by the families from sections, from the points and the family's name alone.

    python design/fit_families.py [--family suction-pressure] [--parameters N | --tolerance] [LS89_2D ... | EXAMPLE ...]

Names ending in _2D, and Aachen_3D, NASA_R67 and APU_rotor, are clouds of ../shared/data/clouds; others are the built-in
examples from sections, of whose sides 3,000 random points are drawn, and which are matched by their own family.
Deviations of all points, outliers too, in mm and in chords; seconds of one processor's time. The results are recorded
in design/fit_families.md.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import time
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from bladewright.errors import BladewrightError
from bladewright.files.clouds import read_cloud
from bladewright.files.reading import read_design
from bladewright.fitting.families.kinds import family_of
from bladewright.fitting.fit import fit
from bladewright.fitting.models.blunt_edges import sides_of

CLOUDS = Path(__file__).resolve().parents[2] / "shared" / "data" / "clouds"
ENLARGED = {"t106eiz_2D": 100.0}
AXES = ("skip", "z", "y", "x")
DRAWN = 1500
"""points of each side of an example"""
TOLERANCE = 5e-5
"""[m]"""


def of_cloud(name: str) -> Any:
    """Points of a shared cloud [m]."""
    columns = None if name.endswith("_2D") else AXES
    return read_cloud(CLOUDS / f"{name}.txt", columns=columns).points * ENLARGED.get(name, 1.0)


def of_example(name: str) -> tuple[Any, dict[str, Any]]:
    """Points of a built-in example [m], and what its row is."""
    design: Any = read_design(Path(str(files("bladewright") / "examples" / f"{name}.toml")))
    random = np.random.default_rng(4)
    points = np.concatenate([side(*random.random((2, DRAWN))) for side in sides_of(design.build())])
    kind = family_of(design)
    return points, {"family": kind.name if kind else "", "blade_count": design.blade_count}


def row(name: str, options: dict[str, Any]) -> str:
    """A line of the table."""
    points, known = (of_cloud(name), {}) if (CLOUDS / f"{name}.txt").exists() else of_example(name)
    options = {**options, **known}
    start = time.process_time()
    try:
        found = fit(points, **options)
    except BladewrightError as error:
        return f"| {name} | {options['family']} | refused after {time.process_time() - start:.0f} s: {error} |"
    spent, off, chord = time.process_time() - start, np.abs(found.deviations), found.built.chord
    return (
        f"| {name} | {options['family']} | {len(found.estimates)} | {1e3 * off.mean():.4f} | {1e3 * off.max():.4f} | "
        f"{off.max() / chord:.1e} | {len(found.outliers)} | {'yes' if found.passed else 'no'} | {spent:.0f} |"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="+")
    parser.add_argument("--family", default="suction-pressure")
    parser.add_argument("--parameters", type=int)
    parser.add_argument("--tolerance", action="store_true")
    given = parser.parse_args()
    options: dict[str, Any] = {"family": given.family, "parameters": given.parameters}
    if given.tolerance:
        options["tolerance"] = TOLERANCE
    print("| cloud | family | parameters | mean mm | max mm | max, of the chord | outliers | passed | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for each in given.names:
        print(row(each, options), flush=True)
