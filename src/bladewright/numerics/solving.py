"""Linear systems with one real matrix and many right-hand sides."""

import numpy as np
from numpy.typing import NDArray

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
