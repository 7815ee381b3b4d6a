"""A second way to a passage: OpenCASCADE cuts the blade out of the sector between exact surfaces of revolution."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BOPAlgo import BOPAlgo_MakerVolume
from OCP.BRep import BRep_Tool
from OCP.BRepAlgoAPI import BRepAlgoAPI_BuilderAlgo
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape, TopoDS_Solid
from OCP.TopTools import TopTools_ListOfShape

from bladewright.atomic_write import atomic_write
from bladewright.cad.closure import Closure, closure
from bladewright.cad.kernel import quiet
from bladewright.cad.native_body import MM, ClosedBody, NativeBody, header_text
from bladewright.cad.reading import format_of, read_cad_file, subshapes
from bladewright.cad.solids import OccSolid, occ_solid
from bladewright.cad.step import Schema, write_step
from bladewright.errors import CadError, GeometryError
from bladewright.numerics.elementary import Array

if TYPE_CHECKING:
    import cadquery

SPAN_EXTENSION = 0.05
"""Length, as a fraction of the blade's span, by which the blade is extended beyond the walls that cut it. More costs
nothing but may reach past the sector; with this value the cuts of design/cad_cutting.py agree with the native passage
within 3.4e-11 of the volume."""
QUADRATURE = (1e-7, 1e-9)
"""Relative errors of OpenCASCADE's volume quadrature, coarse and fine; their difference is an error estimate
(design/cad_quadrature.py)."""
VOLUME_TOLERANCE = 1e-9
"""Largest relative difference of the volume before writing and after reading: that of the finer quadrature."""


class Cuttable(Protocol):
    """A passage that can also be made by cutting."""

    @property
    def name(self) -> str:
        """Name of the product in a CAD file."""

    @property
    def periodic_sector(self) -> ClosedBody:
        """The space between inlet, outlet, periodic boundaries and exact walls, the blade not subtracted."""

    @property
    def blade(self) -> "Extensible":
        """The blade in it."""


class Extensible(Protocol):
    """A blade that can be extended beyond the walls."""

    def extended(self, span: float) -> NativeBody:
        """The blade extended beyond hub and shroud by a fraction of its span."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OccMassProperties:
    """Volume, area and centroid of a solid by OpenCASCADE's quadrature."""

    volume: float
    """[m^3]"""
    area: float
    """[m^2]"""
    centroid: Array
    """(3,) [m]"""
    volume_error: float
    """[m^3] bound: the difference of two quadratures, and what the gaps along the edges may add"""


@dataclass(frozen=True, kw_only=True, eq=False)
class CutPassage:
    """A passage as OpenCASCADE's boolean operation leaves it."""

    name: str
    description: str
    author: str
    organisation: str
    body: OccSolid
    """the solid [mm]; its faces are named as those of the sector, and with `blade_` in front as those of the blade"""
    properties: OccMassProperties
    gap: float
    """[m] largest gap between two faces at an edge"""

    @property
    def solid(self) -> "cadquery.Solid":
        """The closed solid, in millimetres."""
        import cadquery

        return cadquery.Solid(self.body.solid)


def cut_passage(passage: Cuttable, *, span: float = SPAN_EXTENSION) -> CutPassage:
    """The passage cut by OpenCASCADE: its sector minus its blade, extended by the fraction `span` of its span.

    The walls are exact surfaces of revolution, so that the volume shows how well the untrimmed patches of
    `Passage` follow them. Raises CadError where OpenCASCADE does not leave one closed, valid solid of named faces.
    """
    with quiet():
        # fresh solids, since the operation raises the tolerances of its arguments
        try:
            sector, blade = occ_solid(passage.periodic_sector), occ_solid(passage.blade.extended(span))
        except GeometryError as error:
            raise CadError(
                f"the sector of {passage.name!r} cannot be made: {error}. Each of its walls must be one face within a "
                "turn; take the passage of untrimmed patches instead, or a shorter one"
            ) from error
        whole = _difference(sector, blade, passage.name)
        closed = closure(whole)
        if closed.shells != 1 or closed.free_edges or closed.non_manifold_edges or not closed.valid:
            raise CadError(
                f"OpenCASCADE leaves a solid of {closed.shells} shells with {closed.free_edges} free edges of "
                f"{passage.name!r}, where one closed valid shell is needed: the blade does not stand within its sector "
                "from wall to wall; extend it further, or look at the pitch"
            )
        faces = _faces_by_name(whole, sector, blade)
        return CutPassage(
            name=f"{passage.name}-cut",
            description=header_text(passage, "description"),
            author=header_text(passage, "author"),
            organisation=header_text(passage, "organisation"),
            body=OccSolid(solid=whole, faces=faces, gap=max(edge.tolerance for edge in closed.edges)),
            properties=_mass_properties(whole, closed),
            gap=max(edge.gap for edge in closed.edges) / MM,
        )


