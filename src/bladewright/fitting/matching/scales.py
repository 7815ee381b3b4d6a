"""What change of a parameter matters, and how far a parameter may go."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bladewright.derivatives.patterns import matching
from bladewright.designs import Design, Part, limits_at, unit_at
from bladewright.errors import DesignError, FitError
from bladewright.fitting.checks import is_number, texts
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

SMALLEST_LENGTH = 2e-5
"""smallest thickness and edge radius, of the chord: about what can be made (design/matching_constants.md)"""
LARGEST_ANGLE = 89.0
"""largest angle [deg]: at 90 deg the tangent that places the camber is infinite (design/matching_constants.md)"""


class ParameterRange(NamedTuple):
    """Of one parameter, in the unit of its field."""

    size: float
    """a change that matters"""
    low: float = -np.inf
    high: float = np.inf


WEDGE_RANGE, ANGLE_RANGE = ParameterRange(3.0, 0.0, LARGEST_ANGLE), ParameterRange(5.0, -LARGEST_ANGLE, LARGEST_ANGLE)
"""of a wedge angle and of any other angle [deg]"""
SIZE_BY_NAME = {
    **dict.fromkeys(("abscissas", "ordinates"), 0.01),
    **dict.fromkeys(("camber", "leading_edge_curvature", "trailing_edge_curvature"), 0.02),
    **dict.fromkeys(("suction_heights", "pressure_heights"), 0.02),
    **dict.fromkeys(("suction_places", "pressure_places"), 0.05),
    **dict.fromkeys(("camber_position", "front_camber", "uniform_load", "transition"), 0.1),
    **dict.fromkeys(("maximum_thickness_at", "thickness_multiplier", "trailing_edge_slope"), 0.1),
    **dict.fromkeys(("lift_coefficient", "design_lift", "trailing_edge_slope_factor"), 0.3),
}
"""of fields whose size the values do not tell, a change that matters"""
ON_BOUND = 1e-9
"""distance from a bound, of a parameter's scale, within which it is held by it (design/matching_constants.md)"""
INSIDE = 1e-3
"""how far inside its field's limits a parameter stays, of its size, for derivatives (design/matching_constants.md)"""

OPEN = -np.inf, np.inf
"""bounds that hold nothing"""

RangeRule = Callable[[float, float], ParameterRange]
"""from a parameter's value and the largest magnitude in its field"""
RANGE_BY_ENDING: tuple[tuple[str | tuple[str, ...], RangeRule], ...] = (
    ("radius", lambda _, largest: ParameterRange(max(0.5 * largest, 1e-3), SMALLEST_LENGTH)),
    ("thickness", lambda _, largest: ParameterRange(max(0.5 * largest, 0.01), SMALLEST_LENGTH)),
    (("stretch", "scale"), lambda *_: ParameterRange(0.3, 0.05)),
    ("index", lambda *_: ParameterRange(1.0, 0.05)),
    ("skew", lambda *_: ParameterRange(0.2, -0.95, 0.95)),
    ("ratio", lambda *_: ParameterRange(0.5, 0.05)),
    ("places", lambda *_: ParameterRange(0.05, 1e-3, 1.0 - 1e-3)),
    ("weights", lambda value, _: ParameterRange(0.5 * value, 1e-2 * value, 1e2 * value)),
    (("tangent_in", "tangent_out"), lambda value, _: ParameterRange(float(np.clip(0.5 * value, 2e-3, 0.05)), 1e-3)),
    ("", lambda _, largest: ParameterRange(max(0.3 * largest, 0.02))),
)
"""of other fields of a part by the end of their name; the first ending that matches counts"""


def part_range(part: Part, path: str, value: float, largest: float) -> ParameterRange:
    """The range of a part's parameter at a path; `largest` is the largest magnitude in its field."""
    name = re.findall(r"[a-z_]\w*", re.sub(r"\.values\[\d+\]$", "", path))[-1]
    if name in SIZE_BY_NAME:
        found = ParameterRange(SIZE_BY_NAME[name])
    elif unit_at(part, path) == "deg":
        found = WEDGE_RANGE if "wedge" in name else ANGLE_RANGE
    else:
        found = next(rule for ending, rule in RANGE_BY_ENDING if name.endswith(ending))(value, largest)
    limits = limits_at(part, path)
    if limits is None:
        return found
    inside = 0.0 if limits.closed else INSIDE * found.size
    return ParameterRange(found.size, max(found.low, limits.low + inside), min(found.high, limits.high - inside))


@dataclass(frozen=True, kw_only=True, eq=False)
class Scales:
    """Of k parameters, in the units of their fields."""

    size: Reals
    """(k,) a change that matters: the unit of a search, and how far a first guess may be off"""
    low: Reals
    """(k,) lowest values"""
    high: Reals
    """(k,) highest values"""

    def inside(self, values: Reals) -> NDArray[np.bool_]:
        """Which of the parameters (k,) lie on none of their bounds, apart from rounding."""
        return np.minimum(values - self.low, self.high - values) > ON_BOUND * self.size


