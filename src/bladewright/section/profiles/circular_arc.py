"""Double- and multiple-circular-arc profiles (Johnsen and Bullock 1965, NASA SP-36, chapter VI; Crouse et al. 1969)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, cross2, dot, length, radians, turned_left
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.profiles.profile import THICKNESS, Profile

EDGE = 0.12
"""s that a round edge's circle takes on each side: a short arc of large curvature asks for more than its share of the
parameter [-]"""
NOSE_SPEED = 0.75
"""speed by s at the nose, of the mean around the edge: below 1 so that the speed grows towards the long side arc [-]"""
RADIUS = Limits(0.0, 0.1, "an edge radius must be above 0 and below 0.1 chords; leave it out for a sharp edge")
CAMBER = Limits(-120.0, 120.0, "the camber angle must lie between -120 and 120 deg")
TRANSITION = Limits(0.1, 0.9, "the transition must lie above 0.1 and below 0.9 of the mean line")
FRONT_CAMBER = Limits(-2.0, 3.0, "the front's share of the camber must lie between -2 and 3")


@dataclass(frozen=True, kw_only=True)
class Arc:
    """Circular arcs (...), straight where they do not turn."""

    start: Array
    """(..., 2)"""
    direction: Array
    """unit tangent at the start (..., 2)"""
    length: Array
    """(...)"""
    turning: Array
    """angle from the tangent at the start to that at the end (...) [rad]"""

    def points(self, share: Array) -> Array:
        """Points (..., k, 2) at shares (..., k) of the length."""
        half = 0.5 * share * self.turning[..., None]
        distance = share * self.length[..., None] * _sinc(half)
        forward, left = self.direction[..., None, :], turned_left(self.direction)[..., None, :]
        along = np.cos(half)[..., None] * forward + np.sin(half)[..., None] * left
        return self.start[..., None, :] + distance[..., None] * along

    @property
    def end(self) -> Array:
        """The last point (..., 2)."""
        return self.points(np.ones(1))[..., 0, :]

    @property
    def end_direction(self) -> Array:
        """Unit tangent at the end (..., 2)."""
        return turned(self.direction, self.turning)


def turned(vectors: Array, by: Array) -> Array:
    """Vectors (..., 2) turned to the left by angles (...)."""
    return np.cos(by)[..., None] * vectors + np.sin(by)[..., None] * turned_left(vectors)


def _sinc(z: Array) -> Array:
    """sin(z) / z, also at zero."""
    square = z * z
    small = np.real(square) < 1e-8
    nonzero = np.where(small, 1.0, z)
    return np.where(small, 1.0 - square / 6.0, np.sin(nonzero) / nonzero)


def arc_between(start: Array, end: Array, direction: Array, end_direction: Array) -> Arc:
    """The arcs between points (..., 2) that have the given tangents at their ends, which must fit."""
    turning = angle(cross2(direction, end_direction), dot(direction, end_direction))
    return Arc(start=start, direction=direction, length=length(end - start) / _sinc(0.5 * turning), turning=turning)


@dataclass(frozen=True, kw_only=True)
class ArcOutline(Outline):
    """Sections (...) of arcs: on the mean line of two arcs, `thickness` thick at the transition between them.

    There both sides are parallel to the mean line; from there an arc runs to each edge, where it touches the edge's
    circle, whose centre lies on the tangent of the mean line, or ends in the edge's point.
    """

    front: Arc
    """the mean line's front arc, from (0, 0)"""
    rear: Arc
    """its rear arc, to (1, 0)"""
    thickness: Array
    """(...)"""
    radii: tuple[Array | None, Array | None]
    """of the leading and the trailing edge (...); None: sharp"""

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Where arcs meet, with a jump of curvature."""
        return tuple(Joint(place, 1) for place in self._breaks[1:-1])

    @property
    def leading_edge(self) -> Edge:
        """Round with the radius given, or sharp."""
        return self._edge(0)

    @property
    def trailing_edge(self) -> Edge:
        """Round with the radius given, or sharp."""
        return self._edge(1)

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the mean line."""
        in_front = s <= 0.5
        share = np.where(in_front, 2.0 * s, 2.0 * s - 1.0)
        return np.where(in_front[:, None], self.front.points(share), self.rear.points(share))

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        upper, lower = (self._points(arcs, s) for arcs in self._arcs)
        return upper, lower

    @cached_property
    def _breaks(self) -> list[float]:
        front = [] if self.radii[0] is None else [EDGE]
        rear = [] if self.radii[1] is None else [1.0 - EDGE]
        return [0.0, *front, 0.5, *rear, 1.0]

    @cached_property
    def _arcs(self) -> tuple[list[Arc], list[Arc]]:
        """Arcs of the upper and of the lower side, leading to trailing edge."""
        tangent, middle = self.front.end_direction, self.front.end
        sides = []
        for sign in (1.0, -1.0):
            normal = sign * turned_left(tangent)
            side_point = middle + 0.5 * self.thickness[..., None] * normal
            front = self._to_edge(side_point, normal, sign, 0)
            sides.append([*front, *self._to_edge(side_point, normal, sign, 1)])
        return sides[0], sides[1]

    def _to_edge(self, side_point: Array, normal: Array, sign: float, end: int) -> list[Arc]:
        """The arcs between the transition's point of a side and an edge, in the order of s."""
        radius = self.radii[end]
        tip = self.rear.end if end else self.front.start
        outward = self.rear.end_direction if end else -self.front.direction
        size = np.zeros(()) if radius is None else radius
        centre = tip - size[..., None] * outward
        offset = centre - side_point
        curvature = 2.0 * (dot(normal, offset) + size) / (size**2 - dot(offset, offset))
        contact = (curvature[..., None] * offset + normal) / (1.0 - curvature * size)[..., None]
        touched = centre + size[..., None] * contact
        # the outward normal turned back is the tangent towards the trailing edge
        along, edge_direction = (-sign * turned_left(each) for each in (normal, contact))
        arc = (
            arc_between(side_point, touched, along, edge_direction)
            if end
            else arc_between(touched, side_point, edge_direction, along)
        )
        if radius is None:
            return [arc]
        rounding = angle(cross2(outward, contact), dot(outward, contact))
        nose = Arc(
            start=touched if end else tip + 0.0 * touched,
            direction=edge_direction if end else -sign * turned_left(outward),
            length=-sign * radius * rounding if end == 0 else sign * radius * rounding,
            turning=-rounding if end else rounding,
        )
        return [arc, nose] if end else [nose, arc]

    def _points(self, arcs: list[Arc], s: Reals) -> Array:
        ends, speeds = self._breaks, self._speeds(arcs)
        piece = np.clip(np.searchsorted(ends, s, side="right") - 1, 0, len(arcs) - 1)
        shape = np.broadcast_shapes(*[arc.start.shape[:-1] for arc in arcs], *[arc.length.shape for arc in arcs])
        found = np.zeros((*shape, len(s), 2), dtype=np.result_type(*[arc.length for arc in arcs]))
        for i, arc in enumerate(arcs):
            on_arc = piece == i
            step = ends[i + 1] - ends[i]
            share = (s[on_arc] - ends[i]) / step
            start, end = (speeds[k][..., None] * step / arc.length[..., None] for k in (i, i + 1))
            if i == 0 and self.radii[0] is not None:
                fraction = start * share + (1.0 - start) * share**3
            elif i == len(arcs) - 1 and self.radii[1] is not None:
                fraction = 1.0 - end * (1.0 - share) - (1.0 - end) * (1.0 - share) ** 3
            else:
                rest = 1.0 - share
                fraction = share * (start * rest**2 - end * share * rest + share * (3.0 - 2.0 * share))
            found[..., on_arc, :] = arc.points(fraction)
        return found

    def _speeds(self, arcs: list[Arc]) -> list[Array]:
        """Arc length by s where arcs meet (...), the same on both sides at round edges."""
        steps = np.diff(self._breaks)
        inner = 0 if self.radii[0] is None else 1
        mean = [arc.length / step for arc, step in zip(arcs, steps, strict=True)]
        speeds = [mean[inner], 0.5 * (mean[inner] + mean[inner + 1]), mean[inner + 1]]
        for end, radius in ((0, self.radii[0]), (-1, self.radii[1])):
            if radius is not None:
                nose = NOSE_SPEED * 0.5 * np.pi * radius / EDGE + 0.0 * mean[end]
                leaving = 3.0 * mean[end] - 2.0 * nose
                speeds[end] = leaving
                speeds.insert(0 if end == 0 else len(speeds), nose)
        return speeds

    def _edge(self, end: int) -> Edge:
        starts = []
        for arcs in self._arcs:
            arc = arcs[-end]
            speeds, step = self._speeds(arcs), np.diff(self._breaks)[-end]
            point, along = (arc.end, arc.end_direction) if end else (arc.start, arc.direction)
            speed = speeds[-end]
            growth = 0.0 * speed
            if self.radii[end] is None:
                other = speeds[-2] if end else speeds[1]
                growth = (6.0 * arc.length / step - 4.0 * speed - 2.0 * other) / step * (-1.0 if end else 1.0)
            bend = (speed**2 * arc.turning / arc.length)[..., None] * turned_left(along)
            first, second = speed[..., None] * along, growth[..., None] * along + bend
            starts.append(EdgeDerivatives(point + 0.0 * first, first, second))
        return Edge(kind="sharp" if self.radii[end] is None else "round", upper=starts[0], lower=starts[1])


