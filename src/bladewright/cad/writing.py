"""Writing CAD files, each of which is read again from disk and measured before anyone relies on it."""

import os
from pathlib import Path

from OCP.BRepTools import BRepTools

from bladewright.atomic_write import atomic_write
from bladewright.cad.iges import write_iges
from bladewright.cad.kernel import quiet
from bladewright.cad.mesh_verification import write_mesh
from bladewright.cad.native_body import NativeBody
from bladewright.cad.reading import format_of
from bladewright.cad.round_trip import RoundTrip
from bladewright.cad.solids import OccSolid, cached_occ_solid
from bladewright.cad.step import Schema, write_step
from bladewright.cad.verification import SAMPLES, verify
from bladewright.errors import CadError


def write(
    built: NativeBody,
    path: str | os.PathLike[str],
    *,
    schema: Schema = "AP242",
    solid: bool = True,
    chordal_deviation: float | None = None,
    samples: int = SAMPLES,
) -> RoundTrip:
    """Write a blade or passage to a CAD file, read it again from disk and measure it; returns the round trip.

    The ending of `path` decides the format: .step and .stp with the application protocol `schema`; .iges and .igs with
    a manifold solid (entity 186), or with trimmed surfaces (entity 144) where `solid` is false; .brep; .stl and .3mf
    with triangles within `chordal_deviation` [m] of the surfaces, by default 1e-4 of the body's extent. The file is
    written completely or not at all. Raises CadError where it cannot be written or the surfaces do not close a volume.
    A file that was written but misses a limit stays there; the round trip says which limit and by how much.
    """
    path = Path(path)
    kind = format_of(path)
    if kind in {"STL", "3MF"}:
        return write_mesh(built, path, chordal_deviation=chordal_deviation, samples=samples)
    with quiet():
        made = cached_occ_solid(built)
        with atomic_write(path) as unfinished:
            _write_format(built, made, unfinished, kind, schema=schema, solid=solid)
    return verify(path, built, samples=samples)


def _write_format(built: NativeBody, made: OccSolid, unfinished: str, kind: str, *, schema: str, solid: bool) -> None:
    if kind == "STEP":
        write_step(built, made, unfinished, schema=schema)
    elif kind == "IGES":
        write_iges(built, made, unfinished, solid=solid)
    elif not BRepTools.Write_s(made.solid, unfinished):
        raise CadError("OpenCASCADE could not write the BREP file: is there space left in that directory?")
