"""T-Blade3's main input file 3dbgbinput.R.dat: switches and tables."""

import re
from collections.abc import Mapping
from typing import Any

from bladewright.files.tblade3.case import CENTROID, Point, SectionRow, SpanLaw, stacking_of
from bladewright.files.tblade3.fortran_input import InputLines, fortran_number, list_directed_items

# what the values of T-Blade3's switches stand for
ANGLES = {0: "axial", 1: "radial", 2: "axial-radial", 3: "radial-axial", 4: "wing"}
ANGLE_SPLINES = ("inletspline", "outletspline", "inoutspline", "inci_dev_spline")
THICKNESSES = {0: "wennerstrom", 1: "quartic", 2: "quartic-sharp", 5: "naca"}
LEADING_EDGES = {0: "elliptic", 1: "spline"}
CHORDS = {0: "meridional", 1: "given", 2: "multiplied"}
CLUSTERINGS = {0: "uniform", 1: "sine", 2: "exponential", 3: "hyperbolic", 4: "elliptic"}
ON = {0: False, 1: True}
_SECTION_COLUMNS = (
    *("in_beta", "out_beta", "mach", "chord", "thickness", "incidence", "deviation", "secondary_flow_angle"),
)
_TYPE_COLUMNS = ("stack_u", "stack_v", "thickest", "leading_thickness", "trailing_thickness")
_GRID_COLUMNS = ("jcells", "eta_ofst", "bggrid")
_REMOVED = (
    "was removed from T-Blade3, whose current version stops at it: "
    "give one of {known}, or write the points of its sections with the old version and fit a design to them"
)


def read_head(lines: InputLines, notes: list[str]) -> dict[str, Any]:
    """The fields of a case up to the table of sections, whose title is the last line that is read."""
    found: dict[str, Any] = {"title": lines.text("the title").strip()}
    found["name"] = next(iter(lines.words("the name of the case")), "")
    lines.text("the title of the blade row")
    found["row"] = lines.integer("the blade row's number", least=0)
    lines.text("the title of the number of blades")
    found["blade_count"] = lines.integer("the number of blades", least=1)
    found["unit"] = _unit(lines, notes)
    scale, *turn = lines.numbers(1, "the scaling factor", most=2)
    if scale <= 0.0:
        raise lines.error(f"the scaling factor is {scale:g}: it must be positive")
    found["scale"], found["theta_offset"] = scale, turn[0] if turn else 0.0
    lines.text("the title of the number of streamlines")
    found["streamline_count"] = lines.integer("the number of streamlines", least=2)
    lines.text("the title of the angle switch")
    found["angles"], found["angle_spline"] = _angles(lines, notes)
    lines.text("the title of the camber switch")
    found["curvature_camber"], found["spanwise"] = _camber(lines)
    found["thickness"] = _thickness(lines, notes)
    found["thickness_multiplier"] = _switch(lines, "the switch of the thickness multiplier", ON)
    lines.text("the title of the leading edge")
    sting = {2: "a leading edge with a sting " + _REMOVED}
    found["leading_edge"] = _switch(lines, "the switch of the leading edge", LEADING_EDGES, sting)
    lines.text("the title of the chord switch")
    found["chord"] = _switch(lines, "the chord switch", CHORDS)
    found |= {"true_sweep": False, "true_lean": False, "early": False}
    found |= {"clustering": "uniform", "clustering_parameter": None}
    title = lines.text("the title of true lean and sweep, or of the sectionwise properties")
    if _is_table(title):
        notes.append(
            "the file is of an early version without switches of true lean and sweep and of the clustering: sweep and "
            "lean are true where column 15 beside the number of their control points holds a 1, and the clustering is "
            "taken as uniform; current versions do not read such a file"
        )
        return found | {"early": True}
    true = _switch(lines, "the switch of true lean and sweep", ON)
    found |= {"true_sweep": true, "true_lean": true}
    title = lines.text("the title of the clustering, or of the sectionwise properties")
    if _is_table(title):
        notes.append(
            "the file is of an early version without a switch of the clustering, which is taken as uniform; current "
            "versions do not read such a file"
        )
        return found
    found |= _clustering(lines)
    lines.text("the title of the sectionwise properties")
    return found


def _is_table(title: str) -> bool:
    return "sectionwise" in title.lower()


