"""The blade above its fillets: the sides from contact to contact, by lines that leave the joints as the fillet does.

A line of constant u of the blade above is, with w from 0 to 1 along the span, S(u + U(w), V(w)) on the sides S:

    V(w) = L + (H - L) w + sum over the ends of (c - E) f(x / b) + (g - (H - L)) d h(x / b) b,
    U(w) = sum over the ends of m h(x / e) e,    f(x) = (1 - x)^5 (1 + 5 x),    h(x) = x (1 - x)^5,

x = w at the hub's end, where E = L and d = 1, and 1 - w at the shroud's, where E = H and d = -1; c is the v of the
contact, and past the lengths b and e every line is as it was. m and g are chosen so that at the joint

    dB/dx = m S_u + d g S_v = -dF/ds / K

with one K for the whole joint: control points of the first two rows then satisfy F1 - F0 = -k (B1 - B0), so that blade
and fillet have one tangent plane at every point of the joint, not only where they are interpolated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bladewright.blade.native.closed_section import ClosedSection, Sites
from bladewright.blade.native.contacts import Contacts
from bladewright.blade.native.knots import DEGREE
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import JOINT_TOLERANCE, Reals, basis, greville, knots_with_joints

BENT = 6.0
"""Length in which lines bend to a contact, over how far it is from the mean of all: they come no closer than to 0.6 of
their distance (f falls by 2.46 / b at most)."""
LEAST_BENT = 0.2
"""Least length of the part that bends [-]: in a shorter one knots would lie closer than the contacts ask for."""
FOLDED = 0.35
"""Share of their distance that is left to lines as they leave the joint sideways; at 0 they would cross."""
HIGHEST = (5.0 / 6.0) ** 5 / 6.0
"""Largest value of h."""
FIRST_OF_F, FIRST_OF_H = -30.0, -10.0
"""Second derivatives of f and h at 0."""
NEAR_END = 0.02
"""Distance from an end below which the sides' own knots are left out: others are put there where they are needed."""
SMOOTH = 4
"""Derivatives that f and h keep where they end."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Joint(FrozenRecord):
    """How lines of the blade leave one fillet, chosen from the real blade and held in derivatives."""

    level: float
    """L or H: mean v of the contacts"""
    bent: float
    """b"""
    shifted: float
    """e"""
    speed: float
    """K"""


Joints = Mapping[str, Joint]
"""by the wall, `hub` or `shroud`, where there is a fillet"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Leaving(FrozenRecord):
    """What lines at k sites leave a fillet with."""

    contact: Array
    """c (k,)"""
    sideways: Array
    """K m (k,)"""
    upwards: Array
    """K g (k,)"""


def leaving(section: ClosedSection, found: Contacts, slope: Array, toward: int) -> Leaving:
    """From contacts and dF/ds (k, 3) on the blade; `toward` is d, +1 at the hub's end, -1 at the shroud's."""
    along, across = section.derivatives(found.sites, found.v, (1, 0), (0, 1))
    sideways, upwards = resolved(along, across, -slope)
    return Leaving(contact=found.v, sideways=sideways, upwards=toward * upwards)


def resolved(along: Array, across: Array, vectors: Array) -> tuple[Array, Array]:
    """The shares (k,) of two tangents (k, 3) in vectors (k, 3) of their plane."""
    a, b, c = dot(along, along), dot(along, across), dot(across, across)
    first, second = dot(along, vectors), dot(across, vectors)
    size = a * c - b * b
    return (c * first - b * second) / size, (a * second - b * first) / size


def _fade(x: Reals, order: int = 0) -> Reals:
    """f or its derivative at x >= 0."""
    rest = np.maximum(0.0, 1.0 - x)
    return -30.0 * x * rest**4 if order else rest**5 * (1.0 + 5.0 * x)


def _bump(x: Reals, order: int = 0) -> Reals:
    """h or its derivative at x >= 0."""
    rest = np.maximum(0.0, 1.0 - x)
    return rest**4 * (1.0 - 6.0 * x) if order else x * rest**5


Ends = Mapping[str, tuple[Joint, Leaving]]
"""By the wall, where there is a fillet."""


def levels_of(joints: Joints) -> tuple[float, float]:
    """L and H."""
    return joints["hub"].level if "hub" in joints else 0.0, joints["shroud"].level if "shroud" in joints else 1.0


def places(sites: Sites, ends: Ends, w: Reals) -> tuple[Sites, Array]:
    """Sites and v (len(w), k) on the sides of the lines at sites (k,), at w."""
    low, high = levels_of({wall: joint for wall, (joint, _) in ends.items()})
    at = np.asarray(w)[:, None]
    u: Array = np.broadcast_to(sites.u, (len(w), len(sites)))
    v: Array = low + (high - low) * at + np.zeros(len(sites))
    for wall, (joint, lines) in ends.items():
        toward, x = (1, at) if wall == "hub" else (-1, 1.0 - at)
        sideways, upwards = lines.sideways / joint.speed, lines.upwards / joint.speed
        v = v + (lines.contact - joint.level) * _fade(x / joint.bent)
        v = v + toward * (upwards - (high - low)) * joint.bent * _bump(x / joint.bent)
        u = u + sideways * joint.shifted * _bump(x / joint.shifted)
    return sites.moved(u), v


