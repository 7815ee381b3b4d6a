"""The files of `bladewright fit`: the design and the cloud that it reads, the report and the tables that it writes."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli.outcome import jsonable
from bladewright.designs import Design
from bladewright.errors import FileError

if TYPE_CHECKING:
    from bladewright.files.clouds import Cloud
    from bladewright.fitting.assessment.result import Fit


CAD_SUFFIXES = (".step", ".stp", ".igs", ".iges", ".brep")
"""Endings of the files whose faces are sampled."""
SAMPLES = 10_000
"""Points sampled on faces and edges of a CAD file where `--samples` is not given. More take longer to fit and add
little, as the faces are exact; fewer leave small edges with too few points."""
LABELS = ("description", "author", "organisation")
"""Texts that a design file keeps when a fit overwrites it, as no fit knows them."""
_ROWS = 100_000
"""Rows of the table of deviations formatted at a time; more rows take more memory, fewer take more calls."""


def read_start(path: Path) -> Design:
    """Read the design in a design file, or in a ParaBlade configuration."""
    from bladewright.cli.load_design import load_design
    from bladewright.files.parablade import read_parablade

    if path.is_file() and path.suffix.lower() != ".toml" and _is_parablade(path):
        return read_parablade(path)
    return load_design(path, {})


def _is_parablade(path: Path) -> bool:
    from bladewright.files.parablade import is_parablade
    from bladewright.files.text import read_text

    return is_parablade(read_text(path))


def read_points(path: Path, columns: Sequence[str] | None, unit: str | None, samples: int | None) -> "Cloud":
    """Read the points of a file, or sample the faces of a CAD file with so many points."""
    from bladewright.files.clouds import Cloud, read_cloud

    if path.suffix.lower() not in CAD_SUFFIXES:
        if samples is not None:
            raise click.UsageError(f"--samples chooses points of the faces of a CAD file ({', '.join(CAD_SUFFIXES)})")
        return read_cloud(path, columns=columns, unit=unit)
    if columns is not None or unit is not None:
        raise click.UsageError("--columns and --unit are for tables of points: a CAD file has its own axes and unit")
    if not path.exists():
        raise FileError(f"there is no file '{path}'")
    from bladewright import cad

    points = cad.sample(path, samples or SAMPLES)
    return Cloud(points=points, format="a CAD file", unit="mm", columns=("x", "y", "z"))


def report_beside(design: Path) -> Path:
    """The path of the report that belongs to a design file."""
    return design.with_name(f"{design.stem}.fit.json")


def picture_beside(design: Path) -> Path:
    """The path of the picture that belongs to a design file."""
    return design.with_name(f"{design.stem}.fit.png")


def check_design_file(path: Path) -> None:
    """Raise FileError, before the work begins, where a file exists that holds no design."""
    from bladewright.errors import DesignError, FileError
    from bladewright.files.reading import read_design

    if path.is_file():
        try:
            read_design(path)
        except FileError as error:
            raise FileError(f"{error}; so it is not overwritten: name another file") from error
        except DesignError:
            # A design that cannot be built may be overwritten as well.
            return


def with_labels(design: Any, path: Path) -> Any:
    """The design with the labels that the file at `path` already has."""
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
    from bladewright.atomic_write import atomic_write

    dimension = fit.cloud.shape[1]
    names = (*"xyz"[:dimension], "nearest", "u", "v", "deviation", "region", "inlier")
    with atomic_write(path) as unfinished, Path(unfinished).open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(",".join(names) + "\n")
        for first in range(0, len(fit.cloud), _ROWS):
            part = slice(first, first + _ROWS)
            stream.writelines(_table_rows(fit, part))


def _table_rows(fit: "Fit", part: slice) -> Sequence[str]:
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
