"""STL and 3MF files: watertight, within the chordal deviation asked for, and caught where they are not."""

import re
import zipfile

import numpy as np
import pytest
from scipy.spatial import cKDTree

from bladewright import cad
from bladewright.cad.mesh import ClosestTriangle, TriangleMesh, mesh_of_triangles
from bladewright.cad.mesh_files import RECORD, read_3mf, read_stl
from bladewright.errors import CadError

from .conftest import COARSE, MESHES


@pytest.fixture(scope="module")
def stl(filed):
    return filed("annular", "stl")


@pytest.fixture
def edited(stl, tmp_path):
    """A function that writes the triangles of the STL file as it is told."""

    def put(change):
        data = stl[0].read_bytes()
        records = np.frombuffer(data, dtype=RECORD, offset=84).copy()
        records = change(records)
        path = tmp_path / "edited.stl"
        path.write_bytes(data[:80] + np.uint32(len(records)).astype("<u4").tobytes() + records.tobytes())
        return path

    return put


@pytest.mark.parametrize("ending", MESHES)
def test_a_mesh_is_watertight_and_within_its_chordal_deviation(body, built, filed, ending):
    trip = filed(body, ending)[1]
    assert trip.passed, str(trip)
    assert (trip.solids, trip.shells, trip.free_edges) == (1, 1, 0)
    assert trip.limits["side_mm"] == pytest.approx(COARSE * 1e3)
    assert {face.name for face in trip.faces} == set(built.surfaces)
    assert 0.0 < max(face.max_deviation for face in trip.faces) <= COARSE * 1e3
    # chords of a blade are shorter than it is round
    assert trip.volume.relative_error < trip.limits["volume"]


def test_a_finer_mesh_deviates_less(rotor, stl, tmp_path):
    fine = cad.write(rotor, tmp_path / "rotor.stl", chordal_deviation=COARSE / 2.0, samples=300)
    assert fine.passed
    assert fine.edges.count > stl[1].edges.count
    assert fine.volume.relative_error < stl[1].volume.relative_error


def test_the_default_chordal_deviation_is_a_ten_thousandth_of_the_extent(bodies, tmp_path):
    trip = cad.write(bodies["brick"], tmp_path / "brick.stl", samples=200)
    assert trip.passed
    points = np.concatenate([face.control_points.reshape(-1, 3) for face in bodies["brick"].surfaces.values()])
    assert trip.limits["side_mm"] == pytest.approx(1e-4 * 1e3 * np.ptp(points, axis=0).max())


@pytest.mark.parametrize("asked", [0.0, -1e-5, np.nan, np.inf])
def test_a_chordal_deviation_that_is_no_length_is_refused(bodies, tmp_path, asked):
    with pytest.raises(CadError, match="must be positive"):
        cad.write(bodies["linear"], tmp_path / "vane.stl", chordal_deviation=asked)
    assert not list(tmp_path.iterdir())


def test_a_missing_triangle_is_caught(rotor, edited):
    trip = cad.verify(edited(lambda records: records[1:]), rotor, samples=200)
    assert not trip.passed
    # the triangle's three edges
    assert trip.free_edges == 3
    assert any("not watertight" in failure for failure in trip.failures)


def test_a_triangle_turned_round_is_caught(rotor, edited):
    def turned(records):
        records["corners"][0] = records["corners"][0][::-1]
        return records

    trip = cad.verify(edited(turned), rotor, samples=200)
    assert any("not watertight" in failure for failure in trip.failures)


