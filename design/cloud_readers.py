"""Which libraries read the PLY and STL clouds that bladewright reads, and what they lose.

40 points of double precision (4 of single precision as binary STL) in every layout that tests/files holds, read by the
readers of bladewright, of VTK 9.6.2 (installed with cadquery), of meshio 5.3.5 and of trimesh 5.2.0. "exact" is to the
last bit, else the largest error of a coordinate is given, of 0.05:

    file                          bladewright  VTK      meshio      trimesh
    PLY little endian, double     exact        1.8e-09  exact       exact
    PLY big endian, double        exact        1.8e-09  exact       exact
    PLY ASCII, double             exact        1.8e-09  exact       exact
    PLY ASCII, named float        exact        1.8e-09  1.8e-09     1.8e-09
    PLY z y x                     exact        1.8e-09  wrong       exact
    PLY other element first       exact        wrong    fails       exact
    PLY with too few vertices     refused      wrong    wrong       wrong
    STL binary                    exact        exact    exact       exact
    STL ASCII                     exact        1.4e-09  exact       exact
    STL that breaks off           refused      wrong    wrong       fails

meshio ends the process where it fails (sys.exit), and reads neither VTP nor legacy VTK files of polygons, which is what
point clouds are. So VTK reads VTK's own formats, and PLY and STL are read by files/clouds/ply.py and stl.py.

    python design/cloud_readers.py        (columns of libraries that are not installed stay empty)
"""

import io
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from bladewright.files.clouds import read_cloud

POINTS = np.random.default_rng(4).uniform(-0.03, 0.05, (40, 3))
CORNERS = np.random.default_rng(4).uniform(-0.03, 0.05, (3, 3))
STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def ply(layout, kind="double", axes="xyz", before="", body=b"", count=40):
    properties = "".join(f"property {kind} {axis}\n" for axis in axes)
    return f"ply\nformat {layout} 1.0\n{before}element vertex {count}\n{properties}end_header\n".encode() + body


def text(points):
    return "".join(" ".join(repr(float(each)) for each in point) + "\n" for point in points).encode()


def files():
    record = np.zeros(1, dtype=STL)
    record["corners"] = CORNERS
    binary = b"scan".ljust(80) + np.uint32(1).tobytes() + record.tobytes()
    vertices = b"".join(b"vertex " + line + b"\n" for line in text(CORNERS).splitlines())
    ascii_stl = b"solid a\nfacet normal 0 0 0\nouter loop\n" + vertices + b"endloop\nendfacet\nendsolid a\n"
    camera = "element camera 1\nproperty double f\n"
    yield "PLY little endian, double", ply("binary_little_endian", body=POINTS.astype("<f8").tobytes()), POINTS
    yield "PLY big endian, double", ply("binary_big_endian", body=POINTS.astype(">f8").tobytes()), POINTS
    yield "PLY ASCII, double", ply("ascii", body=text(POINTS)), POINTS
    yield "PLY ASCII, named float", ply("ascii", "float", body=text(POINTS)), POINTS
    yield "PLY z y x", ply("ascii", axes="zyx", body=text(POINTS[:, ::-1])), POINTS
    yield "PLY other element first", ply("ascii", before=camera, body=b"7\n" + text(POINTS)), POINTS
    yield "PLY with too few vertices", ply("ascii", body=text(POINTS[:9])), None
    yield "STL binary", binary, CORNERS.astype(np.float32)
    yield "STL ASCII", ascii_stl, CORNERS
    yield "STL that breaks off", binary[:80] + np.uint32(9).tobytes() + record.tobytes(), None


def by_vtk(path, kind):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOGeometry import vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader

    vtkObject.GlobalWarningDisplayOff()
    reader = vtkPLYReader() if kind == "ply" else vtkSTLReader()
    reader.SetFileName(str(path))
    reader.Update()
    points = reader.GetOutput().GetPoints()
    return vtk_to_numpy(points.GetData()) if points else np.zeros((0, 3))


def by_meshio(path, kind):
    import meshio

    return meshio.read(path, file_format=kind).points


def by_trimesh(path, kind):
    from trimesh.exchange import ply, stl

    found = (ply.load_ply if kind == "ply" else stl.load_stl)(io.BytesIO(path.read_bytes()))
    return found.get("vertices", np.zeros((0, 3)))


def verdict(library, reader, path, kind, expected):
    if find_spec(library) is None:
        return ""
    try:
        found = np.unique(np.asarray(reader(path, kind), dtype=float), axis=0)
    except SystemExit:
        return "fails"
    except Exception as error:  # noqa: BLE001 - whatever a library raises
        return "refused" if type(error).__name__ == "FileError" else "fails"
    if expected is None or found.shape != expected.shape:
        return "wrong"
    error = np.max(np.abs(found - np.unique(expected.astype(float), axis=0)))
    return "exact" if error == 0.0 else f"{error:.1e}" if error < 1e-6 else "wrong"


def main():
    ours = ("bladewright", lambda path, _: read_cloud(path).points)
    readers = (ours, ("vtkmodules", by_vtk), ("meshio", by_meshio), ("trimesh", by_trimesh))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cloud"
        for name, data, expected in files():
            path.write_bytes(data)
            row = [verdict(*reader, path, name[:3].lower(), expected) for reader in readers]
            print(f"{name:28}  " + "  ".join(f"{each:10}" for each in row))


if __name__ == "__main__":
    main()
