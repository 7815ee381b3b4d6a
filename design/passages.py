"""Measures the passages of all examples, with and without a gap: walls, folds, volumes, files, and the cut passage.

python design/passages.py --record design/passages.md
"""

import argparse
import sys
import tempfile
import time
from importlib import resources
from pathlib import Path

import numpy as np

import bladewright as bw
from bladewright import cad

GAP = 0.005
"""clearance that an example without one is given as well, of its least span at the edges"""
COLUMNS = (
    "passage",
    "walls off",
    "fold",
    "ring",
    "periodic poles",
    "STEP: untrimmed faces",
    "STEP: volume",
    "cut",
    "STEP: MB",
    "native s",
    "solid, STEP, trip s",
)
HEAD = """\
# Passages

`{command}`: every built-in example as it is, and with the other of gap and no gap; to the ends of the flow path where
there is one.

* walls off: hub and shroud from their surfaces of revolution, of the chord (limit 1e-7);
* fold: least Jacobian of the walls' patches in (m', theta), of its median; "trimmed" with `--walls trimmed`;
* ring: blade count x (passage + blade) over the ring between inlet and outlet, less one (limit 1e-6);
* periodic poles: one boundary's from the other's moved by a pitch, of their extent (limit 1e-12);
* STEP: the round trip's deviation of untrimmed faces (limit 1e-6 mm) and of the volume (limit 1e-6);
* cut: volume of the passage that OpenCASCADE cuts from its sector over the native one, less one (limit 1e-6); where
  the passage winds a full turn, of one that reaches 0.25 past the blade; empty with `--no-cut`;
* MB of the STEP file, and seconds of the processor.

"""


def designs():
    """Each example as it is, and with the other of gap and no gap, by name."""
    for file in sorted((resources.files("bladewright") / "examples").iterdir(), key=lambda each: each.name):
        if not file.name.endswith(".toml"):
            continue
        name, design = file.name.removesuffix(".toml"), bw.read_design(file)
        if hasattr(design, "axial_chord"):
            design = bw.prismatic(design)
        has = [gap for gap in ("tip_clearance", "hub_clearance") if getattr(design, gap, None) is not None]
        yield name, design
        if has:
            yield f"{name}, no gap", design.changed(dict.fromkeys(has))
        else:
            lines = design.exact_blade().meridional_view.lines
            edges = [lines[edge].points / design.metre for edge in ("leading_edge", "trailing_edge")]
            span = min(float(np.sqrt(np.sum((edge[-1] - edge[0]) ** 2))) for edge in edges)
            yield f"{name}, gap", design.changed("tip_clearance", GAP * span)


def measured(name, design, directory, *, cut, walls):
    """One row of the table."""
    blade = design.build()
    start = time.process_time()
    passage = bw.passage(blade, walls=walls)
    native = time.process_time() - start
    filled = (design.blade_count or 1) * (passage.properties.volume + blade.properties.volume)
    start = time.process_time()
    trip = cad.write(passage, Path(directory) / "passage.step")
    written = time.process_time() - start
    untrimmed = {name for name, face in passage.surfaces.items() if not hasattr(face, "boundary")}
    faces = max(face["max_deviation_mm"] for face in trip.to_dict()["faces"] if face["name"] in untrimmed)
    off = ""
    if cut:
        off = _cut(blade, passage)
    figures = [
        f"{passage.wall_error:.1e}",
        f"{min(share for share, _, _ in passage.folds.values()):.3f}" if passage.folds else "trimmed",
        f"{filled / passage.ring - 1.0:.1e}",
        f"{periodic(passage):.1e}",
        f"{faces:.1e} mm",
        f"{trip.to_dict()['volume_mm3']['relative_error']:.1e}",
        off,
        f"{(Path(directory) / 'passage.step').stat().st_size / 1e6:.2f}",
        f"{native:.2f}",
        f"{written:.1f}{'' if trip.passed else ' FAILED'}",
    ]
    return f"| {name} | {' | '.join(figures)} |"


def _cut(blade, passage):
    """The volume of the cut passage over the native one, less one; of a shorter one where a passage winds too far."""
    try:
        found = cad.cut_passage(passage)
    except bw.DesignError:
        passage = bw.passage(blade, upstream=0.25, downstream=0.25)
        found = cad.cut_passage(passage)
    return f"{found.properties.volume / passage.properties.volume - 1.0:.1e}"


def periodic(passage):
    """Largest distance of the upper periodic poles from the lower ones moved by a pitch, of their extent."""
    lower, upper = (passage.whole[f"periodic_{half}"].control_points for half in ("lower", "upper"))
    by = 2.0 * float(passage.half_pitch)
    x, y, z = np.moveaxis(lower, -1, 0)
    if passage.duct.revolved:
        moved = np.stack([x, y * np.cos(by) + z * np.sin(by), z * np.cos(by) - y * np.sin(by)], axis=-1)
    else:
        moved = np.stack([x, y + by, z], axis=-1)
    return np.max(np.abs(moved - upper)) / np.ptp(lower.reshape(-1, 3), axis=0).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="examples, all where none is named")
    parser.add_argument("--record", type=Path, help="Markdown file for the result")
    parser.add_argument("--no-cut", action="store_true", help="leave out the cut, which takes most of the time")
    parser.add_argument("--walls", choices=["auto", "trimmed"], default="auto", help="what the walls are made of")
    given = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as directory:
        for name, design in designs():
            if not given.names or name.split(",")[0] in given.names:
                rows.append(measured(name, design, directory, cut=not given.no_cut, walls=given.walls))
                print(rows[-1], flush=True)
    if given.record:
        given.record.write_text(_table(rows), encoding="utf-8")


def _table(rows):
    head = [f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|"]
    return HEAD.format(command=f"python {' '.join(sys.argv)}") + "\n".join([*head, *rows]) + "\n"


if __name__ == "__main__":
    main()
