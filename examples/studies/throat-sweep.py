"""What opens the throat of a turbine section: 128 designs of a Sobol sequence, their figures and three pictures."""

import sys
from importlib import resources
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

import bladewright as bw

with resources.as_file(resources.files("bladewright") / "examples" / "turbine-section.toml") as path:
    design = bw.read_design(path)
directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path.cwd()
directory.mkdir(parents=True, exist_ok=True)

runs = bw.sweep(
    design,
    {
        "stagger": (-34.0, -28.0),
        "metal_angle_out": (-71.0, -65.0),
        "pitch": (24.0, 30.0),
        "thickness_*": {"lower": 0.85, "upper": 1.15, "relative": True, "together": True},
    },
    ["throat", "gauge_angle", "solidity", "area"],
    sampling="sobol",
    samples=128,
    manifest=directory / "throat-sweep.jsonl",
    jobs=1,
)
print(runs)
runs.to_csv(directory / "throat-sweep.csv")
for drawing in ("parallel", "scatter", "effects"):
    figure = runs.plot(drawing)
    FigureCanvasAgg(figure)
    figure.savefig(directory / f"throat-sweep-{drawing}.png", dpi=90)

# how fast the throat opens with the pitch, by the runs: the slope of the plane through them
variables = np.array(list(runs.parameters.values())).T
plane = np.column_stack([variables - variables.mean(axis=0), np.ones(len(runs))])
slopes = np.linalg.lstsq(plane, runs.figures["throat"], rcond=None)[0]
opening = slopes[list(runs.parameters).index("pitch")]

# and by the section: a neighbour that moves by 1 mm along the pitch opens the throat by the throat line's share of it
section = design.build()
u = np.linspace(0.0, 1.0, 2001)
suction, pressure = (np.real(section.curves[name](u)) for name in ("upper", "lower"))
gaps = pressure + np.array([0.0, 1e-3 * design.pitch]) - suction[:, None]
line = gaps.reshape(-1, 2)[np.argmin(np.sum(gaps**2, axis=-1))]
share = line[1] / np.hypot(*line)
print(f"the throat opens by {opening:.3f} mm per mm of pitch; its line's share is {share:.3f}")
assert abs(opening - share) < 0.02
