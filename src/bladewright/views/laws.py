"""The laws of a design as panels of those that vary along the span, and a table of those that do not."""

from collections.abc import Callable, Sequence
from dataclasses import MISSING, fields
from typing import Any, NamedTuple, get_args, get_origin, get_type_hints

from bladewright.designs import Law, Part, Stations
from bladewright.section.laws import law_points, places_of
from bladewright.section.profiles.profile import PublishedProfile

MAX_CONTROL_POINTS = 16
"""Most control points along the chord of a row of laws that gets a panel. A legend of more covers other panels; such
rows are the points of a given profile, which say nothing as laws."""
VALUES_ACROSS = 5
"""Values of a row of constants on a line."""
OF_MAXIMUM = "maximum thickness"
"""What the trailing edge of a published profile is measured in."""


class Panel(NamedTuple):
    """Laws of one unit in one panel."""

    title: str
    abscissa: str
    factor: float
    """what values are multiplied by to be in the unit of the abscissa"""
    laws: dict[str, Law]
    """laws by their name in the legend"""


class Constant(NamedTuple):
    """A number, or a row of numbers along the chord, that is the same all along the span."""

    name: str
    values: tuple[float, ...]
    """in the unit"""
    unit: str
    default: bool
    """whether the family gives it where a design does not"""


class _Kind(NamedTuple):
    """What the laws of a panel measure."""

    title: str
    abscissa: str
    factor: float
    holds: Callable[[str, str], bool]
    """whether a law of this name and unit belongs here"""


_KINDS = (
    _Kind("Angles", "angle [deg]", 1.0, lambda _, unit: unit == "deg"),
    _Kind("Leading edge position", "y [{unit}]", 1.0, lambda name, _: name == "leading_edge_y"),
    _Kind("Lengths", "length [{unit}]", 1.0, lambda _, unit: unit == "length"),
    _Kind("Camber tangents", "length [% of extent]", 100.0, lambda name, _: name.startswith("tangent_")),
    _Kind("Tangents", "length [% of chord]", 100.0, lambda name, _: "_tangent_" in name),
    _Kind("Edge radii", "radius [% of {length}]", 100.0, lambda name, _: name.endswith("_edge_radius")),
    _Kind("Half thickness", "control point [% of {length}]", 100.0, lambda name, _: name.startswith("thickness_")),
    _Kind("Trailing edge", "thickness [% of maximum]", 100.0, lambda _, unit: unit == OF_MAXIMUM),
    _Kind("Thickness", "thickness [% of chord]", 100.0, lambda name, _: name.endswith("thickness")),
    _Kind("Weights", "control point [-]", 1.0, lambda name, _: name.startswith("weights_")),
    _Kind("Places", "place [% of chord]", 100.0, lambda name, _: name.endswith(("_at", "_position"))),
)
"""Kinds of laws; the first that a law belongs to is taken."""
_REST = _Kind("Further parameters", "value [-]", 1.0, lambda *_: True)
"""The kind of a law that belongs to no other."""


class _Single(NamedTuple):
    """A law along the span."""

    name: str
    unit: str
    law: Law
    default: bool


class _Row(NamedTuple):
    """Control points along the chord, each a law along the span."""

    name: str
    unit: str
    laws: tuple[Law, ...]
    places: tuple[float, ...]
    """from the leading edge, 0, to the trailing edge, 1; none where the row does not run along the chord"""


def panels_of(design: Any) -> list[Panel]:
    """The laws of a blade's design that vary along the span, grouped by what they measure."""
    single, rows = _laws(design)
    panels: dict[str, Panel] = {}

    def add(kind: _Kind, title: str, name: str, law: Law) -> None:
        panel = panels.setdefault(title, Panel(title, _abscissa(kind, design), kind.factor, {}))
        while name in panel.laws:
            name += ", again"
        panel.laws[name] = law

    for each in single:
        if _varies(each.law):
            kind = _kind_of(each.name, each.unit)
            add(kind, kind.title, each.name.replace("_", " "), each.law)
    for row in rows:
        if len(row.laws) > MAX_CONTROL_POINTS or not any(_varies(law) for law in row.laws):
            continue
        kind, side = _kind_of_row(row)
        for name, law in zip(place_names(row.places, len(row.laws)), row.laws, strict=True):
            add(kind, kind.title, f"{side}, {name}" if side else name, law)
    order = [kind.title for kind in (*_KINDS[:-2], _REST)]
    return sorted(panels.values(), key=lambda panel: order.index(panel.title) if panel.title in order else len(order))


