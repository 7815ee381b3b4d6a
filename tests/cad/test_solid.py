"""Solids: closed, valid, pole for pole the native surfaces."""

import dataclasses

import cadquery
import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.Geom import Geom_Plane, Geom_SurfaceOfRevolution

from bladewright import cad
from bladewright.cad.closure import closure
from bladewright.cad.conversion import native_surface
from bladewright.cad.solids import occ_solid
from bladewright.cad.verification import limits_of
from bladewright.errors import CadError
from bladewright.nurbs.surface import Surface
from machines.closed_forms import annular, moved, replaced


def test_a_body_becomes_one_valid_closed_solid_of_its_own_faces(built):
    solid = cad.solid(built)
    assert isinstance(solid, cadquery.Solid)
    assert len(solid.Faces()) == len(built.surfaces) <= 8
    closed = closure(solid.wrapped)
    assert (closed.solids, closed.shells, closed.free_edges, closed.non_manifold_edges) == (1, 1, 0, 0)
    assert all(len(joint.faces) == 2 for joint in closed.edges)
    assert BRepCheck_Analyzer(solid.wrapped).IsValid()


def test_the_solid_encloses_the_native_volume_with_its_faces_outwards(built):
    # cadquery's quadrature of bent faces is good to 1e-7; a face that points inwards would change the sign of its part
    assert cad.solid(built).Volume() == pytest.approx(built.properties.volume * 1e9, rel=1e-6)


def test_untrimmed_faces_are_the_native_surfaces_pole_for_pole(built):
    for name, shape in occ_solid(built).faces.items():
        face = built.surfaces[name]
        if isinstance(face, Surface):
            returned = native_surface(BRep_Tool.Surface_s(shape))
            np.testing.assert_array_equal(returned.control_points, face.control_points * 1000.0)
            np.testing.assert_array_equal(returned.knots_u, face.knots_u)
            np.testing.assert_array_equal(returned.knots_v, face.knots_v)
            assert (returned.degree_u, returned.degree_v) == (face.degree_u, face.degree_v)


def test_gaps_and_tolerances_keep_what_was_promised(built):
    limits = limits_of(built)
    for joint in closure(occ_solid(built).solid).edges:
        sides = all(isinstance(list(built.surfaces.values())[k], Surface) for k in joint.faces)
        limit = limits["edge_mm" if sides else "end_mm"]
        assert joint.gap <= limit
        assert joint.tolerance <= limit
        # a tolerance is a promise that the gap is no larger
        assert joint.gap <= joint.tolerance
        assert joint.vertex_tolerance <= limits["end_mm"]


def test_annular_ends_are_surfaces_of_revolution_about_the_machine_axis(rotor):
    for name in ("hub", "shroud"):
        surface = BRep_Tool.Surface_s(occ_solid(rotor).faces[name])
        assert isinstance(surface, Geom_SurfaceOfRevolution)
        axis = surface.Axis()
        assert axis.Location().Distance(type(axis.Location())(0.0, 0.0, 0.0)) == 0.0
        assert abs(axis.Direction().X()) == 1.0


def test_linear_ends_are_planes(bodies):
    for name in ("hub", "shroud"):
        assert isinstance(BRep_Tool.Surface_s(occ_solid(bodies["linear"]).faces[name]), Geom_Plane)


@pytest.mark.parametrize("turn", [1.5, 3.1, -2.0])
def test_a_blade_may_stand_at_any_angle_around_the_axis(turn, rotor):
    turned = annular(turn=turn)
    closed = closure(occ_solid(turned).solid)
    assert closed.valid
    assert closed.free_edges == 0
    # turning changes lengths by rounding only; the ends lie off the wall by 4e-7 mm
    gap = max(joint.gap for joint in closure(occ_solid(rotor).solid).edges)
    assert max(joint.gap for joint in closed.edges) == pytest.approx(gap, rel=1e-3)


def test_sides_that_do_not_share_their_edge_are_refused_by_name(rotor):
    torn = replaced(rotor, upper=moved(rotor.surfaces["upper"], 0, 3, 1e-9))
    with pytest.raises(CadError, match=r"belongs to 'upper'.*exactly two faces"):
        cad.solid(torn)


def test_a_wall_that_no_edge_follows_is_refused_by_name(rotor):
    hub = rotor.surfaces["hub"]
    lifted = dataclasses.replace(
        hub, surface=dataclasses.replace(hub.surface, control_points=hub.surface.control_points * 1.01)
    )
    with pytest.raises(CadError, match=r"boundary 0 of face 'hub' runs along no edge"):
        cad.solid(replaced(rotor, hub=lifted))


def test_a_missing_face_is_refused(rotor):
    open_body = dataclasses.replace(
        rotor, surfaces={name: face for name, face in rotor.surfaces.items() if name != "hub"}
    )
    with pytest.raises(CadError, match="exactly two faces"):
        cad.solid(open_body)


@pytest.mark.parametrize(("value", "reason"), [(1e-30j, "imaginary step"), (np.nan, "not a finite number")])
def test_surfaces_that_are_not_real_numbers_are_refused(rotor, value, reason):
    upper = rotor.surfaces["upper"]
    net = np.array(upper.control_points, dtype=type(value) if isinstance(value, complex) else float)
    net[10, 10, 0] += value
    with pytest.raises(CadError, match=reason):
        cad.solid(replaced(rotor, upper=dataclasses.replace(upper, control_points=net)))