def write_cut(cut: CutPassage, path: str | os.PathLike[str], *, schema: Schema = "AP242") -> None:
    """Write a cut passage to a STEP file, and read it again.

    The file is written completely or not at all. Raises CadError where it does not hold the same closed, valid solid
    with the same names.
    """
    path = Path(path)
    if format_of(path) != "STEP":
        raise CadError(f"{path} was asked for: a cut passage is written to STEP only; let the name end in .step")
    with quiet():
        with atomic_write(path) as unfinished:
            write_step(cut, cut.body, unfinished, schema=schema)
        opened = read_cad_file(path)
        closed = closure(opened.shape)
        volume = _volume(opened.shape, QUADRATURE[-1])[0]
        error = abs(volume / MM**3 / cut.properties.volume - 1.0)
    if (
        sorted(opened.names.values()) != sorted(cut.body.faces)
        or not closed.valid
        or closed.free_edges
        or error > VOLUME_TOLERANCE
    ):
        raise CadError(
            f"{path} came back with {len(opened.names)} of {len(cut.body.faces)} names, {closed.free_edges} free edges "
            f"and a volume off by {error:.2g}: at most {VOLUME_TOLERANCE:g} is allowed; write the passage of untrimmed "
            "patches instead"
        )


def _difference(sector: OccSolid, blade: OccSolid, name: str) -> TopoDS_Solid:
    """The sector minus the blade.

    OpenCASCADE splits the faces of both along their intersections, and makes all volumes that the pieces enclose; the
    passage is the one with the sector's outer faces. Its own subtraction sometimes returns the whole sector
    (design/cad_cutting.py).
    """
    both, divided = TopTools_ListOfShape(), TopTools_ListOfShape()
    both.Append(sector.solid)
    both.Append(blade.solid)
    division = BRepAlgoAPI_BuilderAlgo()
    division.SetArguments(both)
    # the edges of the sector deviate this much from its walls: whatever is nearer is to be taken as coincident
    division.SetFuzzyValue(max(sector.gap, blade.gap))
    division.Build()
    if not division.IsDone() or division.Shape().IsNull():
        raise CadError(f"OpenCASCADE cannot divide the sector of {name!r} by its blade; try a longer extension")
    for face in subshapes(division.Shape(), TopAbs_FACE):
        divided.Append(face)
    volumes = BOPAlgo_MakerVolume()
    volumes.SetArguments(divided)
    volumes.SetIntersect(False)
    volumes.Perform()
    outer = [BRep_Tool.Surface_s(face) for label, face in sector.faces.items() if label not in {"hub", "shroud"}]
    parts = [
        TopoDS.Solid_s(part)
        for part in subshapes(volumes.Shape(), TopAbs_SOLID)
        if any(BRep_Tool.Surface_s(TopoDS.Face_s(face)) in outer for face in subshapes(part, TopAbs_FACE))
    ]
    if len(parts) != 1:
        raise CadError(
            f"{len(parts)} parts of the sector and the blade of {name!r} reach its outer faces, where only the passage "
            "may: the blade leaves its sector; look at the pitch"
        )
    return parts[0]


def _faces_by_name(whole: TopoDS_Solid, sector: OccSolid, blade: OccSolid) -> dict[str, TopoDS_Face]:
    """The faces by name: a face that was cut still refers to the surface of the face it is a part of."""
    origins = {**sector.faces, **{f"blade_{name}": face for name, face in blade.faces.items() if name != "tip"}}
    origins |= {name: face for name, face in blade.faces.items() if name == "tip"}
    surfaces = {name: BRep_Tool.Surface_s(face) for name, face in origins.items()}
    faces: dict[str, TopoDS_Face] = {}
    for shape in subshapes(whole, TopAbs_FACE):
        face = TopoDS.Face_s(shape)
        own = BRep_Tool.Surface_s(face)
        found = [name for name, surface in surfaces.items() if surface == own]
        if len(found) != 1 or found[0] in faces:
            raise CadError(
                f"a face of the cut passage comes from {' and '.join(found) or 'nowhere'}, where each is the rest of "
                "one face: the blade's extension ends within the sector; extend it further"
            )
        faces[found[0]] = face
    return faces


def _mass_properties(whole: TopoDS_Solid, closed: Closure) -> OccMassProperties:
    (coarse, _), (volume, middle) = (_volume(whole, bound) for bound in QUADRATURE)
    area, box = GProp_GProps(), Bnd_Box()
    BRepGProp.SurfaceProperties_s(whole, area, QUADRATURE[0])
    BRepBndLib.Add_s(whole, box)
    size = float(np.sqrt(box.SquareExtent()))
    # the volume is a third of the flux of the position vector, which is at most half the diagonal long
    leak = sum(edge.mean_gap * edge.length for edge in closed.edges) * size / 6.0
    return OccMassProperties(
        volume=volume / MM**3,
        area=area.Mass() / MM**2,
        centroid=middle / MM,
        volume_error=(abs(volume - coarse) + QUADRATURE[-1] * volume + leak) / MM**3,
    )


def _volume(shape: TopoDS_Shape, bound: float) -> tuple[float, Array]:
    whole = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, whole, bound)
    middle = whole.CentreOfMass()
    return whole.Mass(), np.array([middle.X(), middle.Y(), middle.Z()])
