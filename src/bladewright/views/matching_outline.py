"""The outline of a fitted section in its plane, and points of the cloud beside it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import dot, length, unit
from bladewright.nurbs.basis import Reals
from bladewright.views.matching_points import SIDES, Index, Matched, on_sides
from bladewright.views.sections import along_curve, size_of

if TYPE_CHECKING:
    from bladewright.section.section import Section

FINE = 801
FACES = ("leading_edge", "trailing_edge")
"""faces of blunt edges"""
BAND, WIDEST = 0.04, 0.16
"""half height in v of the band whose points are drawn beside a section, and what it may grow to"""
ENOUGH = 80
"""points in a band"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """Both sides of a section at the parameters u of its blade [mm], with the points of the cloud that belong to it."""

    section: "Section"
    u: Reals
    """(k,)"""
    sides: dict[str, Reals]
    """(k, 2) of `upper` and `lower`"""
    outwards: dict[str, Reals]
    """(k, 2) unit normals"""
    points: NDArray[np.bool_]
    """(n,) whether a point of the cloud is drawn beside it"""
    band: float
    """half height in v of the part of the blade that the points are from; 0 for a section"""

    @property
    def closed(self) -> Reals:
        """The outline (2 k, 2), upper side from leading to trailing edge, lower side back."""
        return np.concatenate([self.sides["upper"], self.sides["lower"][::-1]])

    def moved(self, side: str, off: Reals | float) -> Reals:
        """A side (k, 2), moved outwards [mm]."""
        return self.sides[side] + self.outwards[side] * np.reshape(off, (-1, 1))

    def feet(self, fit: Matched, index: Index) -> tuple[Reals, Reals]:
        """Places (m, 2) on the outline of the points' nearest ones, and the normals (m, 2) there."""
        feet, normals = np.zeros((2, len(index), 2))
        for name in SIDES:
            own = fit.places[index] == name
            for table, found in ((self.sides, feet), (self.outwards, normals)):
                for axis in (0, 1):
                    found[own, axis] = np.interp(fit.u[index[own]], self.u, table[name][:, axis])
        for end, name in enumerate(FACES):
            own = fit.places[index] == name
            upper, lower = (self.sides[side][-end] for side in SIDES)
            feet[own] = upper + _across(fit, index[own], float(end))[:, None] * (lower - upper)
            normals[own] = -self.inwards(trailing=bool(end))
        return feet, normals

    def inwards(self, *, trailing: bool) -> Reals:
        """Direction (2,) into the section from its leading or its trailing edge."""
        end = -1 if trailing else 0
        if self.section.edges[end] == "round":
            return -self.outwards["upper"][end]
        slope = np.real(unit(self.section.camber.derivative(np.array([float(trailing)]))))[0]
        return np.asarray(-slope if trailing else slope)


def outline_at(fit: Matched, v: float) -> Outline:
    """The outline at v in [0, 1] of a blade, or the outline of a section."""
    u = along_curve(FINE)
    solid = fit.cloud.shape[-1] == 3
    if solid:
        section = fit.built.section(v)
        plane = fit.built.exact.stations(np.array([v])).plane.points(u)
        sides = {name: np.real(points[0]) for name, points in zip(SIDES, plane, strict=True)}
    else:
        section = fit.built
        sides = {name: np.real(section.curves[name](u)) for name in SIDES}
    size = size_of(section)
    outwards = {}
    for name, sign in (("upper", 1.0), ("lower", -1.0)):
        tangent = np.gradient(sides[name], u, axis=0, edge_order=2)
        tangent /= length(tangent)[:, None]
        outwards[name] = sign * np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1)
    near, band = _near(fit, v) if solid else (_around(fit), 0.0)
    return Outline(
        section=section,
        u=u,
        sides={name: points * size for name, points in sides.items()},
        outwards=outwards,
        points=near,
        band=band,
    )


def worst_span(fit: Matched, region: str) -> float:
    """v where an inlier of a region is farthest off; the middle of the cloud where the region has none."""
    index = np.flatnonzero(fit.inliers & on_sides(fit) & (fit.regions == region))
    if len(index):
        return float(np.clip(fit.v[index[np.argmax(np.abs(fit.deviations[index]))]], 0.0, 1.0))
    return span_of(fit, 0.5)


def span_of(fit: Matched, share: float) -> float:
    """v at a share of the span that the cloud covers."""
    covered = fit.v[fit.inliers & on_sides(fit)]
    low, high = (float(covered.min()), float(covered.max())) if len(covered) else (0.0, 1.0)
    return float(np.clip(low + share * (high - low), 0.0, 1.0))


def _across(fit: Matched, index: Index, end: float) -> Reals:
    """Shares (m,) of the way from the upper to the lower side at which points stand on the face of a blunt edge."""
    if fit.cloud.shape[-1] == 3:
        upper, lower = (np.real(fit.built.surfaces[name](end, fit.v[index])) for name in SIDES)
    else:
        upper, lower = (np.real(fit.built.curves[name](np.full(len(index), end))) for name in SIDES)
    way = lower - upper
    return np.clip(dot(fit.cloud[index] - upper, way) / dot(way, way), 0.0, 1.0)


def _around(fit: Matched) -> NDArray[np.bool_]:
    """Whether each point (n,) lies nearest to a side or to the face of a blunt edge."""
    return on_sides(fit) | np.isin(fit.places, FACES)


def _near(fit: Matched, v: float) -> tuple[NDArray[np.bool_], float]:
    sides, band = _around(fit), BAND
    while True:
        near = sides & (np.abs(fit.v - v) <= band)
        if np.count_nonzero(near) >= ENOUGH or band >= WIDEST:
            return near, band
        band *= 2.0
