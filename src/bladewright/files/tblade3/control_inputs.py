"""T-Blade3's control points: section by section (controlinputs.R.dat) or along the span (spancontrolinputs.R.dat)."""

from typing import Any

import numpy as np

from bladewright.errors import FileError
from bladewright.files.tblade3.case import LEADING_EDGE, LeadingEdges, Meanlines, Multipliers, NacaThickness, Table
from bladewright.files.tblade3.fortran_input import InputLines, fortran_number, list_directed_items
from bladewright.section.meanline import backward

_ORDER = ("curvature", "thickness", "leading")
_NAMES = {"curvature": "the curvature", "thickness": "the thickness multiplier", "leading": "the leading edge"}


def read_sectionwise(
    lines: InputLines, count: int, *, curvature: bool, multiplier: bool, leading_edge: bool
) -> dict[str, Any]:
    """The fields of a case that are given section by section; tables that the case does not need may be missing."""
    lines.text("the name of the case")
    needed = [kind for kind, present in zip(_ORDER, (curvature, multiplier, leading_edge), strict=True) if present]
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
            found["leading_edges"] = _sectionwise_leading_edges(lines, count)
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
    """What a table holds: as its title says, or else as its position does."""
    named = [kind for kind in _ORDER if kind in title.lower()]
    place = _ORDER.index(last) + 1 if last in _ORDER else 0
    return named[0] if named else _ORDER[min(place, len(_ORDER) - 1)]


def _sections(lines: InputLines, count: int, what: str) -> tuple[Table, Table]:
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


def _sectionwise_leading_edges(lines: InputLines, count: int) -> LeadingEdges:
    lines.text("the header of the leading edge")
    degree, segments = lines.integers(2, "degree and number of segments of the leading edge", least=3)
    rows = []
    for section in range(1, count + 1):
        name = f"the leading edge of section {section} of {count}"
        lines.texts(2, f"the title of {name}")
        rows.append(lines.numbers(len(LEADING_EDGE), name))
    return LeadingEdges(degree=degree, segments=segments, span=None, values=tuple(rows))


_SLOPES = {"dy_dx_te": False, "dy_dx_norm": True}
_CURVATURE = "the control points of the curvature"


def read_spanwise(lines: InputLines, *, naca: bool, multiplier: bool, leading_edge: bool) -> dict[str, Any]:
    """The fields of a case that are given along the span; tables that the case does not need may be missing.

    The file may have the current or the older format.
    """
    lines.texts(5, "the five lines of the head")
    found: dict[str, Any] = {"meanlines": _meanlines(lines)}
    if naca:
        found["naca"] = _naca(lines)
        return found
    while not lines.ended and (multiplier or leading_edge):
        title = lines.skip_words("another table").lower()
        if "leading" in title or (not multiplier and "thickness" not in title):
            found["leading_edges"] = _spanwise_leading_edges(lines)
            leading_edge = False
            continue
        multipliers = _multipliers(lines, needed=multiplier)
        if multipliers:
            found["multipliers"] = multipliers
            multiplier = False
    for missing, what in ((multiplier, "thickness multiplier"), (leading_edge, "leading edge")):
        if missing:
            raise FileError(
                f"'{lines.path}' ends without a table of the {what}, which the main input file asks for: the file is "
                "cut short, or that switch should be 0"
            )
    return found


def _head(lines: InputLines, what: str) -> tuple[int, int, str]:
    """The number of rows, the number after it, and the header in lower case."""
    rows, second = lines.integers(2, f"the numbers of rows and columns of {what}", least=2)
    return rows, second, lines.text(f"the header of {what}").lower()


