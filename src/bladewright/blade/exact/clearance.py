"""The clearance surface that a blade ends on, off a wall, and the blade's own channel between it and the other wall.

Its meridian is the curve of the channel's points at the stated distance from the wall: for every u the place w(u) on
the line u = const and the foot f(u) on the wall solve

    X(u, w) = S(f) + d(u) n(f),

X the channel, S the wall's meridian continued by its own polynomials, n its unit normal into the channel, and d linear
in u. So the meridian starts on the leading- and ends on the trailing-edge curve.
"""

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.flow_path.channel import ChannelCurve, TransfiniteChannel, transfinite_channel
from bladewright.blade.flow_path.cut_channel import channel_in_flow_path
from bladewright.blade.native.knots import DEGREE, clamped, refined
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, length
from bladewright.numerics.roots import level_crossings
from bladewright.nurbs.basis import Reals, basis, greville, knots_with_joints
from bladewright.nurbs.fit import interpolated
from bladewright.section.checks import UNITS
from bladewright.section.crossing import PLACES, outlines_of

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign
    from bladewright.blade.design.unified import UnifiedBlade
    from bladewright.blade.exact.unified import UnifiedSections

REACHED = 1e-9
"""Difference between the stated distance from the wall and that of the fitted meridian, of the mean meridional
chord, to which knots are refined: rounding, with a margin."""
ALLOWED = 1e-8
"""The same difference above which a design is refused; it is what `docs/nomenclature.md` promises of a clearance."""
MOST_POLES = 60
"""Control points of the fitted meridian up to which knots are added; a wall that needs more is not smooth enough to
keep a clearance from."""
_SHARES = np.array([0.03, 0.09, 0.2, 0.35, 0.5, 0.65, 0.8, 0.91, 0.97])
"""Places in a knot span at which the difference is looked at, denser towards the ends: beside much shorter spans it
is largest there."""
STEPS = 30
"""Newton steps after which no point at the distance is expected any more; mostly four suffice."""
CONVERGED = 1e-16
"""Square of a Newton step in u below which it is the last: the error left is of that size, which is rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Clearance:
    """The distance of a blade's end from a wall."""

    name: str
    """the design's field"""
    wall: str
    """`hub` or `shroud`"""
    leading: Array
    """(...) distance at the leading edge [m]"""
    trailing: Array
    """(...) distance at the trailing edge [m]"""
    unit: str
    """the design's unit of length"""

    @property
    def inward(self) -> float:
        """+1 where the channel lies to the left of the wall, -1 where to the right."""
        return 1.0 if self.wall == "hub" else -1.0

    def distance(self, u: Reals) -> Array:
        """Stated distance (..., m) [m] at u (m,)."""
        return self.leading[..., None] * (1.0 - u) + self.trailing[..., None] * u

    def real(self) -> "Clearance":
        """The same without imaginary parts and batch."""
        leading, trailing = (np.asarray(np.real(np.ravel(value)[0])) for value in (self.leading, self.trailing))
        return replace(self, leading=leading, trailing=trailing)

    def in_unit(self, distance: float) -> str:
        """A distance [m] in the design's unit."""
        return f"{distance / UNITS[self.unit]:.4g} {self.unit}"

    def check_span(self, u: Reals, away: Reals) -> None:
        """Refuse a clearance that leaves no blade at some u (m,), where the other end is `away` (m,) from the wall."""
        stated = self.distance(u)
        worst = int(np.argmax(stated / away))
        if stated[worst] >= away[worst]:
            other = "hub" if self.wall == "shroud" else "shroud"
            raise DesignError(
                f"{self.name} is {self._at(u[worst])}, where the {other} is {self.in_unit(away[worst])} from the "
                f"{self.wall}: a clearance must be smaller than the span everywhere; lower {self.name}"
            )

    def check_nose(self, u: float, edge: str) -> None:
        """Refuse a clearance that ends on the blade's nose at u, past the edge at which it is smaller."""
        if float(self.distance(np.array([u]))[0]) <= 0.0:
            raise DesignError(
                f"{self.name} is linear in u and falls to {self._at(u)}, the nose past the {edge} edge: the blade "
                f"would meet the {self.wall} there; bring its two values nearer to each other"
            )

    def folding(self, u: Reals, bend: Reals, given_by: str) -> str:
        """Why the surface folds over, where the wall's curvature towards the blade at u (m,) is `bend` (m,) [1/m]."""
        worst = int(np.argmax(bend * self.distance(u)))
        radius = self.in_unit(1.0 / float(bend[worst])) if bend[worst] > 0.0 else "without limit"
        return (
            f"{self.name} is {self._at(u[worst])}, where the {self.wall}'s radius of curvature towards the blade is "
            f"{radius}: the surface at that distance folds over near there; lower {self.name}, or smooth "
            f"{given_by}.{self.wall}"
        )

    def check_met(self, gap: float, knots: Reals, given_by: str) -> None:
        """Refuse a fitted meridian on `knots` that misses its distance by `gap`, of the meridional chord."""
        if gap > ALLOWED:
            raise DesignError(
                f"{self.name}: the surface at that distance from the {self.wall} is met within {gap:.2g} of the "
                f"meridional chord with {len(knots) - DEGREE - 1} control points, {ALLOWED:g} is allowed: lower "
                f"{self.name}, or smooth {given_by}.{self.wall}"
            )

    def _at(self, u: float) -> str:
        """The clearance at u, in words."""
        stated = self.in_unit(float(self.distance(np.array([u]))[0]))
        return f"{stated} at u = {u:.3f} (0 at the leading, 1 at the trailing edge)"


