"""Faces in pieces: cut at creases, and finer for other programs' quadrature; each piece is the native face's own."""

import dataclasses

import numpy as np
import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Trsf, gp_Vec
from OCP.TopoDS import TopoDS

from bladewright import cad
from bladewright.cad.closure import closure
from bladewright.cad.default_quadrature import default_volume
from bladewright.cad.face_pieces import BodyInPieces, creases, in_fine_pieces, in_pieces, whole_name
from bladewright.cad.kernel import quiet
from bladewright.cad.solids import occ_solid, occ_solid_in_pieces, split_occ_solid
from bladewright.cad.step import write_step
from bladewright.designs import Stations
from bladewright.nurbs.refine import elevated, inserted
from bladewright.nurbs.surface import Surface
from machines import COARSE, built, unified
from machines.sectioned import DESIGNS, DIFFUSER, VANE

from .test_catches import about, failing, put, solid_of

ROTATION = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
BLADES = {**DESIGNS, "unified": unified.INFLOW}
QUICK = (DIFFUSER.name, VANE.name, "unified")
"""sides with creases, from wall to wall of a cascade, and of no sections"""


@pytest.fixture(scope="module")
def diffuser():
    """A vane whose sides have creases where the wedge begins and ends."""
    return built(dataclasses.replace(DIFFUSER, tolerance=COARSE))


@pytest.fixture(scope="module")
def split_vane():
    """A vane of smooth sides, and its file in pieces."""
    return built(dataclasses.replace(VANE, tolerance=COARSE))


def volume(body):
    return float(body.properties.volume) * 1e9


def tent(height: float, middle: float = 0.5) -> Surface:
    """Two planes that meet in a ridge along v."""
    x = np.array([0.0, middle, 1.0])
    net = np.stack(np.broadcast_arrays(x[:, None], np.array([0.0, 1.0]), height * (x == middle)[:, None]), axis=-1)
    return Surface(
        control_points=net,
        knots_u=np.array([0, 0, 0.5, 1, 1.0]),
        knots_v=np.array([0, 0, 1, 1.0]),
        degree_u=1,
        degree_v=1,
    )


def test_a_knot_is_a_crease_only_where_a_derivative_jumps(rotor, diffuser):
    assert creases(tent(0.3), "u") == [0.5]
    assert creases(tent(0.0), "u") == []
    assert creases(tent(0.0, middle=0.3), "u") == [0.5]
    plane = elevated(elevated(tent(0.0), 4, "u"), 4, "v")
    turned = dataclasses.replace(plane, control_points=0.1 * plane.control_points @ ROTATION + 1.0 / 3.0)
    assert creases(turned, "u") == []
    smooth = inserted(rotor.surfaces["upper"], [0.21, 0.21, 0.21, 0.21, 0.21], "u")
    assert creases(smooth, "u") == []
    upper = diffuser.surfaces["upper"]
    for knot in creases(upper, "u"):
        before, after = (upper.derivative(knot + step, 0.5, 2, 0) for step in (-1e-9, 1e-9))
        assert np.abs(after - before).max() > 0.1 * np.abs(after + before).max()
    assert len(creases(upper, "u")) == 3
    assert creases(upper, "v") == []


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in BLADES]
)
def test_the_split_volume_of_every_family_is_the_native_one_by_default_quadrature_too(name):
    body = built(dataclasses.replace(BLADES[name], tolerance=COARSE))
    made = split_occ_solid(body)
    assert default_volume(made.solid) == pytest.approx(volume(body), rel=1e-5)
    closed = closure(made.solid)
    assert (closed.valid, closed.free_edges, closed.non_manifold_edges) == (True, 0, 0)
    assert {whole_name(face, body.surfaces) for face in made.faces} == set(body.surfaces)


def test_cut_at_its_creases_a_wedge_shows_its_volume_in_every_program(diffuser):
    assert default_volume(occ_solid(diffuser).solid) == pytest.approx(volume(diffuser), rel=1e-6)
    assert cad.solid(diffuser).Volume() == pytest.approx(volume(diffuser), rel=1e-6)
    whole = occ_solid_in_pieces(BodyInPieces(built=diffuser, cuts=whole_cuts(diffuser)))
    assert abs(default_volume(whole.solid) / volume(diffuser) - 1.0) > 1e-4


def whole_cuts(body):
    return {name: (face.domain_u, face.domain_v) for name, face in body.surfaces.items() if isinstance(face, Surface)}


