"""CAD files of built objects, each reopened from disk and measured before anyone relies on it."""

import os
from pathlib import Path

from OCP.BRepTools import BRepTools

from bladewright.appearing import appearing
from bladewright.cad.built import Built
from bladewright.cad.iges import write_iges
from bladewright.cad.quiet import quiet
from bladewright.cad.reopen import format_of
from bladewright.cad.roundtrip import RoundTrip
from bladewright.cad.solids import Body, body_of
from bladewright.cad.step import Schema, write_step
from bladewright.cad.verification import SAMPLES, verify
from bladewright.errors import CadError


def write(
    built: Built,
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
        from bladewright.cad.mesh_trip import write_mesh

        return write_mesh(built, path, chordal_deviation=chordal_deviation, samples=samples)
    with quiet():
        made = body_of(built)
        with appearing(path) as unfinished:
            _put(built, made, unfinished, kind, schema=schema, solid=solid)
    return verify(path, built, samples=samples)


def _put(built: Built, made: Body, unfinished: str, kind: str, *, schema: str, solid: bool) -> None:
    if kind == "STEP":
        write_step(built, made, unfinished, schema=schema)
    elif kind == "IGES":
        write_iges(built, made, unfinished, solid=solid)
    elif not BRepTools.Write_s(made.solid, unfinished):
        raise CadError("OpenCASCADE could not write the BREP file: is there space left in that directory?")
