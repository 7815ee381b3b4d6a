"""`bladewright fit`: a cloud of points becomes a design, with the report of how well it matches."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli.directory import removing_partial_files
from bladewright.cli.fit_files import (
    check_design_file,
    picture_beside,
    read_points,
    read_start,
    report_beside,
    with_labels,
    write_deviations,
    write_report,
)
from bladewright.cli.options import Call, common, force_option, parse_length, parse_name
from bladewright.cli.outcome import Outcome
from bladewright.cli.overwriting import refuse_existing, refuse_same_file
from bladewright.cli.progress import status_line
from bladewright.designs import Design

if TYPE_CHECKING:
    from bladewright.files.clouds import Cloud
    from bladewright.fitting.assessment.result import Fit

UNITS = ("m", "cm", "mm", "um", "in", "ft")
"""Units of length that a cloud or a design may have."""


def _parse_columns(_: click.Context, __: click.Parameter, text: str | None) -> tuple[str, ...] | None:
    """Split words at commas; a word may occur more than once."""
    return None if text is None else tuple(word.strip() for word in text.split(","))


def _parse_bounds(_: click.Context, __: click.Parameter, pairs: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Read the lowest and the highest value by pattern; one that is left out is infinite."""
    bounds = {}
    for pair in pairs:
        path, sign, text = pair.rpartition("=")
        low, comma, high = text.partition(",")
        try:
            limits = float(low) if low.strip() else -math.inf, float(high) if high.strip() else math.inf
        except ValueError:
            limits = math.nan, math.nan
        if limits[0] > limits[1]:
            raise click.BadParameter(f"'{pair}' has its lowest value {low} above its highest {high}: exchange them")
        if not (sign and comma and path.strip()) or math.isnan(sum(map(abs, limits))):
            raise click.BadParameter(f"'{pair}' is not PATH=LOW,HIGH: write it like --bound 'stagger[*]=-60,-40'")
        bounds[path.strip()] = limits
    return bounds


def _parse_fixed(_: click.Context, __: click.Parameter, words: Sequence[str]) -> dict[str, float | None]:
    """Read values by path; None stands for the value of the start design."""
    values: dict[str, float | None] = {}
    for word in words:
        path, sign, text = word.partition("=")
        try:
            value = float(text) if sign else None
        except ValueError:
            value = math.nan
        if not path.strip() or (value is not None and not math.isfinite(value)):
            raise click.BadParameter(f"'{word}' is not PATH or PATH=VALUE: write it like --fix stagger[1]=-52")
        values[path.strip()] = value
    return values


def _parse_axis(_: click.Context, __: click.Parameter, text: str | None) -> str | tuple[float, ...] | None:
    """Read a name, or numbers with commas between."""
    if text is None or "," not in text:
        return text
    try:
        return tuple(float(word) for word in text.split(","))
    except ValueError as error:
        raise click.BadParameter(
            f"'{text}' is no axis: write a name like y or -z, or three numbers like 0,1,0"
        ) from error


