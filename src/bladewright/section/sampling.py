"""Where along the camber line the control points of a side stand."""

import numpy as np

from bladewright.nurbs.basis import Reals


def sample_places(samples: int, clustering: float) -> Reals:
    """Camber parameters (samples + 5,) of a side's control points, of which the inner `samples` carry thickness.

    Two control points stand at each edge: the edge itself and the one that sets its radius (Agromayor et al. 2021,
    eq. 14). Between them the places are uniform for clustering 0 and cosine-spaced for 1.
    """
    uniform = np.linspace(0.0, 1.0, samples + 2)
    cosine = (1.0 - np.cos(np.pi * uniform)) / 2.0
    inner = (1.0 - clustering) * uniform + clustering * cosine
    inner[-1] = 1.0
    return np.concatenate([[0.0], inner, [1.0]])
