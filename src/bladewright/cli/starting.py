"""Designs that a fit begins with, and the clouds that it is for, from files of any format."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bladewright.designs import Design
from bladewright.errors import FileError

if TYPE_CHECKING:
    from bladewright.files.clouds import Cloud

CAD = (".step", ".stp", ".igs", ".iges", ".brep")
"""endings of files whose faces points are taken of"""
SAMPLES = 10_000
"""points that are taken of them"""


def parablade_text(path: Path) -> str | None:
    """The text of a ParaBlade configuration, or None where the file is something else.

    Raises FileError where it cannot be read as text.
    """
    from bladewright.files.parablade import is_parablade
    from bladewright.files.text import read_text

    text = read_text(path)
    return text if is_parablade(text) else None


def start_at(path: Path) -> Design:
    """The design in a design file, or in a ParaBlade configuration."""
    from bladewright.cli.blueprint import design_at
    from bladewright.files.parablade import read_parablade

    if path.is_file() and path.suffix.lower() != ".toml" and parablade_text(path) is not None:
        return read_parablade(path)
    return design_at(path, {})


def cloud_at(path: Path, columns: Sequence[str] | None, unit: str | None, samples: int | None) -> "Cloud":
    """The points of a file, or so many of the faces of a CAD file."""
    from bladewright.files.clouds import Cloud, read_cloud

    if path.suffix.lower() not in CAD:
        if samples is not None:
            raise click.UsageError(f"--samples chooses points of the faces of a CAD file ({', '.join(CAD)})")
        return read_cloud(path, columns=columns, unit=unit)
    if columns is not None or unit is not None:
        raise click.UsageError("--columns and --unit are for tables of points: a CAD file has its own axes and unit")
    if not path.exists():
        raise FileError(f"there is no file '{path}'")
    from bladewright import cad

    points = cad.sample(path, samples or SAMPLES)
    return Cloud(points=points, format="a CAD file", unit="mm", columns=("x", "y", "z"))
