"""What a study looks at: figures of what a design builds, by name or by a function of the user."""

from __future__ import annotations

import importlib.util
import inspect
import math
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar, final

import numpy as np

from bladewright.derivatives.quantities import AREAS, BLADE, OTHER_NAMES, SECTION, NamedQuantity
from bladewright.designs import Design, unknown
from bladewright.errors import BladewrightError, StudyError
from bladewright.numerics.elementary import Array
from bladewright.section.checks import UNITS
from bladewright.section.station_table import COLUMNS, IN_SPACE

MIDDLE = 0.5
"""Where a column of the station table is taken that names no place: mid-span."""
OF_WHEEL = ("volume", "mass", "moment-of-inertia")
"""Quantities of a blade that its wheel has as well, as `wheel-mass`."""
COMPONENTS: Mapping[tuple[int, ...], tuple[str, ...]] = {
    (3,): ("x", "y", "z"),
    (3, 3): ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"),
}
"""What the entries of vectors and tensors are called."""


@final
class BuiltDesign:
    """A design and what it builds; what several quantities need of it is worked out once.

    Where no quantity needs curves, it may have the exact `outline` of a section in their place.
    """

    def __init__(self, design: Any, built: Any, outline: Any = None) -> None:
        self.design, self.built, self.outline = design, built, outline
        self._found: dict[Any, Any] = {}

    def once(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """What `make` gives or raises, which is called but once for each key."""
        if key not in self._found:
            try:
                self._found[key] = make()
            except BladewrightError as error:
                self._found[key] = error
        if isinstance(self._found[key], BladewrightError):
            raise self._found[key]
        return self._found[key]

    def stations(self, span: float) -> Any:
        """The station table at a place along the span; that of a section, which has no span."""
        in_space = self.design.dimension == 3
        return self.once(span, lambda: self.built.report([span]) if in_space else self.built.report())

    @cached_property
    def passage(self) -> Any:
        """The flow passage around the blade."""
        from bladewright.domain.build import passage

        return passage(self.built)

    @cached_property
    def wheel(self) -> Any:
        """The wheel of the blade."""
        from bladewright.domain.wheel import wheel

        return wheel(self.built)


@dataclass(frozen=True, kw_only=True)
class Quantity(ABC):
    """A figure of a run, or several."""

    name: str
    """by which the manifest has it; that of the design and a colon before it where a study has several"""
    design: str | None = None
    """of which design of the study; None: of all of them together"""
    needs_curves: ClassVar[bool] = True
    """whether the exact outline of a section does not serve it"""

    @abstractmethod
    def of(self, built: Mapping[str, BuiltDesign]) -> Any:
        """Its value, or several by name, of what the designs of a run build.

        Lengths are in the design's own unit, angles in degrees, masses in kilograms; complex where a build carries a
        step.
        """

    def unit(self, designs: Mapping[str, Design]) -> str:  # noqa: ARG002 - what a user's function returns is unknown
        """Unit of the value, empty where none is known."""
        return ""

    @property
    def source(self) -> str:
        """Digest of the user's code that finds it, by which an edit is noticed; empty where there is none."""
        return ""


@dataclass(frozen=True, kw_only=True)
class NamedFigure(Quantity):
    """A property of what is built, or a column of its station table at a place along the span."""

    quantity: str
    """as `quantity_names` has it"""
    span: float | None = None
    """the place, where one is named"""
    design: str

    def of(self, built: Mapping[str, BuiltDesign]) -> Array:
        own = built[self.design]
        return self._of(own) * _factor(self.unit({self.design: own.design}), own.design.length_unit)

    def _of(self, own: BuiltDesign) -> Array:
        """The value in metres and radians."""
        kind = self._kind(own.design)
        if kind is not None:
            return np.asarray(kind.of(own.built))
        if self.quantity == "passage-volume":
            return np.asarray(own.passage.properties.volume)
        if self.quantity.startswith("wheel-"):
            return np.asarray(BLADE[self.quantity.removeprefix("wheel-")].of(own.wheel))
        value = np.asarray(getattr(own.stations(_place(self.span)), _column(self.quantity)))
        return value if self.quantity in AREAS else value[0]

    def unit(self, designs: Mapping[str, Design]) -> str:
        design: Any = designs[self.design]
        of_wheel = self.quantity.removeprefix("wheel-")
        kind = self._kind(design) if of_wheel == self.quantity else BLADE[of_wheel]
        if self.quantity in AREAS:
            return f"{design.length_unit}2"
        if self.quantity == "passage-volume":
            return f"{design.length_unit}3"
        if kind is not None:
            power = kind.power
            return kind.unit or (f"{design.length_unit}{power if power > 1 else ''}" if power else "-")
        linear = design.dimension == 3 and design.arrangement == "linear"
        unit = "length" if self.quantity == "wrap" and linear else COLUMNS[_column(self.quantity)]
        return str(design.length_unit) if unit == "length" else unit

    def _kind(self, design: Design) -> NamedQuantity | None:
        """The property of the whole; None where it is a column of the station table."""
        return None if self.span is not None else _whole(design).get(self.quantity)


@dataclass(frozen=True, kw_only=True)
class UserFunction(Quantity):
    """A function of what is built: of the blade or section, or of all of them by the designs' names."""

    function: str | Callable[..., Any]
    """the function, or MODULE:FUNCTION where it is imported from"""
    folder: str = "."
    """where modules are looked for before Python's own path"""

    def of(self, built: Mapping[str, BuiltDesign]) -> Any:
        function = self._function
        if self.design is not None:
            return function(built[self.design].built)
        return function({name: each.built for name, each in built.items()})

    @property
    def source(self) -> str:
        return digest(self._function)

    @property
    def _function(self) -> Callable[..., Any]:
        return self.function if callable(self.function) else imported(self.function, self.folder)


def quantities_of(asked: object, designs: Mapping[str, Design], folder: str | Path = ".") -> list[Quantity]:
    """The quantities that a study asks for by a name, by MODULE:FUNCTION, or by a function itself.

    A name is one of `quantity_names`; `NAME@0.3` is a column of the station table at that span fraction, at mid-span
    where none is given, and `rotor:NAME` is that of one of several designs. Raises StudyError where there is none.
    """
    alone = next(iter(designs)) if len(designs) == 1 else None
    if callable(asked):
        return [UserFunction(name=getattr(asked, "__name__", "function"), design=alone, function=asked)]
    if not isinstance(asked, str):
        raise StudyError(f"a quantity is {asked!r}: give a name such as 'volume', MODULE:FUNCTION, or a function")
    prefix, sign, rest = asked.partition(":")
    if sign and prefix not in designs:
        imported(asked, str(folder))
        return [UserFunction(name=rest, design=alone, function=asked, folder=str(folder))]
    own = [prefix] if sign else list(designs)
    return [_named(rest if sign else asked, each, len(designs) > 1, designs[each]) for each in own]


def quantity_names(design: Design) -> list[str]:
    """The names of the quantities that a design's kind may have."""
    columns = [name for name in COLUMNS if name != "span" and (design.dimension == 3 or name not in IN_SPACE)]
    if design.dimension == 2:
        return [*_whole(design), *columns]
    wheel = [f"wheel-{each}" for each in OF_WHEEL]
    return [*_whole(design), "passage-volume", *wheel, *OTHER_NAMES, *AREAS, *columns]


def figures(value: Any, name: str) -> dict[str, Any]:
    """The numbers of a quantity by name: one, components such as `centroid.x`, or those that a function has named."""
    if isinstance(value, Mapping):
        return {str(key): item for key, item in value.items()}
    entries = np.asarray(value)
    if entries.ndim == 0:
        return {name: entries[()]}
    words = COMPONENTS.get(entries.shape, [str(place) for place in range(entries.size)])
    return {f"{name}.{word}": entry for word, entry in zip(words, entries.ravel(), strict=True)}


def imported(function: str, folder: str) -> Callable[..., Any]:
    """The function of MODULE:FUNCTION, of which MODULE may be a file in `folder`; StudyError where there is none.

    A file that was edited is imported again.
    """
    module_name = function.partition(":")[0]
    file = Path(folder) / (module_name if module_name.endswith(".py") else f"{module_name}.py")
    return _imported(function, file, file.stat().st_mtime_ns if file.is_file() else None)


def digest(function: Callable[..., Any]) -> str:
    """A digest of the file that defines a function, or of its own lines in a script; empty where they are unknown."""
    try:
        file = inspect.getsourcefile(function)
        alone = file is None or function.__module__ == "__main__"
        text = inspect.getsource(function).encode() if alone else Path(str(file)).read_bytes()
    except (OSError, TypeError, AttributeError):
        return ""
    return sha256(text).hexdigest()[:16]


@cache
def _imported(function: str, file: Path, edited: int | None) -> Callable[..., Any]:
    module_name, _, name = function.partition(":")
    try:
        module = _module(file) if edited is not None else importlib.import_module(module_name)
    except StudyError:
        raise
    except ModuleNotFoundError as error:
        missing = f"there is no module '{error.name}'"
        where = f", nor a file '{file}'" if error.name == module_name else f", which '{file}' imports"
        raise StudyError(f"the quantity '{function}': {missing}{where}") from error
    except Exception as error:
        raise StudyError(f"the quantity '{function}': importing it raised {type(error).__name__}: {error}") from error
    found = getattr(module, name, None)
    if not callable(found):
        known = [each for each, value in vars(module).items() if callable(value) and not each.startswith("_")]
        raise StudyError(f"the quantity '{function}': {unknown(f'the function {name!r}', name, known or ['none'])}")
    return found


def _module(file: Path) -> ModuleType:
    """The module in a file, which may import its neighbours."""
    spec = importlib.util.spec_from_file_location(file.stem, file)
    if spec is None or spec.loader is None:
        raise StudyError(f"'{file}' is no module of Python")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(file.parent))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(file.parent))
    return module


