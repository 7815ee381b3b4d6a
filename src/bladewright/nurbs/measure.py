"""Arc length and area, and integrals over curves and surfaces, by Gauss quadrature on knot spans."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, cross, length
from bladewright.numerics.quadrature import adaptive, converged_quadrature, gauss, panels
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

PER_PATCH = 6
"""Gauss points each way on a patch of `area`: where they do not suffice a patch is quartered. With 4 a pinched side of
Rotor 67 takes three times as long, with 9 a little less (design/nurbs_constants.md)."""
ROUNDING = 1e-13
"""Difference between a patch and its quarters, in units of the whole area, below which `area` accepts them: the
rounding of a sum over a thousand points. With 1e-10 a pinched side is 3e-14 off instead of 6e-16, with 1e-15 it takes
twice the time (design/nurbs_constants.md)."""
MAX_QUARTERINGS = 24
"""Quarterings of a patch: what then remains of it is 4e-15 of its area. No side in design/nurbs_constants.md needs more
than 4."""
MAX_PATCHES = 20_000
"""Patches that are quartered at once, which bounds time and memory: only where the normal vanishes along a whole line
would there be more. A tenth suffices in design/nurbs_constants.md."""
_QUARTERS = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])

Density = Callable[[Array, Array, Array], Array]
"""A density (..., k) per du dv as a function of S, dS/du and dS/dv, each (..., d)."""


def arc_length(curve: Curve, start: float | None = None, end: float | None = None) -> Array:
    """Length () of a curve between two parameters, by default the whole; negative where start lies above end.

    Gauss quadrature on each knot span, halved where that has not converged to rounding.
    """
    first = curve.domain[0] if start is None else start
    last = curve.domain[1] if end is None else end
    inner = breaks(curve.knots)
    ends = np.concatenate([[first], inner[(inner > min(first, last)) & (inner < max(first, last))], [last]])
    ends = np.sort(ends) if last >= first else np.sort(ends)[::-1]
    return adaptive(lambda u: length(curve.derivative(u)), ends)


def parameters_at_length(curve: Curve, fractions: ArrayLike) -> Array:
    """Parameters u (m,) up to which the curve has the given fractions (m,) in [0, 1] of its length.

    Complex where the control points are. Raises GeometryError for a fraction outside [0, 1].
    """
    wanted = np.atleast_1d(np.asarray(fractions, dtype=np.float64))
    if not ((wanted >= 0.0) & (wanted <= 1.0)).all():
        raise GeometryError(f"fractions {wanted.tolist()} of a length were asked for: each must lie in [0, 1]")
    ends = breaks(curve.knots)
    steps = np.array([arc_length(curve, a, b) for a, b in pairwise(ends)])
    reached = np.concatenate([np.zeros(1, dtype=steps.dtype), np.cumsum(steps)])
    target = wanted * reached[-1]
    span = np.clip(np.searchsorted(reached.real, target.real, side="right") - 1, 0, len(steps) - 1)

    def excess(u: Array) -> tuple[Array, Array]:
        cut = np.array([arc_length(curve, ends[k], x) for k, x in zip(span, u, strict=True)])
        return reached[span] + cut - target, length(curve.derivative(u))

    return bracketed_root(excess, ends[span], ends[span + 1])


def area(surface: Surface) -> Array:
    """Area () of a whole surface in space.

    A patch between knots is quartered until PER_PATCH Gauss points each way on it and on its quarters agree within
    ROUNDING of the whole, so that a normal that turns round within a patch costs more points but no accuracy.
    """
    u, v = breaks(surface.knots_u), breaks(surface.knots_v)
    starts, stops = _quarters(*_corners(u, v))
    # the first quarters lie on a grid too, which takes a tenth of the time of scattered points
    coarse, fine = _grid_areas(surface, u, v).ravel(), _grid_areas(surface, _halved(u), _halved(v))
    fine = fine.reshape(len(u) - 1, 2, len(v) - 1, 2).swapaxes(1, 2).ravel()
    done: Array = np.zeros(())
    for _ in range(MAX_QUARTERINGS):
        both = fine.reshape(-1, 4).sum(axis=1)
        whole = np.real(done + both.sum())
        rough = np.square(np.real(both - coarse)) > (ROUNDING * whole) ** 2
        done = done + both[~rough].sum()
        again = np.repeat(rough, 4)
        coarse = fine[again]
        if not 0 < len(coarse) <= MAX_PATCHES:
            break
        starts, stops = _quarters(starts[again], stops[again])
        fine = _patch_areas(surface, starts, stops)
    return np.asarray(done + coarse.sum())


def _corners(u: Reals, v: Reals) -> tuple[Reals, Reals]:
    """Lower and upper corners (k, 2) of the patches between breaks."""
    grids = [np.stack(np.meshgrid(*ends, indexing="ij"), axis=-1) for ends in ((u[:-1], v[:-1]), (u[1:], v[1:]))]
    return grids[0].reshape(-1, 2), grids[1].reshape(-1, 2)


def _halved(ends: Reals) -> Reals:
    """Breaks with the middles between them."""
    return np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])]))


def _quarters(low: Reals, high: Reals) -> tuple[Reals, Reals]:
    """Corners (4 k, 2) of the quarters of patches between corners (k, 2)."""
    size = 0.5 * (high - low)
    starts = (low[:, None] + _QUARTERS * size[:, None]).reshape(-1, 2)
    return starts, starts + np.repeat(size, 4, axis=0)


def _grid_areas(surface: Surface, u: Reals, v: Reals) -> Array:
    """Areas (m, k) of all patches between breaks u (m + 1,) and v (k + 1,), by Gauss quadrature."""
    (at_u, along), (at_v, across) = panels(u, PER_PATCH), panels(v, PER_PATCH)
    elements = length(cross(surface.grid(at_u, at_v, 1, 0), surface.grid(at_u, at_v, 0, 1)))
    weighted = along[:, None] * across * elements
    return np.asarray(weighted.reshape(len(u) - 1, PER_PATCH, len(v) - 1, PER_PATCH).sum(axis=(1, 3)))


def _patch_areas(surface: Surface, low: Reals, high: Reals) -> Array:
    """Areas (k,) of patches between corners (k, 2), by Gauss quadrature."""
    nodes, weights = gauss(PER_PATCH)
    u, v = (low[:, i, None] + (high - low)[:, i, None] * nodes for i in (0, 1))
    at_u, at_v = u[:, :, None], v[:, None, :]
    normal = cross(surface.derivative(at_u, at_v, 1, 0), surface.derivative(at_u, at_v, 0, 1))
    return np.asarray(np.prod(high - low, axis=-1) * np.einsum("kij,i,j->k", length(normal), weights, weights))


def surface_integral(surface: Surface, density: Density, order: int | None = None) -> Array:
    """Integral (k) of a density per du dv over a whole surface.

    Gauss quadrature on each pair of knot spans, `order` points each way; where None, with more points until the largest
    entry converges to 1e-13 of itself. A polynomial of degree 2 order - 1 in u and v is integrated exactly.
    """

    def total(points: int) -> Array:
        u, along = panels(breaks(surface.knots_u), points)
        v, across = panels(breaks(surface.knots_v), points)
        values = density(surface.grid(u, v), surface.grid(u, v, 1, 0), surface.grid(u, v, 0, 1))
        return np.asarray(np.tensordot(across, np.tensordot(along, values, axes=(0, 0)), axes=(0, 0)))

    return converged_quadrature(total) if order is None else total(order)
