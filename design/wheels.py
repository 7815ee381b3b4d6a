"""Measures sectors and wheels of examples, with discs, thin rims, shroud rings and fillets: closure, time, files.

python design/wheels.py --record design/wheels.md
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.disc import Disc, Outline
from bladewright.blade.design.fillet import Fillet


class Case(NamedTuple):
    """An example with what makes a wheel of it."""

    example: str
    parts: dict[str, Any]


def outlined(*points, radii=()):
    """A disc or a ring within lines and arcs."""
    return Disc(outline=Outline(points=points, radii=radii))


ROTOR_67 = outlined(
    (-7.0, 94.71), (-7.0, 80.0), (12.0, 40.0), (12.0, 32.0), (78.0, 32.0), (78.0, 40.0), (97.5, 100.0), (97.5, 118.37),
    radii=(4.0, 6.0, 2.0, 2.0, 6.0, 4.0),
)  # fmt: skip
FAN = outlined(
    (-7.0, 94.69), (-7.0, 80.0), (12.0, 40.0), (12.0, 32.0), (78.0, 32.0), (78.0, 40.0), (97.5, 100.0), (97.5, 117.97),
    radii=(4.0, 6.0, 2.0, 2.0, 6.0, 4.0),
)  # fmt: skip
IMPELLER = outlined(
    (-6.0, 24.04), (-6.0, 10.0), (82.0, 10.0), (82.0, 25.0), (70.0, 40.0), (70.0, 104.0), (66.0, 104.0),
    radii=(0.0, 0.0, 4.0, 12.0, 1.0),
)  # fmt: skip
CORE = outlined(
    (-2.97, 94.67), (-2.97, 84.0), (10.0, 60.0), (22.0, 60.0), (34.8, 88.0), (34.8, 99.35), radii=(2, 3, 3, 2)
)
TURBINE = outlined(
    (0.46, 60.61), (-4.0, 60.61), (-4.0, 30.0), (-12.0, 18.0), (-12.0, 6.0), (42.82, 6.0), (42.82, 15.62),
    radii=(1.0, 10.0, 4.0, 0.0, 0.0),
)  # fmt: skip
PUMP = outlined(
    (-1.97, 41.47), (-1.97, 16.0), (100.0, 16.0), (100.0, 34.0), (86.0, 40.0), (101.0, 100.0), (98.82, 108.84),
    radii=(0.0, 0.0, 3.0, 12.0, 3.0),
)  # fmt: skip
PROPELLER = outlined((-100.0, 190.0), (-100.0, 90.0), (120.0, 90.0), (120.0, 190.0), radii=(10.0, 10.0))

CASES = {
    "Rotor 67": Case("nasa-rotor-67", {"disc": ROTOR_67}),
    "Rotor 67, 2 mm fillets": Case("nasa-rotor-67", {"disc": ROTOR_67, "hub_fillet": Fillet(radius=2.0)}),
    "Rotor 67, thin rim": Case("nasa-rotor-67", {"disc": Disc(thickness=5.0)}),
    "fan with a tip gap": Case("fan-rotor", {"disc": FAN}),
    "fan, 3 mm fillets": Case("fan-rotor", {"disc": FAN, "hub_fillet": Fillet(radius=3.0)}),
    "centrifugal impeller": Case("centrifugal-impeller", {"disc": IMPELLER}),
    "impeller, 2 mm fillets": Case("centrifugal-impeller", {"disc": IMPELLER, "hub_fillet": Fillet(radius=2.0)}),
    "core rotor": Case("core-rotor", {"disc": CORE}),
    "core rotor, 1 mm fillets": Case("core-rotor", {"disc": CORE, "hub_fillet": Fillet(radius=1.0)}),
    "core rotor, shrouded": Case("core-rotor", {"disc": CORE, "shroud_ring": Disc(thickness=3.0)}),
    "radial turbine": Case("radial-turbine", {"disc": TURBINE}),
    "radial turbine, 1 mm fillets": Case("radial-turbine", {"disc": TURBINE, "hub_fillet": Fillet(radius=1.0)}),
    "mixed-flow pump, shrouded": Case("mixed-flow-pump", {"disc": PUMP, "shroud_ring": Disc(thickness=3.0)}),
    "mixed-flow pump, 3 mm fillets": Case("mixed-flow-pump", {"disc": PUMP, "hub_fillet": Fillet(radius=3.0)}),
    "propeller hub, 20 mm fillets": Case("propeller", {"disc": PROPELLER, "hub_fillet": Fillet(radius=20.0)}),
    "stator ring": Case("compressor-stator", {"shroud_ring": Disc(thickness=4.0)}),
}
COLUMNS = (
    "wheel",
    "blades",
    "faces",
    "native s",
    "solid s",
    "file, trip s",
    "gap mm",
    "volume",
    "N x sector",
    "ring, N x blade",
    "MB",
    "of N blades",
    "proof",
    "FreeCAD, gmsh",
)
HEAD = """\
# Wheels

`{command}`: examples with a disc, a thin rim or a shroud ring.

* native s: from the design to the wheel's native faces; solid s: from there to the closed solid; file, trip s: STEP
  written, reopened and measured; all seconds of the processor (limits 5 s to the solid, 30 s in all);
