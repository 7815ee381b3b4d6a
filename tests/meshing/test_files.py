"""Mesh files of every format hold the same mesh, with the names of the faces and matching nodes."""

import numpy as np
import pytest

from bladewright.errors import FileError
from bladewright.meshing.mesh_file import motionless, read_mesh, rescaled

pytestmark = pytest.mark.usefixtures("gmsh")
FACES = {
    "hub_upper", "hub_lower", "shroud_upper", "shroud_lower", "periodic_upper", "periodic_lower",
    "inlet", "outlet", "blade_upper", "blade_lower",
}  # fmt: skip


def opened(gmsh, path):
    gmsh.clear()
    gmsh.open(str(path))
    return gmsh


def groups(gmsh):
    return {gmsh.model.getPhysicalName(*each): each for each in gmsh.model.getPhysicalGroups()}


def test_every_format_passes(cascade_mesh):
    _, report = cascade_mesh
    assert report.passed, report
    assert report.inverted == 0
    assert report.min_sicn.worst > 0.1
    assert report.periodic_mismatch < 1e-12
    assert report.periodic_nodes > 20
    assert max(face.max_deviation_mm for face in report.faces) < 1e-6
    assert {face.name for face in report.faces} == FACES


def test_every_format_holds_the_same_mesh(cascade_as, cascade_mesh):
    _, report = cascade_mesh
    _, native = cascade_as(".msh")
    found, other = report.to_dict(), native.to_dict()
    for key in ("tetrahedra", "nodes", "size", "smallest", "rotation_deg", "periodic_nodes"):
        assert found[key] == other[key]
    for measure in ("min_sicn", "gamma"):
        # text has sixteen digits, and the worst tetrahedron loses some of them
        assert found[measure] == pytest.approx(other[measure], rel=1e-9)
    assert [face["triangles"] for face in found["faces"]] == [face["triangles"] for face in other["faces"]]


def test_a_mesh_is_in_metres_and_closes_to_the_volume_of_the_passage(cascade, cascade_mesh):
    path, report = cascade_mesh
    # coarse facets on the blade cut off what they stand before
    assert abs(report.volume_error) < 0.02
    assert report.unit == "m"
    if path.suffix == ".su2":
        corners = np.concatenate([each.control_points.reshape(-1, 3) for each in cascade.passage.surfaces.values()])
        nodes = read_mesh(path)["nodes"]
        assert (nodes.min(axis=0) > corners.min(axis=0) - 1e-4).all()
        assert (nodes.max(axis=0) < corners.max(axis=0) + 1e-4).all()


def test_su2_calls_its_markers_by_the_faces_and_says_how_the_periodic_ones_meet(cascade_mesh):
    path, report = cascade_mesh
    if path.suffix != ".su2":
        assert "MARKER_PERIODIC" not in str(report)
        return
    text = path.read_text()
    assert {line.split()[-1] for line in text.splitlines() if line.startswith("MARKER_TAG")} == FACES
    assert "MARKER_PERIODIC= ( periodic_lower, periodic_upper, 0, 0, 0, 0, 0, 0, 0, 0.027, 0 )" in str(report)
    assert report.to_dict()["su2"] in str(report)


def test_a_mesh_of_gmsh_has_the_groups_and_the_pairs_of_nodes_in_metres(gmsh, rotor, rotor_mesh):
    path, report = rotor_mesh
    found = groups(opened(gmsh, path))
    assert set(found) == FACES | {"tip", "fluid"}
    assert found["fluid"][0] == 3
    pairs, motions = set(), []
    copies, originals = (
        gmsh.model.getEntitiesForPhysicalGroup(*found[name]) for name in ("periodic_upper", "periodic_lower")
    )
    for face in copies:
        known, own, theirs, motion = gmsh.model.mesh.getPeriodicNodes(2, face)
        assert known in originals
        pairs |= set(zip(own.tolist(), theirs.tolist(), strict=True))
        motions.append(motion)
    nodes, masters = zip(*sorted(pairs), strict=True)
    assert len(nodes) == report.periodic_nodes
    assert all(np.array_equal(motion, motions[0]) for motion in motions)
    matrix = np.reshape(motions[0], (4, 4))
    points, origins = (np.array([gmsh.model.mesh.getNode(tag)[0] for tag in tags]) for tags in (nodes, masters))
    # of a pitch of 0.1 m
    np.testing.assert_allclose(origins @ matrix[:3, :3].T + matrix[:3, 3], points, rtol=0.0, atol=1e-13)
    turn = 2.0 * np.pi / rotor.passage.blade.design.blade_count
    # theta grows from z to y, against the right hand about x
    assert matrix[1, 2] == pytest.approx(np.sin(turn), rel=1e-12)
    boxes = np.array([gmsh.model.getBoundingBox(2, face) for face in copies])
    low, high = boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)
    assert (low <= points.min(axis=0) + 1e-6).all()
    assert (high >= points.max(axis=0) - 1e-6).all()
    assert (high - low < 1.0).all()


