"""What a picture of a fit needs of it: the points that are drawn, and the outline of a section beside them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, Normalize
from numpy.typing import NDArray

from bladewright.numerics.elementary import dot, length, unit
from bladewright.nurbs.basis import Reals
from bladewright.views.sections import cosine_spacing, drawn_per_unit
from bladewright.views.style import INK, per_metre

if TYPE_CHECKING:
    from bladewright.section.section import Section


Index = NDArray[np.intp]
"""Indices (m,) of points of the cloud."""
SIDES = ("upper", "lower")
"""Names of the sides of a section or a blade."""
WORST_POINTS = 500
"""Points farthest from the blade that are always drawn, however many others are left out."""
DEVIATION_COLOURS = LinearSegmentedColormap.from_list(
    "deviation", ["#0b3c66", "#2f7fb5", "#8fbfd9", "#f4f1ea", "#e9a582", "#c4553f", "#7a1526"]
)
"""Colours of deviations: blue inside the blade, red outside."""
ROUND_NUMBERS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
"""Round numbers of one decade, at which a scale of colours may end."""
OUTLINE_POINTS = 801
"""Points of each side of an outline, between which points of the cloud are placed by linear interpolation."""
BLUNT_FACES = ("leading_edge", "trailing_edge")
"""Names of the faces of blunt edges."""
BAND, WIDEST_BAND = 0.04, 0.16
"""Half height in v of the band whose points are drawn beside a section, and the largest to which it is doubled while it
holds too few points. A high band shows deviations of sections further away."""
BAND_POINTS = 80
"""Points in a band that are enough: a section of fewer has gaps that its deviations cannot be read across."""


class DistanceStatistics(Protocol):
    """Statistics of distances [m]."""

    @property
    def count(self) -> int: ...
    @property
    def mean(self) -> float: ...
    @property
    def rms(self) -> float: ...
    @property
    def percentile_99(self) -> float: ...
    @property
    def maximum(self) -> float: ...


class FitResult(Protocol):
    """A fit of a design to a cloud of n points, as `bladewright.fit` returns it."""

    @property
    def design(self) -> Any: ...
    @property
    def built(self) -> Any: ...
    @property
    def cloud(self) -> Reals: ...
    @property
    def places(self) -> NDArray[np.str_]: ...
    @property
    def u(self) -> Reals: ...
    @property
    def v(self) -> Reals: ...
    @property
    def deviations(self) -> Reals: ...
    @property
    def regions(self) -> NDArray[np.str_]: ...
    @property
    def inliers(self) -> NDArray[np.bool_]: ...
    @property
    def outliers(self) -> NDArray[np.intp]: ...
    @property
    def estimates(self) -> Any: ...
    @property
    def rank(self) -> int: ...
    @property
    def noise(self) -> float: ...
    @property
    def extrema(self) -> Mapping[str, int]: ...
    @property
    def tolerance(self) -> float | None: ...
    @property
    def failures(self) -> tuple[str, ...]: ...
    @property
    def interrupted(self) -> bool: ...
    @property
    def passed(self) -> bool: ...
    @property
    def deviation(self) -> DistanceStatistics: ...
    @property
    def by_region(self) -> Mapping[str, DistanceStatistics]: ...


def on_sides(fit: FitResult) -> NDArray[np.bool_]:
    """Whether the closest point of each point (n,) lies on a side, and not on an end."""
    return np.isin(fit.places, SIDES)


def points_to_draw(fit: FitResult, drawn: NDArray[np.bool_], most: int) -> Index:
    """Indices of at most about `most` of the points of a mask (n,), in order of their deviation.

    The `WORST_POINTS` are always among them; the others are a random choice, the same one every time.
    """
    index = np.flatnonzero(drawn)
    size = np.abs(fit.deviations[index])
    if len(index) > most:
        order = np.argpartition(size, -min(WORST_POINTS, most // 2))
        others, worst = np.split(order, [len(order) - min(WORST_POINTS, most // 2)])
        chosen = np.random.default_rng(0).choice(others, most - len(worst), replace=False)
        index, size = index[np.append(chosen, worst)], size[np.append(chosen, worst)]
    return index[np.argsort(size, kind="stable")]


def deviations_mm(fit: FitResult, index: Index) -> Reals:
    """Signed deviations (m,) of points [mm]."""
    return fit.deviations[index] * per_metre()


def colour_scale(fit: FitResult) -> Normalize:
    """Scale of the colours of deviations [mm]: symmetric about 0, up to a round number above 99 % of the inliers."""
    size = np.abs(fit.deviations[fit.inliers])
    most = float(np.percentile(size, 99.0)) * per_metre() if len(size) else 0.0
    limit = rounded_up(most) if most > 0.0 else 1.0
    return Normalize(-limit, limit, clip=True)


def rounded_up(value: float) -> float:
    """The next round number at or above a positive value."""
    decade = 10.0 ** np.floor(np.log10(value))
    return float(next(each for each in ROUND_NUMBERS if each * decade >= value * (1.0 - 1e-9)) * decade)


def cross_out(axes: Axes, abscissae: Reals, ordinates: Reals, few: int) -> None:
    """Draw a cross for each outlier, smaller and fainter where there are more than `few`, so that they hide nothing."""
    share = min(1.0, few / max(len(abscissae), 1))
    size = max(6.0 * share**0.5, 1.4)
    style: dict[str, Any] = {"markersize": size, "markeredgewidth": 0.2 * size, "alpha": max(share**0.4, 0.08)}
    axes.plot(abscissae, ordinates, color=INK, linestyle="none", marker="x", rasterized=True, **style)


def count_of(number: int, what: str) -> str:
    """A number with separated thousands, and what it counts, in the singular or the plural."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnSection:
    """Both sides of a section [mm] at parameters u of the blade, and which points of the cloud are drawn beside it."""

    section: "Section"
    u: Reals
    """(k,) parameters of both sides"""
    sides: dict[str, Reals]
    """(k, 2) points of `upper` and `lower`"""
    outwards: dict[str, Reals]
    """(k, 2) unit normals of `upper` and `lower`, out of the section"""
    points: NDArray[np.bool_]
    """(n,) whether each point of the cloud is drawn beside the section"""
    band: float
    """half height in v of the band of the blade that the points are from; 0 for a section"""

    @property
    def closed(self) -> Reals:
        """The closed outline (2 k, 2): the upper side from leading to trailing edge, then the lower side back."""
        return np.concatenate([self.sides["upper"], self.sides["lower"][::-1]])

    def moved(self, side: str, distance: Reals | float) -> Reals:
        """A side (k, 2) offset outwards by `distance` [mm]."""
        return self.sides[side] + self.outwards[side] * np.reshape(distance, (-1, 1))

    def footpoints(self, fit: FitResult, index: Index) -> tuple[Reals, Reals]:
        """Footpoints (m, 2) of points of the cloud on the outline, and the normals (m, 2) there."""
        footpoints, normals = np.zeros((2, len(index), 2))
        for name in SIDES:
            own = fit.places[index] == name
            for table, values in ((self.sides, footpoints), (self.outwards, normals)):
                for axis in (0, 1):
                    values[own, axis] = np.interp(fit.u[index[own]], self.u, table[name][:, axis])
        for end, name in enumerate(BLUNT_FACES):
            own = fit.places[index] == name
            upper, lower = (self.sides[side][-end] for side in SIDES)
            footpoints[own] = upper + _across(fit, index[own], float(end))[:, None] * (lower - upper)
            normals[own] = -self.inwards(trailing=bool(end))
        return footpoints, normals

    def inwards(self, *, trailing: bool) -> Reals:
        """Direction (2,) into the section from its leading or its trailing edge."""
        end = -1 if trailing else 0
        if self.section.edges[end] == "round":
            return -self.outwards["upper"][end]
        slope = np.real(unit(self.section.camber.derivative(np.array([float(trailing)]))))[0]
        return np.asarray(-slope if trailing else slope)


