"""The exact blade: for every v the plane section of the laws' values there, laid on its stream surface."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bladewright.blade.clearance import Clearance, clearance_of, cleared
from bladewright.blade.course import OwnCourse
from bladewright.blade.knots import breaks_along_u, breaks_along_v
from bladewright.blade.mapping import Mapping, mapping_of
from bladewright.blade.meant import EndWall, Meant
from bladewright.blade.meridian_line import real_first
from bladewright.blade.meridional import Meridional, meridional
from bladewright.blade.plan import Plan, channel_plan
from bladewright.blade.stations import Stations, stations_at
from bladewright.blade.streamlines import stream_lines
from bladewright.blade.unified import UnifiedBlade
from bladewright.errors import DesignError
from bladewright.numerics.elementary import joined
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.domain import extended
from bladewright.section.checks import UNITS
from bladewright.section.sampling import sample_places

SURVEY = np.array([0.0, 0.12, 0.25, 0.38, 0.5, 0.62, 0.75, 0.88, 1.0])
"""places along the span of the survey"""
REACH = 0.6
"""how far, in u, the channel may be continued for a nose"""


@dataclass(frozen=True, kw_only=True)
class ExactBlade(Meant):
    """The blade that is meant, in metres and radians: what the native surfaces interpolate and are measured against."""

    design: UnifiedBlade
    channel: Meridional
    """the blade's own, between its ends"""
    full_channel: Meridional
    """from wall to wall: the same where there is no clearance"""
    clearance: Clearance | None
    mapping: Mapping
    places: Reals
    """camber parameters of a side's control points"""
    before: float
    """how far, in u, stream lines are continued past the leading edge"""
    after: float
    """how far, in u, stream lines are continued past the trailing edge"""
    surveyed: Stations | None = None
    """the survey, where it is at hand"""
    tentative: bool = False
    """whether edge radii that the thickness cannot hold are let through, as on the way of a search"""

    def moved_to(self, design: UnifiedBlade) -> "ExactBlade":
        return moved(self, design)

    def breaks_along_u(self) -> Reals:
        return breaks_along_u(self)

    def breaks_along_v(self) -> Reals:
        return breaks_along_v(self)

    def end_wall(self, row: int) -> EndWall:
        wall = ("hub", "shroud")[row]
        inner = self.channel.line(wall).joints()
        if self.design.ends[row] == "tip":
            # at a single knot the fitted meridian is smooth up to what it misses
            inner = inner[np.sum(inner[:, None] == inner, axis=0) > 1]
        return EndWall(extended(self.channel.curve(wall), -self.before, 1.0 + self.after), inner)

    def wall_places(self, u: Reals) -> Reals:
        return u

    @cached_property
    def plan(self) -> Plan:
        """Walls, edges and stream lines in the meridional plane."""
        return channel_plan(self)

    def wall_line(self, name: str, u: Reals) -> Reals:
        return np.real(self.full_channel.curve(name)(u))

    @property
    def meridians(self) -> Meridional:
        return self.channel

    @property
    def course(self) -> OwnCourse:
        ends = -self.before, 1.0 + self.after
        length = float(np.mean(real_first(self.survey.lines.lengths, 1)))
        return OwnCourse(
            channel=self.channel, start=ends[0], end=ends[1], noses=ends, edges=(0.0, 1.0), length=length, unit=1.0
        )

    def whole(self) -> "ExactBlade":
        gaps = [name for name in ("tip_clearance", "hub_clearance") if getattr(self.design, name) is not None]
        return exact_blade(self.design.changed(dict.fromkeys(gaps))) if gaps else self

    @property
    def tip_knots(self) -> Reals | None:
        """Knots of the meridian of the clearance surface, where there is one."""
        return None if self.clearance is None else self.channel.knots(self.clearance.wall)

    @cached_property
    def survey(self) -> Stations:
        """Stations from end to end on which the shape is judged."""
        return self.stations(SURVEY) if self.surveyed is None else self.surveyed

    def stations(self, v: Reals) -> Stations:
        """Sections at v (m,); refuses an edge radius that the thickness cannot hold, unless it is tentative."""
        lines = stream_lines(self.channel, self.mapping, v, self.before, self.after)
        return stations_at(self.design, self.places, lines, v, tentative=self.tentative)


def exact_blade(design: UnifiedBlade, tip_knots: Reals | None = None, *, tentative: bool = False) -> ExactBlade:
    """The exact blade of a design, its channel continued as far as the noses need.

    `tip_knots` hold the knots of the meridian of a clearance surface; `tentative` lets through edge radii that the
    thickness cannot hold. Raises DesignError where there is no such blade.
    """
    mapping = mapping_of(design.mapping, design.arrangement)
    full, channel, clearance = _channels_of(design, tip_knots)
    places = sample_places(design.samples, design.clustering)
    lines = stream_lines(channel, mapping, SURVEY, 0.0, 0.0)
    within = stations_at(design, places, lines, SURVEY, tentative=tentative)
    before, after = _reaches(within)
    # the sections do not depend on how far the stream lines are continued
    survey = replace(within, lines=stream_lines(channel, mapping, SURVEY, before, after))
    return ExactBlade(
        design=design,
        channel=channel,
        full_channel=full,
        clearance=clearance,
        mapping=mapping,
        places=places,
        before=before,
        after=after,
        surveyed=survey,
        tentative=tentative,
    )


def moved(exact: ExactBlade, design: UnifiedBlade) -> ExactBlade:
    """The exact blade of a design that is a small step away, its channel continued as far as that of `exact`."""
    full, channel, clearance = _channels_of(design, exact.tip_knots)
    return replace(exact, design=design, channel=channel, full_channel=full, clearance=clearance, surveyed=None)


def _channels_of(design: UnifiedBlade, tip_knots: Reals | None) -> tuple[Meridional, Meridional, Clearance | None]:
    full = meridional(design.channel, UNITS[design.length_unit])
    clearance = clearance_of(design)
    return full, full if clearance is None else cleared(full, clearance, tip_knots), clearance


def _reaches(stations: Stations) -> list[float]:
    """How far in u the noses stand outside the channel, bounded by the sides' control points, with a margin."""
    hull = joined([stations.plane.upper, stations.plane.lower], axis=-2)
    abscissae = np.real(hull[..., 0] / hull[..., 2] if hull.shape[-1] == 3 else hull[..., 0])
    lines, at = stations.lines, np.array([0.0, 1.0])
    densities = np.real(lines.mapping.density(lines.position(at), lines.position(at, 1)))
    before = -np.min(abscissae, axis=-1) / densities[..., 0]
    after = (np.max(abscissae, axis=-1) - np.real(lines.extents())) / densities[..., 1]
    reaches = [1.3 * float(np.max(past, initial=0.0)) + 0.01 for past in (before, after)]
    for value, edge in zip(reaches, ("leading", "trailing"), strict=True):
        if value > REACH:
            raise DesignError(
                f"thickness_upper or thickness_lower: the nose at the {edge} edge stands {value:.2f} of the meridional "
                f"length outside the channel, more than {REACH}: lower the thickness next to the edge, its radius or "
                "the metal angle there"
            )
    return reaches
