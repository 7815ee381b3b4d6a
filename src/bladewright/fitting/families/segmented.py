"""Where a segmented airfoil begins: joints from the section, and each segment on its own, as its paper has it."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from bladewright.errors import DesignError
from bladewright.fitting.families.closed_blade import SectionShape
from bladewright.fitting.families.first_parts import first_part
from bladewright.fitting.models.designs import SINGLE_SECTION
from bladewright.numerics.elementary import cross2, cumulative_length, dot, length, turned_left, unit
from bladewright.nurbs.basis import Reals, basis, greville
from bladewright.section.profiles.points import PointsProfile
from bladewright.section.segmented.part import JointVectors, Segmented, side_joints
from bladewright.section.segmented.parts import AirfoilSide, Nose, Segment, SegmentJoint
from bladewright.section.segmented.segment import DEGREE, control_points, segment_knots
from bladewright.section.segmented.skin import SEGMENTS

PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 401))) / 2.0
"""s at which a side is sampled"""
WINDOW = 0.05
"""chord fraction beside a cut or the leading edge that shows direction and curvature (design/matching_constants.md)"""
SCALES = (0.5, 1.0)
"""scale factors with which a segment's search begins: one alone may mislead it [-] (design/matching_constants.md)"""
SAMPLES: Reals = np.linspace(0.0, 1.0, 33)[1:-1]
"""parameters at which a segment is compared with the section"""
_JOINT = SegmentJoint(height=0.0, angle=0.0, curvature=0.0)
_SEGMENT = Segment(abscissas=(0.5,), ordinates=(0.0,), front_scale=1.0, rear_scale=1.0)
_SIDE = AirfoilSide(
    front_joint=_JOINT,
    rear_joint=_JOINT,
    leading_edge=_SEGMENT,
    central_box=_SEGMENT,
    trailing_edge=replace(_SEGMENT, rear_scale=None),
)
REDUCED = Segmented(nose=Nose(angle=0.0, radius=0.01), trailing_edge_thickness=0.002, upper=_SIDE, lower=_SIDE)
"""the reduced form, of 22 parameters besides the joints"""


def contour_shape(points: Reals) -> SectionShape | None:
    """The section of a spline through points (n, 2) that run once around it, as airfoil tables do; None for others."""
    way = float(np.sum(length(np.diff(points, axis=0, append=points[:1]))))
    # a convex contour is no longer than pi times its largest extent (Rosenthal and Szasz 1916), and points in another
    # order are joined by a much longer polygon
    if way > np.pi * float(np.max(length(points - points[0]))):
        return None
    try:
        x, y = (tuple(axis.tolist()) for axis in points.T)
        outline = PointsProfile(abscissas=x, ordinates=y).outline(SINGLE_SECTION)
        upper, lower = (side[0] for side in outline.points(PLACES))
    except DesignError:
        return None
    start, along = (np.real(each[0]) for each in outline.chord_line)
    edge = outline.leading_edge.upper
    bend = cross2(edge.first, edge.second)[0] / length(edge.first)[0] ** 3
    round_end = outline.trailing_edge.kind == "round"
    return SectionShape(
        chord=float(np.hypot(*along)),
        stagger=float(np.arctan2(along[1], along[0])),
        start=start,
        upper=upper,
        lower=lower,
        edge_radii=(float(np.clip(-1.0 / bend, 1e-3, 0.2)), 1e-3 if round_end else 0.0),
        ends_known=True,
    )


def structures(shape: SectionShape) -> Sequence[Segmented]:
    """The reduced form, its trailing edge open or closed as the section's is, and both for a round one."""
    closed = replace(REDUCED, trailing_edge_thickness=None)
    if shape.edge_radii[1] > 0.0:
        return [REDUCED, closed]
    return [closed if np.allclose(shape.upper[-1], shape.lower[-1]) else REDUCED]


@first_part.register
def _(like: Segmented, shape: SectionShape) -> Segmented:
    """With joints from its sides, and each segment by least squares of its own."""
    thickness = float(np.clip(shape.upper[-1, 1] - shape.lower[-1, 1], 5e-4, 0.4))
    part = replace(
        like,
        nose=_nose(like.nose, shape),
        stagger_angle=float(np.degrees(shape.stagger)),
        trailing_edge_thickness=None if like.trailing_edge_thickness is None else thickness,
        upper=_joined(like.upper, shape.upper, like.partition),
        lower=_joined(like.lower, shape.lower, like.partition),
        morph=None,
    )
    for side, sign, line in (("upper", 1.0, shape.upper), ("lower", -1.0, shape.lower)):
        own, joints = getattr(part, side), side_joints(part, sign, SINGLE_SECTION)
        fitted = {
            name: _fitted(getattr(own, name), (first, last), line)
            for name, (first, last) in zip(SEGMENTS, pairwise(joints), strict=True)
        }
        part = replace(part, **{side: replace(own, **fitted)})
    return part


