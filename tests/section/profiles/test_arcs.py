"""Profiles of circular arcs, and flat plates, against their closed forms."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.section.laws import Span
from bladewright.section.profiles.circular_arc import EDGE, DoubleCircularArc, MultipleCircularArc
from bladewright.section.profiles.flat_plate import FlatPlate

SPAN = Span(np.zeros(1))
DOUBLE = DoubleCircularArc(thickness=0.08, camber_angle=30.0, leading_edge_radius=0.004, trailing_edge_radius=0.004)
MULTIPLE = MultipleCircularArc(
    thickness=0.06, camber_angle=40.0, transition=0.6, front_camber=0.2, leading_edge_radius=0.004
)


def circle(points):
    """Centre and radius of the circle nearest to points (n, 2), and how far they lie off it."""
    matrix = np.column_stack([2.0 * points, np.ones(len(points))])
    a, b, c = np.linalg.lstsq(matrix, np.sum(points**2, axis=1), rcond=None)[0]
    centre, radius = np.array([a, b]), np.sqrt(c + a * a + b * b)
    return centre, radius, np.max(np.abs(np.linalg.norm(points - centre, axis=1) - radius))


def sides(profile, start, end):
    return [points[0] for points in profile.outline(SPAN).points(np.linspace(start, end, 101))]


@pytest.mark.parametrize("angle", [0.0, 20.0, -50.0, 90.0])
def test_a_sharp_double_arc_has_sides_of_the_sagitta_of_mean_line_and_thickness(angle):
    profile = DoubleCircularArc(thickness=0.06, camber_angle=angle)
    for points, sign in zip(sides(profile, 0.0, 1.0), (1.0, -1.0), strict=True):
        assert points[50] == pytest.approx([0.5, 0.5 * np.tan(np.radians(angle) / 4.0) + sign * 0.03], abs=1e-14)
        sagitta = points[50, 1]
        _, radius, off = circle(points)
        assert off < 1e-12 * radius
        assert radius == pytest.approx((0.25 + sagitta**2) / (2.0 * abs(sagitta)), rel=1e-9)
        assert points[[0, -1]] == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.0]]), abs=1e-14)


def test_each_side_of_a_double_arc_is_one_arc_that_touches_both_edge_circles():
    radius = 0.004
    half = np.radians(15.0)
    edges = [np.array([radius * np.cos(half), radius * np.sin(half)])]
    edges.append(np.array([1.0 - edges[0][0], edges[0][1]]))
    for points, sense in zip(sides(DOUBLE, EDGE, 1.0 - EDGE), (-1.0, 1.0), strict=True):
        centre, large, off = circle(points)
        assert off < 1e-12
        # the circle of a convex side holds the edge's inside, that of a concave one stands outside
        convex = centre[1] < points[50, 1] if sense < 0.0 else centre[1] > points[50, 1]
        for edge in edges:
            apart = np.linalg.norm(edge - centre)
            assert apart == pytest.approx(large - radius if convex else large + radius, rel=1e-10)


@pytest.mark.parametrize("profile", [DOUBLE, MULTIPLE], ids=lambda profile: profile.kind)
def test_a_round_edge_is_a_circle_whose_centre_lies_on_the_mean_lines_tangent(profile):
    line = profile.outline(SPAN).camber(np.array([0.0, 1e-6]))[0]
    tangent = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    for points in sides(profile, 0.0, EDGE):
        assert np.linalg.norm(points - 0.004 * tangent, axis=1) == pytest.approx(0.004, rel=1e-6)


@pytest.mark.parametrize("profile", [DOUBLE, MULTIPLE], ids=lambda profile: profile.kind)
def test_arcs_meet_with_one_tangent_and_one_speed(profile):
    outline = profile.outline(SPAN)
    step = 1e-6
    for joint in outline.joints:
        before, at, after = (outline.points(joint.s + np.array([each])) for each in (-step, 0.0, step))
        for k in range(2):
            left, right = ((b - a)[0, 0] / step for a, b in ((before[k], at[k]), (at[k], after[k])))
            assert left == pytest.approx(right, abs=1e-3 * np.linalg.norm(left))


def test_the_multiple_arc_turns_by_the_share_asked_for_and_is_parallel_at_the_transition():
    outline = MULTIPLE.outline(SPAN)
    near = 1e-7
    line = outline.camber(np.array([0.0, near, 0.5 - near, 0.5, 1.0 - near, 1.0]))[0]
    angles = [np.degrees(np.arctan2(*(line[i + 1] - line[i])[::-1])) for i in (0, 2, 4)]
    assert angles[0] - angles[1] == pytest.approx(0.2 * 40.0, abs=1e-4)
    assert angles[1] - angles[2] == pytest.approx(0.8 * 40.0, abs=1e-4)
    upper, lower = (points[0] for points in outline.points(np.array([0.5 - near, 0.5])))
    assert np.linalg.norm(upper[1] - lower[1]) == pytest.approx(0.06, rel=1e-12)
    across = upper[1] - lower[1]
    for points in (upper, lower):
        assert np.dot(points[1] - points[0], across) == pytest.approx(0.0, abs=1e-6 * near)


def test_a_multiple_arc_of_equal_halves_is_a_double_arc():
    halves = MultipleCircularArc(
        thickness=0.08, camber_angle=30.0, leading_edge_radius=0.004, trailing_edge_radius=0.004, transition=0.5,
        front_camber=0.5,
    )  # fmt: skip
    for a, b in zip(sides(halves, 0.0, 1.0), sides(DOUBLE, 0.0, 1.0), strict=True):
        assert a == pytest.approx(b, abs=1e-15)


def test_edges_thicker_than_the_profile_are_refused():
    with pytest.raises(DesignError, match=r"leading_edge_radius is 0.04: it must be below 0.45 of the thickness, 0.06"):
        DoubleCircularArc(thickness=0.06, leading_edge_radius=0.04).outline(SPAN)


def test_a_plate_is_flat_between_half_ellipses():
    profile = FlatPlate(thickness=0.05, leading_edge="elliptic", leading_edge_ratio=3.0)
    for points, sign in zip(sides(profile, 0.0, 1.0), (1.0, -1.0), strict=True):
        flat = (points[:, 0] > 0.075) & (points[:, 0] < 0.975)
        assert points[flat, 1] == pytest.approx(sign * 0.025, abs=1e-16)
        nose, tail = points[points[:, 0] < 0.075], points[points[:, 0] > 0.975]
        assert (nose[:, 0] / 0.075 - 1.0) ** 2 + (nose[:, 1] / 0.025) ** 2 == pytest.approx(1.0, abs=1e-14)
        assert np.hypot(tail[:, 0] - 0.975, tail[:, 1]) == pytest.approx(0.025, rel=1e-13)


def test_a_plate_whose_ratio_and_edge_do_not_fit_is_refused():
    with pytest.raises(DesignError, match=r"leading_edge_ratio is missing and leading_edge is 'elliptic'"):
        FlatPlate(thickness=0.05, leading_edge="elliptic")
    with pytest.raises(DesignError, match=r"trailing_edge_ratio is given and trailing_edge is 'round'"):
        FlatPlate(thickness=0.05, trailing_edge_ratio=2.0)
    with pytest.raises(DesignError, match=r"edges take the whole chord"):
        FlatPlate(thickness=0.3, leading_edge="elliptic", leading_edge_ratio=6.0).outline(SPAN)
