"""Writing a design to its file, the exact inverse of reading; an existing file keeps its comments and layout."""

from __future__ import annotations

import math
from collections.abc import MutableMapping
from dataclasses import MISSING, fields
from os import PathLike
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, Array

from bladewright.designs import Design, Part
from bladewright.errors import BladewrightError, DesignError, FileError
from bladewright.files.families import family_of
from bladewright.files.reading import design_from, parsed
from bladewright.files.text import read_text, write_text
from bladewright.section.tagged_unions import tags

LIST_WIDTH = 100
"""Characters of a list above which each of its entries is written on a line of its own: one screen line."""


def literal(value: Any, path: str) -> str:
    """A text, number, part or nested tuple as TOML, exact to the last bit; DesignError for anything else."""
    if isinstance(value, bool | str):
        return tomlkit.item(value).as_string()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, Part):
        entries = (
            f"{each.name} = {literal(getattr(value, each.name), f'{path}.{each.name}')}"
            for each in fields(value)
            if not (value.inline and _is_default(each, getattr(value, each.name)))
        )
        return f"{{ {', '.join(entries)} }}" if value.inline else "{" + ", ".join(entries) + "}"
    if not isinstance(value, tuple):
        raise DesignError(f"{path} is {value!r}: a file holds real numbers, texts and lists of them")
    items = [literal(item, f"{path}[{index}]") for index, item in enumerate(value)]
    line = f"[{', '.join(items)}]"
    if len(line) <= LIST_WIDTH:
        return line
    return "[\n" + "".join(f"  {item},\n" for item in items) + "]"


def plain(value: Any) -> Any:
    """A value as TOML returns it: lists for tuples, and dictionaries for parts."""
    if isinstance(value, Part):
        return {each.name: plain(getattr(value, each.name)) for each in fields(value)}
    return [plain(item) for item in value] if isinstance(value, tuple) else value


