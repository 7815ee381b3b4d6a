"""What every design is: a frozen record of plain numbers whose parameters have one dotted path each."""

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from bladewright.errors import DesignError


class Point(NamedTuple):
    """A control point of the meridional channel."""

    x: float
    """axial [length]"""
    r: float
    """radius, or span coordinate z of a linear cascade [length]"""


Points = tuple[Point, ...]
OF_LAW = "of the law"
"""The unit of a law's values at stations: that of the field that holds the law."""


class Limits(NamedTuple):
    """Between which values a parameter must lie."""

    low: float
    high: float
    cure: str
    """what a refusal says after the value"""
    closed: bool = False
    """whether the limits are allowed themselves"""


def parameter(unit: str, *, limits: Limits | None = None, **options: Any) -> Any:
    """A dataclass field whose numbers are differentiable parameters, measured in `unit`, within limits if given."""
    return field(metadata={"unit": unit, "limits": limits}, **options)


@dataclass(frozen=True, kw_only=True)
class Part:
    """A frozen record of parameters: validated on construction, addressed by dotted paths."""

    __pydantic_config__: ClassVar[dict[str, Any]] = {"extra": "forbid", "use_attribute_docstrings": True}
    """how a file is validated: unknown keys are refused, and the schema describes a field by its docstring"""

    inline: ClassVar[bool] = False
    """whether design files have it on one line, in the place of a number"""

    def control_places(self, row: str) -> Sequence[float] | None:  # noqa: ARG002 - most parts have them there
        """Places from the leading edge, 0, to the trailing edge, 1, of a row's control points, at mid-span.

        None where they are the Greville abscissae; empty where the row does not run along the chord.
        """
        return None

    def parameters(self) -> dict[str, float]:
        """Every differentiable leaf by its path, in the order of the fields, in the design's own units."""
        return dict(_leaves_of(self, ""))

    def changed(self, path: str | Mapping[str, Any], value: Any = None) -> Self:
        """A new design with another value at a path such as `stagger[1]`, or at several at once given as a mapping.

        Raises DesignError where the path does not exist or the value is refused.
        """
        return self._changed(path, value, replace)

    def stepped(self, path: str | Mapping[str, Any], value: Any = None) -> Self:
        """The same for values with the real parts that they have: what those have passed is not checked again."""
        return self._changed(path, value, _unchecked)

    def _changed(self, path: str | Mapping[str, Any], value: Any, made: Callable[..., Any]) -> Self:
        names = [each.name for each in fields(self)]
        put: dict[str, list[_Change]] = {}
        for where, what in ({path: value} if isinstance(path, str) else path).items():
            name, *rest = _steps(where) or ("",)
            name = str(name)
            if name not in names:
                raise DesignError(unknown(where, name, names))
            put.setdefault(name, []).append((rest, what, where))
        parts = {}
        for name, changes in put.items():
            with naming(name, getattr(self, name)):
                parts[name] = _with(getattr(self, name), changes, made)
        changed: Self = made(self, **parts)
        return changed


@dataclass(frozen=True, kw_only=True)
class Stations(Part):
    """A law of evolution along the span by its values at stations, each of which it meets.

    `interpolation` is "natural": the natural cubic spline; "monotone": a quintic spline that rises, falls and stays
    between stations as their values do; both with continuous curvature; or "linear": straight lines, with a crease at
    every station between hub and shroud.
    """

    inline: ClassVar[bool] = True

    span: tuple[float, ...]
    """span fractions of the stations, increasing from 0 at the hub to 1 at the shroud [-]"""
    values: tuple[float, ...] = parameter(OF_LAW)
    """the law's value at each station, in the unit of the law"""
    interpolation: Literal["natural", "monotone", "linear"] = "natural"
    """what lies between the stations"""