def constants_of(design: Any) -> list[Constant]:
    """The laws of a blade's design that are the same all along the span, and the rows of such laws."""
    single, rows = _laws(design)
    found = []
    for each in single:
        if not _varies(each.law):
            kind = _kind_of(each.name, each.unit)
            value = kind.factor * float(law_points(each.law)[0])
            found.append(Constant(each.name.replace("_", " "), (value,), _unit_of(kind, design), each.default))
    for row in rows:
        if len(row.laws) <= MAX_CONTROL_POINTS and not any(_varies(law) for law in row.laws):
            kind, _ = _kind_of_row(row)
            values = tuple(kind.factor * float(law_points(law)[0]) for law in row.laws)
            found.append(Constant(row.name.replace("_", " "), values, _unit_of(kind, design), default=False))
    return found


def constant_rows(constants: Sequence[Constant]) -> list[tuple[str, str, str]]:
    """Name, value and unit of each; the values of a row stand below each other in lines of a few."""
    rows = []
    for name, values, unit, default in constants:
        figures = [f"{value + 0.0:.4g}" for value in values]
        lines = ["  ".join(figures[start : start + VALUES_ACROSS]) for start in range(0, len(figures), VALUES_ACROSS)]
        remark = "default" if unit == "-" else f"{unit}, default"
        rows.append((name, lines[0], remark if default else unit))
        rows += [("", line, "") for line in lines[1:]]
    return rows


def place_names(places: Sequence[float], count: int) -> list[str]:
    """What control points along the chord are called: by their places, or by their numbers where they have none."""
    if not places:
        return [f"point {i + 1}" for i in range(count)]
    words = {0.0: "leading edge", 1.0: "trailing edge"}
    return [words.get(round(place, 9), f"at {100.0 * place:.3g} %") for place in places]


def _kind_of(name: str, unit: str) -> _Kind:
    return next(each for each in (*_KINDS, _REST) if each.holds(name, unit))


def _kind_of_row(row: _Row) -> tuple[_Kind, str]:
    """The kind of a row, and the side that it belongs to where both sides share a panel."""
    stem, _, side = row.name.rpartition("_")
    if side in ("upper", "lower") and stem in ("thickness", "weights"):
        return _kind_of(row.name, row.unit), side
    title = row.name.replace("_", " ").capitalize()
    return _Kind(title, "control point [deg]" if row.unit == "deg" else "control point [-]", 1.0, _REST.holds), ""


def _abscissa(kind: _Kind, design: Any) -> str:
    return kind.abscissa.format(unit=design.length_unit, length=design.reference_length)


def _unit_of(kind: _Kind, design: Any) -> str:
    return _abscissa(kind, design).partition("[")[2].rstrip("]")


def _varies(law: Law) -> bool:
    """Whether a law is not the same all along the span."""
    return len(set(law_points(law))) > 1


def _laws(part: Part) -> tuple[list[_Single], list[_Row]]:
    """The laws and the rows of laws of a design and of the parts in it."""
    hints, single, rows = get_type_hints(type(part)), list[_Single](), list[_Row]()
    for each in fields(part):
        value, unit, hint = getattr(part, each.name), each.metadata.get("unit"), hints[each.name]
        if isinstance(part, PublishedProfile) and each.name == "trailing_edge_thickness":
            unit = OF_MAXIMUM
        if unit is None and isinstance(value, Part):
            inner_single, inner_rows = _laws(value)
            single += inner_single
            rows += inner_rows
        elif unit is None or value is None or value == ():
            continue
        elif get_origin(hint) is tuple and Stations in get_args(get_args(hint)[0]):
            rows.append(_Row(each.name, unit, value, _places(part, each.name, len(value))))
        elif Stations in get_args(hint):
            default = each.default is not MISSING and value == (each.default or 0.0)
            single.append(_Single(each.name, unit, value, default))
    return single, rows


def _places(part: Part, row: str, count: int) -> tuple[float, ...]:
    """Where the control points of a row stand along the chord."""
    if row.endswith("_places"):
        return ()
    given = part.control_places(row)
    return tuple(places_of((0.0,) * count).tolist() if given is None else given)