def same(a: Any, b: Any) -> bool:
    """Whether two plain values are equal to the last bit, where a whole number equals the same float."""
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(same(one, other) for one, other in zip(a, b, strict=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    numbers = [isinstance(each, int | float) and not isinstance(each, bool) for each in (a, b)]
    if all(numbers):
        return a == b and math.copysign(1.0, a) == math.copysign(1.0, b)
    return type(a) is type(b) and bool(a == b)


def write_design(design: Design, path: str | PathLike[str]) -> None:
    """Write a design as TOML, so that reading the file gives the same design to the last bit.

    Where the file already holds a design, only the values that differ are changed; comments and layout stay.
    Raises FileError where the file cannot be written or holds something else, and DesignError where a parameter of the
    design is complex or a batch.
    """
    path = Path(path)
    fresh = text_of(design)
    write_text(path, updated(design, read_text(path), str(path)) if path.is_file() else fresh)


def text_of(design: Design) -> str:
    """The text of a new design file, with units as comments and without the fields that have their default value."""
    length = _length_of(design)
    lines = [f'family = "{family_of(design)}"', *_lines(design, "", length, parameters=False), ""]
    lines += _lines(design, "", length, parameters=True)
    return "\n".join([*lines, *_tables(design, "", length)]) + "\n"


def updated(design: Design, text: str, where: str) -> str:
    """The text of an existing design file with the values of this design; FileError where it holds no design."""
    try:
        document = parsed(text, where)
    except FileError as error:
        raise FileError(f"{error}; so it is not overwritten: name another file") from error
    if "family" not in document:
        raise FileError(f"'{where}' exists and holds no design, so it is not overwritten: name another file")
    family = family_of(design)
    try:
        before: Design | None = design_from(document, where)
    except DesignError:
        before = None
    tree = tomlkit.parse(text)
    if document["family"] != family:
        tree["family"] = family
    try:
        _merge(tree, design, before if type(before) is type(design) else None, _length_of(design))
        merged = tomlkit.dumps(tree)
        kept = repr(design_from(parsed(merged, where), where)) == repr(design)
    except (TOMLKitError, BladewrightError, IndexError, KeyError) as error:
        raise FileError(_unsuitable_layout(where)) from error
    if not kept:
        raise FileError(_unsuitable_layout(where))
    return merged


def _unsuitable_layout(where: str) -> str:
    return f"'{where}' exists with a layout that cannot take this design's values: name another file"


def _length_of(design: Design) -> str:
    return str(getattr(design, "length_unit", "length"))


def _tables(design: Part, path: str, length: str) -> list[str]:
    """The lines of the tables of a design's parts, each followed by the tables of its own parts."""
    lines = []
    for each in fields(design):
        value, name = getattr(design, each.name), path + each.name
        if _is_table(value):
            lines += ["", f"[{name}]"]
            lines += [line for kind in (False, True) for line in _lines(value, f"{name}.", length, parameters=kind)]
            lines += _tables(value, f"{name}.", length)
        for part in value if _is_parts(value) else ():
            lines += ["", f"[[{name}]]"]
            lines += [line for kind in (False, True) for line in _lines(part, f"{name}.", length, parameters=kind)]
    return lines


def _is_table(value: Any) -> bool:
    """Whether a value is a part that has a table of its own in files."""
    return isinstance(value, Part) and not value.inline


def _is_parts(value: Any) -> bool:
    """Whether a value is a list of parts, which is written as an array of tables."""
    return isinstance(value, tuple) and len(value) > 0 and all(_is_table(item) for item in value)


def _lines(design: Part, path: str, length: str, *, parameters: bool) -> list[str]:
    lines, tag_fields = [], tags(type(design))
    for each in fields(design):
        value = getattr(design, each.name)
        left_out = _is_table(value) or _is_parts(value) or (_is_default(each, value) and each.name not in tag_fields)
        if ("unit" in each.metadata) == parameters and not left_out:
            unit = each.metadata.get("unit", "-").replace("length", length)
            comment = "" if unit == "-" else f"  # {unit}"
            lines.append(f"{each.name} = {literal(value, path + each.name)}{comment}")
    return lines


def _is_default(each: Any, value: Any) -> bool:
    return each.default is not MISSING and type(value) is type(each.default) and same(plain(each.default), plain(value))


def _merge(table: MutableMapping[str, Any], design: Part, before: Part | None, length: str) -> None:
    tag_fields = tags(type(design))
    for each in fields(design):
        value, old = getattr(design, each.name), getattr(before, each.name, None)
        if isinstance(value, Part) and _is_table(value):
            if not isinstance(table.get(each.name), MutableMapping):
                table[each.name] = tomlkit.table()
            _merge(table[each.name], value, old if isinstance(old, Part) else None, length)
        elif value is None:
            table.pop(each.name, None)
        elif _is_parts(value):
            if each.name not in table or not same(plain(old), plain(value)):
                table[each.name] = _rows(value, length)
        elif each.name in table:
            _put(table, each.name, value, each.name)
        elif each.name in tag_fields or not (_is_default(each, value) or (before and same(plain(old), plain(value)))):
            table[each.name] = tomlkit.value(literal(value, each.name))
    for key in set(table) - {each.name for each in fields(design)} - {"family"}:
        del table[key]


def _rows(parts: tuple[Part, ...], length: str) -> AoT:
    rows = tomlkit.aot()
    for part in parts:
        lines = [line for kind in (False, True) for line in _lines(part, "", length, parameters=kind)]
        row = tomlkit.table()
        for key, item in tomlkit.parse("\n".join(lines)).items():
            row[key] = item
        rows.append(row)
    return rows


def _put(holder: Any, key: str | int, value: Any, path: str) -> None:
    """Set the value at `key` of a table or an array, changing as little of its layout as possible."""
    present = holder[key]
    if same(_unwrapped(present), plain(value)):
        return
    if isinstance(present, MutableMapping) and isinstance(value, Part):
        _merge(present, value, None, "")
        return
    if not isinstance(present, Array) or not isinstance(value, tuple) or not present or not value:
        holder[key] = tomlkit.value(literal(value, path))
        return
    while len(present) > len(value):
        del present[-1]
    for index, item in enumerate(value):
        if index < len(present):
            _put(present, index, item, f"{path}[{index}]")
        else:
            present.append(tomlkit.value(literal(item, f"{path}[{index}]")))


def _unwrapped(item: Any) -> Any:
    return item.unwrap() if hasattr(item, "unwrap") else item
