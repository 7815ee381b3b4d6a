"""The ends of a blade: trimmed pieces of hub and shroud, or ruled caps where a blade stands past them."""

from collections.abc import Callable

import numpy as np

from bladewright.blade.exact import ExactBlade
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, dot, joined, length
from bladewright.numerics.roots import crossings
from bladewright.nurbs.basis import Reals, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.joints import jointed
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

FOLLOWED = 1e-9
"""distance of a boundary's image from the side's end, of the chord, besides what the side itself lies off the wall"""


def trimmed_ends(exact: ExactBlade, upper: Surface, lower: Surface, chord: float) -> dict[str, TrimmedSurface]:
    """The pieces of the hub and shroud walls, or of a clearance surface, inside the ends of the sides.

    The walls are the channel's, revolved about the axis or drawn along y in a cascade, exact; their u is the channel's.
    Raises DesignError where the blade winds a full turn around the axis.
    """
    places = np.unique(upper.knots_u)
    stations = exact.survey
    plane = joined(stations.plane.points(places), axis=-2)[..., [0, -1], :, :]
    lines = stations.lines.rows([0, -1])
    u = lines.u_at(plane[..., 0])
    across = lines.mapping.tangential(plane[..., 1], lines.position(u)[..., 1], lines.lengths[..., None])
    first = (0,) * (u.ndim - 2)
    u, across = np.real(u)[first], np.real(across)[first]
    ends = {}
    for wall, row in (("hub", 0), ("shroud", -1)):
        meridian = extended(exact.channel.curve(wall), -exact.before, 1.0 + exact.after)
        inner = exact.full_channel.line(wall).joints()
        traces = [
            _Trace(side, row, meridian, inner, exact.mapping.revolved, places, u[row, part], across[row, part])
            for side, part in ((upper, slice(None, len(places))), (lower, slice(len(places), None)))
        ]
        ends[exact.design.ends[row]] = _trimmed(traces, meridian, wall, chord)
    return ends


def _trimmed(traces: "list[_Trace]", meridian: Curve, wall: str, chord: float) -> TrimmedSurface:
    low, high = min(float(trace.across.min()) for trace in traces), max(float(trace.across.max()) for trace in traces)
    room = 0.05 * (high - low)
    revolution = None
    if traces[0].revolved:
        if high - low + 2.0 * room >= 2.0 * np.pi:
            raise DesignError(
                f"stagger: the blade winds {np.degrees(high - low):.0f} deg around the axis at the {wall}: its end "
                "must be one trimmed face of less than 327 deg; lower the stagger there"
            )
        revolution = Revolution(meridian=meridian, start=low - room, end=high + room)
        surface = revolution.surface()
    else:
        surface = _drawn(meridian, low - room, high + room)

    between = np.linspace(low - room, high + room, revolution.arcs + 1)[1:-1] if revolution is not None else np.empty(0)

    def in_parameters(u: Array, across: Array) -> Array:
        v = (across - low + room) / (high - low + 2.0 * room) if revolution is None else revolution.v(across)
        return np.stack([u, v], axis=-1)

    def stretch(uv: Reals) -> Reals:
        line = _real(meridian)
        around = np.full(len(uv), high - low + 2.0 * room)
        if revolution is not None:
            around = line(uv[:, 0])[:, 1] * revolution.slope(uv[:, 1])
        return np.stack([length(line.derivative(uv[:, 0])), around], axis=-1)

    def followed(trace: _Trace) -> Curve:
        return _followed(lambda s: in_parameters(*trace(s)), trace.end, trace.joints(between), stretch, chord)

    curves = [followed(trace) for trace in traces]
    return TrimmedSurface(surface=surface, boundary=(curves[1], _reversed(curves[0])), revolution=revolution)


def ruled_end(upper: Surface, lower: Surface, row: int) -> Surface:
    """The ruled surface between the ends of the sides: v = 0 on the lower, v = 1 on the upper side's end."""
    ends = [np.array(side.control_points[:, row]) for side in (lower, upper)]
    return Surface(
        control_points=np.stack(ends, axis=1),
        knots_u=upper.knots_u,
        knots_v=np.array([0.0, 0.0, 1.0, 1.0]),
        degree_u=upper.degree_u,
        degree_v=1,
    )


