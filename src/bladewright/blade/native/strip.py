"""Strips of a blade above its fillets: from the contact curve to the curve of constant v at which the side is cut.

The side itself is cut and stays what it is. A line of constant u of its strip is S(u + U(w), V(w)) on the side S, w
from 0 at the contact to 1 at the cut, U and V of degree 5 with the control points

    U: 0, e m / 5, 0, ..., 0            V: c, c + g / 5, the middle of its neighbours, b - 2 k / 5, b - k / 5, b,

c the v of the contact, b that of the cut, k one slope for the whole strip, so that it goes on as the side does, with
two derivatives. U has a knot at e < 1 where lines would cross without. m and g are such that at the joint

    dS/dw = m S_u + g S_v = -dF/ds / K

with one K for the whole joint: control points of the first two rows then satisfy F1 - F0 = -k' (S1 - S0), so that strip
and fillet have one tangent plane at every point of the joint, not only where they are interpolated.

At a corner of the section the line is the corner's own: V = c + (b - c) w, U = 0. Beside corners the lines leave along

    dS/dw = -q dF/ds / K + r (S_u + c' S_v),

the second the joint's own tangent; q, r and k fade from what the corner asks for to 1, 0 and k: on a side within x^5, x
from 1 at the corner to 0 at the strip's `width` from it, on the face of a blunt edge evenly to the other corner.

At a kink of the contact lines cross the place where the side's curvature jumps, and the strip has a crease of up to
0.9 deg. With U = 0 there, q and r fading as beside corners, it has none, but 1.5 to 1.9 times the poles around the
blade (design/fillets.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bladewright.blade.native.closed_section import LOWER, ClosedSection, Sites
from bladewright.blade.native.contacts import Contacts
from bladewright.blade.native.knots import DEGREE
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import JOINT_TOLERANCE, Reals, basis, greville, knots_with_joints
from bladewright.nurbs.blossom import knot_change
from bladewright.nurbs.surface import Surface

ONE_SPAN = np.repeat([0.0, 1.0], DEGREE + 1)
"""Knots of a strip along w to begin with."""
SHORTEST, UNEQUAL = 0.25, 1.0 / 3.0
"""Length of a strip at the highest contact: of the distance from wall to contact, and of how unlike high contacts are;
the longest of its lines is then four times the shortest."""
MOST_OF_ROOM = 0.4
"""Largest length of a strip there, of what is left of the span to the blade's other end or the other fillet."""
NEAR_KNOT = (0.7, 1.7)
"""Lengths, of that one, between which a strip ends at a knot of the side, where there is one: beside it the side would
begin with a narrow span."""
FIRST_STEP, LAST_STEP = 0.35, 0.5
"""Largest steps of V next to its ends, of a line's length: they come no closer than to 0.15 of it."""
SHIFTS = (1.0, 0.5, 0.25, 0.125)
"""e, of which the first is taken that keeps lines apart, or the one that does it best."""
FOLDED = 0.25
"""Area between neighbouring lines, of that between straight ones, that keeps them apart; at 0 they would cross."""
LEVELS = np.linspace(0.0, 1.0, 17)
"""w between which those areas are looked at."""
LEAST_WIDTH, WIDTH, MOST_WIDTH = 0.1, 1.5, 0.5
"""Width in u of the parts of sides beside corners: of how far lines leave the fillet sideways there, so that they do
not come closer than to about 0.4 of their distance; in narrower ones than the least knots would crowd."""
SAME_PLACE = 1e-8
"""Distance in w of knots of the side on two lines below which one knot serves both: it is then as far off."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Leaving(FrozenRecord):
    """What lines at k sites leave a fillet with."""

    contact: Array
    """c (k,)"""
    sideways: Array
    """K m (k,)"""
    upwards: Array
    """K g (k,), below 0 at the shroud"""
    rise: Array
    """c' (k,), known where the section has corners"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Course(FrozenRecord):
    """How lines of a strip run at k sites."""

    contact: Array
    """c (k,)"""
    sideways: Array
    """m (k,)"""
    upwards: Array
    """g (k,)"""
    slope: Array
    """k (k,)"""
    share: Array
    """q (k,)"""
    along: Array
    """r (k,)"""


