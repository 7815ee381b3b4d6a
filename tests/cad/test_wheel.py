"""Wheels: faces of a whole turn with a seam, trimmed faces that meet each other, holes through which blades stand."""

import dataclasses

import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.TopoDS import TopoDS

from bladewright import cad
from bladewright.cad.closure import closure
from bladewright.cad.conversion import native_surface
from bladewright.cad.default_quadrature import default_volume
from bladewright.cad.face_pieces import BodyInPieces, in_pieces
from bladewright.cad.solids import occ_solid, occ_solid_in_pieces, split_occ_solid
from bladewright.cad.topology import topology
from bladewright.errors import CadError
from bladewright.nurbs.refine import elevated
from bladewright.nurbs.surface import Surface
from machines.closed_form_wheels import ring
from machines.closed_forms import moved, replaced

from .test_catches import about, failing, put, solid_of, written


@pytest.fixture(scope="module")
def wheel():
    return ring(3, blades=1)


@pytest.fixture(scope="module")
def plain():
    """Without bore and blades: two pieces of hub between two discs, which end in poles."""
    return ring(2, blades=0, solid=True, name="plain")


def by_edges(built):
    """Names of the two faces of each edge, and the number of edges between them."""
    found = {}
    for edge in topology(in_pieces(built)).edges:
        names = tuple(sorted(coedge.face for coedge in edge.coedges))
        found[names] = found.get(names, 0) + 1
    return found


def test_a_wheel_has_the_edges_that_it_should(wheel):
    found = by_edges(wheel)
    # three lines between pieces, a seam in each face of a whole turn, four arcs of each circle of the bore
    for one, other in (("hub_1", "hub_2"), ("hub_2", "hub_3"), ("hub_1", "hub_3")):
        assert found[one, other] == 1
    for face in ("bore", "rim_front", "rim_back"):
        assert found[face, face] == 1
    assert found["bore", "rim_front"] == found["bore", "rim_back"] == 4
    # rim circles are cut where the lines end, and where their arcs join
    for face in ("rim_front", "rim_back"):
        assert sum(found[tuple(sorted((f"hub_{k}", face)))] for k in (1, 2, 3)) == 7
    assert found["blade_01_upper", "hub_1"] == found["blade_01_lower", "hub_1"] == 1


def test_a_wheel_obeys_eulers_formula(wheel, plain):
    # a ring is a torus, and a face with a hole counts for a disc less
    for built, characteristic in ((wheel, 0), (plain, 2)):
        made = topology(in_pieces(built))
        seen = len(made.vertices) - len(made.edges) + len(built.surfaces)
        assert seen == characteristic + ("blade_01_upper" in built.surfaces)
    assert len(topology(in_pieces(plain)).degenerate_edges) == 2


def test_a_wheel_becomes_one_closed_valid_solid_of_its_own_faces(wheel, plain):
    for built in (wheel, plain):
        made = occ_solid(built)
        assert list(made.faces) == list(built.surfaces)
        closed = closure(made.solid)
        assert (closed.solids, closed.shells, closed.free_edges, closed.non_manifold_edges) == (1, 1, 0, 0)
        assert closed.valid
        assert max(edge.gap for edge in closed.edges) < 1e-5
        for name, face in built.surfaces.items():
            if isinstance(face, Surface):
                returned = native_surface(BRep_Tool.Surface_s(made.faces[name]))
                np.testing.assert_array_equal(returned.control_points, face.control_points * 1000.0)


@pytest.mark.parametrize(
    ("kind", "ending"),
    [
        ("wheel", "step"),
        pytest.param("wheel", "igs", marks=pytest.mark.slow),
        ("plain", "brep"),
        *(pytest.param(*each, marks=pytest.mark.slow) for each in (("wheel", "brep"), ("plain", "step"))),
    ],
)
def test_a_wheels_file_passes(request, kind, ending, tmp_path):
    built = request.getfixturevalue(kind)
    trip = cad.write(built, tmp_path / f"{built.name}.{ending}", samples=200)
    assert trip.passed, str(trip)
    assert {each.fault for each in trip.kernel_faults} <= {"InvalidCurveOnSurface"}
    assert [face.name for face in trip.faces] == list(built.surfaces)
    whole_turns = [face for face in trip.faces if face.name in {"rim_front", "bore", "rim_back"}]
    # compared pole for pole, also where OpenCASCADE made them periodic
    assert max(face.max_deviation for face in whole_turns) < 1e-9


def test_trimmed_faces_that_meet_along_an_edge_that_was_not_declared_are_refused(wheel):
    with pytest.raises(CadError, match=r"boundary 0 of face 'hub_1' runs along no edge .* declare the edge"):
        occ_solid(dataclasses.replace(wheel, edges=()))


