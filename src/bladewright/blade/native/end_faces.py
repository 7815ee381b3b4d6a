"""The ends of a blade: trimmed pieces of hub, shroud or clearance surface, and caps past them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.errors import DesignError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, angle, concatenated, dot, length
from bladewright.numerics.roots import level_crossings
from bladewright.nurbs.basis import JOINT_TOLERANCE, Reals, greville, knots_with_joints
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import piece, reparametrised
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.refine import inserted
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

FOLLOWED = 1e-9
"""Largest distance [chords] of the image of an end's outline from the side's edge, beyond what that edge lies off
the wall: a hundredth of what ends may be off their walls. Of 2,000 random designs 85 were refused for it
(design/random_designs.md)."""

MARGIN = 0.05
"""How far a wall reaches past the blade's end, as a share of its width, so that the end's outline lies inside."""


EDGES = ("leading_edge", "trailing_edge")


@dataclass(frozen=True, kw_only=True, eq=False)
class WallSurface:
    """A meridian turned about the x axis over theta from `low` to `high`, or drawn along y in a cascade."""

    meridian: Curve
    """(x, r), or (x, z) in a cascade"""
    inner: Reals
    """the meridian's inner knots where it loses derivatives, each as often as it occurs"""
    revolved: bool
    low: float
    high: float

    @cached_property
    def revolution(self) -> Revolution | None:
        """How the wall is revolved."""
        return Revolution(meridian=self.meridian, start=self.low, end=self.high) if self.revolved else None

    @cached_property
    def surface(self) -> Surface:
        """The whole wall: u along the meridian, v across."""
        return _drawn(self.meridian, self.low, self.high) if self.revolution is None else self.revolution.surface()

    def parameters(self, u: Array, across: Array) -> Array:
        """(u, v) on the surface at the meridian's u and theta or y."""
        v = (across - self.low) / (self.high - self.low) if self.revolution is None else self.revolution.v(across)
        return np.stack([u, v], axis=-1)

    def stretch(self, uv: Reals) -> Reals:
        """Lengths (k, 2) of the surface's derivatives by u and v."""
        line = _real(self.meridian)
        around = np.full(len(uv), self.high - self.low)
        if self.revolution is not None:
            around = line(uv[:, 0])[:, 1] * self.revolution.slope(uv[:, 1])
        return np.stack([length(line.derivative(uv[:, 0])), around], axis=-1)

    @property
    def seams(self) -> Reals:
        """theta between the rational arcs, where the surface has one continuous derivative."""
        return (
            np.empty(0) if self.revolution is None else np.linspace(self.low, self.high, self.revolution.arcs + 1)[1:-1]
        )


Near = tuple[Reals, Reals, Reals]
"""Increasing parameters (k,) of a curve on a wall; and near the curve there the meridian's u, and theta, or y in a
cascade, (k,) each. Between them both are taken as linear."""


def _foot_step(meridian: Curve, u: Reals, target: Array) -> Array:
    """Newton's step towards the nearest point of the meridian."""
    miss, slope, bend = target - meridian(u), meridian.derivative(u), meridian.derivative(u, 2)
    return dot(miss, slope) / (dot(slope, slope) - dot(miss, bend))