* gap: the largest tolerance of an edge (limit 1e-5 mm); volume: of the file over the native one, less one (1e-6);
* N x sector: the wheel's volume over that of all sectors, less one (1e-9); where the straight lines of the cyclic
  faces cross there is no sector;
* ring, N x blade: the wheel's volume over that of what the outline turns into and of the blades, less one: without
  fillets only the blades' ends off their walls, with fillets what is added;
* of N blades: the file's size over that of the blade's file times the number of blades (limit 2);
* FreeCAD, gmsh: solids that each finds, valid or not.

"""
FREECAD = """\
import Part
shape = Part.Shape()
shape.read({path!r})
print("FREECAD", len(shape.Solids), shape.isValid(), shape.isClosed(), shape.Volume)
"""
GMSH = """\
import gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
found = gmsh.model.occ.importShapes({path!r})
gmsh.model.occ.synchronize()
solids = gmsh.model.getEntities(3)
print("GMSH", len(solids), gmsh.model.occ.getMass(*solids[0]) if solids else 0.0)
"""


def measured(case: Case, folder: Path, *, programs: bool) -> list[str]:
    """The figures of one wheel, as cells."""
    file = resources.files("bladewright") / "examples" / f"{case.example}.toml"
    design = replace(bw.read_design(file), **case.parts)
    start = time.process_time()
    blade = design.build()
    wheel = bw.wheel(blade)
    faces = len(wheel.surfaces)
    native = time.process_time()
    cad.solid(wheel)
    solid = time.process_time()
    path = folder / "wheel.step"
    trip = cad.write(wheel, path).to_dict()
    done = time.process_time()
    cad.write(blade, folder / "blade.step")
    count = design.blade_count
    size, lone = path.stat().st_size, (folder / "blade.step").stat().st_size
    volume = float(wheel.properties.volume)
    parts = sum(float(pitch.carrier.volume) for pitch in wheel.pitches) + count * float(blade.plain.properties.volume)
    try:
        share = f"{volume / (count * float(bw.sector(blade).properties.volume)) - 1.0:.0e}"
    except bw.DesignError:
        share = "lines cross"
    return [
        str(count),
        str(faces),
        f"{native - start:.1f}",
        f"{solid - native:.1f}",
        f"{done - solid:.1f}",
        f"{trip['edges']['max_tolerance_mm']:.1e}",
        f"{trip['volume_mm3']['relative_error']:.0e}",
        share,
        f"{volume / parts - 1.0:.1e}",
        f"{size / 1e6:.1f}",
        f"{size / lone / count:.2f}",
        "passed" if trip["passed"] else "; ".join(trip["failures"])[:200],
        others(path, volume) if programs else "",
    ]


def others(path: Path, volume: float) -> str:
    """What FreeCAD and gmsh find in a file."""
    script = path.with_name("measure.py")
    script.write_text(FREECAD.format(path=str(path)))
    own = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    given = {"stdin": subprocess.DEVNULL, "capture_output": True, "text": True}
    run = ["freecadcmd", str(script)]
    found = subprocess.run(run, check=False, env={**own, "HOME": str(path.parent)}, **given).stdout
    told = next((line.split() for line in found.splitlines() if line.startswith("FREECAD")), None)
    free = "failed" if told is None else f"{told[1]} {'valid' if told[2:4] == ['True', 'True'] else 'invalid'}"
    run = [sys.executable, "-c", GMSH.format(path=str(path))]
    found = subprocess.run(run, check=False, **given).stdout
    told = next((line.split() for line in found.splitlines() if line.startswith("GMSH")), None)
    mesh = "failed" if told is None else f"{told[1]} ({float(told[2]) / volume / 1e9 - 1.0:.0e})"
    return f"{free}, {mesh}"


def main() -> None:
    """Measure all wheels, or those whose names contain a word."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--record", type=Path, help="write the figures to this file")
    parser.add_argument("--only", default="", help="only wheels whose names contain this")
    parser.add_argument("--no-programs", action="store_true", help="leave out FreeCAD and gmsh")
    options = parser.parse_args()
    head = ["| " + " | ".join(COLUMNS) + " |", "|" + " --- |" * len(COLUMNS)]
    sys.stdout.write("\n".join(head) + "\n")
    rows = {}
    with tempfile.TemporaryDirectory() as folder:
        # those of the longest runs first
        for name, case in sorted(CASES.items(), key=lambda each: "fillets" not in each[0]):
            if options.only not in name:
                continue
            try:
                cells = measured(case, Path(folder), programs=not options.no_programs)
            except bw.BladewrightError as error:
                cells = [f"{type(error).__name__}: {error}"]
            rows[name] = f"| {name} | " + " | ".join(cells) + " |"
            sys.stdout.write(rows[name] + "\n")
            sys.stdout.flush()
            if options.record:
                known = [rows[each] for each in CASES if each in rows]
                command = "python " + " ".join(sys.argv)
                options.record.write_text(HEAD.format(command=command) + "\n".join([*head, *known]) + "\n")


if __name__ == "__main__":
    main()
