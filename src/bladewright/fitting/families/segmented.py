"""Where a segmented airfoil begins: joints from the section, and each segment on its own, as its paper has it."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from bladewright.errors import DesignError
from bladewright.fitting.families.section_shape import SectionShape
from bladewright.fitting.models.planar import SINGLE_SECTION
from bladewright.numerics.elementary import cross2, dot, length, turned_left, unit
from bladewright.nurbs.basis import Reals, basis, greville
from bladewright.section.laws import law_points
from bladewright.section.profiles.points import PointsProfile
from bladewright.section.segmented.part import JointVectors, Segmented, side_joints
from bladewright.section.segmented.parts import AirfoilSide, Nose, Segment, SegmentJoint
from bladewright.section.segmented.segment import DEGREE, control_points, segment_knots
from bladewright.section.segmented.skin import SEGMENTS

LONGEST_CONTOUR = 2.6
"""length of the polygon of points in order around a section, of its extent from the first point, up to which they are
taken to be in order: twice the extent and a margin for thickness and camber; unordered points are much longer [-]"""
CLOSED = 1e-6
"""distance of the sides' ends up to which a trailing edge is closed, of the chord: tables have six digits [-]"""
PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 401))) / 2.0
"""s at which a side is sampled"""
WINDOW = 0.05
"""length to both sides of a cut over which a side's slope and curvature are taken, of the chord: short enough for a
polynomial of degree three, long enough for what points leave open [-] (design/matching_constants.md)"""
NOSE_WINDOWS, NOSE_DEGREE = (0.006, 0.012, 0.024), 5
"""lengths to both sides of the leading edge over which its direction and curvature are taken, of the chord, and the
degree of the polynomials that give them (`NOSE_DEGREE`): tables may be irregular there [-]"""
REACHES = (0.04, 0.1, 0.22, 0.45)
"""how far the third control point from a joint lies along the segment, in the trials of its scale factor: a search from
one pair alone may end 40 times as far from the section [-]"""
REFINED = 2
"""trials that are refined"""
REACH_RANGE = (0.015, 0.6)
"""to which it is limited in a start [-]"""
PROJECTIONS = 3
"""times that a trial segment is projected onto the section anew"""
SAMPLES: Reals = np.linspace(0.0, 1.0, 33)[1:-1]
"""parameters at which a segment is compared with the section"""
STIFFNESS = 1e-4
"""weight that holds an inner control point where it was along the segment, of the weight of all samples"""
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
    """The section of points (n, 2) that run once around it, as tables of airfoils do; None for others.

    It is that of a spline through them, with the corners that they show at the trailing edge.
    """
    way = float(np.sum(length(np.diff(points, axis=0, append=points[:1]))))
    if way > LONGEST_CONTOUR * float(np.max(length(points - points[0]))):
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
    )


def first_parts(shape: SectionShape, like: Segmented | None) -> Sequence[Segmented]:
    """The airfoils nearest to a section: joints from its sides, each segment by least squares of its own.

    Without a structure it is the reduced form, its trailing edge open or closed as the section's is, and both for a
    round one. The leading edge's direction and radius are those, of several estimates, with which its segments come
    nearest.
    """
    if like is not None:
        return [_first_part(shape, like)]
    closed = replace(REDUCED, trailing_edge_thickness=None)
    if shape.edge_radii[1] > 0.0:
        return [_first_part(shape, each) for each in (REDUCED, closed)]
    return [_first_part(shape, REDUCED if length(shape.upper[-1] - shape.lower[-1]) > CLOSED else closed)]


def _first_part(shape: SectionShape, like: Segmented) -> Segmented:
    thickness = float(np.clip(shape.upper[-1, 1] - shape.lower[-1, 1], 5e-4, 0.4))
    cuts = [float(np.mean(law_points(each))) for each in like.partition]
    part = replace(
        like,
        stagger_angle=float(np.degrees(shape.stagger)),
        trailing_edge_thickness=None if like.trailing_edge_thickness is None else thickness,
        upper=_joined(like.upper, shape.upper, cuts),
        lower=_joined(like.lower, shape.lower, cuts),
        morph=None,
    )
    for name in ("central_box", "trailing_edge"):
        part, _ = _with_segments(part, shape, name)
    noses = [_with_segments(replace(part, nose=nose), shape, "leading_edge") for nose in _noses(like.nose, shape)]
    return min(noses, key=lambda pair: pair[1])[0]


