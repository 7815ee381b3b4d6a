"""Where sections of the families that are one part begin: the part of numbers nearest to a section."""

from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch
from typing import Any

import numpy as np

from bladewright.fitting.families.closed_blade import PLACES, SectionShape
from bladewright.fitting.free_parameters import parameter_range
from bladewright.fitting.models.designs import SINGLE_SECTION
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_angle import ANGLE, CamberAngle
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.laws import law_basis
from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.circular_arc import DoubleCircularArc
from bladewright.section.profiles.flat_plate import FlatPlate
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.naca5 import Naca5
from bladewright.section.profiles.naca6 import Naca6
from bladewright.section.profiles.naca65 import Naca65
from bladewright.section.profiles.points import PointsProfile
from bladewright.section.profiles.profile import Profile
from bladewright.section.suction_pressure.part import SuctionPressure, skeleton_of
from bladewright.section.suction_pressure.side import DEGREE, default_places, places_off_line, side_knots
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import RATIOS, Wennerstrom
from bladewright.section.wedge_diffuser import WedgeDiffuser

ENDS: Reals = np.array([0.0, 1.0])
"""chord fractions of leading and trailing edge"""


@singledispatch
def first_part(like: Any, shape: SectionShape) -> Any:
    """The part of a structure, one of numbers, that is nearest to a section."""
    raise NotImplementedError(f"no first {type(like).__name__} is known near a section of chord {shape.chord:g}")


CAMBER_ANGLES = tuple(
    CamberAngle(camber_angle=(0.0,) * 4, half_thickness=(0.02,) * 5, trailing_edge=edge)
    for edge in ("round", "blunt", "sharp")
)
"""parts whose structures are tried where none is given: one for each kind of trailing edge"""


@first_part.register
def _(like: CamberAngle, shape: SectionShape) -> CamberAngle:
    """By least squares of its angle, and the half thickness at the places of its control points."""
    # fractions of the meridional extent
    fraction = PLACES - shape.camber(PLACES) * np.tan(shape.stagger)
    rows = law_basis(len(like.camber_angle), np.clip(fraction, 0.0, 1.0))
    angles = np.degrees(shape.stagger + np.linalg.lstsq(rows, shape.angles(PLACES), rcond=None)[0])
    outline = replace(like, half_thickness=(0.01,) * len(like.half_thickness)).outline(SINGLE_SECTION)
    places = np.real(outline.places.controls)[0][1 : 1 + len(like.half_thickness)]
    heights = np.maximum(np.interp(places, fraction, shape.half(PLACES)), 0.05 * shape.thickest[0])
    clipped = np.clip(angles, 0.99 * ANGLE.low, 0.99 * ANGLE.high)
    return replace(like, camber_angle=tuple(clipped.tolist()), half_thickness=tuple(heights.tolist()))


