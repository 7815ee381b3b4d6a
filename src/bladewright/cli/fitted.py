"""What `bladewright fit` leaves behind: the design, the report, the picture and the table of deviations."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bladewright.cli.outcome import jsonable
from bladewright.designs import Design

if TYPE_CHECKING:
    from bladewright.fitting.judgement.result import Fit

LABELS = ("description", "author", "organisation")
"""what a file that is there keeps, as no fit knows it"""
_ROWS = 100_000
"""rows of a table that are put together at a time"""


def report_beside(design: Path) -> Path:
    """The report's path."""
    return design.with_name(f"{design.stem}.fit.json")


def picture_beside(design: Path) -> Path:
    """The picture's path."""
    return design.with_name(f"{design.stem}.fit.png")


def check_design_file(path: Path) -> None:
    """Refuse, before work begins, a file that is there and holds no design."""
    from bladewright.errors import DesignError, FileError
    from bladewright.files.reading import read_design

    if path.is_file():
        try:
            read_design(path)
        except FileError as error:
            raise FileError(f"{error}; so it is not overwritten: name another file") from error
        except DesignError:
            # a design that cannot be built is a design all the same
            return


def labelled(design: Any, path: Path) -> Any:
    """The design with the texts that the file at `path` has for it."""
    from bladewright.errors import BladewrightError
    from bladewright.files.reading import read_design

    if not path.is_file():
        return design
    try:
        before: Design = read_design(path)
    except BladewrightError:
        return design
    kept = {name: getattr(before, name, "") for name in LABELS if not getattr(design, name)}
    return design.changed(kept)


def write_report(data: dict[str, Any], path: Path) -> None:
    """Write the report as JSON."""
    from bladewright.files.text import write_text

    write_text(path, json.dumps(jsonable(data), indent=2, allow_nan=False) + "\n")


def write_deviations(fit: "Fit", path: Path) -> None:
    """Write a table with a row for each point of the cloud, in its order; lengths in metres."""
    from bladewright.appearing import appearing

    dimension = fit.cloud.shape[1]
    names = (*"xyz"[:dimension], "nearest", "u", "v", "deviation", "region", "inlier")
    with appearing(path) as unfinished, Path(unfinished).open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(",".join(names) + "\n")
        for first in range(0, len(fit.cloud), _ROWS):
            part = slice(first, first + _ROWS)
            stream.writelines(_lines(fit, part))


def _lines(fit: "Fit", part: slice) -> Sequence[str]:
    columns = zip(
        fit.cloud[part].tolist(),
        fit.places[part].tolist(),
        fit.u[part].tolist(),
        fit.v[part].tolist(),
        fit.deviations[part].tolist(),
        fit.regions[part].tolist(),
        fit.inliers[part].tolist(),
        strict=True,
    )
    return [
        f"{','.join(map(repr, point))},{place},{u:.9g},{v:.9g},{off:.6e},{region},{int(inlier)}\n"
        for point, place, u, v, off, region, inlier in columns
    ]
