"""Flow paths as designs: what they hold, what they refuse, and the curves that they are made of."""

import re

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ControlPolygon, StraightsAndArcs, ThroughPoints
from bladewright.blade.flow_path.stream_surfaces import stream_surfaces
from bladewright.errors import DesignError
from machines.flow_paths import BEND, GIVEN, IMPELLER, MACHINES, bend, cornered, on, through

POINTS = ((0.0, 1.0), (0.4, 1.1), (0.7, 1.5), (1.2, 1.6), (1.5, 2.2))
CURVES = {
    "points": through(*POINTS),
    "released": through(*POINTS, ends="released"),
    "conformal": through(*POINTS, spacing="conformal"),
    "three": through(*POINTS[:3]),
    "two": through(*POINTS[:2]),
    "control points": on(*POINTS, degree=4),
    "polyline": on(*POINTS, degree=1),
    "arcs": cornered(*POINTS, radii=(0.2, 0.1, 0.0)),
    "bend": bend(2.0),
}
PLACES = np.linspace(0.0, 1.0, 97)


@pytest.fixture(params=list(CURVES))
def curve(request):
    return CURVES[request.param]


def test_a_spline_through_points_is_that_of_scipy():
    points = np.array(POINTS)
    sites = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    witness = CubicSpline(sites, points, bc_type="not-a-knot")
    line = CURVES["points"].line(1.0)
    for order in range(3):
        expected = witness(PLACES * sites[-1], order) * sites[-1] ** order
        # rounding, of derivatives as large as 60
        np.testing.assert_allclose(line.values(PLACES, order), expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("count", [3, 4, 5])
def test_a_released_spline_has_no_second_derivative_at_its_start_and_no_third_at_its_end(count):
    line = through(*POINTS[:count], ends="released").line(1.0)
    assert np.max(np.abs(line.values(np.array([0.0]), 2))) < 1e-12
    assert np.max(np.abs(line.values(np.array([1.0]), 3))) < 1e-10
    np.testing.assert_allclose(line.values(line.breaks), POINTS[:count], atol=1e-15)


@pytest.mark.parametrize("name", ["points", "released", "conformal"])
def test_a_spline_through_points_keeps_two_derivatives_at_them(name):
    line = CURVES[name].line(1.0)
    step = 1e-13
    for order in range(3):
        before, after = (line.values(line.breaks[1:-1] + sign * step, order) for sign in (-1.0, 1.0))
        # a step of 1e-13 times the next derivative, of at most a thousand
        np.testing.assert_allclose(before, after, atol=1e-9)


def test_a_conformal_spacing_counts_chords_over_mean_radii():
    line = CURVES["conformal"].line(1.0)
    points = np.array(POINTS)
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    steps = 2.0 * chords / (points[1:, 1] + points[:-1, 1])
    np.testing.assert_allclose(line.counted, steps.sum(), rtol=1e-15)
    np.testing.assert_allclose(np.diff(line.breaks), steps / steps.sum(), rtol=1e-14)


def test_arcs_keep_their_radius_and_are_tangent_to_the_straight_pieces():
    line = cornered((0, 1), (1, 1), (2, 2.5), (4, 2.5), radii=(0.3, 0.5)).line(1.0)
    at = np.linspace(0.0, 1.0, 2001)
    slope, bent = line.values(at, 1), line.values(at, 2)
    curvature = (slope[:, 0] * bent[:, 1] - slope[:, 1] * bent[:, 0]) / np.sum(slope**2, axis=1) ** 1.5
    expected = np.array([0.0, 1.0 / 0.3, -1.0 / 0.5])
    assert np.max(np.min(np.abs(curvature[:, None] - expected), axis=1)) < 1e-11
    assert all(np.any(np.abs(curvature - each) < 1e-11) for each in expected)
    unit = slope / np.linalg.norm(slope, axis=1)[:, None]
    assert np.max(np.linalg.norm(np.diff(unit, axis=0), axis=1)) < 0.01
    assert line.corners == ()


def test_two_corners_are_a_straight_line():
    line = cornered((0.0, 1.0), (3.0, 2.0)).line(1.0)
    np.testing.assert_allclose(line.values(np.array([0.0, 0.5, 1.0])), [[0, 1], [1.5, 1.5], [3, 2]], atol=1e-15)


def test_a_corner_without_a_radius_is_a_joint_without_a_direction():
    line = cornered((0, 1), (1, 1), (1, 2), (2, 2), radii=(0.0, 0.25)).line(1.0)
    assert len(line.corners) == 1
    np.testing.assert_allclose(line.values(np.array(line.corners)), [[1.0, 1.0]], atol=1e-15)


def test_a_bend_without_straight_pieces_is_a_quarter_of_a_circle():
    line = bend(2.0).line(1.0)
    points = line.values(PLACES)
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1] - 3.0), 2.0, rtol=1e-15)
    np.testing.assert_allclose(np.arctan2(points[:, 0], 3.0 - points[:, 1]), PLACES * np.pi / 2.0, atol=3e-15)


def test_the_native_curve_is_the_same_curve(curve):
    line = curve.line(1.0)
    np.testing.assert_allclose(line.curve()(PLACES), line.values(PLACES), atol=5e-15)


