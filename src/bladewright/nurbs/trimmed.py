"""A piece of a surface inside closed boundary curves in its parameter plane."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
from numpy.random import default_rng
from numpy.typing import ArrayLike, NDArray

from bladewright.errors import GeometryError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, length
from bladewright.numerics.quadrature import converged_quadrature, gauss, panels
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trim_loop import TrimLoop, contained, meeting_parameters, trim_loop

CLOSED = 1e-9
"""Largest gap between consecutive boundary curves, in units of their extent: so much may be rounding."""
ORIENTING = 2
"""Gauss points on a knot span by which the sense of a boundary is found: only the sign of its area matters."""
DRAWS = 4_000_000
"""Largest number of points drawn in the bounding box of a boundary to find some inside: about a second."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class TrimmedSurface(FrozenRecord):
    """The part of `surface` inside `boundary`, a closed loop of curves in (u, v) that runs counter-clockwise.

    `holes` are closed loops inside it that run clockwise, so that the face is to the left of every curve. No loop
    crosses itself or another. Raises GeometryError where one is not plane, not closed, runs the other way or lies
    outside.
    """

    surface: Surface
    """the untrimmed surface"""
    boundary: tuple[Curve, ...]
    """curves of dimension 2, each ending where the next one starts"""
    revolution: Revolution | None = None
    """how the surface was revolved, where it is one of revolution about the x axis"""
    holes: tuple[tuple[Curve, ...], ...] = ()
    """loops of such curves, inside which there is no surface"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "boundary", tuple(self.boundary))
        object.__setattr__(self, "holes", tuple(map(tuple, self.holes)))
        _check_closed(self.boundary, "boundary")
        area = _enclosed(self.boundary, ORIENTING).real
        if not area > 0.0:
            raise GeometryError(
                f"the boundary encloses an area of {area:g} in (u, v): it must run counter-clockwise; reverse its "
                "curves and their order"
            )
        for number, hole in enumerate(self.holes, 1):
            self._check_hole(hole, f"hole {number}")

    def _check_hole(self, hole: tuple[Curve, ...], name: str) -> None:
        _check_closed(hole, name)
        area = _enclosed(hole, ORIENTING).real
        if not area < 0.0:
            raise GeometryError(
                f"{name} encloses an area of {area:g} in (u, v): it must run clockwise; reverse its curves and their "
                "order"
            )
        points = np.concatenate([curve(breaks(curve.knots)).real for curve in hole])
        others = trim_loop([loop for loop in self.loops if loop is not hole])
        outside = ~contained(others, points[:, 0], points[:, 1])
        if outside.any():
            u, v = points[np.argmax(outside)]
            raise GeometryError(
                f"{name} passes (u, v) = ({u:g}, {v:g}), which is outside the boundary or inside another hole: holes "
                "lie apart from each other within the boundary; move it or enlarge the boundary"
            )

    def __repr__(self) -> str:
        holes = {0: "", 1: " and outside a hole"}.get(len(self.holes), f" and outside {len(self.holes)} holes")
        return f"<TrimmedSurface inside {len(self.boundary)} curves{holes}, of {self.surface!r}>"

    @property
    def loops(self) -> tuple[tuple[Curve, ...], ...]:
        """The boundary and the holes: closed loops with the face to their left."""
        return (self.boundary, *self.holes)

    @property
    def curves(self) -> tuple[Curve, ...]:
        """The curves of all loops, one loop after another."""
        return tuple(curve for loop in self.loops for curve in loop)

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Array:
        """Points (..., d) of the surface, on the face or not."""
        return self.surface(u, v)

    def normal(self, u: ArrayLike, v: ArrayLike) -> Array:
        """Unit normals (..., 3) of the surface, on the face or not."""
        return self.surface.normal(u, v)

    @cached_property
    def parametric_area(self) -> Array:
        """Area () of the face in the (u, v) plane."""
        return converged_quadrature(lambda order: _enclosed(self.curves, order))

    def area(self) -> Array:
        """Area () of the trimmed piece of a surface in space."""

        def density(u: Array, v: Array) -> Array:
            along_u, along_v = self.surface.derivative(u, v, 1, 0), self.surface.derivative(u, v, 0, 1)
            return length(np.cross(along_u, along_v))

        return self.integral(density)

    def integral(self, density: Callable[[Array, Array], Array], order: int | None = None) -> Array:
        """Integral (k) of density(u, v) (..., k) du dv over the face.

        Green's theorem: the sum over the loops of F dv, with F the integral of the density along u from the
        boundary's smallest u. Both quadratures break at the surface's knots, the outer one also at the loops';
        `order` Gauss points a panel, or, where None, as many as the result needs to converge to 1e-13 of itself.
        The parameters are complex where a loop is; `Surface` carries their imaginary parts to first order.
        """
        return (
            converged_quadrature(lambda points: self._green(density, points))
            if order is None
            else self._green(density, order)
        )

    def contains(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.bool_]:
        """Whether points (...) of the parameter plane lie on the face; on a loop itself, either."""
        at_u, at_v = np.broadcast_arrays(np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64))
        return contained(self._loop, at_u.ravel(), at_v.ravel()).reshape(at_u.shape)

    def interior_points(self, count: int, seed: int = 0) -> tuple[Reals, Reals]:
        """Random parameters u, v (count,), uniform in the (u, v) plane on the face, the same for the same seed.

        Raises GeometryError where the region is too thin for four million draws in its box.
        """
        random = default_rng(seed)
        low, high = self._loop.low, self._loop.high
        share = float(self.parametric_area.real) / float(np.prod(high - low))
        found: list[Reals] = []
        inside, drawn = 0, 0
        while inside < count:
            batch = min(int(1.2 * (count - inside) / share) + 16, DRAWS - drawn)
            if batch <= 0:
                raise GeometryError(
                    f"{inside} of {count} points of a trimmed face were found in {DRAWS} draws: it fills {share:g} "
                    "of its box in (u, v); ask for fewer points"
                )
            sites = low + (high - low) * random.random((batch, 2))
            found.append(sites[self.contains(sites[:, 0], sites[:, 1])])
            inside, drawn = inside + len(found[-1]), drawn + batch
        sites = np.concatenate([np.zeros((0, 2)), *found])[:count]
        return sites[:, 0], sites[:, 1]

    @cached_property
    def _loop(self) -> TrimLoop:
        return trim_loop(self.loops)

    def _green(self, density: Callable[[Array, Array], Array], order: int) -> Array:
        """Green's theorem: lines across the face, along the direction with fewer knots, summed over its loops."""
        knots = breaks(self.surface.knots_u), breaks(self.surface.knots_v)
        within = [
            inner[(inner > low) & (inner < high)]
            for inner, low, high in zip(knots, self._loop.low, self._loop.high, strict=True)
        ]
        lines = 0 if len(within[0]) <= len(within[1]) else 1
        starts = np.concatenate([[float(self._loop.low[lines])], within[lines]])
        tops = np.append(starts[1:], np.inf)
        nodes, weights = gauss(order)
        total: Array = np.zeros(())
        for curve in self.curves:
            ends = np.concatenate([breaks(curve.knots), meeting_parameters(curve, knots[0][1:-1], knots[1][1:-1])])
            t, outer = panels(np.unique(ends), order)
            place = curve(t)
            end, fixed = place[:, lines], place[:, 1 - lines]
            rise = outer * curve.derivative(t)[:, 1 - lines] * (1.0 if lines == 0 else -1.0)
            # each panel of a line ends at the next knot, or at the boundary if that comes first
            reached = end.real[:, None] > starts
            width = np.where(reached, np.where(end.real[:, None] < tops, end[:, None], tops), starts) - starts
            row, panel = np.nonzero(reached)
            inner = width[row, panel][:, None]
            along = starts[panel][:, None] + inner * nodes
            across = np.broadcast_to(fixed[row][:, None], along.shape)
            values = density(along, across) if lines == 0 else density(across, along)
            scale = (inner * weights) * rise[row][:, None]
            total = total + np.tensordot(scale, values, axes=((0, 1), (0, 1)))
        return total


