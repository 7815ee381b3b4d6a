"""Sections by their camber angle: the integral, the thickness, and the meridional distance."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import BSpline

from bladewright.errors import DesignError
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.laws import Span, law_basis
from machines.camber_angles import CAMBER_ANGLES

SPAN = Span(np.zeros(1))
S = np.linspace(0.0, 1.0, 81)
STEP = 1e-30


@pytest.fixture(params=list(CAMBER_ANGLES))
def part(request):
    return CAMBER_ANGLES[request.param]


def beta(part, m):
    """The camber angle [rad] at fractions of the meridional length, by the basis of laws."""
    return np.radians(law_basis(len(part.camber_angle), np.atleast_1d(m)) @ np.array(part.camber_angle))


def integral(part, end, fraction=lambda x: x):
    """theta at a fraction of m', of its extent, by adaptive quadrature between many breaks."""
    breaks = [*(x for x in np.linspace(0.0, 1.0, 61) if x < end - 1e-9), end]
    pieces = [
        quad(lambda x: float(np.tan(beta(part, fraction(x)))[0]), a, b, epsabs=1e-15, epsrel=1e-15)[0]
        for a, b in pairwise(breaks)
    ]
    return sum(pieces)


def squared(x):
    """A meridional length that does not grow evenly with m'."""
    return x * (0.6 + 0.4 * x)


def meridional(places):
    return np.broadcast_to(squared(places), (1, len(places)))


def in_plane(part, points, **options):
    """Points in the chord frame as (m', theta), of the extent of m'."""
    stagger = part.stagger(SPAN, **options)[0]
    chord = 1.0 / np.cos(stagger)
    turn = np.array([[np.cos(stagger), -np.sin(stagger)], [np.sin(stagger), np.cos(stagger)]])
    return chord * points @ turn.T


@pytest.mark.parametrize("given", [None, meridional], ids=["equal", "uneven"])
def test_the_camber_line_is_the_integral_of_the_angles_tangent(part, given):
    line = in_plane(part, part.outline(SPAN, given).camber(S)[0], meridional=given)
    fraction = squared if given else lambda x: x
    for x, theta in line[[10, 37, 61, 80]]:
        assert theta == pytest.approx(integral(part, x, fraction), abs=3e-14)
    assert line[-1, 0] == pytest.approx(1.0, abs=1e-14)


def test_a_batch_of_complex_steps_carries_central_differences(part):
    """Of an angle, of a height, and of how the meridional length grows, each alone in a batch of three."""

    def upper(steps):
        angle, height, growth = steps
        made = part.stepped(
            {
                "camber_angle[0]": part.camber_angle[0] + angle,
                "half_thickness[1]": part.half_thickness[1] + height,
            }
        )

        def uneven(places):
            share = np.asarray(0.4 + growth)[..., None, None]
            return places * (1.0 - share * (1.0 - places)) + np.zeros((1, 1))

        return np.asarray(made.outline(SPAN, uneven).points(S)[0])

    carried = np.imag(upper(1j * STEP * np.eye(3))) / STEP
    for number, by in enumerate((1e-3, 1e-6, 1e-5)):
        step = by * np.eye(3)[number]
        expected = (upper(step) - upper(-step)) / (2.0 * by)
        assert carried[number] == pytest.approx(expected, abs=1e-8)


def test_a_linear_angle_gives_the_logarithm_of_its_cosine():
    part = CamberAngle(camber_angle=(60.0, 20.0), half_thickness=(0.01, 0.03, 0.03, 0.01))
    line = in_plane(part, part.outline(SPAN).camber(S)[0])
    slope = np.radians(20.0 - 60.0)
    angle = np.radians(60.0) + slope * line[:, 0]
    exact = (np.log(np.cos(np.radians(60.0))) - np.log(np.cos(angle))) / slope
    assert line[:, 1] == pytest.approx(exact, abs=1e-14)


def test_a_constant_angle_gives_a_straight_line_at_that_stagger():
    part = CamberAngle(camber_angle=(35.0,), half_thickness=(0.01, 0.03, 0.03, 0.01))
    assert part.stagger(SPAN) == pytest.approx(np.radians(35.0), abs=1e-15)
    assert part.outline(SPAN).camber(S)[0, :, 1] == pytest.approx(0.0, abs=1e-15)


def test_the_camber_line_has_the_angle_asked_for_everywhere(part):
    outline = part.outline(SPAN, meridional)
    line = in_plane(part, outline.camber(S)[0], meridional=meridional)
    apart = in_plane(part, np.subtract(*outline.points(S))[0], meridional=meridional)
    # the sides lie across the camber line
    inner = slice(1, -1)
    angle = np.arctan2(-apart[inner, 0], apart[inner, 1])
    assert angle == pytest.approx(beta(part, squared(line[inner, 0])), abs=1e-12)


def test_the_half_thickness_is_the_nurbs_of_its_control_points():
    part = CAMBER_ANGLES["camber-angle-weights"]
    places = np.array([0.0, 0.0, *part.thickness_places, 1.0])
    heights = np.array([0.0, *part.half_thickness, 0.0])
    weights = np.array([1.0, *part.thickness_weights, 1.0])
    knots = np.array([0.0, 0.0, 0.0, 0.0, 1 / 3, 2 / 3, 1.0, 1.0, 1.0, 1.0])
    spline = BSpline(knots, np.column_stack([places * weights, heights * weights, weights]), 3)
    t = np.linspace(0.0, 1.0, 200001)
    curve = spline(t)
    place, height = curve[:, 0] / curve[:, 2], curve[:, 1] / curve[:, 2]
    outline = part.outline(SPAN)
    line, (upper, lower) = in_plane(part, outline.camber(S)[0]), outline.points(S)
    half = 0.5 * np.linalg.norm((upper - lower)[0], axis=1)
    # a table of 200,000 places, beside the nose by the square of the parameter
    assert half[4:] == pytest.approx(np.interp(line[4:, 0], place, height), abs=1e-9)


