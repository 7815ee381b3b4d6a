"""What a change of a parameter that matters is, and how far a parameter may go."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bladewright.derivatives.patterns import matching
from bladewright.designs import Design, unit_at
from bladewright.errors import DesignError, FitError
from bladewright.fitting.families.limits import Kind, part_kind
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

ANGLE = 89.0
"""largest angle [deg]"""
LEAST = 2e-5
"""smallest thickness and edge radius, of the meridional length"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scales:
    """Of k parameters, in the units of their fields."""

    size: Reals
    """(k,) a change that matters: the unit of a search, and how far a prior guess may be off"""
    low: Reals
    """(k,)"""
    high: Reals
    """(k,)"""


def scales_of(
    design: Design, paths: Sequence[str], chord: float, bounds: Mapping[str, tuple[float, float]] | None = None
) -> Scales:
    """Scales of a design's parameters, `chord` in metres, `bounds` by pattern within those of the family."""
    kinds = _kinds(design, paths, chord)
    size, low, high = (np.array([getattr(kind, name) for kind in kinds]) for name in ("size", "low", "high"))
    for pattern, (least, most) in (bounds or {}).items():
        for i in _matched(pattern, paths):
            low[i], high[i] = max(low[i], least), min(high[i], most)
    return Scales(size=size, low=low, high=high)


def check_bounds(design: Design, paths: Sequence[str], bounds: Mapping[str, tuple[float, float]]) -> None:
    """Refuse bounds of no parameter (k,) that is free, in the wrong order, or outside what the family allows."""
    for pattern, (least, most) in bounds.items():
        if not least < most:
            raise FitError(f"the bounds of {pattern} are {least:g} to {most:g}: the first must be below the second")
        try:
            matched = matching(pattern, paths)
        except DesignError as error:
            raise FitError(f"bounds: {error}") from error
        for path, kind in zip(matched, _kinds(design, matched, 1.0), strict=True):
            if not max(kind.low, least) < min(kind.high, most):
                raise FitError(
                    f"the bounds of {path} are {least:g} to {most:g}, and the family allows {kind.low:g} to "
                    f"{kind.high:g}: let them overlap"
                )


def _matched(pattern: str, paths: Sequence[str]) -> list[int]:
    """Places of the paths that a pattern matches: none where a structure has no such parameter."""
    try:
        found = set(matching(pattern, paths))
    except DesignError:
        return []
    return [place for place, path in enumerate(paths) if path in found]


def _kinds(design: Design, paths: Sequence[str], chord: float) -> list[Kind]:
    """What parameters are like, a law's by the values of all of it."""
    values = {path: float(value) for path, value in design.parameters().items()}
    fields: dict[str, list[float]] = {}
    for path, value in values.items():
        fields.setdefault(_field(path), []).append(value)
    size = {name: max(among) for name, among in fields.items()}
    extent = {name: float(np.sqrt(max(value**2 for value in among))) for name, among in fields.items()}
    return [
        part_kind(path, unit_at(design, path), values[path], extent[_field(path)])
        if path.startswith("section.")
        else _kind(design, path, values[path], size[_field(path)], chord)
        for path in paths
    ]


def _field(path: str) -> str:
    return path.partition("[")[0]


def _kind(design: Design, path: str, value: float, largest: float, chord: float) -> Kind:
    field = _field(path)
    length = chord / UNITS[getattr(design, "length_unit")]  # noqa: B009 - a field of every family, not of the base
    kinds = {
        "stagger": Kind(5.0, -ANGLE, ANGLE),
        "metal_angle": Kind(10.0, -ANGLE, ANGLE),
        "tangent": Kind(0.2, 0.02, 1.0),
        "leading_edge_radius": Kind(max(0.5 * largest, 1e-3), LEAST, 1.0),
        "trailing_edge_radius": Kind(max(0.5 * largest, 1e-3), LEAST, 1.0),
        "thickness": Kind(max(0.5 * largest, 0.02), LEAST, 5.0),
        "weights": Kind(0.5 * value, 1e-2 * value, 1e2 * value),
        "leading_edge_theta": Kind(float(np.degrees(0.05))),
        "axial_chord": Kind(0.05 * length, 1e-3 * length),
        **dict.fromkeys(("channel", "flow_path.", "leading_edge.", "trailing_edge."), Kind(0.005 * length)),
        "stacking.theta": Kind(float(np.degrees(0.05))),
    }
    return next((kind for name, kind in kinds.items() if field.startswith(name)), Kind(0.05 * length))
