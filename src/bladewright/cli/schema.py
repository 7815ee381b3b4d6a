"""`bladewright schema`: the JSON Schema of design files."""

import json
from pathlib import Path

import click

from bladewright.cli.options import common
from bladewright.cli.outcome import Outcome


@click.command(short_help="JSON Schema of design files.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="File to write, in the place of standard output.")
@common
def schema(output: Path | None) -> Outcome:
    """Print the JSON Schema of design files, with which editors complete and check them."""
    from bladewright.files.schema import schema as of_design_files
    from bladewright.files.text import write_text

    document = of_design_files()
    text = json.dumps(document, indent=2)
    if output is None:
        return Outcome(data=document, text=text)
    write_text(output, text + "\n")
    return Outcome(data={"file": str(output)}, text=f"wrote {output}")
