"""The outcome of a command, and how it is printed."""

import json
import math
import os
import sys
from dataclasses import dataclass, field
from typing import Any

import click

from bladewright.cli.options import Call

INTERRUPTED = 130
"""Exit status after an interrupt: 128 + SIGINT (2), as shells report it."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """The result of a command, for people and for programs."""

    data: dict[str, Any]
    """the object that `--json` prints"""
    text: str = ""
    """what people read, failures included; nothing is printed where it is empty"""
    failures: tuple[str, ...] = field(default=())
    """a paragraph for each check that failed"""
    refusals: tuple[str, ...] = field(default=())
    """a paragraph for each input that was refused while others were not"""
    interrupted: bool = False
    """whether the work was interrupted; the outcome is then the best result up to that point"""


def print_outcome(outcome: Outcome, call: Call) -> int:
    """Print an outcome as the options of the call ask, and return the exit status."""
    text = json.dumps(jsonable(outcome.data), indent=2, allow_nan=False) if call.as_json else outcome.text
    if text and (call.as_json or not call.quiet):
        _print(text)
    # On a terminal the text above already shows the failures.
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
    """The message on one line: line breaks and runs of white space become single blanks."""
    return " ".join(message.split())


def jsonable(value: Any) -> Any:
    """A nested value as JSON types: arrays become lists, numbers that are not finite become null."""
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
        # The reader has closed the pipe; without this, Python's own flush at exit would fail as well.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
