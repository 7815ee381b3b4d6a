"""How OpenCASCADE cuts a blade out of its sector, and how well that agrees with the native passage.

Three ways to cut the extended blade from the sector between exact surfaces of revolution: the kernel's subtraction;
division of both solids by each other, and the part that has the sector's outer faces; the same division, and the
volumes that the divided faces enclose. Relative difference of the volume from the native passage, OpenCASCADE 7.9.3:

    example          subtraction    division    volumes of divided faces
    nasa-rotor-67    -3.4e-11       -3.4e-11    -3.4e-11
    aachen-stator    -3.2e-12       -3.2e-12    -3.2e-12
    vki-ls89         -1.7e-11       -1.7e-11    -1.7e-11
    fan-rotor        +2.3e-11       +2.3e-11    +2.3e-11

Nevertheless the third is used. When the walls' meridians went through fewer points, and the sector's edges lay 2.7e-5
mm off them, the kernel found all edges of the fan rotor and divided all faces, but decided that the blade's sides lie
outside the sector: subtraction and division returned the whole sector, +3.8e-2, the volumes of the divided faces
-7.1e-9. Making volumes needs no such decision, and costs a second.

    python design/cad_cutting.py
"""

from importlib.resources import files
from pathlib import Path

from OCP.BOPAlgo import BOPAlgo_MakerVolume
from OCP.BRep import BRep_Tool
from OCP.BRepAlgoAPI import BRepAlgoAPI_BuilderAlgo, BRepAlgoAPI_Cut
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopoDS import TopoDS
from OCP.TopTools import TopTools_ListOfShape

import bladewright as bw
from bladewright.cad.cutting import SPAN_EXTENSION
from bladewright.cad.kernel import quiet
from bladewright.cad.reading import subshapes
from bladewright.cad.solids import occ_solid

EXAMPLES = Path(str(files("bladewright"))) / "examples"


def main():
    for name in ("nasa-rotor-67", "aachen-stator", "vki-ls89", "fan-rotor"):
        passage = bw.passage(bw.read_design(EXAMPLES / f"{name}.toml").build())
        native = float(passage.properties.volume) * 1e9
        off = []
        for way in (subtracted, divided, made):
            # fresh solids: the operations raise tolerances of what they are given
            sector, blade = occ_solid(passage.periodic_sector), occ_solid(passage.blade.extended(SPAN_EXTENSION))
            with quiet():
                off.append(f"{volume(way(sector, blade), sector) / native - 1.0:+.1e}")
        print(f"{name:<22}", *off, sep="  ")


def subtracted(sector, blade):
    operation = BRepAlgoAPI_Cut()
    operation.SetArguments(listed([sector.solid]))
    operation.SetTools(listed([blade.solid]))
    operation.Build()
    return operation.Shape()


def divided(sector, blade):
    operation = BRepAlgoAPI_BuilderAlgo()
    operation.SetArguments(listed([sector.solid, blade.solid]))
    operation.Build()
    return operation.Shape()


def made(sector, blade):
    operation = BOPAlgo_MakerVolume()
    operation.SetArguments(listed(subshapes(divided(sector, blade), TopAbs_FACE)))
    operation.SetIntersect(False)  # noqa: FBT003  the kernel takes its flags by position
    operation.Perform()
    return operation.Shape()


def listed(shapes):
    found = TopTools_ListOfShape()
    for shape in shapes:
        found.Append(shape)
    return found


def volume(shape, sector):
    """Volume [mm^3] of the parts that have the sector's inlet."""
    inlet, total = BRep_Tool.Surface_s(sector.faces["inlet"]), 0.0
    for part in subshapes(shape, TopAbs_SOLID):
        if any(BRep_Tool.Surface_s(TopoDS.Face_s(face)) == inlet for face in subshapes(part, TopAbs_FACE)):
            properties = GProp_GProps()
            BRepGProp.VolumeProperties_s(part, properties, 1e-9)
            total += properties.Mass()
    return total


if __name__ == "__main__":
    main()
