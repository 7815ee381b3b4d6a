"""`bladewright build`: a design becomes CAD files that are reopened and measured."""

from pathlib import Path
from typing import Any

import click

from bladewright.cli.build_files import ROW_FORMATS, SUFFIXES, BuildOptions, build_files
from bladewright.cli.load_design import BODIES
from bladewright.cli.options import (
    Call,
    blades_option,
    check_options,
    comma_separated,
    common,
    extend_option,
    fine_option,
    parse_colour,
    parse_length,
    parse_name,
    passage_options,
    set_option,
)
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.cli.stations import stations_option

_BUILD_OPTIONS = (
    "directory",
    "formats",
    "schema",
    "iges_surfaces",
    "chordal_deviation",
    "unit",
    "colour",
    "force",
    "stations",
    "changes",
    "fine",
    "blades",
)
"""Options that are fields of `BuildOptions`; the remaining ones shape a passage."""


@click.command(short_help="Design to verified CAD files.")
@click.argument("designs", type=click.Path(path_type=Path), nargs=-1, required=True, metavar="DESIGN...")
@click.option(
    "-o", "--output", "directory", type=click.Path(path_type=Path), default=".", help="Directory to write into."
)
@click.option(
    "--as",
    "formats",
    callback=comma_separated(tuple(SUFFIXES)),
    help="Formats, with commas between: step, iges, brep, stl, 3mf.  [step,iges; step of a row]",
)
@click.option(
    "--body",
    "bodies",
    default="blade",
    show_default=True,
    callback=comma_separated(BODIES),
    help="What to make solid, with commas between: blade, passage, row, sector, wheel.",
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
    "--chordal-deviation", callback=parse_length, metavar="LENGTH", help="Largest gap of STL and 3MF, such as 0.01mm."
)
@click.option(
    "--unit", type=click.Choice(["mm", "m", "in"]), default="mm", show_default=True, help="Unit of length in the files."
)
@click.option(
    "--colour",
    callback=parse_colour,
    default="parts",
    show_default=True,
    metavar="COLOUR",
    help="Colour of the faces in STEP and IGES: parts for one of each part, '#8899aa' for all, or none.",
)
@click.option("--name", callback=parse_name, help="Name of the files, in the place of the design's own.")
@click.option("--force", is_flag=True, help="Overwrite files that were made from another design file.")
@click.option(
    "--jobs", type=click.IntRange(1, 256), metavar="N", help="Designs made at a time.  [as many as processors]"
)
@stations_option
@fine_option
@extend_option
@blades_option
@passage_options
@set_option
@common
@click.pass_obj
def build(
    call: Call,
    /,
    designs: tuple[Path, ...],
    bodies: tuple[str, ...],
    extend: float,
    name: str | None,
    jobs: int | None,
    **others: Any,
) -> Outcome:
    """Build DESIGN into verified CAD files: NAME.step, NAME.igs and so on, NAME being the design's name.

    With --body passage the files of the flow passage are NAME-passage.step and so on; likewise those of a row, one
    blade and its placements, of a sector, one pitch of a wheel, and of a wheel, all blades and what carries them as one
    solid. NAME.roundtrip.json beside them is what was measured on the reopened file of the first format; each further
    format has its own, such as NAME.igs.roundtrip.json. Where a check fails the files stay, say so, and the exit status
    is 1. Several designs are made side by side; one that is refused does not keep the others from being made.

    Files that are there are overwritten where they were made from the same design file, edited or with other changes,
    and that is said; others only with --force.
    """
    own = {option: others.pop(option) for option in _BUILD_OPTIONS}
    split = others["split"]
    check_options(bodies, extend, {**others, "split": False}, blades=own["blades"])
    formats = own["formats"] or ()
    if "row" in bodies and not set(formats) <= set(ROW_FORMATS):
        raise click.UsageError(
            f"--as {','.join(formats)}: a row is one blade and its placements, which {' and '.join(ROW_FORMATS)} files "
            "keep: ask for these, or for the row on its own"
        )
    if own["unit"] != "mm" and "brep" in formats:
        raise click.UsageError("--unit: a BREP file states no unit and is in millimetres: leave brep or --unit out")
    if name is not None:
        if len(designs) > 1:
            raise click.UsageError("--name names the files of one design: give one, or leave it out")
        own["changes"] = {**own["changes"], "name": name}
    options = BuildOptions(bodies=bodies, extend=extend, split=split, extents=others, **own)
    if len(designs) == 1:
        with progress(options.steps, call) as bar:
            return build_files(designs[0], options, bar)
    from bladewright.cli.batch import build_batch

    with progress(len(designs), call) as bar:
        return build_batch(designs, options, jobs, bar)
