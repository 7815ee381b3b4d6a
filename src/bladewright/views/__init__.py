"""Pictures of what a design builds, drawn with matplotlib: sheets, views of a blade or passage, and report pages."""

from bladewright.views.body import body_view
from bladewright.views.picture import blade_view, passage_view, picture
from bladewright.views.report import report

__all__ = ["blade_view", "body_view", "passage_view", "picture", "report"]
