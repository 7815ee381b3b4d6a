"""What the parameters of a section by suction and pressure side must be, each on its own."""

from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.errors import DesignError
from bladewright.section import checks

if TYPE_CHECKING:
    from bladewright.section.suction_pressure.part import SuctionPressure

ANGLES = ("stagger_angle", "metal_angle_in", "metal_angle_out")
EDGES = ("leading_edge", "trailing_edge")
RANGES = {
    "radius": (0.0, 0.5, False, "an edge radius must lie above 0 and below half the chord"),
    "stretch": (0.0, 20.0, False, "the ratio of an edge's semi-axes must lie above 0 and below 20"),
    "skew": (-1.0, 1.0, False, "a skewness must lie between -1 and 1, or an edge loses one of its halves"),
    "wedge": (0.0, 90.0, True, "a wedge angle must lie from 0 to 90 deg"),
}
TANGENTS = ("suction_tangent_in", "suction_tangent_out", "pressure_tangent_in", "pressure_tangent_out")
POINTS = ("suction_heights", "suction_places", "pressure_heights", "pressure_thickness", "pressure_places")


def checked(part: "SuctionPressure") -> dict[str, Any]:
    """Its fields as laws and tuples of numbers; raises DesignError where one is out of its range."""
    found: dict[str, Any] = {}
    for name in ANGLES:
        found[name] = checks.law(name, getattr(part, name))
        checks.between(name, found[name], -90.0, 90.0, "an angle must lie between -90 and 90 deg")
    for name, (low, high, closed, what) in ((f"{edge}_{k}", RANGES[k]) for edge in EDGES for k in RANGES):
        found[name] = checks.law(name, getattr(part, name))
        checks.between(name, found[name], low, high, what, closed=closed)
    for name in TANGENTS:
        if getattr(part, name) is not None or name.startswith("suction"):
            found[name] = checks.law(name, getattr(part, name))
            what = "it must lie above 0 and below 10 chords, along the tangent from the corner"
            checks.between(name, found[name], 0.0, 10.0, what)
    checks.choice("suction_side", part.suction_side, ("upper", "lower"))
    checks.choice("edges", part.edges, ("C1", "C2"))
    checks.choice("skeleton", part.skeleton, ("chord", "pseudo"))
    for name in POINTS:
        value = getattr(part, name)
        empty = checks.is_sequence(value) and len(value) == 0
        found[name] = () if empty else checks.chordwise(name, value)
    _check_counts(found)
    for side, count in (("suction", "suction_heights"), ("pressure", _pressure(found))):
        name = f"{side}_knots"
        found[name] = _knots(name, getattr(part, name), len(found[count]), count)
    return found


def _pressure(found: dict[str, Any]) -> str:
    return "pressure_thickness" if found["pressure_thickness"] else "pressure_heights"


def _check_counts(found: dict[str, Any]) -> None:
    if not found["suction_heights"]:
        raise DesignError(
            "suction_heights is an empty list: a suction side has too few control points with only the two on its "
            "tangents; give one height or more from leading to trailing edge"
        )
    if bool(found["pressure_heights"]) == bool(found["pressure_thickness"]):
        given = "both are given" if found["pressure_heights"] else "none is given"
        raise DesignError(
            f"pressure_heights and pressure_thickness: {given}; give heights for a pressure side of its own, or "
            "thicknesses along the suction side, and leave the other out"
        )
    thickness = found["pressure_thickness"]
    checks.between("pressure_thickness", thickness, 0.0, 1.0, "a thickness must be positive, and below the chord")
    for places, count in (("suction_places", "suction_heights"), ("pressure_places", _pressure(found))):
        if found[places] and len(found[places]) != len(found[count]):
            raise DesignError(
                f"{places} has {len(found[places])} entries and {count} has {len(found[count])}: give one place for "
                f"each, or leave {places} out"
            )
        if count == "pressure_thickness":
            checks.between(places, found[places], 0.0, 1.0, "a place on the suction side must lie between 0 and 1")
        else:
            # past the edges the skeleton goes on, and refined control points may stand there
            checks.between(places, found[places], -0.5, 1.5, "a place along the skeleton must lie between -0.5 and 1.5")


def _knots(name: str, value: Any, count: int, of: str) -> tuple[float, ...]:
    if not checks.is_sequence(value):
        raise DesignError(f"{name} is {value!r}: a list of numbers between 0 and 1 is needed, or none")
    knots = tuple(checks.number(f"{name}[{i}]", each) for i, each in enumerate(value))
    if not knots:
        return ()
    if any(np.iscomplexobj(each) or isinstance(each, np.ndarray) for each in knots):
        raise DesignError(f"{name} is {value!r}: knots are plain real numbers, held while differentiating")
    if len(knots) != count:
        raise DesignError(f"{name} has {len(knots)} entries: {of} has {count}, and one inner knot is needed for each")
    if not (np.diff([0.0, *knots, 1.0]) > 1e-9).all():
        raise DesignError(f"{name} is {list(knots)}: inner knots must increase, above 0 and below 1; sort them")
    return knots
