"""The keys of design files, family by family, as the schema states them: for the key reference and the templates."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from bladewright.designs import unknown
from bladewright.errors import FileError
from bladewright.files.families import FAMILIES
from bladewright.files.schema import schema


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key of a table of design files."""

    name: str
    """as it is written"""
    meaning: str
    """what it says, in words"""
    unit: str
    """`length` (the design's own), `deg`, `-`, or empty where it holds no parameter"""
    limits: str
    """the values that it may have: numbers with their limits, or words"""
    default: Any
    """what counts where the key is left out; None: nothing"""
    required: bool
    """whether it must be given"""
    choices: tuple[str, ...]
    """the words that it may be, where it is one of several"""
    holds: tuple[str, ...]
    """the titles of the tables of which it holds one, or a list; empty where it holds plain values"""
    laws: int
    """0: no law; 1: a law along the span, or a number; 2: a list of such laws along the chord"""
    allowed: float
    """a number within its limits, 0 where that is one"""


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table of design files: the whole file of a family, or a part such as a flow path or a thickness law."""

    title: str
    """the name of its class, which Python uses"""
    meaning: str
    """what it describes, in words"""
    keys: tuple[Key, ...]

    def key(self, name: str) -> Key:
        """The key of a name."""
        return next(each for each in self.keys if each.name == name)


def tables(family: str) -> list[Table]:
    """The file of a family, and every table that it may hold, each once, in the order in which they are met.

    Raises FileError with the nearest name where there is no such family.
    """
    if family not in FAMILIES:
        raise FileError(unknown(f"the family '{family}'", family, list(FAMILIES)))
    found: dict[str, Table] = {}
    waiting = [FAMILIES[family].__name__]
    while waiting:
        title = waiting.pop(0)
        if title not in found:
            found[title] = _table(title)
            waiting += [each for key in found[title].keys for each in key.holds]
    return list(found.values())


@cache
def _definitions() -> dict[str, Any]:
    definitions: dict[str, Any] = schema()["$defs"]
    return definitions


@cache
def _table(title: str) -> Table:
    entry = _definitions()[title]
    required = entry.get("required", [])
    keys = (_key(name, own, required=name in required) for name, own in entry["properties"].items())
    return Table(title=title, meaning=entry.get("description", ""), keys=tuple(keys))


def _key(name: str, entry: dict[str, Any], *, required: bool) -> Key:
    choices = (str(entry["const"]),) if "const" in entry else tuple(str(each) for each in entry.get("enum", ()))
    return Key(
        name=name,
        meaning=entry.get("description", ""),
        unit=entry.get("unit", ""),
        limits=_limits(entry),
        default=entry.get("default"),
        required=required,
        choices=choices,
        holds=tuple(dict.fromkeys(each for each in _held(entry) if each not in ("Point", "Stations"))),
        laws=_laws(entry),
        allowed=_allowed(entry),
    )


def _held(entry: dict[str, Any]) -> Iterator[str]:
    """The titles of the tables that a value may be, or contain."""
    if "$ref" in entry:
        yield entry["$ref"].rsplit("/", 1)[-1]
    for arm in _arms(entry):
        yield from _held(arm)
    if "items" in entry:
        yield from _held(entry["items"])


def _laws(entry: dict[str, Any]) -> int:
    if any(arm.get("$ref", "").endswith("/Stations") for arm in _arms(entry)):
        return 1
    return 2 if "items" in entry and _laws(entry["items"]) else 0


def _arms(entry: dict[str, Any]) -> tuple[dict[str, Any], ...]:
    """What an entry may be."""
    return (*entry.get("anyOf", ()), *entry.get("oneOf", ()))


def _limits(entry: dict[str, Any]) -> str:
    """What a value may be, in words."""
    if "const" in entry:
        return f'"{entry["const"]}"'
    if "enum" in entry:
        return ", ".join(f'"{each}"' if isinstance(each, str) else str(each) for each in entry["enum"])
    kinds = list(_kinds(entry))
    return ", or ".join(dict.fromkeys(kinds))


def _kinds(entry: dict[str, Any]) -> Iterator[str]:
    law = _laws(entry)
    if law:
        number = next(_numbers(entry))
        words = {1: "a number or a law along the span", 2: "a list along the chord of numbers or laws along the span"}
        yield words[law] + _range(number)
    elif "$ref" in entry:
        title = entry["$ref"].rsplit("/", 1)[-1]
        yield "[x, r]" if title == "Point" else "a table"
    elif "oneOf" in entry:
        yield "a table, one of several kinds"
    elif "anyOf" in entry:
        for arm in entry["anyOf"]:
            yield from _kinds(arm)
    elif entry.get("type") == "array":
        yield _list(entry)
    else:
        words_of = {"number": "a number", "integer": "a whole number", "string": "text", "boolean": "true or false"}
        yield words_of[entry["type"]] + _range(entry)


def _list(entry: dict[str, Any]) -> str:
    if "prefixItems" in entry:
        return f"{len(entry['prefixItems'])} numbers"
    return f"a list: each {next(_kinds(entry['items']))}"


def _allowed(entry: dict[str, Any]) -> float:
    """A number within the limits: 0, or a tenth of the way from the lower limit to the upper one, or to 1 above it."""
    number = next((each for each in _numbers(entry)), {})
    low = number.get("minimum", number.get("exclusiveMinimum"))
    if low is None or low < 0.0 or number.get("minimum") == 0.0:
        return 0.0
    high = number.get("maximum", number.get("exclusiveMaximum", low + 10.0))
    return float(f"{low + 0.1 * (high - low):.3g}")


def _numbers(entry: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The parts of an entry that describe a number."""
    if entry.get("type") in ("number", "integer"):
        yield entry
    for arm in (*_arms(entry), *([entry["items"]] if "items" in entry else ())):
        yield from _numbers(arm)


def _range(entry: dict[str, Any]) -> str:
    """The limits of a number, such as `, above 0 and up to 1`."""
    words = {
        "exclusiveMinimum": "above {}",
        "minimum": "from {}",
        "exclusiveMaximum": "below {}",
        "maximum": "up to {}",
    }
    said = [word.format(f"{entry[name]:g}") for name, word in words.items() if name in entry]
    return f", {' and '.join(said)}" if said else ""
