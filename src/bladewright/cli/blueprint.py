"""The design that a command is given, and what it builds."""

from collections.abc import Mapping
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


def built_from(design: Any, path: Path, extend: float = 0.0) -> Any:
    """What a design builds, extended past its ends by a part of its span where that is not 0.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    try:
        built = design.build()
        return built.extended(extend) if extend else built
    except DesignError as error:
        raise DesignError(f"{path}: {error}") from error
