"""The sizes of a ball around the blade, from a fillet's design."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from bladewright.blade.design.fillet import Fillet, FilletRadii
from bladewright.blade.native.closed_section import LEADING, LOWER, TRAILING, Sites
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.section.laws import DEGREE as LAW_DEGREE
from bladewright.section.laws import stacked

Sizes = Callable[[Sites], tuple[Array, Array]]
"""Distances (k,) [m] of the ball's centre from blade and wall at sites (k,)."""


def ball_sizes(fillet: Fillet, metre: float, suction_side: Callable[[], str | None]) -> Sizes:
    """The sizes by site; an ellipse's height on the blade is the distance of its centre from the wall.

    A law along the section runs with u^2 (3 - 2 u), and values at edges and sides are joined by
    t^3 (10 - 15 t + 6 t^2), t the share of the way from an edge to u = 1/2, so that the radius has no slope at edges.
    Across the face of a blunt edge it is that of the edge.
    """
    if fillet.kind == "ellipse":
        on_blade, on_wall = (metre * np.asarray(size) for size in (fillet.on_blade, fillet.on_wall))
        return lambda sites: (_everywhere(on_wall, sites), _everywhere(on_blade, sites))
    radius = fillet.radius
    if isinstance(radius, FilletRadii):
        upper, lower = side_radii(radius, suction_side)
        ends = metre * np.asarray(radius.leading_edge), metre * np.asarray(radius.trailing_edge)
        return lambda sites: _twice(_joined(sites, ends, (metre * np.asarray(upper), metre * np.asarray(lower))))
    if isinstance(radius, tuple):
        degree = min(len(radius) - 1, LAW_DEGREE)
        if degree == 0:
            return lambda sites: _twice(_everywhere(metre * np.asarray(radius[0]), sites))
        law = Curve(
            control_points=metre * stacked(radius)[:, None], knots=uniform_knots(len(radius), degree), degree=degree
        )

        def along_law(sites: Sites) -> tuple[Array, Array]:
            u = _along(sites)
            return _twice(law(u**2 * (3.0 - 2.0 * u))[:, 0])

        return along_law
    return lambda sites: _twice(_everywhere(metre * np.asarray(radius), sites))


def side_radii(radii: FilletRadii, suction_side: Callable[[], str | None]) -> tuple[float, float]:
    """The radii in the middle of the upper and the lower side; raises DesignError where the design does not say."""
    if radii.upper is not None:
        return radii.upper, cast(float, radii.lower)
    name = suction_side()
    if name is None:
        raise DesignError(
            "radius gives suction_side and pressure_side, but neither rotation nor the camber says which side that is: "
            "give upper and lower, or rotation"
        )
    suction, pressure = cast(float, radii.suction_side), cast(float, radii.pressure_side)
    return (suction, pressure) if name == "upper" else (pressure, suction)


def _joined(sites: Sites, ends: tuple[Array, Array], middles: tuple[Array, Array]) -> Array:
    u = _along(sites)
    trailing = np.real(u) > 0.5
    share = 2.0 * np.where(trailing, 1.0 - u, u)
    rise = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    start = np.where(trailing, ends[1], ends[0])
    return np.asarray(start + (np.where(sites.side == LOWER, middles[1], middles[0]) - start) * rise)


def _along(sites: Sites) -> Array:
    """u of the sides at sites: at 0 or 1 all across the face of a blunt edge."""
    return np.where(sites.side == LEADING, 0.0, np.where(sites.side == TRAILING, 1.0, sites.u))


def _everywhere(size: Array, sites: Sites) -> Array:
    return np.zeros(len(sites)) * sites.u + size


def _twice(size: Array) -> tuple[Array, Array]:
    return size, size
