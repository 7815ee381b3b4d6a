"""Files that are no cloud of points: one clear paragraph each, which says where."""

import numpy as np
import pytest

from bladewright.errors import FileError
from bladewright.files.clouds import read_cloud

GOOD = "".join(f"{0.001 * i:.4f} {0.002 * i * i % 0.05:.5f} {0.05 - 0.001 * i:.4f}\n" for i in range(20))
FLAT = "".join(f"{0.001 * i:.4f} {0.002 * i * i % 0.05:.5f}\n" for i in range(20))
PLY = "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
STL = b"scan".ljust(80, b"\0") + np.uint32(9).tobytes() + np.zeros(120, dtype="u1").tobytes()

BAD = {
    "empty": ("", ["is empty"]),
    "blank": ("\n \n", ["is empty"]),
    "only names": ("x y z\n", ["no rows of numbers", "'x y z'"]),
    "prose": ("Dear all,\nplease find the blade.\n", ["no rows of numbers", "'Dear all,'"]),
    "a word for a number": (GOOD.replace("0.0030 ", "abc "), ["'abc' at line 4, column 1"]),
    "a word below names": ("x y z\n\n" + GOOD.replace(" 0.0400", " n/a"), ["'n/a' at line 13, column 3"]),
    "a word in the first row": ("abc 0.5 0.25\n" + GOOD, ["'abc' at line 1, column 1"]),
    "NaN": (GOOD.replace("0.0030 ", "nan "), ["nan at line 4, column 1", "finite"]),
    "infinity": ("# a\n\n" + GOOD.replace("0.0030 ", "inf "), ["inf at line 6, column 1"]),
    "a short row": (GOOD.replace("0.0030 ", ""), ["2 entries in line 4, and 3 in the others", "same length"]),
    "a long row": (GOOD.replace("0.0030 ", "0.0 0.0 "), ["4 entries in line 4"]),
    "cut off between numbers": (GOOD[:-8], ["2 entries in line 20", "cut off"]),
    "cut off in a number": (GOOD + "0.01 0.02 0.0e-", ["'0.0e-' at line 21, column 3", "cut off"]),
    "an empty entry": ("1,2,3\n1,,3\n", ["an empty entry at line 2, column 2"]),
    "one column": ("1.5\n2.5\n", ["one number in a row", "1.5"]),
    "five columns": ("1 2 3 4 5\n2 3 4 5 6\n", ["5 columns", "first row (line 1) is 1 2 3 4 5", "--columns"]),
    "four coordinates": ("1.5 2 3 4\n2 3 4 5\n", ["4 columns", "--columns"]),
    "whole numbers that may be ids": (
        "".join(f"{i} {0.5 * i} {0.25 * i}\n" for i in range(9)),
        ["may be ids or coordinates", "0 0 0", "--columns skip,x,y"],
    ),
    "names of half a point": ("x,p,t\n1.5,2,3\n", ["x, p, t", "of which x are understood"]),
    "binary": (bytes(range(256)) * 40, ["binary file"]),
    "binary at the end": (GOOD.encode() + b"\0\0", ["binary file"]),
    "STEP": ("ISO-10303-21;\nHEADER;\n", ["STEP file"]),
    "SU2 mesh": ("NDIME= 3\nNPOIN= 1\n0 0 0 0\n", ["SU2 mesh", "surface_flow.csv"]),
    "gzip": (b"\x1f\x8b\x08\x00", ["gzip", "unpack"]),
    "UTF-16": (GOOD.encode("utf-16"), ["UTF-16"]),
    "a ZIP archive": (b"PK\x03\x04rubbish", ["ZIP archive"]),
    "half an NPY file": (b"\x93NUMPY\x01\x00", ["NPY file that is not whole"]),
    "PLY without an end": (PLY[:50], ["breaks off in its header"]),
    "PLY with too few vertices": (PLY + "1 2 3\n", ["after 1 of 9 vertices"]),
    "PLY with a word": (PLY + "1 2 3\n" * 8 + "1 a 3\n", ["no row of numbers"]),
    "PLY without z": (PLY.replace("property float z\n", ""), ["x, y and z are needed"]),
    "STL that breaks off": (STL, ["breaks off after 2 of 9 triangles"]),
    "ASCII STL that breaks off": ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0", ["before endsolid"]),
    "VTK without points": ("# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\n", ["VTK file without points"]),
    "VTK cut off": ('<VTKFile type="PolyData"><PolyData>', ["VTK file without points"]),
    "VTK of an image": ('<VTKFile type="ImageData"/>', ["without points of its own"]),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_cloud_is_refused_in_a_paragraph(name, tmp_path):
    content, parts = BAD[name]
    path = tmp_path / "cloud.txt"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(FileError) as refused:
        read_cloud(path)
    message = str(refused.value)
    assert str(path) in message
    for part in parts:
        assert part in message
    assert len(message.splitlines()) == 1


def test_a_file_that_is_not_there_or_a_directory_is_refused(tmp_path):
    with pytest.raises(FileError, match="there is no file"):
        read_cloud(tmp_path / "absent.txt")
    with pytest.raises(FileError, match="is a directory"):
        read_cloud(tmp_path)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (("x", "y", "w"), "'w' is not known"),
        (("x", "y"), "has 3 columns, and 2 are named"),
        (("x", "y", "z", "skip"), "too few"),
        (("x", "x", "y"), "make no points"),
        (("x", "r", "z"), "make no points"),
        (("skip", "skip", "x"), "make no points"),
    ],
)
def test_columns_that_do_not_fit_are_refused(columns, message, tmp_path):
    path = tmp_path / "cloud.txt"
    path.write_text(GOOD)
    with pytest.raises(FileError, match=message):
        read_cloud(path, columns=columns)


def test_two_columns_where_three_are_needed_are_refused(tmp_path):
    path = tmp_path / "cloud.txt"
    path.write_text(FLAT)
    with pytest.raises(FileError, match="has 2 columns, and 3 are named: they are too few"):
        read_cloud(path, columns=("x", "y", "z"))


def test_an_unknown_unit_is_refused(tmp_path):
    path = tmp_path / "cloud.txt"
    path.write_text(GOOD)
    with pytest.raises(FileError, match="'furlong' is not known"):
        read_cloud(path, unit="furlong")


def test_columns_in_different_units_are_refused(tmp_path):
    path = tmp_path / "cloud.txt"
    path.write_text("x [mm],y [in]\n1.5,2.5\n")
    with pytest.raises(FileError, match="columns in in and mm"):
        read_cloud(path)
