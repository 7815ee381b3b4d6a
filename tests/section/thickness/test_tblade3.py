"""Thicknesses that T-Blade3 computed, at its own stations."""

from pathlib import Path

import numpy as np
import pytest

from bladewright.section.laws import Span
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

DATA = Path(__file__).parents[4] / "shared" / "data" / "tblade3"
pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason="T-Blade3's outputs are not here (../shared/data)")
MIDDLE = Span(np.zeros(1))


def table(case: str, pattern: str, **options) -> np.ndarray:
    return np.loadtxt(next((DATA / case / "output").glob(pattern)), **options)


@pytest.mark.parametrize("case", ["Case7-28-8_Rotor", "Case7-28-8_IGV", "NACA_thickness_with_derivative"])
def test_modified_naca_thickness(case):
    for n, (_, index, at, maximum, end, *steep) in enumerate(table(case, "thickness_span_variation.*"), 1):
        law = ModifiedNaca(
            leading_edge_index=index,
            maximum_thickness_at=at,
            maximum_thickness=maximum,
            trailing_edge_thickness=end,
            trailing_edge_slope=steep[0] if steep else None,
        )
        u, full, slope, _ = table(case, f"thickness_data.{n}.*").T
        thickness = law.at(MIDDLE)
        np.testing.assert_allclose(2.0 * thickness.half_at(u)[0], full, atol=1e-12, rtol=0)
        inner = u[(u > 0.05) & (u < 0.9)]
        change = (thickness.half_at(inner + 1e-6) - thickness.half_at(inner - 1e-6))[0] / 2e-6
        np.testing.assert_allclose(change, slope[(u > 0.05) & (u < 0.9)], atol=1e-8)


def test_wennerstrom_thickness_with_elliptic_edges():
    case = "Wennerstrom_r37_v1.2.5"
    for n, (at, maximum) in enumerate(table(case, "thickness_span_variation.*"), 1):
        law = Wennerstrom(
            maximum_thickness=maximum,
            maximum_thickness_at=at,
            leading_edge_thickness=0.02,
            trailing_edge_thickness=0.02,
        )
        u, half = table(case, f"thickness_data.{n}.*").T
        np.testing.assert_allclose(law.at(MIDDLE).half_at(u)[0], half, atol=1e-12, rtol=0)


@pytest.mark.parametrize(
    ("case", "section", "maximum", "leading", "trailing"),
    [
        ("quartic_spline_thickness_rotor_v1.2.2", 1, 0.085, 0.028, 0.02),
        ("LE_spline_turb4_v1.2.2", 1, 0.13, 0.08, 0.05),
        ("LE_spline_turb4_v1.2.2", 2, 0.08, 0.07, 0.05),
    ],
)
def test_quartic_spline_thickness(case, section, maximum, leading, trailing):
    law = QuarticSpline(
        maximum_thickness=maximum,
        maximum_thickness_at=0.3,
        leading_edge_thickness=leading,
        trailing_edge_thickness=trailing,
    )
    pattern = f"splthickness_tec.{section}.*"
    controls = table(case, pattern, skiprows=2, max_rows=11)
    for found, printed in zip(law.control_points(MIDDLE), controls.T[:2], strict=True):
        np.testing.assert_allclose(found[0], printed, atol=1e-12)
    u, upper, _, lower = table(case, pattern, skiprows=15).T
    # T-Blade3 finds its parameter to about 1e-12, whose root counts at the trailing edge
    np.testing.assert_allclose(law.at(MIDDLE).half_at(u)[0], 0.5 * (upper - lower), atol=1e-6, rtol=0)
