"""Alignment: the rigid motion of a cloud that lies anywhere into the machine's axes."""

from bladewright.fitting.alignment.axes import Found, Uncertainty, found_axes
from bladewright.fitting.alignment.registration import (
    Registration,
    aligned_section,
    aligned_to,
    improved,
    refined,
    registered,
    registration,
)
from bladewright.fitting.alignment.rigid import FREEDOMS, PLANE_FREEDOMS, SEPARABLE, composed, inverted

__all__ = [
    "FREEDOMS",
    "PLANE_FREEDOMS",
    "SEPARABLE",
    "Found",
    "Registration",
    "Uncertainty",
    "aligned_section",
    "aligned_to",
    "composed",
    "found_axes",
    "improved",
    "inverted",
    "refined",
    "registered",
    "registration",
]
