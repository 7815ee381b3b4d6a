"""Meanlines by their second derivative, mixed camber lines, and the sections laid on them."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import BSpline

from bladewright.errors import DesignError
from bladewright.section.chord_spline import ChordSpline
from bladewright.section.crossing import check_outline
from bladewright.section.laws import Span
from bladewright.section.meanline import CurvedMeanline, MixedMeanline, backward
from bladewright.section.offset import merged_joints
from bladewright.section.outline import Joint
from machines.meanlines import ELLIPTIC, MEANLINES, NACA, SHARP, on_meanline

from .tblade3_sections import CASES, computed

HUB = Span(np.zeros(1))
U = np.linspace(0.0, 1.0, 97)
INFLECTED = (-0.5, -0.2, 0.3, 0.7)
"""a second derivative of which the meanline leaves both edges to the same side of the chord line"""
PLACES = (0.0, 0.3, 0.7, 1.0)


def line_of(values, camber, places=None):
    count = len(values)
    places = np.linspace(0.0, 1.0, count) if places is None else np.array(places)
    return CurvedMeanline(places=places[None], values=np.array(values)[None], camber=np.array([camber]))


@pytest.mark.parametrize("case", [case for case in CASES if not case.startswith("Wennerstrom")])
def test_meanlines_are_those_that_tblade3_computed(case):
    for number in range(1, CASES[case] + 1):
        known = computed(case, number)
        found = known.part.meanline(HUB).derivatives(known.u)
        # the program's second derivative has the opposite sign
        for own, its, sign in zip(found, known.meanline.T, (1.0, 1.0, -1.0), strict=False):
            assert sign * own[0] == pytest.approx(its, abs=1e-12)


@pytest.mark.parametrize("case", CASES)
def test_stagger_is_the_one_that_tblade3_computed(case):
    for number in range(1, CASES[case] + 1):
        known = computed(case, number)
        assert known.part.stagger(HUB)[0] == pytest.approx(known.stagger, abs=1e-12)


# the program's quartic thickness is good to 1e-7 at the edges; where a spline replaces the leading edge, its sections
# are others
@pytest.mark.parametrize(
    ("case", "tolerance"),
    [(case, 1e-12) for case in CASES if not case.endswith("v1.2.2")]
    + [("quartic_spline_thickness_rotor_v1.2.2", 1e-6)],
)
def test_sections_are_those_that_tblade3_computed(case, tolerance):
    for number in range(1, CASES[case] + 1):
        known = computed(case, number)
        outline = known.part.outline(HUB)
        upper, lower = (side[0] for side in outline.at(known.u, outline.half_at(known.u)))
        assert upper == pytest.approx(known.upper, abs=tolerance)
        assert lower == pytest.approx(known.lower, abs=tolerance)
        around = np.concatenate([upper[::-1], lower[1:]])
        around = around + known.shifted[120] - around[120]
        assert around == pytest.approx(known.shifted, abs=tolerance)
        turn = known.part.stagger(HUB)[0]
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        assert known.chord * around @ rotation.T == pytest.approx(known.placed, abs=tolerance)


@pytest.mark.parametrize("case", ["Case7-28-8_Rotor", "Wennerstrom_r37_v1.2.5"])
def test_the_outline_by_its_own_parameter_runs_through_the_same_points(case):
    known = computed(case, 11)
    outline = known.part.outline(HUB)
    s = np.linspace(0.0, 1.0, 4001)
    u = outline.thickness.u(s)[0]
    half = outline.half_at(u)[0]
    for own, other in zip(outline.points(s), outline.at(u, half), strict=True):
        # sqrt(u) and the root of the edge's ellipse lose half the digits of u there
        assert own[0] == pytest.approx(other[0], abs=1e-8)
        assert own[0, 200:-200] == pytest.approx(other[0, 200:-200], abs=1e-14)


def test_the_second_derivative_is_the_uniform_b_spline_of_its_control_points():
    places, values = np.array([0.0, 0.1, 0.45, 0.7, 1.0]), np.array([0.3, 1.0, -0.2, 0.5, 0.8])
    extended = [np.concatenate([[2 * p[0] - p[1]], p, [2 * p[-1] - p[-2]]]) for p in (places, values)]
    run, rise = (BSpline(np.arange(-3.0, 8.0), each, 3) for each in extended)
    t = np.linspace(0.0, 4.0, 41)
    line = line_of(values, 0.0, places)
    # at t = 4 the witness's u lies 1e-16 outside
    double, single, bend, _ = line.integrals(np.clip(run(t), 0.0, 1.0))
    assert bend[0] == pytest.approx(rise(t), abs=1e-14)
    for i in (7, 18, 40):
        first = quad(lambda x: rise(x) * run(x, 1), 0.0, t[i], points=[1.0, 2.0, 3.0], epsabs=1e-13)[0]
        assert single[0, i] == pytest.approx(first, abs=1e-13)
        # the second integral of S by u is that of (u - u') S
        second = quad(lambda x: (run(t[i]) - run(x)) * rise(x) * run(x, 1), 0.0, t[i], points=[1.0, 2.0, 3.0])[0]  # noqa: B023
        assert double[0, i] == pytest.approx(second, abs=1e-13)


@pytest.mark.parametrize(
    "line", [line_of((0.2, 1.0, -0.3, 0.6), 0.9), MixedMeanline(angles=(np.array([0.5]), np.array([-0.3])))]
)
def test_each_derivative_is_the_complex_step_of_the_one_before(line):
    exact = line.derivatives(U)
    carried = line.derivatives(U + 1e-30j)
    for lower, higher in zip(carried[:3], exact[1:], strict=True):
        assert np.imag(lower) / 1e-30 == pytest.approx(higher, abs=1e-12)


@pytest.mark.parametrize("degrees", [-140.0, -90.0, -35.0, -1e-6, 1e-3, 60.0, 89.9, 90.0, 120.0])
@pytest.mark.parametrize("values", [(1.0, 1.0), (0.0, 1.0, 0.4), (-0.2, -1.0, -0.1, -0.6, 0.1)])
def test_the_scale_holds_any_camber(values, degrees):
    line = line_of(values, np.radians(degrees))
    assert np.degrees(line.angle_out - line.angle_in)[0] == pytest.approx(degrees, abs=1e-11)
    ordinate, slope, _, _ = line.derivatives(np.array([0.0, 1.0]))
    assert ordinate[0] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert np.arctan(slope[0]) == pytest.approx([line.angle_in[0], line.angle_out[0]], abs=1e-14)


@pytest.mark.parametrize("values", [(1.0, 1.0), (-0.5, -0.2, 0.3, 0.7), (0.0, 0.0), (1.0, 0.0, -1.0)])
def test_no_camber_is_the_straight_line(values):
    line = line_of(values, 0.0)
    assert all(np.array_equal(each[0], np.zeros_like(U)) for each in line.derivatives(U))
    assert (line.angle_in[0], line.angle_out[0]) == (0.0, 0.0)


@pytest.mark.parametrize("values", [(0.3, 1.0, 0.5), (-0.5, -0.2, 0.3, 0.7)])
def test_a_little_camber_bends_the_straight_line_in_proportion(values):
    bends = [line_of(values, camber).derivatives(U)[0] / camber for camber in (1e-4, -1e-5, 1e-6)]
    # the next term is of the third order in the camber
    assert bends[0] == pytest.approx(bends[2], abs=1e-7)
    assert bends[1] == pytest.approx(bends[2], abs=1e-7)


def test_a_meanline_that_bends_back_turns_so_far_and_no_farther():
    largest = line_of(INFLECTED, 0.0, PLACES).largest_camber[0]
    assert 0.0 < largest < np.pi / 2
    for share in (0.5, 0.999, -0.999):
        line = line_of(INFLECTED, share * largest, PLACES)
        assert line.angle_out - line.angle_in == pytest.approx(share * largest, rel=1e-12)
    for camber in (1.001 * largest, -1.001 * largest, 2.0):
        assert np.isnan(line_of(INFLECTED, camber, PLACES).scale[0])


def test_more_camber_than_the_law_can_turn_is_refused_with_the_most_there_is():
    part = on_meanline(curvature=INFLECTED, curvature_places=(0.3, 0.7), thickness=NACA).section.changed(
        {"metal_angle_in": (0.0, 10.0), "metal_angle_out": (1.0, 60.0)}
    )
    most = np.degrees(line_of(INFLECTED, 0.0, PLACES).largest_camber[0])
    with pytest.raises(DesignError, match=rf"is 50 deg at span fraction 1: .* by {most:.4g} deg at most.*lower"):
        part.outline(Span(np.array([0.0, 1.0])))


def test_the_scale_carries_a_complex_step_through_no_camber():
    for values in ((1.0, 0.5), (-0.5, -0.2, 0.3, 0.7)):
        steps = [line_of(values, camber).scale[0] for camber in (1e-30j, 1e-6, -1e-6)]
        # central differences err by the square of the step
        assert np.imag(steps[0]) / 1e-30 == pytest.approx((steps[1] - steps[2]) / 2e-6, rel=1e-9)


def test_a_mixed_camber_line_is_straight_at_its_ends_and_smooth_once():
    angles = np.radians([[20.0], [-15.0]])
    line = MixedMeanline(angles=(angles[0], angles[1]))
    low, high = line.joints[0]
    assert [low, 1.0 - high] == pytest.approx([0.1 * np.cos(angles[0, 0]), 0.05 * np.cos(angles[1, 0])], abs=1e-15)
    for joint in (low, high):
        beside = line.derivatives(joint + np.array([-1e-9, 1e-9]))
        assert np.ptp(beside[0]) < 1e-9
        assert np.ptp(beside[1]) < 1e-8
        assert np.ptp(beside[2]) > 0.1
    ordinate, slope, _, _ = line.derivatives(np.array([0.0, 0.5 * low, 0.5 * (1.0 + high), 1.0]))
    assert slope[0] == pytest.approx(np.tan(angles[[0, 0, 1, 1], 0]), abs=1e-15)
    assert ordinate[0, [0, 3]] == pytest.approx([0.0, 0.0], abs=1e-16)


def test_the_half_thickness_stands_normal_to_the_meanline_on_both_sides():
    for design, _ in MEANLINES.values():
        outline, s = design.section.unsplined(HUB), np.linspace(0.0, 1.0, 57)
        upper, lower = (points[0] for points in outline.points(s))
        u = outline.thickness.u(s)[0]
        slope = outline.meanline.derivatives(u)[1][0]
        assert 0.5 * (upper + lower) == pytest.approx(outline.camber(s)[0], abs=1e-15)
        along = np.sum((upper - lower) * np.stack([np.ones_like(slope), slope], axis=-1), axis=-1)
        assert along == pytest.approx(np.zeros_like(s), abs=1e-15)
        height = 0.5 * np.sqrt(np.sum((upper - lower) ** 2, axis=-1))
        # roots of u near the edges, as above
        assert height == pytest.approx(outline.half_at(u)[0], abs=1e-7)


def test_a_spline_along_the_chord_meets_its_ends_and_keeps_straight_lines():
    places = np.array([[0.0, 0.1, 0.3, 0.5, 1.0]])
    straight = ChordSpline(places=places, values=2.0 - 3.0 * places)
    value, slope, bend = straight.derivatives(U)
    assert value[0] == pytest.approx(2.0 - 3.0 * U, abs=1e-14)
    assert slope[0] == pytest.approx(-3.0, abs=1e-12)
    assert bend[0] == pytest.approx(0.0, abs=1e-10)
    bent = ChordSpline(places=places, values=np.array([[0.2, 0.5, -0.1, 0.3, 0.7]]))
    assert bent.derivatives(np.array([0.0, 1.0]))[0][0] == pytest.approx([0.2, 0.7], abs=1e-15)
    carried = bent.derivatives(U + 1e-30j)
    for lower, higher in zip(carried[:2], bent.derivatives(U)[1:], strict=True):
        assert np.imag(lower) / 1e-30 == pytest.approx(higher, abs=1e-11)


@pytest.mark.parametrize("side", [0, 1])
def test_curvature_and_its_slope_are_continuous_along_a_section_of_quartic_thickness(side):
    part = on_meanline(
        curvature=(0.2, 0.6, 0.5, 0.2, 0.1),
        curvature_places=(0.15, 0.5, 0.8),
        thickness=SHARP,
        thickness_multiplier=(0.0, 0.3, 0.1, 0.0),
    ).section
    outline = part.outline(HUB)
    assert len(outline.joints) > 8
    assert {joint.derivatives for joint in outline.joints} == {3}
    nodes = (1.0 - np.cos(np.pi * (np.arange(16) + 0.5) / 16)) / 2.0
    places = [0.0, *(joint.s for joint in outline.joints), 1.0]
    for before, at, after in zip(places[:-2], places[1:-1], places[2:], strict=True):
        found = []
        for far in (before, after):
            reach = np.clip(far - at, -0.05, 0.05)
            s = at + reach * nodes
            order = np.argsort(s)
            points = np.empty((16, 2))
            points[order] = outline.points(s[order])[side][0]
            fitted = [np.polynomial.Chebyshev.fit(nodes, points[:, k], 15, domain=[0, 1]) for k in (0, 1)]
            (x1, x2, x3), (y1, y2, y3) = ([each.deriv(k)(0.0) / reach**k for k in (1, 2, 3)] for each in fitted)
            speed = np.hypot(x1, y1)
            bend = (x1 * y2 - x2 * y1) / speed**3
            slope = (x1 * y3 - x3 * y1) / speed**4 - 3.0 * bend * (x1 * x2 + y1 * y2) / speed**3
            found.append((bend, slope))
        # derivatives of an interpolant through 16 points: what rounding does to the second is bounded by Markov's
        # n^2 (n^2 - 1) / 3 (2 / reach)^2, and a bend is one over the square of the speed
        markov = 15**2 * (15**2 - 1) / 3 * (2.0 / min(0.05, at - before, after - at)) ** 2
        rounding = markov * np.finfo(float).eps / speed**2
        assert found[0][0] == pytest.approx(found[1][0], rel=1e-6, abs=rounding)
        assert found[0][1] == pytest.approx(found[1][1], rel=1e-3, abs=1e-2)


def test_joints_of_splines_are_listed_where_they_stand_still_along_the_span():
    part = on_meanline(curvature=(0.2, 0.6, 0.5, 0.1), curvature_places=(0.3, 0.6), thickness=NACA).section
    steady = part.changed("metal_angle_in", (48.0, 60.0)).outline(HUB).joints
    assert len(steady) == 2 + 2
    # the inner control point at 0.3 moves, and with it both of the spline's joints
    assert len(part.changed("curvature_places[0]", (0.3, 0.4)).outline(HUB).joints) == 2
    moving = part.changed("thickness.maximum_thickness_at", (0.42, 0.5)).outline(HUB).joints
    assert len(moving) == 2


def test_joints_at_one_place_are_one_with_the_fewer_derivatives():
    joints = [Joint(0.5, 3), Joint(0.2, 2), Joint(0.5 + 1e-12, 1), Joint(1e-12, 1), Joint(1.0, 2)]
    assert merged_joints(joints) == (Joint(0.2, 2), Joint(0.5, 1))


def test_a_side_that_folds_back_is_refused_where_it_does():
    design = on_meanline(
        metal_angle_in=75.0,
        metal_angle_out=-75.0,
        curvature=(0.0, 0.0, 1.0, 0.0, 0.0),
        curvature_places=(0.4, 0.5, 0.6),
        thickness=ELLIPTIC.changed("maximum_thickness", 0.35),
    )
    check_outline(design.changed("section.thickness.maximum_thickness", 0.05).section.outline(HUB), [""])
    with pytest.raises(DesignError, match=r"(crosses itself|folds back).*lower side near s = 0\.\d+.*lower the thick"):
        design.build()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"curvature": (1.0,)}, ["curvature", "1 control points", "at least 2"]),
        ({"curvature_places": (0.5,)}, ["curvature_places", "1 entries", "4 control points", "give 2"]),
        ({"curvature_places": (0.6, 0.3)}, ["curvature_places[1]", "0.3", "span fraction 0", "rise"]),
        ({"curvature_places": (0.6, 1.3)}, ["curvature_places[1]", "1.3", "between 0 and 1"]),
        ({"curvature": (), "curvature_places": ()}, ["curvature", "not given", "mixed"]),
        ({"camber": "mixed"}, ["curvature", "given", "mixed", "leave it out"]),
        ({"camber": "mixd"}, ["camber", "mixd", "mixed"]),
        ({"metal_angle_in": 90.0}, ["metal_angle_in", "90", "-90 and 90"]),
        ({"thickness_multiplier": (0.0, 0.1)}, ["thickness_multiplier", "at least 3"]),
        (
            {"camber": "mixed", "curvature": (), "curvature_places": (), "thickness": SHARP},
            ["camber", "mixed", "quartic-spline"],
        ),
        (
            {
                "camber": "mixed",
                "curvature": (),
                "curvature_places": (),
                "thickness": ELLIPTIC.changed("maximum_thickness_at", 0.06),
            },
            ["thickness.maximum_thickness_at", "straight", "mid-chord"],
        ),
    ],
)
def test_numbers_that_contradict_are_refused_with_the_cure(changes, words):
    part = on_meanline(curvature=(0.2, 0.6, 0.5, 0.1), curvature_places=(0.3, 0.6), thickness=NACA).section
    with pytest.raises(DesignError) as caught:
        part.changed(changes).outline(HUB)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_a_built_section_has_its_meanline():
    design = next(iter(MEANLINES.values()))[0]
    section = design.build()
    v, slope, bend = section.meanline(U)
    assert v.shape == slope.shape == bend.shape == U.shape
    assert section.metal_angle_in - section.stagger == pytest.approx(np.arctan(slope[0]), abs=1e-8)
    camber = section.camber(U)
    turn = np.array(
        [[np.cos(section.stagger), np.sin(section.stagger)], [-np.sin(section.stagger), np.cos(section.stagger)]]
    )
    local = camber @ turn.T / 40e-3
    assert section.meanline(np.clip(local[:, 0], 0.0, 1.0))[0] == pytest.approx(local[:, 1], abs=1e-9)


@pytest.mark.parametrize(
    ("places", "wrong"),
    [
        ((0.0, 0.3, 0.3, 1.0), ()),
        ((0.0, 0.2, 0.2, 0.6, 0.6, 1.0), ()),
        ((0.0, 0.3, 0.3, 0.3, 1.0), (2,)),
        ((0.0, 0.0, 0.5, 1.0), (0,)),
        ((0.0, 0.5, 1.0, 1.0), (2,)),
        ((0.0, 0.5, 0.4, 1.0), (1,)),
    ],
)
def test_two_inner_control_points_may_stand_at_one_place_and_nothing_else(places, wrong):
    assert tuple(np.flatnonzero(backward(np.array(places)))) == wrong


def test_control_points_at_one_place_are_the_limit_of_those_that_draw_near():
    values, camber = (0.0, 0.1, 0.2, 0.15, 0.05), 0.6
    limit = line_of(values, camber, (0.0, 0.4, 0.7, 0.7, 1.0))
    near = line_of(values, camber, (0.0, 0.4, 0.7 - 1e-9, 0.7 + 1e-9, 1.0))
    for own, other in zip(limit.derivatives(U), near.derivatives(U), strict=True):
        # the third derivative is the steepest in the places
        assert own[0] == pytest.approx(other[0], rel=1e-6, abs=1e-6)
    # the slope's integral, by a rule that knows nothing of splines
    assert quad(lambda u: limit.derivatives(np.array([u]))[1][0, 0], 0.0, 1.0, limit=200)[0] == pytest.approx(
        0.0, abs=1e-9
    )
