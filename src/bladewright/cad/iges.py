"""IGES files: a manifold solid (entity 186) or trimmed surfaces (144), faces named by label and name property."""

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path

from OCP.IGESCAFControl import IGESCAFControl_Writer
from OCP.IGESControl import IGESControl_Controller
from OCP.IGESData import IGESData_IGESModel, IGESData_IGESWriter
from OCP.IGESSelect import IGESSelect_WorkLibrary
from OCP.Interface import Interface_Static
from OCP.TCollection import TCollection_HAsciiString

from bladewright.cad.native_body import NativeBody, header_text
from bladewright.cad.solids import CONFUSION, OccSolid
from bladewright.cad.step import SYSTEM, UNITS, document, step_text
from bladewright.cad.units import Unit
from bladewright.errors import CadError
from bladewright.origin import Origin, wrapped

COLUMNS = 72
"""of a line of the start section"""
DECIMALS = 12
"""of the numbers in a file: OpenCASCADE alone writes nine, which leaves 5e-7 mm in a file in metres, and areas that are
off by 1.8e-9 where knots are rounded; twelve make a blade's file a tenth larger."""


def write_iges(
    built: NativeBody,
    body: OccSolid,
    path: str,
    *,
    solid: bool,
    unit: Unit = "mm",
    colours: Mapping[str, str] | None = None,
    origin: Origin | None = None,
) -> None:
    """Write an IGES 5.3 file in a unit of length, with the colours `#rrggbb` of the faces by name.

    Its start section names the design that it was made from. Raises CadError where OpenCASCADE fails.
    """
    IGESControl_Controller.Init_s()
    Interface_Static.SetCVal_s("write.iges.unit", UNITS[unit])
    # mode 0, the default, writes the faces without the solid that they close
    Interface_Static.SetIVal_s("write.iges.brep.mode", 1 if solid else 0)
    Interface_Static.SetIVal_s("write.precision.mode", 2)
    Interface_Static.SetRVal_s("write.precision.val", max(CONFUSION, body.gap))
    writer = IGESCAFControl_Writer()
    writer.SetNameMode(True)
    writer.SetColorMode(bool(colours))
    writer.SetLayerMode(False)
    made, _ = document(ascii_text(built.name), body, {name: ascii_text(name) for name in body.faces}, colours or {})
    if not writer.Transfer(made):
        raise CadError(f"OpenCASCADE could not translate the solid of {built.name!r} to IGES")
    model = writer.Model()
    head = model.GlobalSection()
    head.SetSendName(_text(built.name))
    head.SetFileName(_text(built.name))
    head.SetSystemId(_text(SYSTEM))
    head.SetInterfaceVersion(_text(SYSTEM))
    head.SetReceiveName(_text(built.name))
    head.SetAuthorName(_text(header_text(built, "author")))
    head.SetCompanyName(_text(header_text(built, "organisation")))
    model.SetGlobalSection(head)
    for line in origin.lines() if origin else ():
        for piece in wrapped(step_text(line), COLUMNS):
            model.AddStartLine(piece)
    writer.ComputeModel()
    Path(path).write_bytes(_printed(model))


def _printed(model: IGESData_IGESModel) -> bytes:
    """The file of a model."""
    writer, text = IGESData_IGESWriter(model), BytesIO()
    numbers = writer.FloatWriter()
    numbers.SetFormat(f"%{DECIMALS + 2}.{DECIMALS}E", reset=False)
    numbers.SetFormatForRange(f"%{DECIMALS + 2}.{DECIMALS}f", 0.1, 1000.0)
    writer.SendModel(IGESSelect_WorkLibrary.DefineProtocol_s())
    if not writer.Print(text):
        raise CadError("OpenCASCADE could not write the IGES file")
    return text.getvalue()


def ascii_text(text: str) -> str:
    """Text as IGES can hold it: ASCII, with a question mark for any other character."""
    return "".join(letter if letter.isascii() and letter.isprintable() else "?" for letter in text)


def _text(value: str) -> TCollection_HAsciiString:
    return TCollection_HAsciiString(ascii_text(value))
