"""`bladewright build`: a design becomes CAD files that are reopened and measured."""

from pathlib import Path
from typing import Any

import click

from bladewright.cli.build_files import SUFFIXES, BuildOptions, build_files
from bladewright.cli.load_design import BODIES
from bladewright.cli.options import (
    Call,
    check_options,
    comma_separated,
    common,
    extend_option,
    parse_length,
    passage_options,
    set_option,
)
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.cli.stations import stations_option

_BUILD_OPTIONS = ("directory", "formats", "schema", "iges_surfaces", "chordal_deviation", "stations", "changes")
"""Options that are fields of `BuildOptions`; the remaining ones shape a passage."""


@click.command(short_help="Design to verified CAD files.")
@click.argument("designs", type=click.Path(path_type=Path), nargs=-1, required=True, metavar="DESIGN...")
@click.option(
    "-o", "--output", "directory", type=click.Path(path_type=Path), default=".", help="Directory to write into."
)
@click.option(
    "--as",
    "formats",
    default="step,iges",
    show_default=True,
    callback=comma_separated(tuple(SUFFIXES)),
    help="Formats, with commas between: step, iges, brep, stl, 3mf.",
)
@click.option(
    "--body",
    "bodies",
    default="blade",
    show_default=True,
    callback=comma_separated(BODIES),
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
    "--chordal-deviation", callback=parse_length, metavar="LENGTH", help="Largest gap of STL and 3MF, such as 0.01mm."
)
@click.option(
    "--jobs", type=click.IntRange(1, 256), metavar="N", help="Designs made at a time.  [as many as processors]"
)
@stations_option
@extend_option
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
    jobs: int | None,
    **others: Any,
) -> Outcome:
    """Build DESIGN into verified CAD files: NAME.step, NAME.igs and so on, NAME being the design's name.

    With --body passage the files of the flow passage are NAME-passage.step and so on. NAME.roundtrip.json beside them
    is what was measured on the reopened file of the first format; each further format has its own, such as
    NAME.igs.roundtrip.json. Where a check fails the files stay, say so, and the exit status is 1. Several designs are
    made side by side; one that is refused does not keep the others from being made.
    """
    own = {name: others.pop(name) for name in _BUILD_OPTIONS}
    split = others["split"]
    check_options(bodies, extend, {**others, "split": False})
    options = BuildOptions(bodies=bodies, extend=extend, split=split, extents=others, **own)
    if len(designs) == 1:
        with progress(options.steps, call) as bar:
            return build_files(designs[0], options, bar)
    from bladewright.cli.batch import build_batch

    with progress(len(designs), call) as bar:
        return build_batch(designs, options, jobs, bar)