def joints_for(sites: Sites, lines: Mapping[str, Leaving]) -> dict[str, Joint]:
    """How lines that leave so at real sites do it without crossing."""
    means = {wall: float(np.mean(each.contact)) for wall, each in lines.items()}
    span = means.get("shroud", 1.0) - means.get("hub", 0.0)
    found = {}
    for wall, each in lines.items():
        away = float(np.max(np.square(each.contact - means[wall]))) ** 0.5
        bent = float(np.clip(BENT * away / span, LEAST_BENT, 1.0))
        speed = float(np.mean(each.upwards)) / span
        closing = max(float(np.max(-_closing(sites, each.sideways / speed), initial=0.0)), 1e-9)
        shifted = min(bent, (1.0 - FOLDED) / (HIGHEST * closing))
        found[wall] = Joint(level=means[wall], bent=bent, shifted=shifted, speed=speed)
    return found


def _closing(sites: Sites, sideways: Reals) -> Reals:
    """Slopes of the sideways speed by u between neighbouring sites of each side."""
    slopes = []
    for side in (0, 1):
        own = sites.side == side
        order = np.argsort(sites.u[own])
        u, speed = sites.u[own][order], sideways[own][order]
        far = np.diff(u) > JOINT_TOLERANCE
        slopes.append(np.diff(speed)[far] / np.diff(u)[far])
    return np.concatenate(slopes)


def first_knots(plain: Reals, joints: Joints) -> Reals:
    """Knots along w to begin with: the sides' own where lines are as they were, and the ends of f and h."""
    first, last = levels_of(joints)
    inner = (plain[(plain > 0.0) & (plain < 1.0)] - first) / (last - first)
    inner = inner[(inner > NEAR_END) & (inner < 1.0 - NEAR_END)]
    knots = np.concatenate([np.zeros(DEGREE + 1), inner, np.ones(DEGREE + 1)])
    ends = [(wall, x) for wall, joint in joints.items() for x in (joint.bent, joint.shifted)]
    return knots_with_joints(knots, DEGREE, [(x if wall == "hub" else 1.0 - x, SMOOTH) for wall, x in ends])


def bend(section: ClosedSection, found: Contacts, ends: Ends, wall: str) -> Array:
    """d2B/dx2 (k, 3) of the blade above at its joint with a fillet."""
    low, high = levels_of({name: joint for name, (joint, _) in ends.items()})
    joint, lines = ends[wall]
    toward = 1 if wall == "hub" else -1
    sideways, upwards = lines.sideways / joint.speed, toward * lines.upwards / joint.speed
    turn = FIRST_OF_H * sideways / joint.shifted
    lift = FIRST_OF_F * (lines.contact - joint.level) / joint.bent**2
    lift = lift + FIRST_OF_H * (upwards - toward * (high - low)) / joint.bent
    u, v, uu, uv, vv = section.derivatives(found.sites, found.v, (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    shares = turn, lift, sideways**2, 2.0 * sideways * upwards, upwards**2
    return np.asarray(sum(share[:, None] * each for share, each in zip(shares, (u, v, uu, uv, vv), strict=True)))


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanSplines(FrozenRecord):
    """Splines along w through values at sites, and at filleted ends the first derivatives by x."""

    knots: Reals
    orders: Mapping[str, int]
    """how many derivatives, 1 or 2, by the wall"""

    @property
    def sites(self) -> Reals:
        """w of the values: derivatives take the places beside the end."""
        own = greville(self.knots, DEGREE)
        first, last = 1 + self.orders.get("hub", 0), len(own) - 1 - self.orders.get("shroud", 0)
        return np.concatenate([own[:1], own[first:last], own[-1:]])

    def net(self, values: Array, derivatives: Mapping[str, Sequence[Array]]) -> Array:
        """Control points (n, ...) from values (m, ...) at the sites and the derivatives by x at filleted ends."""
        count, knots = len(self.knots) - DEGREE - 1, self.knots
        first = _first_points(values[0], derivatives.get("hub", ()), knots - knots[0])
        last = _first_points(values[-1], derivatives.get("shroud", ()), knots[-1] - knots[::-1])[::-1]
        inside = slice(len(first), count - len(last))
        outer = np.stack([*first, *last])
        matrix = basis(knots, DEGREE, self.sites[1:-1])
        known = np.delete(matrix, inside, axis=1)
        right = values[1:-1] - np.tensordot(known, outer, axes=1)
        inner = np.tensordot(np.linalg.inv(matrix[:, inside]), right, axes=1)
        return np.concatenate([outer[: len(first)], inner, outer[len(first) :]])


def _first_points(start: Array, derivatives: Sequence[Array], knots: Reals) -> list[Array]:
    """The first control points of a spline that starts so (Piegl and Tiller 1997, eqs. 3.7 and 3.9)."""
    found = [start]
    near, far = knots[DEGREE + 1], knots[DEGREE + 2]
    if len(derivatives) > 0:
        found.append(start + derivatives[0] * near / DEGREE)
    if len(derivatives) > 1:
        second = derivatives[1] * near / (DEGREE * (DEGREE - 1))
        found.append(found[1] + far * (second + derivatives[0] / DEGREE))
    return found
