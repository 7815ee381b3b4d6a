"""Moments and area of a trimmed face of revolution about the x axis, as integrals along its loops.

On S = (x, r sin(theta), r cos(theta)) all densities are f(u) g(theta), and by Green's theorem the integral of f g over
the face is minus that of f G du around it, with G' = g in closed form. Circles about the axis give nothing.
"""

from collections.abc import Callable

import numpy as np

from bladewright.numerics.elementary import Array, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.trimmed import TrimmedSurface

Densities = Callable[[Array, Array, Array], Array]
"""Densities (m, k) integrated over theta, of (x, r) and its derivative by u (m, 2), and theta (m,)."""
POINTS = 12
"""Gauss points on a knot span of a loop, as for the outlines of a blade's ends."""


def revolved_moments(face: TrimmedSurface, revolution: Revolution, apex: complex) -> Array:
    """Area vector (3), and volume, first (3) and second moments (9) of the cone from the axis at x = `apex`."""

    def densities(place: Array, slope: Array, theta: Array) -> Array:
        x, r = place[:, 0] - apex, place[:, 1]
        flux = r * (r * slope[:, 0] - x * slope[:, 1])
        none, by_sine, by_cosine = theta, -np.cos(theta), np.sin(theta)
        twice = 0.25 * np.sin(2.0 * theta)
        squares, product = (0.5 * theta - twice, 0.5 * theta + twice), 0.5 * np.sin(theta) ** 2
        xy, xz, yz = x * r * by_sine, x * r * by_cosine, r * r * product
        second = [x * x * none, xy, xz, xy, r * r * squares[0], yz, xz, yz, r * r * squares[1]]
        first = [x * none, r * by_sine, r * by_cosine]
        vector = [-r * slope[:, 1] * none, slope[:, 0] * r * by_sine, slope[:, 0] * r * by_cosine]
        cone = [flux * none / 3.0, *(flux * each / 4.0 for each in first), *(flux * each / 5.0 for each in second)]
        return np.stack(np.broadcast_arrays(*vector, *cone), axis=-1)

    return _around(face, revolution, densities)


def revolved_area(face: TrimmedSurface, revolution: Revolution) -> Array:
    """Area ()."""

    def density(place: Array, slope: Array, theta: Array) -> Array:
        return (place[:, 1] * length(slope) * theta)[:, None]

    return _around(face, revolution, density)[0]


def _around(face: TrimmedSurface, revolution: Revolution, densities: Densities) -> Array:
    """Minus the integrals (k,) of densities (m, k) du around the face's loops."""
    total: Array = np.zeros(())
    for curve in face.curves:
        t, weights = panels(breaks(curve.knots), POINTS)
        uv, along = curve(t), curve.derivative(t)[:, 0]
        theta: Array = revolution.theta(np.real(uv[:, 1]))
        if np.iscomplexobj(uv):
            theta = theta + 1j * np.imag(uv[:, 1]) * revolution.slope(np.real(uv[:, 1]))
        place, slope = revolution.meridian(uv[:, 0]), revolution.meridian.derivative(uv[:, 0])
        total = total - np.sum((weights * along)[:, None] * densities(place, slope, theta), axis=0)
    return total
