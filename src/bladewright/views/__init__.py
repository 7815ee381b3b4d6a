"""Pictures of what a design builds, drawn with matplotlib: sheets for the engineer, and views of a blade or passage."""

from bladewright.views.picture import blade_view, passage_view, picture

__all__ = ["blade_view", "passage_view", "picture"]
