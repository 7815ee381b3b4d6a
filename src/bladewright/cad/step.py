"""STEP files: one product, one solid, every face named, with a header and geometric validation properties."""

import os
from collections.abc import Mapping
from typing import Literal

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.gp import gp_Pnt
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_HArray1OfHAsciiString, Interface_Static
from OCP.StepBasic import StepBasic_Product
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.StepShape import StepShape_ClosedShell, StepShape_ManifoldSolidBrep
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import (
    XCAFDoc_Area,
    XCAFDoc_Centroid,
    XCAFDoc_ColorSurf,
    XCAFDoc_DocumentTool,
    XCAFDoc_Volume,
)

from bladewright import __version__
from bladewright.cad.colours import occ_colour
from bladewright.cad.native_body import MM, CadProduct, NamedBody, header_text
from bladewright.cad.placement import location
from bladewright.cad.solids import CONFUSION, OccSolid
from bladewright.cad.units import MILLIMETRES, Unit
from bladewright.domain.row import Row
from bladewright.errors import CadError
from bladewright.origin import Origin, wrapped

Schema = Literal["AP242", "AP214", "AP203"]
"""application protocols of STEP that can be written"""

SCHEMAS: dict[str, str] = {"AP242": "AP242DIS", "AP214": "AP214IS", "AP203": "AP203"}
"""Application protocols and OpenCASCADE's names for them."""

UNITS: dict[Unit, str] = {"mm": "MM", "m": "M", "in": "INCH"}
"""Units of length, and OpenCASCADE's names for them."""

LINE = 240
"""[characters] of a line of the header's description, which are at most 256 (STRING(256) in ISO 10303-21)."""

SYSTEM = f"bladewright {__version__}"
"""Originating system in the headers of CAD files."""


def write_step(
    built: CadProduct,
    body: OccSolid,
    path: str,
    *,
    schema: str,
    unit: Unit = "mm",
    colours: Mapping[str, str] | None = None,
    origin: Origin | None = None,
    row: Row | None = None,
) -> None:
    """Write a STEP file in a unit of length, with the colours `#rrggbb` of the faces by name.

    With a `row`, `built` is its blade, and the file an assembly of one part and its placements. The description in the
    header names the design that the file was made from. Raises CadError where OpenCASCADE fails.
    """
    if schema not in SCHEMAS:
        raise CadError(f"schema {schema!r} is not a STEP schema that can be written: choose AP242, AP214 or AP203")
    writer = STEPCAFControl_Writer()
    _settings(schema, unit)
    writer.SetNameMode(True)
    writer.SetPropsMode(True)
    writer.SetColorMode(bool(colours))
    writer.SetLayerMode(False)
    # where a reader finds an edge further off a face than this uncertainty, it replaces the trimming curve by a coarse
    # one of its own (design/cad_trimming_curves.py)
    writer.ChangeWriter().SetTolerance(max(CONFUSION, body.gap))
    made, label = document(step_text(built.name), body, {name: step_text(name) for name in body.faces}, colours or {})
    # OpenCASCADE writes these as they are, and readers take them in the unit of the file
    properties, scale = built.properties, MM / MILLIMETRES[unit]
    XCAFDoc_Volume.Set_s(label, float(properties.volume) * scale**3)
    XCAFDoc_Area.Set_s(label, float(properties.area) * scale**2)
    XCAFDoc_Centroid.Set_s(label, gp_Pnt(*(properties.centroid * scale).tolist()))
    if row is not None:
        assemble(made, label, row)
    if not writer.Transfer(made, STEPControl_AsIs):
        raise CadError(f"OpenCASCADE could not translate the solid of {built.name!r} to STEP")
    model = writer.ChangeWriter().Model()
    _name_solid(model, built)
    _fill_header(APIHeaderSection_MakeHeader(model), row or built, origin)
    if writer.Write(os.fspath(path)) != IFSelect_RetDone:
        raise CadError("OpenCASCADE could not write the STEP file: is there space left in that directory?")


def document(
    name: str, body: OccSolid, names: Mapping[str, str], colours: Mapping[str, str]
) -> tuple[TDocStd_Document, TDF_Label]:
    """An XCAF document of one product, which the STEP and IGES writers take, and the label of its solid.

    `names` are the names of the faces as the format can write them, `colours` those of faces that have one.
    """
    made = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(made.Main())
    label = shapes.AddShape(body.solid, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    tool = XCAFDoc_DocumentTool.ColorTool_s(made.Main())
    for face, shape in body.faces.items():
        part = shapes.AddSubShape(label, shape)
        TDataStd_Name.Set_s(part, TCollection_ExtendedString(names[face]))
        if face in colours:
            tool.SetColor(part, occ_colour(colours[face]), XCAFDoc_ColorSurf)
    return made, label


def assemble(made: TDocStd_Document, part: TDF_Label, row: Row) -> None:
    """Put the placements of a row into the document of its blade: an assembly with one named component each."""
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(made.Main())
    whole = shapes.NewShape()
    TDataStd_Name.Set_s(whole, TCollection_ExtendedString(step_text(row.name)))
    for placement in row.placements:
        component = shapes.AddComponent(whole, part, location(placement))
        TDataStd_Name.Set_s(component, TCollection_ExtendedString(placement.name))
    shapes.UpdateAssemblies()


def _settings(schema: str, unit: Unit) -> None:
    Interface_Static.SetCVal_s("write.step.schema", SCHEMAS[schema])
    Interface_Static.SetCVal_s("write.step.unit", UNITS[unit])
    Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 1)


def _name_solid(model: object, built: CadProduct) -> None:
    name = TCollection_HAsciiString(step_text(built.name))
    left: set[type] = {StepShape_ManifoldSolidBrep, StepShape_ClosedShell, StepBasic_Product}
    for number in range(1, model.NbEntities() + 1):  # type: ignore[attr-defined]
        entity = model.Value(number)  # type: ignore[attr-defined]
        if isinstance(entity, (StepShape_ManifoldSolidBrep, StepShape_ClosedShell)):
            entity.SetName(name)
        elif isinstance(entity, StepBasic_Product):
            entity.SetDescription(TCollection_HAsciiString(step_text(header_text(built, "description"))))
        left.discard(type(entity))
        # what follows are thousands of points
        if not left:
            break


def _fill_header(header: APIHeaderSection_MakeHeader, built: NamedBody, origin: Origin | None) -> None:
    def texts(*values: str) -> Interface_HArray1OfHAsciiString:
        array = Interface_HArray1OfHAsciiString(1, len(values))
        for place, value in enumerate(values, start=1):
            array.SetValue(place, TCollection_HAsciiString(step_text(value)))
        return array

    made_from = [piece for line in (origin.lines() if origin else []) for piece in wrapped(line, LINE)]
    header.SetName(TCollection_HAsciiString(step_text(built.name)))
    header.SetDescription(texts(header_text(built, "description"), *made_from))
    header.SetAuthor(texts(header_text(built, "author")))
    header.SetOrganization(texts(header_text(built, "organisation")))
    header.SetOriginatingSystem(TCollection_HAsciiString(SYSTEM))
    header.SetAuthorisation(TCollection_HAsciiString(""))


def step_text(text: str) -> str:
    r"""Text as ISO 10303-21 encodes what is not ASCII: \X2\, the UTF-16 code units in hexadecimal, \X0\."""
    coded = []
    for letter in text:
        if letter.isascii() and letter.isprintable():
            coded.append(letter)
        else:
            coded.append("\\X2\\" + letter.encode("utf-16-be").hex().upper() + "\\X0\\")
    return "".join(coded).replace("\\X0\\\\X2\\", "")
