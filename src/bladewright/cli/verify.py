"""`bladewright verify`: a CAD file from anywhere is measured against a design."""

import re
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

from bladewright.cli.load_design import BODIES, bodies_from, load_design
from bladewright.cli.options import (
    blades_option,
    check_options,
    common,
    design_argument,
    extend_option,
    fine_option,
    passage_options,
    set_option,
)
from bladewright.cli.outcome import Outcome

NAMES = {
    "row": rb"NEXT_ASSEMBLY_USAGE_OCCURRENCE\(\s*'[^']*',\s*'blade_0*1'",
    "sector": rb"cyclic_(low|high)\b",
    "wheel": rb"\bblade_0*1_\w",
    "passage": rb"\bperiodic_(upper|lower)\b",
}
"""What a STEP or IGES file has that holds a body; a blade has none of it."""


@click.command(short_help="A CAD file from anywhere against a design.")
@click.argument("file", type=click.Path(path_type=Path))
@design_argument
@click.option("--body", type=click.Choice(BODIES), help="What the file is to hold.  [what its faces are called]")
@click.option("--intersections", is_flag=True, help="Look for parts that meet where they should not; takes seconds.")
@fine_option
@extend_option
@blades_option
@passage_options
@set_option
@common
def verify(
    file: Path,
    path: Path,
    body: str | None,
    intersections: bool,
    extend: float,
    fine: bool,
    blades: int | None,
    changes: dict[str, Any],
    **extents: Any,
) -> Outcome:
    """Measure the CAD file FILE against what DESIGN builds, both ways: its blade, passage, row, sector or wheel.

    Which of them the file holds is told by the names of its faces, and where it has none by its own name.
    """
    body = body or body_in(file)
    check_options([body], extend, extents, blades=blades)
    design: Any = load_design(path, changes)
    [built] = bodies_from([body], design, path, extend, extents, fine=fine, blades=blades)
    from bladewright import cad

    trip = cad.verify(file, built, intersections=intersections)
    failures = tuple(f"{file}: {failure}" for failure in trip.failures)
    data = {**trip.to_dict(), "body": body}
    return Outcome(data=data, text=trip.text(design.length_unit), failures=failures)


def body_in(file: Path) -> str:
    """Which body a CAD file holds, a word of BODIES: by names in it, else by its own name; a blade where neither tells.

    A file that cannot be read is a blade's, and refused when it is opened.
    """
    with suppress(OSError):
        content = file.read_bytes()
        named = next((body for body, pattern in NAMES.items() if re.search(pattern, content)), None)
        if named is not None:
            return named
    return next((body for body in BODIES if file.stem.endswith(f"-{body}")), "blade")
