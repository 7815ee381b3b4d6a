"""How far fillets read back from STEP lie off the ball that rolls along the blade and its wall.

Each cross-section of a fillet's face is a circle's arc: the ball through its ends and middle is that of the radius
asked for, all its points lie on that ball, and the ball's centre lies a radius off the hub.

    python design/fillet_balls.py
"""

import sys
import tempfile
from importlib.resources import files
from pathlib import Path

import numpy as np

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.fillet import Fillet
from bladewright.cad.file_face import file_face
from bladewright.cad.reading import read_cad_file

CASES = {
    "nasa-rotor-67": 2.0,
    "radial-turbine": 1.0,
    "centrifugal-impeller": 1.5,
    "core-rotor": 1.0,
    "mixed-flow-compressor": 1.0,
}
"""radii at the hub in the design's unit"""
ALONG, ACROSS = 301, 41
"""cross-sections of a face, and points of each"""


def centres(points):
    """Of the circles through the first, middle and last point of cross-sections (n, k, 3)."""
    start = points[:, 0]
    half, chord = points[:, points.shape[1] // 2] - start, points[:, -1] - start
    normal = np.cross(half, chord)
    square = [np.sum(each**2, axis=-1, keepdims=True) for each in (half, chord, normal)]
    return start + (square[1] * np.cross(normal, half) + square[0] * np.cross(chord, normal)) / (2.0 * square[2])


def off_wall(meridian, points):
    """Distances of (x, r) (n, 2) from a meridian curve, by Newton's method from its nearest samples."""
    samples = np.linspace(*meridian.domain, 4001)
    curve = meridian(samples)
    t = np.array([samples[np.argmin(np.sum((curve - point) ** 2, axis=-1))] for point in points])
    for _ in range(6):
        off, slope, bend = meridian(t) - points, meridian.derivative(t), meridian.derivative(t, 2)
        t = t - np.sum(off * slope, axis=-1) / np.sum(slope * slope + off * bend, axis=-1)
    return np.linalg.norm(meridian(t) - points, axis=-1)


def line(name: str, radius: float, folder: Path) -> str:
    """The figures of one blade, as cells."""
    design = bw.read_design(files("bladewright") / "examples" / f"{name}.toml")
    design = design.changed({"hub_fillet": Fillet(radius=radius), "shroud_fillet": None})
    blade = design.build()
    path = folder / f"{name}.step"
    trip = cad.write(blade, path)
    file = read_cad_file(path)
    meridian, _ = blade.end_wall("hub")
    size, off, wall, faces = radius * design.metre, 0.0, 0.0, 0
    for number, own in file.names.items():
        if not own.startswith("hub_fillet"):
            continue
        faces += 1
        region = file_face(file.faces[number]).region
        # the ends of a face about a corner's point have no cross-section
        u, w = (
            np.linspace(region.low[0], region.high[0], ALONG)[1:-1],
            np.linspace(region.low[1], region.high[1], ACROSS),
        )
        places = np.stack(np.meshgrid(u, w, indexing="ij"), axis=-1).reshape(-1, 2)
        points = 1e-3 * region.points(places).reshape(len(u), ACROSS, 3)
        centre = centres(points)
        off = max(off, np.max(np.abs(np.linalg.norm(points - centre[:, None], axis=-1) - size)) / size)
        meridional = np.stack([centre[:, 0], np.hypot(centre[:, 1], centre[:, 2])], axis=-1)
        wall = max(wall, np.max(np.abs(off_wall(meridian, meridional) - size)) / size)
    passed = "passed" if trip.passed else "NOT PROVEN"
    return f"| {name} | {radius:g} | {faces} | {off:.1e} | {wall:.1e} | {passed} |"


def table() -> list[str]:
    """Of all cases."""
    rows = [
        "| example | radius | faces of the fillet | points off the ball, R | ball off the hub, R | proof |",
        "|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        for name, radius in CASES.items():
            rows.append(line(name, radius, Path(folder)))
            sys.stdout.write(f"{rows[-1]}\n")
            sys.stdout.flush()
    return rows


if __name__ == "__main__":
    table()