def _unit(lines: InputLines, notes: list[str]) -> str:
    title = lines.text("the title of the scaling factor, with its unit")
    mark = title[23:25].ljust(2)
    unit = {"mm": "mm", "cm": "cm", "m)": "m", "m ": "m"}.get(mark)
    if unit is None:
        raise lines.error(
            f"characters 24 and 25 are '{mark}', where T-Blade3 reads the unit of the scaling factor: they must be "
            "'mm', 'cm' or 'm)', as in ' Blade Scaling factor (mm):' with one blank before it"
        )
    written = re.search(r"\((mm|cm|m)\)", title)
    if written and written[1] != unit:
        notes.append(
            f"line {lines.place} says ({written[1]}), but T-Blade3 reads the unit in its characters 24 and 25, "
            f"which are '{mark}': the scaling factor is taken in {unit}"
        )
    return unit


def _angles(lines: InputLines, notes: list[str]) -> tuple[str, str]:
    line = lines.text("the angle switch")
    digits = {int(each) for each in line if each in "01234"}
    if len(digits) != 1:
        raise lines.error(
            f"the angle switch '{line.strip()}' holds {len(digits) or 'none'} of the digits 0 to 4, and must hold "
            "exactly one: 0 axial, 1 radial, 2 axial in and radial out, 3 radial in and axial out, 4 wing"
        )
    words = [word for word in list_directed_items(line) if word and fortran_number(word) is None]
    spline = next((word for word in words if word in ANGLE_SPLINES), "")
    if words and not spline:
        notes.append(
            f"line {lines.place} has '{words[0]}' behind the angle switch, which T-Blade3 does not know (it knows "
            f"{', '.join(ANGLE_SPLINES)}): the angles are those of the table of sections"
        )
    return ANGLES[digits.pop()], spline


def _camber(lines: InputLines) -> tuple[bool, bool]:
    words = lines.words("the camber switch")
    camber = _known(lines, "the camber switch", words, ON)
    if len(words) > 1:
        if words[1] != "spanwise_spline":
            raise lines.error(f"'{words[1]}' stands behind the camber switch: only 'spanwise_spline' may stand there")
        lines.text("the title of the thickness switch")
        return camber, True
    title = list_directed_items(lines.text("the title of the thickness switch"))
    if not title or title[0] != "Airfoil":
        raise lines.error(
            "the title behind a camber switch without 'spanwise_spline' must begin with the word 'Airfoil', as "
            f"T-Blade3 tells by it that the switch stands alone: it is '{(title or [''])[0]}'"
        )
    return camber, False


def _thickness(lines: InputLines, notes: list[str]) -> str:
    what = "the thickness switch"
    removed = dict.fromkeys((3, 4), "a thickness of the kind {value} " + _REMOVED)
    words = lines.words(what)
    thickness = _known(lines, what, words, THICKNESSES, removed)
    following = list_directed_items(lines.peek())
    if len(words) == 1 or not following or fortran_number(following[0]) is None:
        lines.text("the title of the thickness multiplier")
        if len(words) > 1:
            notes.append(
                f"T-Blade3 takes '{words[1]}' behind the thickness switch for the title that follows it: it must "
                "stand alone on its line"
            )
    return thickness


def _clustering(lines: InputLines) -> dict[str, Any]:
    words = lines.words("the clustering switch")
    return {
        "clustering": _known(lines, "the clustering switch", words, CLUSTERINGS),
        "clustering_parameter": fortran_number(words[1]) if len(words) > 1 else None,
    }


def _switch(lines: InputLines, what: str, known: Mapping[int, Any], removed: Mapping[int, str] | None = None) -> Any:
    return _known(lines, what, lines.words(what), known, removed)


def _known(
    lines: InputLines, what: str, words: list[str], known: Mapping[int, Any], removed: Mapping[int, str] | None = None
) -> Any:
    numbers = ", ".join(map(str, known))
    value = fortran_number(words[0]) if words else None
    if value is not None and value in known:
        return known[int(value)]
    if value is not None and removed and value in removed:
        raise lines.error(f"{what} is {words[0]}: {removed[int(value)].format(value=words[0], known=numbers)}")
    text = " ".join(words) or "empty"
    raise lines.error(f"{what} is '{text}': it must be one of {numbers}")


