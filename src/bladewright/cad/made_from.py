"""Which design a CAD file was made from, by its header and by the report of the round trip beside it."""

import json
import os
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bladewright.cad.mesh_files import read_3mf, read_stl
from bladewright.cad.reading import format_of, read_cad_file
from bladewright.origin import Origin


@dataclass(frozen=True, kw_only=True)
class MadeFrom:
    """What a CAD file says of the design that it was made from."""

    file: str
    format: str
    """format and schema, such as STEP AP242"""
    unit: str
    system: str
    """program that wrote the file, as it says; empty where it says nothing"""
    origin: Origin | None
    """the design: by the header, with path and text where the report beside the file is about the same design; by that
    report alone where the format has no header"""
    report: str | None
    """name of the report beside the file"""
    notes: tuple[str, ...] = ()
    """what does not agree"""

    def to_dict(self) -> dict[str, Any]:
        """As plain numbers, strings, lists and dictionaries, ready for JSON."""
        return {
            "file": self.file,
            "format": self.format,
            "unit": self.unit,
            "system": self.system,
            "design": None if self.origin is None else self.origin.to_dict(),
            "report": self.report,
            "notes": list(self.notes),
        }

    def __str__(self) -> str:
        head = f"{self.file} ({self.format}, {self.unit})" + (f", written by {self.system}" if self.system else "")
        origin = self.origin
        if origin is None:
            ours = "bladewright" in self.system
            why = "it was written without one" if ours else "bladewright did not write it, or not with its report"
            return "\n".join([f"{head}: it names no design; {why}", *(f"  note: {note}" for note in self.notes)])
        rows = [
            ("design", origin.name + (f", from {origin.file}" if origin.file else "")),
            ("parameters", f"sha256 {origin.parameters_hash}"),
            ("changes", " ".join(f"--set {change}" for change in origin.changes) or "none"),
            ("text", f"in {self.report}" if origin.text else "not beside the file"),
        ]
        lines = [f"  {name:<10}  {value}" for name, value in rows]
        return "\n".join([head, *lines, *(f"  note: {note}" for note in self.notes)])


def made_from(path: str | os.PathLike[str]) -> MadeFrom:
    """Which design a CAD file was made from. Raises CadError where the file is not of the format that it names."""
    path = Path(path)
    kind = format_of(path)
    report, reported = _report_beside(path)
    if kind in {"STL", "3MF"}:
        _, unit = read_stl(path) if kind == "STL" else read_3mf(path)
        return MadeFrom(file=str(path), format=kind, unit=unit, system="", origin=reported, report=report)
    opened = read_cad_file(path)
    own, notes = opened.origin, []
    if kind == "BREP":
        own = reported
    elif own is not None and reported is not None:
        if own == replace(reported, file=None, text=None):
            own = reported
        else:
            notes.append(
                f"{report} beside it is about another design, {reported.name} (sha256 {reported.parameters_hash})"
            )
    return MadeFrom(
        file=str(path),
        format=" ".join(word for word in (kind, opened.schema) if word),
        unit=opened.unit,
        system=opened.system,
        origin=own,
        report=report,
        notes=tuple(notes),
    )


def _report_beside(path: Path) -> tuple[str | None, Origin | None]:
    """Name and design of the report of the round trip of a file; None where there is none."""
    for name in (f"{path.name}.roundtrip.json", f"{path.stem}.roundtrip.json"):
        with suppress(OSError, ValueError):
            data = json.loads((path.parent / name).read_text("utf-8"))
            if isinstance(data, dict) and data.get("file") == path.name:
                return name, Origin.from_dict(data.get("design"))
    return None, None
