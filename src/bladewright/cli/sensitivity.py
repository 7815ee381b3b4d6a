"""`bladewright sensitivity`: derivatives of what a design builds, their check, and the chain to a flow solver."""

from pathlib import Path
from typing import Any

import click

from bladewright.cli.load_design import built_from, load_design
from bladewright.cli.options import Call, common, design_argument, set_option
from bladewright.cli.outcome import Outcome


def _grid(_: click.Context, __: click.Parameter, text: str) -> tuple[int, int]:
    along, _sign, across = text.lower().partition("x")
    if not (along.strip().isdigit() and across.strip().isdigit()):
        raise click.BadParameter(f"'{text}' is no number of points along and across: write it like 81x21")
    return int(along), int(across)


@click.command(short_help="Derivatives by every parameter, and their check.")
@design_argument
@click.option(
    "--of",
    "of",
    metavar="QUANTITY",
    help="volume, area, centroid, inertia, chord, throat, passage-volume, or surface: the control points of the sides; "
    "of a section: area, centroid, chord, perimeter, camber-length, surface.  [volume; area of a section; surface with "
    "--check]",
)
@click.option(
    "--free", multiple=True, metavar="PATTERN", help="Only these parameters, such as 'stagger[*]'. Repeatable."
)
@click.option("--check", is_flag=True, help="Compare with central differences over a sweep of steps.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Picture of the check: .png, .svg or .pdf.")
@click.option(
    "--write-points", type=click.Path(path_type=Path), metavar="FILE", help="Points of both sides for SU2_DEF."
)
@click.option("--points", default="81x21", show_default=True, callback=_grid, help="How many, along and across a side.")
@click.option(
    "--from",
    "sensitivity_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="SU2's surface_sens.csv or .vtu: derivatives of its objective, with --points-file.",
)
@click.option("--points-file", type=click.Path(path_type=Path), metavar="FILE", help="What --write-points wrote.")
@set_option
@common
@click.pass_obj
def sensitivity(
    call: Call,
    design: Path,
    of: str | None,
    free: tuple[str, ...],
    check: bool,
    output: Path | None,
    write_points: Path | None,
    points: tuple[int, int],
    sensitivity_file: Path | None,
    points_file: Path | None,
    changes: dict[str, Any],
) -> Outcome:
    """Print the derivatives of a quantity of what DESIGN builds by its parameters, exact to rounding.

    --check compares each with central differences at held knots; the exit status is 1 where one differs, is not finite,
    or a parameter has no effect on the surface. --write-points and --from chain a design to the flow solver SU2: its
    adjoint's sensitivity at the points becomes the gradient of its objective by the parameters.
    """
    from bladewright.cli.derivatives import checked, derivatives_of, pulled_back, written_points

    _one_task(check=check, output=output, write_points=write_points, of=of, given=(sensitivity_file, points_file))
    blueprint = load_design(design, changes)
    built = built_from(blueprint, design)
    if write_points is not None:
        return written_points(built, write_points, points)
    if sensitivity_file is not None and points_file is not None:
        return pulled_back(blueprint, built, free, sensitivity_file, points_file)
    if check:
        return checked(call, blueprint, built, of or "surface", free, output)
    return derivatives_of(call, blueprint, built, of, free)


def _one_task(
    *,
    check: bool,
    output: Path | None,
    write_points: Path | None,
    of: str | None,
    given: tuple[Path | None, Path | None],
) -> None:
    """Raise a usage error where options do not go together."""
    if output is not None and not check:
        raise click.UsageError("-o draws the check: ask for it with --check")
    if (given[0] is None) != (given[1] is None):
        raise click.UsageError("--from and --points-file belong together: a sensitivity, and the points that it is of")
    tasks = {"--check": check, "--write-points": write_points is not None, "--from": given[0] is not None}
    asked = [name for name, wanted in tasks.items() if wanted]
    if len(asked) > 1:
        raise click.UsageError(f"{' and '.join(asked)} are different tasks: call the program once for each")
    if of is not None and asked and asked != ["--check"]:
        raise click.UsageError(f"--of chooses a quantity, which {asked[0]} does not take")