@dataclass(frozen=True)
class ByShape:
    """Annotates a number, a list or a table: a file's value is validated as what it is, so only its refusals are named.

    `table` is the part that a table is.
    """

    table: type[Part]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        from pydantic_core import core_schema

        kinds = {"number": float, "list": tuple[float, ...], self.table.__name__: self.table}
        choices = {name: handler.generate_schema(kind) for name, kind in kinds.items()}
        return core_schema.tagged_union_schema(choices, discriminator=self._shape)

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        """The three shapes as any other union."""
        return {"anyOf": handler(core)["oneOf"]}

    def _shape(self, value: Any) -> str:
        if isinstance(value, Mapping | self.table):
            return self.table.__name__
        return "list" if isinstance(value, list | tuple) else "number"


Law = Annotated[float | tuple[float, ...] | Stations, ByShape(Stations)]
"""A law of evolution along the span: a constant, control points from hub to shroud, or values at stations."""
ChordwiseLaw = tuple[Law, ...]
"""Control points along the chord, each a law of evolution along the span."""


@dataclass(frozen=True, kw_only=True)
class Design(Part, ABC):
    """Base of the families: a part that is built on its own."""

    dimension: ClassVar[int]
    """2 where the design builds a section in its plane, 3 where it builds a blade"""
    reference_length: ClassVar[str] = "chord"
    """name of the length that thicknesses and edge radii are fractions of"""
    has_planar_passage: ClassVar[bool] = False
    """whether the flow domain shown of a 2D design is curves in its plane instead of its prismatic passage"""

    @property
    def plain(self) -> Self:
        """The design of what is built before cuts and fillets: itself, where there are none."""
        return self

    @property
    def thickness_laws(self) -> Mapping[str, ChordwiseLaw]:
        """Half-thickness laws along the chord of the `upper` and the `lower` side, in families that have such laws."""
        return {}

    def exact(self) -> Any:
        """The exact outline of a section from which what needs no curves is quicker; None where there is no such."""
        return None

    @abstractmethod
    def build(self) -> Any:
        """The native geometry in metres and radians; the same design always builds the same.

        Raises DesignError where the shape is impossible.
        """


def unit_at(design: Part, path: str) -> str | None:
    """The unit of the field that holds a parameter, such as 'deg', or None where the path leads to none."""
    return _field_at(design, path).get("unit")


def limits_at(design: Part, path: str) -> Limits | None:
    """The limits of the field that holds a parameter, or None where it has none."""
    return _field_at(design, path).get("limits")


def _field_at(design: Part, path: str) -> Mapping[str, Any]:
    """What is known of the field that holds a parameter; nothing where the path leads to none."""
    node: Any = design
    found: Mapping[str, Any] = {}
    for step in _steps(path):
        if isinstance(node, Part) and isinstance(step, str):
            own: Mapping[str, Any] = next((f.metadata for f in fields(node) if f.name == step), {})
            found, node = found if own.get("unit") == OF_LAW else own, getattr(node, step, None)
        elif isinstance(node, tuple) and isinstance(step, int) and -len(node) <= step < len(node):
            node = node[step]
        else:
            break
    return found


def value_at(design: Part, path: str) -> Any:
    """What a design has at a path: a number, a text, a tuple, a part or None; DesignError where it does not exist."""
    node: Any = design
    for step in _steps(path):
        _check_step(node, step, path)
        node = getattr(node, step) if isinstance(step, str) else node[step]
    return node


def _leaves_of(node: Any, path: str) -> Iterator[tuple[str, Any]]:
    if isinstance(node, Part):
        for each in fields(node):
            if "unit" in each.metadata or isinstance(getattr(node, each.name), Part):
                yield from _leaves_of(getattr(node, each.name), f"{path}.{each.name}" if path else each.name)
    elif isinstance(node, Point):
        yield f"{path}.x", node.x
        yield f"{path}.r", node.r
    elif isinstance(node, tuple):
        for index, item in enumerate(node):
            yield from _leaves_of(item, f"{path}[{index}]")
    elif node is not None:
        yield path, node


_STEP = re.compile(r"\.?([A-Za-z_]\w*)|\[(-?\d+)\]")


