"""`bladewright import`: another program's design becomes a design file; its distance from the original is reported."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli.directory import removing_partial_files
from bladewright.cli.load_design import built_from
from bladewright.cli.options import Call, common, force_option
from bladewright.cli.outcome import Outcome
from bladewright.cli.overwriting import refuse_existing
from bladewright.cli.progress import progress

if TYPE_CHECKING:
    from bladewright.files.imported import Imported


KNOWN = "ParaBlade's .cfg and T-Blade3's 3dbgbinput.*.dat"
"""The formats that can be imported, as messages name them."""


@click.command("import", short_help="Another program's design to a design file.")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), help="Design file to write; NAME.toml where not given."
)
@click.option(
    "--chordwise",
    type=click.IntRange(2, 40),
    metavar="N",
    help="Control points of a thickness law along the chord.  [8, or up to 16 where that brings the sides nearer]",
)
@click.option(
    "--edge-spline",
    is_flag=True,
    help="The family's own splines in the place of T-Blade3's leading edges that are splines, which are refused else.",
)
@click.option(
    "--true-stagger",
    is_flag=True,
    help="True sweep and lean by the stagger of each section, where T-Blade3 takes a wrong one.",
)
@force_option
@common
@click.pass_obj
def import_design(
    call: Call,
    /,
    file: Path,
    output: Path | None,
    chordwise: int | None,
    edge_spline: bool,
    true_stagger: bool,
    force: bool,
) -> Outcome:
    """Write the design of the blade in FILE, another program's design.

    Known are ParaBlade's .cfg with camber and thickness, which becomes the nearest design of the unified family, and
    T-Blade3's 3dbgbinput.*.dat with the file of control points beside it, whose sections are kept. What was kept and
    what was changed is said, and how far the built surfaces lie from points of the other program's blade. A design
    file that is there is only overwritten with --force, and keeps its comments.
    """
    with progress(3, call) as bar:
        bar.set_description_str("sections")
        imported = _read(file, chordwise, edge_spline=edge_spline, true_stagger=true_stagger)
        design = output or Path(f"{imported.design.name}.toml")
        if not force:
            refuse_existing(design)
        bar.update(1)
        bar.set_description_str("surfaces")
        built = built_from(imported.design, file)
        bar.update(1)
        bar.set_description_str("distances")
        distances = imported.distances(built)
        from bladewright.files.writing import write_design

        with removing_partial_files(design.parent, [design.name]):
            write_design(imported.design, design)
        bar.update(1)
    from bladewright.section.checks import UNITS

    chord = float(built.chord)
    mean, most = float(distances.mean()), float(distances.max())
    unit = imported.design.length_unit
    metre = UNITS[unit]
    data = {
        "file": str(file),
        "program": imported.program,
        "design": str(design),
        "name": imported.design.name,
        "parameters": len(imported.design.parameters()),
        "kept": imported.kept,
        "changed": imported.changed,
        "notes": imported.notes,
        "deviation": {
            "points": len(distances),
            "mean_m": mean,
            "maximum_m": most,
            "chord_m": chord,
            "source": imported.source,
        },
    }
    lines = [f"{imported.design.name}: {imported.program}, {data['parameters']} parameters"]
    lines += [f"  kept: {text}" for text in imported.kept]
    lines += [f"  changed: {text}" for text in imported.changed]
    lines += [f"  note: {text}" for text in imported.notes]
    lines.append(
        f"  the built sides lie {mean / metre:.3g} {unit} in the mean and {most / metre:.3g} {unit} at most from "
        f"{imported.program}'s ({mean / chord:.2g} and {most / chord:.2g} of the chord), by {imported.source}"
    )
    return Outcome(data=data, text="\n".join([*lines, f"wrote {design}"]))


def _read(file: Path, chordwise: int | None, *, edge_spline: bool, true_stagger: bool) -> "Imported[Any]":
    """Read the design in a file whose format its contents tell."""
    from bladewright.errors import FileError
    from bladewright.files.parablade import import_parablade, is_parablade
    from bladewright.files.tblade3 import import_tblade3, is_tblade3
    from bladewright.files.tblade3.reading import COMPANIONS, MAIN
    from bladewright.files.text import read_text

    text = read_text(file)
    if is_parablade(text):
        return import_parablade(file, chordwise=chordwise)
    if is_tblade3(text) or file.name.lower().startswith(tuple(f"{each}." for each in (MAIN, *COMPANIONS))):
        if chordwise is not None:
            raise click.UsageError("--chordwise is for ParaBlade's thickness laws: T-Blade3's sections are kept")
        return import_tblade3(file, edge_spline=edge_spline, true_stagger=true_stagger)
    raise FileError(f"'{file}' is of no format that can be imported: known are {KNOWN}")