def outline_at(fit: FitResult, v: float) -> DrawnSection:
    """The outline at v in [0, 1] of a blade, or the outline of a section."""
    u = cosine_spacing(OUTLINE_POINTS)
    solid = fit.cloud.shape[-1] == 3
    if solid:
        section = fit.built.section(v)
        plane = fit.built.exact.sections(np.array([v])).plane_points(u)
        sides = {name: np.real(points[0]) for name, points in zip(SIDES, plane, strict=True)}
    else:
        section = fit.built
        sides = {name: np.real(section.curves[name](u)) for name in SIDES}
    size = drawn_per_unit(section)
    outwards = {}
    for name, sign in (("upper", 1.0), ("lower", -1.0)):
        tangent = np.gradient(sides[name], u, axis=0, edge_order=2)
        tangent /= length(tangent)[:, None]
        outwards[name] = sign * np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1)
    drawn, band = _near_span(fit, v) if solid else (_on_outline(fit), 0.0)
    return DrawnSection(
        section=section,
        u=u,
        sides={name: points * size for name, points in sides.items()},
        outwards=outwards,
        points=drawn,
        band=band,
    )


def worst_span(fit: FitResult, region: str) -> float:
    """v of the inlier of a region with the largest deviation; the middle of the cloud where there is no inlier."""
    index = np.flatnonzero(fit.inliers & on_sides(fit) & (fit.regions == region))
    if len(index):
        return float(np.clip(fit.v[index[np.argmax(np.abs(fit.deviations[index]))]], 0.0, 1.0))
    return span_at_share(fit, 0.5)


def span_at_share(fit: FitResult, share: float) -> float:
    """v at a fraction of the span that the cloud covers."""
    covered = fit.v[fit.inliers & on_sides(fit)]
    low, high = (float(covered.min()), float(covered.max())) if len(covered) else (0.0, 1.0)
    return float(np.clip(low + share * (high - low), 0.0, 1.0))


def _across(fit: FitResult, index: Index, end: float) -> Reals:
    """Fractions (m,) of the way from the upper to the lower side at which points lie on the face of a blunt edge."""
    if fit.cloud.shape[-1] == 3:
        upper, lower = (np.real(fit.built.surfaces[name](end, fit.v[index])) for name in SIDES)
    else:
        upper, lower = (np.real(fit.built.curves[name](np.full(len(index), end))) for name in SIDES)
    way = lower - upper
    return np.clip(dot(fit.cloud[index] - upper, way) / dot(way, way), 0.0, 1.0)


def _on_outline(fit: FitResult) -> NDArray[np.bool_]:
    """Whether the closest point of each point (n,) lies on a side or on the face of a blunt edge."""
    return on_sides(fit) | np.isin(fit.places, BLUNT_FACES)


def _near_span(fit: FitResult, v: float) -> tuple[NDArray[np.bool_], float]:
    """Whether each point (n,) lies in the band about v, and the half height of the band."""
    sides, band = _on_outline(fit), BAND
    while True:
        inside = sides & (np.abs(fit.v - v) <= band)
        if np.count_nonzero(inside) >= BAND_POINTS or band >= WIDEST_BAND:
            return inside, band
        band *= 2.0