def test_the_default_places_are_a_sixteenth_and_then_equal():
    values = (0.012, 0.02, 0.04, 0.03, 0.01)
    default = CamberAngle(camber_angle=(40.0, 10.0), half_thickness=values, trailing_edge="blunt")
    given = default.changed("thickness_places", (0.0625, 0.375, 0.6875))
    for a, b in zip(default.outline(SPAN).points(S), given.outline(SPAN).points(S), strict=True):
        assert a == pytest.approx(b, abs=1e-15)


def test_a_round_edge_has_the_radius_of_the_first_control_points(part):
    start = part.outline(SPAN).leading_edge.upper
    first, second = start.first[0], start.second[0]
    radius = np.linalg.norm(first) ** 3 / np.abs(first[0] * second[1] - first[1] * second[0])
    count = len(part.half_thickness) + (1 if part.trailing_edge == "blunt" else 2)
    # x'' and h' of a cubic at its end: 6 / width^2 (x2 / 2 w2 / w0) and 3 / width h1 w1 / w0, on uniform knots
    width = 1.0 / (count - 3)
    ends = part.thickness_places or part.changed("thickness_weights", ()).outline(SPAN).places.controls[0, 2:3]
    weights = np.array([1.0, *(part.thickness_weights or np.ones(3))])
    middle = 1.0 if count == 4 else 0.5
    rise = 3.0 / width * part.half_thickness[0] * weights[1]
    bend = 6.0 / width**2 * float(ends[0]) * middle * weights[2]
    stagger = part.stagger(SPAN)[0]
    # along the camber: d(m') / cos(beta), and the chord is the extent over cos(stagger)
    along = bend * np.cos(stagger) / np.cos(np.radians(part.camber_angle[0]))
    assert radius == pytest.approx(rise**2 / along, rel=1e-12)


def test_the_meridional_distance_is_only_its_way_of_counting(part):
    even = part.outline(SPAN, lambda places: np.broadcast_to(places, (1, len(places))))
    for a, b in zip(even.points(S), part.outline(SPAN).points(S), strict=True):
        assert a == pytest.approx(b, abs=1e-13)


def test_a_complex_meridional_distance_is_carried(part):
    def stretched(factor):
        return lambda places: (places + factor * places * (1.0 - places))[None, :]

    analytic = np.imag(np.stack(part.outline(SPAN, stretched(STEP * 1j)).points(S))) / STEP
    high, low = (np.stack(part.outline(SPAN, stretched(each)).points(S)) for each in (1e-6, -1e-6))
    assert analytic == pytest.approx((high - low) / 2e-6, abs=1e-7 * np.max(np.abs(analytic)))


def test_sections_of_different_streams_keep_their_own_distances(part):
    def two(places):
        return np.stack([places, squared(places)])

    both = part.outline(Span(np.array([0.0, 1.0])), two).points(S)
    for k in (0, 1):
        assert both[k][0] == pytest.approx(part.outline(SPAN).points(S)[k][0], abs=1e-13)
        assert both[k][1] == pytest.approx(part.outline(SPAN, meridional).points(S)[k][0], abs=1e-13)


def test_joints_are_the_knots_of_thickness_and_angle():
    part = CAMBER_ANGLES["camber-angle"]
    outline = part.outline(SPAN)
    places = in_plane(part, outline.camber(np.array([joint.s for joint in outline.joints]))[0])[:, 0]
    for knot in (1 / 3, 2 / 3):
        assert np.min(np.abs(places - knot)) < 1e-14
    assert [joint.s for joint in outline.joints if joint.s in (0.25, 0.5, 0.75)] == [0.25, 0.5, 0.75]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"camber_angle": (90.0, 0.0)}, r"camber_angle\[0\] is 90: an angle must lie between -89 and 89 deg"),
        ({"half_thickness": (0.01, -0.02, 0.01)}, r"half_thickness\[1\] is -0.02: a half thickness must be above 0"),
        ({"half_thickness": (0.01,)}, r"half_thickness has 1 control points: a round trailing edge needs at least 2"),
        ({"thickness_places": (0.5,)}, r"thickness_places has 1 entries for 5 of half_thickness: give 3 or none"),
        ({"thickness_weights": (1.0,)}, r"thickness_weights has 1 entries for 5 of half_thickness: give 5 or none"),
        ({"thickness_weights": (1.0, 1.0, 0.0, 1.0, 1.0)}, r"thickness_weights\[2\] is 0: a weight must be"),
    ],
)
def test_what_cannot_be_is_refused(changes, message):
    with pytest.raises(DesignError, match=message):
        CAMBER_ANGLES["camber-angle"].changed(changes)


def test_places_out_of_order_and_edges_too_thin_are_refused():
    part = CAMBER_ANGLES["camber-angle"]
    with pytest.raises(DesignError, match=r"thickness_places do not increase"):
        part.changed("thickness_places", (0.1, 0.6, 0.5)).outline(SPAN)
    with pytest.raises(DesignError, match=r"half_thickness rises beside the leading edge to 20 times its value"):
        part.changed("half_thickness", (0.002, 0.04, 0.04, 0.03, 0.008)).outline(SPAN).check_limits([""] * len(SPAN.v))
