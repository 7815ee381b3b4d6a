"""Colours of faces: each part's own, one for all, or none, as other readers find them."""

import re
from types import SimpleNamespace

import pytest
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_ColorGen, XCAFDoc_ColorSurf, XCAFDoc_ColorTool, XCAFDoc_DocumentTool

from bladewright import cad
from bladewright.cad.colours import COLOURS, face_colours, part_of
from bladewright.cad.face_pieces import whole_name
from bladewright.errors import CadError
from machines.closed_form_passages import passage

PARTS = {"upper": "upper side", "lower": "lower side", "hub": "hub", "shroud": "shroud"}


def colours_in(path, reader=STEPCAFControl_Reader):
    """The name and colour of every face of a file, as OpenCASCADE's reader of assemblies has them."""
    made, reader = TDocStd_Document(TCollection_ExtendedString("XmlXCAF")), reader()
    Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    reader.ReadFile(str(path))
    reader.Transfer(made)
    whole, parts = TDF_LabelSequence(), TDF_LabelSequence()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(made.Main())
    shapes.GetFreeShapes(whole)
    shapes.GetSubShapes_s(whole.Value(1), parts)
    found = []
    for part in (parts.Value(place) for place in range(1, parts.Length() + 1)):
        name, colour = TDataStd_Name(), Quantity_Color()
        # OpenCASCADE's FindAttribute ends the process where there is none
        named = part.IsAttribute(TDataStd_Name.GetID_s()) and part.FindAttribute(TDataStd_Name.GetID_s(), name)
        kinds = (XCAFDoc_ColorSurf, XCAFDoc_ColorGen)
        if any(XCAFDoc_ColorTool.GetColor_s(part, kind, colour) for kind in kinds):
            shade = Quantity_Color.ColorToHex_s(colour).ToCString().lower()
            found.append((name.Get().ToExtString() if named else "", shade))
    return found


def test_every_face_of_a_step_file_has_the_colour_of_its_part(step):
    assert dict(colours_in(step[0])) == {name: COLOURS[part] for name, part in PARTS.items()}


def test_every_face_of_an_iges_file_has_a_colour(filed):
    shades = [shade for _, shade in colours_in(filed("annular", "igs")[0], IGESCAFControl_Reader)]
    assert sorted(shades) == sorted(COLOURS[part] for part in PARTS.values())


def test_one_colour_for_all_faces(rotor, tmp_path):
    cad.write(rotor, tmp_path / "rotor.step", colour="#8899aa", samples=100)
    assert dict(colours_in(tmp_path / "rotor.step")) == dict.fromkeys(rotor.surfaces, "#8899aa")


def test_no_colour_on_request(rotor, tmp_path):
    cad.write(rotor, tmp_path / "rotor.step", colour="none", samples=100)
    assert colours_in(tmp_path / "rotor.step") == []
    assert "COLOUR" not in (tmp_path / "rotor.step").read_text()


@pytest.mark.parametrize("colour", ["red", "#89a", "#8899ag", ""])
def test_what_is_no_colour_is_refused(rotor, tmp_path, colour):
    with pytest.raises(CadError, match=f"the colour {re.escape(repr(colour))} is none"):
        cad.write(rotor, tmp_path / "rotor.step", colour=colour)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("face", "part"),
    [
        ("upper", "suction side"), ("lower", "pressure side"), ("upper_1", "suction side"),
        ("blade_lower", "pressure side"), ("splitter_2_upper", "suction side"), ("blade_07_lower", "pressure side"),
        ("leading_edge", "edge"), ("blade_trailing_edge", "edge"), ("hub_fillet_upper", "fillet"),
        ("shroud_fillet_trailing_edge", "fillet"), ("hub", "hub"), ("hub_upper_inlet", "hub"), ("hub_wake", "hub"),
        ("shroud_stagnation", "shroud"), ("tip", "tip"), ("inlet_lower", "inlet"), ("outlet", "outlet"),
        ("periodic_upper", "periodic boundary"), ("cyclic_low", "periodic boundary"), ("splitter_hub", "hub"),
        ("rim_front", "disc"), ("bore", "disc"),
    ],
)  # fmt: skip
def test_the_name_of_a_face_says_its_part(face, part):
    assert part_of(face, "upper") == part


def test_the_suction_side_may_be_the_lower_one_or_unknown():
    assert (part_of("lower", "lower"), part_of("blade_upper", "lower")) == ("suction side", "pressure side")
    assert (part_of("lower", None), part_of("blade_upper", None)) == ("lower side", "upper side")


def test_blade_and_passage_know_the_suction_side():
    blade = SimpleNamespace(suction_side="lower", surfaces={"upper": None, "tip": None})
    assert face_colours(blade, "parts") == {"upper": COLOURS["pressure side"], "tip": COLOURS["tip"]}
    passage = SimpleNamespace(blade=blade, surfaces={"blade_lower": None})
    assert face_colours(passage, "parts") == {"blade_lower": COLOURS["suction side"]}


def test_the_pieces_of_a_face_have_its_colour(tmp_path):
    walls = passage()
    cad.write(walls, tmp_path / "passage.step", samples=100)
    found = dict(colours_in(tmp_path / "passage.step"))
    assert {"hub_upper_1", "hub_upper_2", "hub_upper_3"} < set(found)
    assert {name: COLOURS[part_of(whole_name(name, walls.surfaces), None)] for name in found} == found
