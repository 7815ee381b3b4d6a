"""Which points of clouds are told to be on hub, shroud and fillets: of blades with a part of their hub, and of none.

python design/walls.py
"""

import sys
import tempfile
from pathlib import Path

import matching_clouds as clouds
import numpy as np
from matching_rows import ROWS
from scipy.spatial import cKDTree

from bladewright.blade.design.fillet import Fillet
from bladewright.fitting.clouds.walls import walls_of
from bladewright.fitting.matching.footpoints import nearest_footpoints

MACHINES = (
    "compressor-stator",
    "aachen-stator",
    "fan-rotor",
    "centrifugal-impeller",
    "radial-turbine",
    "marine-propeller",
    "inlet-guide-vane",
    "mixed-flow-pump",
    "core-rotor",
    "exhaust-strut",
    "nasa-rotor-67",
)
GROUPS = ("examples", "drawn", "foreign", "naca", "brought")
OTHERS = ("ls89", "align", "annulus", "two", "axis", "suction", "half", "-like", "-unified")
"""words in the names of rows whose clouds are of a section, of several blades or in other axes, or are there already"""


def hub(plain, design, count, clear, draw):
    """Points of the hub around a blade, half a pitch or half a chord to each side, clear of its sides."""
    line, chord = plain.exact.wall("hub"), float(plain.chord)
    places = np.real(line.values(np.clip(draw.uniform(-0.12, 1.12, 20 * count), -0.1, 1.1)))
    row = np.concatenate([side(np.linspace(0.0, 1.0, 60), np.zeros(60)) for side in plain.sides])
    annular = plain.exact.mapping.revolved
    angle, radius = (np.arctan2(row[:, 1], row[:, 2]), np.hypot(*row.T[1:])) if annular else (row[:, 1], row[:, 2])
    near = cKDTree(np.stack([row[:, 0], radius], axis=-1)).query(places, k=2)[1]
    reach = min(0.5 * float(np.real(design.spacing)), 0.5 * chord / (np.median(radius) if annular else 1.0))
    at, r = np.mean(np.unwrap(angle)[near], axis=1) + draw.uniform(-reach, reach, len(places)), places[:, 1]
    points = np.stack([places[:, 0], r * np.sin(at) if annular else at, r * np.cos(at) if annular else r], axis=-1)
    return points[nearest_footpoints(points, plain.sides).heights > clear * chord][:count]


def of_machine(name, fillet, count, noise):
    """Points of an example's sides, of its fillet and of its hub, and how many there are of each."""
    draw, design = np.random.default_rng(1), clouds.example(name).plain
    plain = built = design.build()
    chord = float(plain.chord)
    if fillet:
        built = design.changed("hub_fillet", Fillet(radius=fillet * chord / design.metre)).build()
    parts = [clouds.scattered(built.sides, 3000, draw)]
    parts.append(
        clouds.scattered([s for n, s in built.surfaces.items() if "hub_fillet_" in n][:2], 300, draw)
        if fillet
        else np.empty((0, 3))
    )
    parts.append(hub(plain, design, count, 1.2 * fillet, draw))
    return clouds.noisy(np.concatenate(parts), draw, noise * chord), np.cumsum([len(each) for each in parts])[:-1]


def main():
    """Print how many points are told."""
    taken = tried = 0
    rows = [r for r in ROWS.values() if r.group in GROUPS and not any(word in r.name for word in OTHERS)]
    for row in rows:
        with tempfile.TemporaryDirectory() as directory:
            points = row.cloud(Path(directory)).points
        tried += points.shape[1] == 3
        if np.any(walls_of(points, None).kinds != ""):
            taken += 1
            print(f"points of {row.name} are taken")
    print(f"points of {taken} of {tried} clouds without walls are taken")
    print("| machine | hub points, fillet, noise | of the hub | of the fillet | of the sides |\n|---|---|---|---|---|")
    for name in MACHINES:
        for fillet, count, noise in ((0.0, 1000, 0.0), (0.0, 150, 0.0), (0.03, 1000, 1e-4), (0.03, 150, 1e-4)):
            points, ends = of_machine(name, fillet, count, noise)
            sides, on_fillet, on_hub = (np.count_nonzero(e != "") for e in np.split(walls_of(points, None).kinds, ends))
            print(f"| {name} | {count}, {fillet:g}, {noise:g} | {on_hub} | {on_fillet} | {sides} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