def test_a_meridian_carries_an_imaginary_step_of_every_parameter(curve):
    if isinstance(curve, StraightsAndArcs):
        # its parameter is held where pieces join; fractions of the length say where a point of the shape goes
        def points(of):
            return of.line(1.0).at_fraction(PLACES)

        joints = np.ravel(curve.line(1.0).fraction_at(curve.line(1.0).breaks))
    else:

        def points(of):
            return of.line(1.0).values(PLACES)

        joints = curve.line(1.0).breaks
    apart = np.min(np.abs(PLACES[:, None] - joints), axis=1) > 1e-4
    step = 1e-6
    for path, value in curve.parameters().items():
        if path == "radii[2]" or curve is CURVES["bend"]:
            # a corner that stays one has no radius to either side; a bend that fills its legs has no room
            continue
        found = np.imag(points(curve.changed(path, value + 1e-30j))) / 1e-30
        up, down = (points(curve.changed(path, value + sign * step)) for sign in (1.0, -1.0))
        # central differences, of what bends within a tenth; they are wrong within a step of a corner that moves
        np.testing.assert_allclose(found[apart], ((up - down) / (2.0 * step))[apart], atol=2e-9, err_msg=path)


def test_a_batch_of_meridians_is_its_members(curve):
    path = next(iter(curve.parameters()))
    values = curve.parameters()[path] + 1e-30j * np.arange(2)
    both = curve.changed(path, values).line(1.0)
    for i, value in enumerate(values):
        one = curve.changed(path, value).line(1.0)
        for batch, own in ((both.values(PLACES)[i], one.values(PLACES)), (both.net[i], one.net)):
            np.testing.assert_allclose(batch.real, own.real, atol=1e-15)
            np.testing.assert_allclose(batch.imag, own.imag, atol=1e-44)


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_every_number_of_a_flow_path_has_a_path(machine):
    for path, value in machine.parameters().items():
        assert machine.changed(path, value + 0.125).parameters()[path] == value + 0.125


REFUSED = {
    "one point": (lambda: ThroughPoints(points=((0, 1),)), "points has 1 control points: at least 2"),
    "twice": (lambda: through((0, 1), (1, 1), (1, 1)), r"points\[1\] and points\[2\] are the same point"),
    "axis": (lambda: through((0, 0), (1, 1), spacing="conformal"), r"points\[0\].r is 0: .* must be positive"),
    "ends": (lambda: through((0, 0), (1, 1), ends="natural"), "ends is 'natural': it must be one of smooth"),
    "degree": (lambda: ControlPolygon(control_points=((0, 1), (1, 1)), degree=7), "degree is 7"),
    "radii": (lambda: cornered((0, 1), (1, 1), (1, 2), radii=(0.1, 0.1)), "radii has 2 entries, but corners has 1"),
    "negative": (lambda: cornered((0, 1), (1, 1), (1, 2), radii=(-0.1,)), r"radii\[0\] is -0.1"),
    "large": (lambda: cornered((0, 1), (1, 1), (1, 2), radii=(1.5,)).line(1e-3), "take 1.5 of the straight piece"),
    "back": (lambda: cornered((0, 1), (1, 1), (0, 1)).line(1.0), r"corners\[1\]: the line turns back on itself"),
    "no curve": (lambda: FlowPath(hub=(1, 2), shroud=CURVES["two"]), "hub is .*: a curve in"),
    "spans": (lambda: GIVEN.path.changed("stream_spans", (0.2, 0.1, 0.5)), r"stream_spans\[0\] is 0.2"),
    "few spans": (lambda: GIVEN.path.changed("stream_spans", (0.2,)), "stream_spans has 1 entries for 3"),
    "both": (lambda: GIVEN.path.changed("quasi_orthogonals", ((0.4, 0.5),)), "together with stream_surfaces"),
    "pairs": (
        lambda: IMPELLER.path.changed("quasi_orthogonals", ((0.4, 0.5), (0.3, 0.6))),
        r"quasi_orthogonals\[1\]\[0\] is 0.3: fractions of the hub's length must increase .* more than 0.4",
    ),
    "curved back": (
        lambda: stream_surfaces(IMPELLER.path.changed("quasi_orthogonals", ((0.5, 0.02), (0.52, 0.98))), 1.0),
        "turns back near there",
    ),
    "swapped": (
        lambda: stream_surfaces(FlowPath(hub=BEND.path.shroud, shroud=BEND.path.hub), 1.0),
        "hub and shroud are swapped",
    ),
    "crossing": (
        lambda: stream_surfaces(FlowPath(hub=through((0, 1), (2, 2)), shroud=through((0, 1.5), (2, 1.5))), 1.0),
        "the stream surfaces fold over",
    ),
    "on the axis": (
        lambda: stream_surfaces(FlowPath(hub=through((0, -0.1), (1, 0.5)), shroud=through((0, 1), (1, 1))), 1.0),
        "radius -0.1 m at x = 0 m, v = 0.000",
    ),
    "no edges": (lambda: stream_surfaces(GIVEN.path.changed("matched", "edges"), 1.0), "no leading- and trailing-edge"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_paragraph(case):
    make, said = REFUSED[case]
    with pytest.raises(DesignError) as refusal:
        make()
    assert re.search(said, str(refusal.value))
    assert "\n" not in str(refusal.value)
