"""The design file that a CAD file is made from, with its text and its changes."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit

from bladewright.files.changing import changed_design
from bladewright.files.reading import parsed
from bladewright.files.text import read_text
from bladewright.origin import Origin, parameters_hash


def design_origin(
    path: str | os.PathLike[str],
    changes: Mapping[str, Any] | None = None,
    *,
    directory: str | os.PathLike[str] = ".",
) -> Origin:
    """The record of a design file that CAD files made from it carry: `cad.write(blade, file, origin=...)`.

    `changes` of parameters by path are those made to the design in the file, `directory` is where the CAD file goes.
    Raises FileError and DesignError as `read_design` does.
    """
    path, changes = Path(path), changes or {}
    text = read_text(path)
    design = changed_design(parsed(text, str(path)), str(path), changes)
    return Origin(
        name=design.name,
        parameters_hash=parameters_hash(design),
        changes=tuple(f"{where}={_toml(value)}" for where, value in changes.items()),
        file=_relative(path, Path(directory)),
        text=text,
    )


def _toml(value: Any) -> str:
    """A value as it is written after an equals sign, on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + "}"
    return tomlkit.item(value).as_string()


def _relative(path: Path, directory: Path) -> str:
    """The path from a directory, so that it holds when both are moved together; absolute between two drives."""
    try:
        return Path(os.path.relpath(path, directory)).as_posix()
    except ValueError:
        return path.absolute().as_posix()
