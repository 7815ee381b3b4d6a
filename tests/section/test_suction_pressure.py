"""Sections by suction and pressure side: what their parameters say is what is built."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.closest import closest_on_curve
from bladewright.nurbs.curvature import curvature
from bladewright.nurbs.curve import Curve
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.outline import EDGE, closed_curve
from bladewright.section.suction_pressure.part import edge_points
from machines.suction_pressure import FAN_TIP, STATOR, TURBINE, section

from .one_sided import one_sided

PARTS = {"stator": STATOR, "fan tip": FAN_TIP, "turbine": TURBINE}
SPAN = Span(np.zeros(1))
W = np.linspace(0.0, 1.0, 401)


@pytest.fixture(params=list(PARTS))
def part(request):
    return PARTS[request.param]


def spline(side):
    return Curve(control_points=side.controls[0], knots=side.knots, degree=3)


def sides(part):
    outline = part.outline(SPAN)
    upper, lower = spline(outline.upper), spline(outline.lower)
    return (upper, lower) if part.suction_side == "upper" else (lower, upper)


def direction(degrees):
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])


def test_the_characteristic_points_are_where_the_ellipses_have_the_sides_directions(part):
    for edge, points, angle, sign in zip(
        ("leading_edge", "trailing_edge"),
        edge_points(part, SPAN),
        (part.metal_angle_in - part.stagger_angle, part.metal_angle_out - part.stagger_angle),
        (1.0, -1.0),
        strict=True,
    ):
        along, across = sign * direction(angle), direction(angle + 90.0)
        b, wedge = (getattr(part, f"{edge}_{name}") for name in ("radius", "wedge"))
        for name, side in (("upper", 1.0), ("lower", -1.0)):
            corner = points[name]
            skew = getattr(part, f"{edge}_skew") * (1.0 if name == part.suction_side else -1.0)
            a = b * getattr(part, f"{edge}_stretch") * (1.0 + skew)
            x, y = np.dot(corner.offset[0], along), side * np.dot(corner.offset[0], across)
            assert ((x - a) / a) ** 2 + (y / b) ** 2 == pytest.approx(1.0, abs=1e-13)
            # the ellipse's tangent, from its gradient
            tangent = np.array([y / b**2, -(x - a) / a**2])
            half = np.radians(0.5 * wedge)
            assert cross2(tangent, np.array([np.cos(half), np.sin(half)])) == pytest.approx(
                0.0, abs=1e-13 * np.linalg.norm(tangent)
            )
            turned = angle * np.pi / 180.0 + sign * side * half
            assert corner.direction[0] == pytest.approx(sign * np.array([np.cos(turned), np.sin(turned)]), abs=1e-14)


def test_a_circle_with_parallel_sides_leaves_its_diameter_beside_the_middle():
    part = STATOR.changed(
        {"leading_edge_stretch": 1.0, "leading_edge_skew": 0.0, "leading_edge_wedge": 0.0, "stagger_angle": 42.0}
    )
    corner = edge_points(part, SPAN)[0]["upper"]
    assert corner.point[0] == pytest.approx([0.006, 0.006], abs=1e-17)


def test_the_sides_run_from_corner_to_corner_in_their_directions(part):
    leading, trailing = edge_points(part, SPAN)
    outline = part.outline(SPAN)
    for name in ("upper", "lower"):
        curve = spline(getattr(outline, name))
        for points, place, sign in ((leading, 0.0, 1.0), (trailing, 1.0, -1.0)):
            corner = points[name]
            assert curve(place) == pytest.approx(corner.point[0], abs=1e-15)
            slope = sign * curve.derivative(place)
            assert slope / np.linalg.norm(slope) == pytest.approx(corner.direction[0], abs=1e-12)


@pytest.mark.parametrize("edges", ["C1", "C2"])
def test_edges_continue_the_sides_by_s_as_often_as_asked(part, edges):
    outline = part.changed("edges", edges).outline(SPAN)
    for k in (0, 1):
        for place in (EDGE, 1.0 - EDGE):
            for order in (1, 2):
                (before, rounding), (after, as_well) = (
                    one_sided(lambda s, k=k: outline.points(s)[k][0], place, step, order) for step in (-0.05, 0.05)
                )
                jump = np.max(np.fabs(after - before))
                if order == 1 or edges == "C2":
                    assert jump < rounding + as_well
                else:
                    assert jump > 1e-3


def test_an_edge_has_the_ellipses_radius_at_its_nose(part):
    for edges, allowed in (("C1", 1e-12), ("C2", 0.02)):
        # exact for C1 edges; with C2 the sides' own curvature enters
        plain = part.changed({"edges": edges, "leading_edge_skew": 0.0})
        start = plain.outline(SPAN).leading_edge.upper
        bend = cross2(start.first[0], start.second[0]) / np.linalg.norm(start.first[0]) ** 3
        assert -1.0 / bend == pytest.approx(plain.leading_edge_radius / plain.leading_edge_stretch, rel=allowed)


def test_a_round_edge_with_parallel_straight_sides_is_nearly_a_circle():
    plain = STATOR.changed(
        {"edges": "C1", "leading_edge_stretch": 1.0, "leading_edge_skew": 0.0, "leading_edge_wedge": 0.0}
    )
    points = plain.outline(SPAN).points(np.linspace(0.0, EDGE, 101)[:-1])
    centre = 0.006 * direction(20.0)
    for side in points:
        # the quartic of equal nose radius misses the circle by 4.9e-4 of the radius
        assert np.linalg.norm(side[0] - centre, axis=-1) == pytest.approx(0.006, rel=5e-4)


def test_the_pressure_side_has_the_thickness_asked_at_the_places_asked():
    suction, pressure = sides(FAN_TIP)
    places = np.array(FAN_TIP.pressure_places)
    tangents = suction.derivative(places)
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=-1) / np.linalg.norm(tangents, axis=-1)[:, None]
    asked = suction(places) + np.array(FAN_TIP.pressure_thickness)[:, None] * normals
    assert closest_on_curve(pressure, asked).distances == pytest.approx(0.0, abs=1e-13)


def test_the_pressure_side_follows_the_suction_side_at_the_thickness_only_in_that_form():
    raised = {"suction_heights[1]": -0.0185}
    moved = sides(FAN_TIP.changed(raised))[1](W) - sides(FAN_TIP)[1](W)
    assert np.max(np.abs(moved)) > 5e-4
    free = FAN_TIP.independent()
    given = {"pressure_tangent_in": free.pressure_tangent_in, "pressure_tangent_out": free.pressure_tangent_out}
    free = free.changed(given)
    assert np.array_equal(sides(free.changed(raised))[1](W), sides(free)[1](W))


def test_a_pressure_side_of_its_own_made_from_a_thickness_has_the_same_shape():
    free = FAN_TIP.independent()
    assert free.pressure_thickness == ()
    assert sides(free)[1](W) == pytest.approx(sides(FAN_TIP)[1](W), abs=1e-15)
    assert STATOR.independent() == STATOR


@pytest.mark.parametrize("knots", [1, 4, (0.1, 0.45, 0.83)], ids=str)
def test_refinement_adds_control_points_and_keeps_the_curves(part, knots):
    part = part.independent()
    refined = part.refined(knots)
    added = knots if isinstance(knots, int) else len(knots)
    assert len(refined.suction_heights) == len(part.suction_heights) + added
    assert len(refined.pressure_heights) == len(part.pressure_heights) + added
    for before, after in zip(sides(part), sides(refined), strict=True):
        assert after(W) == pytest.approx(before(W), abs=1e-13)
    for before, after in zip(part.outline(SPAN).edges, refined.outline(SPAN).edges, strict=True):
        assert after == pytest.approx(before, abs=1e-13)


def test_the_suction_side_alone_is_refined_under_a_thickness():
    refined = FAN_TIP.refined(2, side="suction")
    for before, after in zip(sides(FAN_TIP), sides(refined), strict=True):
        assert after(W) == pytest.approx(before(W), abs=1e-13)


@pytest.mark.parametrize(
    ("part", "call", "message"),
    [
        (FAN_TIP, {"knots": 1}, "pressure_thickness.*independent"),
        (
            STATOR.changed("leading_edge_radius", (0.006, 0.005)),
            {"knots": 1},
            "leading_edge_radius.*law along the span",
        ),
        (STATOR, {"knots": 0}, "at least 1"),
        (STATOR, {"knots": 1, "side": "upper"}, "suction, pressure, both"),
    ],
    ids=["thickness", "law", "none", "side"],
)
def test_a_refinement_that_would_not_be_exact_is_refused(part, call, message):
    with pytest.raises(DesignError, match=message):
        part.refined(**call)


def test_a_section_merges_into_one_closed_curve_of_four_pieces(part):
    curve = closed_curve(part.outline(SPAN))
    start, end = curve.domain
    outline = part.outline(SPAN)
    degree = 4 if part.edges == "C1" else 6
    assert (curve.degree, end - start) == (degree, 4.0)
    assert curve(start) == pytest.approx(curve(end), abs=1e-15)
    s = np.linspace(0.0, 1.0, 101)
    for points in outline.points(s):
        assert closest_on_curve(curve, points[0]).distances == pytest.approx(0.0, abs=1e-12)
    joints = np.array([1.0, 2.0, 3.0])
    before, after = (curve.derivative(joints + step) for step in (-1e-12, 1e-12))
    unit = [each / np.linalg.norm(each, axis=-1)[:, None] for each in (before, after)]
    assert unit[0] == pytest.approx(unit[1], abs=1e-9)
    if part.edges == "C2":
        bends = [curvature(curve, joints + step) for step in (-1e-9, 1e-9)]
        # the curvature changes by up to 1e6 a unit of an edge's parameter
        assert bends[0] == pytest.approx(bends[1], abs=1e-2)


def test_the_pseudo_skeleton_line_reaches_in_front_of_the_nose():
    outline = TURBINE.outline(SPAN)
    assert np.min(outline.points(np.linspace(0.0, 1.0, 201))[0][..., 0]) < -0.03
    assert np.min(outline.upper.controls[..., 0]) < -0.03


def test_without_turning_the_pseudo_skeleton_line_is_the_chord_line():
    straight = {"metal_angle_in": 22.0, "metal_angle_out": 22.0}
    chord = STATOR.changed(straight)
    pseudo = chord.changed("skeleton", "pseudo")
    for one, other in zip(sides(chord), sides(pseudo), strict=True):
        assert one.control_points == pytest.approx(other.control_points, abs=1e-15)


def test_a_mirrored_design_is_the_mirror_image():
    flipped = {name: -value for name, value in STATOR.parameters().items() if name.endswith(("angle", "in", "out"))}
    flipped = {name: value for name, value in flipped.items() if "tangent" not in name}
    heights = {
        f"{side}_heights": tuple(-h for h in getattr(STATOR, f"{side}_heights")) for side in ("suction", "pressure")
    }
    mirrored = STATOR.changed({**flipped, **heights, "suction_side": "lower"})
    s = np.linspace(0.0, 1.0, 101)
    upper, lower = STATOR.outline(SPAN).points(s)
    other_upper, other_lower = mirrored.outline(SPAN).points(s)
    assert other_lower == pytest.approx(upper * [1.0, -1.0], abs=1e-15)
    assert other_upper == pytest.approx(lower * [1.0, -1.0], abs=1e-15)


@pytest.mark.parametrize(
    ("part", "change", "message"),
    [
        (STATOR, {"suction_heights": ()}, "suction_heights is an empty list.*one control point or more"),
        (STATOR, {"pressure_heights": ()}, "pressure_heights and pressure_thickness: none"),
        (STATOR, {"pressure_thickness": (0.1,)}, "pressure_heights and pressure_thickness: both"),
        (STATOR, {"suction_places": (0.5,)}, "suction_places has 1 entries and suction_heights has 3"),
        (STATOR, {"suction_places": (0.2, 0.5, 1.7)}, r"suction_places\[2\] is 1.7: a place along"),
        (STATOR, {"suction_knots": (0.5,)}, "suction_knots has 1 entries: suction_heights has 3"),
        (STATOR, {"suction_knots": (0.5, 0.2, 0.7)}, "suction_knots .*must increase"),
        (STATOR, {"leading_edge_radius": 0.6}, "leading_edge_radius is 0.6: an edge radius"),
        (STATOR, {"leading_edge_skew": 1.0}, "leading_edge_skew is 1: a skewness"),
        (STATOR, {"suction_tangent_in": 0.0}, "suction_tangent_in is 0"),
        (STATOR, {"edges": "C3"}, "edges is 'C3'"),
        (FAN_TIP, {"pressure_thickness": (0.01, -0.01, 0.01, 0.01)}, r"pressure_thickness\[1\] is -0.01"),
        (
            STATOR,
            {"leading_edge_wedge": 70.0},
            r"leading_edge_wedge is 70 deg.*more than 4\d.*lower",
        ),
        (STATOR, {"leading_edge_radius": 0.45, "trailing_edge_radius": 0.45}, "leave no room for the"),
        (
            STATOR,
            {"suction_tangent_in": 0.0008},
            "suction_tangent_in is 0.0008 .*leading_edge_radius.*make it about 0.01",
        ),
        (
            STATOR,
            {"pressure_heights": (0.2, 0.25, 0.2)},
            "suction_heights and pressure_heights: the two.*near 0.5",
        ),
        (STATOR, {"suction_side": "lower"}, r"the two sides cross.*suction_side is the lower one"),
        (STATOR, {"leading_edge_wedge": (14.0, 70.0)}, "at span v = 1"),
    ],
    ids=lambda each: str(each) if isinstance(each, dict) else "",
)
def test_what_does_not_fit_is_refused_with_the_parameter_that_cures_it(part, change, message):
    with pytest.raises(DesignError, match=message):
        part.changed(change).outline(Span(np.array([0.0, 1.0]))).check_limits([" at span v = 0", " at span v = 1"])


def test_built_sections_have_the_radius_and_angle_of_their_edges():
    built = section(TURBINE).build()
    # C2 edges meet the sides' curvature, which moves the nose's
    assert built.edge_radii == pytest.approx((0.04 * 0.05 / 1.3, 0.04 * 0.012), rel=0.02)
