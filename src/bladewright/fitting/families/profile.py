"""Where standard profiles begin; what none of them follows is followed by points."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from bladewright.fitting.families.section_samples import SampledSection
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
TURNING = 0.6
"""share of a contour's points that are spread by its turning; the others are spread by its length."""
TEMPLATES: tuple[Profile, ...] = (
    Naca4(thickness=0.1, camber=0.02, camber_position=0.4),
    Naca4(thickness=0.1, camber=0.02, camber_position=0.4, trailing_edge="round"),
    Naca4(thickness=0.1, camber=0.02, camber_position=0.4, trailing_edge="blunt", trailing_edge_thickness=0.01),
    Naca65(thickness=0.1, lift_coefficient=0.5),
    Naca65(thickness=0.1, lift_coefficient=0.5, trailing_edge="round"),
    C4(thickness=0.1, camber_angle=20.0, trailing_edge="round"),
    DoubleCircularArc(thickness=0.06, camber_angle=20.0, leading_edge_radius=0.003, trailing_edge_radius=0.003),
    DoubleCircularArc(thickness=0.06, camber_angle=20.0),
    Naca5(thickness=0.1),
    Naca5(thickness=0.1, trailing_edge="blunt"),
    Naca6(series="65", thickness=0.1, design_lift=0.2),
    FlatPlate(thickness=0.06),
)
"""kinds that are tried where none is given"""


def templates(section: SampledSection, parameters: int | None) -> Sequence[Profile]:  # noqa: ARG001 - the contract's
    """Structures that are tried where none is given."""
    return TEMPLATES


def starts(section: SampledSection, like: Profile) -> Sequence[Profile]:
    """The profile of a structure nearest to a section."""
    return [_start(section, like)]


def _start(section: SampledSection, like: Profile) -> Profile:
    """The profile of a kind nearest to a section, by its thickness, camber and stagger."""
    if isinstance(like, PointsProfile):
        return _through(section, like)
    maximum, _ = section.thickest
    camber, position = section.most_cambered
    turning = float(np.degrees(section.angles[0] - section.angles[1]))
    radius_in, radius_out = (float(np.clip(each, 5e-4, 0.2 * maximum)) for each in section.radii)
    values: dict[str, Any] = {
        "stagger_angle": float(np.degrees(section.stagger)),
        "thickness": float(np.clip(maximum, 0.01, 0.4)),
        "camber": float(np.clip(camber, -0.25, 0.25)),
        "camber_position": float(np.clip(position, 0.15, 0.7)),
        "lift_coefficient": float(np.clip(LIFT * camber, -2.5, 2.5)),
        "design_lift": float(np.clip(LIFT * camber, -1.5, 1.5)),
        "camber_angle": float(np.clip(turning, -110.0, 110.0)),
        "leading_edge_radius": radius_in,
        "trailing_edge_radius": radius_out,
        "trailing_edge_thickness": float(np.clip(2.0 * section.half_at(0.985), 1e-3, 0.5 * maximum)),
    }
    known = {each.name for each in fields(like) if "unit" in each.metadata and getattr(like, each.name) is not None}
    if type(like).__name__ == "Naca5":
        values["camber_position"] = min(values["camber_position"], 0.25)
    return replace(like, **{name: value for name, value in values.items() if name in known})


def _through(section: SampledSection, like: PointsProfile) -> PointsProfile:
    """As many points of the section as the profile has, from its trailing edge around the leading edge.

    They are as dense as the section turns and, less so, as it is long: where a contour turns fast it has a corner.
    """
    count = len(like.abscissas)
    around = np.concatenate([section.upper[::-1], section.lower[1:-1]])
    along = np.diff(around, axis=0, append=around[:1])
    steps = np.sqrt(np.sum(along**2, axis=-1))
    heading = np.arctan2(along[:, 1], along[:, 0])
    turns = np.abs((np.diff(heading, prepend=heading[-1:]) + np.pi) % (2.0 * np.pi) - np.pi)
    pace = (1.0 - TURNING) * steps / np.sum(steps) + TURNING * turns / np.sum(turns)
    way = np.concatenate([[0.0], np.cumsum(pace)[:-1]])
    at = np.linspace(0.0, float(np.sum(pace)), count, endpoint=False)
    x, y = (np.interp(at, way, around[:, i]) for i in (0, 1))
    return replace(
        like,
        stagger_angle=float(np.degrees(section.stagger)),
        abscissas=tuple(x.tolist()),
        ordinates=tuple(y.tolist()),
    )


def through_points(section: SampledSection, count: int) -> PointsProfile:
    """The contour through so many points of a section."""
    places = (0.0,) * count
    return _through(section, PointsProfile(abscissas=places, ordinates=places))


def extensions(part: Profile, section: SampledSection) -> Sequence[Profile]:  # noqa: ARG001 - what every family answers
    """None: a kind of profile has its parameters."""
    return ()
