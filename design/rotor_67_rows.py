"""How far the edges of Rotor 67's cloud lie from a smooth match, row by row, and whether one row predicts the next.

    python design/rotor_67_rows.py

Needs ../shared/data/clouds. The design is the example nasa-rotor-67, a match with 107 parameters. The points of each of
the 11 rows that lie beside an edge are moved along the chord and across it until they lie nearest to the design; the
moves of a row are then interpolated from those of the rows on both sides of it. Recorded in design/matching.md.
"""

from pathlib import Path

import numpy as np

from bladewright.files.clouds import read_cloud
from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed
from bladewright.fitting.matching.footpoints import nearest_footpoints

CLOUD = Path(__file__).resolve().parents[2] / "shared" / "data" / "clouds" / "NASA_R67.txt"
NAME = "nasa-rotor-67"
BESIDE = 0.06
"""how near to an edge, in u"""
ROWS = 0.03
"""gap along the span between rows, in v"""


def rows_of(v):
    """Indices of the points of each row."""
    order = np.argsort(v)
    return np.split(order, np.flatnonzero(np.diff(v[order]) > ROWS) + 1)


def moved(side, on, chosen, v, *, leading):
    """Move along the chord and across it [mm] that brings points nearest, and what is left (root mean square)."""
    at = np.array([v])
    ends = [side(np.array([u]), at)[0] for u in ((0.0, 0.1) if leading else (0.9, 1.0))]
    chord = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    across = np.cross(side.derivative(np.array([0.5]), at, 0, 1)[0], chord)
    ways = on.normals[chosen] @ np.stack([chord, across / np.linalg.norm(across)], axis=-1)
    heights = 1e3 * on.heights[chosen]
    move, *_ = np.linalg.lstsq(ways, heights, rcond=None)
    return move, np.sqrt(np.mean((heights - ways @ move) ** 2))


if __name__ == "__main__":
    points = read_cloud(CLOUD, columns=("skip", "z", "y", "x")).points
    built = design_from(parsed(example_text(NAME), NAME), NAME).build()
    on = nearest_footpoints(points, built.sides)
    for name, beside in (("leading", on.u < BESIDE), ("trailing", on.u > 1.0 - BESIDE)):
        # at the ends of the span the wall, and not the row, says where the blade ends
        rows = rows_of(on.v)[1:-1]
        places = np.array([np.mean(on.v[row]) for row in rows])
        found = [
            moved(built.sides[0], on, row[beside[row]], v, leading=name == "leading")
            for row, v in zip(rows, places, strict=True)
        ]
        along = np.array([move[0] for move, _ in found])
        inner = np.arange(1, len(rows) - 1)
        beside_it = np.array([np.interp(places[i], places[[i - 1, i + 1]], along[[i - 1, i + 1]]) for i in inner])
        print(f"{name} edge\n| v | along the chord | between the rows beside it | left, rms |\n|---|---|---|---|")
        for i, other in zip(inner, beside_it, strict=True):
            print(f"| {places[i]:.2f} | {along[i]:+.3f} | {other:+.3f} | {found[i][1]:.3f} |")
        size, error = (np.sqrt(np.mean(each**2)) for each in (along[inner], beside_it - along[inner]))
        print(f"rms {size:.3f} mm; error of what the rows beside foretell {error:.3f} mm")
