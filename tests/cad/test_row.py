"""Rows as assemblies: one part proven like a lone blade, and every placement; what is wrong is found."""

from dataclasses import replace

import numpy as np
import pytest
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepTools import BRepTools
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.TopoDS import TopoDS_Compound
from OCP.XCAFDoc import XCAFDoc_DocumentTool

import bladewright as bw
from bladewright import cad
from bladewright.cad.kernel import quiet
from bladewright.cad.placement import location, write_brep_row
from bladewright.cad.solids import occ_solid
from bladewright.cad.step import write_step
from bladewright.domain.row import turn_matrix
from bladewright.errors import CadError
from bladewright.views.round_trip import round_trip_tables
from machines.coarse import CASCADE, ROTOR

SAMPLES = 100


@pytest.fixture(scope="module")
def row():
    return bw.row(ROTOR.build(), 5)


@pytest.fixture(scope="module")
def part(row):
    return occ_solid(row.blade)


@pytest.fixture(scope="module", params=["step", "brep"])
def filed(request, row, tmp_path_factory):
    path = tmp_path_factory.mktemp("row") / f"row.{request.param}"
    return path, cad.write(row, path, samples=SAMPLES)


def test_a_row_is_one_proven_part_and_its_placements(filed, row):
    _, trip = filed
    assert trip.passed, trip.failures
    assert (trip.solids, trip.shells, trip.free_edges) == (5, 5, 0)
    assert [face.name for face in trip.faces] == list(row.blade.surfaces)
    assert [each.name for each in trip.placements] == [f"blade_{k:02d}" for k in range(1, 6)]
    assert max(each.displacement for each in trip.placements) < 1e-9
    np.testing.assert_allclose(trip.volume.cad, 5e9 * row.blade.properties.volume, rtol=1e-7)
    data = trip.to_dict()
    assert data["limits"]["placement_mm"] == 1e-6
    assert data["placements"][4]["name"] == "blade_05"
    assert "placements: 5, at most" in str(trip)
    assert "5, at most" in round_trip_tables(data)


def test_a_step_file_of_a_row_holds_the_blade_once_and_names_its_copies(filed, row, tmp_path):
    path, trip = filed
    if trip.format != "STEP":
        pytest.skip("a BREP file has no names")
    cad.write(row.blade, tmp_path / "blade.step", samples=SAMPLES)
    assert path.stat().st_size < 1.1 * (tmp_path / "blade.step").stat().st_size
    reader = STEPCAFControl_Reader()
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    with quiet():
        reader.ReadFile(str(path))
        reader.Transfer(document)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())

    def name(label):
        found = TDataStd_Name()
        assert label.FindAttribute(TDataStd_Name.GetID_s(), found)
        return found.Get().ToExtString()

    roots, parts = TDF_LabelSequence(), TDF_LabelSequence()
    shapes.GetFreeShapes(roots)
    assert [name(each) for each in roots] == ["rotor-row"]
    shapes.GetComponents_s(roots.Value(1), parts)
    assert [name(each) for each in parts] == [f"blade_{k:02d}" for k in range(1, 6)]


def changed(row, k, **values):
    places = list(row.placements)
    places[k] = replace(places[k], **values)
    return replace(row, placements=tuple(places))


MUTATIONS = {
    "lost": (lambda row: replace(row, placements=row.placements[:2] + row.placements[3:]), "blade_03 is missing"),
    "the first is lost": (lambda row: replace(row, placements=row.placements[1:]), "blade_01 is missing"),
    "turned by a microdegree": (
        lambda row: changed(row, 2, turn=turn_matrix(np.radians(1e-6)) @ row.placements[2].turn),
        "blade_03 is ",
    ),
    "the first is turned": (lambda row: changed(row, 0, turn=turn_matrix(1e-7)), "blade_01 is "),
    "shifted": (lambda row: changed(row, 3, shift=np.array([1e-8, 0.0, 0.0])), "blade_04 is 1e-05 mm away"),
    "doubled": (
        lambda row: replace(row, placements=(*row.placements, replace(row.placements[1], name="blade_06"))),
        "2 blades stand where blade_02 does",
    ),
    "in the place of another": (lambda row: changed(row, 2, turn=row.placements[1].turn), "blade_03 is missing"),
}


@pytest.mark.parametrize(("mutation", "ending"), [*((each, "step") for each in MUTATIONS), ("doubled", "brep")])
def test_a_row_that_is_wrong_is_found(row, part, tmp_path, mutation, ending):
    wrong, words = MUTATIONS[mutation]
    path = tmp_path / f"wrong.{ending}"
    with quiet():
        if ending == "step":
            write_step(row.blade, part, str(path), schema="AP242", row=wrong(row))
        else:
            write_brep_row(wrong(row), part, str(path))
    trip = cad.verify(path, row, samples=SAMPLES)
    assert not trip.passed
    assert any(failure.startswith(words) for failure in trip.failures), trip.failures


def test_a_name_that_is_wrong_is_found(row, part, tmp_path):
    with quiet():
        write_step(row.blade, part, str(tmp_path / "w.step"), schema="AP242", row=changed(row, 1, name="blade_99"))
    trip = cad.verify(tmp_path / "w.step", row, samples=SAMPLES)
    assert "blade_02 is called 'blade_99' in the file" in trip.failures


def test_separate_solids_are_each_measured(row, part, tmp_path):
    # as of a program that keeps no assembly, with a part that stands nowhere near the first blade
    builder, whole = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(whole)
    for place in row.placements[1:] + row.placements[:1]:
        moved = BRepBuilderAPI_Transform(part.solid, location(place).Transformation(), theCopyGeom=True)
        builder.Add(whole, moved.Shape())
    assert BRepTools.Write_s(whole, str(tmp_path / "row.brep"))
    trip = cad.verify(tmp_path / "row.brep", row, samples=SAMPLES)
    assert trip.passed, trip.failures
    assert trip.solids == 5


def test_a_lone_blade_is_no_row_and_a_row_no_lone_blade(row, part, tmp_path):
    assert BRepTools.Write_s(part.solid, str(tmp_path / "blade.brep"))
    trip = cad.verify(tmp_path / "blade.brep", row, samples=SAMPLES)
    assert "the file holds 1 solids: the row has 5 blades" in trip.failures
    write_brep_row(bw.row(row.blade, 2), part, str(tmp_path / "row.brep"))
    trip = cad.verify(tmp_path / "row.brep", row.blade, samples=SAMPLES)
    assert "the file holds 2 solids: one closed body is one solid" in trip.failures


def test_a_row_of_a_cascade_in_inches(tmp_path):
    row = bw.row(CASCADE.build(), 2)
    trip = cad.write(row, tmp_path / "row.step", unit="in", samples=SAMPLES)
    assert trip.passed, trip.failures
    assert trip.solids == 2


@pytest.mark.parametrize("ending", ["igs", "stl", "3mf"])
def test_other_formats_are_refused(row, tmp_path, ending):
    with pytest.raises(CadError, match=r"files do not keep: write a \.step or a \.brep file, or one blade"):
        cad.write(row, tmp_path / f"row.{ending}")
    assert not list(tmp_path.iterdir())
