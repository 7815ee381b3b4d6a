"""The report page of `show`, with the round trip that is beside it or that is made for it."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from bladewright.cli.load_design import blade_from


def write_report(
    design: Any, built: Any, design_file: Path, page: Path, *, measured: bool, stations: Sequence[float] | None
) -> None:
    """Write the page about what a design file builds, with a round trip that is `measured` or found."""
    from bladewright import views

    trip: Mapping[str, Any] | None
    if measured:
        trip = _measured(built if built.dimension == 3 else blade_from(design, design_file))
    else:
        name = built.name if built.dimension == 3 else design.name
        trip = _found(f"{name}.roundtrip.json", (page.parent, design_file.parent))
    views.report(design, page, built=built, round_trip=trip, stations=stations)


def _measured(built: Any) -> Mapping[str, Any]:
    from bladewright import cad

    with TemporaryDirectory() as directory:
        return cad.write(built, Path(directory) / f"{built.name}.step").to_dict()


def _found(name: str, directories: tuple[Path, ...]) -> Mapping[str, Any] | None:
    """The first report of this name; None where there is none that is whole."""
    from bladewright.errors import FileError
    from bladewright.files.text import read_text

    for path in (directory / name for directory in directories):
        try:
            found = json.loads(read_text(path))
        except (FileError, json.JSONDecodeError):
            continue
        if isinstance(found, dict) and {"faces", "volume_mm3", "limits", "passed"} <= found.keys():
            return found
    return None