def leaving(section: ClosedSection, found: Contacts, slope: Array, rise: Array) -> Leaving:
    """From contacts and dF/ds (k, 3) on the blade."""
    along, across = section.derivatives(found.sites, found.v, (1, 0), (0, 1))
    sideways, upwards = resolved(along, across, -slope)
    return Leaving(contact=found.v, sideways=sideways, upwards=upwards, rise=rise)


def resolved(along: Array, across: Array, vectors: Array) -> tuple[Array, Array]:
    """The shares (k,) of two tangents (k, 3) in vectors (k, 3) of their plane."""
    a, b, c = dot(along, along), dot(along, across), dot(across, across)
    first, second = dot(along, vectors), dot(across, vectors)
    size = a * c - b * b
    return (c * first - b * second) / size, (a * second - b * first) / size


@dataclass(frozen=True, kw_only=True, eq=False)
class Strip(FrozenRecord):
    """How lines run from a fillet to the side, chosen from the real blade and held in derivatives."""

    level: float
    """b"""
    slope: float
    """k, below 0 at the shroud"""
    speed: float
    """K"""
    shifted: float
    """e"""
    curved: bool
    """whether the fillet has the side's curvature, so that second derivatives are kept at the joint too"""
    knots: Reals
    """along w"""
    width: float = 1.0
    """of the parts of both sides beside corners in which lines bend to them"""

    def course(
        self, sites: Sites, lines: Leaving, at_corners: Leaving | None = None, corner_sites: Sites | None = None
    ) -> Course:
        """How lines at sites run, from how they leave the fillet there and at the corners of the section.

        Lines of several blades (..., k) have the same sites.
        """
        sideways, upwards = lines.sideways / self.speed, lines.upwards / self.speed
        share, along = np.ones_like(lines.contact), np.zeros_like(lines.contact)
        slope = np.full_like(lines.contact, self.slope)
        if at_corners is None or corner_sites is None:
            return Course(
                contact=lines.contact, sideways=sideways, upwards=upwards, slope=slope, share=share, along=along
            )
        run = self.level - at_corners.contact
        asked = run * self.speed / (at_corners.upwards - at_corners.sideways * at_corners.rise)
        for number, (face, end) in enumerate(zip(corner_sites.side, corner_sites.u, strict=True)):
            x = 1.0 - sites.u if end == 0.0 else sites.u
            if face <= LOWER:
                x = np.maximum(0.0, 1.0 - (1.0 - np.real(x)) / self.width) ** DEGREE
            fade = np.where(sites.side == face, x, 0.0)
            own = (..., slice(number, number + 1))
            share = share + fade * (asked[own] - 1.0)
            along = along - fade * asked[own] * at_corners.sideways[own] / self.speed
            slope = slope + fade * (run[own] - self.slope)
        return Course(
            contact=lines.contact,
            sideways=share * sideways + along,
            upwards=share * upwards + along * lines.rise,
            slope=slope,
            share=share,
            along=along,
        )

    def places(self, sites: Sites, course: Course, w: Reals) -> tuple[Sites, Array]:
        """Sites and v (len(w), k) on the sides of the lines at sites (k,), at w."""
        v = np.tensordot(basis(ONE_SPAN, DEGREE, w), np.stack(self._rise(course)), axes=1)
        bump = basis(with_knot(self.shifted), DEGREE, w)[:, 1:2]
        return sites.moved(sites.u + bump * self.shifted / DEGREE * course.sideways), v

    def _rise(self, course: Course) -> list[Array]:
        """Control points (6 of (k,)) of V."""
        second = course.contact + course.upwards / DEGREE
        last = [self.level - share * course.slope / DEGREE for share in (2.0, 1.0, 0.0)]
        return [course.contact, second, 0.5 * (second + last[0]), *last]

    def points(self, section: ClosedSection, sites: Sites, course: Course, w: Reals) -> Array:
        """Points (len(w), k, 3) of the lines at w."""
        return section.derivative(*self.places(sites, course, w))

    def bend(self, section: ClosedSection, sites: Sites, course: Course) -> Array:
        """Second derivatives (k, 3) of the lines by w at the joint."""
        rise, sideways, upwards = self._rise(course), course.sideways, course.upwards
        lift = DEGREE * (DEGREE - 1) * (rise[0] - 2.0 * rise[1] + rise[2])
        # of U, by its first two spans
        turn = -(DEGREE - 1) * sideways * (1.0 + 1.0 / self.shifted)
        u, v, uu, uv, vv = section.derivatives(sites, course.contact, (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
        shares = turn, lift, sideways**2, 2.0 * sideways * upwards, upwards**2
        return np.asarray(sum(share[:, None] * each for share, each in zip(shares, (u, v, uu, uv, vv), strict=True)))

    def beside(self, at_corners: Leaving, corner_sites: Sites) -> Strip:
        """The strip with parts beside corners as wide as real lines that leave them so need in order not to cross."""
        of_side = at_corners.sideways[corner_sites.side <= LOWER] / self.speed
        most = float(np.max(np.square(of_side), initial=0.0)) ** 0.5
        return replace(self, width=min(max(LEAST_WIDTH, WIDTH * most), MOST_WIDTH))

    def unfolded(self, sites: Sites, course: Course) -> Strip:
        """The strip with the length of U that keeps real lines that run so at sites apart."""
        tried = [replace(self, shifted=e, knots=with_knot(e)) for e in SHIFTS]
        areas = [_least_area(each, sites, course) for each in tried]
        return tried[int(np.argmax(np.minimum(areas, FOLDED)))]

    def with_side_knots(self, knots: Reals, contacts: Reals) -> Strip:
        """The strip with the side's knots along v at their places on the lines at corners, from contacts (k,) on."""
        own = self.knots
        for level, count in zip(*np.unique(knots, return_counts=True), strict=True):
            for place in (level - contacts) / (self.level - contacts):
                if np.all(np.square(own - place) > SAME_PLACE**2):
                    own = knots_with_joints(own, DEGREE, [(float(place), DEGREE - int(count))])
        return replace(self, knots=own)

    @property
    def sites(self) -> Reals:
        """w inside at which lines are interpolated: derivatives take the places beside the ends."""
        return greville(self.knots, DEGREE)[2 + self.curved : -3]

    def net(self, start: Sequence[Array], inside: Array, end: Sequence[Array]) -> Array:
        """Control points (n, ...) of lines along w.

        From where they start with their first and, where it is kept, second derivatives, from the points (m, ...) at
        the inner sites, and from where they end with two derivatives.
        """
        first = end_points(start, self.knots)
        last = end_points([end[0], -end[1], end[2]], 1.0 - self.knots[::-1])[::-1]
        middle = slice(len(first), -len(last))
        matrix = basis(self.knots, DEGREE, self.sites)
        known = np.concatenate([matrix[:, : len(first)], matrix[:, -len(last) :]], axis=1)
        right = inside - np.tensordot(known, np.stack([*first, *last]), axes=1)
        return np.stack([*first, *np.tensordot(np.linalg.inv(matrix[:, middle]), right, axes=1), *last])

    def side_end(self, side: Surface, knots_u: Reals) -> list[Array]:
        """Where lines end, and their two derivatives, as control points (n, 3) on knots that have those of the side."""
        change = knot_change(side.knots_u, DEGREE, knots_u)
        rows = [basis(side.knots_v, DEGREE, [self.level], order)[0] * self.slope**order for order in range(3)]
        return [change @ np.tensordot(row, side.control_points, axes=(0, 1)) for row in rows]


def with_knot(place: float) -> Reals:
    """Knots of one span with a knot inside, where it is inside."""
    return np.insert(ONE_SPAN, DEGREE + 1, place) if place < 1.0 else ONE_SPAN


def end_points(derivatives: Sequence[Array], knots: Reals) -> list[Array]:
    """The first control points of a spline on knots from 0 that starts with a point and these derivatives.

    Those are the first, or the first two (Piegl and Tiller 1997, eqs. 3.7 and 3.9).
    """
    near, far = knots[DEGREE + 1], knots[DEGREE + 2]
    found = [derivatives[0], derivatives[0] + derivatives[1] * near / DEGREE]
    if len(derivatives) > 2:
        found.append(found[1] + far * (derivatives[2] * near / (DEGREE * (DEGREE - 1)) + derivatives[1] / DEGREE))
    return found


def strips_for(
    lines: Mapping[str, Leaving], ends: Mapping[str, float], curved: Mapping[str, bool], knots: Reals
) -> dict[str, Strip]:
    """Strips of lines that leave fillets so, by the wall, of one span each.

    `ends` are the v of the walls, `curved` tells which fillets have the side's curvature, `knots` are those of the side
    along v.
    """
    away = {wall: _inwards(end) * (lines[wall].contact - end) for wall, end in ends.items()}
    room = 1.0 - sum(float(np.max(each)) for each in away.values())
    found = {}
    for wall, end in ends.items():
        level, toward = _level(away[wall], room, knots, end), _inwards(end)
        run = toward * (level - end) - away[wall]
        steep = toward * lines[wall].upwards / run
        speed = max(float(np.mean(steep)), float(np.max(steep)) / (DEGREE * FIRST_STEP))
        slope = min(float(np.mean(run)), float(np.min(run)) * DEGREE * LAST_STEP / 2.0)
        found[wall] = Strip(
            level=level, slope=toward * slope, speed=speed, shifted=1.0, curved=curved[wall], knots=ONE_SPAN
        )
    return found


def _inwards(end: float) -> float:
    """The way from an end of the blade into the span."""
    return 1.0 - 2.0 * end


def _level(away: Reals, room: float, knots: Reals, end: float) -> float:
    """v at which strips over contacts (k,) so far from an end are to end: at one of the knots where one is near."""
    lowest, highest = float(np.min(away)), float(np.max(away))
    most = MOST_OF_ROOM * room
    asked = min(max(SHORTEST * highest, UNEQUAL * (highest - lowest)), most)
    lengths = _inwards(end) * (knots - end) - highest
    near = (lengths >= NEAR_KNOT[0] * asked) & (lengths <= min(NEAR_KNOT[1] * asked, most))
    if near.any():
        return float(knots[near][np.argmin(np.square(lengths[near] - asked))])
    return end + _inwards(end) * (highest + asked)


def _least_area(strip: Strip, sites: Sites, course: Course) -> float:
    """Least area between neighbouring lines in (u, v), of that between straight ones: below 0 they cross."""
    moved, v = strip.places(sites, course, LEVELS)
    least = []
    for side in np.unique(sites.side):
        own = np.flatnonzero(sites.side == side)
        own = own[np.argsort(sites.u[own])]
        own = own[np.diff(sites.u[own], prepend=-1.0) > JOINT_TOLERANCE]
        line = np.stack([moved.u[:, own], v[:, own]])
        between = np.diff(line, axis=2)[:, :-1]
        up = np.diff(line, axis=1)
        area = between[0] * up[1, :, :-1] - between[1] * up[0, :, :-1]
        straight = np.diff(sites.u[own]) * np.diff(LEVELS)[:, None] * (strip.level - course.contact[own][:-1])
        least.append(float(np.min(area / straight)))
    return min(least)
