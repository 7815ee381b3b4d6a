"""Checks of the plain numbers in a design; each refusal names path, value, limit and cure."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from bladewright.designs import ChordwiseLaw, Law, Point, Points
from bladewright.errors import DesignError

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
"""Metres in one unit of length."""


def number(path: str, value: Any) -> Any:
    """The value as a finite float, complex number or numeric array (a batch), or a refusal."""
    if isinstance(value, np.ndarray) and value.ndim > 0 and value.dtype.kind in "fc":
        if not np.all(np.isfinite(value)):
            raise DesignError(f"{path} holds a value that is not finite: every number of a design must be finite")
        return value
    single = np.isscalar(value) or (isinstance(value, np.ndarray) and value.ndim == 0)
    if isinstance(value, bool | str | bytes) or not single:
        raise DesignError(f"{path} is {value!r}: a number is needed")
    given: Any = value
    value = complex(given) if np.iscomplexobj(given) else float(given)
    if not math.isfinite(value.real) or not math.isfinite(value.imag):
        raise DesignError(f"{path} is {value}: every number of a design must be finite")
    return value


def law(path: str, value: Any) -> Law:
    """A number, or a tuple of at least one number."""
    if not is_sequence(value):
        return number(path, value)
    if len(value) == 0:
        raise DesignError(f"{path} is an empty list: give a number, or one control point or more from hub to shroud")
    return tuple(number(f"{path}[{i}]", item) for i, item in enumerate(value))


def chordwise(path: str, value: Any) -> ChordwiseLaw:
    """A tuple of laws, one a control point along the chord."""
    if not is_sequence(value):
        return (number(f"{path}[0]", value),)
    if len(value) == 0:
        raise DesignError(f"{path} is an empty list: give one control point or more from leading to trailing edge")
    return tuple(law(f"{path}[{i}]", item) for i, item in enumerate(value))


def points(path: str, value: Any, least: int) -> Points:
    """A tuple of (x, r) control points."""
    if not is_sequence(value) or any(not is_sequence(item) or len(item) != 2 for item in value):
        raise DesignError(f"{path} is {value!r}: a list of [x, r] pairs is needed")
    if len(value) < least:
        raise DesignError(f"{path} has {len(value)} control points: at least {least} are needed")
    return tuple(Point(number(f"{path}[{i}].x", x), number(f"{path}[{i}].r", r)) for i, (x, r) in enumerate(value))


def is_sequence(value: Any) -> bool:
    """Whether the value is a list of entries (a numeric array is one batched number, not a list)."""
    return isinstance(value, Sequence) and not isinstance(value, str | bytes)


def leaves(path: str, value: Any) -> list[tuple[str, Any]]:
    """Paths and numbers of a law or a chordwise law."""
    if isinstance(value, tuple):
        return [pair for i, item in enumerate(value) for pair in leaves(f"{path}[{i}]", item)]
    return [(path, value)]


def between(path: str, value: Any, low: float, high: float, what: str, *, closed: bool = False) -> None:
    """Refuse every leaf whose real part is not inside (low, high), or [low, high] where closed."""
    for where, leaf in leaves(path, value):
        real = np.real(leaf)
        inside = (real >= low) & (real <= high) if closed else (real > low) & (real < high)
        if not np.all(inside):
            worst = float(np.ravel(real)[np.argmin(np.ravel(inside))])
            raise DesignError(f"{where} is {worst:g}: {what}")


def integer(path: str, value: Any, low: int, high: int, what: str) -> int:
    """A whole number within [low, high]."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
        raise DesignError(f"{path} is {value!r}: {what} ({low} to {high})")
    return int(value)


def choice(path: str, value: Any, known: Sequence[str]) -> str:
    """One of the known words."""
    if value not in known:
        from difflib import get_close_matches

        near = get_close_matches(str(value), known, n=1, cutoff=0.4)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise DesignError(f"{path} is {value!r}: it must be one of {', '.join(known)}{hint}")
    return str(value)


def text(path: str, value: Any) -> str:
    """A string of one line of printable characters."""
    if not isinstance(value, str) or not value.isprintable():
        raise DesignError(f"{path} is {value!r}: a text of one line of printable characters is needed")
    return value
