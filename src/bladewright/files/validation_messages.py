"""Validation errors of pydantic, each turned into one paragraph: whole path, value, and what is needed."""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from bladewright.designs import OF_LAW, Design, Point, unknown, whole_path
from bladewright.errors import DesignError
from bladewright.files.families import FAMILIES
from bladewright.section.checks import between, declared, number
from bladewright.section.tagged_unions import tags

_NEEDED = {
    float: "a number",
    bool: "true or false",
    int: "a whole number",
    str: "a text in quotes",
    Point: "a pair of numbers",
}
_RANKS = {"unexpected_keyword_argument": 0, "missing": 2}
"""Order in which errors are reported: unknown keys, wrong values (1), missing keys."""


def validation_messages(error: ValidationError, document: Mapping[str, Any], kind: type[Design]) -> list[str]:
    """A paragraph for each thing to correct: unknown keys, then wrong values, then missing keys."""
    found: dict[str, list[tuple[int, int, str, str]]] = {}
    for each in error.errors(include_url=False):
        place = _Place(each["loc"], document, kind)
        rank = _RANKS.get(each["type"], 1) if place.depth_in_list == 0 else 1
        if each["type"] == "value_error":
            for text in each["ctx"]["error"].args:
                own = whole_path(place.path, str(text), place.annotation) if place.path else str(text)
                own = own if own.startswith(place.path) else f"{place.path}: {own}"
                found.setdefault(f"{place.path}: {text}", []).append((rank, 0, place.path, own))
            continue
        depth = place.path.count(".") + place.path.count("[")
        found.setdefault(place.field, []).append((rank, -depth, place.path, _error_text(each, place)))
    said = list[tuple[int, str]]()
    for candidates in found.values():
        # of the members of a union, the one that was intended is the one that reached deepest into the value
        rank, depth, *_ = min(candidates)
        deepest = {path: text for *ranks, path, text in sorted(candidates, reverse=True) if ranks == [rank, depth]}
        said += ((rank, text) for text in reversed(deepest.values()))
    said += ((1, text) for text in _beyond_limits(document, kind, ""))
    return list(dict.fromkeys(text for _, text in sorted(said, key=lambda each: each[0])))


def _beyond_limits(table: Mapping[str, Any], kind: Any, path: str) -> Iterator[str]:
    """What lies outside its field's limits, also where a table's own checks do not run for an error in it."""
    kinds = {each.name: kept for each, kept in declared(kind)}
    limited = {each.name: each.metadata["limits"] for each in fields(kind) if each.metadata.get("limits")}
    hints = get_type_hints(kind)
    for name in (each.name for each in fields(kind) if table.get(each.name) is not None):
        value, annotation = table[name], _without_none(hints[name])
        if name in limited:
            limits = limited[name]
            try:
                value = kinds.get(name, number)(f"{path}{name}", value)
            except (DesignError, TypeError, ValueError, OverflowError):
                continue  # no number, or no law, which is said already
            try:
                between(f"{path}{name}", value, limits.low, limits.high, limits.cure, closed=limits.closed)
            except DesignError as error:
                yield str(error)
        elif isinstance(value, Mapping):
            parts: list[Any] = [part for part, own in _tagged_parts(annotation) if own.items() <= value.items()]
            parts = [annotation] if is_dataclass(annotation) else parts
            for part in parts[:1]:
                yield from _beyond_limits(value, part, f"{path}{name}.")


def shown(value: Any) -> str:
    """A value as a file has it, shortened."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    text = json.dumps(value, default=str, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


def needed(annotation: Any) -> str:
    """What a field of this type needs, in words."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        parts = [own for _, own in _tagged_parts(annotation)]
        if parts:
            return f"a table whose {next(iter(parts[0]))} is one of " + ", ".join(shown(*own.values()) for own in parts)
        return " or ".join(needed(each) for each in inner if each is not NoneType)
    if origin is Literal:
        return "one of " + ", ".join(shown(each) for each in inner)
    if origin is tuple:
        return _needed_list(inner)
    if is_dataclass(annotation):
        return "a table of " + ", ".join(each.name for each in fields(annotation))
    return _NEEDED[annotation]


