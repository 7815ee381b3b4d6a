"""Passages of untrimmed patches: creased walls in pieces that share edges, one solid, every face named."""

import dataclasses
import re

import numpy as np
import pytest
from OCP.BRep import BRep_Tool

from bladewright import cad
from bladewright.cad.closure import closure
from bladewright.cad.conversion import native_surface
from bladewright.cad.face_pieces import in_pieces
from bladewright.cad.reading import read_cad_file
from bladewright.cad.solids import occ_solid
from bladewright.cad.topology import side_curve, smooth_pieces, topology
from bladewright.errors import CadError
from bladewright.nurbs.domain import reparametrised, split
from bladewright.nurbs.surface import Surface
from machines.closed_form_passages import AFTER, ALONG, BEFORE, divided, passage
from machines.closed_forms import moved, replaced

from .test_catches import about, failing, put, solid_of, written

COUNTS = {"whole": (24, 46, 22), "gap": (26, 47, 23), "split": (24, 48, 24), "split gap": (26, 49, 25)}
"""vertices, edges and faces, by hand: ten whole faces, of which walls and periodic boundaries have two creases each,
and a tip with a gap; inlet and outlet are plane, and whole where they are not asked to be split"""


@pytest.fixture(scope="module")
def passages():
    whole, gap = passage(), passage(clearance=True)
    return {"whole": whole, "gap": gap, "split": divided(whole), "split gap": divided(gap)}


@pytest.fixture(scope="module")
def vane(passages):
    return passages["whole"]


@pytest.mark.parametrize("kind", COUNTS)
def test_a_passage_has_the_edges_and_vertices_that_it_should(passages, kind):
    pieces = in_pieces(passages[kind])
    found = topology(pieces)
    counts = (len(found.vertices), len(found.edges), len(pieces.surfaces))
    assert counts == COUNTS[kind]
    # Euler: a vane from wall to wall is a hole through the passage, one with a gap above its tip is none
    assert counts[0] - counts[1] + counts[2] == (2 if "gap" in kind else 0)
    assert not found.degenerate_edges


@pytest.mark.parametrize("kind", COUNTS)
def test_a_passage_becomes_one_closed_valid_solid_whose_faces_meet_exactly(passages, kind):
    made = occ_solid(passages[kind])
    closed = closure(made.solid)
    assert (closed.solids, closed.shells, closed.free_edges, closed.non_manifold_edges) == (1, 1, 0, 0)
    assert closed.valid
    assert len(closed.edges) == COUNTS[kind][1]
    assert list(made.faces) == list(in_pieces(passages[kind]).surfaces)
    # trimming curves run with their edge's parameter, also where it is the blade's own
    assert max(joint.gap for joint in closed.edges) < 1e-11


def test_faces_are_the_native_ones_cut_at_their_creases(vane):
    faces = occ_solid(vane).faces
    assert "periodic_upper" not in faces
    for name, cuts in (("hub_upper", [BEFORE, AFTER]), ("inlet", []), ("blade_upper", [])):
        whole = vane.surfaces[name]
        pieces = split(whole, cuts) if len(cuts) else [whole]
        names = [f"{name}_{number + 1}" for number in range(len(pieces))] if len(cuts) else [name]
        for piece, label in zip(pieces, names, strict=True):
            returned = native_surface(BRep_Tool.Surface_s(faces[label]))
            np.testing.assert_array_equal(returned.control_points, piece.control_points * 1000.0)
            np.testing.assert_array_equal(returned.knots_u, piece.knots_u)


def test_a_side_falls_into_its_pieces_control_point_for_control_point(vane):
    whole, _ = side_curve(vane.surfaces["hub_upper"], 0)
    parts = smooth_pieces(whole)
    assert [part.domain for part in parts] == [(0.0, 0.3), (0.3, 0.7), (0.7, 1.0)]
    np.testing.assert_array_equal(
        np.concatenate([parts[0].control_points, *[part.control_points[1:] for part in parts[1:]]]),
        whole.control_points,
    )
    for part in parts:
        u = np.linspace(*part.domain, 21)
        np.testing.assert_allclose(part(u), whole(u), rtol=0.0, atol=1e-16)


def test_a_side_without_creases_is_one_piece(vane):
    whole, _ = side_curve(vane.surfaces["blade_upper"], 0)
    assert [part.control_points.shape for part in smooth_pieces(whole)] == [whole.control_points.shape]


def test_the_parameter_of_a_neighbour_may_have_any_scale(vane):
    scaled = replaced(vane, blade_upper=reparametrised(vane.surfaces["blade_upper"], -3.0, 5.0))
    closed = closure(occ_solid(scaled).solid)
    assert closed.valid
    assert max(joint.gap for joint in closed.edges) < 1e-11


def test_neighbours_with_the_same_poles_and_other_knots_are_refused(vane):
    face = vane.surfaces["blade_upper"]
    knots = np.array(face.knots_u)
    knots[6] += 1e-6
    with pytest.raises(CadError, match=r"'(hub|blade)_upper(_2)?'.*exactly two faces"):
        cad.solid(replaced(vane, blade_upper=dataclasses.replace(face, knots_u=knots)))


