"""Points for a flow solver, and the sensitivities to them that come back: whole, in order, of the same points."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.errors import DerivativeError, FileError
from bladewright.files.examples import example_text
from bladewright.files.su2 import places_path
from machines.coarse import SECTION

UNITS = np.array([2.0, -3.0, 5.0])


@pytest.fixture(scope="module")
def design(tmp_path_factory):
    path = tmp_path_factory.mktemp("design") / "vki-ls89.toml"
    path.write_text(example_text("vki-ls89"))
    return bw.read_design(path).changed("tolerance", 1e-4)


@pytest.fixture(scope="module")
def blade(design):
    return design.build()


@pytest.fixture(scope="module")
def points(blade):
    return bw.surface_points(blade, along=9, across=4)


@pytest.fixture
def written(points, tmp_path):
    path = tmp_path / "surface_positions.dat"
    bw.write_surface_points(points, path)
    return path


def table(points, rates, *, number="PointID", order=None):
    """As SU2's CSV writer does it: quoted names, blanks after commas, fifteen digits."""
    names = [number, "x", "y", "z", "Sensitivity_x", "Sensitivity_y", "Sensitivity_z", "Surface_Sensitivity"]
    lines = [",".join(f'"{name}"' for name in names)]
    for i in range(len(points.ids)) if order is None else order:
        row = [*points.points[i], *rates[i], 0.0]
        lines.append(", ".join([str(points.ids[i]), *(f"{each:.15e}" for each in row)]))
    return "\n".join([*lines, ""])


def test_points_lie_on_both_sides_and_shared_edges_are_there_once(points, blade):
    # two sides of 9 x 4, whose leading and trailing edges of 4 each are shared
    assert len(points.ids) == 2 * 9 * 4 - 2 * 4
    assert list(points.ids) == list(range(len(points.ids)))
    gaps = np.linalg.norm(points.points[:, None] - points.points[None], axis=-1)
    assert np.min(gaps + np.eye(len(gaps))) > 1e-6
    for i in (0, 17, 50):
        on = blade.surfaces[points.names[i]](points.u[i], points.v[i])
        assert points.points[i] == pytest.approx(on, abs=1e-15)


def test_what_is_written_is_what_su2_reads(written, points):
    rows = np.loadtxt(written)
    assert np.array_equal(rows[:, 0], points.ids)
    # repr keeps every digit
    assert np.array_equal(rows[:, 1:], points.points)


def test_points_are_read_back_to_the_bit(written, points):
    back = bw.read_surface_points(written)
    assert np.array_equal(back.ids, points.ids)
    assert back.names == points.names
    for name in ("u", "v", "points"):
        assert np.array_equal(getattr(back, name), getattr(points, name))


def test_points_follow_another_design_in_their_places(points, design):
    other = design.changed("stagger", design.stagger + 1.0).build()
    moved = points.on(other)
    assert np.array_equal(moved.ids, points.ids)
    i = 30
    assert moved.points[i] == pytest.approx(other.surfaces[points.names[i]](points.u[i], points.v[i]))
    assert np.abs(moved.points - points.points).max() > 1e-4


@pytest.mark.parametrize("number", ["PointID", "Point", "GlobalIndex"])
def test_a_table_in_any_order_comes_back_in_that_of_the_points(number, written, points, tmp_path):
    rates = np.random.default_rng(0).standard_normal(points.points.shape)
    path = tmp_path / "surface_sens.csv"
    order = np.random.default_rng(1).permutation(len(points.ids))
    path.write_text(table(points, rates, number=number, order=order))
    found = bw.read_surface_sensitivity(path, bw.read_surface_points(written))
    assert found == pytest.approx(rates, rel=1e-14)


