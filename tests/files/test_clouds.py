"""Clouds of points from files of every format: the same points come out, whatever stands around them."""

import numpy as np
import pytest

from bladewright.files.clouds import read_cloud

RANDOM = np.random.default_rng(4)
FLAT = RANDOM.uniform(-0.03, 0.05, (40, 2))
SOLID = RANDOM.uniform(-0.03, 0.05, (40, 3))


def rows(points, between, *, ids=None, number="{!r}"):
    lines = [[number.format(float(each)) for each in row] for row in points]
    if ids is not None:
        lines = [[str(each), *row] for each, row in zip(ids, lines, strict=True)]
    return "\n".join(between.join(line) for line in lines) + "\n"


IDS = range(700, 740)
TABLES = {
    "blanks": (rows(SOLID, "  "), SOLID),
    "tabs": (rows(SOLID, "\t"), SOLID),
    "commas": (rows(SOLID, ", "), SOLID),
    "semicolons": (rows(SOLID, ";"), SOLID),
    "no line end at the end": (rows(SOLID, " ").rstrip(), SOLID),
    "ids": (rows(SOLID, "\t", ids=IDS), SOLID),
    "ids in two dimensions": (rows(FLAT, "\t", ids=IDS), FLAT),
    "two dimensions": (rows(FLAT, " "), FLAT),
    "names": ("x,y,z\n" + rows(SOLID, ","), SOLID),
    "names in another order": ("Z Y X\n" + rows(SOLID[:, ::-1], " "), SOLID),
    "names in quotes": ('"PointID","x","y","z"\n' + rows(SOLID, ", ", ids=IDS), SOLID),
    "names of ParaView": ('"Points:0","Points:1","Points:2"\n' + rows(SOLID, ","), SOLID),
    "names of other columns": ("p x y z\n" + rows(np.column_stack([SOLID[:, 0], SOLID]), " "), SOLID),
    "names in a comment": ("# scan of yesterday\n# z x y\n" + rows(SOLID[:, [2, 0, 1]], " "), SOLID),
    "Tecplot": ('TITLE = "a"\nVARIABLES = "x", "y", "z"\nZONE I=40\n' + rows(SOLID, " "), SOLID),
    "comments between": (rows(SOLID[:9], " ") + "% more\n! still more\n\n" + rows(SOLID[9:], " "), SOLID),
    "comments behind": (rows(SOLID, " ").replace("\n", " # measured\n"), SOLID),
    "Windows": (("x;y;z\n" + rows(SOLID, ";")).replace("\n", "\r\n"), SOLID),
    "an old Macintosh": (rows(SOLID, " ").replace("\n", "\r"), SOLID),
    "numbers in quotes": ('"x","y"\n"' + rows(FLAT, '","').replace("\n", '"\n"').rstrip('"'), FLAT),
    "a byte-order mark": ("\ufeffx,y,z\n" + rows(SOLID, ","), SOLID),
    "decimal commas": (rows(SOLID, ";").replace(".", ","), SOLID),
    "decimal commas and blanks": (rows(SOLID, "  ", number="{:.22f}").replace(".", ","), SOLID),
    "exponents of Fortran": (rows(SOLID, " ", number="{:.20E}").replace("E", "D"), SOLID),
    "the number of points above": ("40\n" + rows(SOLID, " "), SOLID),
}