_BODY: dict[str, Any] = {"maximum_thickness": 0.1, "maximum_thickness_at": 0.4}
_ROUND: dict[str, Any] = {**_BODY, "leading_edge_thickness": 0.02, "trailing_edge_thickness": 0.02}
CURVATURE_MEANLINES = tuple(
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
"""smallest control point of the second derivative at first, of the largest: one sign (design/matching_constants.md)"""


@first_part.register
def _(like: CurvatureMeanline, shape: SectionShape) -> CurvatureMeanline:
    """By its angles, the bends of its mean line, and its thickness."""
    inner = like.curvature_places
    places = np.array([0.0, *inner, 1.0]) if inner else np.linspace(0.0, 1.0, len(like.curvature))
    turned = abs(np.ptp(shape.angles(ENDS))) >= STRAIGHT
    bends = shape.camber.deriv(2)(places) if turned else np.ones(len(places))
    if like.curvature:
        bends = np.maximum(bends / bends[np.argmax(bends**2)], LEAST_CURVATURE)
    return replace(
        like,
        **_metal_angles(shape),
        curvature=tuple(bends.tolist()),
        thickness=replace(like.thickness, **_thickness(shape, like.thickness)),
        thickness_multiplier=(0.0,) * len(like.thickness_multiplier),
    )


def _metal_angles(shape: SectionShape) -> dict[str, Any]:
    first, last = np.degrees(np.clip(shape.stagger + shape.angles(ENDS), -1.5, 1.5))
    return {"metal_angle_in": float(first), "metal_angle_out": float(last)}


def _thickness(shape: SectionShape, law: Any) -> dict[str, Any]:
    """The fields of a thickness law that a section shows."""
    given, (maximum, at) = vars(law), shape.thickest
    # the radius of curvature of an ellipse whose half height is b is b / ratio
    ratios = [given.get(f"{edge}_ratio") or usual for edge, usual in RATIOS.items()]
    first, last = (2.0 * radius * ratio for radius, ratio in zip(shape.radii, ratios, strict=True))
    if given.get("trailing_edge") == "blunt":
        last = 2.0 * float(shape.half(np.array([0.95]))[0])
    known = {
        "maximum_thickness": maximum,
        "maximum_thickness_at": float(np.clip(at, 0.15, 0.8)),
        "leading_edge_thickness": float(np.clip(first, 0.02 * maximum, 0.6 * maximum)),
        "trailing_edge_thickness": float(np.clip(last, 0.02 * maximum, 0.6 * maximum)),
    }
    return {name: value for name, value in known.items() if given.get(name) is not None}


SUCTION_PRESSURE = SuctionPressure(
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
"""wedge angles of the leading edge that are tried [deg], as sides may be taken for it (design/matching_constants.md)"""


def suction_pressures(shape: SectionShape) -> Sequence[SuctionPressure]:
    """Parts whose structures are tried where none is given."""
    sided = replace(SUCTION_PRESSURE, suction_side="upper" if shape.most_cambered[0] > 0.0 else "lower")
    both = [replace(sided, skeleton="pseudo"), sided]
    kinds = [*both, *(replace(each, edges="C1") for each in both)]
    return [replace(each, leading_edge_wedge=wedge) for each in kinds for wedge in WEDGES]


@first_part.register
def _(like: SuctionPressure, shape: SectionShape) -> SuctionPressure:
    """By its edges' radii, and sides at its heights over the skeleton line; the leading edge's wedge angle is kept."""
    tail = shape.half(np.array([0.85, 0.95]))
    last = 2.0 * np.degrees(np.arctan((tail[0] - tail[1]) / 0.1))
    values: dict[str, Any] = {
        "stagger_angle": float(np.degrees(shape.stagger)),
        "trailing_edge_wedge": float(np.clip(last, 2.0, 40.0)),
        **_metal_angles(shape),
    }
    for edge, radius in zip(("leading_edge", "trailing_edge"), shape.radii, strict=True):
        values |= {f"{edge}_radius": float(np.clip(radius, 1e-3, 0.15)), f"{edge}_stretch": 1.0, f"{edge}_skew": 0.0}
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
            places = getattr(part, f"{name}_places") or default_places(knots)
            changes[f"{name}_heights"] = tuple(np.interp(places, along, above).tolist())
    if part.pressure_thickness:
        knots = side_knots(len(part.pressure_thickness), part.pressure_knots)
        places = np.array(part.pressure_places or default_places(knots))
        changes["pressure_thickness"] = tuple(np.maximum(2.0 * shape.half(places), 1e-3).tolist())
    return replace(part, **changes)


WEDGE_DIFFUSERS = (
    WedgeDiffuser(stagger_angle=0.0, leading_edge_radius=0.01, trailing_edge_radius=0.01, wedge_angle=8.0),
    WedgeDiffuser(stagger_angle=0.0, leading_edge_radius=0.01, trailing_edge_radius=0.05),
)
"""parts whose structures are tried where none is given: with a back face, and without"""


@first_part.register
def _(like: WedgeDiffuser, shape: SectionShape) -> WedgeDiffuser:
    """By its stagger, the line through its half thickness, and its edges."""
    straight = np.linspace(0.2, 0.8, 31)
    opening, first = np.polyfit(straight, shape.half(straight), 1)
    last = float(np.clip(first + opening, 2e-3, 0.3))
    angle = float(np.clip(np.degrees(2.0 * np.arctan(opening)), 1.0, 60.0))
    return replace(
        like,
        stagger_angle=float(np.degrees(shape.stagger)),
        leading_edge_radius=float(np.clip(first, 1e-3, 0.2)),
        # the corners of a back face are rounded by much less than its half width
        trailing_edge_radius=last if like.wedge_angle is None else 0.2 * last,
        wedge_angle=None if like.wedge_angle is None else angle,
    )


LIFT = 4.0 * np.pi / np.log(2.0)
"""design lift of a mean line of uniform load, over its camber (Abbott and von Doenhoff 1959, eq. 4.26)"""
PROFILE_EDGES: tuple[dict[str, Any], ...] = (
    {},
    *(
        {"trailing_edge": edge, "trailing_edge_thickness": 0.02, "trailing_edge_opening": opening}
        for edge in ("round", "blunt")
        for opening in ("quartic", "linear")
    ),
)
"""kinds of trailing edge: sharp, and round or blunt, opened as x^4 or as x"""
PROFILES: tuple[Profile, ...] = (
    *(Naca4(thickness=0.1, camber=0.02, camber_position=0.4, **edge) for edge in PROFILE_EDGES),
    *(Naca65(thickness=0.1, lift_coefficient=0.5, **edge) for edge in PROFILE_EDGES),
    *(C4(thickness=0.1, camber_angle=20.0, **edge) for edge in PROFILE_EDGES),
    *(Naca5(thickness=0.1, **edge) for edge in PROFILE_EDGES),
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


@first_part.register
def _(like: Profile, shape: SectionShape) -> Profile:
    """By its thickness, camber and stagger."""
    (maximum, _), (camber, position) = shape.thickest, shape.most_cambered
    first, last = np.clip(shape.radii, 5e-4, 0.2 * maximum)
    values = {
        "stagger_angle": np.degrees(shape.stagger),
        "thickness": maximum,
        "camber": camber,
        "camber_position": np.clip(position, 0.15, 0.7),
        "lift_coefficient": LIFT * camber,
        "design_lift": LIFT * camber,
        "camber_angle": np.degrees(-np.diff(shape.angles(ENDS))[0]),
        "leading_edge_radius": first,
        "trailing_edge_radius": last,
        "trailing_edge_thickness": max(2.0 * shape.half(np.array([0.985]))[0] / maximum, 0.01),
    }
    changes = {}
    for name, value in values.items():
        if vars(like).get(name) is not None:
            allowed = parameter_range(like, name, value, abs(value))
            changes[name] = float(np.clip(value, allowed.low, allowed.high))
    return replace(like, **changes)


@first_part.register
def _(like: PointsProfile, shape: SectionShape) -> PointsProfile:
    return through_points(shape, len(like.abscissas))


def through_points(shape: SectionShape, count: int) -> PointsProfile:
    """The contour through so many points of a section, as dense as it turns and as it is long; two at a blunt edge."""
    blunt = not np.allclose(shape.upper[-1], shape.lower[-1])
    around = np.concatenate([shape.upper[::-1], shape.lower[1:]])
    along = np.diff(around, axis=0)
    steps, heading = length(along), np.arctan2(along[:, 1], along[:, 0])
    turns = np.abs((np.diff(heading, append=heading[-1:]) + np.pi) % (2.0 * np.pi) - np.pi)
    way = np.concatenate([[0.0], np.cumsum(steps / np.sum(steps) + turns / np.sum(turns))])
    at = np.linspace(0.0, way[-1], count, endpoint=blunt)
    x, y = (np.interp(at, way, around[:, i]) for i in (0, 1))
    return PointsProfile(
        stagger_angle=float(np.degrees(shape.stagger)), abscissas=tuple(x.tolist()), ordinates=tuple(y.tolist())
    )
