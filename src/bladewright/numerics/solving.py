"""Linear systems with one real matrix and many right-hand sides."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from bladewright.numerics.elementary import Array


def solved(matrix: NDArray[np.float64], values: Array) -> Array:
    """The solutions x (..., n, k) of `matrix` (n, n) x = `values` (..., n, k), real or complex.

    By the inverse, which is as accurate as elimination where the matrix is well conditioned, as in interpolation at
    Greville abscissae (condition about 10), and several times faster for a batch.
    """
    inverse = np.linalg.inv(matrix)
    if not np.iscomplexobj(values):
        return np.asarray(inverse @ values)
    found: Array = inverse @ np.ascontiguousarray(values).view(np.float64)
    return found.view(np.complex128)


def banded_solved(matrix: NDArray[np.float64], values: Array, width: int) -> Array:
    """The same for a large matrix whose entries lie within `width` places of its diagonal, by elimination there."""
    count = len(matrix)
    # a small matrix is narrower than its band
    width = min(width, max(count - 1, 0))
    bands = np.zeros((2 * width + 1, count))
    for place in range(-width, width + 1):
        bands[width - place, max(place, 0) : count + min(place, 0)] = np.diagonal(matrix, place)
    right = np.moveaxis(values, -2, 0)
    flat = np.ascontiguousarray(right).reshape(count, -1)
    found = solve_banded((width, width), bands, flat.view(np.float64), check_finite=False)
    return np.moveaxis(np.ascontiguousarray(found).view(flat.dtype).reshape(right.shape), 0, -2)
