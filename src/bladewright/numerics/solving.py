"""Linear systems with one real matrix and many right sides."""

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array


def solved(matrix: NDArray[np.float64], values: Array) -> Array:
    """The solutions (..., n, k) of matrix (n, n) times them = values (..., n, k), real or complex.

    By the inverse, which is as exact as elimination where the matrix is well conditioned, as in an interpolation at
    Greville abscissae (about 10), and many times faster for a batch.
    """
    inverse = np.linalg.inv(matrix)
    if not np.iscomplexobj(values):
        return np.asarray(inverse @ values)
    found: Array = inverse @ np.ascontiguousarray(values).view(np.float64)
    return found.view(np.complex128)