@click.command(short_help="A cloud of points to a design.")
@click.argument("cloud", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Design file to write; NAME.toml where not given. That of --start may be the same, and keeps its comments.",
)
@click.option(
    "--start", type=click.Path(path_type=Path), metavar="DESIGN", help="Design, or ParaBlade's .cfg, to begin with."
)
@click.option(
    "--like",
    type=click.Path(path_type=Path),
    metavar="DESIGN",
    help="Design whose numbers of control points are taken.",
)
@click.option(
    "--family",
    default="unified",
    show_default=True,
    help="Family of the design, as in design files; that of --start or --like where none is named.",
)
@click.option("--unit", type=click.Choice(UNITS), help="Unit of the cloud's lengths; the file's own, or m.")
@click.option(
    "--columns",
    callback=_parse_columns,
    metavar="x,y,...",
    help="What the file's columns are, in their order: x y z r theta skip, with commas between.",
)
@click.option(
    "--samples", type=click.IntRange(100, 5_000_000), metavar="N", help="Points taken of a CAD file's faces.  [10000]"
)
@click.option(
    "--tolerance",
    callback=parse_length,
    metavar="LENGTH",
    help="Largest deviation wanted, such as 0.05mm: control points are added until it is reached.",
)
@click.option("--parameters", type=click.IntRange(min=1), metavar="N", help="Number of free parameters.")
@click.option(
    "--free", multiple=True, metavar="PATTERN", help="Only these are fitted, such as 'stagger[*]'. Repeatable."
)
@click.option(
    "--fix",
    "fixed",
    multiple=True,
    callback=_parse_fixed,
    metavar="PATH[=VALUE]",
    help="Hold a parameter at a value, or at that of --start. Repeatable.",
)
@click.option(
    "--bound",
    "bounds",
    multiple=True,
    callback=_parse_bounds,
    metavar="PATH=LOW,HIGH",
    help="Keep a parameter between two values, either of which may be left out. Repeatable.",
)
@click.option(
    "--axis",
    callback=_parse_axis,
    metavar="AXIS",
    help="Axis of rotation in the cloud's coordinates: y, -z, or three numbers such as 0,1,0.  [x]",
)
@click.option(
    "--align",
    is_flag=True,
    help="The cloud lies anywhere: move it onto --start, or lay a cascade's prismatic blade along its chord.",
)
@click.option("--arrangement", type=click.Choice(["annular", "linear"]), help="Around the axis, or in a cascade.")
@click.option("--blade-count", type=click.IntRange(1, 10_000), metavar="N", help="Number of blades of an annular row.")
@click.option(
    "--pitch", callback=parse_length, metavar="LENGTH", help="Distance of neighbours in a cascade, such as 57.5mm."
)
@click.option("--name", callback=parse_name, help="The design's name; that of --start, or of the cloud's file.")
@click.option("--length-unit", type=click.Choice(UNITS), help="The design's unit; that of --start, or mm.")
@click.option("--picture", type=click.Path(path_type=Path), help="Picture to write; NAME.fit.png where not given.")
@click.option("--no-picture", is_flag=True, help="Draw none.")
@click.option(
    "--deviations", type=click.Path(path_type=Path), metavar="FILE", help="Table of every point's deviation, as CSV."
)
@force_option
@common
@click.pass_obj
def fit(
    call: Call,
    /,
    cloud: Path,
    output: Path | None,
    columns: tuple[str, ...] | None,
    unit: str | None,
    samples: int | None,
    picture: Path | None,
    deviations: Path | None,
    *,
    no_picture: bool,
    force: bool,
    **fit_options: Any,
) -> Outcome:
    """Fit a design to the points of CLOUD, and say how far they lie from it: no first guess is needed.

    CLOUD is a table of numbers with or without names above them, an airfoil, a PLY, STL, VTK or NumPy file, or a STEP,
    IGES or BREP file, whose faces and edges are sampled. Two coordinates give a section, three a blade; x is the
    machine axis, or give --axis or --align. NAME.fit.json and NAME.fit.png are written beside the design. A design file
    that is there is only overwritten where it is that of --start, or with --force; it keeps its comments. The exit
    status is 1 where the fit does not pass; interrupted, it writes the best design so far.
    """
    if no_picture and picture is not None:
        raise click.UsageError("--picture names a picture, and --no-picture wants none: leave one out")
    name = fit_options["name"] or _name_from(cloud)
    if fit_options["start"] is None:
        fit_options["name"] = name
    design = output or Path(f"{name}.toml")
    report = report_beside(design)
    picture = None if no_picture else picture or picture_beside(design)
    check_design_file(design)
    start, like = fit_options["start"], fit_options["like"]
    onto_start = _same_file(design, start)
    if not (force or onto_start):
        refuse_existing(design)
        if deviations is not None:
            refuse_existing(deviations, "--deviations")
    if picture is not None:
        _check_picture(picture, beside=design)
    refuse_same_file(
        {"the cloud": cloud, "the design of --start": None if onto_start else start, "the design of --like": like},
        {"the design": design, "the report": report, "the picture": picture, "the table of --deviations": deviations},
    )
    with removing_partial_files(design.parent, [design.name, report.name]):
        result, points = _fit(call, cloud, columns, unit, samples, fit_options)
        data = _write(result, points, cloud, design, report)
    if deviations is not None:
        write_deviations(result, deviations)
        data["files"]["deviations"] = str(deviations)
    if picture is not None and not result.interrupted:
        from bladewright.views.fit_sheet import fit_picture

        fit_picture(result, picture)
        data["files"]["picture"] = str(picture)
    lines = [str(result), *(f"  note: {note}" for note in points.notes)]
    if result.interrupted:
        lines.append("interrupted: the best design so far is written")
    lines.append(f"wrote {', '.join(data['files'].values())}")
    failures = tuple(f"{cloud}: {text}" for text in result.failures)
    return Outcome(data=data, text="\n".join(lines), failures=failures, interrupted=result.interrupted)


