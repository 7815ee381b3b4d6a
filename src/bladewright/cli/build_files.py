"""A design is built into CAD files, which are reopened and measured."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from bladewright.cli.directory import removing_partial_files
from bladewright.cli.load_design import bodies_from, load_design
from bladewright.cli.outcome import Outcome, jsonable
from bladewright.cli.progress import Bar

SUFFIXES = {"step": ".step", "iges": ".igs", "brep": ".brep", "stl": ".stl", "3mf": ".3mf"}


@dataclass(frozen=True, kw_only=True)
class BuildOptions:
    """What is to be made of a design, and where."""

    directory: Path
    formats: tuple[str, ...]
    """keys of SUFFIXES"""
    bodies: tuple[str, ...]
    """of BODIES"""
    schema: Literal["AP242", "AP214", "AP203"]
    iges_surfaces: bool
    """trimmed surfaces in the IGES file, in the place of a solid"""
    chordal_deviation: float | None
    """largest gap of STL and 3MF [m]"""
    extend: float
    """part of its span by which a blade is extended at both ends"""
    changes: Mapping[str, Any]
    """of the design's parameters, by path"""
    reach: Mapping[str, Any]
    """options of a passage"""

    @property
    def steps(self) -> int:
        """Steps of a bar for one design."""
        return len(self.bodies) * (1 + len(self.formats))


def build_files(path: Path, making: BuildOptions, bar: Bar) -> Outcome:
    """Make the design at a path into files; an error leaves none of them behind."""
    from bladewright.files.text import write_text

    blueprint: Any = load_design(path, making.changes)
    names = {body: blueprint.name + ("-passage" if body == "passage" else "") for body in making.bodies}
    files = [f"{name}{SUFFIXES[each]}" for name in names.values() for each in making.formats]
    reports = [
        f"{name}{SUFFIXES[each] if number else ''}.roundtrip.json"
        for name in names.values()
        for number, each in enumerate(making.formats)
    ]
    directory, trips = making.directory, list[Any]()
    with removing_partial_files(directory, [*files, *reports]):
        bar.set_description_str(" and ".join(making.bodies))
        for built in bodies_from(making.bodies, blueprint, path, making.extend, making.reach):
            bar.update(1)
            from bladewright import cad

            for each in making.formats:
                bar.set_description_str(each)
                file, report = files[len(trips)], reports[len(trips)]
                trip = cad.write(
                    built,
                    directory / file,
                    schema=making.schema,
                    solid=not (making.iges_surfaces and each == "iges"),
                    chordal_deviation=making.chordal_deviation,
                )
                write_text(directory / report, json.dumps(jsonable(trip.to_dict()), indent=2) + "\n")
                trips.append(trip)
                bar.update(1)
    return Outcome(
        data={
            "name": built.name if len(making.bodies) == 1 else blueprint.name,
            "passed": all(trip.passed for trip in trips),
            "files": [str(directory / file) for file in files],
            "roundtrips": [trip.to_dict() for trip in trips],
        },
        text="\n".join(str(trip) for trip in trips),
        failures=tuple(f"{file}: {text}" for file, trip in zip(files, trips, strict=True) for text in trip.failures),
    )