def followed(wall: WallSurface, curve: Curve, near: Near, chord: float, knots: Reals | None = None) -> Curve:
    """A plane B-spline that the wall maps on a curve in space, as smooth as that, its knots cut until it follows.

    Or on given knots, as they are. Raises DesignError where it does not come within FOLLOWED of the chord.
    """

    def exact(s: Reals) -> Array:
        return wall.parameters(*nearest_on_wall(wall, curve, near, s))

    if knots is not None:
        sites = greville(knots, curve.degree)
        return interpolated(exact(sites), sites, degree=curve.degree, knots=knots)
    own = knots_with_joints(curve.knots, curve.degree, _joints(wall, curve, near))
    spans = np.unique(own)
    # knots that differ by their rounding have nothing between them
    wide = np.diff(spans) > JOINT_TOLERANCE * (spans[-1] - spans[0])
    for pieces in (2, 3, 4, 6, 8):
        added = [(spans[:-1] + np.diff(spans) * k / pieces)[wide] for k in range(1, pieces)]
        knots = np.sort(np.concatenate([own, *added]))
        sites = greville(knots, curve.degree)
        found = interpolated(exact(sites), sites, degree=curve.degree, knots=knots)
        between = (sites[1:] + sites[:-1]) / 2.0
        wanted, reached = np.real(exact(between)), np.real(found(between))
        miss = length((reached - wanted) * wall.stretch(wanted))
        if np.max(miss) < FOLLOWED * chord:
            return found
    raise DesignError(
        f"channel: an end of the blade cannot be followed on its wall within {FOLLOWED:g} of the chord, "
        f"{np.max(miss) / chord:.2g} is reached: smooth the wall by a higher channel.degree or fewer inner control "
        "points, or lower the tolerance"
    )


def nearest_on_wall(wall: WallSurface, curve: Curve, near: Near, s: Reals) -> tuple[Array, Array]:
    """The meridian's u, and theta or y, (len(s),), of the wall's points nearest to the curve's at s."""
    places, near_u, near_across = near
    points = curve(s)
    if wall.revolved:
        radius = length(points[..., 1:])
        across = angle(points[..., 1], points[..., 2])
        about = np.interp(s, places, near_across)
        across = across + 2.0 * np.pi * np.round((about - np.real(across)) / (2.0 * np.pi))
    else:
        radius, across = points[..., 2], points[..., 1]
    target = np.stack([points[..., 0], radius], axis=-1)
    u = np.interp(s, places, near_u)
    # the second brings rounding, without which the derivative would be as far off as the first left the place
    for _ in range(2):
        u = u + _foot_step(wall.meridian, u, np.real(target))
    return u + _foot_step(wall.meridian, u, target), across


def _joints(wall: WallSurface, curve: Curve, near: Near) -> list[tuple[float, int]]:
    """Where the curve passes inner knots and seams of the wall, and how many derivatives the parameters keep there.

    Between rational arcs, which are symmetric, that is one.
    """
    places, near_u, near_across = near

    def passed(which: int, values: Reals, levels: Reals) -> list[float]:
        def at(s: Reals) -> Reals:
            return np.real(nearest_on_wall(wall, curve, near, s)[which])

        return list(map(float, level_crossings(at, places, values, levels)))

    levels, counts = np.unique(wall.inner, return_counts=True)
    own = [
        (place, wall.meridian.degree - int(times))
        for times in np.unique(counts)
        for place in passed(0, near_u, levels[counts == times])
    ]
    return [*own, *((place, 1) for place in passed(1, near_across, wall.seams))]


def _real(curve: Curve) -> Curve:
    if not np.iscomplexobj(curve.control_points):
        return curve
    return Curve(control_points=np.real(curve.control_points), knots=curve.knots, degree=curve.degree)


def _drawn(meridian: Curve, low: float, high: float) -> Surface:
    """The meridian (x, z) drawn along y from low to high."""
    x, z = meridian.control_points[:, 0], meridian.control_points[:, 1]
    rows = [np.stack([x, np.full_like(x, y), z], axis=-1) for y in (low, high)]
    return Surface(
        control_points=np.stack(rows, axis=1),
        knots_u=meridian.knots,
        knots_v=np.array([0.0, 0.0, 1.0, 1.0]),
        degree_u=meridian.degree,
        degree_v=1,
    )


