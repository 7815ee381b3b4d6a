"""Where a section on a mean line of given second derivative begins."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bladewright.fitting.families.section_shape import SectionShape
from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import law_points
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import RATIOS, Wennerstrom

_BODY: dict[str, Any] = {"maximum_thickness": 0.1, "maximum_thickness_at": 0.4}
_ROUND: dict[str, Any] = {**_BODY, "leading_edge_thickness": 0.02, "trailing_edge_thickness": 0.02}
TEMPLATES = tuple(
    CurvatureMeanline(metal_angle_in=0.0, metal_angle_out=0.0, curvature=(1.0,) * 4, thickness=law)
    for law in (
        # the end that is straight is held: where it changes, edges of different thickness make the shape jump
        Wennerstrom(**_ROUND, straight_end="leading"),
        Wennerstrom(**_ROUND, straight_end="trailing"),
        Wennerstrom(**_ROUND, straight_end="leading", trailing_edge="blunt"),
        Wennerstrom(**_ROUND, straight_end="trailing", trailing_edge="blunt"),
        ModifiedNaca(**_BODY, trailing_edge_thickness=0.02, trailing_edge_slope=-0.1),
        QuarticSpline(**_ROUND),
        QuarticSpline(**_ROUND, trailing_edge="sharp"),
    )
)
"""parts whose structures are tried where none is given"""
STRAIGHT = np.radians(0.5)
"""turning of a mean line [rad] below which the shape of its second derivative cannot be seen"""
LEAST_CURVATURE = 0.1
"""smallest control point of the second derivative to begin with, of the largest: of one sign, it always has a shape"""


def first_parts(shape: SectionShape, like: CurvatureMeanline | None) -> Sequence[CurvatureMeanline]:
    """The parts nearest to a section: its angles, the bends of its mean line, and its thickness."""
    ends = np.degrees(np.clip(shape.stagger + shape.angles(np.array([0.0, 1.0])), -1.5, 1.5))
    found = []
    for each in TEMPLATES if like is None else [like]:
        inner = [_number(place) for place in each.curvature_places]
        places = np.array([0.0, *inner, 1.0]) if inner else np.linspace(0.0, 1.0, len(each.curvature))
        found.append(
            replace(
                each,
                metal_angle_in=float(ends[0]),
                metal_angle_out=float(ends[1]),
                curvature=tuple(_curvatures(shape, places).tolist()) if each.curvature else (),
                curvature_places=tuple(inner),
                thickness=replace(each.thickness, **_thickness(shape, each.thickness)),
                thickness_multiplier=(0.0,) * len(each.thickness_multiplier),
            )
        )
    return found


def _curvatures(shape: SectionShape, places: Reals) -> Reals:
    """The second derivative of the mean line at places, of its largest."""
    bends = shape.camber.deriv(2)(places)
    if abs(np.ptp(shape.angles(np.array([0.0, 1.0])))) < STRAIGHT:
        return np.ones(len(places))
    bends = bends / bends[np.argmax(bends**2)]
    return np.asarray(np.maximum(bends, LEAST_CURVATURE))


def _thickness(shape: SectionShape, law: Any) -> dict[str, Any]:
    """The fields of a thickness law that a section shows."""
    maximum, at = shape.thickest
    # a half thickness of an ellipse's radius of curvature b^2 / a, with a = ratio b
    ends = [2.0 * radius * ratio for radius, ratio in zip(shape.radii, _ratios(law), strict=True)]
    first, tail, last, end = (float(each) for each in shape.half(np.array([0.03, 0.85, 0.95, 0.985])))
    known: dict[str, Any] = {
        "maximum_thickness": maximum,
        "maximum_thickness_at": float(np.clip(at, 0.15, 0.8)),
        "leading_edge_thickness": ends[0],
        "trailing_edge_thickness": 2.0 * last if _field(law, "trailing_edge") == "blunt" else ends[1],
    }
    if isinstance(law, ModifiedNaca):
        # the radius of the leading edge is 1.1019 (thickness I / 6)^2 (NACA Report 492)
        index = 6.0 * np.sqrt(shape.radii[0] / 1.1019) / maximum
        known |= {
            "leading_edge_index": float(np.clip(index, 1.0, 11.0)),
            "trailing_edge_slope": float(np.clip(10.0 * (last - tail), -1.0, -0.01)),
            "trailing_edge_thickness": 2.0 * end,
        }
    if isinstance(law, QuarticSpline):
        # this law works with its maximum near 0.3
        known |= {
            "maximum_thickness_at": 0.3,
            "leading_edge_thickness": 2.0 * first,
            "trailing_edge_thickness": 2.0 * last,
        }
    for name in ("leading_edge_thickness", "trailing_edge_thickness"):
        known[name] = float(np.clip(known[name], 0.02 * maximum, 0.6 * maximum))
    return {name: value for name, value in known.items() if _field(law, name) is not None}


def _ratios(law: Any) -> tuple[float, float]:
    """Ratios of the axes of elliptic edges."""
    given = (_field(law, f"{edge}_ratio") for edge in RATIOS)
    first, last = (_number(ratio or usual) for ratio, usual in zip(given, RATIOS.values(), strict=True))
    return first, last


def _field(law: Any, name: str) -> Any:
    return vars(law).get(name)


def _number(law: Any) -> float:
    return float(np.mean(law_points(law)))
