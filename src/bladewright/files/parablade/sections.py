"""ParaBlade's sections, as it defines them and normalised as those of the unified family are.

Written from the published method (Agromayor et al. 2021) and from measurements of what ParaBlade evaluates.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.files.parablade.config import LOWER, UPPER, Config
from bladewright.numerics.elementary import turned_left
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.camber import bernstein, camber_line, camber_points, camber_tangents
from bladewright.section.laws import law_basis

THICKNESS_POINTS = 10
"""Points of the camber line at which ParaBlade takes the thickness, the edges included (Agromayor et al. 2021)."""
DEGREE = 3
"""Degree of ParaBlade's sides (Agromayor et al. 2021)."""
EXTENT_POINTS = 500
"""Points around a section among which ParaBlade takes the smallest and largest abscissa; kept, since the channel is
filled between these (its program, Agromayor et al. 2021)."""
_TINY = 1e-12
"""What ParaBlade adds to the extent against division by zero (its program, Agromayor et al. 2021)."""
_STEP = 1e-3
"""Step of the central difference by which ParaBlade integrates the meridional length (its program, Agromayor et al.
2021)."""
SIDE_STATIONS = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 121))) / 2.0
"""Parameters of the sides at which they are fitted: cosine spacing, dense at the edges."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ParaBladeSections:
    """ParaBlade's sections at span fractions v (m,), in units of the meridional length."""

    config: Config
    v: Reals

    def law(self, key: str, v: Reals | None = None) -> Reals:
        """Values (m,) of a law along the span."""
        points = np.array(self.config.laws[key])
        return law_basis(len(points), self.v if v is None else v) @ points

    @cached_property
    def camber(self) -> Reals:
        """Control points (m, 4, 2) of the camber lines, from (0, 0) to abscissa 1."""
        stagger, angle_in, angle_out = (np.radians(self.law(key)) for key in ("stagger", "theta_in", "theta_out"))
        zero, one = np.zeros(len(self.v)), np.ones(len(self.v))
        return camber_line(zero, one, stagger, angle_in, angle_out, self.law("dist_in"), self.law("dist_out"))

    @cached_property
    def sides(self) -> tuple[Reals, Reals]:
        """Control points (m, 12, 2) of the upper and the lower side, cubic over uniform knots."""
        u = np.linspace(0.0, 1.0, THICKNESS_POINTS)
        line, normals = camber_points(self.camber, u), turned_left(camber_tangents(self.camber, u))
        sides = []
        for keys, sign in ((UPPER, 1.0), (LOWER, -1.0)):
            laws = np.stack([self.law(key) for key in ("radius_in", *keys, "radius_out")], axis=-1)
            thickness = laws @ law_basis(len(keys) + 2, u).T
            points = line + sign * thickness[..., None] * normals
            points[:, [0, -1]] = line[:, [0, -1]]
            inserted = []
            for end, inner, key in ((0, 1, "radius_in"), (-1, -2, "radius_out")):
                step = points[:, inner] - points[:, end]
                along = step[:, 0] * normals[:, end, 1] - step[:, 1] * normals[:, end, 0]
                height = np.sqrt(self.law(key) / 3.0 * np.sqrt(along**2))
                inserted.append(points[:, end] + sign * height[:, None] * normals[:, end])
            rows = [points[:, :1], inserted[0][:, None], points[:, 1:-1], inserted[1][:, None], points[:, -1:]]
            sides.append(np.concatenate(rows, axis=1))
        return sides[0], sides[1]

    @cached_property
    def extents(self) -> tuple[Reals, Reals]:
        """Least and largest abscissa (m,) of the sections, as ParaBlade samples them."""
        around = np.linspace(0.0, 1.0, EXTENT_POINTS)
        upper = side_basis(2.0 * (1.0 - around[around >= 0.5])) @ self.sides[0][..., 0].T
        lower = side_basis(2.0 * around[around < 0.5]) @ self.sides[1][..., 0].T
        every = np.concatenate([upper, lower])
        return every.min(axis=0), every.max(axis=0)

    def channel_places(self, abscissae: Reals) -> Reals:
        """Channel parameters u (m, k) of abscissae (m, k): ParaBlade's sections fill the channel from nose to nose."""
        low, high = (each[:, None] for each in self.extents)
        return (abscissae - low + _TINY) / (high - low + 2.0 * _TINY)

    @cached_property
    def lengths(self) -> Reals:
        """Meridional lengths (m,) [m], as ParaBlade integrates them."""
        nodes, weights = np.polynomial.legendre.leggauss(10)
        low, high = 1e-6, 1.0 - 1e-6
        u = np.broadcast_to(low + (high - low) * (nodes + 1.0) / 2.0, (len(self.v), 10))
        slope = (self.meridional(u + _STEP) - self.meridional(u - _STEP)) / (2.0 * _STEP)
        return np.sqrt(np.sum(slope**2, axis=-1)) @ weights * (high - low) / 2.0

    def meridional(self, u: Reals) -> Reals:
        """Meridional points (x, z) (m, k, 2) [m] at u (m, k), by transfinite interpolation of four curves."""
        u = np.clip(u, 0.0, 1.0)
        flat = u.ravel()
        parts = []
        for axis in "xz":
            ends = {edge: np.array(self.config.laws[f"{axis}_{edge}"]) for edge in ("leading", "trailing")}
            walls = []
            for wall, end in (("hub", 0), ("shroud", -1)):
                inner = self.config.laws[f"{axis}_{wall}"]
                points = np.array([ends["leading"][end], *inner, ends["trailing"][end]])
                walls.append((law_basis(len(points), flat) @ points).reshape(u.shape))
            start, stop = (self.law(f"{axis}_{edge}")[:, None] for edge in ("leading", "trailing"))
            v = self.v[:, None]
            corners = [(1.0 - u) * ends["leading"][end] + u * ends["trailing"][end] for end in (0, -1)]
            point = (1.0 - u) * start + u * stop + (1.0 - v) * (walls[0] - corners[0]) + v * (walls[1] - corners[1])
            parts.append(point)
        return np.stack(parts, axis=-1)

    def placed(self, plane: Reals) -> Reals:
        """Axial x, tangential y and radius or span z (m, k, 3) [m] of points (m, k, 2) of the sections."""
        meridional = self.meridional(self.channel_places(plane[..., 0]))
        y = self.law("y_leading")[:, None] + plane[..., 1] * self.lengths[:, None]
        return np.stack([meridional[..., 0], y, meridional[..., 1]], axis=-1)

    def points(self, plane: Reals) -> Reals:
        """Points of the sections in space (m, k, 3) [m]; in two dimensions those of the mean section (k, 2) [m]."""
        placed = self.placed(plane)
        if self.config.dimensions == 2:
            return np.mean(placed[..., :2], axis=0)
        if not self.config.annular:
            return placed
        x, y, z = np.moveaxis(placed, -1, 0)
        return np.stack([x, z * np.sin(y / z), z * np.cos(y / z)], axis=-1)