@dataclass(frozen=True, kw_only=True)
class CircularArcProfile(Profile):
    """Base of the profiles whose mean line and sides are circular arcs."""

    thickness: Law = parameter("-", limits=THICKNESS)
    """maximum thickness, of the chord, at the transition [-]"""
    camber_angle: Law = parameter("deg", limits=CAMBER, default=0.0)
    """turning of the mean line [deg]"""
    leading_edge_radius: Law | None = parameter("-", limits=RADIUS, default=None)
    """of the chord; none: a sharp edge [-]"""
    trailing_edge_radius: Law | None = parameter("-", limits=RADIUS, default=None)
    """of the chord; none: a sharp edge [-]"""

    def _outline(self, span: Span, transition: Array, front_camber: Array) -> Outline:
        thickness = span.values(self.thickness)
        radii: list[Array | None] = []
        for name in ("leading_edge_radius", "trailing_edge_radius"):
            law: Law | None = getattr(self, name)
            radii.append(None if law is None else span.values(law))
            self._check_radius(name, radii[-1], thickness)
        turning = -radians(span.values(self.camber_angle))
        front, rear = mean_line(turning * front_camber, turning * (1.0 - front_camber), transition)
        return ArcOutline(front=front, rear=rear, thickness=thickness, radii=(radii[0], radii[1]))

    def _check_radius(self, name: str, radius: Array | None, thickness: Array) -> None:
        if radius is None or np.all(np.real(radius) < 0.45 * np.real(thickness)):
            return
        raise DesignError(
            f"{name} is {np.max(np.real(radius)):g}: it must be below 0.45 of the thickness, "
            f"{np.min(np.real(thickness)):g}; lower it or raise thickness"
        )


