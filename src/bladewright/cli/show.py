"""`bladewright show`: what a design builds, as figures and as a picture."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import click

from bladewright.cli.directory import removing_partial_files
from bladewright.cli.load_design import BODIES, bodies_from, built_from, flow_domain_from, load_design
from bladewright.cli.made_from import CAD_SUFFIXES, made_from
from bladewright.cli.masses import mass_data, mass_rows
from bladewright.cli.options import (
    Call,
    blades_option,
    check_options,
    common,
    design_argument,
    passage_options,
    set_option,
)
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.cli.report_page import write_report
from bladewright.cli.stations import sense_data, sense_rows, station_table, stations_option, written_csv
from bladewright.cli.summary import (
    broken_promises,
    part_data,
    passage_data,
    passage_rows,
    smoothness_data,
    smoothness_rows,
    summary_data,
    summary_text,
)


@click.command(short_help="Figures and a picture of what a design builds.")
@design_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Picture to write: .png, .svg or .pdf.")
@click.option("--report", type=click.Path(path_type=Path), help="Page to write with all of it, to send: .html.")
@click.option("--round-trip", is_flag=True, help="Measure a STEP file for the report, in place of NAME.roundtrip.json.")
@click.option("--body", type=click.Choice(BODIES), default="blade", show_default=True, help="What to show.")
@blades_option
@stations_option
@click.option("--csv", "table_file", type=click.Path(path_type=Path), metavar="FILE", help="Write that table as CSV.")
@passage_options
@set_option
@common
@click.pass_obj
def show(
    call: Call,
    /,
    path: Path,
    output: Path | None,
    report: Path | None,
    round_trip: bool,
    body: str,
    blades: int | None,
    stations: tuple[float, ...] | None,
    table_file: Path | None,
    changes: dict[str, Any],
    **extents: Any,
) -> Outcome:
    """Print the properties of what DESIGN builds and whether it passes its checks; draw it where -o names a picture.

    --stations adds metal angles, chord, thickness, throat, solidity, lean, sweep and more as they are built, at places
    along the span; --csv writes them, named like the keys of a design. --report writes one page to send, which loads
    nothing: a 3D view that the mouse turns, the figures, the stations, the pictures, the parameters, and the round trip
    that `build` left as NAME.roundtrip.json beside the page or the design.

    The picture shows sections, curvature and its slope, the meridional channel, edges from close by, the laws of
    evolution and a 3D view; with --body passage a see-through view of the flow passage, its duct, and its walls
    unwrapped with the lines of their patches; with --body row, sector or wheel that part. The flow domain of a 2D
    design is the curves around its section, and reaches are in axial chords. The exit status is 1 where a check fails.

    Of a CAD file in the place of DESIGN it tells which design the file was made from.
    """
    if path.suffix.lower() in CAD_SUFFIXES:
        if output is not None or changes:
            raise click.UsageError(
                f"'{path}' is a CAD file, of which only the design is shown: -o and --set are for a design file"
            )
        return made_from(path)
    check_options((body,), 0.0, extents, blades=blades)
    wants_table = stations is not None or table_file is not None
    if wants_table and body != "blade":
        raise click.UsageError(f"--stations and --csv are of the blade: leave out --body {body}")
    design: Any = load_design(path, changes)
    if report is not None:
        from bladewright.views.report import checked_report_path

        checked_report_path(report)
    elif round_trip:
        raise click.UsageError("--round-trip is for the report: name it by --report FILE.html, or leave it out")
    with _writing(output, table_file, report), progress(1 + bool(output) + bool(report), call) as bar:
        bar.set_description_str(body)
        if body == "passage":
            built = flow_domain_from(design, path, extents)
            data = passage_data(design, built)
        elif body != "blade":
            [built] = bodies_from((body,), design, path, 0.0, {}, blades=blades)
            data = part_data(design, built)
        else:
            built = built_from(design, path)
            data = summary_data(design, built)
            data["smoothness"] = smoothness_data(built)
            data |= sense_data(built)
        data["mass"] = mass_data(built) or None
        bar.update(1)
        if output is not None:
            from bladewright import views

            bar.set_description_str("picture")
            views.picture(design, output, blade=built)
            data["picture"] = str(output)
            bar.update(1)
        if report is not None:
            bar.set_description_str("report")
            write_report(design, built, path, report, measured=round_trip, stations=stations)
            data["report"] = str(report)
            bar.update(1)
    rows = [
        *mass_rows(data["mass"] or {}, data["length_unit"]),
        *passage_rows(data),
        *smoothness_rows(data.get("smoothness", []), data["length_unit"]),
    ]
    rows += sense_rows(data, with_table=wants_table)
    text = summary_text(data, rows)
    if wants_table:
        table = station_table(built, stations)
        data["table"] = table.to_dict()
        text += f"\n\n{table}"
        text += f"\n{written_csv(table, table_file)}" if table_file else ""
    text += "".join(f"\nwrote {file}" for file in (output, report) if file)
    return Outcome(data=data, text=text, failures=broken_promises(data))


@contextmanager
def _writing(picture: Path | None, *others: Path | None) -> Iterator[None]:
    """A context in which the files that are wanted can be written; FileError, before any work, where not.

    Their directories are made; after an error, what is new is removed.
    """
    with ExitStack() as stack:
        for path in (picture, *others):
            if path is not None:
                stack.enter_context(removing_partial_files(path.parent, [path.name]))
        if picture is not None:
            from bladewright.views.pages import checked_path

            checked_path(picture)
        yield
