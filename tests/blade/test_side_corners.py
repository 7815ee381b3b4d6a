"""Corners that published profiles leave on the sides, over which no ball rolls."""

import numpy as np
import pytest

from bladewright.blade.design.fillet import Fillet
from bladewright.blade.native.side_corners import side_corner
from bladewright.errors import DesignError
from bladewright.files.changing import changed_design
from bladewright.files.reading import parsed
from bladewright.files.templates import template_text


@pytest.fixture(scope="module")
def propeller():
    return changed_design(parsed(template_text("propeller"), "propeller.toml"), "propeller.toml", {"tolerance": 1e-4})


def test_the_corner_of_a_four_digit_profile_is_that_of_its_mean_lines_jump(propeller):
    # sides turn by the jump of curvature times the slope of the thickness, at y of the half thickness
    x, t, m, p = 0.4, 0.2, 0.04, 0.4
    slope = 5 * t * (0.2969 / (2 * np.sqrt(x)) - 0.1260 - 0.7032 * x + 0.8529 * x**2 - 0.4060 * x**3)
    half = 5 * t * (0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4)
    jump = 2 * m * (1 / p**2 - 1 / (1 - p) ** 2)
    side, u, angle = side_corner(propeller.changed("section.camber_position", p).build())
    assert u == 0.5
    assert side in {"upper", "lower"}
    # 10 %: the hub is round, and the section twisted
    assert angle == pytest.approx(abs(half * jump * slope), rel=0.1)


def test_a_fillet_is_laid_where_the_mean_line_has_no_jump_and_told_why_not_elsewhere(propeller):
    design = propeller.changed("hub_fillet", Fillet(radius=0.01))
    assert side_corner(propeller.build()) is None
    assert "hub_fillet_upper" in design.build().surfaces
    with pytest.raises(
        DesignError, match=r"corner of 0.1 deg at u = 0.500, over which no ball rolls.*camber_position = 0.5"
    ):
        design.changed("section.camber_position", 0.4).build()
