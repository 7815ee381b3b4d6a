"""`bladewright build`: a design becomes CAD files that are reopened and measured."""

import json
from pathlib import Path
from typing import Any, Literal

import click

from bladewright.cli.blueprint import design_at
from bladewright.cli.call import Call, common
from bladewright.cli.directory import tidy
from bladewright.cli.domain import BODIES, check_options, named_body, passage_options
from bladewright.cli.options import design_argument, extend_option, length, listed, set_option
from bladewright.cli.outcome import Outcome, jsonable
from bladewright.cli.progress import progress

SUFFIXES = {"step": ".step", "iges": ".igs", "brep": ".brep", "stl": ".stl", "3mf": ".3mf"}


@click.command(short_help="Design to verified CAD files.")
@design_argument
@click.option(
    "-o", "--output", "directory", type=click.Path(path_type=Path), default=".", help="Directory to write into."
)
@click.option(
    "--as",
    "formats",
    default="step,iges",
    show_default=True,
    callback=listed(tuple(SUFFIXES)),
    help="Formats, with commas between: step, iges, brep, stl, 3mf.",
)
@click.option(
    "--body",
    "bodies",
    default="blade",
    show_default=True,
    callback=listed(BODIES),
    help="What to make solid, with commas between: blade, passage.",
)
@click.option(
    "--schema",
    type=click.Choice(["AP242", "AP214", "AP203"]),
    default="AP242",
    show_default=True,
    help="Application protocol of the STEP file.",
)
@click.option("--iges-surfaces", is_flag=True, help="Trimmed surfaces in the IGES file, in the place of a solid.")
@click.option(
    "--chordal-deviation", callback=length, metavar="LENGTH", help="Largest gap of STL and 3MF, such as 0.01mm."
)
@extend_option
@passage_options
@set_option
@common
@click.pass_obj
def build(
    call: Call,
    /,
    design: Path,
    directory: Path,
    formats: tuple[str, ...],
    bodies: tuple[str, ...],
    schema: Literal["AP242", "AP214", "AP203"],
    iges_surfaces: bool,
    chordal_deviation: float | None,
    extend: float,
    changes: dict[str, Any],
    **reach: Any,
) -> Outcome:
    """Build DESIGN into verified CAD files: NAME.step, NAME.igs and so on, NAME being the design's name.

    With --body passage the files of the flow passage are NAME-passage.step and so on. NAME.roundtrip.json beside them
    is what was measured on the reopened file of the first format; each further format has its own, such as
    NAME.igs.roundtrip.json. Where a check fails the files stay, say so, and the exit status is 1.
    """
    from bladewright.files.text import write_text

    check_options(bodies, extend, reach)
    blueprint: Any = design_at(design, changes)
    names = {body: blueprint.name + ("-passage" if body == "passage" else "") for body in bodies}
    files = [f"{name}{SUFFIXES[each]}" for name in names.values() for each in formats]
    reports = [
        f"{name}{SUFFIXES[each] if number else ''}.roundtrip.json"
        for name in names.values()
        for number, each in enumerate(formats)
    ]
    trips: list[Any] = []
    with tidy(directory, [*files, *reports]), progress(len(bodies) * (1 + len(formats)), call) as bar:
        for body in bodies:
            bar.set_description_str(body)
            built = named_body(body, blueprint, design, extend, reach)
            bar.update(1)
            from bladewright import cad

            for each in formats:
                bar.set_description_str(each)
                file, report = files[len(trips)], reports[len(trips)]
                solid = not (iges_surfaces and each == "iges")
                trip = cad.write(
                    built, directory / file, schema=schema, solid=solid, chordal_deviation=chordal_deviation
                )
                write_text(directory / report, json.dumps(jsonable(trip.to_dict()), indent=2) + "\n")
                trips.append(trip)
                bar.update(1)
    return Outcome(
        data={
            "name": built.name if len(bodies) == 1 else blueprint.name,
            "passed": all(trip.passed for trip in trips),
            "files": [str(directory / file) for file in files],
            "roundtrips": [trip.to_dict() for trip in trips],
        },
        text="\n".join(str(trip) for trip in trips),
        failures=tuple(f"{file}: {text}" for file, trip in zip(files, trips, strict=True) for text in trip.failures),
    )
