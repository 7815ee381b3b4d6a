"""Points of a cloud in the planes of their sections."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis


@dataclass(frozen=True, kw_only=True, eq=False)
class Laid:
    """Points of a cloud in the planes of their sections."""

    points: Reals
    """(n, 2)"""
    v: Reals
    """(n,) along the span"""
    size: Reals
    """(n,) of one metre in the plane"""
    chord: float
    """typical, [m]"""
    ratio: float
    """typical chord of the meridional length"""
    flat: bool = False
    """whether all points belong to one section"""
    upper: NDArray[np.bool_] | None = None
    """(n,) which side a point belongs to"""
    sure: NDArray[np.bool_] | None = None
    """(n,) whether that is known"""


def numbers_at(laws: Reals, v: Reals) -> Reals:
    """Numbers (n, q) of the sections at v."""
    return law_basis(len(laws), v) @ laws


def stations(laid: Laid) -> Reals:
    """Places along the span where sections are drawn."""
    return np.zeros(1) if laid.flat else np.linspace(0.0, 1.0, 13)
