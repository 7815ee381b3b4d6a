"""The ends of a blade that stands on its walls: trimmed pieces of hub and shroud, or of a clearance surface."""

from collections.abc import Mapping

import numpy as np

from bladewright.blade.meant import Meant
from bladewright.blade.outline import Trace, Wall, followed
from bladewright.errors import DesignError
from bladewright.numerics.elementary import joined
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as reversed_
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface


def trimmed_ends(
    exact: Meant,
    upper: Surface,
    lower: Surface,
    chord: float,
    like: Mapping[str, TrimmedSurface] | None = None,
    faces: Mapping[str, Surface] | None = None,
) -> dict[str, TrimmedSurface]:
    """The pieces of the hub and shroud walls, or of a clearance surface, inside the ends of the sides.

    The walls are the channel's or the flow path's, revolved about the axis or drawn along y in a cascade, exact; their
    u is the wall's own. `like` are the ends of a blade a small step away: their stretches of the walls and their knots
    are taken. `faces` are those of blunt edges, of a blade that has no `like`. Raises DesignError where the blade winds
    a full turn around the axis.
    """
    places = np.unique(upper.knots_u)
    stations = exact.survey
    plane = joined(stations.plane.points(places), axis=-2)[..., [0, -1], :, :]
    lines = stations.lines.rows([0, -1])
    u = lines.u_at(plane[..., 0])
    across = lines.mapping.tangential(plane[..., 1], lines.position(u)[..., 1], lines.lengths[..., None])
    first = (0,) * (u.ndim - 2)
    u, across = np.real(u)[first], np.real(across)[first]
    own = exact.wall_places(u)
    ends = {}
    for wall, row in (("hub", 0), ("shroud", -1)):
        name, (meridian, inner) = exact.design.ends[row], exact.end_wall(row)
        traces = [
            Trace(_end(side, row), meridian, exact.mapping.revolved, places, own[row, part], across[row, part])
            for side, part in ((upper, slice(None, len(places))), (lower, slice(len(places), None)))
        ]
        blunt = {}
        for edge, face in ({} if faces is None else faces).items():
            at = 0 if edge == "leading_edge" else len(places) - 1
            both, two = [at, len(places) + at], np.array([0.0, 1.0])
            blunt[edge] = Trace(
                _end(face, row), meridian, exact.mapping.revolved, two, own[row, both], across[row, both]
            )
        ends[name] = _trimmed(traces, blunt, inner, wall, chord, None if like is None else like[name])
    return ends


def _trimmed(
    traces: list[Trace],
    blunt: Mapping[str, Trace],
    inner: Reals,
    name: str,
    chord: float,
    like: TrimmedSurface | None,
) -> TrimmedSurface:
    first = traces[0]
    low, high = _stretch(traces, name) if like is None else _stretch_of(like)
    wall = Wall(meridian=first.meridian, inner=inner, revolved=first.revolved, low=low, high=high)
    held = [None, None] if like is None else [reversed_(like.boundary[1]).knots, like.boundary[0].knots]
    upper, lower = (followed(wall, trace, chord, knots) for trace, knots in zip(traces, held, strict=True))
    faces = {edge: followed(wall, trace, chord) for edge, trace in blunt.items()}
    chain = [lower]
    chain += [reversed_(faces["trailing_edge"])] if "trailing_edge" in faces else []
    chain += [reversed_(upper)]
    chain += [faces["leading_edge"]] if "leading_edge" in faces else []
    return TrimmedSurface(surface=wall.surface, boundary=tuple(chain), revolution=wall.revolution)


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
