"""Where a section on a mean line of given second derivative begins, and which control points may be added."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bladewright.designs import ChordwiseLaw, Law
from bladewright.fitting.families.section_samples import SampledSection
from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import law_points
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

CURVATURES, MULTIPLIERS = 4, 5
"""control points of the second derivative and of the thickness multiplier (`MULTIPLIERS`) to begin with"""
MOST_CONTROL_POINTS = 14
"""control points of either law at most; it bounds the time of growth."""
STRAIGHT_CAMBER = np.radians(0.5)
"""camber [rad] below which the second derivative is taken as constant: its shape cannot be seen."""
LEAST_CURVATURE = 0.1
"""smallest control point of the second derivative to begin with, of the largest."""
FREE_PLACES_FROM = 2
"""control points of the second derivative up to which they have no places of their own"""
REFLEX_RATIO = 0.7
"""ratio of a mean line's turning to its total bending below which it clearly bends back."""
_EVEN = (1.0,) * CURVATURES
_LAWS = (
    Wennerstrom(
        maximum_thickness=0.1, maximum_thickness_at=0.4, leading_edge_thickness=0.02, trailing_edge_thickness=0.02
    ),
    ModifiedNaca(
        maximum_thickness=0.1, maximum_thickness_at=0.4, trailing_edge_thickness=0.02, trailing_edge_slope=-0.1
    ),
    QuarticSpline(
        maximum_thickness=0.1, maximum_thickness_at=0.4, leading_edge_thickness=0.03, trailing_edge_thickness=0.02
    ),
    Wennerstrom(
        maximum_thickness=0.1,
        maximum_thickness_at=0.4,
        leading_edge_thickness=0.02,
        trailing_edge="blunt",
        trailing_edge_thickness=0.02,
    ),
    QuarticSpline(
        maximum_thickness=0.1,
        maximum_thickness_at=0.4,
        leading_edge_thickness=0.03,
        trailing_edge_thickness=0.008,
        trailing_edge="sharp",
    ),
)
TEMPLATES = tuple(
    CurvatureMeanline(metal_angle_in=0.0, metal_angle_out=0.0, curvature=_EVEN, thickness=law) for law in _LAWS
)
"""structures that are tried where none is given"""


def templates(section: SampledSection, parameters: int | None) -> Sequence[CurvatureMeanline]:  # noqa: ARG001 - the contract's
    """Structures that are tried where none is given."""
    return TEMPLATES


def starts(section: SampledSection, like: CurvatureMeanline) -> Sequence[CurvatureMeanline]:
    """The part of a structure nearest to a section."""
    return [_start(section, like)]


def _start(section: SampledSection, like: CurvatureMeanline) -> CurvatureMeanline:
    """The part of a structure nearest to a section: its angles, the bends of its mean line, and its thickness."""
    angles = [float(np.degrees(np.clip(section.stagger + each, -1.5, 1.5))) for each in section.angles]
    found = replace(like, metal_angle_in=angles[0], metal_angle_out=angles[1], thickness=_thickness(section, like))
    if like.curvature:
        inner = [_number(each) for each in like.curvature_places]
        places = np.array([0.0, *inner, 1.0]) if inner else np.linspace(0.0, 1.0, len(like.curvature))
        found = replace(
            found, curvature=tuple(float(each) for each in _curvatures(section, places)), curvature_places=tuple(inner)
        )
    zeros = (0.0,) * len(like.thickness_multiplier)
    return replace(found, thickness_multiplier=zeros)


def _curvatures(section: SampledSection, places: Reals) -> Reals:
    """Control points of the second derivative; of one sign unless the mean line clearly bends back."""
    turning = np.tan(section.angles[1]) - np.tan(section.angles[0])
    if turning**2 < STRAIGHT_CAMBER**2:
        return np.ones(len(places))
    # higher powers bend back at the edges, where the mean line is badly known
    u = np.linspace(0.03, 0.97, 60)
    bends = np.polynomial.Polynomial.fit(u, section.mean(u), 4).deriv(2)(places) / turning
    even = np.maximum(bends, LEAST_CURVATURE * np.max(bends))
    total = np.trapezoid(bends, places)
    # a line that bends back turns less than it bends
    back = 0.0 < total < REFLEX_RATIO * np.trapezoid(np.abs(bends), places)
    return np.asarray(bends / np.max(np.abs(bends)) if back else even / np.max(even))


