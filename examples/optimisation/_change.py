"""What an optimisation does besides its search: read a design, write verified CAD files, draw the change."""

import json
import sys
from importlib import resources
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

import bladewright as bw
from bladewright import cad


def example(name):
    """The built-in design of that name."""
    with resources.as_file(resources.files("bladewright") / "examples" / f"{name}.toml") as path:
        return bw.read_design(path)


def export(blade, before, name):
    """Write the design, a verified STEP file and a picture of the sections before and after.

    They go to the directory that is the script's argument, or to the working directory.
    """
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path.cwd()
    directory.mkdir(parents=True, exist_ok=True)
    bw.write_design(blade.design, directory / f"{name}.toml")
    trip = cad.write(blade, directory / f"{name}.step")
    print(trip)
    assert trip.passed, trip.failures
    report = json.dumps(trip.to_dict(), indent=2)
    (directory / f"{name}.roundtrip.json").write_text(report + "\n", encoding="utf-8")
    _draw(blade, before, directory / f"{name}.png")


def _draw(blade, before, path):
    """Sections at three spans, unrolled on their mean radius [mm]."""
    figure = Figure(figsize=(15.0, 5.8), layout=ConstrainedLayoutEngine(w_pad=0.15, h_pad=0.15))
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 200))) / 2.0
    for axes, v, label in zip(figure.subplots(1, 3), (0.0, 0.5, 1.0), ("hub", "mid span", "tip"), strict=True):
        for built, style in ((before, {"color": "#8a97a3", "linestyle": "--"}), (blade, {"color": "#1f6f9f"})):
            outline = np.concatenate([built.surfaces["upper"](u, v), built.surfaces["lower"](u[::-1], v)])
            radius = np.hypot(outline[:, 1], outline[:, 2])
            around = radius.mean() * np.arctan2(outline[:, 1], outline[:, 2])
            along = outline[:, 0] if np.ptp(outline[:, 0]) > np.ptp(radius) else radius
            axes.fill(1e3 * along, 1e3 * around, alpha=0.12, color=style["color"], linewidth=0.0)
            axes.plot(1e3 * along, 1e3 * around, label="after" if built is blade else "before", **style)
        axes.set_aspect("equal")
        axes.set_title(f"{blade.name}: {label}", loc="left", fontweight="bold")
        axes.set_xlabel("x [mm]")
        axes.set_ylabel("r θ [mm]")
        axes.grid(color="#e4e9ee")
        axes.legend(frameon=False)
    FigureCanvasAgg(figure)
    figure.savefig(path, dpi=120)
