"""Starting files: a machine of each kind with every key of its family, explained, the optional ones commented out."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from importlib import resources
from textwrap import wrap
from typing import Any

import tomlkit

from bladewright.designs import unknown
from bladewright.errors import FileError
from bladewright.files.keys import Key, Table, tables

WIDTH = 110
"""longest line of a comment, so that it fits an editor's window beside a tree of files [characters]"""
_HEAD = """\
# Every key of the family '{family}' stands here with its meaning, unit and limits. To use one that is commented out,
# take away the # before it and give it your own value; where it has no default, the value here is a placeholder.
"""


def templates() -> dict[str, str]:
    """One line about every template, by its name, in alphabetical order."""
    return {name: str(_document(name).get("description", "")) for name in _names()}


def template_text(name: str) -> str:
    """The text of a template's design file; FileError with the nearest name where there is none."""
    if name not in _names():
        raise FileError(unknown(f"the template '{name}'", name, _names()))
    document = _document(name)
    family = document["family"]
    found = {each.title: each for each in tables(family)}
    root = next(iter(found.values()))
    return "\n".join([_HEAD.format(family=family), *_body(root, document, "", found), ""])


def _names() -> list[str]:
    entries = (resources.files("bladewright") / "templates").iterdir()
    return sorted(entry.name.removesuffix(".toml") for entry in entries if entry.name.endswith(".toml"))


def _document(name: str) -> dict[str, Any]:
    return tomllib.loads((resources.files("bladewright") / "templates" / f"{name}.toml").read_text(encoding="utf-8"))


def _body(table: Table, given: Mapping[str, Any] | None, path: str, found: Mapping[str, Table]) -> Iterator[str]:
    """The lines of a table: its plain keys, then the tables in it; all commented out where it is not given."""
    inner = [key for key in table.keys if _is_table(key, found)]
    plain = [key for key in table.keys if key not in inner]
    for key in sorted(plain, key=lambda each: len(each.choices) != 1):
        used = given is not None and key.name in given
        value = given[key.name] if given is not None and used else _placeholder(key, found)
        yield from _comment(key, found)
        yield f"{'' if used else '#'}{key.name} = {inline(value)}"
        yield ""
    for key in inner:
        own = None if given is None else given.get(key.name)
        at = f"{path}{key.name}"
        yield from _comment(key, found)
        yield f"{'' if own is not None else '#'}[{at}]"
        yield from _body(_kind(key, own, found), own, f"{at}.", found)


def _is_table(key: Key, found: Mapping[str, Table]) -> bool:
    """Whether a key is written as a [table]; curves of two or three keys and lists of tables stand on one line."""
    return key.limits == "a table" or any(_tag(found[each]) for each in key.holds)


def _tag(table: Table) -> Key | None:
    """The key whose one value tells a table from its siblings."""
    return next((key for key in table.keys if len(key.choices) == 1), None)


def _kind(key: Key, given: Mapping[str, Any] | None, found: Mapping[str, Table]) -> Table:
    """The table that stands under a key: of several kinds the one that is given, or the first."""
    kinds = [found[each] for each in key.holds]
    for kind in kinds:
        tag = _tag(kind)
        if given is not None and tag is not None and given.get(tag.name) == tag.choices[0]:
            return kind
    return kinds[0]


def _comment(key: Key, found: Mapping[str, Table]) -> Iterator[str]:
    """What a key means, and below it what it may be and what it is where it is left out."""
    unit = f" [{key.unit.replace('length', 'length_unit')}]" if key.unit else ""
    values = " or ".join(_written(found[each]) for each in key.holds) if len(key.holds) > 1 else key.limits
    if len(key.holds) == 1 and not _is_table(key, found):
        values = values.replace("a table", _written(found[key.holds[0]]))
    default = "" if key.default in (None, "", []) else f"; default {inline(key.default)}"
    yield from _wrapped(re.sub(r"\s*\[(-|deg|length|kg/m\^3)\]$", "", " ".join(key.meaning.split())), "# ")
    if len(key.choices) != 1 and values not in ("a table", "text"):
        yield from _wrapped(f"{values}{unit}{default}", "#   = ")


def _wrapped(text: str, indent: str) -> list[str]:
    """Lines of a comment; what stands in braces or quotes is not broken."""
    kept = re.sub(r"\{[^}]*\}|\w+ = \"[^\"]*\"", lambda found: found[0].replace(" ", "\0"), text)
    lines = wrap(kept, WIDTH, initial_indent=indent, subsequent_indent="#" + " " * len(indent), break_on_hyphens=False)
    return [line.replace("\0", " ") for line in lines]


def _written(table: Table) -> str:
    """How a kind of a table is chosen in a file."""
    tag = _tag(table)
    if tag is not None:
        return f'{tag.name} = "{tag.choices[0]}"'
    return f"{{ {', '.join(key.name for key in table.keys)} }}"


def _placeholder(key: Key, found: Mapping[str, Table]) -> Any:
    """A value that the key may have."""
    if key.default is not None:
        return key.default
    if key.choices:
        return key.choices[0]
    if key.limits.startswith("a table"):
        first = found[key.holds[0]].keys[0]
        return {first.name: _placeholder(first, found)}
    if key.limits.startswith("a list: each [x, r]"):
        return [[0.0, 1.0], [1.0, 2.0], [2.0, 2.0]]
    if key.laws or "number" in key.limits:
        return [key.allowed] * 3 if key.laws == 2 else key.allowed
    return [] if key.limits.startswith("a list") else ""


def inline(value: Any) -> str:
    """A value of a design file on one line."""
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{name} = {inline(each)}' for name, each in value.items())} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(inline(each) for each in value)}]"
    return str(tomlkit.item(value).as_string())
