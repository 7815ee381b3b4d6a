"""A design is built into CAD files, which are reopened and measured."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from bladewright.cli.directory import removing_partial_files
from bladewright.cli.law_remarks import law_data, law_rows
from bladewright.cli.load_design import bodies_from, body_name, load_design
from bladewright.cli.masses import mass_data, mass_texts
from bladewright.cli.outcome import Outcome, jsonable
from bladewright.cli.overwriting import overwritten
from bladewright.cli.progress import Bar
from bladewright.cli.stations import sense_data, sense_rows, station_table

SUFFIXES = {"step": ".step", "iges": ".igs", "brep": ".brep", "stl": ".stl", "3mf": ".3mf"}
"""Endings of the files of each format."""
FORMATS = ("step", "iges")
"""Formats of a body where none is asked for."""
ROW_FORMATS = ("step", "brep")
"""Formats that keep one blade and its placements, of which the first is written where none is asked for."""


@dataclass(frozen=True, kw_only=True)
class BuildOptions:
    """What a design is built into, and where the files go."""

    directory: Path
    formats: tuple[str, ...] | None
    """each a key of SUFFIXES; None: those of the body"""
    bodies: tuple[str, ...]
    """each a word of BODIES"""
    schema: Literal["AP242", "AP214", "AP203"]
    iges_surfaces: bool
    """whether the IGES file holds trimmed surfaces instead of a solid"""
    chordal_deviation: float | None
    """largest distance of the triangles of STL and 3MF from the solid [m]; None: the default of `cad.write`"""
    stations: tuple[float, ...] | None
    """span fractions of the station table; None: no table"""
    unit: Literal["mm", "m", "in"]
    """of length in the files"""
    colour: str
    """of the faces, as `cad.write` takes it"""
    force: bool
    """whether files are overwritten that were made from another design file"""
    extend: float
    """fraction of the span by which a blade is extended at both ends [-]"""
    fine: bool
    """whether the blade meets hub and shroud within 1e-7 mm"""
    split: bool
    """whether faces are cut as other CAD programs need it"""
    changes: Mapping[str, Any]
    """changes of the design's parameters, by path"""
    extents: Mapping[str, Any]
    """options of a passage: how far it reaches, its angles, its walls, whether it is split"""
    blades: int | None = None
    """number of blades of a row; None: all"""

    def formats_of(self, body: str) -> tuple[str, ...]:
        """The formats that a body is written in."""
        return self.formats or (ROW_FORMATS[:1] if body == "row" else FORMATS)

    @property
    def steps(self) -> int:
        """Steps of a progress bar for one design."""
        return sum(1 + len(self.formats_of(body)) for body in self.bodies)


def build_files(path: Path, options: BuildOptions, bar: Bar) -> Outcome:
    """Build the design in a file into CAD files and their reports; an error leaves none of them behind."""
    from bladewright.files.origin import design_origin
    from bladewright.files.text import write_text

    directory, trips = options.directory, list[Any]()
    design: Any = load_design(path, options.changes)
    origin = design_origin(path, options.changes, directory=directory)
    names = {body: body_name(design, body) for body in options.bodies}
    files = [f"{name}{SUFFIXES[each]}" for body, name in names.items() for each in options.formats_of(body)]
    reports = [
        f"{name}{SUFFIXES[each] if number else ''}.roundtrip.json"
        for body, name in names.items()
        for number, each in enumerate(options.formats_of(body))
    ]
    former = [directory / f"{name}{end}.roundtrip.json" for name in names.values() for end in ("", *SUFFIXES.values())]
    note = overwritten([directory / each for each in files], former, path, origin, force=options.force)
    sense, table, masses = dict[str, Any](), None, dict[str, Any]()
    with removing_partial_files(directory, [*files, *reports]):
        bar.set_description_str(" and ".join(options.bodies))
        made = _made(design, path, options, bar)
        for body, built in made.items():
            masses[body] = mass_data(built)
            blade = getattr(built, "blade", built)
            sense = sense or sense_data(blade)
            table = table or (station_table(blade, options.stations) if options.stations else None)
            from bladewright import cad

            for each in options.formats_of(body):
                bar.set_description_str(each)
                file, report = files[len(trips)], reports[len(trips)]
                trip = cad.write(
                    built,
                    directory / file,
                    schema=options.schema,
                    solid=not (options.iges_surfaces and each == "iges"),
                    split=options.split,
                    chordal_deviation=options.chordal_deviation,
                    unit=options.unit,
                    colour=options.colour,
                    origin=origin,
                )
                write_text(directory / report, json.dumps(jsonable(trip.to_dict()), indent=2) + "\n")
                trips.append(trip)
                bar.update(1)
    laws = law_data(design)
    remarks = [
        *(f"{name} {words}" for name, words in law_rows(laws)),
        *(f"{name}: {words}" for name, words in sense_rows(sense, with_table=table is not None)),
        *(f"{design.name}: {body}: {words}" for body, found in masses.items() for words in mass_texts(found)),
        *([str(table)] if table else []),
        *([note] if note else []),
    ]
    return Outcome(
        data={
            "name": built.name if len(options.bodies) == 1 else design.name,
            "passed": all(trip.passed for trip in trips),
            "files": [str(directory / file) for file in files],
            "roundtrips": [trip.to_dict() for trip in trips],
            "overwritten": note or None,
            **({"laws": laws} if laws else {}),
            **sense,
            **({"masses": masses} if any(masses.values()) else {}),
            **({"table": table.to_dict()} if table else {}),
        },
        text="\n".join([*(trip.text(design.length_unit) for trip in trips), *remarks]),
        failures=tuple(f"{file}: {text}" for file, trip in zip(files, trips, strict=True) for text in trip.failures),
    )


def _made(design: Any, path: Path, options: BuildOptions, bar: Bar) -> dict[str, Any]:
    """All bodies by their words, before the first file: an error leaves no new file among those of a former build."""
    found = dict[str, Any]()
    bodies = bodies_from(
        options.bodies, design, path, options.extend, options.extents, fine=options.fine, blades=options.blades
    )
    for body, built in zip(options.bodies, bodies, strict=True):
        found[body] = built
        bar.update(1)
    return found
