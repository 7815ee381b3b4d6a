"""Laws of the unified family from slices of a blade."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bladewright.fitting.initial_guess.slices import PLACES, STEEPEST, Slices
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis

LIMITS = {
    "stagger": (-STEEPEST, STEEPEST),
    "metal_angle_in": (-STEEPEST, STEEPEST),
    "metal_angle_out": (-STEEPEST, STEEPEST),
    "tangent_in": (0.05, 0.95),
    "tangent_out": (0.05, 0.95),
    "leading_edge_radius": (1e-3, 0.5),
    "trailing_edge_radius": (1e-3, 0.5),
}
"""limits of a first blade's laws, inside the family's own; angles in radians"""
THINNEST = 1e-3
"""smallest half thickness of a first blade, of the meridional length"""


def unified_numbers(
    slices: Slices, chordwise: tuple[int, int], span: Mapping[str, int], scale: Reals | float
) -> dict[str, Any]:
    """Angles, tangents, radii and thicknesses of sections, as laws of `span` control points.

    `scale` (m, k) is the meridional length, in extents of the plane, at PLACES of each section.
    """
    line, v = slices.camber, slices.v
    scale = np.broadcast_to(scale, (len(v), len(PLACES)))
    chord, first, last = line[:, 3] - line[:, 0], line[:, 1] - line[:, 0], line[:, 3] - line[:, 2]
    extent = np.maximum(chord[:, 0], 0.02)
    radii = [each / scale[:, end] for each, end in zip(slices.radii, (0, -1), strict=True)]
    values = {
        "stagger": np.arctan2(chord[:, 1], extent),
        "metal_angle_in": np.arctan2(first[:, 1], np.maximum(first[:, 0], 1e-9)),
        "metal_angle_out": np.arctan2(last[:, 1], np.maximum(last[:, 0], 1e-9)),
        "tangent_in": np.sqrt(np.sum(first**2, axis=-1)) / extent,
        "tangent_out": np.sqrt(np.sum(last**2, axis=-1)) / extent,
        "leading_edge_radius": radii[0],
        "trailing_edge_radius": radii[1],
    }
    found: dict[str, Any] = {}
    for name, row in values.items():
        law = np.clip(fitted_law(np.clip(row, *LIMITS[name]), v, span.get(name, 1)), *LIMITS[name])
        found[name] = plain_law(np.degrees(law) if LIMITS[name][0] < 0.0 else law)
    for name, count in zip(("thickness_upper", "thickness_lower"), chordwise, strict=True):
        along = np.linalg.lstsq(law_basis(count, PLACES), (slices.half / scale).T, rcond=None)[0]
        laws = [np.maximum(fitted_law(row, v, span.get(name, 1)), THINNEST) for row in along]
        found[name] = tuple(plain_law(law) for law in laws)
    return found


def fitted_law(values: Reals, v: Reals, count: int) -> Reals:
    """Control points (count,) of the law nearest to values (m,) at v (m,)."""
    return np.asarray(np.linalg.lstsq(law_basis(count, v), values, rcond=None)[0])


def plain_law(law: Reals) -> float | tuple[float, ...]:
    """A law as designs hold it: a number, or control points."""
    return tuple(law.tolist()) if len(law) > 1 else float(law[0])