def _nose(like: Nose | None, shape: SectionShape) -> Nose | None:
    """Direction and radius of the leading edge, by polynomials of the length around it."""
    if like is None or like.angle is None:
        return like
    around = np.concatenate([shape.lower[:0:-1], shape.upper])
    way = cumulative_length(around)
    way = way - way[len(shape.lower) - 1]
    near = np.square(way) < WINDOW**2
    fitted = [Polynomial.fit(way[near], around[near, axis], 3) for axis in (0, 1)]
    first, second = (np.array([each.deriv(order)(0.0) for each in fitted]) for order in (1, 2))
    curvature = float(cross2(first, second)) / float(length(first)) ** 3
    radius = None if like.radius is None else float(np.clip(-1.0 / min(curvature, -1e-9), 1e-3, 0.2))
    return Nose(angle=float(np.degrees(np.arctan2(-first[0], first[1]))), radius=radius)


def _joined(like: AirfoilSide, line: Reals, cuts: Sequence[Any]) -> AirfoilSide:
    """The side with its joints on a line (n, 2)."""
    found = []
    for cut, joint in zip(cuts, (like.front_joint, like.rear_joint), strict=True):
        x = np.linspace(cut - WINDOW, cut + WINDOW, 21)
        order = np.argsort(line[:, 0], kind="stable")
        polynomial = Polynomial.fit(x, np.interp(x, *line[order].T), 3)
        height, slope, bend = (float(polynomial.deriv(k)(cut)) for k in range(3))
        found.append(
            SegmentJoint(
                height=height,
                angle=None if joint.angle is None else float(np.degrees(np.arctan(slope))),
                curvature=None if joint.curvature is None else bend / (1.0 + slope**2) ** 1.5,
            )
        )
    return replace(like, front_joint=found[0], rear_joint=found[1])


def _fitted(like: Segment, joints: tuple[JointVectors, JointVectors], line: Reals) -> Segment:
    """The segment between two joints that is nearest to a line (n, 2), by least squares from several scale factors.

    Its unknowns are both scale factors and the inner control points, which begin on the line, between the joints.
    """
    count, scaled = len(like.abscissas), [joint.direction is not None for joint in joints]
    start, end = (np.real(each.point[0]) for each in joints)
    distance = length(end - start)
    kept = [1 + (joint.direction is not None) + (joint.curvature is not None) for joint in joints]
    knots = segment_knots(count + sum(kept))
    rows, share = basis(knots, DEGREE, SAMPLES), greville(knots, DEGREE)[kept[0] : kept[0] + count, None]
    along, tree = unit(np.diff(line, axis=0)), cKDTree(line)

    def feet(points: Reals) -> tuple[Reals, Reals]:
        """The nearest places of the line (m, 2), which continues straight past its ends, and its normals there."""
        first = np.clip(tree.query(points)[1], 0, len(along) - 1)
        behind = dot(points - line[first], along[first]) < 0.0
        piece = np.where(behind, np.maximum(first - 1, 0), first)
        way = dot(points - line[piece], along[piece])
        return line[piece] + way[:, None] * along[piece], turned_left(along[piece])

    def heights(unknowns: Reals) -> Reals:
        """Distances of the segment's samples from the line."""
        ends = [joint.end(distance, np.array([scale])) for joint, scale in zip(joints, unknowns[:2], strict=True)]
        points = rows @ control_points(ends[0], unknowns[2:].reshape(1, -1, 2), ends[1])[0]
        places, normals = feet(points)
        return np.asarray(dot(points - places, normals))

    low, high = np.full(2 + 2 * count, -np.inf), np.full(2 + 2 * count, np.inf)
    low[:2], low[2::2], high[2::2] = 0.0, start[0], end[0]
    inner = feet(start + share * (end - start))[0]
    inner[:, 0] = np.clip(inner[:, 0], start[0], end[0])
    pairs = product(*[SCALES if free else SCALES[-1:] for free in scaled])
    tried = [least_squares(heights, np.concatenate([pair, inner.ravel()]), bounds=(low, high)) for pair in pairs]
    best = min(tried, key=lambda one: float(one.cost))
    scales = [float(value) if free else None for value, free in zip(best.x[:2], scaled, strict=True)]
    inner = best.x[2:].reshape(-1, 2)
    return Segment(
        abscissas=tuple(inner[:, 0].tolist()),
        ordinates=tuple(inner[:, 1].tolist()),
        front_scale=scales[0],
        rear_scale=scales[1],
    )
