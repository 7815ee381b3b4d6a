"""Checks of the plain numbers in a design; each refusal names path, value, limit and cure."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import Field, fields
from functools import cache
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from bladewright.designs import ChordwiseLaw, Law, Limits, Part, Point, Points, Stations, unknown
from bladewright.errors import DesignError
from bladewright.section.laws import extremes_between, is_list, law_points, number_paths

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
"""Metres in one unit of length."""
NEAREST_STATIONS = 1e-6
"""Least distance of two stations, of the span: curves of the surfaces have knots there, which count as one below 1e-12,
and a spline's second derivative grows with the inverse square [-]"""


def number(path: str, value: Any) -> Any:
    """The value as a finite float, complex number or numeric array (a batch), or a refusal."""
    if type(value) is float and math.isfinite(value):
        # nearly every number, and a search checks millions
        return value
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
    """A number, a tuple of at least one number, or values at stations."""
    if isinstance(value, Stations | Mapping):
        return stations(path, value)
    return control_points(path, value)


def control_points(path: str, value: Any) -> float | tuple[float, ...]:
    """A number, or a tuple of at least one number."""
    if not is_sequence(value):
        return number(path, value)
    if len(value) == 0:
        raise DesignError(f"{path} is an empty list: give a number, or one control point or more from hub to shroud")
    return tuple(number(f"{path}[{i}]", item) for i, item in enumerate(value))


def stations(path: str, given: Any) -> Stations:
    """Values at stations, of a `Stations` or a table of its fields, which say each station's value."""
    known = [each.name for each in fields(Stations)]
    table = dict(given) if isinstance(given, Mapping) else vars(given)
    for name in table:
        if name not in known:
            raise DesignError(unknown(f"{path}.{name}", str(name), known))
    for name in ("span", "values"):
        if not is_sequence(table.get(name)):
            raise DesignError(f"{path}.{name} is {table.get(name)!r}: a list with a number for each station is needed")
    span = tuple(number(f"{path}.span[{i}]", each) for i, each in enumerate(table["span"]))
    values = tuple(number(f"{path}.values[{i}]", each) for i, each in enumerate(table["values"]))
    if len(span) < 2:
        raise DesignError(f"{path}.span has {len(span)} entries: give two stations or more, from 0 to 1, or one number")
    if any(np.iscomplexobj(each) or isinstance(each, np.ndarray) for each in span):
        raise DesignError(f"{path}.span is {span}: stations are plain real numbers, held while differentiating")
    if len(values) != len(span):
        raise DesignError(
            f"{path}.values has {len(values)} entries for the {len(span)} stations of its span: give one value for each"
        )
    if span[0] != 0.0 or span[-1] != 1.0:
        raise DesignError(
            f"{path}.span runs from {span[0]:g} to {span[-1]:g}: the first station must be 0, the hub, and the last 1, "
            "the shroud, for a law is never continued past its stations"
        )
    for i, step in enumerate(np.diff(span)):
        if step < NEAREST_STATIONS:
            raise DesignError(
                f"{path}.span[{i + 1}] is {span[i + 1]:g} after {span[i]:g}: stations must increase from hub to "
                f"shroud, by {NEAREST_STATIONS:g} of the span or more"
            )
    way = choice(f"{path}.interpolation", table.get("interpolation", "natural"), ["natural", "monotone", "linear"])
    return Stations(span=span, values=values, interpolation=way)  # type: ignore[arg-type]


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


def between(path: str, value: Any, low: float, high: float, what: str, *, closed: bool = False) -> None:
    """Refuse every number whose real part is not inside (low, high), or [low, high] where closed.

    `value` is a number, a law or a row of laws; what a law takes on between its stations is a number of it too.
    """
    for where, number, cure in _numbers(path, value):
        if type(number) is float and low < number < high:
            continue
        real = np.real(number)
        inside = (real >= low) & (real <= high) if closed else (real > low) & (real < high)
        if not np.all(inside):
            worst = float(np.ravel(real)[np.argmin(np.ravel(inside))])
            raise DesignError(f"{where} is {worst:g}{cure}: {what}")


def _numbers(path: str, value: Any) -> Iterator[tuple[str, Any, str]]:
    """Paths and numbers of a law or a row of laws, and what a refusal adds."""
    if any(map(is_list, value)) if isinstance(value, tuple) else False:
        for i, each in enumerate(value):
            yield from _numbers(f"{path}[{i}]", each)
        return
    yield from ((where, leaf, "") for where, leaf in zip(number_paths(value, path), law_points(value), strict=True))
    for v, extreme in extremes_between(value):
        cure = ' between its stations, which it passes: give it interpolation = "monotone", or other values'
        yield f"{path} at v = {v:.3g}", extreme, cure


def integer(path: str, value: Any, low: int, high: int, what: str) -> int:
    """A whole number within [low, high]."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
        raise DesignError(f"{path} is {value!r}: {what} ({low} to {high})")
    return int(value)


def parameters(part: Part, path: str = "") -> None:
    """Bring a part's laws, rows of laws and numbers to their kinds, and refuse those outside their fields' limits.

    `path` stands before the fields' names in a refusal, which names every field that is refused.
    """
    kind: Any = type(part)
    problems = list[str]()
    for each, kept in declared(kind):
        try:
            _keep(part, each, kept, path)
        except DesignError as error:
            problems += error.args
    if problems:
        raise DesignError(*problems)


def _keep(part: Part, each: Field[Any], kept: Callable[[str, Any], Any], path: str) -> None:
    """Bring a field to its kind, and refuse a value outside its limits."""
    value, where = getattr(part, each.name), f"{path}{each.name}"
    if value is None or (isinstance(value, tuple) and value == () == each.default):
        return
    value = kept(where, value)
    object.__setattr__(part, each.name, value)
    limits: Limits | None = each.metadata["limits"]
    if limits is not None:
        between(where, value, limits.low, limits.high, limits.cure, closed=limits.closed)


@cache
def declared(kind: Any) -> list[tuple[Field[Any], Callable[[str, Any], Any]]]:
    """The fields of a class that hold a law, a row of laws or a number, each with what brings a value to its kind."""
    found: list[tuple[Field[Any], Callable[[str, Any], Any]]] = []
    hints = get_type_hints(kind)
    of_law, of_row = get_type_hints(_Kinds).values()
    for each in fields(kind):
        hint = hints[each.name]
        optional = get_origin(hint) in (Union, UnionType)
        arms = {arm for arm in get_args(hint) if arm is not NoneType} if optional else {hint}
        if "unit" not in each.metadata:
            continue
        if arms == set(get_args(of_law)):
            found.append((each, law))
        elif arms <= {of_row, tuple[float, ...]}:
            found.append((each, chordwise))
        elif arms == {float}:
            found.append((each, number))
    return found


class _Kinds:
    """How a law and a row of laws are declared."""

    one: Law
    row: ChordwiseLaw


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