def test_a_wall_torn_off_the_extension_is_refused(vane):
    # the third control point of the line that both halves of the hub share before the vane
    torn = replaced(vane, hub_upper=moved(vane.surfaces["hub_upper"], 2, 0, 1e-9))
    with pytest.raises(CadError, match=r"'hub_(upper|lower)_1'.*exactly two faces"):
        cad.solid(torn)


@pytest.mark.parametrize(
    ("kind", "ending"),
    [
        *[("whole", "step"), ("split", "igs"), ("split gap", "step")],
        *[
            pytest.param(*each, marks=pytest.mark.slow)
            for each in (("whole", "igs"), ("whole", "brep"), ("gap", "step"))
        ],
    ],
)
def test_a_passage_returns_from_a_file_with_every_face_named(passages, kind, ending, tmp_path):
    built = passages[kind]
    trip = cad.write(built, tmp_path / f"passage.{ending}", samples=400)
    assert trip.passed, str(trip)
    assert (trip.solids, trip.shells, trip.free_edges, trip.edges.count) == (1, 1, 0, COUNTS[kind][1])
    assert [face.name for face in trip.faces] == list(built.surfaces)
    # what the digits of a file allow for a body of 0.2 m
    assert max(face.max_deviation for face in trip.faces) < 1e-8
    assert trip.edges.max_gap < 1e-8
    assert trip.volume.relative_error < 1e-9
    if ending != "brep":
        opened = read_cad_file(tmp_path / f"passage.{ending}")
        assert len(opened.faces) == COUNTS[kind][2]
        assert sorted(opened.names.values()) == sorted(in_pieces(built).surfaces)


def test_a_passage_is_triangulated_watertight(vane, tmp_path):
    # how a mesh is written in either format does not depend on the body
    trip = cad.write(vane, tmp_path / "passage.stl", chordal_deviation=4e-4, samples=400)
    assert trip.passed, str(trip)
    assert {face.name for face in trip.faces} == set(vane.surfaces)


def test_a_moved_pole_of_a_wall_is_found_on_that_wall(vane, tmp_path):
    face = vane.surfaces["shroud_lower"]
    net = np.array(face.control_points)
    # across the wall; along it, the surface would stay the same
    net[10, 4, 2] += 1e-7
    written(replaced(vane, shroud_lower=dataclasses.replace(face, control_points=net)), tmp_path / "bent.step")
    trip = failing(tmp_path / "bent.step", vane)
    assert about(trip, "face shroud_lower is ", "mm off at u = ")
    assert not [failure for failure in trip.failures if "shroud_lower" not in failure]
    u, _ = next(face for face in trip.faces if face.name == "shroud_lower").worst
    assert ALONG[10] <= u <= ALONG[16]
    assert u > BEFORE


def test_a_crease_that_was_smoothed_is_found(vane, tmp_path):
    face = vane.surfaces["periodic_upper"]
    # the same poles with two of five knots moved off the crease
    knots = np.array(face.knots_u)
    place = int(np.searchsorted(knots, BEFORE))
    knots[place + 3 : place + 5] += 0.005
    meant = replaced(vane, periodic_upper=dataclasses.replace(face, knots_u=knots))
    cad.write(vane, tmp_path / "passage.step", samples=400)
    trip = cad.verify(tmp_path / "passage.step", meant, samples=900)
    assert about(trip, "face periodic_upper is ", "mm off")


def test_walls_with_each_others_names_are_found(vane, tmp_path):
    path = tmp_path / "swapped.step"
    written(vane, path)
    swapped = {"hub_upper": "hub_lower", "hub_lower": "hub_upper"}
    path.write_text(
        re.sub(r"(ADVANCED_FACE\(')(hub_upper|hub_lower)_", lambda m: f"{m[1]}{swapped[m[2]]}_", path.read_text())
    )
    trip = failing(path, vane)
    for name in swapped:
        assert about(trip, f"face {name} is ", "mm off")


def test_a_missing_wall_is_found(vane, tmp_path):
    faces = [face for name, face in occ_solid(vane).faces.items() if not name.startswith("hub_upper")]
    put(solid_of(faces), tmp_path / "open.brep")
    trip = failing(tmp_path / "open.brep", vane)
    assert about(trip, "no face of the file is hub_upper")
    # three edges to vane and extensions, three to the periodic boundary, one each to inlet and outlet
    assert trip.free_edges == 8


@pytest.mark.slow
def test_a_wall_split_by_another_program_is_one_face_still(passages, tmp_path):
    # without names each piece is found to lie on the wall that it is a part of
    put(occ_solid(passages["split"]).solid, tmp_path / "split.brep")
    trip = cad.verify(tmp_path / "split.brep", passages["whole"], samples=900)
    assert trip.passed, str(trip)
    assert len(trip.faces) == 10


def test_split_faces_are_plain(passages):
    for face in passages["split"].surfaces.values():
        assert isinstance(face, Surface)
        for side in range(4):
            assert len(smooth_pieces(side_curve(face, side)[0])) == 1
