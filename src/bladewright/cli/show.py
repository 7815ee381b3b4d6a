"""`bladewright show`: what a design builds, as figures and as a picture."""

import tempfile
from pathlib import Path
from typing import Any

import click

from bladewright.cli.blueprint import built_from, design_at
from bladewright.cli.call import Call, common
from bladewright.cli.options import design_argument, set_option
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.cli.summary import broken_promises, data_of, text_of

PICTURES = (".png", ".svg", ".pdf")


def _picture(_: click.Context, __: click.Parameter, path: Path | None) -> Path | None:
    if path is not None and path.suffix.lower() not in PICTURES:
        raise click.BadParameter(f"'{path}' is no picture that can be drawn: end its name in {', '.join(PICTURES)}")
    return path


@click.command(short_help="Figures and a picture of what a design builds.")
@design_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), callback=_picture, help="Picture to write.")
@set_option
@common
@click.pass_obj
def show(call: Call, design: Path, output: Path | None, changes: dict[str, Any]) -> Outcome:
    """Print the properties of what DESIGN builds and the promises it keeps; draw it where -o names a picture.

    The picture shows sections, curvature, the meridional channel, the laws of evolution and a 3D view. The exit status
    is 1 where a promise is not kept.
    """
    blueprint = design_at(design, changes)
    with progress(2 if output else 1, call) as bar:
        bar.set_description_str("blade")
        built = built_from(blueprint, design)
        data = data_of(blueprint, built)
        bar.update(1)
        if output is not None:
            bar.set_description_str("picture")
            _draw(built, output)
            data["picture"] = str(output)
            bar.update(1)
    return Outcome(data=data, text=text_of(data), failures=broken_promises(data))


def _draw(built: Any, output: Path) -> None:
    from bladewright import views
    from bladewright.files.text import write_bytes

    with tempfile.TemporaryDirectory() as draft:
        path = Path(draft) / output.name
        views.picture(built, path)
        write_bytes(output, path.read_bytes())
