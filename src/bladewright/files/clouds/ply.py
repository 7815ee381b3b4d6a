"""Vertices of PLY files, ASCII and binary.

They are read here because the libraries lose something: VTK rounds double coordinates to single precision and reads a
wrong element where the vertices are not the first, meshio depends on the order of x, y and z, and trimesh takes a file
that breaks off for a complete one (design/cloud_readers.py).
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns
from bladewright.nurbs.basis import Reals

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}


class _Element(NamedTuple):
    """An element of the header, such as the vertices."""

    name: str
    number: int
    properties: list[tuple[str, str]]
    """name and type of each"""


def read_ply(path: Path, data: bytes) -> Columns:
    """The vertices; raises FileError where the header cannot be read or the file is cut off."""
    order, elements, start = _header(path, data)
    before: list[_Element] = []
    for element in elements:
        if element.name == "vertex":
            break
        before.append(element)
    else:
        raise FileError(f"'{path}' is a PLY file without vertices")
    names = [name for name, _ in element.properties]
    if not {"x", "y", "z"} <= set(names) or any(
        kind == "list" for each in (*before, element) for _, kind in each.properties
    ):
        raise FileError(f"'{path}' is a PLY file whose vertices have {', '.join(names)}: x, y and z are needed")
    skipped = sum(each.number for each in before)
    if order:
        kind = np.dtype([(name, order + _TYPES[each]) for name, each in element.properties])
        start += sum(
            np.dtype([(n, order + _TYPES[t]) for n, t in each.properties]).itemsize * each.number for each in before
        )
        if len(data) < start + kind.itemsize * element.number:
            count = max(0, len(data) - start) // kind.itemsize
            raise FileError(f"'{path}' is a PLY file that breaks off after {count} of {element.number} vertices")
        rows = np.frombuffer(data, dtype=kind, offset=start, count=element.number)
        values = np.stack([rows[axis].astype(np.float64) for axis in "xyz"], axis=-1)
    else:
        body = [line for line in data[start:].splitlines() if line.strip()][skipped : skipped + element.number]
        values = _ascii(path, body, element, [names.index(axis) for axis in "xyz"])
    if not len(values):
        raise FileError(f"'{path}' is a PLY file without vertices")
    return Columns(values=values, format="a PLY file", columns=("x", "y", "z"))


def _ascii(path: Path, body: list[bytes], element: _Element, places: list[int]) -> Reals:
    if len(body) < element.number:
        raise FileError(f"'{path}' is a PLY file that breaks off after {len(body)} of {element.number} vertices")
    try:
        return np.loadtxt([line.decode("latin-1") for line in body], usecols=places, ndmin=2)
    except (ValueError, IndexError) as error:
        raise FileError(f"'{path}' is a PLY file with a vertex that is no row of numbers: {error}") from None


def _header(path: Path, data: bytes) -> tuple[str, list[_Element], int]:
    """Byte order ("" for ASCII), elements, and the offset at which the header ends."""
    end = data.find(b"end_header")
    start = data.find(b"\n", end) + 1
    if end < 0 or start == 0:
        raise FileError(f"'{path}' is a PLY file that breaks off in its header")
    order: str | None = None
    elements: list[_Element] = []
    for line in data[:end].decode("latin-1").splitlines():
        match line.split():
            case ["format", kind, _]:
                order = _ORDERS.get(kind)
            case ["element", name, count] if count.isdigit():
                elements.append(_Element(name, int(count), []))
            case ["property", "list", *_, name] if elements:
                elements[-1].properties.append((name, "list"))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append((name, kind))
            case ["ply"] | ["comment", *_] | ["obj_info", *_] | []:
                pass
            case _:
                raise FileError(f"'{path}' is a PLY file with '{line.strip()[:60]}' in its header, which is not known")
    if order is None:
        raise FileError(f"'{path}' is a PLY file that does not say its format: ascii or binary")
    return order, elements, start