def read_tables(lines: InputLines, count: int, notes: list[str], *, early: bool) -> dict[str, Any]:
    """The fields of a case from the table of sections on, for `count` streamlines.

    An `early` file has the switches of true sweep and lean next to the numbers of their control points.
    """
    found: dict[str, Any] = {}
    lines.text("the header of the sectionwise properties")
    angles = lines.rows(count, 9, "the sectionwise properties")
    found |= _edge_curves(lines)
    lines.texts(6, "the titles of the stacking")
    found["radial_stacking"] = radial = _switch(lines, "the switch of variable radial stacking", ON)
    shapes, found["grid_columns"] = _shapes(lines, count, radial=radial)
    found["sections"] = tuple(
        SectionRow(
            label=int(row[0]),
            type=kind,
            **dict(zip(_SECTION_COLUMNS, row[1:], strict=True)),
            **dict(zip(_TYPE_COLUMNS, shape, strict=True)),
        )
        for row, (kind, shape) in zip(angles, shapes, strict=True)
    )
    lines.texts(2, "the title of the blending")
    rows, *_ = lines.integers(3, "the number of rows of the blending, and two switches", least=0)
    lines.text("the header of the blending")
    found["blending"] = tuple(lines.rows(rows, 3, "the blending"))
    lines.texts(2, "the title of the stacking axis")
    found["stacking_code"] = _stacking_code(lines, radial=radial)
    for name in ("sweep", "lean"):
        true, found[name] = _shift(lines, name, notes, early=early)
        if early:
            found[f"true_{name}"] = true
    for name, title in (("in_beta", "in_beta*"), ("out_beta", "out_beta*"), ("chord_multiplier", "chord_multiplier")):
        found[name] = _law(lines, title, notes)
    found |= _thicknesses(lines)
    lines.text("a blank line")
    for end in ("hub", "tip"):
        lines.text(f"the title of the {end} offset")
        offset, *inflation = lines.numbers(1, f"the {end} offset", most=2)
        found[f"{end}_offset"], found[f"{end}_inflation"] = offset, inflation[0] if inflation else None
    found["streamlines"] = _streamlines(lines, count)
    return found


def _edge_curves(lines: InputLines) -> dict[str, tuple[Point, ...]]:
    lines.texts(3, "the titles of the leading- and trailing-edge curves")
    rows = lines.integer("the number of points of the leading- and trailing-edge curves", least=2)
    lines.text("the header of the leading- and trailing-edge curves")
    leading, trailing = [], []
    for x_in, r_in, x_out, r_out in lines.rows(rows, 4, "the leading- and trailing-edge curves"):
        leading.append((x_in, r_in))
        trailing.append((x_out, r_out))
    return {"leading_curve": tuple(leading), "trailing_curve": tuple(trailing)}


def _shapes(lines: InputLines, count: int, *, radial: bool) -> tuple[list[tuple[str, tuple[float, ...]]], bool]:
    """Type and numbers of each section, and whether columns of a grid follow them."""
    header = lines.text("the header of the types of section").lower()
    grid = any(name in header for name in _GRID_COLUMNS)
    found = []
    for row in range(1, count + 1):
        what = f"row {row} of {count} of the types of section"
        words = lines.words(what)
        values = [fortran_number(word) for word in words[2:7]]
        if len(values) < 5 or None in values or fortran_number(words[0]) is None:
            raise lines.error(
                f"{what} must be a number, a type such as sect1, and 5 numbers (stk_u, stk_v, umxthk, lethk, tethk), "
                f"not '{' '.join(words)}'"
            )
        shape = tuple(value for value in values if value is not None)
        if radial and not (0.0 <= shape[0] <= 100.0 or shape[0] == CENTROID):
            raise lines.error(
                f"stk_u of {what} is {shape[0]:g}: it must lie between 0 and 100 %, or be 200, the centroid"
            )
        if radial and not -100.0 <= shape[1] <= 100.0:
            raise lines.error(f"stk_v of {what} is {shape[1]:g}: it must lie between -100 and 100 %")
        found.append((words[1], shape))
    return found, grid


