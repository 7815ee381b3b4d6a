"""What matters in a parameter of a family's part, and how far it may go: by the end of its path."""

import re
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

LEAST = 2e-5
"""smallest thickness and edge radius, of the chord"""
ANGLE = 89.0
"""largest angle [deg]"""


class Kind(NamedTuple):
    """Of a parameter, in the unit of its field."""

    size: float
    """a change that matters"""
    low: float = -np.inf
    high: float = np.inf


WEDGE, TURN = Kind(3.0, 0.0, ANGLE), Kind(5.0, -ANGLE, ANGLE)
BY_NAME = {
    "maximum_thickness_at": Kind(0.1, 0.051, 0.949),
    "camber_position": Kind(0.1, 0.021, 0.979),
    "uniform_load": Kind(0.1, 0.0, 1.0),
    "transition": Kind(0.1, 0.101, 0.899),
    "leading_edge_index": Kind(1.0, 0.05, 11.99),
    "leading_edge_curvature": Kind(0.02, 1e-4),
    "trailing_edge_curvature": Kind(0.02, 0.0),
    "trailing_edge_slope": Kind(0.1, -np.inf, -1e-4),
    "trailing_edge_slope_factor": Kind(0.3, 1e-3),
    "camber": Kind(0.02, -0.29, 0.29),
    "lift_coefficient": Kind(0.3, -2.99, 2.99),
    "design_lift": Kind(0.3, -1.99, 1.99),
    "front_camber": Kind(0.1),
    "abscissas": Kind(0.01),
    "ordinates": Kind(0.01),
    "thickness_multiplier": Kind(0.1),
    "suction_heights": Kind(0.02),
    "pressure_heights": Kind(0.02),
    "suction_places": Kind(0.05, -0.49, 1.49),
    "pressure_places": Kind(0.05, -0.49, 1.49),
}


Rule = Callable[[float, float], Kind]
"""from a parameter's value and the largest magnitude in its field"""
BY_ENDING: tuple[tuple[str, Rule], ...] = (
    ("radius", lambda _, largest: Kind(max(0.5 * largest, 1e-3), LEAST, 0.499)),
    ("half_thickness", lambda _, largest: Kind(max(0.5 * largest, 0.01), LEAST, 0.399)),
    ("thickness", lambda _, largest: Kind(max(0.5 * largest, 0.01), LEAST, 0.99)),
    ("stretch", lambda *_: Kind(0.3, 0.05, 19.9)),
    ("skew", lambda *_: Kind(0.2, -0.95, 0.95)),
    ("ratio", lambda *_: Kind(0.5, 0.05, 99.0)),
    ("places", lambda *_: Kind(0.05, 1e-3, 1.0 - 1e-3)),
    ("weights", lambda value, _: Kind(0.5 * value, 1e-2 * value, 1e2 * value)),
    ("tangent_in", lambda value, _: Kind(float(np.clip(0.5 * value, 2e-3, 0.05)), 1e-3, 9.9)),
    ("tangent_out", lambda value, _: Kind(float(np.clip(0.5 * value, 2e-3, 0.05)), 1e-3, 9.9)),
    ("", lambda _, largest: Kind(max(0.3 * largest, 0.02))),
)


def part_kind(path: str, unit: str | None, value: float, largest: float) -> Kind:
    """Of the parameter of a part at a path; `largest` is the largest magnitude in its field."""
    name = re.findall(r"[a-z_]\w*", path)[-1]
    if name in BY_NAME:
        return BY_NAME[name]
    if unit == "deg":
        return WEDGE if "wedge" in name else TURN
    rule = next(rule for ending, rule in BY_ENDING if name.endswith(ending))
    return rule(value, largest)