def test_the_gradient_of_a_known_objective_comes_out(design, blade, points, written, tmp_path):
    # the objective c . (sum of all points) has the sensitivity c at each: its gradient is c . (sum of all dS/dp)
    path = tmp_path / "surface_sens.csv"
    path.write_text(table(points, np.broadcast_to(UNITS, points.points.shape)))
    back = bw.read_surface_points(written)
    gradient = bw.pullback(design, back.bars(bw.read_surface_sensitivity(path, back)), knots=blade.knots)

    def objective(blade):
        return sum(np.sum(blade.surfaces[name](u, v) @ UNITS) for name, (u, v, _) in points.bars(points.points).items())

    exact = bw.sensitivity(design, objective, knots=blade.knots)
    assert list(gradient) == list(exact)
    scale = max(abs(value) for value in exact.values())
    assert list(gradient.values()) == pytest.approx([float(value) for value in exact.values()], abs=1e-12 * scale)


def test_a_file_for_paraview_is_matched_by_place(points, tmp_path):
    rates = np.random.default_rng(0).standard_normal(points.points.shape)
    order = np.random.default_rng(1).permutation(len(points.ids))
    path = tmp_path / "surface_sens.vtu"
    write_vtu(path, points.points[order], {"Sensitivity": rates[order]})
    found = bw.read_surface_sensitivity(path, points)
    # the solver writes single precision
    assert found == pytest.approx(rates, rel=1e-6)
    write_vtu(path, points.points[order], {f"Sensitivity_{axis}": rates[order, i] for i, axis in enumerate("xyz")})
    assert bw.read_surface_sensitivity(path, points) == pytest.approx(rates, rel=1e-6)


def write_vtu(path, points, fields):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    grid, places = vtkUnstructuredGrid(), vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=np.float32), deep=True))
    grid.SetPoints(places)
    for name, values in fields.items():
        array = numpy_to_vtk(np.ascontiguousarray(values, dtype=np.float32), deep=True)
        array.SetName(name)
        grid.GetPointData().AddArray(array)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    assert writer.Write() == 1


def with_entry(line, place, change):
    entries = line.split(", ")
    entries[place] = change(entries[place])
    return ", ".join(entries)


BROKEN = {
    "missing": (
        lambda lines: lines[:5] + lines[7:],
        "has no row for points 4, 5: every point that was written needs its sensitivity",
    ),
    "foreign": (
        lambda lines: [*lines, with_entry(lines[-1], 0, lambda _: "9999")],
        "has rows for point 9999, which were not written: name the design's surfaces alone in DV_MARKER",
    ),
    "twice": (lambda lines: [*lines, lines[3]], "has point 2 more than once"),
    "columns": (
        lambda lines: [lines[0].replace("Sensitivity_y", "Sensitivity_2"), *lines[1:]],
        "the column 'Sensitivity_y' does not exist.*did you mean 'Sensitivity_",
    ),
    "scalar": (
        lambda lines: [lines[0].replace(',"Sensitivity_', ',"Adjoint_'), *lines[1:]],
        "holds Surface_Sensitivity alone, along the normals",
    ),
    "unnumbered": (
        lambda lines: [lines[0].replace("PointID", "rho"), *lines[1:]],
        "has no column PointID: its columns are rho, x",
    ),
    "moved": (
        lambda lines: [*lines[:4], with_entry(lines[4], 1, lambda x: f"{float(x) + 1e-4:.15e}"), *lines[5:]],
        "has point 3 elsewhere than they were written, 3 by 0.0001 m",
    ),
    "word": (
        lambda lines: [*lines[:4], with_entry(lines[4], 2, lambda _: "one"), *lines[5:]],
        "has 'one' in row 5: a number is needed",
    ),
    "nan": (
        lambda lines: [*lines[:4], with_entry(lines[4], 5, lambda _: "nan"), *lines[5:]],
        "not finite, at point 3: has the adjoint converged",
    ),
    "half": (
        lambda lines: [*lines[:4], with_entry(lines[4], 0, lambda _: "2.5"), *lines[5:]],
        "numbers a point 2.5: a whole number is needed",
    ),
    "cut": (lambda lines: [*lines[:-1], lines[-1][:40]], "entries in row .*, and 8 columns: is it cut off"),
    "empty": (lambda lines: lines[:1], "holds no rows"),
}


