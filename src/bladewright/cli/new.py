"""`bladewright new`: a design file to start from, of an example, of a template or of a table of stations."""

from pathlib import Path
from typing import Any

import click

from bladewright.cli.options import common, force_option, set_option
from bladewright.cli.outcome import Outcome
from bladewright.cli.overwriting import refuse_existing
from bladewright.errors import FileError


@click.command(short_help="List the built-in examples, or write one.")
@click.argument("example", required=False)
@click.option("-o", "--output", type=click.Path(path_type=Path), help="File to write; EXAMPLE.toml where not given.")
@click.option("--template", metavar="NAME", help="Write a starting file with every key of its family, explained.")
@click.option(
    "--from-table",
    "table",
    type=click.Path(path_type=Path),
    metavar="CSV",
    help="Write the design of a table of stations: r [mm], metal_angle_in [deg], metal_angle_out [deg], chord [mm]...",
)
@set_option
@force_option
@common
def new(
    example: str | None,
    output: Path | None,
    template: str | None,
    table: Path | None,
    changes: dict[str, Any],
    force: bool,
) -> Outcome:
    """List the built-in examples and templates, or write the design file of one to start from.

    With --from-table the file is made from a table of stations, hub to shroud, whose values are met there. What the
    table does not say is assumed, stated in a comment, and changed with --set.
    """
    from bladewright.files.examples import example_text, examples
    from bladewright.files.templates import template_text, templates
    from bladewright.files.text import write_text

    given = {"the example": example, "--template": template, "--from-table": table}
    asked = [f"{what} {name}" for what, name in given.items() if name is not None]
    if len(asked) > 1:
        raise FileError(f"{' and '.join(asked)} are asked for together: give one of them")
    if changes and table is None:
        raise click.UsageError("--set completes a table: give --from-table, or change the file once it is written")
    if not asked:
        lists = {"examples": examples(), "templates": templates()}
        text = f"{_listed('bladewright new NAME', lists['examples'])}\n\n"
        text += _listed("bladewright new --template NAME, every key of its family explained", lists["templates"])
        return Outcome(data=lists, text=text)
    if example in templates() and example not in examples():
        raise FileError(f"'{example}' is a template: write it by bladewright new --template {example}")
    if template in examples() and template not in templates():
        raise FileError(f"'{template}' is an example: write it by bladewright new {template}")
    remarks: dict[str, str] = {}
    if table is not None:
        from bladewright.files.from_table import design_from_table

        made = design_from_table(table, changes)
        name, text, remarks = made.design.name, made.text, dict(made.remarks)
        data: dict[str, Any] = {"table": str(table), "remarks": remarks}
    else:
        name = str(example or template)
        text = example_text(name) if example is not None else template_text(name)
        data = {"example" if example else "template": name}
    file = output or Path(f"{name}.toml")
    if not force:
        refuse_existing(file)
    write_text(file, text)
    said = [f"wrote {file}", *(f"  {key}: {words}" for key, words in remarks.items())]
    return Outcome(data={**data, "file": str(file)}, text="\n".join(said))


def _listed(title: str, lines: dict[str, str]) -> str:
    width = max(map(len, lines), default=0)
    return "\n".join([f"{title}:", *(f"  {name:<{width}}  {line}".rstrip() for name, line in lines.items())])
