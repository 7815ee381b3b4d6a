"""Guesses that have a shape at all: edges whose sides leave them outwards are made thinner."""

import numpy as np

from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.fitting.matching.model import model_of
from bladewright.fitting.matching.search import COARSEST
from bladewright.section.limits import THICKNESSES
from bladewright.section.unified import UnifiedSection

THINNER, TIMES = 0.7, 12
"""thickness beside the edges at each turn, of that before, and turns"""


def opened(design: Design) -> Design:
    """The design, or one with thinner edges where values that it was given leave it no shape; the last where none has.

    A camber that is turned away from the points may leave the third control points of the sides outside the edges.
    """
    if not isinstance(design, UnifiedSection | UnifiedBlade):
        return design
    for _ in range(TIMES):
        if _has_shape(design):
            break
        values = design.parameters()
        ends = tuple(f"{name}[{place}]" for name in THICKNESSES for place in (0, len(getattr(design, name)) - 1))
        design = design.changed({path: THINNER * value for path, value in values.items() if path.startswith(ends)})
    return design


def _has_shape(design: UnifiedSection | UnifiedBlade) -> bool:
    try:
        with np.errstate(all="ignore"):
            return model_of(design, COARSEST).shape(design).finite
    except DesignError:
        return False
