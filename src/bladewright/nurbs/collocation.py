"""The sparse collocation matrix: times the control points it gives the points at scattered parameters."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, NdBSpline
from scipy.sparse import csr_array

from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface


def collocation(shape: Curve | Surface, u: ArrayLike, v: ArrayLike = 0.0) -> csr_array:
    """The basis functions (m, n), or (m, n_u n_v), at real parameters (m,), without weights.

    Outside the knots' range the end polynomials are continued.
    """
    at_u = np.asarray(u, dtype=np.float64)
    if isinstance(shape, Curve):
        return csr_array(BSpline.design_matrix(at_u, shape.knots, shape.degree, extrapolate=True))
    sites = np.stack(np.broadcast_arrays(at_u, np.asarray(v, dtype=np.float64)), axis=-1)
    degrees = (shape.degree_u, shape.degree_v)
    found = NdBSpline.design_matrix(sites, (shape.knots_u, shape.knots_v), degrees, extrapolate=True)
    # scipy takes the number of columns from the last one in use
    size = (len(sites), shape.control_points.shape[0] * shape.control_points.shape[1])
    return csr_array((found.data, found.indices, found.indptr), shape=size)
