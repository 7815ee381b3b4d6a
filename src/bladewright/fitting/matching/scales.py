"""What change of a parameter matters, and how far a parameter may go."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bladewright.derivatives.patterns import matching
from bladewright.designs import Design, unit_at
from bladewright.errors import DesignError, FitError
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

SMALLEST_LENGTH = 2e-5
"""smallest thickness and edge radius, of the chord: about what can be made, and far above rounding
(design/matching_constants.md)."""
LARGEST_ANGLE = 89.0
"""largest angle [deg]: at 90 deg the tangent that places the camber is infinite (design/matching_constants.md)."""


class ParameterRange(NamedTuple):
    """Of one parameter, in the unit of its field."""

    size: float
    """a change that matters"""
    low: float = -np.inf
    """lowest value"""
    high: float = np.inf
    """highest value"""


WEDGE_RANGE, ANGLE_RANGE = ParameterRange(3.0, 0.0, LARGEST_ANGLE), ParameterRange(5.0, -LARGEST_ANGLE, LARGEST_ANGLE)
"""of a wedge angle [deg]"""
"""of any other angle [deg]"""
RANGE_BY_NAME = {
    "maximum_thickness_at": ParameterRange(0.1, 0.051, 0.949),
    "camber_position": ParameterRange(0.1, 0.021, 0.979),
    "uniform_load": ParameterRange(0.1, 0.0, 1.0),
    "transition": ParameterRange(0.1, 0.101, 0.899),
    "leading_edge_index": ParameterRange(1.0, 0.05, 11.99),
    "leading_edge_curvature": ParameterRange(0.02, 1e-4),
    "trailing_edge_curvature": ParameterRange(0.02, 0.0),
    "trailing_edge_slope": ParameterRange(0.1, -np.inf, -1e-4),
    "trailing_edge_slope_factor": ParameterRange(0.3, 1e-3),
    "camber": ParameterRange(0.02, -0.29, 0.29),
    "lift_coefficient": ParameterRange(0.3, -2.99, 2.99),
    "design_lift": ParameterRange(0.3, -1.99, 1.99),
    "front_camber": ParameterRange(0.1),
    "abscissas": ParameterRange(0.01),
    "ordinates": ParameterRange(0.01),
    "thickness_multiplier": ParameterRange(0.1),
    "suction_heights": ParameterRange(0.02),
    "pressure_heights": ParameterRange(0.02),
    "suction_places": ParameterRange(0.05, -0.49, 1.49),
    "pressure_places": ParameterRange(0.05, -0.49, 1.49),
}
"""Of fields whose limits the family states: a little inside them, so that a search may differentiate at its bounds."""


RangeRule = Callable[[float, float], ParameterRange]
"""from a parameter's value and the largest magnitude in its field"""
RANGE_BY_ENDING: tuple[tuple[str, RangeRule], ...] = (
    ("radius", lambda _, largest: ParameterRange(max(0.5 * largest, 1e-3), SMALLEST_LENGTH, 0.499)),
    ("half_thickness", lambda _, largest: ParameterRange(max(0.5 * largest, 0.01), SMALLEST_LENGTH, 0.399)),
    ("thickness", lambda _, largest: ParameterRange(max(0.5 * largest, 0.01), SMALLEST_LENGTH, 0.99)),
    ("stretch", lambda *_: ParameterRange(0.3, 0.05, 19.9)),
    ("scale", lambda *_: ParameterRange(0.3, 0.05, 19.9)),
    ("skew", lambda *_: ParameterRange(0.2, -0.95, 0.95)),
    ("ratio", lambda *_: ParameterRange(0.5, 0.05, 99.0)),
    ("places", lambda *_: ParameterRange(0.05, 1e-3, 1.0 - 1e-3)),
    ("weights", lambda value, _: ParameterRange(0.5 * value, 1e-2 * value, 1e2 * value)),
    ("tangent_in", lambda value, _: ParameterRange(float(np.clip(0.5 * value, 2e-3, 0.05)), 1e-3, 9.9)),
    ("tangent_out", lambda value, _: ParameterRange(float(np.clip(0.5 * value, 2e-3, 0.05)), 1e-3, 9.9)),
    ("", lambda _, largest: ParameterRange(max(0.3 * largest, 0.02))),
)
"""of other fields of a part by the end of their name; the first ending that matches counts"""


