"""Kinds of designs as a search sees them: their sides, the derivatives of these, and what is refused."""

from bladewright.fitting.models import designs

__all__ = ["designs"]
