"""Round trips: accuracy, the report, and files that other programs wrote in their own way."""

import copy
import json
import pickle

import numpy as np
import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
from OCP.GeomAbs import GeomAbs_C3
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Writer
from OCP.Interface import Interface_Static
from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideContinuity
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

from bladewright import cad
from bladewright.cad.solids import occ_solid
from bladewright.cad.verification import AREA_LIMIT, limits_of, rounded_area
from bladewright.nurbs.measure import area
from bladewright.nurbs.surface import Surface

SEARCHED = 1000
"""points a face of a foreign file, each of which is searched for on the native face"""
REPORT = {
    "file", "format", "schema", "unit", "passed", "failures", "limits", "solids", "shells", "free_edges", "valid",
    "kernel_check", "faces", "edges", "volume_mm3", "area_mm2", "centroid_mm", "version", "design",
}  # fmt: skip
SIDE = {"step": 1e-9, "igs": 1e-7, "brep": 1e-11}
"""[mm] what a file's digits allow for a blade of 0.1 m: STEP keeps 14 or 15, IGES as many as leave 1e-8 mm"""


def foreign_step(shape, path):
    writer = STEPControl_Writer()
    assert writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone
    assert writer.Write(str(path)) == IFSelect_RetDone


def test_a_files_digits_may_move_the_area_of_a_narrow_face_by_what_is_allowed():
    along, across = np.meshgrid(np.linspace(0.0, 8.0, 6), np.linspace(0.0, 0.05, 6), indexing="ij")
    net = np.stack([180.0 + across + 0.3 * along, along, 1353.0 + across * along], axis=-1) / 3.0 + [0.0, 0.0, 902.0]
    clamped = np.repeat([0.0, 1.0], 6)
    narrow = Surface(control_points=net, knots_u=clamped, knots_v=clamped, degree_u=5, degree_v=5)
    written = Surface(control_points=np.round(net, 9), knots_u=clamped, knots_v=clamped, degree_u=5, degree_v=5)
    off = abs(float(area(written)) - float(area(narrow)))
    assert AREA_LIMIT * float(area(narrow)) < off < rounded_area(net)


@pytest.mark.parametrize("ending", SIDE)
def test_every_body_passes_its_round_trip_in_every_format(body, built, filed, ending):
    trip = filed(body, ending)[1]
    assert trip.passed, str(trip)
    assert (trip.solids, trip.shells, trip.free_edges, trip.valid) == (1, 1, 0, True)
    assert {face.name for face in trip.faces} == set(built.surfaces)
    for face in trip.faces:
        assert face.samples == 10_000
        if isinstance(built.surfaces[face.name], Surface):
            assert face.max_deviation <= SIDE[ending]
            assert face.area.relative_error <= 1e-9
    assert trip.volume.relative_error <= 1e-6
    assert trip.area.relative_error <= 1e-6
    assert trip.centroid_distance <= 1e-6 * 100.0


def test_the_report_is_what_was_promised(step):
    report = json.loads(json.dumps(step[1].to_dict()))
    assert set(report) == REPORT | {"promises"}
    limits = report["limits"]
    assert (limits["side_mm"], limits["edge_mm"], limits["face_area"], limits["volume"]) == (1e-6, 1e-6, 1e-9, 1e-6)
    assert set(report["faces"][0]) == {
        "name", "samples", "pieces", "max_deviation_mm", "mean_deviation_mm", "worst", "area_mm2",
    }  # fmt: skip
    assert set(report["faces"][0]["worst"]) == {"u", "v"}
    assert set(report["edges"]) == {"count", "shortest_mm", "max_gap_mm", "max_tolerance_mm"}
    assert set(report["volume_mm3"]) == {"cad", "native", "relative_error", "kernel_default"}
    assert set(report["volume_mm3"]["kernel_default"]) == {"cad", "relative_error"}
    assert set(report["area_mm2"]) == {"cad", "native", "relative_error"}
    assert set(report["centroid_mm"]) == {"cad", "native", "distance"}
    assert report["edges"]["count"] == 6
    assert report["file"] == "rotor.step"
    assert report["promises"] == {"surface_error_m": 1e-9}


def test_the_printed_report_gives_the_verdict_and_every_face(rotor, step):
    text = str(step[1])
    assert "rotor.step (STEP AP242, mm): passed" in text
    assert all(name in text for name in rotor.surfaces)