def _thickness(section: SampledSection, like: CurvatureMeanline) -> Wennerstrom | ModifiedNaca | QuarticSpline:
    law = like.thickness
    maximum, at = section.thickest
    # a thick leading edge may show the largest half thickness at the edge
    at = float(np.clip(at, 0.15, 0.8))
    # the thickness of an edge is that of the ellipse with the section's radius
    first, last = (
        float(np.clip(2.0 * radius * ratio, 0.02 * maximum, 0.6 * maximum))
        for radius, ratio in zip(section.radii, _ratios(law), strict=True)
    )
    behind = float(np.clip(2.0 * section.half_at(0.985), 0.01 * maximum, 0.6 * maximum))
    if isinstance(law, Wennerstrom):
        return replace(
            law,
            maximum_thickness=maximum,
            maximum_thickness_at=at,
            leading_edge_thickness=None if law.leading_edge == "sharp" else first,
            trailing_edge_thickness={"sharp": None, "blunt": behind}.get(law.trailing_edge, last),
        )
    if isinstance(law, ModifiedNaca):
        index = float(np.clip(6.0 * np.sqrt(max(section.radii[0], 1e-6) / 1.1019) / maximum, 1.0, 11.0))
        slope = float(np.clip((section.half_at(0.97) - section.half_at(0.85)) / 0.12, -1.0, -0.01))
        return replace(
            law,
            leading_edge_index=index,
            maximum_thickness=maximum,
            maximum_thickness_at=at,
            trailing_edge_thickness=None if law.trailing_edge == "sharp" else behind,
            trailing_edge_slope=None if law.trailing_edge_slope is None else slope,
        )
    return replace(
        law,
        maximum_thickness=maximum,
        maximum_thickness_at=at,
        leading_edge_thickness=float(np.clip(2.0 * section.half_at(0.03), 0.1 * maximum, 0.7 * maximum)),
        trailing_edge_thickness=float(np.clip(2.0 * section.half_at(0.95), 0.05 * maximum, 0.5 * maximum)),
    )


def _ratios(law: Wennerstrom | ModifiedNaca | QuarticSpline) -> tuple[float, float]:
    if not isinstance(law, Wennerstrom):
        return 1.0, 1.0
    return _number(law.leading_edge_ratio or 1.0), _number(law.trailing_edge_ratio or 1.0)


def _number(law: Law) -> float:
    return float(np.mean(law_points(law)))


def extensions(part: CurvatureMeanline, section: SampledSection) -> Sequence[CurvatureMeanline]:  # noqa: ARG001 - the contract's
    """The part with one control point more of the second derivative or of the thickness multiplier, or free places."""
    found = []
    if part.curvature and not part.curvature_places and len(part.curvature) < MOST_CONTROL_POINTS:
        found.append(replace(part, curvature=_wider(part.curvature)))
    if len(part.curvature) > FREE_PLACES_FROM and not part.curvature_places:
        places = np.linspace(0.0, 1.0, len(part.curvature))[1:-1]
        found.append(replace(part, curvature_places=tuple(places.tolist())))
    count = len(part.thickness_multiplier)
    if not part.thickness_multiplier_places and count < MOST_CONTROL_POINTS:
        wider = _wider(part.thickness_multiplier) if count else (0.0,) * MULTIPLIERS
        found.append(replace(part, thickness_multiplier=wider))
    return found


def _wider(laws: ChordwiseLaw) -> tuple[float, ...]:
    """One control point more on the same polygon."""
    count = len(laws)
    at = np.linspace(0.0, 1.0, count + 1)
    return tuple(np.interp(at, np.linspace(0.0, 1.0, count), [_number(law) for law in laws]).tolist())
