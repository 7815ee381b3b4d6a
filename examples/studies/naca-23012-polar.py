"""NACA 23012 at Re 3.5e6, by XFOIL and by NeuralFoil: its polar, and the forces on its segments at 4 deg."""

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import bladewright as bw
from bladewright.views.polar import draw_polar

directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path.cwd()
directory.mkdir(parents=True, exist_ok=True)
airfoil = bw.ProfileSection(
    name="NACA 23012", length_unit="m", chord=0.245, section=bw.Naca5(thickness=0.12, trailing_edge="blunt")
).build()
alpha = np.arange(-5.0, 15.1, 1.0)

polars = [bw.polar(airfoil, 3.5e6, alpha)]
polars[0].to_csv(directory / "naca-23012-polar.csv")
if find_spec("neuralfoil"):
    polars.append(bw.polar(airfoil, 3.5e6, alpha, solver="neuralfoil"))
draw_polar(polars, directory / "naca-23012-polar.png", angles=[-4.0, 4.0, 10.0])

segments = polars[0].segments(4.0)
print(polars[0])
print(segments)

# what Tortora, Concilio and Pecora (2023, table 14) have of the airfoil and of its six segments
at = int(np.argmin(np.abs(alpha - 4.0)))
assert abs(polars[0].cl[at] / 0.5743 - 1.0) < 0.01
assert abs(polars[0].cd[at] / 0.00601 - 1.0) < 0.03
published = [0.0126, 0.1697, 0.3218, 0.0592, -0.0073, 0.0182]
assert np.max(np.abs(segments.lift_pressure[:6] - published)) < 0.003