def clearance_of(design: "RowDesign") -> Clearance | None:
    """The clearance of a design, or None where its blade reaches from wall to wall."""
    for name, wall in (("tip_clearance", "shroud"), ("hub_clearance", "hub")):
        value = getattr(design, name)
        if value is not None:
            pair = value if isinstance(value, tuple) else (value, value)
            leading, trailing = (UNITS[design.length_unit] * np.asarray(each) for each in pair)
            return Clearance(name=name, wall=wall, leading=leading, trailing=trailing, unit=design.length_unit)
    return None


def channels_of(
    design: "UnifiedBlade", knots: Reals | None = None
) -> tuple[TransfiniteChannel, TransfiniteChannel, Clearance | None]:
    """The channel from wall to wall, the blade's own, which is the same without a clearance, and the clearance.

    `knots` hold those of the clearance surface's meridian. Raises DesignError where there is no such surface.
    """
    if design.flow_path is None:
        full = transfinite_channel(design.channel, design.metre)
    else:
        full = channel_in_flow_path(design.channel, design.flow_path, design.metre)
    clearance = clearance_of(design)
    return full, full if clearance is None else cleared(full, clearance, knots), clearance


def cleared(full: TransfiniteChannel, clearance: Clearance, knots: Reals | None = None) -> TransfiniteChannel:
    """The channel between the other wall and the clearance surface, whose meridian takes the place of the wall's.

    Its edges are the full channel's, up to the meridian. `knots` hold those of the meridian; without, they are refined
    until it keeps its distance. Raises DesignError where the channel has no such surface.
    """
    real, real_clearance = full.real(), clearance.real()
    if knots is None:
        real.check_folds()
        _check_span(real, real_clearance)
        knots = _knots(real, real_clearance)
    sites = greville(knots, DEGREE)
    places, foot_u = _met(real, real_clearance, sites)
    miss, across, along = _miss(full, clearance, sites, places, foot_u)
    # one more of Newton's steps, in complex numbers, is the derivative of the meeting point
    step = cross2(miss, along) / cross2(across, along)
    points = full.at(sites, places)[0] - step[..., None] * across
    ends = (places - step)[..., [0, -1]]
    meridian = ChannelCurve(points=np.linalg.solve(basis(knots, DEGREE, sites), points), knots=knots)
    cut = "end" if clearance.wall == "shroud" else "start"
    return replace(
        full,
        **{
            "leading_edge": full.leading_edge.cut(cut, ends[..., 0]),
            "trailing_edge": full.trailing_edge.cut(cut, ends[..., 1]),
            clearance.wall: meridian,
        },
    )


def off_distance(full: TransfiniteChannel, clearance: Clearance, u: Reals, points: Reals) -> Reals:
    """Differences (m,) [m] between the distances of points (x, r) (m, 2) from the wall and those stated at u (m,)."""
    wall, foot_u = full.real().line(clearance.wall), u
    for _ in range(8):
        foot, slope, bend = (wall.values(foot_u, order) for order in range(3))
        gap = points - foot
        step = dot(gap, slope) / (dot(slope, slope) - dot(gap, bend))
        foot_u = foot_u + step
        if np.max(np.square(step)) < CONVERGED:
            break
    return np.abs(length(points - wall.values(foot_u)) - clearance.real().distance(u))  # real: a measured distance


def check_clearance(clearance: Clearance, sections: "UnifiedSections", row: int) -> None:
    """Refuse a clearance that ends on the nose of the blade, past the edge at which it is smaller.

    `row` is the number of the section at the clearance.
    """
    outline = outlines_of(*sections.plane_points(PLACES))[..., [row], :, :]
    u = np.real(sections.lines.rows([row]).u_at(outline[..., 0]))
    clearance.real().check_nose(float(np.min(u)), "leading")
    clearance.real().check_nose(float(np.max(u)), "trailing")