def test_pieces_are_numbered_along_u_and_row_after_row_along_v(rotor):
    upper = rotor.surfaces["upper"]
    u, v = (np.unique(knots)[[0, 5, 9, -1]] for knots in (upper.knots_u, upper.knots_v))
    cuts = {**whole_cuts(rotor), "upper": (tuple(u.tolist()), tuple(v[[0, 2, 3]].tolist()))}
    body = BodyInPieces(built=rotor, cuts=cuts)
    assert body.names("upper").T.tolist() == [["upper_1", "upper_2", "upper_3"], ["upper_4", "upper_5", "upper_6"]]
    assert (body.surfaces["upper_2"].domain_u, body.surfaces["upper_2"].domain_v) == ((u[1], u[2]), (v[0], v[2]))
    assert body.surfaces["upper_6"].domain_v == (v[2], v[3])
    # the lower side, which is whole, has a corner where the upper one's rows meet
    made = occ_solid_in_pieces(body)
    closed = closure(made.solid)
    assert (closed.valid, closed.free_edges, closed.non_manifold_edges) == (True, 0, 0)
    assert max(edge.gap for edge in closed.edges) == pytest.approx(
        max(edge.gap for edge in closure(occ_solid(rotor).solid).edges), rel=0.2
    )
    # two walls of 3 + 1 edges each, two edges of two parts, and within the side 3 + 2 x 2
    assert len(closed.edges) == 2 * 4 + 2 * 2 + 3 + 4


def test_pieces_are_the_face_itself(split_vane):
    whole = split_vane.surfaces["upper"]
    body = in_fine_pieces(split_vane, ["lower"])
    pieces = [face for name, face in body.surfaces.items() if whole_name(name, ["upper"])]
    assert len(pieces) > 4
    for face in pieces:
        u, v = (np.linspace(*domain, 7) for domain in (face.domain_u, face.domain_v))
        for order in (0, 1, 2):
            np.testing.assert_allclose(face.grid(u, v, order), whole.grid(u, v, order), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("ending", ["step", "igs", pytest.param("brep", marks=pytest.mark.slow)])
def test_a_split_file_passes_and_says_in_how_many_pieces_its_faces_are(split_vane, ending, tmp_path):
    trip = cad.write(split_vane, tmp_path / f"vane.{ending}", split=True, samples=400)
    assert trip.passed, str(trip)
    assert [face.name for face in trip.faces] == list(split_vane.surfaces)
    assert all(face.pieces > 4 for face in trip.faces if face.name in {"upper", "lower"})
    assert trip.to_dict()["volume_mm3"]["kernel_default"]["relative_error"] < 1e-5
    assert "FreeCAD and CadQuery show" in str(trip)


def test_a_file_of_whole_faces_from_an_older_release_passes(diffuser, tmp_path):
    whole = occ_solid_in_pieces(BodyInPieces(built=diffuser, cuts=whole_cuts(diffuser)))
    with quiet():
        write_step(diffuser, whole, str(tmp_path / "old.step"), schema="AP242")
    trip = cad.verify(tmp_path / "old.step", diffuser, samples=400)
    assert trip.passed, str(trip)
    assert {face.pieces for face in trip.faces} == {1}


def test_a_piece_that_is_shifted_is_found(diffuser, tmp_path):
    shift = gp_Trsf()
    shift.SetTranslation(gp_Vec(0.0, 1e-4, 0.0))
    faces = occ_solid(diffuser).faces
    faces["upper_2"] = TopoDS.Face_s(BRepBuilderAPI_Transform(faces["upper_2"], shift).Shape())
    put(solid_of(faces.values()), tmp_path / "shifted.brep")
    trip = failing(tmp_path / "shifted.brep", diffuser)
    assert about(trip, "face upper is ", "mm off at u = ")
    worst = next(face for face in trip.faces if face.name == "upper")
    cuts = in_pieces(diffuser).cuts["upper"][0]
    assert cuts[1] <= worst.worst[0] <= cuts[2]
    assert 2e-5 < worst.max_deviation <= 1e-4


def test_a_missing_piece_is_found(diffuser, tmp_path):
    faces = [face for name, face in occ_solid(diffuser).faces.items() if name != "lower_3"]
    put(solid_of(faces), tmp_path / "open.step")
    trip = failing(tmp_path / "open.step", diffuser)
    assert about(trip, "face lower is ", "mm off")
    assert about(trip, "face lower has an area")


def test_pieces_with_each_others_names_are_found(diffuser, tmp_path):
    path = tmp_path / "named.step"
    cad.write(diffuser, path, samples=100)
    text = path.read_text().replace("FACE('upper_2'", "FACE('?'").replace("FACE('upper_3'", "FACE('upper_2'")
    path.write_text(text.replace("FACE('?'", "FACE('upper_3'"))
    assert about(failing(path, diffuser), "pieces of face upper", "upper_3")


def test_a_law_of_straight_pieces_cuts_both_sides_along_the_chord():
    thickness = Stations(span=(0.0, 0.4, 1.0), values=(0.1, 0.09, 0.05), interpolation="linear")
    bent = built(dataclasses.replace(VANE, tolerance=COARSE).changed("section.thickness", thickness))
    body = in_pieces(bent)
    assert list(body.surfaces)[:4] == ["upper_1", "upper_2", "lower_1", "lower_2"]
    assert body.cuts["upper"] == body.cuts["lower"] == ((0.0, 1.0), (0.0, 0.4, 1.0))
    closed = closure(occ_solid(bent).solid)
    assert (closed.valid, closed.free_edges, closed.non_manifold_edges) == (True, 0, 0)
