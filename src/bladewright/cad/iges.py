"""IGES files: a manifold solid (entity 186) or trimmed surfaces (144), faces named by label and name property."""

import os

from OCP.IGESCAFControl import IGESCAFControl_Writer
from OCP.IGESControl import IGESControl_Controller
from OCP.Interface import Interface_Static
from OCP.TCollection import TCollection_HAsciiString

from bladewright.cad.native_body import NativeBody, header_text
from bladewright.cad.solids import CONFUSION, OccSolid
from bladewright.cad.step import SYSTEM, document
from bladewright.errors import CadError


def write_iges(built: NativeBody, body: OccSolid, path: str, *, solid: bool) -> None:
    """Write an IGES 5.3 file in millimetres. Raises CadError where OpenCASCADE fails."""
    IGESControl_Controller.Init_s()
    Interface_Static.SetCVal_s("write.iges.unit", "MM")
    # mode 0, the default, writes the faces without the solid that they close
    Interface_Static.SetIVal_s("write.iges.brep.mode", 1 if solid else 0)
    Interface_Static.SetIVal_s("write.precision.mode", 2)
    Interface_Static.SetRVal_s("write.precision.val", max(CONFUSION, body.gap))
    writer = IGESCAFControl_Writer()
    writer.SetNameMode(True)
    writer.SetColorMode(False)
    writer.SetLayerMode(False)
    made, _ = document(ascii_text(built.name), body, {name: ascii_text(name) for name in body.faces})
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
    writer.ComputeModel()
    if not writer.Write(os.fspath(path), False):
        raise CadError("OpenCASCADE could not write the IGES file: is there space left in that directory?")


def ascii_text(text: str) -> str:
    """Text as IGES can hold it: ASCII, with a question mark for any other character."""
    return "".join(letter if letter.isascii() and letter.isprintable() else "?" for letter in text)


def _text(value: str) -> TCollection_HAsciiString:
    return TCollection_HAsciiString(ascii_text(value))
