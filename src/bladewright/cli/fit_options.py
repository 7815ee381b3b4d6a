"""Values of the options of `bladewright fit`."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import click

from bladewright.designs import Design

Fixed = Sequence[str] | Mapping[str, float]
"""patterns of parameters that are held at the start's values, or values by path"""


def columns(_: click.Context, __: click.Parameter, text: str | None) -> tuple[str, ...] | None:
    """Words with commas between, some of them perhaps the same."""
    return None if text is None else tuple(word.strip() for word in text.split(","))


def name(_: click.Context, __: click.Parameter, text: str | None) -> str | None:
    """A name that a design may have."""
    if text is not None and (not text.strip() or any(sign in text for sign in '/\\:*?"<>|')):
        raise click.BadParameter(
            f"'{text}' cannot be a design's name: it names files, so leave / \\ : * ? \" < > | out"
        )
    return text


def bounds(_: click.Context, __: click.Parameter, pairs: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Lowest and highest value by pattern; one that is left out is infinite."""
    found = {}
    for pair in pairs:
        path, sign, text = pair.rpartition("=")
        low, comma, high = text.partition(",")
        try:
            limits = float(low) if low.strip() else -math.inf, float(high) if high.strip() else math.inf
        except ValueError:
            limits = math.nan, math.nan
        if not (sign and comma and path.strip()) or not limits[0] <= limits[1]:
            raise click.BadParameter(f"'{pair}' is not PATH=LOW,HIGH: write it like --bound 'stagger[*]=-60,-40'")
        found[path.strip()] = limits
    return found


def fixes(_: click.Context, __: click.Parameter, words: Sequence[str]) -> dict[str, float | None]:
    """Values by path; None for one that is held at the start's."""
    found: dict[str, float | None] = {}
    for word in words:
        path, sign, text = word.partition("=")
        try:
            value = float(text) if sign else None
        except ValueError:
            value = math.nan
        if not path.strip() or (value is not None and not math.isfinite(value)):
            raise click.BadParameter(f"'{word}' is not PATH or PATH=VALUE: write it like --fix stagger[1]=-52")
        found[path.strip()] = value
    return found


def fixed_of(given: Mapping[str, float | None], start: Design | None) -> Fixed | None:
    """What the fit is told to hold; those without a value are the start's, where others have one."""
    if not given:
        return None
    bare = [path for path, value in given.items() if value is None]
    if bare and start is None:
        raise click.UsageError(f"--fix {bare[0]} holds a start's value: give the value, or a design with --start")
    if len(bare) == len(given) or start is None:
        return bare or {path: value for path, value in given.items() if value is not None}
    from bladewright.derivatives.patterns import chosen

    values: dict[str, Any] = start.parameters()
    held = {path: float(values[path]) for path in chosen(start, bare)} if bare else {}
    return held | {path: value for path, value in given.items() if value is not None}
