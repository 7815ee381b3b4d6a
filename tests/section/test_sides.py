"""Sides of a section: edge radii, metal angles and the smooth meeting of the sides, for random laws."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from bladewright.section.camber import camber_line, camber_tangents
from bladewright.section.laws import Span
from bladewright.section.unified_sides import (
    matched,
    plane_sections,
    reparametrised,
    sample_places,
    side,
    side_curve,
    taylor,
)

ANGLES = st.floats(-1.0, 1.0)
RADII = st.floats(1e-3, 0.05)
THICK = st.floats(0.05, 0.1)
WEIGHTS = st.sampled_from([None, (1.0,), (0.6, 1.8, 0.9), (2.0, 0.7)])


def sections(stagger, angle_in, angle_out, radius_in, radius_out, thickness, weights=None, samples=12, clustering=0.8):
    """One section: camber, sides, and the section with its common parametrisation."""
    span = Span(np.zeros(1))
    one = np.ones(1)
    line = camber_line(0.0 * one, one, stagger * one, angle_in * one, angle_out * one, 0.35 * one, 0.35 * one)
    places = sample_places(samples, clustering)
    half = span.chordwise(thickness, places[2:-2])
    law = None if weights is None else span.chordwise(weights, places)
    sides = [
        side(line, places, half, one / radius_in, one / radius_out, upper=upper, weights=law) for upper in (True, False)
    ]
    return line, sides, plane_sections(line, *matched(*sides))


def radius_at(curve, u):
    first, second = curve.derivative(u), curve.derivative(u, 2)
    bend = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return np.sum(first**2, axis=-1) ** 1.5 / np.abs(bend)


@settings(max_examples=60, deadline=None)
@given(ANGLES, RADII, RADII, THICK, THICK, WEIGHTS)
def test_both_sides_have_the_edge_radii_asked_for(turn, radius_in, radius_out, first, last, weights):
    _, sides, _ = sections(turn / 2, turn, turn / 3, radius_in, radius_out, (first, 0.1, last), weights)
    for controls in sides:
        curve = side_curve(controls[0])
        assert radius_at(curve, 0.0) == pytest.approx(radius_in, rel=1e-9)
        assert radius_at(curve, 1.0) == pytest.approx(radius_out, rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(ANGLES, RADII, RADII, THICK, THICK, WEIGHTS)
def test_across_an_edge_first_derivatives_are_opposite_and_second_ones_equal(
    turn, radius_in, radius_out, a, b, weights
):
    _, _, section = sections(turn / 2, turn, turn / 3, radius_in, radius_out, (a, 0.1, b), weights)
    for edge, from_end in ((section.leading_edge, False), (section.trailing_edge, True)):
        derivatives = []
        for controls, (alpha, beta) in ((section.upper, edge.upper), (section.lower, edge.lower)):
            series = taylor(controls, from_end)[0]
            derivatives.append((alpha * series[1], 2.0 * alpha**2 * series[2] + beta * series[1]))
        (first_upper, second_upper), (first_lower, second_lower) = derivatives
        assert first_lower == pytest.approx(-first_upper, rel=1e-9, abs=1e-12 * np.max(np.abs(first_upper)))
        assert second_lower == pytest.approx(second_upper, rel=1e-7, abs=1e-9 * np.max(np.abs(second_upper)))


@settings(max_examples=60, deadline=None)
@given(ANGLES, st.floats(2e-5, 0.05), THICK, st.floats(0.01, 0.1))
def test_the_common_parameter_runs_forward_along_both_sides(turn, radius, first, last):
    _, _, section = sections(turn / 2, turn, turn / 3, radius, radius / 3, (first, 0.1, last))
    s = np.linspace(0.0, section.span, 400)
    for edge in (section.leading_edge, section.trailing_edge):
        for alpha, beta in (edge.upper, edge.lower):
            assert np.all(np.diff(reparametrised(s, alpha, beta, section.span)) > 0.0)


def test_the_common_parameter_leaves_the_sides_shape_alone():
    _, sides, section = sections(0.4, 0.9, -0.3, 0.01, 0.004, (0.06, 0.1, 0.05))
    for points, controls in zip(section.points(np.linspace(0.0, 1.0, 301)), sides, strict=True):
        dense = side_curve(controls[0])(np.linspace(0.0, 1.0, 40001))
        distance = cKDTree(dense).query(points[0])[0]
        # half the spacing of the dense points bounds what a point on the curve can be away from them
        assert np.max(distance) < 0.51 * np.max(np.linalg.norm(np.diff(dense, axis=0), axis=-1))


@pytest.mark.parametrize("angle", [-1.3, -0.4, 0.0, 0.7, 1.4])
def test_the_camber_leaves_its_ends_at_the_metal_angles(angle):
    one = np.ones(1)
    line = camber_line(0.3 * one, 2.0 * one, 0.2 * one, angle * one, -angle / 2 * one, 0.3 * one, 0.6 * one)
    tangents = camber_tangents(line, np.array([0.0, 1.0]))[0]
    assert np.arctan2(tangents[:, 1], tangents[:, 0]) == pytest.approx([angle, -angle / 2], abs=1e-14)
    assert np.arctan2(*(line[0, 3] - line[0, 0])[::-1]) == pytest.approx(0.2, abs=1e-14)


def test_samples_are_the_papers_for_no_clustering():
    places = sample_places(8, 0.0)
    count = len(places) - 1
    expected = [0.0, *[(i - 1) / (count - 2) for i in range(1, count)], 1.0]
    assert places == pytest.approx(expected, abs=1e-15)