def _check_closed(loop: tuple[Curve, ...], name: str) -> None:
    """Raise GeometryError unless a loop is a closed chain of plane curves."""
    if not loop or any(curve.control_points.shape[1:] != (2,) for curve in loop):
        shapes = [curve.control_points.shape for curve in loop]
        raise GeometryError(f"a {name} of curves of shapes {shapes} was given: at least one, each (n, 2) in (u, v)")
    ends = [(curve.control_points[0].real, curve.control_points[-1].real) for curve in loop]
    extent = float(np.ptp(np.concatenate([curve.control_points.real for curve in loop]), axis=0).max())
    for index, (_, end) in enumerate(ends):
        following = (index + 1) % len(ends)
        gap = float(length(ends[following][0] - end))
        if gap > CLOSED * extent:
            raise GeometryError(
                f"{name} curve {following} starts {gap:g} away from the end of curve {index}: at most "
                f"{CLOSED * extent:g} is allowed; reorder, reverse or close the chain"
            )


def _enclosed(curves: tuple[Curve, ...], order: int) -> Array:
    """Area () to the left of closed loops, by Gauss points on their knot spans."""
    enclosed: Array = np.zeros(())
    for curve in curves:
        t, weights = panels(breaks(curve.knots), order)
        enclosed = enclosed + np.sum(weights * curve(t)[:, 0] * curve.derivative(t)[:, 1])
    return enclosed