@pytest.fixture
def file(tmp_path):
    def write(content, name="cloud.txt"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.mark.parametrize("name", TABLES)
def test_a_table_gives_its_points_to_the_bit(name, file):
    text, points = TABLES[name]
    found = read_cloud(file(text))
    assert np.array_equal(found.points, points)
    assert found.unit == "m"
    assert found.notes == ()


def test_columns_can_be_said(file):
    path = file(rows(SOLID[:, ::-1], "\t", ids=IDS))
    assert np.array_equal(read_cloud(path, columns=["skip", "z", "y", "x"]).points, SOLID)
    assert np.array_equal(read_cloud(path, columns=["skip", "skip", "y", "x"]).points, SOLID[:, :2])


def test_theta_turns_z_towards_y(file):
    found = read_cloud(file("x r theta\n1 2 0\n1 2 90\n1 2 30\n")).points
    assert found == pytest.approx(np.array([[1, 0, 2], [1, 2, 0], [1, 1, np.sqrt(3)]]), abs=1e-15)
    radians = read_cloud(file("x [m], r [m], theta [rad]\n1, 2, 0.5\n")).points
    assert radians == pytest.approx(np.array([[1, 2 * np.sin(0.5), 2 * np.cos(0.5)]]), abs=1e-15)
    said = read_cloud(file("30 2 1\n45 2 1\n"), columns=("theta", "r", "x")).points
    assert said[0] == pytest.approx([1, 1, np.sqrt(3)], abs=1e-15)


@pytest.mark.parametrize(("unit", "metre"), [("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("um", 1e-6), ("in", 0.0254)])
def test_lengths_come_out_in_metres(unit, metre, file):
    points = SOLID / metre
    assert read_cloud(file(rows(points, " ")), unit=unit).points == pytest.approx(SOLID, rel=1e-14)
    named = f"x [{unit}], y [{unit}], z [{unit}]\n" + rows(points, ",")
    assert read_cloud(file(named)).points == pytest.approx(SOLID, rel=1e-14)
    assert read_cloud(file(named)).unit == unit
    # what is asked for outweighs what the file says
    assert read_cloud(file(named), unit="m").points == pytest.approx(points)


def test_a_unit_that_no_blade_has_is_suspected(file):
    (note,) = read_cloud(file(rows(SOLID * 1e3, " "))).notes
    assert "taken to be in m" in note
    assert "give the unit mm" in note
    (note,) = read_cloud(file(rows(SOLID, " ")), unit="mm").notes
    assert "given as mm" in note
    assert "give the unit m" in note
    assert read_cloud(file(rows(SOLID * 1e3, " ")), unit="mm").notes == ()


@pytest.mark.parametrize("taken", ["m", "mm"])
@pytest.mark.parametrize(("unit", "metre"), [("mm", 1e-3), ("m", 1.0), ("in", 0.0254)])
def test_the_likeliest_unit_of_a_blade_of_a_decimetre_is_named(unit, metre, taken, file):
    notes = read_cloud(file(rows(SOLID / metre, " ")), unit=taken).notes
    # some inches are as many metres, a blade of a fan
    right = unit == taken or (unit, taken) == ("in", "m")
    assert [f"Then give the unit {unit}" in note for note in notes] == ([] if right else [True])


def profile():
    """A closed profile around the leading edge, 41 points, and its two sides from there."""
    x = (1 + np.cos(np.linspace(0.0, 2 * np.pi, 41))) / 2
    y = np.where(np.arange(41) < 20, 1.0, -1.0) * 0.1 * np.sqrt(x) * (1 - x)
    selig = np.column_stack([x, y])
    return selig, np.concatenate([selig[20::-1], selig[20:]])


@pytest.mark.parametrize("title", ["NACA 0012 AIRFOIL", "NACA 0012", "a profile with x and y"])
def test_airfoils_are_read_in_both_orders(title, file):
    selig, lednicer = profile()
    found = read_cloud(file(f"{title}\n" + rows(selig, " ")))
    assert found.format == "a Selig airfoil"
    assert np.array_equal(found.points, selig)
    upper, lower = rows(lednicer[:21], " "), rows(lednicer[21:], " ")
    found = read_cloud(file(f"{title}\n  21.  21.\n\n{upper}\n{lower}"))
    assert found.format == "a Lednicer airfoil"
    assert np.array_equal(found.points, lednicer)


def test_numpy_arrays_are_read(tmp_path):
    np.save(tmp_path / "cloud.npy", SOLID)
    assert np.array_equal(read_cloud(tmp_path / "cloud.npy").points, SOLID)
    np.save(tmp_path / "columns.npy", np.tile(SOLID, (20, 1)).T)
    turned = read_cloud(tmp_path / "columns.npy")
    assert np.array_equal(turned.points, np.tile(SOLID, (20, 1)))
    assert "a column for each point" in turned.notes[0]
    np.savez(tmp_path / "cloud.npz", points=FLAT, other=SOLID)
    assert np.array_equal(read_cloud(tmp_path / "cloud.npz").points, FLAT)
    np.savez(tmp_path / "parts.npz", y=SOLID[:, 1], z=SOLID[:, 2], x=SOLID[:, 0])
    assert np.array_equal(read_cloud(tmp_path / "parts.npz").points, SOLID)
    kind = np.dtype([("z", float), ("x", float), ("y", float)])
    np.save(tmp_path / "named.npy", np.array([tuple(row) for row in SOLID[:, [2, 0, 1]]], dtype=kind))
    assert np.array_equal(read_cloud(tmp_path / "named.npy").points, SOLID)


PLY = "ply\nformat {}\ncomment made here\nelement vertex 40\nproperty double x\nproperty double y\nproperty double z\n"
PLY += "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_binary_ply_file_keeps_double_precision(order, file):
    vertices = np.zeros(40, dtype=[*((axis, f"{order}f8") for axis in "xyz"), ("red", "u1")])
    for i, axis in enumerate("xyz"):
        vertices[axis] = SOLID[:, i]
    kind = "binary_little_endian 1.0" if order == "<" else "binary_big_endian 1.0"
    data = PLY.format(kind).encode() + vertices.tobytes() + b"\3" + np.arange(3, dtype=f"{order}i4").tobytes()
    assert np.array_equal(read_cloud(file(data)).points, SOLID)


def test_an_ascii_ply_file_is_read_up_to_its_faces(file):
    text = PLY.format("ascii 1.0") + rows(SOLID, " ").replace("\n", " 255\n") + "3 0 1 2\n"
    assert np.array_equal(read_cloud(file(text)).points, SOLID)


def test_the_vertices_of_a_stl_file_come_once(file):
    corners = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    triangles = corners[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    records = np.zeros(4, dtype=kind)
    records["corners"] = triangles
    binary = b"made by a scanner".ljust(80) + np.uint32(4).tobytes() + records.tobytes()
    text = "solid a\n"
    for triangle in triangles:
        text += "facet normal 0 0 0\nouter loop\n"
        text += "".join(f"vertex {x:g} {y:g} {z:g}\n" for x, y, z in triangle) + "endloop\nendfacet\n"
    for content in (binary, text + "endsolid a\n"):
        found = read_cloud(file(content)).points
        assert np.array_equal(found[np.lexsort(found.T)], corners[np.lexsort(corners.T)])


@pytest.mark.parametrize("ending", ["vtk", "vtp", "vtu"])
def test_vtk_files_are_read_whatever_their_name(ending, tmp_path):
    from vtkmodules import vtkIOLegacy, vtkIOXML
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkUnstructuredGrid

    points = vtkPoints()
    points.SetData(numpy_to_vtk(SOLID, deep=True))
    grid = vtkUnstructuredGrid() if ending == "vtu" else vtkPolyData()
    grid.SetPoints(points)
    writers = {"vtk": vtkIOLegacy.vtkPolyDataWriter, "vtp": vtkIOXML.vtkXMLPolyDataWriter}
    writer = writers.get(ending, vtkIOXML.vtkXMLUnstructuredGridWriter)()
    path = tmp_path / "cloud.points"
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    if ending == "vtk":
        writer.SetFileTypeToBinary()
    assert writer.Write()
    assert np.array_equal(read_cloud(path).points, SOLID)


def test_what_su2_is_given_comes_back(tmp_path):
    import bladewright as bw
    from bladewright.files.examples import example_text

    path = tmp_path / "section.toml"
    path.write_text(example_text("turbine-section"))
    points = bw.surface_points(bw.read_design(path).build(), along=30, across=2)
    bw.write_surface_points(points, tmp_path / "surface.dat")
    assert np.array_equal(read_cloud(tmp_path / "surface.dat").points, points.points)