def test_a_hole_that_no_edge_follows_is_refused_by_name(wheel):
    surfaces = {name: face for name, face in wheel.surfaces.items() if not name.startswith("blade")}
    with pytest.raises(CadError, match="hole 1, curve 0 of face 'hub_1' runs along no edge"):
        occ_solid(dataclasses.replace(wheel, surfaces=surfaces))


def test_a_face_that_meets_itself_without_a_whole_turn_is_refused(bodies):
    body = bodies["brick"]
    inlet = body.surfaces["inlet"]
    net = np.array(inlet.control_points)
    # two neighbouring sides are the same curve
    net[:, 0] = net[0]
    folded = dataclasses.replace(body, surfaces={"inlet": dataclasses.replace(inlet, control_points=net)})
    with pytest.raises(CadError, match="'inlet' meets itself along an edge"):
        occ_solid(folded)


def test_a_wheels_triangles_are_measured_across_its_seams(wheel, tmp_path):
    trip = cad.write(wheel, tmp_path / "wheel.stl", chordal_deviation=1e-3, samples=100)
    assert trip.passed, str(trip)
    assert [face.name for face in trip.faces] == list(wheel.surfaces)


def test_a_split_wheel_shows_its_volume_in_every_program(plain):
    """By the kernel's default quadrature, which a pole of a face of a whole turn spoils."""
    volume = float(plain.properties.volume) * 1e9
    assert abs(default_volume(occ_solid(plain).solid) / volume - 1.0) > 1e-5
    assert default_volume(split_occ_solid(plain).solid) == pytest.approx(volume, rel=1e-10)


def test_a_wheel_may_be_split(wheel):
    """Whole turns in quarters, which share an edge where the seam was."""
    cuts = {**in_pieces(wheel).cuts, "bore": ((0.0, 1.0), (0.0, 0.25, 0.5, 0.75, 1.0))}
    body = BodyInPieces(built=wheel, cuts=cuts)
    closed = closure(occ_solid_in_pieces(body).solid)
    assert (closed.valid, closed.free_edges, closed.non_manifold_edges) == (True, 0, 0)
    assert len(body.surfaces) == len(wheel.surfaces) + 3


@pytest.mark.slow
def test_a_moved_pole_of_a_wheel_is_found(wheel, tmp_path):
    bent = replaced(wheel, blade_01_upper=moved(wheel.surfaces["blade_01_upper"], 10, 10, 1e-7))
    written(bent, tmp_path / "bent.step")
    trip = failing(tmp_path / "bent.step", wheel)
    assert about(trip, "face blade_01_upper is ", "mm off at u = ")
    assert len(about(trip, "mm off at u = ")) == 1


def test_a_moved_pole_of_a_whole_turn_is_found(wheel, tmp_path):
    # a row of poles of its own between those on its circles
    bore = elevated(wheel.surfaces["bore"], 1, "u")
    written(replaced(wheel, bore=moved(bore, 1, 4, 1e-7)), tmp_path / "bent.step")
    trip = failing(tmp_path / "bent.step", wheel)
    assert about(trip, "face bore is ", "mm off at u = ")
    assert len(about(trip, "mm off at u = ")) == 1


def test_a_lost_blade_is_found(wheel, tmp_path):
    # its hole in the hub is closed again: a valid solid
    written(ring(3, blades=0), tmp_path / "lost.step")
    trip = failing(tmp_path / "lost.step", wheel, samples=100)
    assert about(trip, "no face of the file is blade_01_upper or blade_01_lower or blade_01_tip")
    assert about(trip, "face hub_1 has an area")
    assert about(trip, "the volume of")
    assert trip.free_edges == 0


def test_a_turned_blade_is_found(wheel, tmp_path):
    # by a ten-thousandth of a millimetre at its tip, together with its hole
    written(ring(3, blades=1, askew=3e-7), tmp_path / "turned.step")
    trip = failing(tmp_path / "turned.step", wheel, samples=100)
    assert trip.free_edges == 0
    assert {name for name in wheel.surfaces if about(trip, f"face {name} is ", "mm off at u = ")} == {
        "blade_01_upper",
        "blade_01_lower",
        "blade_01_tip",
        "hub_1",
    }


def test_an_open_edge_of_a_wheel_is_found(wheel, tmp_path):
    # one piece of the hub stands on its own copies of the edges
    faces = {
        name: TopoDS.Face_s(BRepBuilderAPI_Copy(face).Shape()) if name == "hub_2" else face
        for name, face in occ_solid(wheel).faces.items()
    }
    put(solid_of(faces.values()), tmp_path / "open.brep")
    trip = failing(tmp_path / "open.brep", wheel, samples=100)
    edges = sum(count for names, count in by_edges(wheel).items() if "hub_2" in names)
    assert trip.free_edges == 2 * edges
    assert about(trip, f"{2 * edges} edges belong to one face only")
    assert not about(trip, "mm off")