def trimmed_ends(
    exact: ExactBlade,
    upper: Surface,
    lower: Surface,
    chord: float,
    like: Mapping[str, TrimmedSurface] | None = None,
    faces: Mapping[str, Surface] | None = None,
) -> dict[str, TrimmedSurface]:
    """The pieces of the hub and shroud walls, or of a clearance surface, inside the ends of the sides.

    The walls are the channel's or the flow path's, revolved about the axis or drawn along y in a cascade, exact; their
    u is the wall's own. `like` are the ends of a blade a small step away: their stretches of the walls and their knots
    are taken. `faces` are those of blunt edges. Raises DesignError where the blade winds
    a full turn around the axis.
    """
    places = np.unique(upper.knots_u)
    own, across = exact.end_places(places)
    ends = {}
    for wall, row in (("hub", 0), ("shroud", -1)):
        name, (meridian, inner) = exact.design.ends[row], exact.end_wall(row)
        outline = [
            (end_row(side, row), (places, own[row, part], across[row, part]))
            for side, part in ((upper, slice(None, len(places))), (lower, slice(len(places), None)))
        ]
        blunt = {}
        for edge, face in ({} if faces is None else faces).items():
            at = 0 if edge == "leading_edge" else len(places) - 1
            both, two = [at, len(places) + at], np.array([0.0, 1.0])
            blunt[edge] = end_row(face, row), (two, own[row, both], across[row, both])
        known = None if like is None else like[name]
        revolved = exact.mapping.revolved
        low, high = stretch_about(across[row], wall, revolved=revolved) if known is None else _stretch_of(known)
        surface = WallSurface(meridian=meridian, inner=inner, revolved=revolved, low=low, high=high)
        ends[name] = _trimmed(surface, outline, blunt, chord, known)
    return ends


def _trimmed(
    wall: WallSurface,
    outline: Sequence[tuple[Curve, Near]],
    blunt: Mapping[str, tuple[Curve, Near]],
    chord: float,
    like: TrimmedSurface | None,
) -> TrimmedSurface:
    boundary: list[Curve] = []
    around = {"upper": outline[0], "lower": outline[1], **blunt}
    for name in ("lower", "trailing_edge", "upper", "leading_edge"):
        if name not in around:
            continue
        against, held = name in ("trailing_edge", "upper"), None if like is None else like.boundary[len(boundary)]
        knots = None if held is None else (run_back(held) if against else held).knots
        found = followed(wall, *around[name], chord, knots)
        boundary.append(run_back(found) if against else found)
    return TrimmedSurface(surface=wall.surface, boundary=tuple(boundary), revolution=wall.revolution)


@dataclass(frozen=True, kw_only=True, eq=False)
class EndKnots(FrozenRecord):
    """What derivatives hold of an end face: the extent of its wall, and the knots of the curves of its boundary."""

    domain: tuple[float, float]
    """of the meridian"""
    low: float
    """theta, or y in a cascade, at which the wall begins"""
    high: float
    """where it ends"""
    curves: tuple[Reals, ...]


def end_within(
    wall: WallSurface, chain: Sequence[tuple[Curve, Near, bool]], chord: float, held: EndKnots | None = None
) -> tuple[TrimmedSurface, EndKnots]:
    """The piece of a wall inside a closed chain of space curves, counter-clockwise in (u, v), and what is to be held.

    Each curve comes with what is near it on the wall, and whether the chain runs against it.
    """
    known: Sequence[Reals | None] = [None] * len(chain) if held is None else held.curves
    curves = [followed(wall, curve, near, chord, knots) for (curve, near, _), knots in zip(chain, known, strict=True)]
    boundary = tuple(run_back(curve) if back else curve for curve, (_, _, back) in zip(curves, chain, strict=True))
    end = TrimmedSurface(surface=wall.surface, boundary=boundary, revolution=wall.revolution)
    return end, EndKnots(
        domain=wall.meridian.domain, low=wall.low, high=wall.high, curves=tuple(curve.knots for curve in curves)
    )


def stretch_about(across: Reals, name: str, *, revolved: bool) -> tuple[float, float]:
    """Where the wall starts and ends in theta, or y in a cascade: with a margin about the blade's end."""
    low, high = float(across.min()), float(across.max())
    margin = MARGIN * (high - low)
    if revolved and high - low + 2.0 * margin >= 2.0 * np.pi:
        raise DesignError(
            f"stagger: the blade winds {np.degrees(high - low):.0f} deg around the axis at the {name}: its end "
            "must be one trimmed face of less than 327 deg; lower the stagger there"
        )
    return low - margin, high + margin


