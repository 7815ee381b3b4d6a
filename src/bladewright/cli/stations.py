"""The station table on the command line: which stations, and what is said of a blade beside it."""

from pathlib import Path
from typing import Any

import click

Rows = list[tuple[str, str]]


def parse_stations(_: click.Context, __: click.Parameter, text: str | None) -> tuple[float, ...] | None:
    """Span fractions such as 0,0.5,1."""
    if text is None:
        return None
    try:
        found = tuple(float(word) for word in text.split(","))
    except ValueError:
        raise click.BadParameter(f"'{text}' is no list of span fractions: write them like 0,0.5,1") from None
    outside = [each for each in found if not 0.0 <= each <= 1.0]
    if outside:
        raise click.BadParameter(f"{outside[0]:g} is no span fraction: they run from 0 at the hub to 1 at the shroud")
    return found


stations_option = click.option(
    "--stations",
    callback=parse_stations,
    metavar="SPANS",
    help="Add the table of what is built at span fractions, such as 0,0.25,0.5,0.75,1.",
)


def station_table(built: Any, stations: tuple[float, ...] | None) -> Any:
    """The table of a blade, or of the one station that a 2D section has."""
    return built.report(stations) if built.dimension == 3 else built.report()


def sense_data(built: Any) -> dict[str, Any]:
    """Rotation, suction side and warnings of a blade; nothing of a 2D section."""
    if built.dimension == 2:
        return {}
    sense = built.flow_sense
    found = {"rotation": sense.rotation, "suction_side": sense.suction_side, "flow": sense.sentence}
    return {**found, "warnings": [sense.warning]} if sense.warning else found


def sense_rows(data: dict[str, Any], *, with_table: bool) -> Rows:
    """The same to read; the station table says where the flow comes from itself."""
    rows = [("flow", data["flow"])] if "flow" in data and not with_table else []
    return [*rows, *(("WARNING", each) for each in data.get("warnings", []))]


def written_csv(table: Any, path: Path) -> str:
    """Write the table to a CSV file; the line that says so."""
    table.to_csv(path)
    return f"wrote {path}"
