"""Writing CAD files, each of which is read again from disk and measured before anyone relies on it."""

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from OCP.BRepTools import BRepTools

from bladewright.atomic_write import atomic_write
from bladewright.cad.colours import face_colours
from bladewright.cad.face_pieces import whole_name
from bladewright.cad.iges import write_iges
from bladewright.cad.kernel import quiet
from bladewright.cad.mesh_verification import write_mesh
from bladewright.cad.native_body import NativeBody, origin_of
from bladewright.cad.placement import check_row_format, row_and_part, write_brep_row
from bladewright.cad.reading import format_of
from bladewright.cad.round_trip import RoundTrip
from bladewright.cad.solids import OccSolid, cached_occ_solid
from bladewright.cad.step import Schema, write_step
from bladewright.cad.units import Unit, check_unit
from bladewright.cad.verification import SAMPLES, verify
from bladewright.domain.row import Row
from bladewright.errors import CadError
from bladewright.origin import Origin


def write(
    built: NativeBody | Row,
    path: str | os.PathLike[str],
    *,
    schema: Schema = "AP242",
    solid: bool = True,
    split: bool = False,
    chordal_deviation: float | None = None,
    unit: Unit = "mm",
    colour: str = "parts",
    origin: Origin | None = None,
    samples: int = SAMPLES,
) -> RoundTrip:
    """Write a body to a CAD file, read it again from disk and measure it; returns the round trip.

    A body is a blade, a passage, a sector or a wheel, one solid each, or a row, which is an assembly of one blade and
    its placements, in STEP and BREP files alone.

    The ending of `path` decides the format: .step and .stp with the application protocol `schema`; .iges and .igs with
    a manifold solid (entity 186), or with trimmed surfaces (entity 144) where `solid` is false; .brep; .stl and .3mf
    with triangles within `chordal_deviation` [m] of the surfaces, by default 1e-4 of the body's extent. Faces are cut
    at creases, and with `split` wherever other programs' quadrature needs it (docs/build.md). `unit` is the unit of
    length in the file, "mm", "m" or "in"; BREP is always in mm. `colour` is that of the faces in STEP and IGES:
    "parts" for those of `cad.COLOURS`, one for all such as "#8899aa", or "none". `origin` is the design that the file
    says it was made from (`bladewright.origin`), by default what the body knows of its design.

    The file is written completely or not at all. Raises CadError where it cannot be written or the surfaces do not
    close a volume. A file that was written but misses a limit stays there; the round trip says which limit and by how
    much.
    """
    path = Path(path)
    kind, origin = format_of(path), origin or origin_of(built)
    check_unit(unit, kind)
    row, body = row_and_part(built)
    if row is not None:
        check_row_format(path, kind)
    if kind in {"STL", "3MF"}:
        trip = write_mesh(body, path, chordal_deviation=chordal_deviation, samples=samples, unit=unit)
        return replace(trip, origin=origin)
    colours = face_colours(body, colour)
    with quiet():
        made = cached_occ_solid(body, split=split)
        # pieces of a face have its colour
        colours = {face: colours[whole] for face in made.faces if (whole := whole_name(face, colours))}
        with atomic_write(path) as unfinished:
            if row is not None and kind == "BREP":
                write_brep_row(row, made, unfinished)
            else:
                _write_format(
                    body,
                    made,
                    unfinished,
                    kind,
                    schema=schema,
                    solid=solid,
                    unit=unit,
                    colours=colours,
                    origin=origin,
                    row=row,
                )
    return replace(verify(path, built, samples=samples), origin=origin)


def _write_format(
    built: NativeBody,
    made: OccSolid,
    unfinished: str,
    kind: str,
    *,
    schema: str,
    solid: bool,
    unit: Unit = "mm",
    colours: Mapping[str, str] | None = None,
    origin: Origin | None = None,
    row: Row | None = None,
) -> None:
    if kind == "STEP":
        write_step(built, made, unfinished, schema=schema, unit=unit, colours=colours, origin=origin, row=row)
    elif kind == "IGES":
        write_iges(built, made, unfinished, solid=solid, unit=unit, colours=colours, origin=origin)
    elif not BRepTools.Write_s(made.solid, unfinished):
        raise CadError("OpenCASCADE could not write the BREP file: is there space left in that directory?")
