"""The report page of a design: one file that an engineer sends to a colleague, and that loads nothing."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from html import escape
from pathlib import Path
from typing import Any

from bladewright import __version__
from bladewright.atomic_write import atomic_write
from bladewright.designs import Design, Part, unit_at
from bladewright.errors import FileError
from bladewright.origin import LABELS, parameters_hash
from bladewright.views.html import Rows, image, table
from bladewright.views.picture import Built, sheet
from bladewright.views.round_trip import Report, round_trip_figure, round_trip_tables
from bladewright.views.shown import KINDS
from bladewright.views.style import INK, PALE, SOFT, lengths_in
from bladewright.views.view3d import HINT

SUFFIXES = (".html", ".htm")
"""Endings of a report page."""
STYLE = f"""
body {{ font: 14px/1.4 sans-serif; color: {INK}; background: white; max-width: 1200px; margin: 0 auto; padding: 16px }}
h1 {{ margin: 0 }}
h2 {{ border-bottom: 1px solid {PALE}; margin: 28px 0 8px; font-size: 18px }}
p {{ margin: 2px 0 }}
.soft {{ color: {SOFT} }}
.beside {{ display: flex; flex-wrap: wrap; gap: 24px; align-items: flex-start }}
.beside > :first-child {{ flex: 1 1 520px; max-width: 760px }}
.wide {{ overflow-x: auto }}
@page {{ margin: 12mm }}
@media print {{
  body {{ max-width: none; padding: 0; font-size: 11px; print-color-adjust: exact }}
  .screen {{ display: none }}
  h2 {{ break-after: avoid }}
  tr, img, canvas {{ break-inside: avoid }}
  .wide {{ overflow: visible }}
}}
"""


def report(
    design: Design,
    path: str | Path,
    *,
    built: Built | None = None,
    round_trip: Report | None = None,
    stations: Sequence[float] | None = None,
) -> None:
    """Write a page about a design: the view in space that turns, figures, pictures, round trip and parameters.

    `built` is what the design builds, or its flow passage, where that is already known; `round_trip` is what
    `trip.to_dict()` gives, or the JSON beside a CAD file; `stations` are those of `blade.report`. The page is one file
    that loads nothing, written whole or not at all. Raises FileError where its name does not end in .html or cannot be
    written, DesignError where the design cannot be built.
    """
    path = checked_report_path(path)
    page = report_page(design, built if built is not None else design.build(), round_trip, stations)
    with atomic_write(path) as unfinished:
        Path(unfinished).write_text(page, encoding="utf-8", newline="\n")


def checked_report_path(path: str | Path) -> Path:
    """The path, where a page can be written to it; raises FileError where its ending or its directory is wrong."""
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        kind = f"ends in '{path.suffix}'" if path.suffix else "has no ending"
        raise FileError(f"'{path}' {kind}: a report is a page; end its name in {SUFFIXES[0]}")
    return path


def report_page(
    design: Any, built: Any, round_trip: Report | None = None, stations: Sequence[float] | None = None
) -> str:
    """The HTML of the page that `report` writes."""
    kind = KINDS[built.shown_as]
    with lengths_in(design.length_unit):
        picture, tables, further = kind.picture(built), kind.tables(built), kind.further(built, stations)
    drawn = image(sheet(design if built.dimension == 2 else built, built), "sections, channel, curvature, laws")
    parts = {
        "": f'<div class="beside"><div>{picture}</div><div>{tables}</div></div>',
        "Stations": f'<div class="wide">{further}</div>' if further else "",
        "Pictures": f'<div class="wide">{drawn}</div>',
    }
    if built.dimension == 3:
        parts[""] += f'<p class="soft screen">{escape(HINT)}</p>'
    if round_trip is not None:
        parts["Round trip"] = _round_trip(design, round_trip)
    parts["Parameters"] = table(parameter_rows(design))
    title = escape(design.name)
    heads = "".join(f"{f'<h2>{name}</h2>' if name else ''}{part}" for name, part in parts.items() if part)
    made = f"bladewright {__version__} · parameters sha256 {parameters_hash(design)}"
    people = " · ".join(filter(None, (design.author, design.organisation)))
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8"><title>{title}</title>'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{STYLE}</style></head>\n'
        f"<body>\n<h1>{title}</h1><p>{escape(design.description)}</p>"
        f'<p class="soft">{escape(people)}</p>{heads}\n<p class="soft">{made}</p>\n</body>\n</html>\n'
    )


def parameter_rows(design: Part) -> Rows:
    """Path and value of every field that is given, with its unit, in the order of the fields."""
    return [
        (path, f"{_text(value)} {_unit(design, path)}".rstrip())
        for path, value in _fields(design, "")
        if value is not None and value != () and path not in LABELS
    ]


def _fields(part: Part, prefix: str) -> Iterator[tuple[str, Any]]:
    for each in fields(part):
        value, path = getattr(part, each.name), f"{prefix}{each.name}"
        if isinstance(value, Part) and not value.inline:
            yield from _fields(value, f"{path}.")
        else:
            yield path, value


def _unit(design: Any, path: str) -> str:
    unit = unit_at(design, path) or ""
    return design.length_unit if unit == "length" else unit.replace("-", "")


def _round_trip(design: Part, report: Report) -> str:
    origin: Mapping[str, Any] = report.get("design") or {}
    other = origin.get("parameters_hash") not in (None, parameters_hash(design))
    remark = "<p><b>This file was made from another state of the design: build it again.</b></p>" if other else ""
    drawn = image(round_trip_figure(report), "deviations of the reopened file")
    return f'{remark}<div class="beside"><div>{drawn}</div><div>{round_trip_tables(report)}</div></div>'


def _text(value: Any) -> str:
    """A value of a design as design files have it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, Part):
        given = (f"{name} = {_text(each)}" for name, each in _fields(value, "") if each is not None)
        return f"{{ {', '.join(given)} }}"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.10g}" if isinstance(value, float) else str(value)
