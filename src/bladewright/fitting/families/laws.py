"""The laws of a family's part as lines of control points: along the chord, and along the span."""

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

from bladewright.designs import Part


def lines_of(part: Part, stem: str) -> Iterator[list[str]]:
    """Paths of control points in a row, for every law and every row of laws of a part."""
    for each in fields(part):
        value, path = getattr(part, each.name), f"{stem}.{each.name}"
        if isinstance(value, Part):
            yield from lines_of(value, path)
        elif "unit" in each.metadata and isinstance(value, tuple):
            yield from _lines(value, path)


def _lines(value: tuple[Any, ...], path: str) -> Iterator[list[str]]:
    if not any(isinstance(item, tuple) for item in value):
        yield [f"{path}[{i}]" for i in range(len(value))]
        return
    rows = [
        [f"{path}[{i}][{j}]" for j in range(len(item))] if isinstance(item, tuple) else [f"{path}[{i}]"]
        for i, item in enumerate(value)
    ]
    yield from rows
    if len({len(row) for row in rows}) == 1:
        yield from (list(column) for column in zip(*rows, strict=True))