@lru_cache(maxsize=4096)
def _steps(path: str) -> tuple[str | int, ...]:
    """The names and numbers that lead along a path."""
    steps: list[str | int] = []
    position = 0
    while position < len(path):
        match = _STEP.match(path, position)
        if match is None:
            message = f"the path '{path}' is not understood at '{path[position:]}': write it like stagger[1]"
            raise DesignError(f"{message} or channel.hub[0].x")
        steps.append(match[1] or int(match[2]))
        position = match.end()
    return tuple(steps)


_Change = tuple[Sequence[str | int], Any, str]
"""steps from a node, the value there, and the whole path"""


def _unchecked(part: Part, /, **changes: Any) -> Part:
    """The same as `replace`, without the checks of the constructor."""
    found = object.__new__(type(part))
    vars(found).update({name: value for name, value in vars(part).items() if name in part.__dataclass_fields__})
    vars(found).update(changes)
    return found


def _with(node: Any, changes: list[_Change], made: Callable[..., Any]) -> Any:
    """A node with several changes, of which later ones go before earlier ones; `made` makes changed parts."""
    for number in reversed(range(len(changes))):
        steps, value, _ = changes[number]
        if not steps:
            node, changes = value, changes[number + 1 :]
            break
    groups: dict[str | int, list[_Change]] = {}
    for steps, value, path in changes:
        step = steps[0]
        _check_step(node, step, path)
        place = step % len(node) if isinstance(step, int) else step
        place = Point._fields[place] if isinstance(node, Point) and isinstance(place, int) else place
        groups.setdefault(place, []).append((steps[1:], value, path))
    if not groups:
        return node
    if isinstance(node, tuple) and not isinstance(node, Point):
        return tuple(_with(item, groups[place], made) if place in groups else item for place, item in enumerate(node))
    parts: dict[str, Any] = {}
    for step, group in groups.items():
        part = getattr(node, str(step))
        with naming(str(step), part):
            parts[str(step)] = _with(part, group, made)
    return node._replace(**parts) if isinstance(node, Point) else made(node, **parts)


def _check_step(node: Any, step: str | int, path: str) -> None:
    """Refuse a step that leads nowhere."""
    if isinstance(node, Part | Point) and isinstance(step, str):
        names = Point._fields if isinstance(node, Point) else node.__dataclass_fields__
        if step not in names:
            raise DesignError(unknown(path, step, [*names]))
        return
    if isinstance(node, tuple) and isinstance(step, int):
        if not -len(node) <= step < len(node):
            raise DesignError(f"{path} does not exist: it has {len(node)} entries, 0 to {len(node) - 1}")
        return
    if isinstance(node, Stations):
        raise DesignError(f"{path} does not exist: the law is given at stations; write .values[{step}] there")
    if node is None:
        raise DesignError(
            f"{path} does not exist: nothing is given before '{step}'; give the whole table or list there"
        )
    kind = "a single number" if not isinstance(node, tuple | Part) else "a list"
    raise DesignError(f"{path} does not exist: what stands before '{step}' is {kind}; see design.parameters()")


def whole_path(path: str, message: str, part: Any) -> str:
    """A message about the part at a path, with that path before the name of a field or of the part at its beginning.

    A message that begins with neither is returned as it is.
    """
    own = re.sub(r"\[\d+\]$", "", path).rpartition(".")[2]
    if re.match(rf"{re.escape(own)}\b", message):
        return path + message.removeprefix(own)
    first = re.match(r"\w+", message)
    names = [each.name for each in fields(part)] if is_dataclass(part) else []
    return f"{path}.{message}" if first and first[0] in names else message


@contextmanager
def naming(path: str, part: Any) -> Iterator[None]:
    """A context in which every DesignError about a part gets the `whole_path`."""
    try:
        yield
    except DesignError as error:
        raise DesignError(*(whole_path(path, str(each), part) for each in error.args)) from error


def unknown(path: str, name: str, known: list[str]) -> str:
    """The message for a name that does not exist, with the nearest that does."""
    from difflib import get_close_matches

    near = get_close_matches(name, known, n=1, cutoff=0.61)
    hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)}"
    said = "" if re.search(rf"(^|\W){re.escape(name)}\W*$", path) else f": there is no '{name}'"
    return f"{path} does not exist{said}; {hint}"
