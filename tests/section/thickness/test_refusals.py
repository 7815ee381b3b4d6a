"""What a thickness law cannot be: each refusal names path, value, limit and cure."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.section.laws import Span
from machines.thickness_laws import NACA, QUARTIC, WENNERSTROM

SPAN = Span(np.array([0.0, 1.0]))

CASES = [
    (NACA, {"maximum_thickness": (0.1, -0.1)}, r"maximum_thickness\[1\] is -0.1: it must be between 0 and 1 chord"),
    (NACA, {"maximum_thickness_at": 1.2}, "maximum_thickness_at is 1.2: the maximum must stand between"),
    (NACA, {"leading_edge_index": 0.0}, "leading_edge_index is 0: it must be between 0 and 12"),
    (NACA, {"trailing_edge_thickness": (0.01, 0.2)}, "edge_thickness is 0.2 at span fraction 1: it must be below"),
    (NACA, {"trailing_edge_thickness": None}, "is not given for a circular trailing edge: give it, or set"),
    (NACA, {"trailing_edge": "sharp"}, "is given for a sharp trailing edge: leave it out"),
    (NACA, {"trailing_edge": "round"}, "it must be one of circular, blunt, sharp"),
    (NACA, {"trailing_edge_slope": 0.1}, "trailing_edge_slope is 0.1: the blade must not grow thicker"),
    (NACA, {"trailing_edge_slope": -0.1, "trailing_edge_slope_factor": 1.0}, "both given: they say the same"),
    (NACA, {"trailing_edge_slope": -2.0}, "the rear would bulge instead; move it forward"),
    (NACA, {"maximum_thickness": 0.3, "maximum_thickness_at": 0.9, "trailing_edge_thickness": 0.28,
            "trailing_edge_slope": -0.01}, "must stand before the trailing edge's circle"),
    (NACA, {"leading_edge_index": 0.2, "maximum_thickness_at": 0.7, "trailing_edge_thickness": 0.001,
            "trailing_edge_slope": -0.01}, "gives a half thickness of -.* it must be positive; raise"),
    (WENNERSTROM, {"leading_edge_thickness": 0.09}, "leading_edge_thickness is 0.09 at span fraction 0: the thickness"),
    (WENNERSTROM, {"trailing_edge_ratio": 0.0}, "trailing_edge_ratio is 0: it must be positive"),
    (WENNERSTROM, {"leading_edge": "blunt"}, "leading_edge_ratio is given, but .* is blunt: leave it out"),
    (WENNERSTROM, {"leading_edge": "sharp", "leading_edge_ratio": None}, "leading_edge_thickness is given, but"),
    (WENNERSTROM, {"trailing_edge_thickness": None}, "trailing_edge_thickness is not given, but"),
    (WENNERSTROM, {"maximum_thickness_at": (0.4, 0.6)}, "lies on both sides of 0.5: .* set straight_end"),
    (WENNERSTROM, {"maximum_thickness_at": 0.8, "straight_end": "trailing"}, "set straight_end to farther"),
    (QUARTIC, {"leading_edge_curvature": 0.0}, "leading_edge_curvature is 0: it must be positive"),
    (QUARTIC, {"trailing_edge_thickness": 0.1}, "trailing_edge_thickness is 0.1 at span fraction 0: it must be below"),
    (QUARTIC, {"trailing_edge_wedge_angle": 3.0}, "is given, but the trailing edge is closed: leave it out"),
    (QUARTIC, {"trailing_edge_curvature": -0.1}, "trailing_edge_curvature is -0.1: it must not be negative"),
    (QUARTIC, {"trailing_edge": "sharp", "trailing_edge_curvature": None, "trailing_edge_wedge_angle": 0.3},
     "the wedge must begin behind the maximum; widen"),
    (QUARTIC, {"maximum_thickness_at": 0.5}, "folds back at u = .* put the maximum near 0.3"),
]  # fmt: skip


@pytest.mark.parametrize(("law", "changes", "message"), CASES, ids=[case[2][:40] for case in CASES])
def test_a_law_that_cannot_be_is_refused(law, changes, message):
    with pytest.raises(DesignError, match=f"thickness.*{message}"):
        law.changed(changes).at(SPAN)
