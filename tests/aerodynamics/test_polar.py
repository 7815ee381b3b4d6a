"""Polars by the real XFOIL: the published figures, references, marches and what goes wrong."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import bladewright as bw
from bladewright.aerodynamics.xfoil_output import read_polar_dump
from bladewright.errors import PolarError
from machines.polars import DUMP

from .conftest import NACA_23012

SEGMENTED = Path(__file__).parent / "data" / "naca-23012-segmented.toml"
"""the segmented airfoil of 22 parameters that `bladewright fit` matches to NACA 23012 within 4e-5 chords"""
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
def test_the_morphed_airfoil_has_the_lift_and_drag_of_table_15():
    design = bw.read_design(SEGMENTED)
    droop = replace(design.section, morph=bw.Morph(leading_edge=4.0, trailing_edge=-15.0))
    morphed = replace(design, section=droop).build()
    # the paper's angle is from the x axis of the airfoil that was matched
    alpha = 4.0 - np.degrees(design.build().stagger)
    found = bw.polar(morphed, 3.5e6, alpha, reference_length=1.0)
    assert found.cl[0] == pytest.approx(1.5098, rel=0.03)
    assert found.cd[0] == pytest.approx(0.01724, rel=0.05)
    assert np.sum(found.segments(alpha).lift_pressure) == pytest.approx(found.cl[0], abs=1e-3)


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


@pytest.mark.usefixtures("xfoil")
def test_an_angle_that_does_not_converge_is_named_and_the_others_stay(section):
    found = bw.polar(section, 3.5e6, [4.0, 60.0], iterations=30)
    assert list(found.converged) == [True, False]
    assert found.failures == ("alpha 60: XFOIL did not converge in 30 iterations, with 160 or 200 panels",)
    with pytest.raises(PolarError, match=r"alpha is 60 deg: XFOIL 6\.99 did not converge there"):
        found.flow(60.0)
    with pytest.raises(PolarError, match="none of the polar's 2 angles"):
        found.flow(5.0)


@pytest.mark.usefixtures("xfoil")
def test_what_was_done_by_the_time_limit_is_kept(section):
    found = bw.polar(section, 3.5e6, np.linspace(-5.0, 15.0, 900), time_limit=0.5)
    assert 0 < np.count_nonzero(found.converged) < 900
    assert found.failures[-1].startswith("alpha 15: XFOIL was stopped at the time limit of 0.5 s")


@pytest.mark.usefixtures("xfoil")
def test_a_compressible_flow_has_more_lift_and_forced_transition_more_drag(polar, section):
    fast = bw.polar(section, 3.5e6, 0.0, mach=0.4)
    assert fast.cl[0] > 1.03 * polar.cl[1]
    tripped = bw.polar(section, 3.5e6, 0.0, transition=(0.1, 0.2))
    assert tripped.cd[0] > 1.3 * polar.cd[1]
    assert (tripped.transition_upper[0], tripped.transition_lower[0]) == pytest.approx((0.1, 0.2), abs=1e-3)


def test_moments_about_two_points_differ_by_the_normal_force(xfoil, polar, section):  # noqa: ARG001
    behind = bw.polar(section, 3.5e6, 4.0, moment_point=0.5)
    angle = np.radians(4.0)
    flow, nodes = polar.segments(4.0), polar.flow(4.0)
    normal = np.sum(flow.lift_pressure) * np.cos(angle) + np.sum(flow.drag_pressure) * np.sin(angle)
    assert behind.cm[0] - polar.cm[-1] == pytest.approx(0.25 * normal, abs=2e-5)
    assert nodes.alpha == 4.0


def test_cuts_out_of_order_are_refused(polar):
    for cuts in ((0.7, 0.3), (0.0, 0.5), (0.3,)):
        with pytest.raises(PolarError, match="two numbers x/c between 0 and 1"):
            polar.segments(4.0, cuts)


def test_segments_of_other_cuts_have_the_same_sum(polar):
    for name in ("lift_pressure", "drag_friction"):
        sums = [np.sum(getattr(polar.segments(4.0, cuts), name)) for cuts in ((0.3, 0.7), (0.1, 0.55))]
        assert sums[0] == pytest.approx(sums[1], rel=1e-3)


def test_a_neural_network_is_near_xfoil_and_says_what_it_is(polar, section):
    pytest.importorskip("neuralfoil", reason="NeuralFoil is not installed: pip install 'bladewright[polar]'")
    quick = bw.polar(section, 3.5e6, polar.alpha, solver="neuralfoil")
    np.testing.assert_allclose(quick.cl, polar.cl, atol=0.03)
    np.testing.assert_allclose(quick.cd, polar.cd, rtol=0.1)
    assert "neural network trained on XFOIL" in quick.remarks[-1]
    with pytest.raises(PolarError, match="gives no cp and cf; take solver='xfoil'"):
        quick.segments(4.0)


@pytest.mark.usefixtures("xfoil")
def test_first_use_on_a_fresh_account_works_from_several_processes_at_once(polar, section, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with ThreadPoolExecutor(3) as pool:
        found = list(pool.map(lambda _: bw.polar(section, 3.5e6, 4.0), range(3)))
    assert [each.cl[0] for each in found] == [polar.cl[-1]] * 3
    assert all(path.suffix == ".so" for path in tmp_path.glob("bladewright/*"))


def test_a_neural_network_s_airfoil_may_lie_off_its_chord_line():
    pytest.importorskip("neuralfoil", reason="NeuralFoil is not installed: pip install 'bladewright[polar]'")
    flow = read_polar_dump(DUMP)[1][0].flow
    plain = flow.x + 1j * flow.y
    turned = 0.9 * plain * np.exp(-1j * np.radians(3.0)) + 0.1 + 0.05j
    airfoils = [bw.Airfoil(points=np.stack([each.real, each.imag], axis=-1)) for each in (plain, turned)]
    there = bw.polar(airfoils[0], 0.9e6, 5.0, solver="neuralfoil", moment_point=0.0)
    here = bw.polar(airfoils[1], 1e6, 2.0, solver="neuralfoil", moment_point=0.1)
    assert here.cl[0] == pytest.approx(0.9 * there.cl[0], rel=1e-3)
    assert here.cd[0] == pytest.approx(0.9 * there.cd[0], rel=5e-3)
    # its leading edge is at (0.1, 0.05): the force along x turns the nose up about a point below
    angle = np.radians(2.0)
    up = 0.05 * (here.cd[0] * np.cos(angle) - here.cl[0] * np.sin(angle))
    assert here.cm[0] - 0.81 * there.cm[0] == pytest.approx(up, abs=2e-4)