def _knots(full: TransfiniteChannel, clearance: Clearance) -> Reals:
    """Knots of the meridian: where hub and shroud lose derivatives, and wherever else the distance asks for them."""
    joints = [each for wall in (full.hub, full.shroud) for each in wall.smoothness()]
    start = knots_with_joints(clamped(np.empty(0)), DEGREE, [*joints, *_passed(full, clearance)])
    chord = float(np.mean([length(each.corners[1] - each.corners[0]) for each in (full.hub, full.shroud)]))

    @cache
    def worst(on: bytes) -> Reals:
        """Largest miss in each of the spans of knots, of the chord."""
        knots = np.frombuffer(on)
        sites, spans = greville(knots, DEGREE), np.unique(knots)
        points = full.at(sites, _met(full, clearance, sites)[0])[0]
        u = (spans[:-1, None] + np.diff(spans)[:, None] * _SHARES).ravel()
        found = interpolated(points, sites, degree=DEGREE, knots=knots)(u)
        return np.max(off_distance(full, clearance, u, found).reshape(-1, len(_SHARES)), axis=1) / chord

    def miss(knots: Reals, places: Reals) -> Reals:
        return worst(knots.tobytes())[np.searchsorted(np.unique(knots), places) - 1] / REACHED

    knots = refined(start, miss, MOST_POLES)
    gap = float(np.max(worst(knots.tobytes())))
    clearance.check_met(gap, knots, full.line(clearance.wall).given_by)
    return knots


def _passed(full: TransfiniteChannel, clearance: Clearance) -> list[tuple[float, int]]:
    """u where the nearest point passes inner knots of the wall, each with the derivatives continuous there."""
    kept = dict(full.line(clearance.wall).smoothness())
    if not kept:
        return []
    u = np.linspace(0.0, 1.0, 101)
    feet = _met(full, clearance, u)[1]
    passed = [(level_crossings(lambda at: _met(full, clearance, at)[1], u, feet, [each]), kept[each]) for each in kept]
    return [(float(place), smooth) for places, smooth in passed for place in places]


def _met(full: TransfiniteChannel, clearance: Clearance, u: Reals) -> tuple[Reals, Reals]:
    """Span places w and wall parameters f (m,) of the points at the stated distance, by Newton's method."""
    hub, shroud = full.hub.values(u), full.shroud.values(u)
    share = clearance.distance(u) / length(shroud - hub)
    places, foot_u = share if clearance.wall == "hub" else 1.0 - share, u
    for _ in range(STEPS):
        miss, across, along = _miss(full, clearance, u, places, foot_u)
        area = cross2(across, along)
        with np.errstate(all="ignore"):
            steps = cross2(miss, along) / area, cross2(across, miss) / area
        places, foot_u = places - steps[0], foot_u - steps[1]
        size = float(np.max(np.square(steps)))
        if not size < 1.0:
            break
        if size < CONVERGED:
            if np.all((places > 0.0) & (places < 1.0) & (_bend(full, clearance, foot_u) * clearance.distance(u) < 1.0)):
                return places, foot_u
            break
    raise DesignError(_cusp(full, clearance))


def _miss(full: TransfiniteChannel, clearance: Clearance, u: Reals, w: Reals, f: Reals) -> tuple[Array, Array, Array]:
    """X(u, w) - S(f) - d(u) n(f) and its derivatives by w and by f, (..., m, 2) each."""
    point, across = full.at(u, w)
    foot, slope, bend = (full.line(clearance.wall).values(f, order) for order in range(3))
    speed = length(slope)[..., None]
    normal = clearance.inward * np.stack([-slope[..., 1], slope[..., 0]], axis=-1) / speed
    away = clearance.distance(u)[..., None]
    curvature = clearance.inward * cross2(slope, bend)[..., None] / speed**3
    return point - foot - away * normal, across, slope * (away * curvature - 1.0)


def _bend(full: TransfiniteChannel, clearance: Clearance, foot_u: Reals) -> Reals:
    """Curvature (m,) of the wall towards the channel [1/m]."""
    slope, bend = (full.line(clearance.wall).values(foot_u, order) for order in (1, 2))
    return clearance.inward * cross2(slope, bend) / length(slope) ** 3


def _check_span(full: TransfiniteChannel, clearance: Clearance) -> None:
    """Refuse a clearance that leaves no blade somewhere."""
    u = np.linspace(0.0, 1.0, 101)
    other = "hub" if clearance.wall == "shroud" else "shroud"
    wall = full.line(clearance.wall).values(np.linspace(-0.1, 1.1, 601))
    span = np.min(length(full.line(other).values(u)[:, None] - wall), axis=1)
    clearance.check_span(u, np.asarray(span))


def _cusp(full: TransfiniteChannel, clearance: Clearance) -> str:
    u = np.linspace(-0.05, 1.05, 111)
    return clearance.folding(u, _bend(full, clearance, u), full.line(clearance.wall).given_by)