def _with_segments(part: Segmented, shape: SectionShape, name: str) -> tuple[Segmented, float]:
    """The airfoil with a segment of both sides nearest to the section's, and the sum of its squared distances."""
    at, total = SEGMENTS.index(name), 0.0
    for side, sign, line in (("upper", 1.0, shape.upper), ("lower", -1.0, shape.lower)):
        joints = side_joints(part, sign, SINGLE_SECTION)[at : at + 2]
        segment, cost = _fitted(getattr(getattr(part, side), name), (joints[0], joints[1]), line)
        part = replace(part, **{side: replace(getattr(part, side), **{name: segment})})
        total += cost
    return part, total


def _noses(like: Nose | None, shape: SectionShape) -> Sequence[Nose | None]:
    """Direction and radius of the leading edge, by polynomials over a narrow and a wide window."""
    if like is None or like.angle is None:
        return [like]
    around = np.concatenate([shape.lower[:0:-1], shape.upper])
    way = np.cumsum(length(np.diff(around, axis=0, prepend=around[:1])))
    way = way - way[len(shape.lower) - 1]
    found = []
    for window in NOSE_WINDOWS:
        near = np.square(way) < window**2
        fitted = [np.polynomial.Polynomial.fit(way[near], around[near, axis], NOSE_DEGREE) for axis in (0, 1)]
        first, second = (np.array([each.deriv(order)(0.0) for each in fitted]) for order in (1, 2))
        curvature = float(cross2(first, second)) / float(length(first)) ** 3
        radius = None if like.radius is None else float(np.clip(-1.0 / min(curvature, -1e-9), 1e-3, 0.2))
        found.append(Nose(angle=float(np.degrees(np.arctan2(-first[0], first[1]))), radius=radius))
    return found


def _joined(like: AirfoilSide, line: Reals, cuts: list[float]) -> AirfoilSide:
    """The side with its joints on a line (n, 2)."""
    found = []
    for cut, joint in zip(cuts, (like.front_joint, like.rear_joint), strict=True):
        x = np.linspace(cut - WINDOW, cut + WINDOW, 21)
        order = np.argsort(line[:, 0], kind="stable")
        polynomial = np.polynomial.Polynomial.fit(x, np.interp(x, *line[order].T), 3)
        height, slope, bend = (float(polynomial.deriv(k)(cut)) if k else float(polynomial(cut)) for k in range(3))
        found.append(
            SegmentJoint(
                height=height,
                angle=None if joint.angle is None else float(np.degrees(np.arctan(slope))),
                curvature=None if joint.curvature is None else bend / (1.0 + slope**2) ** 1.5,
            )
        )
    return replace(like, front_joint=found[0], rear_joint=found[1])


def _fitted(like: Segment, joints: tuple[JointVectors, JointVectors], line: Reals) -> tuple[Segment, float]:
    """The segment between two joints that is nearest to a line (n, 2), and the sum of its squared distances.

    It is the best of several pairs of scale factors, refined.
    """
    trial = _Trial(like, joints, line)
    reaches = [REACHES if free else REACHES[:1] for free in trial.scaled]
    tried = [trial.projected(trial.scale_of_reach * np.array(pair)) for pair in product(*reaches)]
    tried.sort(key=lambda unknowns: float(np.sum(trial.heights(unknowns) ** 2)))
    low, high = trial.limits()
    size = np.array([0.3, 0.3, *[0.05] * (2 * trial.count)])
    refined = [
        least_squares(trial.heights, np.clip(each, low, high), bounds=(low, high), x_scale=size, max_nfev=20)
        for each in tried[:REFINED]
    ]
    best = min(refined, key=lambda one: float(one.cost))
    scales = [float(value) if free else None for value, free in zip(best.x[:2], trial.scaled, strict=True)]
    inner = best.x[2:].reshape(-1, 2)
    segment = Segment(
        abscissas=tuple(inner[:, 0].tolist()),
        ordinates=tuple(inner[:, 1].tolist()),
        front_scale=scales[0],
        rear_scale=scales[1],
    )
    return segment, 2.0 * float(best.cost)


