"""Kinds of designs as a search sees them: their sides, the derivatives of these, and what is refused."""

from bladewright.fitting.models import designs
from bladewright.fitting.models.model import Model, ModelShape, model_of

__all__ = ["Model", "ModelShape", "designs", "model_of"]
