"""Homogeneous coordinates of rational curves and surfaces: the way there and back, and derivatives of quotients."""

from math import comb

import numpy as np

from bladewright.numerics.elementary import Array


def homogeneous(control_points: Array, weights: Array | None) -> Array:
    """Control points (..., d) without weights, or (w P, w) of shape (..., d + 1) with weights (...)."""
    if weights is None:
        return control_points
    return np.concatenate([control_points * weights[..., None], weights[..., None]], axis=-1)


def projected(coordinates: Array, *, rational: bool) -> tuple[Array, Array | None]:
    """Control points and weights (or None) of homogeneous coordinates: the inverse of `homogeneous`."""
    if not rational:
        return coordinates, None
    weights = coordinates[..., -1]
    return coordinates[..., :-1] / weights[..., None], weights


def curve_quotients(derivatives: list[Array]) -> list[Array]:
    """C, C', C''... (..., d) of the homogeneous derivatives [(A, w), (A', w'), ...], each (..., d + 1).

    Piegl and Tiller 1997, eq. 4.8 and algorithm A4.2.
    """
    inverse = 1.0 / derivatives[0][..., -1:]
    found: list[Array] = []
    for k, homogeneous_derivative in enumerate(derivatives):
        value = homogeneous_derivative[..., :-1]
        for i in range(1, k + 1):
            value = value - comb(k, i) * derivatives[i][..., -1:] * found[k - i]
        found.append(value * inverse)
    return found


def surface_quotients(derivatives: dict[tuple[int, int], Array]) -> dict[tuple[int, int], Array]:
    """Partial derivatives {(k, l): (..., d)} of the homogeneous ones {(k, l): (..., d + 1)}.

    With every (k, l) come all (i, j) with i <= k and j <= l. Piegl and Tiller 1997, eq. 4.20 and algorithm A4.4.
    """
    inverse = 1.0 / derivatives[0, 0][..., -1:]
    found: dict[tuple[int, int], Array] = {}
    for k, l in sorted(derivatives):  # noqa: E741 - the formula's letters
        value = derivatives[k, l][..., :-1]
        for i in range(k + 1):
            for j in range(l + 1):
                if i or j:
                    value = value - comb(k, i) * comb(l, j) * derivatives[i, j][..., -1:] * found[k - i, l - j]
        found[k, l] = value * inverse
    return found
