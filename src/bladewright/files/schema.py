"""The JSON Schema of design files, from the designs' own fields, units and docstrings."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, get_args, get_type_hints

from pydantic import TypeAdapter

from bladewright.designs import Part
from bladewright.files.families import FAMILIES
from bladewright.files.reading import adapter
from bladewright.section.tagged_unions import tags

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schema() -> dict[str, Any]:
    """A JSON Schema (2020-12) whose `oneOf` has an entry for each `family`; units stand under the key `unit`."""
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
    """Add units, and take away what a TOML file cannot say: null; once for each part, however many designs have it."""
    if kind in refined:
        return
    refined.add(kind)
    properties = definitions[kind.__name__]["properties"]
    required = definitions[kind.__name__].setdefault("required", [])
    hints, told_by = get_type_hints(kind), tags(kind)
    for each in fields(kind):
        entry = properties[each.name]
        entry.pop("title", None)
        if "description" not in entry and (words := _inherited(kind, each.name)):
            entry["description"] = words
        if "unit" in each.metadata:
            entry["unit"] = each.metadata["unit"]
        if each.name in told_by:
            del entry["default"]
            required.insert(0, each.name)
        if entry.get("default", 0) is None:
            del entry["default"]
            arms = [arm for arm in entry.pop("anyOf") if arm != {"type": "null"}]
            entry.update(arms[0] if len(arms) == 1 else {"anyOf": arms})
        for hint in _parts_in(hints[each.name]):
            _refine(hint, definitions, refined)


def _parts_in(hint: Any) -> Iterator[type[Part]]:
    """The parts that a field may hold, alone, in a choice or in a list."""
    if isinstance(hint, type) and is_dataclass(hint) and issubclass(hint, Part):
        yield hint
    for inner in get_args(hint):
        yield from _parts_in(inner)


def _inherited(kind: type[Part], name: str) -> str | None:
    """The description of a field that a base class has declared; pydantic reads those of the class itself."""
    for base in kind.__mro__[1:]:
        if is_dataclass(base) and name in base.__annotations__:
            found: str | None = _properties(base)[name].get("description")
            return found
    return None


@cache
def _properties(kind: type) -> dict[str, Any]:
    """The properties of a class as pydantic describes them."""
    found: dict[str, Any] = TypeAdapter(kind).json_schema()["properties"]
    return found