def _named(asked: str, name: str, several: bool, design: Design) -> NamedFigure:
    base, sign, place = asked.partition("@")
    span = None
    if sign:
        try:
            span = float(place)
        except ValueError:
            span = np.nan
        if not 0.0 <= span <= 1.0:
            raise StudyError(f"the quantity '{asked}' is at span '{place}': give a fraction from 0 to 1, as {base}@0.5")
    known = quantity_names(design)
    columns = {*COLUMNS, *OTHER_NAMES} if sign else set(known)
    quantity = next((each for each in (base, base.replace("_", "-"), base.replace("-", "_")) if each in known), base)
    if quantity not in known:
        raise StudyError(unknown(f"the quantity '{asked}'", base, known))
    if quantity not in columns:
        raise StudyError(f"the quantity '{asked}': {base} is of the whole blade, so leave '@{place}' out")
    return NamedFigure(name=f"{name}:{asked}" if several else asked, design=name, quantity=quantity, span=span)


def _whole(design: Design) -> dict[str, NamedQuantity]:
    """Properties of the whole."""
    known = BLADE if design.dimension == 3 else SECTION
    return {name: each for name, each in known.items() if not each.points}


def _column(quantity: str) -> str:
    return OTHER_NAMES.get(quantity, quantity)


def _place(span: float | None) -> float:
    return MIDDLE if span is None else span


def _factor(unit: str, length_unit: str) -> float:
    """What converts metres and radians."""
    if unit == "deg":
        return math.degrees(1.0)
    power = unit.removeprefix(length_unit)
    if not unit.startswith(length_unit) or power not in {"", "2", "3", "5"}:
        return 1.0
    return float(UNITS[length_unit] ** -int(power or 1))