def _needed_list(entries: tuple[Any, ...]) -> str:
    if Ellipsis not in entries:
        return "a pair of numbers"
    entry = needed(entries[0])
    return f"a list of {entry[2:]}s" if entry == "a number" else f"a list with, for each entry, {entry}"


def _tagged_parts(annotation: Any) -> list[tuple[type[Any], dict[str, Any]]]:
    """The part classes of a union, and the field and value by which each is recognised."""
    if get_origin(annotation) not in (Union, UnionType):
        return []
    parts: list[Any] = [each for each in get_args(annotation) if is_dataclass(each)]
    return [(each, own) for each in parts if (own := tags(each))]


def _union_member(annotation: Any, step: int | str) -> type[Any] | None:
    """The part class of a union that a step of pydantic's path names: by its tag, or by its class where it has none."""
    members = get_args(annotation) if get_origin(annotation) in (Union, UnionType) else ()
    parts: list[Any] = [each for each in members if is_dataclass(each)]
    named = (each for each in parts if step in tags(each).values() or (not tags(each) and step == each.__name__))
    return next(named, None)


def _without_none(annotation: Any) -> Any:
    """The type of an optional part without None."""
    arms = [each for each in get_args(annotation) if each is not NoneType]
    alone = get_origin(annotation) in (Union, UnionType) and len(arms) == 1 and is_dataclass(arms[0])
    return arms[0] if alone else annotation


class _Place:
    """Where in a file pydantic found an error: the dotted path, the field's type and unit, and the table around it."""

    def __init__(self, loc: tuple[int | str, ...], document: Mapping[str, Any], kind: type[Design]) -> None:
        self.path = self.field = self.unit = ""
        self.annotation: Any = kind
        self.names: list[str] = [each.name for each in fields(kind)]
        self.kind = kind
        self.depth_in_list = 0
        node: Any = document
        for step in loc:
            part = _union_member(self.annotation, step)
            if part is not None:
                self.annotation, self.depth_in_list = part, 0
            elif isinstance(step, str) and self.depth_in_list == 0 and isinstance(node, Mapping):
                self._enter(step)
                node = node.get(step)
            elif isinstance(step, int) and isinstance(node, list):
                self._index(step)
                node = node[step] if step < len(node) else None

    def _enter(self, name: str) -> None:
        if not is_dataclass(self.annotation):
            return
        self.names = [each.name for each in fields(self.annotation)]
        unit = next((each.metadata.get("unit", "") for each in fields(self.annotation) if each.name == name), "")
        self.unit = self.unit if unit == OF_LAW else unit
        self.annotation = _without_none(get_type_hints(self.annotation).get(name))
        self.path = self.field = f"{self.path}.{name}" if self.path else name

    def _index(self, index: int) -> None:
        self.depth_in_list += 1
        if self.annotation is Point:
            self.path += f".{Point._fields[index]}" if index < 2 else f"[{index}]"
            self.annotation = float
            return
        self.path += f"[{index}]"
        optional = get_origin(self.annotation) in (Union, UnionType)
        members = get_args(self.annotation) if optional else (self.annotation,)
        self.annotation = next((get_args(each)[0] for each in members if get_origin(each) is tuple), float)


def _error_text(error: ErrorDetails, place: _Place) -> str:
    unit = f" [{place.unit}]" if place.unit else ""
    if error["type"] == "unexpected_keyword_argument":
        return _unknown_key(place)
    if error["type"] == "missing" and place.depth_in_list == 0:
        return f"{place.path} is missing: {needed(place.annotation)}{unit} must be given"
    if error["type"] == "missing":
        return f"{place.path} is missing: a pair of numbers{unit} is needed"
    if error["type"].startswith("union_tag"):
        return _wrong_tag(error, place)
    value = shown(error["input"])
    what = f"{place.path or 'the file'} is {value}: {needed(place.annotation)}{unit} is needed"
    return what + _nearest_choice(error, place)


