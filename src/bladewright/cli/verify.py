"""`bladewright verify`: a CAD file from anywhere is measured against a design."""

from pathlib import Path
from typing import Any

import click

from bladewright.cli.blueprint import body_from, design_at
from bladewright.cli.call import common
from bladewright.cli.options import design_argument, extend_option, set_option
from bladewright.cli.outcome import Outcome


@click.command(short_help="A CAD file from anywhere against a design.")
@click.argument("file", type=click.Path(path_type=Path))
@design_argument
@extend_option
@set_option
@common
def verify(file: Path, design: Path, extend: float, changes: dict[str, Any]) -> Outcome:
    """Measure the CAD file FILE against the blade of DESIGN, both ways."""
    built = body_from(design_at(design, changes), design, extend)
    from bladewright import cad

    trip = cad.verify(file, built)
    failures = tuple(f"{file}: {failure}" for failure in trip.failures)
    return Outcome(data=trip.to_dict(), text=str(trip), failures=failures)
