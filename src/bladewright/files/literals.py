"""Plain values of a design and their TOML literals, exact to the bit."""

import math
from dataclasses import fields
from typing import Any

import tomlkit

from bladewright.designs import Part
from bladewright.errors import DesignError

_WIDTH = 100
"""Columns that a list may take before each entry gets its line."""


def literal(value: Any, path: str) -> str:
    """The TOML of a text, a number, a part or a (nested) tuple; DesignError where it is a complex number or a batch."""
    if isinstance(value, bool | str):
        return tomlkit.item(value).as_string()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, Part):
        held = {each.name: getattr(value, each.name) for each in fields(value)}
        return "{" + ", ".join(f"{name} = {literal(item, f'{path}.{name}')}" for name, item in held.items()) + "}"
    if not isinstance(value, tuple):
        raise DesignError(f"{path} is {value!r}: a file holds real numbers, texts and lists of them")
    items = [literal(item, f"{path}[{index}]") for index, item in enumerate(value)]
    line = f"[{', '.join(items)}]"
    if len(line) <= _WIDTH:
        return line
    return "[\n" + "".join(f"  {item},\n" for item in items) + "]"


def plain(value: Any) -> Any:
    """A value with lists in the place of tuples and tables in that of parts, as TOML would return it."""
    if isinstance(value, Part):
        return {each.name: plain(getattr(value, each.name)) for each in fields(value)}
    return [plain(item) for item in value] if isinstance(value, tuple) else value


def same(a: Any, b: Any) -> bool:
    """Whether two plain values are one to the bit, a whole number standing for the same float."""
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(same(one, other) for one, other in zip(a, b, strict=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    numbers = [isinstance(each, int | float) and not isinstance(each, bool) for each in (a, b)]
    if all(numbers):
        return a == b and math.copysign(1.0, a) == math.copysign(1.0, b)
    return type(a) is type(b) and bool(a == b)
