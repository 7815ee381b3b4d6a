"""T-Blade3's file `controlinputs.R.dat`: control points of meanline and thickness, section by section."""

from typing import Any

from bladewright.errors import FileError
from bladewright.files.tblade3.lines import Lines
from bladewright.files.tblade3.records import LEADING_EDGE, LeadingEdges, Meanlines, Multipliers, Table

_ORDER = ("curvature", "thickness", "leading")
_NAMES = {"curvature": "the curvature", "thickness": "the thickness multiplier", "leading": "the leading edge"}


def read_sectionwise(
    lines: Lines, count: int, *, curvature: bool, multiplier: bool, leading_edge: bool
) -> dict[str, Any]:
    """Fields of a case from the file, for so many sections; what is not asked for may be missing."""
    lines.text("the name of the case")
    needed = [kind for kind, asked in zip(_ORDER, (curvature, multiplier, leading_edge), strict=True) if asked]
    found: dict[str, Any] = {}
    kind = ""
    while needed:
        lines.skip_blank()
        if lines.ended:
            raise FileError(
                f"'{lines.path}' ends without a table of {_NAMES[needed[0]]}, which the main input file asks for: the "
                "file is cut short, or that switch should be 0"
            )
        kind = _kind(lines.text("the title of a table"), kind)
        if kind == "leading":
            found["leading_edges"] = _leading_edges(lines, count)
        else:
            u, values = _sections(lines, count, _NAMES[kind])
            if kind == "curvature":
                found["meanlines"] = Meanlines(span=None, u=u, curvature=values)
            else:
                found["multipliers"] = Multipliers(span=None, u=u, values=values)
        if kind in needed:
            needed.remove(kind)
        elif kind == "leading":
            raise lines.error(f"the table of {_NAMES[needed[0]]} does not precede that of {_NAMES[kind]}")
    return found


def _kind(title: str, last: str) -> str:
    """What a table holds: its title says so, or else its place."""
    named = [kind for kind in _ORDER if kind in title.lower()]
    place = _ORDER.index(last) + 1 if last in _ORDER else 0
    return named[0] if named else _ORDER[min(place, len(_ORDER) - 1)]


def _sections(lines: Lines, count: int, what: str) -> tuple[Table, Table]:
    places, values = [], []
    for section in range(1, count + 1):
        name = f"the control points of {what} of section {section} of {count}"
        lines.texts(2, f"the title of {name}")
        points = lines.integer(f"the number of {name}", least=3)
        lines.text(f"the header of {name}")
        u, value = zip(*lines.table(points, 2, name, first="u", equal=True), strict=True)
        places.append(u)
        values.append(value)
    return tuple(places), tuple(values)


def _leading_edges(lines: Lines, count: int) -> LeadingEdges:
    lines.text("the header of the leading edge")
    degree, segments = lines.integers(2, "degree and number of segments of the leading edge", least=3)
    rows = []
    for section in range(1, count + 1):
        name = f"the leading edge of section {section} of {count}"
        lines.texts(2, f"the title of {name}")
        rows.append(lines.numbers(len(LEADING_EDGE), name))
    return LeadingEdges(degree=degree, segments=segments, span=None, values=tuple(rows))
