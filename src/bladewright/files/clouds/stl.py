"""Vertices of STL files, each once; the format states no unit.

They are read here because VTK rounds the numbers of ASCII files to single precision (design/cloud_readers.py).
"""

import re
from pathlib import Path

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns

HEADER = 84
"""[bytes] Length of a binary file's header: a title of 80 bytes and the number of triangles."""
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def is_stl(data: bytes) -> bool:
    """Whether the contents of a file are STL, complete or not."""
    head = data[:1024].lstrip()
    ascii_file = head.startswith(b"solid") and b"facet" in head
    binary_file = b"\0" in data[:HEADER] and HEADER < len(data) <= HEADER + _RECORD.itemsize * _triangle_count(data)
    return ascii_file or (binary_file and _has_unit_normals(data))


def read_stl(path: Path, data: bytes) -> Columns:
    """The vertices, each once; raises FileError where the file is cut off."""
    if len(data) == HEADER + _RECORD.itemsize * _triangle_count(data):
        corners = np.frombuffer(data, dtype=_RECORD, offset=HEADER)["corners"].astype(np.float64)
    elif data[:1024].lstrip().startswith(b"solid") and b"facet" in data[:1024]:
        if b"endsolid" not in data[-4096:]:
            raise FileError(f"'{path}' is an STL file that breaks off before endsolid: write it again")
        try:
            corners = np.array(_VERTEX.findall(data), dtype=np.float64)
        except ValueError as error:
            raise FileError(f"'{path}' is an STL file with a vertex that is no number: {error}") from None
    else:
        count = (len(data) - HEADER) // _RECORD.itemsize
        raise FileError(f"'{path}' is an STL file that breaks off after {count} of {_triangle_count(data)} triangles")
    points = np.unique(corners.reshape(-1, 3), axis=0)
    return Columns(values=points, format="an STL file", columns=("x", "y", "z"))


def _triangle_count(data: bytes) -> int:
    """The number of triangles that a binary file states."""
    return int(np.frombuffer(data[80:84].ljust(4, b"\0"), dtype="<u4")[0])


def _has_unit_normals(data: bytes) -> bool:
    """Whether the first 20 triangles have unit normals or zeros in their place, as no other binary file does."""
    count = min((len(data) - HEADER) // _RECORD.itemsize, 20)
    if count == 0:
        return False
    normals = np.frombuffer(data, dtype=_RECORD, offset=HEADER, count=count)["normal"].astype(np.float64)
    squares = np.sum(normals**2, axis=-1) if np.all(np.isfinite(normals)) else np.full(count, np.inf)
    return bool(np.all((squares < 1e-6) | (np.abs(squares - 1.0) < 0.02)))