def scales_of(
    design: Design, paths: Sequence[str], chord: float, bounds: Mapping[str, tuple[float, float]] | None = None
) -> Scales:
    """Scales of a design's parameters; `chord` in metres, `bounds` by pattern within those of the family."""
    kinds = _ranges(design, paths, chord)
    size, low, high = (np.array([getattr(kind, name) for kind in kinds]) for name in ("size", "low", "high"))
    for pattern, (least, most) in (bounds or {}).items():
        # a structure may have no such parameter
        with suppress(DesignError):
            for i in map(paths.index, matching(pattern, paths)):
                low[i], high[i] = max(low[i], least), min(high[i], most)
    return Scales(size=size, low=low, high=high)


def given_bounds(given: Any) -> dict[str, tuple[float, float]]:
    """The bounds that were asked for, infinite where one is None; refuse those of no shape, or in the wrong order."""
    given = {} if given is None else given
    if not isinstance(given, Mapping):
        raise FitError(
            f"bounds are {given!r}: a mapping from patterns to pairs is needed, such as {{'stagger': (5, 9)}}"
        )
    bounds = dict[str, tuple[float, float]]()
    for pattern, pair in zip(texts("bounds", given), given.values(), strict=True):
        ends = tuple(pair) if isinstance(pair, Iterable) else ()
        if len(ends) != 2 or not all(each is None or is_number(each) for each in ends):
            raise FitError(
                f"the bounds of {pattern} are {pair!r}: the lowest and the highest value are needed, such as (5, 9), "
                "or None for one that is open"
            )
        least, most = (open_end if each is None else float(each) for each, open_end in zip(ends, OPEN, strict=True))
        if not least < most:
            raise FitError(f"the bounds of {pattern} are {least:g} to {most:g}: the first must be below the second")
        bounds[pattern] = least, most
    return bounds


def check_bounds(design: Design, paths: Sequence[str], bounds: Mapping[str, tuple[float, float]]) -> None:
    """Refuse bounds of no free parameter (k,), or outside what the family allows."""
    for pattern, (least, most) in bounds.items():
        try:
            matched = matching(pattern, paths)
        except DesignError as error:
            with suppress(DesignError):
                matching(pattern, design.parameters())
                raise FitError(
                    f"'{pattern}' is held and has bounds at once: it is fixed, or not among what is free; leave its "
                    "bounds out, or let it change"
                ) from error
            raise FitError(f"bounds: {error}") from error
        for path, kind in zip(matched, _ranges(design, matched, 1.0), strict=True):
            if not max(kind.low, least) < min(kind.high, most):
                raise FitError(
                    f"the bounds of {path} are {least:g} to {most:g}, and the family allows {kind.low:g} to "
                    f"{kind.high:g}: let them overlap"
                )


def _ranges(design: Design, paths: Sequence[str], chord: float) -> list[ParameterRange]:
    """Ranges of parameters; a law's sizes follow from the largest magnitude in all of it."""
    values, largest = design.parameters(), dict[str, float]()
    for path, value in values.items():
        name = path.partition("[")[0]
        largest[name] = max(largest.get(name, 0.0), abs(float(value)))
    return [_range(design, path, float(values[path]), largest[path.partition("[")[0]], chord) for path in paths]


def _range(design: Design, path: str, value: float, largest: float, chord: float) -> ParameterRange:
    """The range of a parameter at a path; `largest` is the largest magnitude in its field."""
    if path.startswith("section."):
        return part_range(design, path, value, largest)
    length = chord / UNITS[getattr(design, "length_unit")]  # noqa: B009 - a field of every family, not of the base
    radius = ParameterRange(max(0.5 * largest, 1e-3), SMALLEST_LENGTH, 0.999)
    kinds = {
        "stagger": ANGLE_RANGE,
        "metal_angle": ParameterRange(10.0, -LARGEST_ANGLE, LARGEST_ANGLE),
        "tangent": ParameterRange(0.2, 0.05, 1.0),
        **dict.fromkeys(("leading_edge_radius", "trailing_edge_radius"), radius),
        "thickness": ParameterRange(max(0.5 * largest, 0.02), SMALLEST_LENGTH, 5.0),
        "weights": ParameterRange(0.5 * value, 1e-2 * value, 1e2 * value),
        **dict.fromkeys(("leading_edge_theta", "stacking.theta"), ParameterRange(float(np.degrees(0.05)))),
        "axial_chord": ParameterRange(0.05 * length, 1e-3 * length),
        **dict.fromkeys(("channel", "flow_path.", "leading_edge.", "trailing_edge."), ParameterRange(0.02 * length)),
    }
    return next((kind for name, kind in kinds.items() if path.startswith(name)), ParameterRange(0.05 * length))
