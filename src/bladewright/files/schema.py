"""The JSON Schema of design files, made from the fields, units and docstrings of the design classes."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from math import isfinite
from typing import Any, get_args, get_type_hints

from pydantic import TypeAdapter

from bladewright.designs import Limits, Part
from bladewright.files.families import FAMILIES
from bladewright.files.reading import adapter
from bladewright.section.tagged_unions import tags

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schema() -> dict[str, Any]:
    """A JSON Schema (2020-12) with an entry of `oneOf` for each `family`; units are under the key `unit`."""
    inputs = [(family, "validation", adapter(kind)) for family, kind in FAMILIES.items()]
    _, shared = TypeAdapter.json_schemas(inputs)  # type: ignore[arg-type]
    definitions: dict[str, Any] = shared["$defs"]
    refined: set[type[Part]] = set()
    for family, kind in FAMILIES.items():
        own = definitions[kind.__name__]
        own["properties"] = {"family": {"const": family, "description": own["description"]}, **own["properties"]}
        own["required"] = ["family", *own["required"]]
        _refine(kind, definitions, refined)
    return {
        "$schema": _DIALECT,
        "title": "bladewright design file",
        "type": "object",
        "oneOf": [{"$ref": f"#/$defs/{kind.__name__}"} for kind in FAMILIES.values()],
        "$defs": definitions,
    }


def _refine(kind: type[Part], definitions: dict[str, Any], refined: set[type[Part]]) -> None:
    """Add units and remove null, which TOML does not have; once for each part, however many designs contain it."""
    if kind in refined:
        return
    refined.add(kind)
    properties = definitions[kind.__name__]["properties"]
    required = definitions[kind.__name__].setdefault("required", [])
    hints, tag_fields = get_type_hints(kind), tags(kind)
    for each in fields(kind):
        entry = properties[each.name]
        entry.pop("title", None)
        if "description" not in entry and (words := _inherited(kind, each.name)):
            entry["description"] = words
        if "unit" in each.metadata:
            entry["unit"] = each.metadata["unit"]
        if each.metadata.get("limits") is not None:
            _limit(entry, each.metadata["limits"])
        if each.name in tag_fields:
            del entry["default"]
            required.insert(0, each.name)
        if entry.get("default", 0) is None:
            del entry["default"]
            arms = [arm for arm in entry.pop("anyOf") if arm != {"type": "null"}]
            entry.update(arms[0] if len(arms) == 1 else {"anyOf": arms})
        for hint in _parts_in(hints[each.name]):
            _refine(hint, definitions, refined)


def _limit(entry: dict[str, Any], limits: Limits) -> None:
    """Write limits to every number that an entry may be or hold."""
    if entry.get("type") in ("number", "integer"):
        names = ("minimum", "maximum") if limits.closed else ("exclusiveMinimum", "exclusiveMaximum")
        entry.update({name: value for name, value in zip(names, limits[:2], strict=True) if isfinite(value)})
    for inner in (*entry.get("anyOf", ()), *entry.get("oneOf", ()), *([entry["items"]] if "items" in entry else ())):
        _limit(inner, limits)


def _parts_in(hint: Any) -> Iterator[type[Part]]:
    """The part classes that a field may hold: by itself, in a union or in a list."""
    if isinstance(hint, type) and is_dataclass(hint) and issubclass(hint, Part):
        yield hint
    for inner in get_args(hint):
        yield from _parts_in(inner)


def _inherited(kind: type[Part], name: str) -> str | None:
    """The docstring of a field that a base class declares; pydantic reads those of the class itself only."""
    for base in kind.__mro__[1:]:
        if is_dataclass(base) and name in base.__annotations__:
            found: str | None = _properties(base)[name].get("description")
            return found
    return None


@cache
def _properties(kind: type) -> dict[str, Any]:
    """The schema of a class's fields as pydantic makes it."""
    found: dict[str, Any] = TypeAdapter(kind).json_schema()["properties"]
    return found
