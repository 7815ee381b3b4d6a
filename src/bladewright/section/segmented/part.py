"""The segmented airfoil as a section: its parameters, and the 2D design (Tortora et al. 2023, section 2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any, Literal

import numpy as np

from bladewright.designs import ChordwiseLaw, Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length, radians, turned_left
from bladewright.section.laws import Span
from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.profile import Profile
from bladewright.section.segmented.morph import morphed
from bladewright.section.segmented.outline import SegmentedOutline, SegmentedSide
from bladewright.section.segmented.parts import AirfoilSide, Morph, Nose, Segment, SegmentJoint, Skin
from bladewright.section.segmented.segment import DEGREE, SegmentEnd, control_points
from bladewright.section.segmented.skin import SEGMENTS, Band

PLACE = Limits(0.0, 1.0, "a cut must lie between 0 and 1 chord")
THICKNESS = Limits(0.0, 0.5, "an open trailing edge must be thicker than 0 and thinner than half the chord")
_Given = tuple[Law | None, Law | None]
"""Angle, and curvature or radius, of a joint."""


@dataclass(frozen=True, kw_only=True)
class Segmented(Profile):
    """An airfoil of leading edge, central box and trailing edge, each an upper and a lower uniform cubic B-spline.

    The six segments meet at seven joints: the leading edge, the ends of the sides, and each side's two cuts. Segments
    have as many derivatives in common at a joint as are given there: with angle and curvature C2, with the angle C1.
    Their end control points follow from these by a scale factor at each end. With one inner control point each and C2
    at all joints that is the reduced form of 22 parameters; with corners at all joints and every control point free
    between them it is the full one of 52. Reference: Tortora et al. 2023, section 2.
    """

    kind: Literal["segmented"] = "segmented"
    """which kind of profile this is"""
    partition: ChordwiseLaw = parameter("-", limits=PLACE, default=(0.3, 0.7))
    """chord fractions of the front and the rear cut, on both sides [-]"""
    trailing_edge_thickness: Law | None = parameter("-", limits=THICKNESS, default=None)
    """distance of the sides at an open trailing edge, which a straight face closes; none: closed in one point, of the
    chord [-]"""
    nose: Nose | None = None
    """the leading edge; none: a corner"""
    upper: AirfoilSide
    """joints and segments of the upper side"""
    lower: AirfoilSide
    """joints and segments of the lower side"""
    morph: Morph | None = None
    """turns of leading and trailing edge; none: not morphed"""

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.partition) != 2:
            raise DesignError(f"partition has {len(self.partition)} entries: give 2, the front and the rear cut")
        for name in ("upper", "lower"):
            side = getattr(self, name)
            given: _Given = (None, None) if self.nose is None else (self.nose.angle, self.nose.radius)
            for segment_name, joint in zip(SEGMENTS, (side.front_joint, side.rear_joint, None), strict=True):
                behind = (None, None) if joint is None else (joint.angle, joint.curvature)
                _check(f"{name}.{segment_name}", getattr(side, segment_name), given, behind)
                given = behind

    def outline(self, span: Span) -> SegmentedOutline:
        """The exact sections (..., m), in chords; raises DesignError where the cuts are in the wrong order."""
        front, rear = (span.values(each) for each in self.partition)
        if np.any(np.real(front) >= np.real(rear)):
            raise DesignError(
                f"partition is {float(np.real(front).flat[0]):g}, {float(np.real(rear).flat[0]):g}: the front cut must "
                "lie ahead of the rear one"
            )
        upper, lower = self._sides(span, skinned=True)
        bands = tuple(self._bands(span))
        return SegmentedOutline(
            upper=upper,
            lower=lower,
            nose=0 if self.nose is None else self.nose.continuity,
            blunt=self.trailing_edge_thickness is not None,
            morphed=self.morph is not None,
            bands=bands,
            old_sides=self._sides(span, skinned=False) if bands else None,
        )

    def _sides(self, span: Span, *, skinned: bool) -> tuple[SegmentedSide, SegmentedSide]:
        upper, lower = (_side(self, sign, span, skinned=skinned) for sign in (1.0, -1.0))
        return (upper, lower) if self.morph is None else morphed(self.morph, upper, lower, span)

    def _bands(self, span: Span) -> Iterator[Band]:
        for k, side in enumerate((self.upper, self.lower)):
            for j, name in enumerate(SEGMENTS):
                skin = getattr(side, name).skin
                if skin is not None:
                    yield Band(side=k, segment=j, inner=span.values(skin.inner), outer=span.values(skin.outer))


@dataclass(frozen=True, kw_only=True)
class SegmentedSection(PlanarSection):
    """A segmented airfoil in the plane (x, y)."""

    section: Segmented
    """the airfoil's parameters"""


