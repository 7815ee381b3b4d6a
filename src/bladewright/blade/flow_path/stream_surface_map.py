"""How a plane section lies on its stream surface: one final class for each plane, all with the same questions.

The plane's abscissa a grows along the stream line with the density da/du; its ordinate b is tangential.
"""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, dot, length
from bladewright.section import checks


class Taylor(NamedTuple):
    """A quantity along a curve with its first and second derivatives by the curve's parameter."""

    value: Array
    first: Array
    second: Array

    def __mul__(self, other: "Taylor") -> "Taylor":  # type: ignore[override]
        return Taylor(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2.0 * self.first * other.first + self.value * other.second,
        )

    def scaled(self, factor: Array) -> "Taylor":
        """The quantity times a factor that does not vary along the curve."""
        return Taylor(self.value * factor, self.first * factor, self.second * factor)

    def composed(self, value: Array, first: Array, second: Array) -> "Taylor":
        """f(self) for a function with the given value and derivatives there."""
        return Taylor(value, first * self.first, second * self.first**2 + first * self.second)

    def sine(self) -> "Taylor":
        return self.composed(np.sin(self.value), np.cos(self.value), -np.sin(self.value))

    def cosine(self) -> "Taylor":
        return self.composed(np.cos(self.value), -np.sin(self.value), -np.cos(self.value))

    def inverse(self) -> "Taylor":
        return self.composed(1.0 / self.value, -1.0 / self.value**2, 2.0 / self.value**3)


class StreamSurfaceMap(ABC):
    """The plane of a family of sections, and the way from it to space."""

    revolved: bool
    """whether blades are arranged around the machine axis"""
    plane: str
    """the plane's coordinates by name"""
    keeps_ordinate: bool = True
    """whether neighbouring blades are one pitch apart in the plane's ordinate everywhere"""
    true_lengths: bool = False
    """whether the abscissa is a length along the stream line, or along x"""
    discrete: bool = False
    """whether its m' is counted, chord by chord, by the points of hub, shroud and stream surfaces"""
    keeps_angles: bool = True
    """whether a built blade is promised the angles and edge radii that its sections have"""

    @abstractmethod
    def density(self, position: Array, slope: Array) -> Array:
        """da/du (...) from (x, r) and its derivative by u (..., 2)."""

    @abstractmethod
    def density_slope(self, position: Array, slope: Array, bend: Array) -> Array:
        """d2a/du2 (...) from (x, r) and its first and second derivatives by u (..., 2)."""

    @abstractmethod
    def scale(self, radius: Array, lengths: Array) -> Array:
        """Size in the plane of one meridional length at the radius (...)."""

    @abstractmethod
    def edge_curvature(self, fraction: Array, lengths: Array, radius: Array, climb: Array, trailing: bool) -> Array:
        """Curvature to set in the plane so that the edge has its radius in the stream surface.

        `fraction` of the meridional length, `lengths` of the stream lines [m], `radius` r at the edge [m], `climb`
        sin(phi) cos(beta), phi the stream line's angle to the axis and beta the metal angle.
        """

    def tangential(self, ordinate: Array, radius: Array, lengths: Array) -> Array:
        """theta [rad], or y [m] in a cascade, from ordinate and radius: the ordinate itself, but for the paper."""
        del radius, lengths
        return ordinate

    def tangential_series(self, ordinate: Taylor, radius: Taylor, lengths: Array) -> Taylor:
        """The same along a curve."""
        del radius, lengths
        return ordinate

    def start(self, tangential: Array, radius: Array, lengths: Array) -> Array:
        """Ordinate of a point whose theta, or y in a cascade, is given."""
        del radius, lengths
        return tangential

    def in_space(self, x: Array, radius: Array, tangential: Array) -> Array:
        """Points (..., 3) in metres."""
        if not self.revolved:
            return np.stack(np.broadcast_arrays(x, tangential, radius), axis=-1)
        both = radius * np.sin(tangential), radius * np.cos(tangential)
        return np.stack(np.broadcast_arrays(x, *both), axis=-1)

    def series_in_space(self, x: Taylor, radius: Taylor, tangential: Taylor) -> tuple[Array, Array, Array]:
        """A curve's point and its first two derivatives (..., 3) in space."""
        parts = (
            [x, tangential, radius]
            if not self.revolved
            else [x, radius * tangential.sine(), radius * tangential.cosine()]
        )
        value, first, second = (
            np.stack(np.broadcast_arrays(*[part[order] for part in parts]), axis=-1) for order in range(3)
        )
        return value, first, second


class Conformal(StreamSurfaceMap):
    """The plane (m', theta) of a stream surface of revolution, m' = integral dm / r: angles are true."""

    revolved = True
    plane = "m'-theta"

    def density(self, position: Array, slope: Array) -> Array:
        return length(slope) / position[..., 1]

    def density_slope(self, position: Array, slope: Array, bend: Array) -> Array:
        speed, radius = length(slope), position[..., 1]
        return dot(slope, bend) / (speed * radius) - speed * slope[..., 1] / radius**2

    def scale(self, radius: Array, lengths: Array) -> Array:
        return lengths / radius

    def edge_curvature(self, fraction: Array, lengths: Array, radius: Array, climb: Array, trailing: bool) -> Array:
        return radius / (fraction * lengths) + (-climb if trailing else climb)


