"""Vertices of STL files, each once; the format says no unit."""

import re
from pathlib import Path

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def is_stl(data: bytes) -> bool:
    """Whether a file's contents are an STL file, whole or not."""
    head = data[:1024].lstrip()
    ascii_file = head.startswith(b"solid") and b"facet" in head
    binary_file = len(data) >= 84 and b"\0" in data[:84] and 84 + _RECORD.itemsize * _announced(data) >= len(data) > 84
    return ascii_file or (binary_file and _announced(data) > 0 and _plausible(data))


def read_stl(path: Path, data: bytes) -> Columns:
    """The vertices, each once; raises FileError where the file is cut off."""
    if len(data) == 84 + _RECORD.itemsize * _announced(data):
        corners = np.frombuffer(data, dtype=_RECORD, offset=84)["corners"].astype(np.float64)
    elif data[:1024].lstrip().startswith(b"solid") and b"facet" in data[:1024]:
        if b"endsolid" not in data[-4096:]:
            raise FileError(f"'{path}' is an STL file that breaks off before endsolid: write it again")
        try:
            corners = np.array(_VERTEX.findall(data), dtype=np.float64)
        except ValueError as error:
            raise FileError(f"'{path}' is an STL file with a vertex that is no number: {error}") from None
    else:
        held = (len(data) - 84) // _RECORD.itemsize
        raise FileError(f"'{path}' is an STL file that breaks off after {held} of {_announced(data)} triangles")
    points = np.unique(corners.reshape(-1, 3), axis=0)
    return Columns(values=points, format="an STL file", columns=("x", "y", "z"))


def _announced(data: bytes) -> int:
    return int(np.frombuffer(data[80:84].ljust(4, b"\0"), dtype="<u4")[0])


def _plausible(data: bytes) -> bool:
    """Whether the first triangles have unit normals or none, as no other binary file has."""
    whole = min((len(data) - 84) // _RECORD.itemsize, 20)
    if whole == 0:
        return False
    normals = np.frombuffer(data, dtype=_RECORD, offset=84, count=whole)["normal"].astype(np.float64)
    sizes = np.sum(normals**2, axis=-1) if np.all(np.isfinite(normals)) else np.full(whole, 9.0)
    return bool(np.all((sizes < 1e-6) | (np.abs(sizes - 1.0) < 0.02)))