@dataclass(frozen=True, kw_only=True)
class DoubleCircularArc(CircularArcProfile):
    """A double-circular-arc profile: mean line, upper and lower side are circular arcs, thickest at mid-chord.

    With edges of equal radius each side is one arc that touches both edges' circles.
    """

    kind: Literal["double-circular-arc"] = "double-circular-arc"
    """which kind of profile this is"""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        half = np.full(len(span.v), 0.5)
        return self._outline(span, half, half)


@dataclass(frozen=True, kw_only=True)
class MultipleCircularArc(CircularArcProfile):
    """A multiple-circular-arc profile: mean line and both sides are each two arcs, tangent at the transition.

    The profile is thickest at the transition, where both sides are parallel to the mean line.
    """

    kind: Literal["multiple-circular-arc"] = "multiple-circular-arc"
    """which kind of profile this is"""
    transition: Law = parameter("-", limits=TRANSITION)
    """where the arcs meet, of the mean line's length [-]"""
    front_camber: Law = parameter("-", limits=FRONT_CAMBER)
    """the front arc's share of the camber angle [-]"""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        return self._outline(span, span.values(self.transition), span.values(self.front_camber))


def mean_line(front_turning: Array, rear_turning: Array, transition: Array) -> tuple[Arc, Arc]:
    """Two tangent arcs from (0, 0) to (1, 0) that turn by given angles (...) [rad] and meet at the transition."""
    share, front_turning, rear_turning = np.broadcast_arrays(transition, front_turning, rear_turning)
    ahead = np.stack([np.ones_like(share), np.zeros_like(share)], axis=-1)
    first = Arc(start=0.0 * ahead, direction=ahead, length=share, turning=front_turning)
    second = Arc(start=first.end, direction=first.end_direction, length=1.0 - share, turning=rear_turning)
    chord = length(second.end)
    # the way to the end, mirrored: it turns the chord line onto the axis
    cosine, sine = (second.end[..., k] / chord for k in (0, 1))

    def in_chords(arc: Arc) -> Arc:
        start, direction = (
            cosine[..., None] * each - sine[..., None] * turned_left(each) for each in (arc.start, arc.direction)
        )
        return Arc(start=start / chord[..., None], direction=direction, length=arc.length / chord, turning=arc.turning)

    return in_chords(first), in_chords(second)
