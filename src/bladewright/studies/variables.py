"""What a study varies: numbers and choices of its designs, by dotted paths or patterns of paths."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from bladewright.derivatives.patterns import matching
from bladewright.designs import Design, value_at
from bladewright.errors import DesignError, StudyError

STRICT: Mapping[str, Any] = {"extra": "forbid"}
"""How the tables of a study file are validated: unknown keys are refused."""
Target = tuple[str, str]
"""The name of a design in the study, and a path in it."""


@dataclass(frozen=True, kw_only=True)
class Range:
    """What a variable may be, as a study file states it: from `lower` to `upper`, or one of `values`."""

    __pydantic_config__: ClassVar[Mapping[str, Any]] = STRICT

    lower: float | None = None
    """lowest value, in the unit of the parameter"""
    upper: float | None = None
    """highest value"""
    values: tuple[Any, ...] = ()
    """the choices: numbers, texts or lists"""
    count: int | None = None
    """how many values between `lower` and `upper` a grid takes"""
    relative: bool = False
    """whether these are factors of the design's own value"""
    offset: bool = False
    """whether these are added to the design's own value"""
    together: bool = False
    """whether the parameters that a pattern matches are one variable; otherwise each is a variable of its own"""


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One variable of a study, which sets one or several parameters."""

    name: str
    """the path that it sets, or the pattern of those that it sets together; `NAME:` of one of several designs before"""
    targets: tuple[Target, ...]
    """the parameters that it sets"""
    lower: float | None = None
    """lowest value, in the unit of the parameter, unless `relative`"""
    upper: float | None = None
    """highest value"""
    values: tuple[Any, ...] = ()
    """its choices, where it has no bounds"""
    count: int | None = None
    """how many values a grid takes"""
    relative: bool = False
    """whether its value is a factor of what each parameter is in its design"""
    offset: bool = False
    """whether its value is added to that"""
    whole: bool = False
    """whether its values are whole numbers"""
    start: Any = None
    """its value in the design of the study"""

    @property
    def continuous(self) -> bool:
        """Whether it may have every value between its bounds."""
        return self.lower is not None and not self.whole

    def at(self, fraction: float) -> Any:
        """Its value at a fraction from 0 to 1 of its range, of which each choice has an equal share."""
        if self.continuous:
            return self._low + fraction * (self._high - self._low)
        choices = self.choices
        return choices[min(int(fraction * len(choices)), len(choices) - 1)]

    @cached_property
    def choices(self) -> tuple[Any, ...]:
        """Its values on a grid; StudyError where it is continuous and has no `count`."""
        if self.values:
            return self.values
        if self.whole and self.count is None:
            return tuple(range(int(self._low), int(self._high) + 1))
        if self.count is None:
            raise StudyError(
                f"variable '{self.name}' has bounds but no count, and a grid needs one: write count = 5 beside them, "
                "or give values"
            )
        places = np.linspace(self._low, self._high, self.count)
        return tuple(dict.fromkeys(round(place) if self.whole else float(place) for place in places))

    def changes(self, designs: Mapping[str, Design], value: Any) -> dict[str, dict[str, Any]]:
        """What a value of it changes, by design and path."""
        found: dict[str, dict[str, Any]] = {}
        for design, path in self.targets:
            own = value_at(designs[design], path) if self.relative or self.offset else None
            new = own * value if self.relative else own + value if self.offset else _as_tuples(value)
            found.setdefault(design, {})[path] = new
        return found

    @property
    def _low(self) -> float:
        return 0.0 if self.lower is None else self.lower

    @property
    def _high(self) -> float:
        return 0.0 if self.upper is None else self.upper


def changed_designs(
    designs: Mapping[str, Design], variables: Sequence[Variable], parameters: Mapping[str, Any]
) -> dict[str, Design]:
    """The designs with the values of variables, which `parameters` gives by name.

    Raises DesignError where a design refuses a value.
    """
    changes: dict[str, dict[str, Any]] = {name: {} for name in designs}
    for variable in variables:
        for design, own in variable.changes(designs, parameters[variable.name]).items():
            changes[design] |= own
    return {name: design.changed(changes[name]) if changes[name] else design for name, design in designs.items()}


def resolved(ranges: Mapping[str, Range], designs: Mapping[str, Design]) -> tuple[Variable, ...]:
    """The variables that paths and patterns stand for in the designs of a study, in their order.

    A path with `NAME:` before it is of that design; without, of every design that has it. What is relative to one
    parameter is given as that parameter's values, so that a run's parameters are what `--set` takes. Raises StudyError
    where no design has a path, a range is none, or two variables set the same parameter.
    """
    found: list[Variable] = []
    taken: dict[Target, str] = {}
    for name, given in ranges.items():
        _check_range(name, given)
        for variable in _variables(name, given, designs):
            for target in variable.targets:
                if target in taken:
                    raise StudyError(
                        f"variables '{taken[target]}' and '{name}' both set {target[1]}: leave it out of one of them"
                    )
                taken[target] = name
            found.append(variable)
    if not found:
        raise StudyError("the study varies nothing: give at least one variable, such as 'stagger[1]', with its bounds")
    return tuple(found)


def _variables(name: str, given: Range, designs: Mapping[str, Design]) -> list[Variable]:
    targets = _targets(name, designs)
    if given.together:
        return [_variable(name, tuple(targets), given, designs)]
    if ":" in name:
        prefix = name.partition(":")[0]
        return [_variable(f"{prefix}:{path}", ((design, path),), given, designs) for design, path in targets]
    paths = dict.fromkeys(path for _, path in targets)
    return [_variable(path, tuple(each for each in targets if each[1] == path), given, designs) for path in paths]


def _targets(name: str, designs: Mapping[str, Design]) -> list[Target]:
    """The parameters that a path or a pattern stands for."""
    prefix, sign, pattern = name.rpartition(":")
    if sign and prefix not in designs:
        raise StudyError(f"variable '{name}': the study has no design '{prefix}'; it has {', '.join(designs)}")
    found: list[Target] = []
    refusals: list[str] = []
    for design in [prefix] if sign else designs:
        try:
            found += [(design, path) for path in _paths(designs[design], pattern)]
        except DesignError as error:
            refusals.append(str(error))
    if not found:
        raise StudyError(f"variable '{name}': {refusals[0]}")
    return found


def _paths(design: Design, pattern: str) -> list[str]:
    parameters = design.parameters()
    if pattern in parameters or "*" in pattern or "?" in pattern:
        return matching(pattern, parameters)
    value_at(design, pattern)  # a field that is no parameter, such as blade_count
    return [pattern]


def _variable(name: str, targets: tuple[Target, ...], given: Range, designs: Mapping[str, Design]) -> Variable:
    """A variable of parameters; relative to one parameter, its range becomes that of its values."""
    own = [value_at(designs[design], path) for design, path in targets]
    numbers = [value for value in own if isinstance(value, int | float) and not isinstance(value, bool)]
    if (given.relative or given.offset) and len(numbers) < len(own):
        path = targets[[value in numbers for value in own].index(False)][1]
        word = "relative" if given.relative else "offset"
        raise StudyError(f"variable '{name}' is {word}, and {path} is no number in the design: give values themselves")
    listed = [value for value in own if isinstance(value, tuple)]
    if given.lower is not None and listed:
        raise StudyError(f"variable '{name}' has bounds and is a list: write '{name}[*]' for its numbers")
    lower, upper, values, relative, offset = given.lower, given.upper, given.values, given.relative, given.offset
    start: Any = own[0]
    if len(own) == 1 and (relative or offset):
        factor, shift = (own[0], 0.0) if relative else (1.0, own[0])
        if lower is not None and upper is not None:
            lower, upper = sorted((lower * factor + shift, upper * factor + shift))
        if lower == upper and not values:
            raise StudyError(f"variable '{name}' is relative to 0, of which every factor is 0: write offset = true")
        values, relative, offset = tuple(value * factor + shift for value in values), False, False
    elif relative or offset:
        start = 1.0 if relative else 0.0
    whole = lower is not None and not relative and all(type(value) is int for value in own)
    if whole and not (float(lower or 0).is_integer() and float(upper or 0).is_integer()):
        raise StudyError(f"variable '{name}' is a whole number: its bounds {lower:g} and {upper:g} must be, too")
    return Variable(
        name=name,
        targets=targets,
        lower=lower,
        upper=upper,
        values=values,
        count=given.count,
        relative=relative,
        offset=offset,
        whole=whole,
        start=start,
    )


def _check_range(name: str, given: Range) -> None:
    """Refuse what is no range."""
    if given.values and (given.lower is not None or given.upper is not None):
        raise StudyError(f"variable '{name}' has both bounds and values: leave one of them out")
    if given.relative and given.offset:
        raise StudyError(f"variable '{name}' is both relative and offset: leave one of them out")
    if given.values:
        return
    if given.lower is None or given.upper is None:
        missing = [word for word in ("lower", "upper") if getattr(given, word) is None]
        raise StudyError(f"variable '{name}' has no {' and no '.join(missing)}: give lower and upper, or values")
    if not (np.isfinite(given.lower) and np.isfinite(given.upper)):
        raise StudyError(f"variable '{name}' goes from {given.lower:g} to {given.upper:g}: give finite bounds")
    if given.lower >= given.upper:
        raise StudyError(
            f"variable '{name}' goes from lower = {given.lower:g} to upper = {given.upper:g}: lower must be below upper"
            + ("; change them round" if given.lower > given.upper else "")
        )
    if given.count is not None and given.count < 2:
        raise StudyError(f"variable '{name}' has count = {given.count}: a grid takes at least 2 values between bounds")


def _as_tuples(value: Any) -> Any:
    """Lists of a file as designs have them."""
    return tuple(_as_tuples(item) for item in value) if isinstance(value, list | tuple) else value