class _Trial:
    """A segment between two joints, whose unknowns are both scale factors and the inner control points (2 + 2 n,)."""

    def __init__(self, like: Segment, joints: tuple[JointVectors, JointVectors], line: Reals) -> None:
        self.count, self.joints, self.line = len(like.abscissas), joints, line
        self.along, self.tree = unit(np.diff(line, axis=0)), cKDTree(line)
        self.scaled = [joint.direction is not None for joint in joints]
        self.distance = length(joints[1].point - joints[0].point)
        knots = segment_knots(self.count + sum(map(_kept, joints)))
        self.rows = basis(knots, DEGREE, SAMPLES)
        self.places = greville(knots, DEGREE)
        self.scale_of_reach = float(DEGREE / (knots[DEGREE + 1] + knots[DEGREE + 2]))

    def limits(self) -> tuple[Reals, Reals]:
        """Lowest and highest unknowns: inner control points stay between the joints along the chord line."""
        low, high = np.full(2 + 2 * self.count, -np.inf), np.full(2 + 2 * self.count, np.inf)
        low[:2], high[:2] = (self.scale_of_reach * each for each in REACH_RANGE)
        low[2::2], high[2::2] = (float(np.real(joint.point[0, 0])) for joint in self.joints)
        return low, high

    def controls(self, unknowns: Reals) -> Reals:
        """All control points (k, 2)."""
        ends = [
            joint.end(self.distance, np.array([scale])) for joint, scale in zip(self.joints, unknowns[:2], strict=True)
        ]
        found: Reals = control_points(ends[0], unknowns[2:].reshape(1, -1, 2), ends[1])[0]
        return found

    def heights(self, unknowns: Reals) -> Reals:
        """Distances of the segment's samples from the line."""
        points = self.rows @ self.controls(unknowns)
        feet, normals = self.feet(points)
        return np.asarray(np.sum((points - feet) * normals, axis=1))

    def feet(self, points: Reals) -> tuple[Reals, Reals]:
        """The nearest places of the line (m, 2), which continues straight past its ends, and its normals there."""
        first = np.clip(self.tree.query(points)[1], 0, len(self.along) - 1)
        before = np.clip(first - 1, 0, None)
        behind = dot(points - self.line[first], self.along[first]) < 0.0
        piece = np.where(behind, before, first)
        way = dot(points - self.line[piece], self.along[piece])
        along = self.along[piece]
        return self.line[piece] + way[:, None] * along, turned_left(along)

    def projected(self, scales: Reals) -> Reals:
        """The unknowns with these scale factors whose segment is nearest to the line."""
        controls = self.controls(np.array([*scales, *[0.0] * (2 * self.count)]))
        first = _kept(self.joints[0])
        inner = slice(first, first + self.count)
        fixed, moving = self.rows @ controls, self.rows[:, inner]
        start, end = (each.point[0] for each in self.joints)
        share = self.places[inner, None]
        points = self.feet(start + share * (end - start))[0]
        hold = STIFFNESS * np.eye(2 * self.count)
        for _ in range(PROJECTIONS):
            feet, normals = self.feet(fixed + moving @ points)
            slopes = (moving[:, :, None] * normals[:, None]).reshape(len(SAMPLES), -1)
            wanted = np.sum((feet - fixed) * normals, axis=1)
            right = np.concatenate([wanted, hold @ points.ravel()])
            points = np.linalg.lstsq(np.concatenate([slopes, hold]), right, rcond=None)[0].reshape(-1, 2)
        return np.concatenate([scales, points.ravel()])


def _kept(joint: JointVectors) -> int:
    """Control points that a joint decides at a segment's end."""
    return 1 + (joint.direction is not None) + (joint.curvature is not None)
