"""The ends of a blade: trimmed pieces of hub and shroud, or ruled caps where a blade stands past them."""

from collections.abc import Mapping

import numpy as np

from bladewright.blade.exact import ExactBlade
from bladewright.blade.outline import Trace, Wall, followed
from bladewright.errors import DesignError
from bladewright.numerics.elementary import joined
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended
from bladewright.nurbs.domain import reversed as reversed_
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface


def trimmed_ends(
    exact: ExactBlade,
    upper: Surface,
    lower: Surface,
    chord: float,
    like: Mapping[str, TrimmedSurface] | None = None,
) -> dict[str, TrimmedSurface]:
    """The pieces of the hub and shroud walls, or of a clearance surface, inside the ends of the sides.

    The walls are the channel's, revolved about the axis or drawn along y in a cascade, exact; their u is the channel's.
    `like` are the ends of a blade a small step away: their stretches of the walls and their knots are taken. Raises
    DesignError where the blade winds a full turn around the axis.
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
        name, inner = exact.design.ends[row], exact.channel.line(wall).joints()
        if name == "tip":
            # at a single knot the fitted meridian is smooth up to what it misses
            inner = inner[np.sum(inner[:, None] == inner, axis=0) > 1]
        traces = [
            Trace(_end(side, row), meridian, exact.mapping.revolved, places, u[row, part], across[row, part])
            for side, part in ((upper, slice(None, len(places))), (lower, slice(len(places), None)))
        ]
        ends[name] = _trimmed(traces, inner, wall, chord, None if like is None else like[name])
    return ends


def _trimmed(traces: list[Trace], inner: Reals, name: str, chord: float, like: TrimmedSurface | None) -> TrimmedSurface:
    first = traces[0]
    low, high = _stretch(traces, name) if like is None else _stretch_of(like)
    wall = Wall(meridian=first.meridian, inner=inner, revolved=first.revolved, low=low, high=high)
    held = [None, None] if like is None else [reversed_(like.boundary[1]).knots, like.boundary[0].knots]
    curves = [followed(wall, trace, chord, knots) for trace, knots in zip(traces, held, strict=True)]
    return TrimmedSurface(surface=wall.surface, boundary=(curves[1], reversed_(curves[0])), revolution=wall.revolution)


def _stretch(traces: list[Trace], name: str) -> tuple[float, float]:
    """Where the wall starts and ends in theta, or y in a cascade: with some room about the blade's end."""
    low, high = min(float(trace.across.min()) for trace in traces), max(float(trace.across.max()) for trace in traces)
    room = 0.05 * (high - low)
    if traces[0].revolved and high - low + 2.0 * room >= 2.0 * np.pi:
        raise DesignError(
            f"stagger: the blade winds {np.degrees(high - low):.0f} deg around the axis at the {name}: its end "
            "must be one trimmed face of less than 327 deg; lower the stagger there"
        )
    return low - room, high + room


def _stretch_of(end: TrimmedSurface) -> tuple[float, float]:
    """The same of an end that is there."""
    if end.revolution is not None:
        return end.revolution.start, end.revolution.end
    y = np.real(end.surface.control_points[0, :, 1])
    return float(y[0]), float(y[-1])


def _end(side: Surface, row: int) -> Curve:
    return Curve(control_points=side.control_points[:, row], knots=side.knots_u, degree=side.degree_u)


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