def test_a_moved_vertex_is_caught(rotor, edited):
    def moved(records):
        corners = records["corners"]
        place = corners[len(corners) // 2, 0].copy()
        corners[np.all(corners == place, axis=-1)] += np.float32([0.0, 1.0, 0.0])
        return records

    path = edited(moved)
    trip = cad.verify(path, rotor, samples=300)
    assert trip.free_edges == 0
    assert any("mm off at u = " in failure for failure in trip.failures)


def test_a_mesh_in_another_unit_is_caught(rotor, edited):
    def inches(records):
        records["corners"] /= np.float32(25.4)
        return records

    trip = cad.verify(edited(inches), rotor, samples=200)
    assert any("the volume is off" in failure for failure in trip.failures)


def test_an_ascii_file_is_read_as_well(rotor, stl, tmp_path):
    mesh, _ = read_stl(stl[0])
    lines = ["solid rotor"]
    for corners in mesh.corners:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners]
        lines += ["endloop", "endfacet"]
    (tmp_path / "ascii.stl").write_text("\n".join([*lines, "endsolid rotor\n"]))
    trip = cad.verify(tmp_path / "ascii.stl", rotor, samples=200)
    assert trip.free_edges == 0
    # nine digits of each coordinate
    assert trip.volume.cad == pytest.approx(stl[1].volume.cad, rel=1e-8)


def test_a_3mf_file_says_its_unit_and_who_made_it(bodies, filed):
    built = bodies["linear"]
    with zipfile.ZipFile(filed("linear", "3mf")[0]) as package:
        assert {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"} == set(package.namelist())
        model = package.read("3D/3dmodel.model").decode()
    assert 'unit="millimeter"' in model
    for key, text in (("Title", built.name), ("Designer", built.author), ("Description", built.description)):
        assert re.search(rf'<metadata name="{key}">{text}</metadata>', model)


def test_a_3mf_file_in_metres_is_read_in_millimetres(filed, tmp_path):
    millimetres = filed("linear", "3mf")[0]
    with zipfile.ZipFile(millimetres) as package:
        parts = {name: package.read(name) for name in package.namelist()}
    parts["3D/3dmodel.model"] = parts["3D/3dmodel.model"].replace(b'unit="millimeter"', b'unit="meter"')
    with zipfile.ZipFile(tmp_path / "large.3mf", "w") as package:
        for name, content in parts.items():
            package.writestr(name, content)
    small, large = read_3mf(millimetres), read_3mf(tmp_path / "large.3mf")
    assert (small[1], large[1]) == ("mm", "m")
    assert large[0].volume == pytest.approx(1e9 * small[0].volume)


def test_volume_and_centroid_of_a_tetrahedron_are_right():
    vertices = np.array([[1.0, 2.0, 3.0], [2.0, 2.0, 3.0], [1.0, 3.0, 3.0], [1.0, 2.0, 4.0]])
    mesh = TriangleMesh(vertices=vertices, triangles=np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))
    assert mesh.volume == pytest.approx(1.0 / 6.0)
    np.testing.assert_allclose(mesh.centroid, vertices.mean(axis=0))
    assert (mesh.open_edges, mesh.shells) == (0, 1)


def test_the_nearest_triangle_is_the_one_that_brute_force_finds():
    random = np.random.default_rng(5)
    mesh = mesh_of_triangles(random.random((20, 3, 3)))
    points = 2.0 * random.random((100, 3)) - 0.5
    share = np.linspace(0.0, 1.0, 41)
    a, b = (grid.ravel() for grid in np.meshgrid(share, share))
    a, b = a[a + b <= 1.0], b[a + b <= 1.0]
    weights = np.stack([a, b, 1.0 - a - b], axis=-1)
    dense = np.einsum("pk,mkd->mpd", weights, mesh.corners).reshape(-1, 3)
    brute = cKDTree(dense).query(points)[0]
    found = ClosestTriangle(mesh).distance(points, 0.0)
    # the dense points of a triangle are a fortieth of a side apart
    assert np.all(found <= brute + 1e-12)
    np.testing.assert_allclose(found, brute, atol=0.03)


def test_a_large_triangle_is_found_behind_hundreds_of_small_ones():
    # a fan of slivers about a corner of a large triangle: their middles are nearer than the large one's
    angles = np.linspace(0.0, 0.5 * np.pi, 400)
    rim = 0.001 * np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=-1)
    fan = np.stack([np.zeros_like(rim[1:]), rim[:-1], rim[1:]], axis=1)
    large = np.array([[[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]])
    found = ClosestTriangle(mesh_of_triangles(np.concatenate([fan, large]))).distance(
        np.array([[-1e-4, -1e-4, 0.0]]), 1e-6
    )
    np.testing.assert_allclose(found, 0.0, atol=1e-12)
