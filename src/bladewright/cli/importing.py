"""`bladewright import`: another program's design becomes a design file, and its distance from the original is said."""

from pathlib import Path

import click

from bladewright.cli.blueprint import built_from
from bladewright.cli.call import Call, common
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress

KNOWN = "ParaBlade's .cfg"


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
@common
@click.pass_obj
def importing(call: Call, /, file: Path, output: Path | None, chordwise: int | None) -> Outcome:
    """Write the design of the unified family that comes nearest to the blade of FILE, another program's design.

    Known is ParaBlade's .cfg with camber and thickness. What was kept and what was changed is said, and how far the
    built surfaces lie from points of the other program's blade. A file that is there keeps its comments.
    """
    from bladewright.cli.starting import parablade_text
    from bladewright.errors import FileError
    from bladewright.files.parablade import import_parablade

    if parablade_text(file) is None:
        raise FileError(f"'{file}' is of no format that can be imported: known is {KNOWN}")
    with progress(3, call) as bar:
        bar.set_description_str("sections")
        found = import_parablade(file, chordwise=chordwise)
        bar.update(1)
        bar.set_description_str("surfaces")
        built = built_from(found.design, file)
        bar.update(1)
        bar.set_description_str("distances")
        distances = found.distances(built)
        from bladewright.files.writing import write_design

        design = output or Path(f"{found.design.name}.toml")
        write_design(found.design, design)
        bar.update(1)
    chord = float(built.chord)
    mean, most = float(distances.mean()), float(distances.max())
    data = {
        "file": str(file),
        "program": found.program,
        "design": str(design),
        "name": found.design.name,
        "parameters": len(found.design.parameters()),
        "kept": found.kept,
        "changed": found.changed,
        "deviation": {"points": len(distances), "mean_m": mean, "maximum_m": most, "chord_m": chord},
    }
    lines = [f"{found.design.name}: {found.program}, {data['parameters']} parameters"]
    lines += [f"  kept: {text}" for text in found.kept]
    lines += [f"  changed: {text}" for text in found.changed]
    lines.append(
        f"  the built sides lie {mean * 1e3:.3g} mm in the mean and {most * 1e3:.3g} mm at most from {found.program}'s "
        f"({mean / chord:.2g} and {most / chord:.2g} of the chord)"
    )
    return Outcome(data=data, text="\n".join([*lines, f"wrote {design}"]))