def _meanlines(lines: InputLines) -> Meanlines:
    count, points, header = _head(lines, _CURVATURE)
    if points < 3:
        raise lines.error(
            f"the number of control points of the curvature is {points}: at least 3 are needed", lines.place - 1
        )
    first = "cur1" in header.split()
    inner = points - 2
    spans, places, values = [], [], []
    for span, *row in lines.table(count, 1 + inner + points - (not first), _CURVATURE):
        spans.append(span)
        places.append((0.0, *row[:inner], 1.0))
        values.append((*(() if first else (0.0,)), *row[inner:]))
    _check_places(lines, spans, places, _CURVATURE)
    return Meanlines(span=tuple(spans), u=tuple(places), curvature=tuple(values))


def _naca(lines: InputLines) -> NacaThickness:
    what = "the control points of the thickness"
    if lines.ended:
        raise FileError(
            f"'{lines.path}' ends without a table of LE_radius, u_max, t_max and t_TE, which the thickness switch 5 "
            "needs: the file is cut short, or of the older format, which has no such thickness"
        )
    lines.texts(2, f"the title of {what}")
    count, switch, header = _head(lines, what)
    words = header.split()
    if "le_radius" not in words:
        raise lines.error(
            f"the header of {what} is '{' '.join(words)}': the thickness switch 5 needs the columns span, LE_radius, "
            "u_max, t_max and t_TE; a file of the older format has no such thickness"
        )
    slopes = [word for word in words if word in _SLOPES]
    span, *columns = zip(*lines.table(count, 6 if slopes else 5, what), strict=True)
    return NacaThickness(
        span=span,
        leading_index=columns[0],
        thickest=columns[1],
        thickness=columns[2],
        trailing_thickness=columns[3],
        trailing_slope=columns[4] if slopes else None,
        slope_normalised=bool(slopes) and _SLOPES[slopes[0]],
        spline_switch=switch,
    )


def _multipliers(lines: InputLines, *, needed: bool) -> Multipliers | None:
    """The older format's table of a thickness multiplier; None where the case needs none, or in the current format.

    A table that the case does not need may hold anything.
    """
    what = "the control points of the thickness multiplier"
    count, points, header = _head(lines, what)
    if not needed:
        lines.rows(count, 1, what)
        return None
    if "le_radius" in header.split():
        lines.table(count, 5, "the control points of the thickness")
        return None
    if points < 3:
        raise lines.error(f"the number of {what} is {points}: at least 3 are needed", lines.place - 1)
    inner = points - 2
    numbers = [fortran_number(word) for word in list_directed_items(lines.peek())]
    # in some versions the table ends with the multiplier at the trailing edge; in the others that is 0
    last = len(numbers) >= 2 + 2 * inner and numbers[1 + 2 * inner] is not None
    spans, places, values = [], [], []
    for span, *row in lines.table(count, 1 + 2 * inner + last, f"{what} (span, {inner} places u, {inner} values)"):
        spans.append(span)
        places.append((0.0, *row[:inner], 1.0))
        values.append((0.0, *row[inner:], *(() if last else (0.0,))))
    _check_places(lines, spans, places, what)
    return Multipliers(span=tuple(spans), u=tuple(places), values=tuple(values))


def _spanwise_leading_edges(lines: InputLines) -> LeadingEdges:
    what = "the control points of the leading edge"
    degree, segments = lines.integers(2, "degree and number of segments of the leading edge", least=3)
    lines.skip_words(f"the numbers of rows and columns of {what}")
    count, _, _ = _head(lines, what)
    rows = lines.table(count, 1 + len(LEADING_EDGE), what)
    return LeadingEdges(
        degree=degree,
        segments=segments,
        span=tuple(row[0] for row in rows),
        values=tuple(row[1:] for row in rows),
    )


def _check_places(lines: InputLines, spans: list[float], places: Table | list[tuple[float, ...]], what: str) -> None:
    for span, row in zip(spans, places, strict=True):
        wrong = np.flatnonzero(backward(np.array(row)))
        if len(wrong):
            i = int(wrong[0])
            raise FileError(
                f"'{lines.path}': u of {what} is {row[i + 1]:g} after {row[i]:g} at the span {span:g}: the places must "
                "increase from 0 to 1, both of which are left out of the table; two inner ones may be equal"
            )
