"""`bladewright fit`: a cloud of points becomes a design, with the report of how well it matches."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli import fit_options
from bladewright.cli.directory import removing_partial_files
from bladewright.cli.options import Call, common, parse_length
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import status_line

if TYPE_CHECKING:
    from bladewright.files.clouds import Cloud
    from bladewright.fitting.assessment.result import Fit

UNITS = ("m", "cm", "mm", "um", "in", "ft")


@click.command(short_help="A cloud of points to a design.")
@click.argument("cloud", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Design file to write; NAME.toml where not given. One that is there keeps its comments.",
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
    callback=fit_options.columns,
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
    callback=fit_options.fixes,
    metavar="PATH[=VALUE]",
    help="Hold a parameter at a value, or at that of --start. Repeatable.",
)
@click.option(
    "--bound",
    "bounds",
    multiple=True,
    callback=fit_options.bounds,
    metavar="PATH=LOW,HIGH",
    help="Keep a parameter between two values, either of which may be left out. Repeatable.",
)
@click.option("--align", is_flag=True, help="Find the rigid motion to the machine's axes, too.")
@click.option("--arrangement", type=click.Choice(["annular", "linear"]), help="Around the axis, or in a cascade.")
@click.option("--blade-count", type=click.IntRange(1, 10_000), metavar="N", help="Number of blades of an annular row.")
@click.option(
    "--pitch", callback=parse_length, metavar="LENGTH", help="Distance of neighbours in a cascade, such as 57.5mm."
)
@click.option("--name", callback=fit_options.name, help="The design's name; that of the cloud's file where not given.")
@click.option("--length-unit", type=click.Choice(UNITS), default="mm", show_default=True, help="The design's unit.")
@click.option("--picture", type=click.Path(path_type=Path), help="Picture to write; NAME.fit.png where not given.")
@click.option("--no-picture", is_flag=True, help="Draw none.")
@click.option(
    "--deviations", type=click.Path(path_type=Path), metavar="FILE", help="Table of every point's deviation, as CSV."
)
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
    **how: Any,
) -> Outcome:
    """Fit a design to the points of CLOUD, and say how far they lie from it: no first guess is needed.

    CLOUD is a table of numbers with or without names above them, an airfoil, a PLY, STL, VTK or NumPy file, or a STEP,
    IGES or BREP file, whose faces are sampled. Two coordinates give a section, three a blade; x is the machine axis, or
    give --align. NAME.fit.json and NAME.fit.png are written beside the design. The exit status is 1 where the fit does
    not pass; interrupted, it writes the best design so far.
    """
    from bladewright.cli.fit_files import check_design_file, picture_beside, report_beside

    if no_picture and picture is not None:
        raise click.UsageError("--picture names a picture, and --no-picture wants none: leave one out")
    name = how.pop("name") or _name_from(cloud)
    design = output or Path(f"{name}.toml")
    report = report_beside(design)
    picture = None if no_picture else picture or picture_beside(design)
    check_design_file(design)
    if picture is not None:
        _check_picture(picture, beside=design)
    with removing_partial_files(design.parent, [design.name, report.name]):
        found, points = _fitted(call, cloud, columns, unit, samples, name, how)
        data = _written(found, points, cloud, design, report)
    if deviations is not None:
        from bladewright.cli.fit_files import write_deviations

        write_deviations(found, deviations)
        data["files"]["deviations"] = str(deviations)
    if picture is not None and not found.interrupted:
        from bladewright.views.fit_sheet import fit_picture

        fit_picture(found, picture)
        data["files"]["picture"] = str(picture)
    lines = [str(found), *(f"  note: {note}" for note in points.notes)]
    if found.interrupted:
        lines.append("interrupted: the best design so far is written")
    lines.append(f"wrote {', '.join(data['files'].values())}")
    failures = tuple(f"{cloud}: {text}" for text in found.failures)
    return Outcome(data=data, text="\n".join(lines), failures=failures, interrupted=found.interrupted)


def _fitted(
    call: Call,
    path: Path,
    columns: tuple[str, ...] | None,
    unit: str | None,
    samples: int | None,
    name: str,
    how: dict[str, Any],
) -> "tuple[Fit, Cloud]":
    """The fit, and the cloud as it was read."""
    from bladewright.cli.fit_files import cloud_at, start_at
    from bladewright.errors import FitError

    start, like = (None if how[key] is None else start_at(how[key]) for key in ("start", "like"))
    how = {**how, "start": start, "like": like, "fixed": fit_options.fixed_of(how["fixed"], start)}
    with status_line(call) as say:
        say("reading points")
        points = cloud_at(path, columns, unit, samples)
        from bladewright.fitting.fit import fit as fitted

        try:
            options: Mapping[str, Any] = how | {"free": how["free"] or None, "bounds": how["bounds"] or None}
            return fitted(points.points, name=name, progress=say, **options), points
        except KeyboardInterrupt as error:
            raise click.Abort("before a design was measured, so nothing is written") from error
        except FitError as error:
            # a wrong unit or wrong columns may well be the reason
            more = f"; {'; '.join(points.notes)}" if points.notes else ""
            raise FitError(f"'{path}': {error}{more}") from error


def _written(found: "Fit", points: "Cloud", cloud: Path, design: Path, report: Path) -> dict[str, Any]:
    """What was found, for programs, when the design and the report are written."""
    from bladewright.cli.fit_files import labelled, write_report
    from bladewright.files.writing import write_design

    read = {"file": str(cloud), "format": points.format, "unit": points.unit, "columns": points.columns}
    data = {**found.to_dict(), "cloud": {**read, "notes": points.notes}}
    write_design(labelled(found.design, design), design)
    write_report(data, report)
    return {**data, "files": {"design": str(design), "report": str(report)}}


def _check_picture(picture: Path, beside: Path) -> None:
    from bladewright.views.pages import checked_path

    # the design's own directory is made where it is not there
    if picture.parent != beside.parent or picture.parent.is_dir():
        checked_path(picture)


def _name_from(cloud: Path) -> str:
    return re.sub(r'[/\\:*?"<>|\s]+', "-", cloud.stem).strip("-.") or "blade"