def _check(path: str, segment: Segment, front: _Given, rear: _Given) -> None:
    """Refuse scale factors of vectors that are not given, and too few control points."""
    holders: list[tuple[str, Any]] = [("", segment)]
    if segment.skin is not None:
        holders.append(("skin.", segment.skin))
    for (prefix, holder), (field, given) in product(holders, (("front_scale", front), ("rear_scale", rear))):
        if getattr(holder, field) is not None and given[0] is None:
            raise DesignError(
                f"{path}.{prefix}{field} is given, but no tangent is at that end: it scales what the joint's angle "
                "gives; leave it out, or give the joint an angle"
            )
    ends = 2 + sum(each is not None for each in (*front, *rear))
    if ends + len(segment.abscissas) < DEGREE + 1:
        raise DesignError(
            f"{path}.abscissas has {len(segment.abscissas)} entries: with the {ends} control points at its ends the "
            f"segment needs {DEGREE + 1 - ends} or more"
        )


def _side(part: Segmented, sign: float, span: Span, *, skinned: bool) -> SegmentedSide:
    """The upper (1) or the lower side (-1)."""
    side = part.upper if sign > 0.0 else part.lower
    joints = side_joints(part, sign, span)
    controls, speeds = [], []
    for name, (front, rear) in zip(SEGMENTS, pairwise(joints), strict=True):
        segment: Segment = getattr(side, name)
        distance = length(rear.point - front.point)
        scales = [
            1.0 + 0.0 * distance if each is None else span.values(each)
            for each in (segment.front_scale, segment.rear_scale)
        ]
        inner = _points(span.control_values(segment.abscissas), span.control_values(segment.ordinates))
        if skinned and segment.skin is not None:
            scales, inner = _skinned(f"{name}.skin", segment.skin, scales, inner, span)
        ends = [joint.end(distance, scale) for joint, scale in zip((front, rear), scales, strict=True)]
        controls.append(control_points(ends[0], inner, ends[1]))
        speeds.append((scales[0] * distance, scales[1] * distance))
    return SegmentedSide(
        controls=(controls[0], controls[1], controls[2]),
        speeds=tuple(speeds),
        continuity=(side.front_joint.continuity, side.rear_joint.continuity),
    )


def _skinned(path: str, skin: Skin, scales: Sequence[Array], inner: Array, span: Span) -> tuple[list[Array], Array]:
    """Scale factors (..., m) and inner control points (..., m, k, 2) with their changes."""
    zero = 0.0 * inner[..., 0]
    moves = [span.control_values(row) if row else zero for row in (skin.abscissas, skin.ordinates)]
    found = []
    for name, scale in zip(("front_scale", "rear_scale"), scales, strict=True):
        change = getattr(skin, name)
        found.append(scale if change is None else scale + span.values(change))
        if np.any(np.real(found[-1]) <= 0.0):
            raise DesignError(
                f"{path}.{name} leaves a scale factor of {float(np.min(np.real(found[-1]))):g}: it must stay above 0"
            )
    return found, inner + _points(*moves)


@dataclass(frozen=True, eq=False)
class JointVectors:
    """What is given at a joint of a side, in chords."""

    point: Array
    """(..., m, 2)"""
    direction: Array | None
    """(..., m, 2) of the side towards the trailing edge, of length 1"""
    curvature: Array | None
    """(..., m) positive where it turns to the left"""

    def end(self, distance: Array, scale: Array) -> SegmentEnd:
        """The end here of a segment whose joints have a distance (..., m)."""
        if self.direction is None:
            return SegmentEnd(point=self.point)
        bend = (
            None if self.curvature is None else (distance**2 * self.curvature)[..., None] * turned_left(self.direction)
        )
        return SegmentEnd(point=self.point, tangent=distance[..., None] * self.direction, curvature=bend, scale=scale)


def side_joints(part: Segmented, sign: float, span: Span) -> list[JointVectors]:
    """The four joints of the upper (1) or the lower side (-1), from the leading to the trailing edge."""
    side = part.upper if sign > 0.0 else part.lower
    half = 0.0 if part.trailing_edge_thickness is None else 0.5 * span.values(part.trailing_edge_thickness)
    front, rear = (span.values(each) for each in part.partition)
    zero = 0.0 * front
    return [
        JointVectors(_points(zero, zero), *_vectors_at_nose(part.nose, sign, span)),
        _at_joint(side.front_joint, front, span),
        _at_joint(side.rear_joint, rear, span),
        JointVectors(_points(1.0 + zero, sign * half + zero), None, None),
    ]


def _vectors_at_nose(nose: Nose | None, sign: float, span: Span) -> tuple[Array | None, Array | None]:
    if nose is None or nose.angle is None:
        return None, None
    angle = radians(span.values(nose.angle))
    direction = sign * turned_left(_points(np.cos(angle), np.sin(angle)))
    return direction, None if nose.radius is None else -sign / span.values(nose.radius)


def _at_joint(joint: SegmentJoint, x: Array, span: Span) -> JointVectors:
    point = _points(x, span.values(joint.height))
    if joint.angle is None:
        return JointVectors(point, None, None)
    angle = radians(span.values(joint.angle))
    return JointVectors(
        point, _points(np.cos(angle), np.sin(angle)), None if joint.curvature is None else span.values(joint.curvature)
    )


def _points(x: Array, y: Array) -> Array:
    return np.stack(np.broadcast_arrays(x, y), axis=-1)
