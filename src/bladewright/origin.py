"""The design that a file was made from, as the file itself and the report beside it say."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, asdict, dataclass, fields
from typing import Any, Self

from bladewright.designs import Part

LABELS = ("name", "description", "author", "organisation")
"""Texts of a design that shape nothing."""
CONTINUED = "+ "
"""What a line of a header begins with that continues the line before it."""


@dataclass(frozen=True, kw_only=True)
class Origin:
    """The design that a file was made from."""

    name: str
    """of the design"""
    parameters_hash: str
    """as `parameters_hash` gives it"""
    changes: tuple[str, ...] = ()
    """changes of the design file by `--set`, each PATH=VALUE as in TOML"""
    file: str | None = None
    """path of the design file, from the directory of the file that was made"""
    text: str | None = None
    """TOML text of the design file, without the changes"""

    def to_dict(self) -> dict[str, Any]:
        """As in the round-trip report."""
        return asdict(self) | {"changes": list(self.changes)}

    @classmethod
    def from_dict(cls, data: object) -> Self | None:
        """The inverse of `to_dict`; None where `data` is no such record."""
        if not isinstance(data, Mapping):
            return None
        texts: dict[str, Any] = {key: data.get(key) for key in ("name", "parameters_hash", "file", "text")}
        needed = (texts["name"], texts["parameters_hash"])
        if not all(isinstance(each, str) for each in needed):
            return None
        changes = data.get("changes")
        return cls(changes=tuple(map(str, changes if isinstance(changes, list) else ())), **texts)

    def lines(self) -> list[str]:
        """Name, hash and changes, as the headers of CAD files state them."""
        changes = (f"set: {change}" for change in self.changes)
        return [f"design: {self.name}", f"parameters: sha256 {self.parameters_hash}", *changes]

    @classmethod
    def from_lines(cls, lines: Sequence[str]) -> Self | None:
        """The inverse of `lines`; None where they name no design."""
        pairs = [line.partition(": ")[::2] for line in lines]
        names = [text for key, text in pairs if key == "design"]
        hashes = [text.removeprefix("sha256 ") for key, text in pairs if key == "parameters" and "sha256 " in text]
        if not names or not hashes:
            return None
        return cls(
            name=names[-1], parameters_hash=hashes[-1], changes=tuple(text for key, text in pairs if key == "set")
        )


def parameters_hash(design: Part) -> str:
    """SHA-256, in hexadecimal, of what shapes a design: classes, and fields that are not at their defaults.

    Designs that differ in their `LABELS` only have the same. A whole number counts as the same float.
    """
    text = json.dumps(_record(design), sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def wrapped(line: str, width: int) -> list[str]:
    """A line as lines of at most so many characters; those after the first begin with `CONTINUED`."""
    first, rest = line[:width], line[width:]
    step = width - len(CONTINUED)
    return [first, *(CONTINUED + rest[start : start + step] for start in range(0, len(rest), step))]


def unwrapped(lines: Sequence[str]) -> list[str]:
    """The inverse of `wrapped` for several lines one after another."""
    whole: list[str] = []
    for line in lines:
        if line.startswith(CONTINUED) and whole:
            whole[-1] += line.removeprefix(CONTINUED)
        else:
            whole.append(line)
    return whole


def _record(part: Part) -> dict[str, Any]:
    values = [(each, getattr(part, each.name)) for each in fields(part) if each.name not in LABELS]
    given = {each.name: _plain(value) for each, value in values if each.default is MISSING or value != each.default}
    return {"": type(part).__name__, **given}


def _plain(value: Any) -> Any:
    if isinstance(value, Part):
        return _record(value)
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    whole = isinstance(value, int) and not isinstance(value, bool)
    return float(value) if whole else value
