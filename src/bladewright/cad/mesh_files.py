"""STL and 3MF files of triangles: 3MF states its unit; STL does not, and is in millimetres unless bladewright says."""

import re
import zipfile
from pathlib import Path
from xml.etree import ElementTree as ET
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from bladewright.cad.mesh import TriangleMesh, mesh_of_triangles
from bladewright.cad.native_body import NativeBody, header_text
from bladewright.cad.reading import first_and_last_bytes
from bladewright.cad.step import SYSTEM
from bladewright.cad.units import MILLIMETRES, Unit
from bladewright.errors import CadError

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL file."""


def write_stl(mesh: TriangleMesh, path: str, *, name: str, unit: Unit = "mm") -> None:
    """Write a binary STL file of a mesh [mm] in a unit of length, which its header names."""
    corners = (mesh.corners / MILLIMETRES[unit]).astype("<f4")
    records = np.zeros(len(corners), dtype=RECORD)
    records["corners"] = corners
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    records["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=-1), 1e-30)[:, None]
    # a header that begins with "solid" would be taken for ASCII
    title = f"binary STL [{unit}] by {SYSTEM} of {name}".encode("ascii", "replace")[:80].ljust(80)
    with Path(path).open("wb") as file:
        file.write(title + np.uint32(len(records)).astype("<u4").tobytes() + records.tobytes())


STL_UNIT = re.compile(rb"binary STL \[(mm|m|in)\] by bladewright")
"""What the headers of STL files begin with that bladewright wrote."""


def read_stl(path: Path) -> tuple[TriangleMesh, Unit]:
    """The triangles [mm] of an STL file, and its unit: the one that bladewright wrote in its header, else mm.

    Raises CadError where it is none, or incomplete.
    """
    head, _ = first_and_last_bytes(path)
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
    stated = STL_UNIT.match(head)
    unit: Unit = next((each for each in MILLIMETRES if stated and each.encode() == stated[1]), "mm")
    return mesh_of_triangles(corners * MILLIMETRES[unit]), unit


CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MODEL = "3D/3dmodel.model"
UNITS = {"micron": 1e-3, "millimeter": 1.0, "centimeter": 10.0, "inch": 25.4, "foot": 304.8, "meter": 1000.0}
"""Millimetres in each unit of the format."""
SHORT = {"millimeter": "mm", "meter": "m", "inch": "in"}
"""The units of the format that files are written in, and their signs."""

TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    f'<Relationship Target="/{MODEL}" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    "</Relationships>"
)


def write_3mf(mesh: TriangleMesh, path: str, *, built: NativeBody, unit: Unit = "mm") -> None:
    """Write a 3MF file of a mesh [mm] in a unit of length."""
    texts = {
        "Title": built.name,
        "Designer": header_text(built, "author"),
        "Description": header_text(built, "description"),
        "Application": SYSTEM,
    }
    metadata = "".join(f'<metadata name="{key}">{escape(text)}</metadata>' for key, text in texts.items() if text)
    places, word = mesh.vertices / MILLIMETRES[unit], next(word for word, sign in SHORT.items() if sign == unit)
    vertices = "".join(f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in places.tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.triangles.tolist())
    model = (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<model unit="{word}" xml:lang="en-US" xmlns="{CORE}">{metadata}'
        f'<resources><object id="1" type="model" name={quoteattr(built.name)}><mesh><vertices>{vertices}</vertices>'
        f'<triangles>{triangles}</triangles></mesh></object></resources><build><item objectid="1"/></build></model>'
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr("[Content_Types].xml", TYPES)
        package.writestr("_rels/.rels", RELATIONS)
        package.writestr(MODEL, model)


def read_3mf(path: Path) -> tuple[TriangleMesh, str]:
    """The triangles [mm] of a 3MF file, and its unit. Raises CadError where it is none, or incomplete."""
    first_and_last_bytes(path)
    try:
        with zipfile.ZipFile(path) as package:
            # the XML parser itself refuses entities that expand exponentially
            root = ET.fromstring(package.read(MODEL))  # noqa: S314
        unit = root.get("unit", "millimeter")
        corners = []
        for mesh in root.iter(f"{{{CORE}}}mesh"):
            vertices = np.array(
                [[float(node.get(axis, "nan")) for axis in "xyz"] for node in mesh.iter(f"{{{CORE}}}vertex")]
            )
            triangles = [[int(t.get(k, "-1")) for k in ("v1", "v2", "v3")] for t in mesh.iter(f"{{{CORE}}}triangle")]
            corners.append(vertices[np.array(triangles, dtype=np.int64)])
        found = np.concatenate(corners) * UNITS[unit]
    except (zipfile.BadZipFile, KeyError, ET.ParseError, ValueError, IndexError, OSError, EOFError) as error:
        raise CadError(f"{path} is not a whole 3MF file ({error}): write it again") from error
    return mesh_of_triangles(found), SHORT.get(unit, unit)
