"""`bladewright verify`: a CAD file from anywhere is measured against a design."""

from pathlib import Path
from typing import Any

import click

from bladewright.cli.load_design import BODIES, bodies_from, load_design
from bladewright.cli.options import (
    check_options,
    common,
    design_argument,
    extend_option,
    fine_option,
    passage_options,
    set_option,
)
from bladewright.cli.outcome import Outcome


@click.command(short_help="A CAD file from anywhere against a design.")
@click.argument("file", type=click.Path(path_type=Path))
@design_argument
@click.option("--body", type=click.Choice(BODIES), default="blade", show_default=True, help="What the file is to hold.")
@click.option("--intersections", is_flag=True, help="Look for parts that meet where they should not; takes seconds.")
@fine_option
@extend_option
@passage_options
@set_option
@common
def verify(
    file: Path,
    path: Path,
    body: str,
    intersections: bool,
    extend: float,
    fine: bool,
    changes: dict[str, Any],
    **extents: Any,
) -> Outcome:
    """Measure the CAD file FILE against the blade of DESIGN, or against its passage, both ways."""
    check_options([body], extend, extents)
    design: Any = load_design(path, changes)
    [built] = bodies_from([body], design, path, extend, extents, fine=fine)
    from bladewright import cad

    trip = cad.verify(file, built, intersections=intersections)
    failures = tuple(f"{file}: {failure}" for failure in trip.failures)
    return Outcome(data=trip.to_dict(), text=trip.text(design.length_unit), failures=failures)
