"""The prismatic blade of a 2D section: a linear cascade between two planes."""

from bladewright.blade.channel import Channel
from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Point
from bladewright.errors import DesignError
from bladewright.section.unified import UnifiedSection

WIDE = 1e3
"""pitch of a section that has none, in axial chords"""


def prismatic(section: UnifiedSection, span: float | None = None) -> UnifiedBlade:
    """The design of the blade that a section becomes when drawn along z, `span` high [length].

    Raises DesignError where neither the call nor the section has a span.
    """
    height = section.span if span is None else span
    if height is None:
        raise DesignError("span is missing: a section becomes a solid by its height; set span in the design")
    start, end = section.leading_edge_x, section.leading_edge_x + section.axial_chord
    same = {
        name: getattr(section, name)
        for name in (
            "name",
            "length_unit",
            "leading_edge_y",
            "stagger",
            "metal_angle_in",
            "metal_angle_out",
            "tangent_in",
            "tangent_out",
            "leading_edge_radius",
            "trailing_edge_radius",
            "thickness_upper",
            "thickness_lower",
            "weights_upper",
            "weights_lower",
            "samples",
            "clustering",
            "description",
            "author",
            "organisation",
        )
    }
    return UnifiedBlade(
        **same,
        arrangement="linear",
        pitch=WIDE * section.axial_chord if section.pitch is None else section.pitch,
        channel=Channel(
            leading_edge=(Point(start, 0.0), Point(start, height)), trailing_edge=(Point(end, 0.0), Point(end, height))
        ),
    )
