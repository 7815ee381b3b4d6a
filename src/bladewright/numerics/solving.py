"""Linear systems with one real matrix and many right sides."""

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array


def solved(matrix: NDArray[np.float64], values: Array) -> Array:
    """The solutions (..., n, k) of matrix (n, n) times them = values (..., n, k), real or complex.

    The matrix is factorised once for all of them, in real numbers.
    """
    columns = np.moveaxis(values, -2, 0)
    complex_valued = np.iscomplexobj(columns)
    flat = np.ascontiguousarray(columns).reshape(len(columns), -1)
    found: Array = np.linalg.solve(matrix, flat.view(np.float64) if complex_valued else flat)
    found = found.view(np.complex128) if complex_valued else found
    return np.moveaxis(found.reshape(columns.shape), 0, -2)
