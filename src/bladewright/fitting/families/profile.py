"""Where standard profiles begin; what none of them follows is followed by points."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from bladewright.fitting.families.section_shape import SectionShape
from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.circular_arc import DoubleCircularArc
from bladewright.section.profiles.flat_plate import FlatPlate
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.naca5 import Naca5
from bladewright.section.profiles.naca6 import Naca6
from bladewright.section.profiles.naca65 import Naca65
from bladewright.section.profiles.points import PointsProfile
from bladewright.section.profiles.profile import Profile

LIFT = 4.0 * np.pi / np.log(2.0)
"""design lift of a mean line of uniform load, over its camber (Abbott and von Doenhoff 1959, eq. 4.26)"""
EDGES: tuple[dict[str, Any], ...] = (
    {},
    {"trailing_edge": "round", "trailing_edge_thickness": 0.02},
    {"trailing_edge": "blunt", "trailing_edge_thickness": 0.02},
)
"""kinds of trailing edge: sharp, round, blunt"""
TEMPLATES: tuple[Profile, ...] = (
    *(Naca4(thickness=0.1, camber=0.02, camber_position=0.4, **edge) for edge in EDGES),
    *(Naca65(thickness=0.1, lift_coefficient=0.5, **edge) for edge in EDGES),
    *(C4(thickness=0.1, camber_angle=20.0, **edge) for edge in EDGES),
    *(Naca5(thickness=0.1, **edge) for edge in EDGES),
    DoubleCircularArc(thickness=0.06, camber_angle=20.0, leading_edge_radius=0.003, trailing_edge_radius=0.003),
    DoubleCircularArc(thickness=0.06, camber_angle=20.0),
    Naca6(series="65", thickness=0.1, design_lift=0.2),
    FlatPlate(thickness=0.06),
    FlatPlate(thickness=0.06, trailing_edge="blunt"),
    FlatPlate(thickness=0.06, leading_edge="elliptic", leading_edge_ratio=2.0),
    FlatPlate(thickness=0.06, leading_edge="elliptic", leading_edge_ratio=2.0, trailing_edge="blunt"),
    FlatPlate(thickness=0.06, leading_edge="blunt", trailing_edge="blunt"),
)
"""kinds that are tried where none is given"""


def first_parts(shape: SectionShape, like: Profile | None) -> Sequence[Profile]:
    """The profiles nearest to a section, by its thickness, camber and stagger."""
    return [_first(shape, each) for each in (TEMPLATES if like is None else [like])]


def _first(shape: SectionShape, like: Profile) -> Profile:
    if isinstance(like, PointsProfile):
        return through_points(shape, len(like.abscissas))
    maximum, _ = shape.thickest
    camber, position = shape.most_cambered
    turning = float(np.degrees(-np.diff(shape.angles(np.array([0.0, 1.0])))[0]))
    tail = float(shape.half(np.array([0.985]))[0])
    first, last = (float(np.clip(each, 5e-4, 0.2 * maximum)) for each in shape.radii)
    values: dict[str, Any] = {
        "stagger_angle": float(np.degrees(shape.stagger)),
        "thickness": float(np.clip(maximum, 0.01, 0.39)),
        "camber": float(np.clip(camber, -0.25, 0.25)),
        "camber_position": float(np.clip(position, 0.15, 0.25 if isinstance(like, Naca5) else 0.7)),
        "lift_coefficient": float(np.clip(LIFT * camber, -2.5, 2.5)),
        "design_lift": float(np.clip(LIFT * camber, -1.5, 1.5)),
        "camber_angle": float(np.clip(turning, -110.0, 110.0)),
        "leading_edge_radius": first,
        "trailing_edge_radius": last,
        "trailing_edge_thickness": float(np.clip(2.0 * tail / maximum, 0.01, 0.4)),
    }
    known = {each.name for each in fields(like) if "unit" in each.metadata and getattr(like, each.name) is not None}
    return replace(like, **{name: value for name, value in values.items() if name in known})


def through_points(shape: SectionShape, count: int) -> PointsProfile:
    """The contour through so many points of a section, from its trailing edge around the leading edge.

    They are as dense as the outline turns, and as it is long, in equal parts. A blunt edge has a point on each corner.
    """
    blunt = bool(np.any(shape.upper[-1] != shape.lower[-1]))
    around = np.concatenate([shape.upper[::-1], shape.lower[1:]])
    along = np.diff(around, axis=0)
    steps, heading = np.sqrt(np.sum(along**2, axis=-1)), np.arctan2(along[:, 1], along[:, 0])
    turns = np.abs((np.diff(heading, append=heading[-1:]) + np.pi) % (2.0 * np.pi) - np.pi)
    way = np.concatenate([[0.0], np.cumsum(steps / np.sum(steps) + turns / np.sum(turns))])
    at = np.linspace(0.0, way[-1], count, endpoint=blunt)
    x, y = (np.interp(at, way, around[:, i]) for i in (0, 1))
    return PointsProfile(
        stagger_angle=float(np.degrees(shape.stagger)), abscissas=tuple(x.tolist()), ordinates=tuple(y.tolist())
    )
