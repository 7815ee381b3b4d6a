"""`bladewright new`: the built-in examples, to start from."""

from pathlib import Path

import click

from bladewright.cli.options import common
from bladewright.cli.outcome import Outcome
from bladewright.errors import FileError


@click.command(short_help="List the built-in examples, or write one.")
@click.argument("example", required=False)
@click.option("-o", "--output", type=click.Path(path_type=Path), help="File to write; EXAMPLE.toml where not given.")
@click.option("--template", metavar="NAME", help="Write a starting file with every key of its family, explained.")
@click.option("--force", is_flag=True, help="Overwrite a file that is there.")
@common
def new(example: str | None, output: Path | None, template: str | None, force: bool) -> Outcome:
    """List the built-in examples and templates, or write the design file of one to start from."""
    from bladewright.files.examples import example_text, examples
    from bladewright.files.templates import template_text, templates
    from bladewright.files.text import write_text

    if example is not None and template is not None:
        raise FileError(f"both the example '{example}' and --template {template} are asked for: give one of them")
    if example is None and template is None:
        lists = {"examples": examples(), "templates": templates()}
        text = f"{_listed('bladewright new NAME', lists['examples'])}\n\n"
        text += _listed("bladewright new --template NAME, every key of its family explained", lists["templates"])
        return Outcome(data=lists, text=text)
    text = example_text(example) if example is not None else template_text(str(template))
    file = output or Path(f"{example or template}.toml")
    if file.is_file() and not force:
        raise FileError(f"'{file}' exists already: name another file with -o, or overwrite it with --force")
    write_text(file, text)
    return Outcome(
        data={"example" if example else "template": example or template, "file": str(file)}, text=f"wrote {file}"
    )


def _listed(title: str, lines: dict[str, str]) -> str:
    width = max(map(len, lines), default=0)
    return "\n".join([f"{title}:", *(f"  {name:<{width}}  {line}".rstrip() for name, line in lines.items())])
