"""`bladewright show`: what a design builds, as figures and as a picture."""

from pathlib import Path
from typing import Any

import click

from bladewright.cli.blueprint import built_from, design_at
from bladewright.cli.call import Call, common
from bladewright.cli.options import design_argument, set_option
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.cli.summary import data_of, text_of


@click.command(short_help="Figures and a picture of what a design builds.")
@design_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Picture to write: .png, .svg or .pdf.")
@set_option
@common
@click.pass_obj
def show(call: Call, design: Path, output: Path | None, changes: dict[str, Any]) -> Outcome:
    """Print the properties of what DESIGN builds and the promises it keeps; draw it where -o names a picture."""
    blueprint = design_at(design, changes)
    with progress(2 if output else 1, call) as bar:
        bar.set_description_str("blade")
        built = built_from(blueprint, design)
        bar.update(1)
        data = data_of(blueprint, built)
        if output is None:
            return Outcome(data=data, text=text_of(data))
        from bladewright import views

        bar.set_description_str("picture")
        views.picture(built, output)
        bar.update(1)
    return Outcome(data={**data, "picture": str(output)}, text=f"{text_of(data)}\nwrote {output}")
