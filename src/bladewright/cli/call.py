"""How a command was called: the options that every command takes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
