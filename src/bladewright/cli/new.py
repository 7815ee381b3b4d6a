"""`bladewright new`: the built-in examples, to start from."""

from pathlib import Path

import click

from bladewright.cli.options import common
from bladewright.cli.outcome import Outcome
from bladewright.errors import FileError


@click.command(short_help="List the built-in examples, or write one.")
@click.argument("example", required=False)
@click.option("-o", "--output", type=click.Path(path_type=Path), help="File to write; EXAMPLE.toml where not given.")
@click.option("--force", is_flag=True, help="Overwrite a file that is there.")
@common
def new(example: str | None, output: Path | None, force: bool) -> Outcome:
    """List the built-in examples, or write the design file of one to start from."""
    from bladewright.files.examples import example_text, examples
    from bladewright.files.text import write_text

    if example is None:
        known = examples()
        width = max(map(len, known), default=0)
        text = "\n".join(f"{name:<{width}}  {line}".rstrip() for name, line in known.items())
        return Outcome(data={"examples": known}, text=text)
    text = example_text(example)
    file = output or Path(f"{example}.toml")
    if file.is_file() and not force:
        raise FileError(f"'{file}' exists already: name another file with -o, or overwrite it with --force")
    write_text(file, text)
    return Outcome(data={"example": example, "file": str(file)}, text=f"wrote {file}")
