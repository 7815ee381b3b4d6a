"""OpenCASCADE's own check, which FreeCAD shows: it finds nothing in fine blades."""

import dataclasses

import numpy as np
import pytest
from OCP.BRep import BRep_Builder
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt
from OCP.TopoDS import TopoDS_Compound

from bladewright import cad
from bladewright.cad.kernel_check import kernel_faults
from machines import COARSE, built, coarse, unified

CURVES = {"fault": "InvalidCurveOnSurface", "count": 4}


@pytest.fixture(scope="module")
def fine():
    return dataclasses.replace(unified.INFLOW, tolerance=COARSE).build(fine=True)


def test_a_fine_blade_meets_its_walls_within_the_kernels_smallest_tolerance(fine, tmp_path):
    assert fine.wall_error * fine.chord <= 1e-10
    assert fine.conformance.kept
    trip = cad.write(fine, tmp_path / "fine.step", samples=400)
    assert trip.passed, str(trip)
    assert trip.edges.max_gap < 1e-7
    assert trip.edges.max_tolerance == pytest.approx(1e-7, rel=1e-6)
    assert trip.to_dict()["kernel_check"] == []
    assert "check of the geometry finds nothing" in str(trip)


def test_another_blade_may_be_further_off_and_the_round_trip_says_so(tmp_path):
    blade = built(dataclasses.replace(unified.INFLOW, tolerance=COARSE))
    trip = cad.write(blade, tmp_path / "blade.step", samples=400)
    assert trip.passed, str(trip)
    assert trip.edges.max_gap > 1e-7
    assert trip.to_dict()["kernel_check"] == [CURVES]
    assert "InvalidCurveOnSurface (4): build --fine" in str(trip)


def test_a_brep_file_holds_the_true_tolerance_of_its_edges_and_passes_as_it_is(tmp_path):
    blade = built(dataclasses.replace(unified.INFLOW, tolerance=COARSE))
    trip = cad.write(blade, tmp_path / "blade.brep", samples=400)
    assert 1e-7 < trip.edges.max_gap < trip.edges.max_tolerance
    assert trip.kernel_faults == ()


def test_fine_is_a_choice_of_knots_alone(fine):
    design = dataclasses.replace(unified.INFLOW, tolerance=COARSE)
    assert fine.knots.poles[0] > built(design).knots.poles[0]
    np.testing.assert_array_equal(fine.knots.v, built(design).knots.v)
    held = design.build(knots=fine.knots)
    for name, side in zip(("upper", "lower"), held.sides, strict=True):
        np.testing.assert_array_equal(side.control_points, fine.surfaces[name].control_points)


def test_a_fine_blade_may_have_a_gap_at_its_tip(tmp_path):
    blade = dataclasses.replace(coarse.CLEARED, tolerance=COARSE).build(fine=True)
    trip = cad.write(blade, tmp_path / "tip.step", samples=400)
    assert trip.passed, str(trip)
    assert trip.edges.max_gap < 1e-7
    assert trip.kernel_faults == ()


def test_parts_that_meet_are_found_on_request():
    one, other = (BRepPrimAPI_MakeBox(gp_Pnt(at, at, at), 2.0, 2.0, 2.0).Solid() for at in (0.0, 1.0))
    builder, both = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(both)
    builder.Add(both, one)
    builder.Add(both, other)
    assert kernel_faults(both) == ()
    assert "SelfIntersect" in {each.fault for each in kernel_faults(both, intersections=True)}
    assert kernel_faults(one, intersections=True) == ()
