"""Matches of clouds without a first guess: what is reached with a number of parameters, and with a tolerance.

    python design/matches.py [--tolerance] [LS89_2D ...]

Needs ../shared/data/clouds. Deviations in mm, seconds of one processor's time. The
results of both are recorded in design/matches.md.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
import time
from pathlib import Path

from bladewright.errors import BladewrightError
from bladewright.files.clouds import read_cloud
from bladewright.fitting.fit import fit

CLOUDS = Path(__file__).resolve().parents[2] / "shared" / "data" / "clouds"
PARAMETERS = {"LS89_2D": 22, "t106eiz_2D": 22, "Impulse_2D": 22, "Aachen_3D": 26, "NASA_R67": 107, "APU_rotor": 101}
ENLARGED = {"t106eiz_2D": 100.0}
AXES = ("skip", "z", "y", "x")
TOLERANCE = 5e-5
"""[m]"""


def row(name: str, *, tolerance: bool) -> str:
    """A line of the table."""
    columns = None if name.endswith("_2D") else AXES
    points = read_cloud(CLOUDS / f"{name}.txt", columns=columns).points * ENLARGED.get(name, 1.0)
    start = time.process_time()
    try:
        found = fit(points, **({"tolerance": TOLERANCE} if tolerance else {"parameters": PARAMETERS[name]}))
    except BladewrightError as error:
        return f"| {name} | refused after {time.process_time() - start:.0f} s: {error} |"
    spent = time.process_time() - start
    edges = found.by_region["leading edge"]
    return (
        f"| {name} | {len(points)} | {len(found.estimates)} | {1e3 * found.mean:.4f} | {1e3 * found.maximum:.4f} | "
        f"{1e3 * edges.mean:.4f} | {1e3 * found.noise:.4f} | {max(found.extrema.values())} | {len(found.outliers)} | "
        f"{'yes' if found.passed else 'no'} | {spent:.0f} |"
    )


if __name__ == "__main__":
    names = [word for word in sys.argv[1:] if not word.startswith("--")] or list(PARAMETERS)
    print("| cloud | points | parameters | mean | max | leading edge | noise | extrema | outliers | passed | s |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for each in names:
        print(row(each, tolerance="--tolerance" in sys.argv), flush=True)
