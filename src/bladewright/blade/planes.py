"""The planes that sections are laid out in, besides (m', theta): (m, r theta), (x, y), and a counted m'."""

import numpy as np

from bladewright.blade.mapping import Cascade, Conformal, Mapping, Taylor, TrueLengths
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.section import checks


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


class Level(TrueLengths):
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


class Counted(Conformal):
    """The plane (m', theta) with m' in proportion to t, as meridians of points with `spacing` "conformal" count it.

    It is that of T-Blade3; it differs from the conformal one by what the sum of chords over radii misses. Its abscissa
    is t, to be multiplied by the increase of m'.
    """

    def density(self, position: Array, slope: Array) -> Array:
        del slope
        return np.ones_like(position[..., 1])

    def density_slope(self, position: Array, slope: Array, bend: Array) -> Array:
        del slope, bend
        return np.zeros_like(position[..., 1])


PLANES: dict[str, dict[str, type[Mapping]]] = {
    "annular": {"m'-theta": Conformal, "m-r*theta": Unrolled, "counted-m'-theta": Counted},
    "linear": {"m-y": Cascade, "x-y": Level},
}
"""The planes that there are of each arrangement."""


def plane_of(name: str, arrangement: str) -> Mapping:
    """The mapping of a plane by its name, as `Section.plane` has it; in a cascade m' is m, theta y and r theta y."""
    if arrangement == "linear" and name in ("m'-theta", "m-r*theta"):
        name = "m-y"
    kinds = PLANES[arrangement]
    checks.choice("plane", name, list(kinds))
    return kinds[name]()
