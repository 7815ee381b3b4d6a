"""Which files a command may overwrite: those that were made from the same design file."""

import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import click

from bladewright.errors import FileError
from bladewright.origin import Origin


def refuse_existing(path: Path, option: str = "-o") -> None:
    """Raise FileError where there is a file already, for a command that was not given `--force`."""
    if path.is_file():
        raise FileError(f"'{path}' exists already: name another file with {option}, or overwrite it with --force")


def refuse_same_file(read: Mapping[str, Path | None], written: Mapping[str, Path | None]) -> None:
    """Raise UsageError where a file that is written is also read, or is written twice.

    Files stand under what they are called in a message, and are None where they are not asked for.
    """
    known = {path.resolve(): name for name, path in read.items() if path is not None}
    for name, path in written.items():
        if path is not None and (other := known.setdefault(path.resolve(), name)) != name:
            raise click.UsageError(f"{name} would be written to '{path}', which is {other} as well: name another file")


def overwritten(files: Sequence[Path], reports: Sequence[Path], design: Path, origin: Origin, *, force: bool) -> str:
    """Why CAD files are overwritten that were made from another state of the design; empty where none are.

    `reports` are all that may tell which design file the `files` were made from. It is the one at `design` where text
    or parameters are the same, where the recorded path leads to the same file, or where it leads nowhere and the name
    is the same, as after moving a folder. Raises FileError where it is another one, or where nothing tells, unless
    `force` is set.
    """
    present = [path for path in files if path.is_file()]
    if not present:
        return ""
    records = [record for path in reports if (record := _recorded(path)) is not None]
    names = ", ".join(path.name for path in present)
    cure = "overwrite it with --force, name this design with --name, or choose another directory with -o"
    for file, before in records:
        if not _same_design_file(before, file.parent, design, origin):
            was = f"made from '{_design_file(before, file.parent)}'"
            if not force:
                raise FileError(f"'{file}' was {was}, not from '{design}': {cure}")
            return f"{names} overwritten: {was} before"
    if not records:
        if not force:
            raise FileError(f"'{present[0]}' exists, and no report beside it tells from which design file: {cure}")
        return f"{names} overwritten: nothing says from which design file they were made"
    changes = [(before.changes, before.parameters_hash) for _, before in records]
    if any(each != origin.changes for each, _ in changes):
        return f"{names} overwritten: {_with(origin.changes)}, {_with(changes[0][0])} before"
    if any(each != origin.parameters_hash for _, each in changes):
        return f"{names} overwritten: '{design}' was edited since"
    return ""


def _recorded(report: Path) -> tuple[Path, Origin] | None:
    """The file that the report of a round trip is about, and the design that it records."""
    with suppress(OSError, ValueError, AttributeError, KeyError):
        data = json.loads(report.read_text("utf-8"))
        origin = Origin.from_dict(data.get("design"))
        return None if origin is None else (report.with_name(str(data["file"])), origin)
    return None


def _same_design_file(record: Origin, directory: Path, design: Path, origin: Origin) -> bool:
    if record.text == origin.text or record.parameters_hash == origin.parameters_hash:
        return True
    before = _design_file(record, directory)
    return before.samefile(design) if before.exists() else before.name == design.name


def _design_file(record: Origin, directory: Path) -> Path:
    """The path of the design file; its name, as a path, where none is recorded."""
    return Path(record.name) if record.file is None else Path(os.path.normpath(directory / record.file))


def _with(changes: Sequence[str]) -> str:
    return "with " + " ".join(f"--set {change}" for change in changes) if changes else "without --set"