def part_range(path: str, unit: str | None, value: float, largest: float) -> ParameterRange:
    """The range of a part's parameter at a path; `largest` is the largest magnitude in its field."""
    name = re.findall(r"[a-z_]\w*", re.sub(r"\.values\[\d+\]$", "", path))[-1]
    if name in RANGE_BY_NAME:
        return RANGE_BY_NAME[name]
    if unit == "deg":
        return WEDGE_RANGE if "wedge" in name else ANGLE_RANGE
    rule = next(rule for ending, rule in RANGE_BY_ENDING if name.endswith(ending))
    return rule(value, largest)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scales:
    """Of k parameters, in the units of their fields."""

    size: Reals
    """(k,) a change that matters: the unit of a search, and how far a first guess may be off"""
    low: Reals
    """(k,) lowest values"""
    high: Reals
    """(k,) highest values"""


def scales_of(
    design: Design, paths: Sequence[str], chord: float, bounds: Mapping[str, tuple[float, float]] | None = None
) -> Scales:
    """Scales of a design's parameters; `chord` in metres, `bounds` by pattern within those of the family."""
    kinds = _ranges(design, paths, chord)
    size, low, high = (np.array([getattr(kind, name) for kind in kinds]) for name in ("size", "low", "high"))
    for pattern, (least, most) in (bounds or {}).items():
        for i in _matched_indices(pattern, paths):
            low[i], high[i] = max(low[i], least), min(high[i], most)
    return Scales(size=size, low=low, high=high)


def check_bounds(design: Design, paths: Sequence[str], bounds: Mapping[str, tuple[float, float]]) -> None:
    """Refuse bounds of no free parameter (k,), in the wrong order, or outside what the family allows."""
    for pattern, (least, most) in bounds.items():
        if not least < most:
            raise FitError(f"the bounds of {pattern} are {least:g} to {most:g}: the first must be below the second")
        try:
            matched = matching(pattern, paths)
        except DesignError as error:
            raise FitError(f"bounds: {error}") from error
        for path, kind in zip(matched, _ranges(design, matched, 1.0), strict=True):
            if not max(kind.low, least) < min(kind.high, most):
                raise FitError(
                    f"the bounds of {path} are {least:g} to {most:g}, and the family allows {kind.low:g} to "
                    f"{kind.high:g}: let them overlap"
                )


def _matched_indices(pattern: str, paths: Sequence[str]) -> list[int]:
    """Indices of the paths that a pattern matches: none where a structure has no such parameter."""
    try:
        found = set(matching(pattern, paths))
    except DesignError:
        return []
    return [place for place, path in enumerate(paths) if path in found]


def _ranges(design: Design, paths: Sequence[str], chord: float) -> list[ParameterRange]:
    """Ranges of parameters; a law's sizes follow from the values of all of it."""
    values = {path: float(value) for path, value in design.parameters().items()}
    fields: dict[str, list[float]] = {}
    for path, value in values.items():
        fields.setdefault(_field(path), []).append(value)
    size = {name: max(among) for name, among in fields.items()}
    extent = {name: float(np.sqrt(max(value**2 for value in among))) for name, among in fields.items()}
    return [
        part_range(path, unit_at(design, path), values[path], extent[_field(path)])
        if path.startswith("section.")
        else _range(design, path, values[path], size[_field(path)], chord)
        for path in paths
    ]


def _field(path: str) -> str:
    return path.partition("[")[0]


def _range(design: Design, path: str, value: float, largest: float, chord: float) -> ParameterRange:
    field = _field(path)
    length = chord / UNITS[getattr(design, "length_unit")]  # noqa: B009 - a field of every family, not of the base
    kinds = {
        "stagger": ParameterRange(5.0, -LARGEST_ANGLE, LARGEST_ANGLE),
        "metal_angle": ParameterRange(10.0, -LARGEST_ANGLE, LARGEST_ANGLE),
        "tangent": ParameterRange(0.2, 0.05, 1.0),
        "leading_edge_radius": ParameterRange(max(0.5 * largest, 1e-3), SMALLEST_LENGTH, 0.999),
        "trailing_edge_radius": ParameterRange(max(0.5 * largest, 1e-3), SMALLEST_LENGTH, 0.999),
        "thickness": ParameterRange(max(0.5 * largest, 0.02), SMALLEST_LENGTH, 5.0),
        "weights": ParameterRange(0.5 * value, 1e-2 * value, 1e2 * value),
        "leading_edge_theta": ParameterRange(float(np.degrees(0.05))),
        "axial_chord": ParameterRange(0.05 * length, 1e-3 * length),
        **dict.fromkeys(("channel", "flow_path.", "leading_edge.", "trailing_edge."), ParameterRange(0.02 * length)),
        "stacking.theta": ParameterRange(float(np.degrees(0.05))),
    }
    return next((kind for name, kind in kinds.items() if field.startswith(name)), ParameterRange(0.05 * length))
