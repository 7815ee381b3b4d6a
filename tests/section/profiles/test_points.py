"""Profiles through points: what they go through, and what does not change them."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.section.laws import Span
from bladewright.section.profiles.naca4 import Naca4
from machines.profiles import CUT, LENS, OVAL, through

SPAN = Span(np.zeros(1))
S = np.linspace(0.0, 1.0, 101)
FORMS = {"round": OVAL, "blunt": CUT[::-1], "sharp": LENS}
KINDS = {"round": ("round", "round"), "blunt": ("round", "blunt"), "sharp": ("sharp", "sharp")}


@pytest.fixture(params=list(FORMS))
def form(request):
    return request.param


def contour_of(points):
    return np.concatenate(through(points).outline(SPAN).points(S))


def test_the_edges_are_what_the_corners_say(form):
    outline = through(FORMS[form]).outline(SPAN)
    assert (outline.leading_edge.kind, outline.trailing_edge.kind) == KINDS[form]


@pytest.mark.parametrize("form", ["sharp"])
def test_the_outline_goes_through_every_point(form):
    # sharp edges at (0, 0) and (1, 0): the chord line is theirs already
    outline = through(FORMS[form]).outline(SPAN)
    fine = np.concatenate(outline.points(np.linspace(0.0, 1.0, 20001)), axis=1)[0]
    for point in FORMS[form]:
        # steps of 1e-4 at most
        assert np.min(np.linalg.norm(fine - point, axis=1)) < 1e-4


@pytest.mark.parametrize("start", [0, 3, 5])
@pytest.mark.parametrize("step", [1, -1])
def test_neither_start_nor_sense_nor_closing_changes_a_profile(form, start, step):
    points = FORMS[form]
    turned = [*points[start:], *points[:start]][::step]
    expected = contour_of(points)
    # the parameters of a closed curve start elsewhere: rounding only, of systems of up to a dozen points
    assert contour_of(turned) == pytest.approx(expected, abs=1e-11)
    assert contour_of([*turned, turned[0]]) == pytest.approx(expected, abs=1e-11)


def test_size_place_and_direction_change_nothing(form):
    points = np.array(FORMS[form])
    turn = np.radians(35.0)
    matrix = 120.0 * np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    moved = [tuple(map(float, point)) for point in points @ matrix + [7.0, -3.0]]
    assert contour_of(moved) == pytest.approx(contour_of(FORMS[form]), abs=1e-10)


def test_finer_points_come_nearer_to_the_profile_they_are_of():
    profile = Naca4(thickness=0.16)
    errors = []
    for count in (12, 24, 48):
        upper, lower = (points[0] for points in profile.outline(SPAN).points(np.linspace(0.0, 1.0, count + 1)))
        points = [tuple(map(float, point)) for point in [*upper[::-1], *lower[1:-1]]]
        x, y = through(points).outline(SPAN).points(S)[0][0].T
        root = np.sqrt(np.maximum(x, 0.0))
        half = 0.16 * (1.4845 * root - 0.63 * x - 1.758 * x**2 + 1.4215 * x**3 - 0.518 * x**4)
        errors.append(np.max(np.abs(y - half)))
    # the slope of the curvature jumps at the nose: second order at least
    assert errors[1] < errors[0] / 4.0
    assert errors[2] < errors[1] / 4.0
    assert errors[2] < 1e-5


def test_a_round_edge_is_where_the_chord_is_longest():
    outline = through(OVAL).outline(SPAN)
    upper, lower = (points[0] for points in outline.points(np.linspace(0.0, 0.02, 41)))
    for points in (upper, lower):
        assert np.all(np.linalg.norm(points - [1.0, 0.0], axis=1) <= 1.0 + 1e-12)
    assert outline.leading_edge.upper.first[0, 0] == pytest.approx(0.0, abs=1e-10)


def test_contours_that_are_none_are_refused():
    with pytest.raises(DesignError, match=r"abscissas has 7 entries: a contour needs at least 8"):
        through(OVAL[:7])
    with pytest.raises(DesignError, match=r"abscissas has 10 entries and ordinates 7"):
        through(OVAL).changed("ordinates", (0.0,) * 7)
    with pytest.raises(DesignError, match=r"abscissas\[2\] and ordinates\[2\]: the point is given twice"):
        through([*OVAL[:3], OVAL[2], *OVAL[3:]]).outline(SPAN)
    with pytest.raises(DesignError, match=r"5 points on the upper side, between the corners"):
        through([point for point in LENS if point not in ((0.4, 0.06), (0.4, -0.03))]).outline(SPAN)
    house = [(0.0, 0.0), (0.2, 0.0), (0.4, 0.0), (0.6, 0.0), (0.8, 0.0), (1.0, 0.0), (0.9, 0.1), (0.8, 0.2)]
    house += [(0.7, 0.3), (0.6, 0.4), (0.5, 0.5), (0.4, 0.4), (0.3, 0.3), (0.2, 0.2), (0.1, 0.1)]
    with pytest.raises(DesignError, match=r"corner at point 10, \(0.5, 0.5\)"):
        through(house).outline(SPAN)