def side_basis(s: Reals) -> Reals:
    """Basis functions (len(s), 12) of the sides at parameters s."""
    return basis(uniform_knots(THICKNESS_POINTS + 2, DEGREE), DEGREE, s)


def sections_at(config: Config, v: Reals) -> ParaBladeSections:
    """The sections at span fractions v; of a design in two dimensions, those at both ends, whose mean it is."""
    return ParaBladeSections(config=config, v=np.array([0.0, 1.0]) if config.dimensions == 2 else v)


@dataclass(frozen=True, kw_only=True)
class NormalisedSections:
    """Sections at v (m,) as the unified family has them: their camber lines run from (0, 0) to abscissa 1."""

    v: Reals
    camber: Reals
    """(m, 4, 2) control points of the camber lines"""
    upper: Reals
    """(m, k, 2) points of the upper side"""
    lower: Reals
    """(m, k, 2) points of the lower side"""
    radii: tuple[Reals, Reals]
    """(m,) radii of curvature at leading and trailing edge"""


def scaled_sections(sections: ParaBladeSections, factors: Reals) -> NormalisedSections:
    """ParaBlade's sections with their ordinates multiplied by factors (m,), one for each."""
    stretch = np.stack([np.ones_like(factors), factors], axis=-1)[:, None, :]
    sides = [side * stretch for side in sections.sides]
    return _normalised_sections(
        sections.v, sections.camber * stretch, sides, [side_basis(SIDE_STATIONS) @ side for side in sides]
    )


def mean_section(config: Config) -> tuple[NormalisedSections, Reals, float]:
    """The section of a design in two dimensions, its leading edge (2,) [m] and its axial chord [m]."""
    sections = sections_at(config, np.zeros(1))
    u = SIDE_STATIONS
    # in all but odd files the channel is straight, and then the mean of both camber lines is a Bezier curve too
    line = np.linalg.lstsq(bernstein(u), sections.points(camber_points(sections.camber, u)), rcond=None)[0]
    start, extent = line[0], float(line[3, 0] - line[0, 0])
    points = [(sections.points(side_basis(SIDE_STATIONS) @ side) - start) / extent for side in sections.sides]
    sides = [((sections.points(side) - start) / extent)[None] for side in sections.sides]
    found = _normalised_sections(np.zeros(1), (line - start)[None] / extent, sides, [each[None] for each in points])
    return found, start, extent


def _normalised_sections(v: Reals, camber: Reals, sides: list[Reals], points: list[Reals]) -> NormalisedSections:
    radii = []
    for end in (0.0, 1.0):
        rows = [basis(uniform_knots(sides[0].shape[1], 3), 3, np.array([end]), order)[0] for order in (1, 2)]
        bends = []
        for side in sides:
            first, second = (np.einsum("i,mid->md", row, side) for row in rows)
            turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
            bends.append(np.sqrt(turn**2) / np.sum(first**2, axis=-1) ** 1.5)
        radii.append(2.0 / (bends[0] + bends[1]))
    return NormalisedSections(v=v, camber=camber, upper=points[0], lower=points[1], radii=(radii[0], radii[1]))
