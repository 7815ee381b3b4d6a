"""CAD files of built objects, each reopened from disk and measured before anyone relies on it."""

import os
from pathlib import Path

from OCP.BRepTools import BRepTools

from bladewright.atomic_write import atomic_write
from bladewright.cad.iges import write_iges
from bladewright.cad.kernel import quiet
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
    """Write a built object to a CAD file, reopen it from disk and measure it; the round trip.

    The ending of `path` says what is written: .step and .stp in a `schema` of STEP; .iges and .igs with a manifold
    solid (entity 186), or with trimmed surfaces (144) where `solid` is false; .brep; .stl and .3mf with triangles
    within `chordal_deviation` [m] of the surfaces, by default 1e-4 of the body's extent. The file appears whole or not
    at all. Raises CadError where it cannot be written or the surfaces do not close up; a file that was written but is
    not what was meant stays there, and the round trip says what is wrong.
    """
    path = Path(path)
    kind = format_of(path)
    if kind in {"STL", "3MF"}:
        from bladewright.cad.mesh_verification import write_mesh

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
