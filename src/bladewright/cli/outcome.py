"""What a command hands back, and how it is printed."""

import json
import math
import os
import sys
from dataclasses import dataclass, field
from typing import Any

import click

from bladewright.cli.options import Call

INTERRUPTED = 130
"""exit status of work that was broken off"""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """The result of a command, for people and for programs."""

    data: dict[str, Any]
    """the JSON object"""
    text: str = ""
    """for people, the failures in it; nothing is printed where it is empty"""
    failures: tuple[str, ...] = field(default=())
    """checks that failed, each a paragraph"""
    refusals: tuple[str, ...] = field(default=())
    """inputs among several that were refused, each a paragraph"""
    interrupted: bool = False
    """whether the work was broken off, and what is here is the best until then"""


def print_outcome(outcome: Outcome, call: Call) -> int:
    """Print an outcome as the call wants it, and return the exit status."""
    text = json.dumps(jsonable(outcome.data), indent=2, allow_nan=False) if call.as_json else outcome.text
    if text and (call.as_json or not call.quiet):
        _print(text)
    # On a terminal the text has said it already.
    if call.quiet or call.as_json or not sys.stdout.isatty():
        for failure in outcome.failures:
            click.echo(one_paragraph(failure), err=True)
    for refusal in outcome.refusals:
        click.echo(f"bladewright: {one_paragraph(refusal)}", err=True)
    if outcome.interrupted:
        return INTERRUPTED
    if outcome.refusals:
        return 2
    return 1 if outcome.failures else 0


def one_paragraph(message: str) -> str:
    """The message on one line, its white space and line breaks single blanks."""
    return " ".join(message.split())


def jsonable(value: Any) -> Any:
    """A value of dictionaries, sequences, numpy numbers and arrays as JSON has it; what is not finite becomes null."""
    if isinstance(value, dict):
        return {str(key): jsonable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [jsonable(item) for item in value]
    if hasattr(value, "tolist"):
        return jsonable(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, int | str | None) else str(value)


def _print(text: str) -> None:
    try:
        click.echo(text)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has what it wanted; without this, Python's own flush at exit would complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
