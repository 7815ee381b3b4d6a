"""Alignment: the rigid motion of a cloud that lies anywhere into the machine's axes."""

from bladewright.fitting.alignment.registration import (
    Registration,
    improved,
    registered,
    registration,
)
from bladewright.fitting.alignment.rigid import FREEDOMS, PLANE_FREEDOMS, SEPARABLE, composed, inverted

__all__ = [
    "FREEDOMS",
    "PLANE_FREEDOMS",
    "SEPARABLE",
    "Registration",
    "composed",
    "improved",
    "inverted",
    "registered",
    "registration",
]
