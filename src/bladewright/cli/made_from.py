"""What `bladewright show` tells of a CAD file: which design it was made from."""

from pathlib import Path

from bladewright.cli.outcome import Outcome

CAD_SUFFIXES = (".step", ".stp", ".igs", ".iges", ".brep", ".stl", ".3mf")
"""Endings of CAD files."""


def made_from(path: Path) -> Outcome:
    """Which design a CAD file was made from, by its header and the report beside it."""
    from bladewright import cad
    from bladewright.errors import FileError

    if not path.exists():
        raise FileError(f"there is no file '{path}'")
    found = cad.made_from(path)
    return Outcome(data=found.to_dict(), text=str(found))
