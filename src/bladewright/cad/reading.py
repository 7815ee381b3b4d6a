"""Reading STEP, IGES and BREP files: their shape in millimetres and the names of its faces."""

import re
from dataclasses import dataclass
from pathlib import Path

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Controller, IGESControl_Reader
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_Reader
from OCP.TColStd import TColStd_SequenceOfAsciiString
from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape, TopoDS_Solid
from OCP.TopTools import TopTools_IndexedMapOfShape

from bladewright.cad.kernel import quiet
from bladewright.errors import CadError
from bladewright.origin import Origin, unwrapped

FORMATS = {
    ".step": "STEP",
    ".stp": "STEP",
    ".iges": "IGES",
    ".igs": "IGES",
    ".brep": "BREP",
    ".stl": "STL",
    ".3mf": "3MF",
}
"""File format by the ending of a file's name."""

SEWING_TOLERANCE = 1e-4
"""[mm] Largest gap across which the faces of an IGES file without solids are sewn together. It is above the gaps that
the round trip allows, so that they are measured rather than refused, and far below the size of any edge."""

LARGEST_FILE = 500_000_000
"""[bytes] Size above which a file is refused. A blade takes about half a megabyte (105 bytes of STEP a control point,
44 x 48 of them on a side); the limit keeps OpenCASCADE from being handed whole assemblies by mistake."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CadFile:
    """What a CAD file holds."""

    path: Path
    format: str
    """STEP, IGES or BREP"""
    schema: str
    """application protocol of a STEP file, kind of entities of an IGES file"""
    unit: str
    """length unit that the file is written in"""
    system: str
    """program that wrote the file, as it says"""
    origin: Origin | None
    """the design that the file says it was made from"""
    shape: TopoDS_Shape
    """everything in the file [mm]"""
    names: dict[int, str]
    """names of the faces that have one, by index in `faces`"""
    solid_names: tuple[str, ...] = ()
    """names of the `solids` of a STEP file, as an assembly calls them; empty where one has none"""

    @property
    def written_by_bladewright(self) -> bool:
        """Whether the file says that bladewright wrote it."""
        return "bladewright" in self.system

    @property
    def faces(self) -> list[TopoDS_Face]:
        """All faces, in the order of the file."""
        return [TopoDS.Face_s(face) for face in subshapes(self.shape, TopAbs_FACE)]

    @property
    def solids(self) -> list[TopoDS_Solid]:
        """Every occurrence of a solid, in the order of the file; also of those that stand in the same place."""
        return occurrences(self.shape)


def occurrences(shape: TopoDS_Shape) -> list[TopoDS_Solid]:
    """Every occurrence of a solid in a shape."""
    found, walk = [], TopExp_Explorer(shape, TopAbs_SOLID)
    while walk.More():
        found.append(TopoDS.Solid_s(walk.Current()))
        walk.Next()
    return found


def subshapes(shape: TopoDS_Shape, kind: object) -> list[TopoDS_Shape]:
    """The distinct parts of a shape of one type (faces, edges...), in a fixed order."""
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, found)
    return [found.FindKey(i) for i in range(1, found.Extent() + 1)]


def format_of(path: Path) -> str:
    """The format that the ending of a path stands for. Raises CadError for an unknown ending."""
    ending = path.suffix.lower()
    if ending not in FORMATS:
        raise CadError(f"{path} ends in {ending or 'nothing'!r}: CAD files end in {', '.join(FORMATS)}; rename it")
    return FORMATS[ending]


def read_cad_file(path: Path) -> CadFile:
    """What a STEP, IGES or BREP file holds. Raises CadError where it is no such file, or an incomplete one."""
    kind = format_of(path)
    check_complete(path, kind)
    with quiet():
        opened = {"STEP": _step, "IGES": _iges, "BREP": _brep}[kind](path)
    if opened.shape.IsNull() or not opened.faces:
        raise CadError(f"{path} holds no face: it is not the {kind} file of a solid; write it again")
    return opened


def check_complete(path: Path, kind: str) -> None:
    """Raise CadError unless the file exists, begins as its format does and ends as it should."""
    head, tail = first_and_last_bytes(path)
    problem = f"{path} is not a whole {kind} file"
    if kind == "STEP":
        if b"ISO-10303-21" not in head:
            raise CadError(f"{problem}: it does not begin with ISO-10303-21; {_likely_format(head)}")
        if b"END-ISO-10303-21" not in tail:
            raise CadError(f"{problem}: it breaks off before END-ISO-10303-21, so a part is missing; write it again")
    elif kind == "IGES":
        lines = [line for line in head.splitlines() if line.strip()]
        if not lines or len(lines[0]) < 73 or lines[0][72:73] not in {b"S", b"B", b"C"}:
            raise CadError(f"{problem}: it does not begin with a start section; {_likely_format(head)}")
        last = [line for line in tail.splitlines() if line.strip()][-1]
        if last[72:73] != b"T":
            raise CadError(
                f"{problem}: it breaks off before its terminate section, so a part is missing; write it again"
            )
    elif kind == "BREP":
        if b"DBRep_DrawableShape" not in head and b"CASCADE Topology" not in head:
            raise CadError(f"{problem}: it does not begin with OpenCASCADE's name; {_likely_format(head)}")
        _check_brep_parts(path, problem)


def _check_brep_parts(path: Path, problem: str) -> None:
    """Raise CadError where a BREP file has fewer parts than it states, or does not name the last one as its content.

    OpenCASCADE would read on for ever: each part ends with an asterisk, for which it looks past the end of the file.
    """
    parts = path.read_bytes().rpartition(b"TShapes ")[2]
    stated = re.match(rb"\d+", parts)
    if stated is None or parts.count(b"*") != int(stated[0]) or not re.search(rb"\*\s*[+-]\d+ \d+\s*$", parts):
        raise CadError(f"{problem}: it breaks off before its last part, so a part is missing; write it again")


def first_and_last_bytes(path: Path) -> tuple[bytes, bytes]:
    """The first and last 4096 bytes of a file. Raises CadError where it cannot be read, or is empty or too large."""
    if path.is_dir():
        raise CadError(f"{path} is a directory: name a file in it")
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise CadError(f"{path} has {size / 1e6:.0f} MB: at most {LARGEST_FILE / 1e6:.0f} MB are opened; split it")
        with path.open("rb") as file:
            head = file.read(4096)
            file.seek(max(0, size - 4096))
            tail = file.read(4096)
    except OSError as error:
        raise CadError(f"cannot read {path}: {error.strerror}; check the name and the permissions") from error
    if not head.strip():
        raise CadError(f"{path} is empty: write it again")
    return head, tail


def _likely_format(head: bytes) -> str:
    known = {
        b"\x89PNG": "a PNG picture",
        b"%PDF": "a PDF",
        b"PK\x03\x04": "a ZIP archive",
        b"\xff\xd8": "a JPEG picture",
    }
    for signature, name in known.items():
        if head.startswith(signature):
            return f"it is {name}: give the CAD file"
    return "give the CAD file"


def _step(path: Path) -> CadFile:
    reader = STEPControl_Reader()
    # in other modes OpenCASCADE replaces the trimming curves of the file by projections
    Interface_Static.SetIVal_s("read.surfacecurve.mode", 0)
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise CadError(f"OpenCASCADE cannot read the STEP file {path}: its syntax is broken; write it again")
    reader.TransferRoots()
    shape = reader.OneShape()
    units = TColStd_SequenceOfAsciiString()
    reader.FileUnits(units, TColStd_SequenceOfAsciiString(), TColStd_SequenceOfAsciiString())
    header = APIHeaderSection_MakeHeader(reader.StepModel())
    schema = header.SchemaIdentifiersValue(1).ToCString() if header.NbSchemaIdentifiers() else ""
    system = header.OriginatingSystem().ToCString()
    described = (header.DescriptionValue(place).ToCString() for place in range(2, header.NbDescription() + 1))
    transferred = reader.WS().TransferReader()
    names, solid_names = {}, list[str]()
    for index, face in enumerate(subshapes(shape, TopAbs_FACE) if not shape.IsNull() else []):
        # the face of a part that is placed has its name where the part itself stands
        if name := _step_name(transferred, face.Located(TopLoc_Location())):
            names[index] = name
    if not shape.IsNull():
        solid_names = [_step_name(transferred, solid) for solid in occurrences(shape)]
    return CadFile(
        path=path,
        format="STEP",
        schema=_protocol(schema),
        unit=_unit([unit.ToCString() for unit in units]),
        system=step_plain(system),
        origin=Origin.from_lines(unwrapped([step_plain(line) for line in described])),
        shape=shape,
        names=names,
        solid_names=tuple(solid_names),
    )


def _step_name(transferred: object, shape: TopoDS_Shape) -> str:
    """The name of what a shape was read from; empty where it has none."""
    entity = transferred.EntityFromShapeResult(shape, 1)  # type: ignore[attr-defined]
    name = entity.Name() if hasattr(entity, "Name") else None
    return "" if name is None else step_plain(name.ToCString())


def step_plain(text: str) -> str:
    r"""Text with the \X2\ sequences of ISO 10303-21 decoded."""
    return re.sub(r"\\X2\\((?:[0-9A-Fa-f]{4})+)\\X0\\", lambda found: bytes.fromhex(found[1]).decode("utf-16-be"), text)


def _protocol(schema: str) -> str:
    known = {"AP242": "AP242", "AUTOMOTIVE": "AP214", "CONFIG": "AP203", "AP203": "AP203", "AP214": "AP214"}
    for start, name in known.items():
        if schema.upper().startswith(start):
            return name
    return schema


def _unit(units: list[str]) -> str:
    short = {"millimetre": "mm", "metre": "m", "inch": "in", "centimetre": "cm", "micrometre": "um", "foot": "ft"}
    return ", ".join(short.get(unit.lower(), unit.lower()) for unit in units) or "mm"


def _iges(path: Path) -> CadFile:
    IGESControl_Controller.Init_s()
    reader = IGESControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise CadError(f"OpenCASCADE cannot read the IGES file {path}: its syntax is broken; write it again")
    reader.TransferRoots()
    shape = reader.OneShape()
    model = reader.IGESModel()
    head = model.GlobalSection()
    system = head.SystemId().ToCString() if head.SystemId() is not None else ""
    unit = head.UnitName().ToCString() if head.UnitName() is not None else ""
    start = [model.StartLine(place).ljust(72) for place in range(1, model.NbStartLines() + 1)]
    transferred = reader.WS().TransferReader()
    names, kind = {}, "5.3 solid"
    faces = subshapes(shape, TopAbs_FACE) if not shape.IsNull() else []
    for index, face in enumerate(faces):
        entity = transferred.EntityFromShapeResult(face, 1)
        name = entity.NameValue() if hasattr(entity, "NameValue") else None
        if name is not None and name.ToCString().strip():
            names[index] = name.ToCString().strip()
    if faces and not subshapes(shape, TopAbs_SOLID):
        kind = "5.3 trimmed surfaces"
        shape, names = _sewn(shape, names)
    return CadFile(
        path=path,
        format="IGES",
        schema=kind,
        unit={"MM": "mm", "M": "m", "IN": "in", "INCH": "in", "CM": "cm", "FT": "ft"}.get(unit.upper(), unit.lower()),
        system=system,
        origin=Origin.from_lines([step_plain(line.rstrip()) for line in unwrapped(start)]),
        shape=shape,
        names=names,
    )


def _sewn(shape: TopoDS_Shape, names: dict[int, str]) -> tuple[TopoDS_Shape, dict[int, str]]:
    """Faces sewn together, as any CAD system that reads such a file has to do; a solid where they close a volume."""
    sewing = BRepBuilderAPI_Sewing(SEWING_TOLERANCE)
    sewing.Add(shape)
    sewing.Perform()
    whole = sewing.SewedShape()
    kept = {}
    shells = subshapes(whole, TopAbs_SHELL)
    if len(shells) == 1 and not sewing.NbFreeEdges():
        whole = BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(shells[0])).Solid()
    after = subshapes(whole, TopAbs_FACE)
    for index, face in enumerate(subshapes(shape, TopAbs_FACE)):
        if index in names:
            sewn = sewing.ModifiedSubShape(face)
            for place, candidate in enumerate(after):
                if candidate.IsSame(sewn):
                    kept[place] = names[index]
    return whole, kept


def _brep(path: Path) -> CadFile:
    shape = TopoDS_Shape()
    if not BRepTools.Read_s(shape, str(path), BRep_Builder()):
        raise CadError(f"OpenCASCADE cannot read the BREP file {path}: it is broken or cut off; write it again")
    return CadFile(
        path=path,
        format="BREP",
        schema="",
        unit="mm",
        system="",
        origin=None,
        shape=shape,
        names={},
    )