@pytest.mark.parametrize(("breaking", "message"), BROKEN.values(), ids=BROKEN)
def test_a_table_that_is_not_of_these_points_is_refused(breaking, message, points, tmp_path):
    path = tmp_path / "surface_sens.csv"
    path.write_text("\n".join(breaking(table(points, np.ones(points.points.shape)).splitlines())))
    with pytest.raises(FileError, match=message):
        bw.read_surface_sensitivity(path, points)


@pytest.mark.parametrize("name", ["surface_sens.csv", "surface_sens.vtu"])
def test_a_file_that_is_not_there_or_no_table_is_refused(name, points, tmp_path):
    with pytest.raises(FileError, match="there is no file"):
        bw.read_surface_sensitivity(tmp_path / name, points)
    (tmp_path / name).write_bytes(b"\x89PNG\r\n\x1a\n\0\0\xff")
    with pytest.raises(FileError, match=r"is no text|is no VTU file"):
        bw.read_surface_sensitivity(tmp_path / name, points)


def test_a_vtu_file_of_other_points_or_without_the_field_is_refused(points, tmp_path):
    path = tmp_path / "surface_sens.vtu"
    write_vtu(path, points.points, {"Pressure": points.points[:, 0]})
    with pytest.raises(FileError, match="has no field Sensitivity at its points: its fields are Pressure"):
        bw.read_surface_sensitivity(path, points)
    write_vtu(path, points.points[:-1], {"Sensitivity": points.points[:-1]})
    with pytest.raises(FileError, match=f"holds {len(points.ids) - 1} points, and {len(points.ids)} were written"):
        bw.read_surface_sensitivity(path, points)
    write_vtu(path, points.points + 1e-4, {"Sensitivity": points.points})
    with pytest.raises(FileError, match="elsewhere than they were written"):
        bw.read_surface_sensitivity(path, points)


def test_nothing_is_left_behind_where_points_cannot_be_written(points, tmp_path):
    with pytest.raises(FileError, match="cannot be written"):
        bw.write_surface_points(points, tmp_path / "absent" / "points.dat")
    directory = tmp_path / "points.dat"
    directory.mkdir()
    with pytest.raises(FileError, match="is a directory"):
        bw.write_surface_points(points, directory)
    assert list(tmp_path.iterdir()) == [directory]


def test_the_file_beside_is_needed_to_read_points(written):
    places_path(written).unlink()
    with pytest.raises(FileError, match=r"there is no file '.*places.csv'"):
        bw.read_surface_points(written)


def test_points_of_a_mesh_made_elsewhere_find_their_places(blade, points):
    order = np.random.default_rng(2).permutation(len(points.ids))
    found = bw.placed_points(blade, 100 + points.ids[order], points.points[order])
    assert np.array_equal(found.ids, 100 + points.ids[order])
    assert found.points == pytest.approx(points.points[order], abs=1e-12)
    with pytest.raises(DerivativeError, match=r"lies 0\.001 m off upper, lower"):
        bw.placed_points(blade, points.ids, points.points + np.array([0.0, 0.0, 1e-3]))
    with pytest.raises(DerivativeError, match="the number 7 is given to more than one point"):
        bw.placed_points(blade, np.full(len(points.ids), 7), points.points)


def test_the_points_of_a_section_are_those_of_its_curves():
    points = bw.surface_points(SECTION.build(), along=11)
    assert points.points.shape == (20, 2)
    gradient = bw.pullback(SECTION, points.bars(np.broadcast_to([1.0, 0.0], points.points.shape)))
    assert gradient["leading_edge_x"] == pytest.approx(20.0 * 1e-3)
    found = bw.placed_points(SECTION.build(), points.ids, points.points)
    assert found.points == pytest.approx(points.points, abs=1e-12)


@pytest.mark.parametrize(
    ("options", "message"), [({"along": 1}, "1 x 21 points"), ({"names": ["uper"]}, "did you mean 'upper'")]
)
def test_points_that_cannot_be_made_are_refused(options, message, blade):
    with pytest.raises(DerivativeError, match=message):
        bw.surface_points(blade, **options)


def test_values_of_another_number_of_points_are_refused(points):
    with pytest.raises(DerivativeError, match="one row for each point is needed"):
        points.bars(np.ones((3, 3)))
