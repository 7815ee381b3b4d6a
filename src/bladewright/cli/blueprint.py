"""The design that a command is given, and what it builds."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bladewright.designs import Design
from bladewright.errors import DesignError, FileError


def design_at(path: Path, changes: Mapping[str, Any]) -> Design:
    """The design in a file, with the changes of `--set`."""
    from bladewright.files.examples import examples
    from bladewright.files.reading import read_design

    if not (path.exists() or path.with_suffix(".toml").exists()) and path.stem in examples():
        raise FileError(f"there is no file '{path}': 'bladewright new {path.stem}' writes the built-in example")
    design = read_design(path)
    return design.changed(changes) if changes else design


@contextmanager
def named(path: Path) -> Iterator[None]:
    """Name the design file at `path` in what is refused of its design."""
    try:
        yield
    except DesignError as error:
        raise DesignError(f"{path}: {error}") from error


def built_from(design: Any, path: Path) -> Any:
    """What a design builds: a blade, or a section of a 2D family.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    with named(path):
        return design.build()


def blade_from(design: Any, path: Path) -> Any:
    """The blade of a design, a prismatic one where it is 2D.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    from bladewright.blade.prismatic import prismatic
    from bladewright.section.planar import PlanarSection
    from bladewright.section.unified import UnifiedSection

    with named(path):
        return (prismatic(design) if isinstance(design, UnifiedSection | PlanarSection) else design).build()
