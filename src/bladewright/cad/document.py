"""The kernel's document of one named product with named faces, which its STEP and IGES writers take."""

from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from bladewright.cad.solids import Body


def document(name: str, body: Body, names: dict[str, str]) -> tuple[TDocStd_Document, TDF_Label]:
    """A document with the body's solid, and the solid's label; `names` are the texts by which the faces go."""
    made = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(made.Main())
    label = shapes.AddShape(body.solid, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    for face, shape in body.faces.items():
        TDataStd_Name.Set_s(shapes.AddSubShape(label, shape), TCollection_ExtendedString(names[face]))
    return made, label
