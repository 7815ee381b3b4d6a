"""Pictures of what a design builds, drawn with matplotlib: a sheet for the engineer and a view of the blade alone."""

from bladewright.views.picture import blade_view, picture

__all__ = ["blade_view", "picture"]
