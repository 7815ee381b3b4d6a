"""STL files: binary ones are written, ASCII ones are read as well; their unit is taken to be the millimetre."""

import re
from pathlib import Path

import numpy as np

from bladewright.cad.mesh import Mesh, merged
from bladewright.cad.reopen import ends
from bladewright.cad.step import SYSTEM
from bladewright.errors import CadError

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_stl(mesh: Mesh, path: str, *, name: str) -> None:
    """Write a binary STL file."""
    corners = mesh.corners.astype("<f4")
    records = np.zeros(len(corners), dtype=RECORD)
    records["corners"] = corners
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    records["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=-1), 1e-30)[:, None]
    # a header that began with "solid" would pass for ASCII
    title = f"binary STL of {name} [mm] by {SYSTEM}".encode("ascii", "replace")[:80].ljust(80)
    with Path(path).open("wb") as file:
        file.write(title + np.uint32(len(records)).astype("<u4").tobytes() + records.tobytes())


def read_stl(path: Path) -> Mesh:
    """The triangles of an STL file. Raises CadError where it is none, or not whole."""
    head, _ = ends(path)
    data = path.read_bytes()
    count = int(np.frombuffer(data[80:84].ljust(4, b"\0"), dtype="<u4")[0])
    if len(data) == 84 + RECORD.itemsize * count and count:
        corners = np.frombuffer(data, dtype=RECORD, offset=84)["corners"].astype(np.float64)
    elif head.lstrip().startswith(b"solid") and b"facet" in head:
        if b"endsolid" not in data[-4096:]:
            raise CadError(f"{path} is not a whole STL file: it breaks off before endsolid; write it again")
        number = rb"([-+0-9.eE]+)"
        found = re.findall(rb"vertex\s+" + rb"\s+".join([number] * 3), data)
        corners = np.array(found, dtype=np.float64).reshape(-1, 3, 3)
    else:
        raise CadError(
            f"{path} is not a whole STL file: {len(data)} bytes do not hold the {count} triangles it announces, and it "
            "is not ASCII; write it again"
        )
    if not np.all(np.isfinite(corners)):
        raise CadError(f"{path} holds a vertex that is not a finite number: write it again")
    return merged(corners)
