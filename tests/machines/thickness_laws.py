"""Thickness laws that the shared tests ask the same questions, by a name that says what is particular."""

from bladewright.section.thickness.law import ThicknessLaw
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

NACA = ModifiedNaca(
    leading_edge_index=5.5, maximum_thickness=0.1, maximum_thickness_at=0.42, trailing_edge_thickness=0.014
)
WENNERSTROM = Wennerstrom(
    maximum_thickness=0.08, maximum_thickness_at=0.38, leading_edge_thickness=0.024, trailing_edge_thickness=0.016
)
QUARTIC = QuarticSpline(
    maximum_thickness=0.085, maximum_thickness_at=0.3, leading_edge_thickness=0.028, trailing_edge_thickness=0.02
)

LAWS: dict[str, ThicknessLaw] = {
    "modified NACA": NACA,
    "modified NACA, evolving": NACA.changed(
        {
            "maximum_thickness": (0.12, 0.08, 0.04),
            "trailing_edge_thickness": (0.02, 0.002),
            "maximum_thickness_at": (0.4, 0.58),
            "leading_edge_index": (3.0, 8.0),
        }
    ),
    "modified NACA of a given slope": NACA.changed("trailing_edge_slope", -0.18),
    "modified NACA of a given slope factor": NACA.changed("trailing_edge_slope_factor", (1.6, 1.9)),
    "modified NACA with a blunt trailing edge": NACA.changed("trailing_edge", "blunt"),
    "modified NACA with a sharp trailing edge": NACA.changed(
        {"trailing_edge": "sharp", "trailing_edge_thickness": None}
    ),
    "Wennerstrom": WENNERSTROM,
    "Wennerstrom, evolving": WENNERSTROM.changed(
        {"straight_end": "leading", "maximum_thickness_at": (0.4, 0.5, 0.6), "leading_edge_ratio": (1.0, 2.0, 3.5)}
    ),
    "Wennerstrom with the maximum behind": WENNERSTROM.changed("maximum_thickness_at", 0.6),
    "Wennerstrom with a blunt trailing edge": WENNERSTROM.changed(
        {"trailing_edge": "blunt", "trailing_edge_ratio": None}
    ),
    "Wennerstrom with sharp edges": Wennerstrom(
        maximum_thickness=0.05, maximum_thickness_at=0.45, leading_edge="sharp", trailing_edge="sharp"
    ),
    "Wennerstrom with a sharp leading edge": Wennerstrom(
        maximum_thickness=0.05, maximum_thickness_at=0.55, leading_edge="sharp", trailing_edge_thickness=0.01
    ),
    "quartic spline": QUARTIC,
    "quartic spline, evolving": QUARTIC.changed(
        {"maximum_thickness": (0.12, 0.09), "leading_edge_curvature": (0.03, 0.05), "maximum_thickness_at": (0.3, 0.25)}
    ),
    "quartic spline with a rounded trailing edge": QUARTIC.changed("trailing_edge_curvature", 0.02),
    "quartic spline with a sharp trailing edge": QUARTIC.changed(
        {"trailing_edge": "sharp", "trailing_edge_thickness": 0.01, "trailing_edge_curvature": None}
    ),
}