class TrueLengths(StreamSurfaceMap, ABC):
    """A plane whose abscissa is the meridional length."""

    true_lengths = True

    def density(self, position: Array, slope: Array) -> Array:
        del position
        return length(slope)

    def density_slope(self, position: Array, slope: Array, bend: Array) -> Array:
        del position
        return dot(slope, bend) / length(slope)

    def scale(self, radius: Array, lengths: Array) -> Array:
        return lengths + 0.0 * radius

    def edge_curvature(self, fraction: Array, lengths: Array, radius: Array, climb: Array, trailing: bool) -> Array:
        del radius, climb, trailing
        return 1.0 / (fraction * lengths)


class Cascade(TrueLengths):
    """The plane (m, y) of a linear cascade's stream surface, a cylinder along y: lengths are true."""

    revolved = False
    plane = "m-y"


class ByParameter(StreamSurfaceMap, ABC):
    """A plane whose abscissa is the parameter along the stream lines."""

    def density(self, position: Array, slope: Array) -> Array:
        del slope
        return np.ones_like(position[..., 1])

    def density_slope(self, position: Array, slope: Array, bend: Array) -> Array:
        del slope, bend
        return np.zeros_like(position[..., 1])


class Paper(ByParameter):
    """The plane (u, y / L) of Agromayor et al. 2021: u is the channel's parameter, and theta = y / r (eq. 28).

    Neither angles nor radii survive it; it is here to reproduce the paper's blades.
    """

    plane = "u-y/L"
    keeps_ordinate = False
    keeps_angles = False

    def __init__(self, *, revolved: bool) -> None:
        self.revolved = revolved

    def scale(self, radius: Array, lengths: Array) -> Array:
        del lengths
        return np.ones_like(radius)

    def edge_curvature(self, fraction: Array, lengths: Array, radius: Array, climb: Array, trailing: bool) -> Array:
        del lengths, radius, climb, trailing
        return 1.0 / fraction

    def start(self, tangential: Array, radius: Array, lengths: Array) -> Array:
        return tangential * (radius if self.revolved else 1.0) / lengths

    def tangential(self, ordinate: Array, radius: Array, lengths: Array) -> Array:
        return ordinate * lengths / radius if self.revolved else ordinate * lengths

    def tangential_series(self, ordinate: Taylor, radius: Taylor, lengths: Array) -> Taylor:
        series = ordinate.scaled(lengths)
        return series * radius.inverse() if self.revolved else series


def mapping_of(name: str, arrangement: str) -> StreamSurfaceMap:
    """The mapping of a design."""
    revolved = arrangement == "annular"
    if name == "paper":
        return Paper(revolved=revolved)
    return Conformal() if revolved else Cascade()


class Unrolled(TrueLengths):
    """The plane (m, r theta) of a stream surface of revolution: its abscissa is a length, r that at the point.

    Angles are true only where theta = 0 or r stands still. Voss et al. 2025, section 2.
    """

    revolved = True
    plane = "m-r*theta"
    keeps_ordinate = False

    def start(self, tangential: Array, radius: Array, lengths: Array) -> Array:
        del lengths
        return tangential * radius

    def tangential(self, ordinate: Array, radius: Array, lengths: Array) -> Array:
        del lengths
        return ordinate / radius

    def tangential_series(self, ordinate: Taylor, radius: Taylor, lengths: Array) -> Taylor:
        del lengths
        return ordinate * radius.inverse()


class Projected(TrueLengths):
    """The plane (x, y) of a linear cascade: the section as it is seen along the span.

    Raises DesignError where a stream line does not go forwards in x.
    """

    revolved = False
    plane = "x-y"

    def density(self, position: Array, slope: Array) -> Array:
        least = float(np.min(np.real(slope[..., 0])))
        if least <= 0.0:
            where = np.unravel_index(int(np.argmin(np.real(slope[..., 0]))), slope.shape[:-1])
            x, z = np.real(position[where])
            raise DesignError(
                f"plane 'x-y': a stream line does not go forwards in x at (x, z) = ({x:.5g}, {z:.5g}) m, so sections "
                'cannot be laid out by x; take the plane "m\'-theta", or make hub and shroud go downstream everywhere'
            )
        return slope[..., 0]

    def density_slope(self, position: Array, slope: Array, bend: Array) -> Array:
        del position, slope
        return bend[..., 0]


class DiscreteConformal(ByParameter, Conformal):
    """The plane (m', theta) with m' in proportion to t, as meridians of points with `spacing` "conformal" count it.

    It is that of T-Blade3; it differs from the conformal one by what the sum of chords over radii misses. Its abscissa
    is t, to be multiplied by the increase of m'.
    """

    discrete = True


PLANES: dict[str, dict[str, type[StreamSurfaceMap]]] = {
    "annular": {"m'-theta": Conformal, "m-r*theta": Unrolled, "counted-m'-theta": DiscreteConformal},
    "linear": {"m-y": Cascade, "x-y": Projected},
}
"""The planes that there are of each arrangement."""


def plane_of(name: str, arrangement: str) -> StreamSurfaceMap:
    """The mapping of a plane by its name, as `Section.plane` has it; in a cascade m' is m, theta y and r theta y."""
    if arrangement == "linear" and name in ("m'-theta", "m-r*theta"):
        name = "m-y"
    kinds = PLANES[arrangement]
    checks.choice("plane", name, list(kinds))
    return kinds[name]()
