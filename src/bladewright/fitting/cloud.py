"""Clouds as they come: what can be fitted at all, and what is suspicious."""
import numpy as np
from numpy.typing import ArrayLike
from bladewright.nurbs.basis import Reals
def checked_cloud(cloud: ArrayLike) -> tuple[Reals, tuple[str, ...]]:
    return np.asarray(cloud, dtype=np.float64), ()