def _stretch_of(end: TrimmedSurface) -> tuple[float, float]:
    """The same of an end that is there."""
    if end.revolution is not None:
        return end.revolution.start, end.revolution.end
    y = np.real(end.surface.control_points[0, :, 1])
    return float(y[0]), float(y[-1])


def cap(upper: Surface, lower: Surface, faces: Mapping[str, Surface], back: float | None, row: int) -> Surface:
    """The cap of the end at v = 0 (row 0) or v = 1 (row -1): v runs from the lower to the upper side's end.

    It has the control points of its neighbours' ends: ruled where the sides meet at both edges, and else Coons's
    bilinear patch. `faces` are those of blunt edges; `back` is the u from which both sides are one straight back face,
    across which the cap ends. Coons 1967; Farin 2002, Curves and Surfaces for CAGD, section 22.2.
    """
    low, high = (end_row(side, row) for side in (lower, upper))
    across = {name: run_back(end_row(face, row)) for name, face in faces.items()}
    if back is not None:
        across["trailing_edge"] = _end_to_end(piece(low, back, 1.0), run_back(piece(high, back, 1.0)))
        low, high = (reparametrised(piece(end, 0.0, back)) for end in (low, high))
    net = np.stack([low.control_points, high.control_points], axis=-2)
    if not across:
        return Surface(
            control_points=net,
            knots_u=low.knots,
            knots_v=np.array([0.0, 0.0, 1.0, 1.0]),
            degree_u=low.degree,
            degree_v=1,
        )
    pattern = across["trailing_edge"] if "trailing_edge" in across else across["leading_edge"]
    return Surface(
        control_points=_coons(net, across, _shares(low), _shares(pattern)),
        knots_u=low.knots,
        knots_v=pattern.knots,
        degree_u=low.degree,
        degree_v=pattern.degree,
    )


def parted(side: Surface, back: float | None) -> Surface:
    """The side with full knots where a back face begins, its shape unchanged, so that it has two ends at each wall."""
    if back is None:
        return side
    missing = side.degree_u - int(np.sum(side.knots_u == back))
    return inserted(side, np.full(missing, back), "u") if missing else side


def _coons(net: Array, across: Mapping[str, Curve], u: Reals, v: Reals) -> Array:
    """The net within the ends of both sides (n, 2, 3) and the curves `across`, straight where there is none.

    A linear function has its values at the Greville abscissae u (n,) and v (m,) for control points.
    """
    ruled = net[:, :1] + v[:, None] * (net[:, 1:] - net[:, :1])
    for edge, at, share in zip(EDGES, (0, -1), (1.0 - u, u), strict=True):
        if edge in across:
            ruled = ruled + share[:, None, None] * (across[edge].control_points - ruled[at])
    return concatenated([net[:, :1], ruled[:, 1:-1], net[:, 1:]], axis=1)


def _end_to_end(first: Curve, second: Curve) -> Curve:
    """Two curves over [0, 1], the first up to 1/2, where the second begins."""
    parts = reparametrised(first, 0.0, 0.5), reparametrised(second, 0.5, 1.0)
    return Curve(
        control_points=concatenated([parts[0].control_points, parts[1].control_points[1:]], axis=0),
        knots=np.concatenate([parts[0].knots[:-1], parts[1].knots[first.degree + 1 :]]),
        degree=first.degree,
    )


def end_row(face: Surface, row: int) -> Curve:
    """The end of a face at v = 0 (row 0) or v = 1 (row -1)."""
    return Curve(control_points=face.control_points[:, row], knots=face.knots_u, degree=face.degree_u)


def _shares(curve: Curve) -> Reals:
    return greville(curve.knots, curve.degree)
