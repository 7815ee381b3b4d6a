"""Where a section by its suction and pressure side begins."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bladewright.fitting.families.section_shape import SectionShape
from bladewright.fitting.models.planar import SINGLE_SECTION
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_points
from bladewright.section.suction_pressure.part import SuctionPressure, skeleton_of
from bladewright.section.suction_pressure.side import DEGREE, default_places, places_off_line, side_knots

TEMPLATE = SuctionPressure(
    stagger_angle=0.0,
    metal_angle_in=0.0,
    metal_angle_out=0.0,
    leading_edge_radius=0.01,
    leading_edge_wedge=10.0,
    trailing_edge_radius=0.01,
    trailing_edge_wedge=6.0,
    suction_tangent_in=0.08,
    suction_tangent_out=0.08,
    suction_heights=(0.1,) * 4,
    pressure_tangent_in=0.08,
    pressure_tangent_out=0.08,
    pressure_heights=(0.0,) * 4,
)
"""the part whose structure is tried where none is given"""
WEDGES = (25.0, 50.0, 75.0)
"""wedge angles of the leading edge that are tried [deg]: how far an edge extends is ambiguous, as the sides beside it
may be taken for parts of it (design/matching_constants.md)"""


def first_parts(shape: SectionShape, like: SuctionPressure | None) -> Sequence[SuctionPressure]:
    """The parts nearest to a section: its edges by their radii, and sides at its heights over the skeleton line."""
    if like is not None:
        tried = [like]
    else:
        sided = replace(TEMPLATE, suction_side="upper" if shape.most_cambered[0] > 0.0 else "lower")
        tried = [replace(sided, skeleton="pseudo"), sided]
    return [_first(shape, each, wedge) for each in tried for wedge in WEDGES]


def _first(shape: SectionShape, like: SuctionPressure, wedge: float) -> SuctionPressure:
    tail = shape.half(np.array([0.85, 0.95]))
    last = 2.0 * np.degrees(np.arctan((tail[0] - tail[1]) / 0.1))
    ends = np.degrees(np.clip(shape.stagger + shape.angles(np.array([0.0, 1.0])), -1.5, 1.5))
    values: dict[str, Any] = {
        "stagger_angle": float(np.degrees(shape.stagger)),
        "leading_edge_wedge": wedge,
        "trailing_edge_wedge": float(np.clip(last, 2.0, 40.0)),
    }
    for end, (edge, angle) in enumerate((("leading_edge", "metal_angle_in"), ("trailing_edge", "metal_angle_out"))):
        values |= {
            angle: float(ends[end]),
            f"{edge}_radius": float(np.clip(shape.radii[end], 1e-3, 0.15)),
            f"{edge}_stretch": 1.0,
            f"{edge}_skew": 0.0,
        }
    part = replace(like, **values)
    sides = (shape.upper, shape.lower) if part.suction_side == "upper" else (shape.lower, shape.upper)
    line = np.real(skeleton_of(part, SINGLE_SECTION))[0]
    changes: dict[str, Any] = {}
    for name, side in zip(("suction", "pressure"), sides, strict=True):
        heights = getattr(part, f"{name}_heights")
        knots = side_knots(len(heights), getattr(part, f"{name}_knots"))
        for way, width in (("in", knots[DEGREE + 1]), ("out", 1.0 - knots[-DEGREE - 2])):
            if getattr(part, f"{name}_tangent_{way}") is not None:
                changes[f"{name}_tangent_{way}"] = float(width) / DEGREE
        if heights:
            inner = side[1:-1]
            along, above = places_off_line(line, inner, np.clip(inner[:, 0], 0.01, 0.99))
            places = _places(getattr(part, f"{name}_places"), knots)
            changes[f"{name}_heights"] = tuple(np.interp(places, along, above).tolist())
    if part.pressure_thickness:
        knots = side_knots(len(part.pressure_thickness), part.pressure_knots)
        places = _places(part.pressure_places, knots)
        changes["pressure_thickness"] = tuple(np.maximum(2.0 * shape.half(places), 1e-3).tolist())
    return replace(part, **changes)


def _places(given: Any, knots: Reals) -> Reals:
    return np.array([float(np.mean(law_points(law))) for law in given]) if given else default_places(knots)