def test_the_shortest_edge_is_the_shortest_native_edge(rotor, step):
    along, whole = np.linspace(0.0, 1.0, 20001), np.ones(20001)
    lengths = []
    for name in ("upper", "lower"):
        for u, v in ((along, 0.0 * whole), (along, whole), (0.0 * whole, along), (whole, along)):
            points = rotor.surfaces[name](u, v)
            lengths.append(np.sum(np.sqrt(np.sum(np.diff(points, axis=0) ** 2, axis=-1))))
    # the kernel's quadrature of lengths is good to 1e-8, and so is a polyline of 20,000 chords
    assert step[1].edges.shortest == pytest.approx(1e3 * min(lengths), rel=1e-7)


def test_the_limit_at_the_ends_is_a_hundred_thousandth_of_a_millimetre_or_that_share_of_a_decimetre(bodies):
    upper = bodies["annular"].surfaces["upper"]
    chords = [np.sqrt(np.sum((upper(1.0, v) - upper(0.0, v)) ** 2)) for v in (0.0, 1.0)]
    assert limits_of(bodies["annular"])["end_mm"] == pytest.approx(1e-7 * 1e3 * max(chords))
    assert limits_of(bodies["ruled ends"])["end_mm"] == 1e-5


@pytest.mark.parametrize("unit", ["M", "INCH"])
def test_a_file_in_another_unit_that_says_so_passes(bodies, tmp_path, unit):
    path = tmp_path / "vane.step"
    STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    try:
        foreign_step(occ_solid(bodies["linear"]).solid, path)
    finally:
        Interface_Static.SetCVal_s("write.step.unit", "MM")
    trip = cad.verify(path, bodies["linear"], samples=SEARCHED)
    assert trip.passed, str(trip)
    assert trip.unit == {"M": "m", "INCH": "in"}[unit]


@pytest.mark.parametrize("name", ["annular", "linear"])
def test_a_foreign_file_without_names_passes(bodies, tmp_path, name):
    foreign_step(occ_solid(bodies[name]).solid, tmp_path / "part.step")
    trip = cad.verify(tmp_path / "part.step", bodies[name], samples=SEARCHED)
    assert trip.passed, str(trip)
    assert {face.name for face in trip.faces} == set(bodies[name].surfaces)


def test_a_foreign_file_with_other_surfaces_of_the_same_shape_passes(rotor, solid, tmp_path):
    # walls become rational splines
    converted = BRepBuilderAPI_NurbsConvert(solid.solid).Shape()
    foreign_step(converted, tmp_path / "part.step")
    trip = cad.verify(tmp_path / "part.step", rotor, samples=SEARCHED)
    assert trip.passed, str(trip)


def test_a_foreign_file_with_split_faces_passes(rotor, solid, tmp_path):
    divided = ShapeUpgrade_ShapeDivideContinuity(solid.solid)
    divided.SetSurfaceCriterion(GeomAbs_C3)
    divided.SetTolerance(1e-9)
    divided.Perform()
    foreign_step(divided.Result(), tmp_path / "part.step")
    trip = cad.verify(tmp_path / "part.step", rotor, samples=SEARCHED)
    assert trip.edges.count > 6
    # the kernel's new trimming curves are as good as its own approximation; surfaces and volume are untouched
    about_surfaces = [failure for failure in trip.failures if "edge" not in failure]
    assert not about_surfaces, str(trip)
    for face in trip.faces:
        if face.name in {"upper", "lower"}:
            assert face.max_deviation <= 1e-6


def test_a_foreign_iges_file_of_loose_faces_passes(rotor, solid, tmp_path):
    writer = IGESControl_Writer("MM", 0)
    assert writer.AddShape(solid.solid)
    writer.ComputeModel()
    assert writer.Write(str(tmp_path / "part.igs"))
    trip = cad.verify(tmp_path / "part.igs", rotor, samples=SEARCHED)
    assert trip.schema == "5.3 trimmed surfaces"
    assert trip.passed, str(trip)


def test_the_kernel_is_named():
    assert cad.occ_version().startswith("7.")


def test_a_round_trip_survives_a_pickle_and_is_named_in_one_line(step):
    path, trip = step
    assert pickle.loads(pickle.dumps(trip)).to_dict() == copy.deepcopy(trip).to_dict() == trip.to_dict()
    line = repr(trip)
    assert "\n" not in line
    assert all(word in line for word in (path.name, "STEP", "passed", "4 faces", f"{trip.volume.cad:.6g}"))
