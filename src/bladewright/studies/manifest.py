"""The manifest of a study: one line of JSON for the study itself, then one for every run that has ended."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Self, final

from bladewright.atomic_write import atomic_write
from bladewright.errors import FileError, StudyError
from bladewright.studies.run import Record

NOT_COMPARED = frozenset({"bladewright", "study", "directory", "functions"})
"""Entries of the first line that may differ where a study goes on: versions and places. Functions are told apart."""

LONGEST_HEADER = 10_000_000
"""[bytes] Size above which a file without any line end is no manifest that was killed at its first line."""


@final
class Manifest:
    """A file to which the records of runs are appended, one line each, by one process at a time.

    A line is written by one call to the system and counts from its line end on: what a killed process left unfinished
    is cut off where the study goes on, and that run is done again. `done` are the runs that were there at the start.
    """

    def __init__(self, path: str | os.PathLike[str], header: Mapping[str, Any], *, retry: bool = False) -> None:
        """Open the manifest of a study, new or to go on.

        `header` says what determines the runs; `retry` drops the runs that have failed, to do them again. Raises
        StudyError where the file is the manifest of another study or another process writes to it, and FileError where
        it is none, or cannot be written.
        """
        self.path, self.header = Path(path), dict(header)
        self.done: set[int] = set()
        self._descriptor = self._opened()
        try:
            self._check(mends=retry)
            if retry:
                self._drop_failed()
            self._cut()
        except BaseException:
            self.close()
            raise

    def append(self, record: Record) -> None:
        """Write the record of a run."""
        self._write(record.line())
        self.done.add(record.run)

    def note(self, data: Mapping[str, Any]) -> None:
        """Write a line that is no run, such as the state of a search; `notes` reads them."""
        self._write(json.dumps({"note": data}, allow_nan=False, default=str))

    def close(self) -> None:
        """Write everything to the disk, and let others write."""
        with suppress(OSError):
            os.fsync(self._descriptor)
            os.close(self._descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _write(self, line: str) -> None:
        data = (line + "\n").encode()
        try:
            while data:
                data = data[os.write(self._descriptor, data) :]
        except OSError as error:
            raise FileError(f"'{self.path}' cannot be written: {error.strerror}; what is in it stays") from error

    def _opened(self) -> int:
        """The file, to which no other process writes as long as it is open."""
        try:
            descriptor = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        except OSError as error:
            raise FileError(f"'{self.path}' cannot be written: {error.strerror}; name another manifest") from error
        with suppress(ImportError):  # Windows has other locks
            import fcntl

            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                os.close(descriptor)
                raise StudyError(
                    f"another process writes to '{self.path}': wait for it, or name another manifest with -o"
                ) from error
        return descriptor

    def _check(self, *, mends: bool) -> None:
        """Read what is there, and refuse the manifest of another study, or of functions that were edited.

        Edits are allowed that are meant to mend what has failed.
        """
        lines = _lines(self.path)
        before = next(lines, None)
        if before is None:
            if self.path.stat().st_size > LONGEST_HEADER:
                raise FileError(f"'{self.path}' is no manifest of a study: name another one with -o")
            return
        other = _difference(before["study"], self.header)
        if other:
            raise StudyError(
                f"'{self.path}' is the manifest of another study: {other}; name another manifest with -o, or move this "
                "one away"
            )
        sources = self.header.get("functions", {})
        known = before["study"].get("functions", {})
        edited = [name for name, source in sources.items() if known.get(name, source) != source]
        if edited and not mends:
            raise StudyError(
                f"the source of {', '.join(edited)} was edited since the runs of '{self.path}', which may not agree "
                "with new ones: name another manifest with -o, which repeats them all, or take the edit back; a sweep "
                "goes on with --retry where the edit only mends what has failed"
            )
        self.done = {line["run"] for line in lines if "run" in line}

    def _drop_failed(self) -> None:
        """Leave out the runs that have failed."""
        kept = [line for line in _texts(self.path) if json.loads(line).get("verdict") != "failed"]
        kept[:1] = [f"{self._first_line}\n".encode()] if kept else []
        with atomic_write(self.path) as unfinished:
            Path(unfinished).write_bytes(b"".join(kept))
        self.close()
        self._descriptor = self._opened()
        self.done = {json.loads(line).get("run") for line in kept} - {None}

    def _cut(self) -> None:
        """Cut off an unfinished last line; write the first line of a new manifest."""
        size = sum(len(line) for line in _texts(self.path))
        os.ftruncate(self._descriptor, size)
        if size == 0:
            self._write(self._first_line)

    @property
    def _first_line(self) -> str:
        return json.dumps({"study": self.header}, allow_nan=False, default=str)


def read_manifest(path: str | os.PathLike[str]) -> tuple[dict[str, Any], Iterator[Record]]:
    """The first line of a manifest, and its records as they are read; FileError where it is none."""
    lines = _lines(Path(path))
    header = next(lines, None)
    if header is None:
        raise FileError(f"'{path}' is no manifest of a study: it is empty")
    return header["study"], (Record.from_dict(line) for line in lines if "run" in line)


def notes(path: str | os.PathLike[str]) -> Iterator[dict[str, Any]]:
    """What `Manifest.note` has written."""
    return (line["note"] for line in _lines(Path(path)) if "note" in line)


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    """The finished lines of a manifest as JSON objects, of which the first is that of the study."""
    for number, text in enumerate(_texts(path), start=1):
        try:
            line = json.loads(text)
        except ValueError:
            line = None
        wanted = ("study",) if number == 1 else ("run", "note")
        if not isinstance(line, dict) or not any(key in line for key in wanted):
            what = "is no manifest of a study" if number == 1 else f"is broken at line {number}"
            raise FileError(f"'{path}' {what}: {text[:60].decode(errors='replace').strip()!r} is not what stands there")
        yield line


def _texts(path: Path) -> Iterator[bytes]:
    """The lines that have their end."""
    try:
        with path.open("rb") as stream:
            yield from (line for line in stream if line.endswith(b"\n"))
    except FileNotFoundError:
        raise FileError(f"there is no manifest '{path}'") from None
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {error.strerror}") from error


def _difference(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """What differs between two studies, in words; empty where nothing does."""
    now = json.loads(json.dumps(now, default=str))
    names = [*now, *(name for name in before if name not in now)]
    differ = [name for name in names if name not in NOT_COMPARED and before.get(name) != now.get(name)]
    if not differ:
        return ""
    name = differ[0]
    was, is_now = (json.dumps(each.get(name))[:120] for each in (before, now))
    short = f": {was} there, {is_now} here" if max(len(was), len(is_now)) <= 80 else ""
    return f"it differs in {' and '.join(differ)}{short}"
