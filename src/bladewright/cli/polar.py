"""`bladewright polar`: lift, drag and moment of a design's section as a lone airfoil."""

import re
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli.directory import removing_partial_files
from bladewright.cli.load_design import built_from, load_design
from bladewright.cli.options import Call, common, design_argument, parse_length, set_option
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.errors import FileError

if TYPE_CHECKING:
    from bladewright.aerodynamics.polar import Polar

NUMBER = r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?"
"""A number as people type it."""
MOST = 1000
"""Angles of a range; a longer one is a mistyped step."""


def parse_angles(_: click.Context, __: click.Parameter, text: str) -> tuple[float, ...]:
    """Angles such as 4, or -5,0,5, or -5:15:0.5 with the last included."""
    if re.fullmatch(rf"{NUMBER}(,{NUMBER})*", text):
        return tuple(float(word) for word in text.split(","))
    if not re.fullmatch(rf"{NUMBER}:{NUMBER}:{NUMBER}", text):
        raise click.BadParameter(f"'{text}' are no angles: write them like 4, or -5,0,5, or -5:15:0.5")
    first, last, step = (float(word) for word in text.split(":"))
    count = int((last - first) / step + 1.0 + 1e-9) if step else 0
    if not 0 < count <= MOST:
        raise click.BadParameter(
            f"'{text}' counts {count} angles: from {first:g} in steps of {step:g} to {last:g}; write FIRST:LAST:STEP "
            f"with at most {MOST}"
        )
    return tuple(round(first + step * number, 9) for number in range(count))


def parse_pair(_: click.Context, __: click.Parameter, text: str) -> tuple[float, float]:
    """Two numbers such as 0.3,0.7."""
    if not re.fullmatch(rf"{NUMBER},{NUMBER}", text):
        raise click.BadParameter(f"'{text}' are no two numbers: write them like 0.3,0.7")
    first, second = text.split(",")
    return float(first), float(second)


@click.command(short_help="Lift, drag and moment of a section as a lone airfoil.")
@design_argument
@click.option("--reynolds", type=float, required=True, metavar="RE", help="Reynolds number by the chord.")
@click.option("--mach", type=float, default=0.0, show_default=True, help="Mach number.")
@click.option(
    "--alpha",
    callback=parse_angles,
    default="-5:15:0.5",
    show_default=True,
    metavar="ANGLES",
    help="Angles of attack from the chord line in degrees: 4, or -5,0,5, or FIRST:LAST:STEP.",
)
@click.option(
    "--with",
    "solver",
    type=click.Choice(["xfoil", "neuralfoil"]),
    default="xfoil",
    show_default=True,
    help="XFOIL, or the neural network that was trained on it.",
)
@click.option("--n-crit", type=float, default=9.0, show_default=True, help="Exponent of the e^n transition method.")
@click.option(
    "--transition",
    callback=parse_pair,
    default="1,1",
    show_default=True,
    metavar="X,X",
    help="x/c at which transition is forced on the upper and the lower side; 1: nowhere.",
)
@click.option(
    "--reference-length",
    callback=parse_length,
    metavar="LENGTH",
    help="Length such as 1m by which Reynolds number and coefficients are made, in place of the chord.",
)
@click.option(
    "--moment-point", type=float, default=0.25, show_default=True, help="x/c about which the moment is taken."
)
@click.option("--span", type=click.FloatRange(0.0, 1.0), default=0.5, show_default=True, help="Section of a blade.")
@click.option("--panels", type=int, default=160, show_default=True, help="XFOIL's panels.")
@click.option("--time-limit", type=float, default=60.0, show_default=True, help="Seconds after which XFOIL is stopped.")
@click.option("--segments", is_flag=True, help="Add lift and drag of each of the six segments, at every angle.")
@click.option(
    "-o",
    "--output",
    "outputs",
    type=click.Path(path_type=Path),
    multiple=True,
    help="File to write, by its ending: .csv, or .png, .svg, .pdf for a picture. Repeatable.",
)
@set_option
@common
@click.pass_obj
def polar(
    call: Call,
    /,
    path: Path,
    solver: Any,
    span: float,
    segments: bool,
    outputs: Sequence[Path],
    changes: dict[str, Any],
    **conditions: Any,
) -> Outcome:
    """Print the polar of a section of DESIGN: cl, cd, cdp, cm and transition over the angle of attack.

    The section of a 2D design, or a blade's at a span fraction, is taken as a lone airfoil with its chord line level;
    that of a cascade is said to be one. An angle that does not converge is named, and the exit status is then 1. XFOIL
    is needed (apt-get install xfoil, or its path in BLADEWRIGHT_XFOIL), or pip install 'bladewright[polar]'.
    """
    import bladewright as bw

    design: Any = load_design(path, changes)
    with ExitStack() as stack:
        for output in outputs:
            _check(output)
            stack.enter_context(removing_partial_files(output.parent, [output.name]))
        bar = stack.enter_context(progress(1, call))
        bar.set_description_str(solver)
        [section] = built_from(design, path).sections_at([span])
        found = bw.polar(section, conditions.pop("reynolds"), conditions.pop("alpha"), solver=solver, **conditions)
        parts = _parts(found) if segments else {}
        for output in outputs:
            _write(found, output)
        bar.update(1)
    data = {**found.to_dict(), "name": design.name, "passed": not found.failures}
    text = str(found)
    if segments:
        data["segments"] = [{"alpha": angle, **part.to_dict()} for angle, part in parts.items()]
        text += "".join(f"\n\nsegments at {angle:g} deg\n{part}" for angle, part in parts.items())
    text += "".join(f"\nwrote {output}" for output in outputs)
    return Outcome(data={**data, "files": [str(each) for each in outputs]}, text=text, failures=found.failures)


def _parts(found: "Polar") -> dict[float, Any]:
    """The segments at each angle that converged."""
    return {float(angle): found.segments(angle) for angle in found.alpha[found.converged]}


def _check(output: Path) -> None:
    """Raise FileError, before any work, where a file cannot be written."""
    from bladewright.views.pages import SUFFIXES

    if output.suffix.lower() not in {".csv", *SUFFIXES}:
        raise FileError(f"'{output}' is neither a table nor a picture: end its name in .csv, {', '.join(SUFFIXES)}")


def _write(found: "Polar", output: Path) -> None:
    """Write a polar as a table or a picture, by the file's ending."""
    from bladewright.views.polar import draw_polar

    if output.suffix.lower() == ".csv":
        found.to_csv(output)
    else:
        draw_polar(found, output)
