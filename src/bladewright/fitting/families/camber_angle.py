"""Where a section by its camber angle begins."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import lsq_linear

from bladewright.fitting.families.section_shape import PLACES, SectionShape
from bladewright.fitting.models.planar import SINGLE_SECTION
from bladewright.section.camber_angle import ANGLE, HALF_THICKNESS, CamberAngle
from bladewright.section.laws import law_basis

TEMPLATES = tuple(
    CamberAngle(camber_angle=(0.0,) * 4, half_thickness=(0.02,) * 5, trailing_edge=edge)
    for edge in ("round", "blunt", "sharp")
)
"""parts whose structures are tried where none is given: one for each kind of trailing edge"""


def first_parts(shape: SectionShape, like: CamberAngle | None) -> Sequence[CamberAngle]:
    """The parts nearest to a section by least squares of its angle and of its half thickness."""
    return [_first(shape, each) for each in (TEMPLATES if like is None else [like])]


def _first(shape: SectionShape, like: CamberAngle) -> CamberAngle:
    # fractions of the meridional extent
    fraction = PLACES - shape.camber(PLACES) * np.tan(shape.stagger)
    rows = law_basis(len(like.camber_angle), np.clip(fraction, 0.0, 1.0))
    angles = np.degrees(shape.stagger + np.linalg.lstsq(rows, shape.angles(PLACES), rcond=None)[0])
    half = shape.half(PLACES)
    outline = replace(like, half_thickness=(0.01,) * len(like.half_thickness)).outline(SINGLE_SECTION)
    weights, places = (np.real(each.controls)[0] for each in (outline.weights, outline.places))
    rows = law_basis(len(weights), np.linspace(0.0, 1.0, 2 * len(half)))
    at, shares = rows @ places / (rows @ weights), rows * weights / (rows @ weights)[:, None]
    free = shares[:, 1 : 1 + len(like.half_thickness)]
    # beside a round edge the half thickness is far above what is left of it further on
    limits = 0.1 * float(np.max(half)), 0.99 * HALF_THICKNESS.high
    heights = lsq_linear(free, np.interp(at, fraction, half), bounds=limits).x
    return replace(
        like,
        camber_angle=tuple(np.clip(angles, 0.99 * ANGLE.low, 0.99 * ANGLE.high).tolist()),
        half_thickness=tuple(heights.tolist()),
    )
