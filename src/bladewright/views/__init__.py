"""Pictures of what a design builds, drawn with matplotlib: sheets, views of a blade or passage, and report pages."""

from bladewright.views.part import part_view
from bladewright.views.picture import blade_view, passage_view, picture
from bladewright.views.report import report

__all__ = ["blade_view", "part_view", "passage_view", "picture", "report"]
