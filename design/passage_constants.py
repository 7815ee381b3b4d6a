"""What the constants of `domain/` decide: the passages of eight machines with each constant smaller and larger.

python design/passage_constants.py --record design/passage_constants.md
"""

import argparse
import importlib
import pkgutil
import sys
import time
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

import numpy as np

import bladewright as bw
from bladewright import domain

MACHINES = (
    "nasa-rotor-67",
    "backswept-impeller",
    "radial-turbine",
    "propeller",
    "inlet-guide-vane",
    "booster-stator",
    "wedge-diffuser",
    "vki-ls89",
)
CONSTANTS = (
    ("camber_correspondence", "TERMS", (3, 12)),
    ("camber_correspondence", "LEAST_SLOPE", (0.05, 0.4)),
    ("checks", "AMPLE_JACOBIAN", (0.03, 0.12)),
    ("duct", "BEND", (0.02, 0.32)),
    ("duct", "LEAST_SINE", (1e-5, 1e-3)),
    ("duct", "LIMIT_SPANS", (20, 80)),
    ("duct", "LIMIT_LINES", (17, 65)),
    ("duct", "WALL_DEGREE", (5, 9)),
    ("duct", "MERIDIAN_TOLERANCE", (1e-13, 1e-10)),
    ("extents", "STEP", (0.125, 0.5)),
    ("extents", "BULGE_MARGIN", (1.0, 1.6)),
    ("extents", "CLEARANCE", (0.0, 0.1)),
    ("extents", "LIMIT_SHARE", (0.6, 0.95)),
    ("knot_selection", "WALL_TOLERANCE", (1e-8, 1e-6)),
    ("knot_selection", "MAX_POLES", (40, 160)),
    ("knot_selection", "JOINT_SPACING", (1e-6, 1e-2)),
    ("knot_selection", "SPAN_SPACING", (0.05, 0.2)),
    ("periodic_sector", "PLACES", (33, 129)),
    ("periodic_sector", "MERIDIAN_POINTS", (501, 8001)),
    ("periodic_sector", "OVERHANG", (0.002, 0.2)),
    ("periodic_sector", "ANGULAR_OVERHANG", (0.005, 0.2)),
    ("walls", "WIDE_PITCH", (2.0, 8.0)),
)
HEAD = """\
# Constants of passages

`{command}`: the passages of {machines}, with one constant changed at a time.

* refused: machines whose passage is refused;
* control points of all their faces;
* walls off: the largest distance of hub and shroud from their surfaces of revolution, in chords (limit 1e-7);
* fold: the least Jacobian of a wall's half over its median (limit 0);
* ring: the largest difference of blade count x (passage + blade) from the ring, of it;
* sector: the same of blade count x periodic sector, where a constant bears on it;
* s: processor time beside other work.

| constant | value | refused | control points | walls off | fold | ring | sector | s |
|---|---|---|---|---|---|---|---|---|
"""
ROOMS = [importlib.import_module(each.name) for each in pkgutil.iter_modules(domain.__path__, "bladewright.domain.")]


@contextmanager
def changed(module, name, value):
    """A constant with another value in every module of the room that knows it."""
    home = importlib.import_module(f"bladewright.domain.{module}")
    own = getattr(home, name)
    knowing = [
        room for room in ROOMS if getattr(room, name, None) is own and (room is home or imports(room, home, name))
    ]
    for room in knowing:
        setattr(room, name, value)
    try:
        yield
    finally:
        for room in knowing:
            setattr(room, name, own)


def imports(room, home, name):
    """Whether a module imports that name from its home."""
    source = Path(room.__file__).read_text(encoding="utf-8")
    return f"from {home.__name__} import" in source and name in source


def measured(blades, *, with_sector):
    """One row of figures for the passages of all blades."""
    refused, poles, off, fold, ring, sector = 0, 0, 0.0, np.inf, 0.0, 0.0
    start = time.process_time()
    for blade in blades:
        try:
            made = bw.passage(blade)
            if with_sector:
                share = (blade.design.blade_count or 1) * made.periodic_sector.properties.volume / made.ring - 1.0
                sector = max(sector, abs(float(share)))
        except bw.DesignError:
            refused += 1
            continue
        nets = [getattr(face, "surface", face).control_points for face in made.whole.values()]
        poles += sum(net.shape[0] * net.shape[1] for net in nets)
        off, fold = max(off, made.wall_error), min(fold, *(share for share, _, _ in made.folds.values()))
        ring = max(ring, abs(made.ring_error))
    seconds = time.process_time() - start
    shown = f"{sector:.1e}" if with_sector else ""
    return f"{refused} | {poles:,} | {off:.1e} | {fold:.3f} | {ring:.1e} | {shown} | {seconds:.1f}"


def rows(blades):
    """The table's rows, each printed as soon as it is known."""
    yield f"| as they are | | {measured(blades, with_sector=True)} |"
    for module, name, values in CONSTANTS:
        own = getattr(importlib.import_module(f"bladewright.domain.{module}"), name)
        for value in values:
            with changed(module, name, value):
                found = measured(blades, with_sector=module == "periodic_sector")
                yield f"| `{module}.{name}` = {own:g} | {value:g} | {found} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--record", type=Path, help="write the table to this file")
    parser.add_argument("--constants", nargs="*", help="only these, by name")
    given = parser.parse_args()
    global CONSTANTS  # noqa: PLW0603 - the table that was asked for
    CONSTANTS = [each for each in CONSTANTS if not given.constants or each[1] in given.constants]
    folder = resources.files("bladewright") / "examples"
    blades = [bw.read_design(folder / f"{name}.toml").build() for name in MACHINES]
    found = []
    for row in rows(blades):
        print(row, flush=True)
        found.append(row)
    if given.record:
        command = f"python design/passage_constants.py --record {given.record}"
        head = HEAD.format(command=command, machines=", ".join(MACHINES))
        given.record.write_text(head + "\n".join(found) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
