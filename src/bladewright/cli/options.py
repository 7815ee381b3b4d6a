"""Options that several commands share: those that every command takes, their values, and how they are read."""

import re
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self, TypeVar

import click

Decorated = TypeVar("Decorated", bound=Callable[..., Any])


@dataclass(frozen=True, kw_only=True)
class Call:
    """The options that every command takes."""

    as_json: bool
    """one JSON object on standard output, and nothing else"""
    quiet: bool
    """nothing but errors and failures"""
    debug: bool
    """the traceback of an error"""

    @classmethod
    def from_words(cls, words: Sequence[str]) -> Self:
        """The options among the words of a command line, which must be known even where the rest cannot be parsed."""
        return cls(as_json="--json" in words, quiet=not {"--quiet", "-q"}.isdisjoint(words), debug="--debug" in words)


def common(command: Decorated) -> Decorated:
    """Let a command take the options of `Call`."""
    options = (
        click.option("--debug", is_flag=True, expose_value=False, help="Show the traceback of an error."),
        click.option("-q", "--quiet", is_flag=True, expose_value=False, help="Print nothing but errors and failures."),
        click.option("--json", is_flag=True, expose_value=False, help="Print one JSON object, and nothing else."),
    )
    for option in options:
        command = option(command)
    return command


design_argument = click.argument("design", type=click.Path(path_type=Path))


def _parse_changes(_: click.Context, __: click.Parameter, pairs: Sequence[str]) -> dict[str, Any]:
    changes = {}
    for pair in pairs:
        path, sign, text = pair.partition("=")
        if not sign or not path.strip():
            raise click.BadParameter(f"'{pair}' is not PATH=VALUE: write it like --set stagger[1]=-52")
        changes[path.strip()] = _parse_value(path.strip(), text.strip())
    return changes


set_option = click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="PATH=VALUE",
    callback=_parse_changes,
    help="Change a parameter, such as stagger[1]=-52 or channel.hub[0].x=3; the value is TOML. Repeatable.",
)
extend_option = click.option(
    "--extend",
    type=click.FloatRange(0.0, 0.5),
    default=0.0,
    metavar="SPAN",
    help="Extend the blade past hub and shroud by this part of its span, for a later cut in your CAD; a tip stays.",
)


def parse_length(_: click.Context, __: click.Parameter, text: str | None) -> float | None:
    """A length such as 0.01mm [m]."""
    from bladewright.section.checks import UNITS

    if text is None:
        return None
    match = re.fullmatch(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*([a-z]+)\s*", text)
    try:
        value = float(match[1]) * UNITS[match[2]] if match else 0.0
    except (ValueError, KeyError):
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise click.BadParameter(f"'{text}' is not a length: write a positive number and its unit, like 0.01mm")
    return value


def comma_separated(known: Sequence[str]) -> Callable[[click.Context, click.Parameter, str], tuple[str, ...]]:
    """A callback for a list with commas, each entry one of the known words."""

    def entries(_: click.Context, __: click.Parameter, text: str) -> tuple[str, ...]:
        words = tuple(dict.fromkeys(word.strip().lower() for word in text.split(",")))
        for word in words:
            if word not in known:
                raise click.BadParameter(f"'{word}' is not one of {', '.join(known)}: write them with commas between")
        return words

    return entries


def _parse_value(path: str, text: str) -> Any:
    try:
        document = tomllib.loads(f"value = {text}\n")
    except (ValueError, RecursionError):
        document = {}
    if document.keys() == {"value"}:
        return document["value"]
    if re.fullmatch(r"[^\W\d][\w .-]*", text):
        return text
    raise click.BadParameter(f"'{text}' is no TOML value for {path}: a number, a list like [1.0, 2.0], or a \"text\"")
