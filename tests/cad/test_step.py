"""STEP files: schema, header, names, unit, validation properties."""

import dataclasses
import re

import pytest
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_DocumentTool

import bladewright
from bladewright import cad
from bladewright.cad.reading import read_cad_file
from bladewright.errors import CadError

SCHEMAS = {
    "AP242": "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING",
    "AP214": "AUTOMOTIVE_DESIGN",
    "AP203": "CONFIG_CONTROL_DESIGN",
}


@pytest.mark.parametrize("schema", SCHEMAS)
def test_every_schema_is_written_read_and_passes(bodies, tmp_path, schema):
    path = tmp_path / "vane.step"
    trip = cad.write(bodies["linear"], path, schema=schema)
    assert trip.passed, str(trip)
    assert trip.schema == schema
    assert SCHEMAS[schema] in path.read_text()[:2000]


def test_the_schema_is_ap242_unless_another_is_asked_for(step):
    assert step[1].schema == "AP242"


def test_an_unknown_schema_is_refused(bodies, tmp_path):
    with pytest.raises(CadError, match="choose AP242, AP214 or AP203"):
        cad.write(bodies["linear"], tmp_path / "vane.step", schema="AP209")
    assert not list(tmp_path.iterdir())


def test_the_header_says_what_it_is_and_who_made_it(rotor, step):
    head = step[0].read_text().split("DATA;")[0].replace("\n", "")
    described = re.search(r"FILE_DESCRIPTION\(\('(.*?)'\)", head)[1]
    assert described == rotor.description
    name, author, organisation, system = re.search(
        r"FILE_NAME\('(.*?)','[-0-9T:]+',\s*\(\s*'(.*?)'\),\s*\(\s*'(.*?)'\),\s*'.*?',\s*'(.*?)'", head
    ).groups()
    assert (name, author, organisation) == (rotor.name, rotor.author, rotor.organisation)
    assert system == f"bladewright {bladewright.__version__}"


def test_product_solid_and_every_face_are_named(rotor, step):
    text = step[0].read_text()
    assert re.search(rf"= PRODUCT\('{rotor.name}'", text)
    assert re.search(rf"= MANIFOLD_SOLID_BREP\('{rotor.name}'", text)
    assert set(re.findall(r"= ADVANCED_FACE\('(.*?)'", text)) == set(rotor.surfaces)


def test_another_reader_finds_the_names_too(rotor, step):
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    reader = STEPCAFControl_Reader()
    assert reader.ReadFile(str(step[0])) == IFSelect_RetDone
    reader.Transfer(document)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = TDF_LabelSequence()
    shapes.GetFreeShapes(labels)
    assert labels.Length() == 1
    name = TDataStd_Name()
    assert labels.Value(1).FindAttribute(TDataStd_Name.GetID_s(), name)
    assert name.Get().ToExtString() == rotor.name


def test_names_of_any_letters_come_back(bodies, tmp_path):
    name = "Schaufel Ø5 'ß' \\ 翼"
    trip = cad.write(dataclasses.replace(bodies["linear"], name=name, author="Ünal"), tmp_path / "vane.step")
    assert trip.passed
    text = (tmp_path / "vane.step").read_text("ascii")
    coded = r"Schaufel \X2\00D8\X0\5 ''\X2\00DF\X0\'' \\ \X2\7FFC\X0" + "\\"
    assert f"PRODUCT('{coded}'" in text.replace("\n", "")


def test_lengths_are_in_millimetres(step):
    assert "SI_UNIT(.MILLI.,.METRE.)" in step[0].read_text()
    assert step[1].unit == "mm"


def test_validation_properties_hold_the_native_volume_area_and_centroid(rotor, step):
    text = step[0].read_text().replace("\n", "")
    properties = rotor.properties
    # the writer rounds to 13 digits
    for kind, value in (("VOLUME", properties.volume * 1e9), ("AREA", properties.area * 1e6)):
        found = re.search(rf"MEASURE_REPRESENTATION_ITEM\('[a-z ]+',{kind}_MEASURE\(\s*([-+.E0-9]+)\)", text)[1]
        assert float(found) == pytest.approx(value, rel=1e-12)
    centre = re.search(r"CARTESIAN_POINT\('centre point',\(([-+.E0-9, ]+)\)\)", text)[1]
    assert [float(x) for x in centre.split(",")] == pytest.approx(properties.centroid * 1e3, rel=1e-12)
    for what in ("volume", "surface area", "centroid"):
        assert re.search(rf"PROPERTY_DEFINITION\('geometric validation property',\s*'{what}'", text)


def test_the_uncertainty_covers_the_gaps_so_that_readers_keep_the_trimming_curves(step):
    text = step[0].read_text().replace("\n", "")
    uncertainty = float(re.search(r"UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\(([-+.E0-9]+)\)", text)[1])
    assert uncertainty >= step[1].edges.max_gap


def test_nothing_but_the_file_is_left_behind(rotor, tmp_path):
    cad.write(rotor, tmp_path / "rotor.step", samples=100)
    assert [path.name for path in tmp_path.iterdir()] == ["rotor.step"]


def test_the_file_names_its_faces_in_any_order(rotor, step):
    assert sorted(read_cad_file(step[0]).names.values()) == sorted(rotor.surfaces)
