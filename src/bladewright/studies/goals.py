"""What a search is after: the table `[optimise]` with its objectives and constraints, and what they are in figures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from bladewright.designs import unknown
from bladewright.errors import StudyError
from bladewright.nurbs.basis import Reals
from bladewright.studies.variables import STRICT

Method = Literal["slsqp", "trust-constr", "nsga2"]
Count = Annotated[int, Field(ge=1)]


@dataclass(frozen=True, kw_only=True)
class Objective:
    """A figure that is to be small, or large."""

    __pydantic_config__: ClassVar[Mapping[str, Any]] = STRICT

    quantity: Any
    """a name, MODULE:FUNCTION, or a function"""
    figure: str | None = None
    """which figure of the quantity, where it has several"""
    maximise: bool = False
    """whether it is to be large"""
    adjoint: bool = False
    """whether the function returns its derivatives by points of the surfaces, too"""


@dataclass(frozen=True, kw_only=True)
class Constraint:
    """A figure, or all figures of a quantity, between limits; equal limits hold it."""

    __pydantic_config__: ClassVar[Mapping[str, Any]] = STRICT

    quantity: Any
    """a name, MODULE:FUNCTION, or a function"""
    figure: str | None = None
    """which figure of the quantity; all of them where None"""
    lower: float | None = None
    """lowest value, in the unit of the figure"""
    upper: float | None = None
    """highest value"""
    relative: bool = False
    """whether the limits are factors of the figure of the design that the search begins with"""
    adjoint: bool = False
    """whether the function returns its derivatives by points of the surfaces, too"""


@dataclass(frozen=True, kw_only=True)
class SearchOptions:
    """How a search searches: the table `[optimise]`."""

    __pydantic_config__: ClassVar[Mapping[str, Any]] = STRICT

    objectives: tuple[Objective, ...]
    """what is to be small or large"""
    constraints: tuple[Constraint, ...] = ()
    """what is kept between limits"""
    method: Method | None = None
    """how it searches; None: slsqp for one objective, nsga2 for several"""
    tolerance: Annotated[float, Field(gt=0.0)] = 1e-6
    """of a search with derivatives: largest residual of the KKT conditions, and largest violation of a constraint"""
    iterations: Count = 200
    """of a search with derivatives: most iterations in a round"""
    members: Annotated[int, Field(ge=2)] = 15
    """of a front with derivatives: number of its designs"""
    population: Annotated[int, Field(ge=4)] = 100
    """of nsga2: designs in a generation"""
    generations: Count = 40
    """of nsga2"""
    seed: Annotated[int, Field(ge=0)] = 1
    """of nsga2's random numbers: the same seed gives the same search"""
    time_limit: Annotated[float, Field(gt=0.0)] | None = None
    """of nsga2: longest time of a run [s]"""


@dataclass(frozen=True, kw_only=True)
class Aim:
    """A figure that is to be small, or large."""

    figure: str
    maximise: bool
    size: float
    """by which it is divided in a search with derivatives"""

    def cost(self, figures: Mapping[str, Any]) -> Any:
        """What is to be small, of figures or of their derivatives."""
        value = figures[self.figure]
        return -value if self.maximise else value


@dataclass(frozen=True, kw_only=True)
class Limit:
    """A figure between limits, of which one may be infinite."""

    figure: str
    lower: float
    upper: float
    size: float
    """by which it is divided in a search with derivatives"""

    @property
    def equal(self) -> bool:
        """Whether it holds the figure."""
        return self.lower == self.upper

    def excess(self, figures: Mapping[str, float]) -> float:
        """By how much the figure lies outside the limits, in sizes."""
        value = figures[self.figure]
        return max(self.lower - value, value - self.upper, 0.0) / self.size


@dataclass(frozen=True, kw_only=True)
class Goals:
    """Aims and limits by the figures' names."""

    aims: tuple[Aim, ...]
    limits: tuple[Limit, ...]

    def costs(self, figures: Mapping[str, float]) -> Reals:
        """(k,) what is to be small."""
        return np.array([aim.cost(figures) for aim in self.aims])

    def excesses(self, figures: Mapping[str, float]) -> Reals:
        """(m,) by how much figures lie outside their limits, in sizes."""
        return np.array([limit.excess(figures) for limit in self.limits])


def entry_of(kind: type[Any], given: Any) -> Any:
    """An objective or a constraint as Python gives it."""
    if isinstance(given, kind):
        return given
    if not isinstance(given, Mapping):
        return kind(quantity=given)
    try:
        return kind(**given)
    except TypeError as error:
        known = ", ".join(each.name for each in fields(kind))
        raise StudyError(
            f"{kind.__name__.lower()} {dict(given)!r} is not understood ({error}); keys are {known}"
        ) from error


def entry_keys(entry: Objective | Constraint) -> dict[str, Any]:
    """An entry as a manifest has it, where functions are known by their names."""
    asked = entry.quantity
    if callable(asked):
        asked = f"{asked.__module__}:{getattr(asked, '__qualname__', type(asked).__qualname__)}"
    return {**asdict(replace(entry, quantity=None)), "quantity": asked}


def goals_of(search: SearchOptions, names: Mapping[int, Sequence[str]], figures: Mapping[str, float]) -> Goals:
    """The goals of a search; `names` are the figures of each of its entries, `figures` those that it begins with.

    Entries are numbered through the objectives, then through the constraints. Raises StudyError where an entry names no
    figure, or a constraint no limit.
    """
    aims = []
    for place, objective in enumerate(search.objectives):
        known = _chosen(objective, names[place], f"objective {place + 1}")
        if len(known) > 1:
            raise StudyError(
                f"objective {place + 1} has {len(known)} figures, {', '.join(known[:6])}: name one, as figure = "
                f'"{known[0]}"'
            )
        aims.append(Aim(figure=known[0], maximise=objective.maximise, size=_size(figures[known[0]])))
    limits = []
    for place, constraint in enumerate(search.constraints):
        word = f"constraint {place + 1}"
        chosen = _chosen(constraint, names[len(search.objectives) + place], word)
        limits += [_limit(constraint, figure, figures[figure], word) for figure in chosen]
    return Goals(aims=tuple(aims), limits=tuple(limits))


def _chosen(entry: Objective | Constraint, names: Sequence[str], word: str) -> Sequence[str]:
    if entry.figure is None:
        return names
    if entry.figure not in names:
        raise StudyError(f"{word}: {unknown(f'the figure {entry.figure!r}', entry.figure, list(names))}")
    return [entry.figure]


def _limit(entry: Constraint, figure: str, own: float, word: str) -> Limit:
    if entry.lower is None and entry.upper is None:
        raise StudyError(f"{word}, on {figure}, has no limit: give lower, upper or both, as lower = {own:.4g}")
    factor = own if entry.relative else 1.0
    given = [-math.inf if entry.lower is None else entry.lower, math.inf if entry.upper is None else entry.upper]
    if given[0] > given[1]:
        raise StudyError(
            f"{word}, on {figure}, goes from lower = {given[0]:g} to upper = {given[1]:g}: lower must not be above "
            "upper; change them round"
        )
    low, high = sorted(factor * value for value in given)
    sizes = [abs(value) for value in (low, high) if math.isfinite(value)]
    return Limit(figure=figure, lower=low, upper=high, size=_size(max([*sizes, abs(own)])))


def _size(value: float) -> float:
    return abs(value) or 1.0