def _unknown_key(place: _Place) -> str:
    """The message for a key that does not exist here, with the place or the families in which it does."""
    name = place.path.rpartition(".")[2]
    own = sorted(path for path in key_paths(place.kind) if path.rpartition(".")[2] == name)
    if place.path in own:
        tags_of = " or ".join(sorted(key_paths(place.kind)[place.path])) or "another kind of this table"
        return f"{place.path} does not exist here: it belongs to {tags_of}; known here are {', '.join(place.names)}"
    if own:
        return f"{place.path} does not exist: in this family it is {' or '.join(own)}"
    families = [family for family, kind in FAMILIES.items() if place.path in key_paths(kind)]
    if families and not get_close_matches(name, place.names, n=1, cutoff=0.9):
        return f"{place.path} does not exist in this family: it is a key of {', '.join(families)}"
    elsewhere = _same_name_elsewhere(name)
    if elsewhere and not get_close_matches(name, place.names, n=1, cutoff=0.9):
        others = "; ".join(f"{path} of {', '.join(found)}" for path, found in elsewhere.items())
        return f"{place.path} does not exist in this family: there is {others}"
    return unknown(place.path, name, place.names)


def _same_name_elsewhere(name: str) -> dict[str, list[str]]:
    """The families that have a key of this name, by its path there."""
    found: dict[str, list[str]] = {}
    for family, kind in FAMILIES.items():
        for path in key_paths(kind):
            if path.rpartition(".")[2] == name:
                found.setdefault(path, []).append(family)
    return found


@cache
def key_paths(kind: Any, path: str = "", within: tuple[Any, ...] = ()) -> dict[str, set[str]]:
    """The path of every key that a design, or a part of it, may have; with the tags of the parts that have it."""
    found: dict[str, set[str]] = {}
    hints = get_type_hints(kind)
    tag_text = " and ".join(f"{name} = {shown(value)}" for name, value in tags(kind).items())
    for each in fields(kind):
        where = path + each.name
        found.setdefault(where, set()).update([tag_text] if tag_text else [])
        for part in _parts_in(hints[each.name]):
            if part not in within:
                for below, tags_of in key_paths(part, f"{where}.", (*within, part)).items():
                    found.setdefault(below, set()).update(tags_of)
    return found


def _parts_in(annotation: Any) -> list[Any]:
    """The part classes that a field may hold."""
    if is_dataclass(annotation) and isinstance(annotation, type):
        return [annotation]
    return [part for arm in get_args(annotation) for part in _parts_in(arm)]


def _wrong_tag(error: ErrorDetails, place: _Place) -> str:
    parts, value = [own for _, own in _tagged_parts(place.annotation)], error["input"]
    if not parts or not isinstance(value, dict):
        # parts that are recognised by their keys, or a value that is no table at all
        return f"{place.path} is {shown(value)}: {needed(place.annotation)} is needed"
    name, known = next(iter(parts[0])), [str(value) for own in parts for value in own.values()]
    given = value.get(name)
    choice = "one of " + ", ".join(shown(each) for each in known)
    if given is None:
        return f"{place.path}.{name} is missing: {choice} must be given"
    return f"{place.path}.{name} is {shown(given)}: {choice} is needed{_suggestion(given, known)}"


def _nearest_choice(error: ErrorDetails, place: _Place) -> str:
    if error["type"] != "literal_error" or not isinstance(error["input"], str):
        return ""
    return _suggestion(error["input"], [str(each) for each in get_args(place.annotation)])


def _suggestion(given: object, known: list[str]) -> str:
    near = get_close_matches(str(given), known, n=1, cutoff=0.4)
    return f"; did you mean '{near[0]}'?" if near else ""
