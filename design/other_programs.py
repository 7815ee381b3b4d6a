"""What FreeCAD, CadQuery and gmsh make of the files of all examples, as they are, with `--split` and with `--fine`.

Also of the wheels of those with a disc or a shroud ring, as they are and with `--split`.

    python design/other_programs.py [EXAMPLE]...

For each example: the poles of a side, how far CadQuery's and FreeCAD's volumes are off the native one, the largest gap
between edges and faces, what FreeCAD's geometry check says, and the size of the STEP file. FreeCAD (`freecadcmd`, in
Debian's package freecad) runs without a window; where it is absent its columns stay empty.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import cadquery
import gmsh

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.families import prismatic
from bladewright.files.examples import examples

FREECAD = """
import json, os, Part
found = {}
for name in sorted(os.listdir(os.environ["STEP_FILES"])):
    shape = Part.Shape()
    shape.read(os.path.join(os.environ["STEP_FILES"], name))
    try:
        # in a wheel it takes minutes to look for parts that meet where they should not
        shape.check(len(shape.Faces) < 60)
        said = ""
    except Exception as fault:
        said = str(fault)
    found[name] = {"volume": shape.Volume, "solids": len(shape.Solids), "valid": shape.isValid(), "check": said}
print("FOUND " + json.dumps(found))
"""


def freecad(folder):
    """What FreeCAD says of each file in a folder; nothing where it is not installed."""
    program = shutil.which("freecadcmd")
    if program is None:
        return {}
    with tempfile.TemporaryDirectory() as home:
        script = Path(home) / "measure.py"
        script.write_text(FREECAD)
        own = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        run = subprocess.run(
            [program, script],
            env={**own, "HOME": home, "STEP_FILES": str(folder)},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )
    return json.loads(next(line for line in run.stdout.splitlines() if line.startswith("FOUND "))[6:])


def gmsh_volume(path):
    """Volume [mm^3] and number of solids that gmsh reads without repair."""
    gmsh.initialize()
    try:
        for option in ("General.Terminal", "Geometry.OCCAutoFix", "Geometry.OCCSewFaces", "Geometry.OCCFixSmallEdges"):
            gmsh.option.setNumber(option, 0)
        gmsh.model.occ.importShapes(str(path))
        gmsh.model.occ.synchronize()
        solids = gmsh.model.getEntities(3)
        return sum(gmsh.model.occ.getMass(*solid) for solid in solids), len(solids)
    finally:
        gmsh.finalize()


def main(names):
    with tempfile.TemporaryDirectory() as folder:
        rows = {}
        for name in names or sorted(examples()):
            design = bw.read_design(Path(bw.__file__).parent / "examples" / f"{name}.toml")
            design = prismatic(design) if design.dimension == 2 else design
            blade, fine = design.build(), design.build(fine=True)
            bodies = [("", blade, False), ("-split", blade, True), ("-fine", fine, False)]
            if design.disc or design.shroud_ring:
                made = bw.wheel(blade)
                bodies += [("-wheel", made, False), ("-wheel-split", made, True)]
            for ending, body, split in bodies:
                path = Path(folder) / f"{name}{ending}.step"
                sides = fine if ending == "-fine" else blade
                rows[path] = sides.knots.poles, cad.write(body, path, split=split, samples=400)
        seen = freecad(folder)
        print("| file | poles | faces | CadQuery's volume off | FreeCAD's | gmsh's | gap [mm] | FreeCAD's check | kB |")
        print("|---|---|---|---|---|---|---|---|---|")
        for path, (poles, trip) in rows.items():
            native = trip.volume.native
            opened = cadquery.importers.importStep(str(path)).val()
            assert opened.isValid()
            mass, solids = gmsh_volume(path)
            assert (len(opened.Solids()), solids, trip.passed) == (1, 1, True)
            own = seen.get(path.name)
            volumes = [opened.Volume(), own["volume"] if own else float("nan"), mass]
            faults = sorted({line.split(": ")[1] for line in own["check"].splitlines()[1:]}) if own else []
            said = ", ".join(fault.removeprefix("BOPAlgo_") for fault in faults) or ("nothing" if own else "")
            print(
                f"| {path.stem} | {poles[0]} x {poles[1]} | {len(opened.Faces())} |",
                *(f"{volume / native - 1.0:+.1e} |" for volume in volumes),
                f"{trip.edges.max_gap:.1e} | {said} | {path.stat().st_size / 1024:.0f} |",
            )


if __name__ == "__main__":
    main(sys.argv[1:])