def _fit(
    call: Call,
    path: Path,
    columns: tuple[str, ...] | None,
    unit: str | None,
    samples: int | None,
    fit_options: dict[str, Any],
) -> "tuple[Fit, Cloud]":
    """Fit the design; return the result and the cloud as it was read."""
    from bladewright.errors import FitError

    start, like = (None if fit_options[key] is None else read_start(fit_options[key]) for key in ("start", "like"))
    fit_options = fit_options | {"start": start, "like": like, "fixed": _fixed_parameters(fit_options["fixed"], start)}
    with status_line(call) as show:
        show("reading points")
        points = read_points(path, columns, unit, samples)
        from bladewright.fitting.fit import fit as fitted

        try:
            options: Mapping[str, Any] = fit_options | {
                "free": fit_options["free"] or None,
                "bounds": fit_options["bounds"] or None,
            }
            return fitted(points.points, progress=show, **options), points
        except KeyboardInterrupt as error:
            raise click.Abort("before a design was measured, so nothing is written") from error
        except FitError as error:
            # A wrong unit or wrong columns are often the reason.
            more = f"; {'; '.join(points.notes)}" if points.notes else ""
            raise FitError(f"'{path}': {error}{more}") from error


def _write(result: "Fit", points: "Cloud", cloud: Path, design: Path, report: Path) -> dict[str, Any]:
    """Write the design and the report; return the JSON object of the command."""
    from bladewright.files.writing import write_design

    read = {"file": str(cloud), "format": points.format, "unit": points.unit, "columns": points.columns}
    data = {**result.to_dict(), "cloud": {**read, "notes": points.notes}}
    write_design(with_labels(result.design, design), design)
    write_report(data, report)
    return {**data, "files": {"design": str(design), "report": str(report)}}


def _check_picture(picture: Path, beside: Path) -> None:
    """Raise FileError, before the work begins, where the picture cannot be written."""
    from bladewright.views.pages import checked_path

    # The design's own directory is created later where it does not exist yet.
    if picture.parent != beside.parent or picture.parent.is_dir():
        checked_path(picture)


def _same_file(design: Path, start: Path | None) -> bool:
    return start is not None and design.is_file() and start.is_file() and design.samefile(start)


def _name_from(cloud: Path) -> str:
    return re.sub(r'[/\\:*?"<>|\s]+', "-", cloud.stem).strip("-.") or "blade"


def _fixed_parameters(
    given: Mapping[str, float | None], start: Design | None
) -> Sequence[str] | Mapping[str, float] | None:
    """The argument `fixed` of `bladewright.fit`: patterns held at the start's values, or values by path."""
    if not given:
        return None
    bare = [path for path, value in given.items() if value is None]
    if bare and start is None:
        raise click.UsageError(f"--fix {bare[0]} holds a start's value: give the value, or a design with --start")
    if len(bare) == len(given) or start is None:
        return bare or {path: value for path, value in given.items() if value is not None}
    from bladewright.derivatives.patterns import chosen

    values: dict[str, Any] = start.parameters()
    fixed = {path: float(values[path]) for path in chosen(start, bare)} if bare else {}
    return fixed | {path: value for path, value in given.items() if value is not None}
