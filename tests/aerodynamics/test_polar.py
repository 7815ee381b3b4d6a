"""Polars by the real XFOIL: the published figures, references, marches and what goes wrong."""

import numpy as np
import pytest

import bladewright as bw

from .conftest import NACA_23012

TABLE_14 = (0.0126, 0.1697, 0.3218, 0.0592, -0.0073, 0.0182)
"""lift of the six segments of NACA 23012 at Re 3.5e6 and 4 deg (Tortora et al. 2023, table 14)"""
FRICTION = (0.00068, 0.00161, 0.00120, 0.00045, 0.00023, 0.00018)
"""drag by friction of the same"""


def test_naca_23012_has_the_lift_and_drag_of_the_paper(polar):
    at = int(np.argmax(polar.alpha))
    assert polar.cl[at] == pytest.approx(0.5743, rel=0.01)
    assert polar.cd[at] == pytest.approx(0.00601, rel=0.03)
    assert polar.cdp[at] == pytest.approx(0.00166, abs=2e-5)


def test_its_segments_have_the_lift_and_friction_of_table_14(polar):
    segments = polar.segments(4.0)
    assert np.sum(segments.lift_pressure) == pytest.approx(polar.cl[-1], abs=1e-3)
    assert segments.lift_pressure[:6] == pytest.approx(TABLE_14, abs=0.003)
    assert segments.drag_friction[:6] == pytest.approx(FRICTION, abs=1e-4)
    assert np.sum(segments.drag_friction) + polar.cdp[-1] == pytest.approx(polar.cd[-1], abs=1e-9)


@pytest.mark.usefixtures("xfoil")
def test_an_angle_has_the_same_figures_alone(polar, section):
    alone = bw.polar(section, 3.5e6, 4.0)
    assert (alone.cl[0], alone.cd[0], alone.cm[0]) == (polar.cl[-1], polar.cd[-1], polar.cm[-1])


@pytest.mark.usefixtures("xfoil")
def test_a_reference_length_of_one_metre_gives_the_figures_of_table_16():
    section = NACA_23012.changed("chord", 0.245).build()
    found = bw.polar(section, 2.0394e6, 4.0, reference_length=1.0, moment_point=0.25 / 0.245)
    assert found.cl[0] == pytest.approx(0.1586, rel=0.01)
    assert found.cd[0] == pytest.approx(0.00252, rel=0.03)
    assert found.cm[0] == pytest.approx(0.0284, rel=0.02)
    by_chord = bw.polar(section, 2.0394e6 * 0.245, 4.0)
    assert found.cl[0] == pytest.approx(by_chord.cl[0] * 0.245, rel=1e-12)
    assert np.sum(found.segments(4.0).lift_pressure) == pytest.approx(found.cl[0], abs=1e-4)
