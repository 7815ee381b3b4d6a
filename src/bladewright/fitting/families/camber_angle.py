"""Where a section by its camber angle begins, and which control points may be added."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import lsq_linear

from bladewright.fitting.families.section_samples import PLACES, SampledSection
from bladewright.fitting.models.planar import SINGLE_SECTION
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.laws import law_basis

ANGLES, THICKNESSES = 4, 4
"""control points of the camber angle and of the half thickness (`THICKNESSES`) to begin with"""
LEAST_HALF_THICKNESS = 0.1
"""smallest half thickness to begin with, of the largest: beside a round edge it may rise only so much."""
MOST_CONTROL_POINTS = 14
"""control points of either law at most; it bounds the time of growth."""
_FEW, _ANGLES = (0.02,) * THICKNESSES, (0.0,) * ANGLES
TEMPLATES = (
    CamberAngle(camber_angle=_ANGLES, half_thickness=_FEW),
    CamberAngle(camber_angle=_ANGLES, half_thickness=_FEW, trailing_edge="blunt"),
    CamberAngle(camber_angle=_ANGLES, half_thickness=_FEW, trailing_edge="sharp"),
)
"""structures that are tried where none is given: one for each kind of trailing edge"""


def templates(section: SampledSection, parameters: int | None) -> Sequence[CamberAngle]:  # noqa: ARG001 - the contract's
    """Structures that are tried where none is given."""
    return TEMPLATES


def starts(section: SampledSection, like: CamberAngle) -> Sequence[CamberAngle]:
    """The part of a structure nearest to a section."""
    return [_start(section, like)]


def _start(section: SampledSection, like: CamberAngle) -> CamberAngle:
    """The part of a structure nearest to a section, by least squares of its angle and its half thickness."""
    fraction = _fractions(section, PLACES)
    slope = np.arctan(section.mean(PLACES, 1))
    rows = law_basis(len(like.camber_angle), fraction)
    angles = np.degrees(section.stagger + np.linalg.lstsq(rows, slope, rcond=None)[0])
    heights = _heights(like, fraction, section.half)
    return replace(
        like,
        camber_angle=tuple(float(np.clip(each, -88.0, 88.0)) for each in angles),
        half_thickness=tuple(heights.tolist()),
    )


def _fractions(section: SampledSection, u: Reals) -> Reals:
    """Fractions of the meridional extent at chord fractions."""
    cosine, sine = np.cos(section.stagger), np.sin(section.stagger)
    return np.asarray((u * cosine - section.mean(u) * sine) / cosine)


def _heights(like: CamberAngle, fraction: Reals, half: Reals) -> Reals:
    """Control points of the half thickness, with their places and weights held."""
    plain = replace(like, half_thickness=tuple(0.01 for _ in like.half_thickness))
    outline = plain.outline(SINGLE_SECTION)
    weights, places = (np.real(each.controls)[0] for each in (outline.weights, outline.places))
    t = np.linspace(0.0, 1.0, 201)
    rows = law_basis(len(weights), t)
    total = rows @ weights
    at = (rows @ places) / total
    count = len(like.half_thickness)
    matrix = (rows * weights)[:, 1 : 1 + count] / total[:, None]
    least = max(1e-3, LEAST_HALF_THICKNESS * float(np.max(half)))
    wanted = np.interp(at, fraction, half, left=0.0)
    return np.asarray(lsq_linear(matrix, wanted, bounds=(least, 0.39)).x)


def extensions(part: CamberAngle, section: SampledSection) -> Sequence[CamberAngle]:  # noqa: ARG001 - what every family answers
    """The part with one control point more of the angle or of the half thickness, or with free places or weights."""
    found = []
    if len(part.camber_angle) < MOST_CONTROL_POINTS:
        at = np.linspace(0.0, 1.0, 101)
        angles = law_basis(len(part.camber_angle), at) @ np.array(part.camber_angle)
        wider = np.linalg.lstsq(law_basis(len(part.camber_angle) + 1, at), angles, rcond=None)[0]
        found.append(replace(part, camber_angle=tuple(wider.tolist())))
    if len(part.half_thickness) < MOST_CONTROL_POINTS and not part.thickness_places and not part.thickness_weights:
        outline = part.outline(SINGLE_SECTION)
        t = np.linspace(0.0, 1.0, 401)
        places, heights = (
            law_basis(each.controls.shape[-1], t) @ np.real(each.controls)[0]
            for each in (outline.places, outline.heights)
        )
        more = replace(part, half_thickness=(*part.half_thickness, part.half_thickness[-1]))
        wider = _heights(more, places, heights)
        found.append(replace(more, half_thickness=tuple(wider.tolist())))
    if not part.thickness_places:
        found.append(replace(part, thickness_places=_inner_places(part)))
    elif not part.thickness_weights:
        found.append(replace(part, thickness_weights=(1.0,) * len(part.half_thickness)))
    return found


def _inner_places(part: CamberAngle) -> tuple[float, ...]:
    """The places of the control points of the half thickness that are not at an edge."""
    outline = part.outline(SINGLE_SECTION)
    at = np.real(outline.places.controls / outline.weights.controls)[0]
    return tuple(at[2 : -2 if part.trailing_edge == "round" else -1].tolist())