class _Trace:
    """The end of a side on its wall: the channel's u and theta, or y in a cascade, by the side's parameter."""

    def __init__(
        self,
        side: Surface,
        row: int,
        meridian: Curve,
        inner: Reals,
        revolved: bool,
        places: Reals,
        u: Reals,
        across: Reals,
    ) -> None:
        self.end = Curve(control_points=side.control_points[:, row], knots=side.knots_u, degree=side.degree_u)
        self.meridian, self.inner, self.revolved = meridian, np.unique(inner), revolved
        self.across, self._places, self._u = across, places, u

    def __call__(self, s: Reals) -> tuple[Array, Array]:
        """u and theta or y (len(s),) of the feet of the end's points on the wall's meridian."""
        points = self.end(s)
        if self.revolved:
            radius = length(points[..., 1:])
            across = angle(points[..., 1], points[..., 2])
            near = np.interp(s, self._places, self.across)
            across = across + 2.0 * np.pi * np.round((near - np.real(across)) / (2.0 * np.pi))
        else:
            radius, across = points[..., 2], points[..., 1]
        target = np.stack([points[..., 0], radius], axis=-1)
        u = np.interp(s, self._places, self._u)
        u = u + _foot_step(self.meridian, u, np.real(target))
        return u + _foot_step(self.meridian, u, target), across

    def joints(self, angles: Reals) -> list[tuple[float, int]]:
        """Where the end passes `inner` knots of the meridian, or `angles` (k,) between the wall's rational arcs.

        Each with the derivatives that the wall's own parameters keep there: one between arcs, which are symmetric.
        """

        def passed(which: int, values: Reals, levels: Reals) -> list[float]:
            return list(map(float, crossings(lambda s: np.real(self(s)[which]), self._places, values, levels)))

        return [
            *((place, self.meridian.degree - 1) for place in passed(0, self._u, self.inner)),
            *((place, 1) for place in passed(1, self.across, angles)),
        ]


def _foot_step(meridian: Curve, u: Reals, target: Array) -> Array:
    """Newton's step towards the nearest point of the meridian."""
    miss, slope, bend = target - meridian(u), meridian.derivative(u), meridian.derivative(u, 2)
    return dot(miss, slope) / (dot(slope, slope) - dot(miss, bend))


def _followed(
    place: Callable[[Reals], Array],
    end: Curve,
    joints: list[tuple[float, int]],
    stretch: Callable[[Reals], Reals],
    chord: float,
) -> Curve:
    """A plane B-spline that the wall maps on the side's end, as smooth as the side, its knots cut until it follows.

    `joints` are the places where it is less smooth, each with the derivatives that are continuous there.
    """
    own = jointed(end.knots, end.degree, joints)
    spans = np.unique(own)
    for pieces in (2, 3, 4, 6, 8):
        added = [spans[:-1] + np.diff(spans) * k / pieces for k in range(1, pieces)]
        knots = np.sort(np.concatenate([own, *added]))
        sites = greville(knots, end.degree)
        curve = interpolated(place(sites), sites, degree=end.degree, knots=knots)
        between = (sites[1:] + sites[:-1]) / 2.0
        exact, found = np.real(place(between)), np.real(curve(between))
        miss = length((found - exact) * stretch(exact))
        if np.max(miss) < FOLLOWED * chord:
            return curve
    raise DesignError(
        f"channel: an end of the blade cannot be followed on its wall within {FOLLOWED:g} of the chord, "
        f"{np.max(miss) / chord:.2g} is reached: smooth the wall by a higher channel.degree or fewer inner control "
        "points, or lower the tolerance"
    )


def _real(curve: Curve) -> Curve:
    if not np.iscomplexobj(curve.control_points):
        return curve
    return Curve(control_points=np.real(curve.control_points), knots=curve.knots, degree=curve.degree)


def _reversed(curve: Curve) -> Curve:
    low, high = curve.knots[0], curve.knots[-1]
    return Curve(control_points=curve.control_points[::-1], knots=(low + high - curve.knots)[::-1], degree=curve.degree)


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
