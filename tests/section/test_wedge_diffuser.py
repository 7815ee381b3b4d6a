"""Vanes of wedge diffusers: straight sides and circles in touch, of the radii and the angle asked for."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.numerics.elementary import cross2
from bladewright.section.laws import Span
from bladewright.section.wedge_diffuser import CORNER, EDGE, FACE, WedgeDiffuser
from machines.suction_pressure import TEARDROP, WEDGE

from .one_sided import one_sided

SPAN = Span(np.zeros(1))
VANES = {"face": WEDGE, "circles": TEARDROP}


@pytest.fixture(params=list(VANES))
def vane(request):
    return VANES[request.param]


def upper(vane, start, end):
    return vane.outline(SPAN).points(np.linspace(start, end, 201))[0][0]


def arc_end(vane):
    return 1.0 if vane.wedge_angle is None else FACE


def half_angle(vane):
    side = upper(vane, EDGE, CORNER)
    along = side[-1] - side[0]
    return np.arctan2(along[1], along[0])


def test_the_edges_are_circles_of_the_radii_asked_for(vane):
    nose = upper(vane, 0.0, EDGE)
    assert np.hypot(nose[:, 0] - vane.leading_edge_radius, nose[:, 1]) == pytest.approx(
        vane.leading_edge_radius, rel=1e-14
    )
    corner, radius = upper(vane, CORNER + 1e-9, arc_end(vane)), vane.trailing_edge_radius
    centre = np.array([1.0 - radius, corner[-1, 1]])
    # coordinates near one, a radius of a fiftieth
    assert np.linalg.norm(corner - centre, axis=-1) == pytest.approx(radius, rel=1e-13)


def test_the_sides_are_straight_at_the_angle_asked_for(vane):
    side = upper(vane, EDGE, CORNER)
    along = side[-1] - side[0]
    assert cross2(along / np.linalg.norm(along), side - side[0]) == pytest.approx(0.0, abs=1e-15)
    assert np.all(np.diff(side[:, 0]) > 0.0)
    if vane.wedge_angle is not None:
        assert 2.0 * np.degrees(half_angle(vane)) == pytest.approx(vane.wedge_angle, abs=1e-12)


def test_sides_and_circles_touch(vane):
    angle = half_angle(vane)
    normal = np.array([-np.sin(angle), np.cos(angle)])
    side = upper(vane, EDGE, CORNER)
    first = np.array([vane.leading_edge_radius, 0.0])
    assert side[0] == pytest.approx(first + vane.leading_edge_radius * normal, abs=1e-15)
    top = 0.0 if vane.wedge_angle is None else upper(vane, FACE, 1.0)[0, 1]
    last = np.array([1.0 - vane.trailing_edge_radius, top])
    assert side[-1] == pytest.approx(last + vane.trailing_edge_radius * normal, abs=1e-15)


def test_without_a_wedge_angle_it_is_that_of_the_line_that_touches_both_circles():
    first, last = TEARDROP.leading_edge_radius, TEARDROP.trailing_edge_radius
    assert np.sin(half_angle(TEARDROP)) == pytest.approx((last - first) / (1.0 - first - last), rel=1e-13)


def test_the_back_face_stands_across_the_chord_line():
    face = upper(WEDGE, FACE, 1.0)
    assert np.all(face[:, 0] == 1.0)
    assert np.all(np.diff(face[:, 1]) < 0.0)
    assert face[-1, 1] == 0.0


def test_the_tangent_is_continuous_by_s(vane):
    outline = vane.outline(SPAN)
    for joint in outline.joints:
        (before, rounding), (after, as_well) = (
            one_sided(lambda s: outline.points(s)[0][0], joint.s, step, 1) for step in (-0.02, 0.02)
        )
        assert np.max(np.fabs(before - after)) < rounding + as_well


def test_a_wedge_close_to_that_of_both_circles_has_no_back_face_left():
    angle = 2.0 * np.degrees(half_angle(TEARDROP))
    near = WedgeDiffuser(
        stagger_angle=65.0, leading_edge_radius=0.01, trailing_edge_radius=0.08, wedge_angle=angle * (1.0 + 1e-9)
    )
    assert 0.0 < upper(near, FACE, 1.0)[0, 1] < 1e-9
    with pytest.raises(DesignError, match=r"wedge_angle is 8.*need more than 8.*leave wedge_angle out"):
        near.changed("wedge_angle", angle * (1.0 - 1e-3)).outline(SPAN)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wedge_angle": -1.0}, "wedge_angle is -1"),
        ({"leading_edge_radius": 0.0}, "leading_edge_radius is 0"),
        ({"trailing_edge_radius": 0.5}, "trailing_edge_radius is 0.5"),
        ({"stagger_angle": 95.0}, "stagger_angle is 95"),
    ],
    ids=str,
)
def test_what_makes_no_vane_is_refused(change, message):
    with pytest.raises(DesignError, match=message):
        WEDGE.changed(change)
