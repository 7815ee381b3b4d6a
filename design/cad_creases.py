"""What OpenCASCADE does with faces that have a crease: knots of full multiplicity inside a B-spline surface.

A passage's walls, periodic boundaries, inlet and outlet have such knots, so that each is one face of its own name.
Measured with OpenCASCADE 7.9.3 on the passages of Rotor 67 and of the Aachen stator:

* Its STEP reader keeps them in every mode of `read.surfacecurve.mode`, its IGES reader in every mode of
  `read.iges.bspline.continuity` (which splits free curves only): 10 faces, 34 edges, 24 vertices, gaps below 2e-8 mm.
* A line of the kernel has its length for a parameter, so that an edge with the blade's own [0, 1] needs a trimming
  curve of degree 1 on a wall, where it runs from one crease to the next. Both formats keep those.
* `ShapeFix_Shape` leaves the solid as it is; `ShapeUpgrade_ShapeDivideContinuity` splits it at the creases.
* Its quadrature without an error bound takes a number of points for the whole face and misses areas and volumes, which
  is what cadquery, FreeCAD and others print; with a bound, or with faces split at the creases, it does not:

    passage          faces    volume, no bound    volume, bound 1e-3
    nasa-rotor-67    10       -1.0e-03            -3.6e-10
    nasa-rotor-67    22       -1.9e-05            -3.8e-10
    aachen-stator    10       +1.2e-04            +1.5e-13
    aachen-stator    22       +7.3e-06            +1.5e-13

    python design/cad_creases.py
"""

import tempfile
from importlib.resources import files
from pathlib import Path

from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_C1
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Controller, IGESControl_Reader
from OCP.Interface import Interface_Static
from OCP.ShapeFix import ShapeFix_Shape
from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideContinuity
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_VERTEX

import bladewright as bw
from bladewright import cad
from bladewright.cad.closure import closure
from bladewright.cad.kernel import quiet
from bladewright.cad.reading import subshapes
from bladewright.cad.solids import occ_solid

EXAMPLES = Path(str(files("bladewright"))) / "examples"
SETTINGS = {"read.surfacecurve.mode": (0, 1, 2, 3, -3), "read.iges.bspline.continuity": (1, 0, 2)}


def main():
    for name in ("nasa-rotor-67", "aachen-stator"):
        passage = bw.passage(bw.read_design(EXAMPLES / f"{name}.toml").build())
        native = float(passage.properties.volume) * 1e9
        whole = occ_solid(passage).solid
        fixed = ShapeFix_Shape(whole)
        fixed.Perform()
        print(name, "after ShapeFix_Shape", counts(fixed.Shape()))
        for shape in (whole, divided(whole)):
            off = " ".join(f"{volume(shape, *bound) / native - 1.0:+.1e}" for bound in ((), (1e-3,)))
            print(f"{name}    {len(subshapes(shape, TopAbs_FACE))} faces    {off}")
        with tempfile.TemporaryDirectory() as folder, quiet():
            read_back(passage, Path(folder))


def read_back(passage, folder):
    IGESControl_Controller.Init_s()
    readers = zip(("passage.step", "passage.igs"), (STEPControl_Reader, IGESControl_Reader), SETTINGS, strict=True)
    for file, reader, setting in readers:
        cad.write(passage, folder / file, samples=400)
        for value in SETTINGS[setting]:
            opened = reader()
            Interface_Static.SetIVal_s(setting, value)
            opened.ReadFile(str(folder / file))
            opened.TransferRoots()
            closed = closure(opened.OneShape())
            gap = max(joint.gap for joint in closed.edges)
            print(f"{file} {setting} = {value}", counts(opened.OneShape()), f"gap {gap:.1e} mm", closed.valid)
        Interface_Static.SetIVal_s(setting, SETTINGS[setting][0])


def counts(shape):
    return tuple(len(subshapes(shape, kind)) for kind in (TopAbs_FACE, TopAbs_EDGE, TopAbs_VERTEX))


def divided(shape):
    division = ShapeUpgrade_ShapeDivideContinuity(shape)
    division.SetSurfaceCriterion(GeomAbs_C1)
    division.SetTolerance(1e-9)
    division.Perform()
    return division.Result()


def volume(shape, *bound):
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, *bound)
    return properties.Mass()


if __name__ == "__main__":
    main()
