"""Faces that meet at T-junctions, and along edges whose knots differ."""

import numpy as np
import pytest

from bladewright.cad.closure import closure
from bladewright.cad.face_pieces import in_pieces
from bladewright.cad.solids import occ_solid
from bladewright.cad.topology import topology
from bladewright.errors import CadError
from bladewright.nurbs.domain import reparametrised, split
from bladewright.nurbs.refine import elevated, inserted
from bladewright.nurbs.surface import Surface
from machines.closed_forms import blade, moved

CUT = 0.3
"""where two opposite faces of the box are cut, of its height"""


def bent_box(cut=CUT, *, redundant=True):
    """A box with cubic sides; front and back are each two faces, and some edges have knots that others lack."""
    corners = np.array([[x, y, z] for x in (0.0, 0.1) for y in (0.0, 0.2) for z in (0.0, 0.3)]).reshape(2, 2, 2, 3)
    squares = {
        "bottom": (corners[:, :, 0], -1),
        "top": (corners[:, :, 1], 1),
        "left": (corners[0], -1),
        "right": (corners[1], 1),
        "front": (corners[:, 0], 1),
        "back": (corners[:, 1], -1),
    }
    knots = np.array([0.0, 0.0, 1.0, 1.0])
    faces, signs = {}, {}
    for name, (net, sign) in squares.items():
        plane = Surface(control_points=net, knots_u=knots, knots_v=knots, degree_u=1, degree_v=1)
        face = elevated(elevated(plane, 2, "u"), 2, "v")
        points = np.array(face.control_points)
        points[..., 2] *= 1.0 + points[..., 0]
        face = Surface(control_points=points, knots_u=face.knots_u, knots_v=face.knots_v, degree_u=3, degree_v=3)
        pieces = split(face, [cut], "v") if name in {"front", "back"} else (face,)
        for k, piece in enumerate(pieces):
            label = f"{name}_{k + 1}" if len(pieces) > 1 else name
            more = inserted(piece, [0.37, 0.81], "u") if redundant and name in {"top", "back"} else piece
            faces[label] = reparametrised(more, 0.0, 1.0, "v")
            signs[label] = sign
    return blade("box", faces, signs)


def test_edges_are_cut_at_t_junctions_and_shared_whatever_their_knots():
    box = bent_box()
    found = topology(in_pieces(box))
    assert (len(found.vertices), len(found.edges)) == (12, 18)
    for edge in found.edges:
        for coedge in edge.coedges:
            assert len(edge.coedges) == 2
            assert coedge.span[0] < coedge.span[1]
    spans = {coedge.span for edge in found.edges for coedge in edge.coedges if coedge.face == "left"}
    assert {tuple(np.round(span, 12)) for span in spans} == {(0.0, 1.0), (0.0, CUT), (CUT, 1.0)}


def test_a_body_with_t_junctions_becomes_one_closed_valid_solid():
    closed = closure(occ_solid(bent_box()).solid)
    assert (closed.solids, closed.shells, closed.free_edges, closed.non_manifold_edges) == (1, 1, 0, 0)
    assert closed.valid
    assert max(joint.gap for joint in closed.edges) < 1e-11


@pytest.mark.parametrize("by", [1e-10, 1e-4])
def test_an_edge_that_leaves_its_neighbour_is_not_shared(by):
    box = bent_box()
    box.surfaces["front_1"] = moved(box.surfaces["front_1"], 0, 1, by)
    with pytest.raises(CadError, match="exactly two faces"):
        topology(in_pieces(box))