def test_a_rotor_with_a_gap_at_its_tip_passes(rotor, rotor_mesh):
    _, report = rotor_mesh
    assert report.passed, report
    assert report.rotation_deg == pytest.approx(-360.0 / rotor.passage.blade.design.blade_count, rel=1e-12)
    assert report.translation == (0.0, 0.0, 0.0)
    (tip,) = [face for face in report.faces if face.name == "tip"]
    assert 0.0 < tip.max_deviation_mm <= report.deviation_limit_mm


@pytest.mark.slow
def test_the_same_passage_gives_the_same_mesh_a_thousand_times_as_large_in_millimetres(cascade, cascade_as, tmp_path):
    metres, millimetres = cascade_as(".msh")[0], tmp_path / "mm.msh"
    report = cascade.mesh(millimetres, unit="mm")
    assert report.passed, report
    assert report.translation[1] == pytest.approx(27.0, rel=1e-12)
    assert np.allclose(read_mesh(millimetres)["nodes"], 1e3 * read_mesh(metres)["nodes"], rtol=1e-12, atol=1e-9)


@pytest.mark.slow
def test_pieces_of_faces_are_joined_to_one_group(cascade, tmp_path):
    import bladewright as bw
    from bladewright import cad, meshing

    passage = bw.passage(cascade.passage.blade, split=True)
    assert "hub_upper" not in passage.surfaces
    cad.write(passage, tmp_path / "split.step", samples=100)
    report = meshing.mesh(tmp_path / "split.step", tmp_path / "split.msh", passage=passage, size=0.3)
    assert report.passed, report
    assert {face.name for face in report.faces} == FACES


NATIVE = """$Entities
1 1 1 0
1 2000 0 3000 0
1 0 0 0 2000 0 3000 0 0
7 -1 -2 -3 4 5 6 1 3 1 1
$EndEntities
$Periodic
2
2 8 7
16 1 0 0 0 0 1 0 57.5 0 0 1 0 0 0 0 1
1
4 2
0 2 1
0
1
4 2
$EndPeriodic
$Elements
"""


def test_entities_and_motions_are_scaled_and_nothing_else():
    lines = list(rescaled(iter(NATIVE.splitlines(keepends=True)), 1e-3))
    before = NATIVE.splitlines(keepends=True)
    changed = [i for i, (old, new) in enumerate(zip(before, lines, strict=True)) if old != new]
    assert changed == [2, 3, 4, 9]
    assert lines[2].split() == ["1", "2.0", "0.0", "3.0", "0"]
    assert [float(word) for word in lines[4].split()[1:7]] == [-1e-3, -2e-3, -3e-3, 4e-3, 5e-3, 6e-3]
    assert lines[4].split()[7:] == ["1", "3", "1", "1"]
    assert float(lines[9].split()[8]) == 57.5e-3


def test_motions_can_be_left_out():
    assert "".join(motionless(iter(NATIVE.splitlines(keepends=True)))) == (
        NATIVE[: NATIVE.index("$Periodic")] + "$Elements\n"
    )


def test_a_file_that_cannot_be_written_is_refused(cascade, tmp_path):
    with pytest.raises(FileError, match="create the directory"):
        cascade.mesh(tmp_path / "nowhere" / "mesh.msh")
    assert list(tmp_path.iterdir()) == []
