"""The head of T-Blade3's main input file: names, counts, scale and switches, to the line of the clustering."""

import re
from collections.abc import Mapping
from typing import Any

from bladewright.files.tblade3.lines import Lines, items, number

ANGLES = {0: "axial", 1: "radial", 2: "axial-radial", 3: "radial-axial", 4: "wing"}
ANGLE_SPLINES = ("inletspline", "outletspline", "inoutspline", "inci_dev_spline")
THICKNESSES = {0: "wennerstrom", 1: "quartic", 2: "quartic-sharp", 5: "naca"}
LEADING_EDGES = {0: "elliptic", 1: "spline"}
CHORDS = {0: "meridional", 1: "given", 2: "multiplied"}
CLUSTERINGS = {0: "uniform", 1: "sine", 2: "exponential", 3: "hyperbolic", 4: "elliptic"}
ON = {0: False, 1: True}
_REMOVED = (
    "was removed from T-Blade3, whose current version stops at it: "
    "give one of {known}, or write the points of its sections with the old version and fit a design to them"
)


def read_head(lines: Lines, notes: list[str]) -> dict[str, Any]:
    """Fields of a case up to the table of sections, whose title is the line read last."""
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


def _unit(lines: Lines, notes: list[str]) -> str:
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


def _angles(lines: Lines, notes: list[str]) -> tuple[str, str]:
    line = lines.text("the angle switch")
    digits = {int(each) for each in line if each in "01234"}
    if len(digits) != 1:
        raise lines.error(
            f"the angle switch '{line.strip()}' holds {len(digits) or 'none'} of the digits 0 to 4, and must hold "
            "exactly one: 0 axial, 1 radial, 2 axial in and radial out, 3 radial in and axial out, 4 wing"
        )
    words = [word for word in items(line) if word and number(word) is None]
    spline = next((word for word in words if word in ANGLE_SPLINES), "")
    if words and not spline:
        notes.append(
            f"line {lines.place} has '{words[0]}' behind the angle switch, which T-Blade3 does not know (it knows "
            f"{', '.join(ANGLE_SPLINES)}): the angles are those of the table of sections"
        )
    return ANGLES[digits.pop()], spline


def _camber(lines: Lines) -> tuple[bool, bool]:
    words = lines.words("the camber switch")
    camber = _known(lines, "the camber switch", words, ON)
    if len(words) > 1:
        if words[1] != "spanwise_spline":
            raise lines.error(f"'{words[1]}' stands behind the camber switch: only 'spanwise_spline' may stand there")
        lines.text("the title of the thickness switch")
        return camber, True
    title = items(lines.text("the title of the thickness switch"))
    if not title or title[0] != "Airfoil":
        raise lines.error(
            "the title behind a camber switch without 'spanwise_spline' must begin with the word 'Airfoil', as "
            f"T-Blade3 tells by it that the switch stands alone: it is '{(title or [''])[0]}'"
        )
    return camber, False


def _thickness(lines: Lines, notes: list[str]) -> str:
    what = "the thickness switch"
    removed = dict.fromkeys((3, 4), "a thickness of the kind {value} " + _REMOVED)
    words = lines.words(what)
    thickness = _known(lines, what, words, THICKNESSES, removed)
    following = items(lines.peek())
    if len(words) == 1 or not following or number(following[0]) is None:
        lines.text("the title of the thickness multiplier")
        if len(words) > 1:
            notes.append(
                f"T-Blade3 takes '{words[1]}' behind the thickness switch for the title that follows it: it must "
                "stand alone on its line"
            )
    return thickness


def _clustering(lines: Lines) -> dict[str, Any]:
    words = lines.words("the clustering switch")
    return {
        "clustering": _known(lines, "the clustering switch", words, CLUSTERINGS),
        "clustering_parameter": number(words[1]) if len(words) > 1 else None,
    }


def _switch(lines: Lines, what: str, known: Mapping[int, Any], removed: Mapping[int, str] | None = None) -> Any:
    return _known(lines, what, lines.words(what), known, removed)


def _known(
    lines: Lines, what: str, words: list[str], known: Mapping[int, Any], removed: Mapping[int, str] | None = None
) -> Any:
    numbers = ", ".join(map(str, known))
    value = number(words[0]) if words else None
    if value is not None and value in known:
        return known[int(value)]
    if value is not None and removed and value in removed:
        raise lines.error(f"{what} is {words[0]}: {removed[int(value)].format(value=words[0], known=numbers)}")
    said = " ".join(words) or "empty"
    raise lines.error(f"{what} is '{said}': it must be one of {numbers}")


read_switch = _switch