def _stacking_code(lines: InputLines, *, radial: bool) -> int:
    code = lines.integer("the code of the stacking axis")
    stacking = stacking_of(code)
    if not radial and not (stacking.along <= 1.0 or stacking.centroid):
        raise lines.error(
            f"the code of the stacking axis is {code}, {100.0 * stacking.along:g} % of the chord: its first three "
            "digits must be 000 to 100, or 200 for the centroid"
        )
    if not radial and not -1.0 <= stacking.above <= 1.0:
        raise lines.error(
            f"the code of the stacking axis is {code}, {100.0 * stacking.above:g} % of the half thickness: its last "
            "three digits must be 000 to 100 (the centroid is 200000, a quarter of the chord 025000)"
        )
    return code


def _count(lines: InputLines, name: str, notes: list[str], *, one_digit: bool = False) -> int:
    line = lines.peek()
    rows = lines.integer(f"the number of control points of {name}", least=2)
    digit = line[11:12]
    if one_digit and digit != str(rows):
        notes.append(
            f"T-Blade3 reads the number of control points of {name} as one digit in column 12 of line {lines.place}, "
            f"which holds '{digit}': {rows} are taken, as the line says"
        )
    return rows


def _shift(lines: InputLines, name: str, notes: list[str], *, early: bool) -> tuple[bool, SpanLaw]:
    """Sweep or lean as a law, and whether an early file states that it is a true one.

    There a digit in column 15 of the line with the count says so, and the values are in the third column.
    """
    lines.texts(2, f"the title of the control points of {name}")
    switch = lines.peek()[14:15].strip() if early else ""
    rows = _count(lines, name, notes, one_digit=True)
    if switch not in {"", "0", "1"}:
        raise lines.error(
            f"column 15 holds '{switch}', where an early version reads the switch of true {name}: it must be 0, 1 or "
            "blank"
        )
    header = lines.text(f"the header of the control points of {name}")
    if early and not switch and "true_" in header:
        notes.append(f"the column true_{name} has no effect: column 15 of line {lines.place - 1}, its switch, is blank")
    columns = zip(*lines.table(rows, 3 if switch else 2, f"the control points of {name}"), strict=True)
    span, *values = columns
    return switch == "1", SpanLaw(span=span, values=values[-1])


def _law(lines: InputLines, name: str, notes: list[str]) -> SpanLaw:
    lines.texts(2, f"the title of the control points of {name}")
    rows = _count(lines, name, notes)
    lines.text(f"the header of the control points of {name}")
    span, values = zip(*lines.table(rows, 2, f"the control points of {name}"), strict=True)
    return SpanLaw(span=span, values=values)


def _thicknesses(lines: InputLines) -> dict[str, SpanLaw | None]:
    """The laws of tm/c and u_max; the header states which of them there are, and in which order."""
    name = "the control points of tm/c"
    lines.texts(2, f"the title of {name}")
    rows = lines.integer(f"the number of {name}", least=2)
    header = [word.lower() for word in lines.text(f"the header of {name}").split()]
    places = {"thickness_multipliers": "tm/c", "thickest": "u_max"}
    columns = sorted((header.index(word), field) for field, word in places.items() if word in header)
    if not columns:
        raise lines.error(
            f"the header of {name} is '{' '.join(header)}': it must name the columns that follow the span, 'tm/c' or "
            "'u_max' or both"
        )
    span, *values = zip(*lines.table(rows, 1 + len(columns), name), strict=True)
    found: dict[str, SpanLaw | None] = dict.fromkeys(places)
    for (_, field), column in zip(columns, values, strict=True):
        found[field] = SpanLaw(span=span, values=column)
    return found


def _streamlines(lines: InputLines, count: int) -> tuple[tuple[Point, ...], ...]:
    while (list_directed_items(lines.text("the streamlines, below a line that begins with x_s")) or [None])[0] != "x_s":
        pass
    found = []
    for index in range(1, count + 1):
        what = f"streamline {index} of {count}"
        points: list[Point] = []
        while True:
            x, r = lines.numbers(2, f"a point of {what}, or the 0 0 that closes it,")
            if r == 0.0:
                break
            if r < 0.0:
                raise lines.error(f"{what} has the radius {r:g}: it must be positive, or 0 to close the streamline")
            points.append((x, r))
        if len(points) < 2:
            raise lines.error(
                f"{what} is closed after {len(points)} points: at least 2 are needed; is the number of streamlines, "
                f"{count}, right?"
            )
        found.append(tuple(points))
    return tuple(found)
