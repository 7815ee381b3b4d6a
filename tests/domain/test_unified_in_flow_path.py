"""Passages of unified blades in a flow path: they follow it to its ends, and go on straight past them."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from bladewright import cad
from bladewright.domain.build import passage
from bladewright.domain.kinks import kinks
from machines import COARSE, built
from machines.flow_paths import cornered
from machines.unified_paths import DESIGNS, FAN_IN_PATH, IMPELLER_IN_PATH, INFLOW_IN_PATH

INNER = np.linspace(1e-9, 1.0 - 1e-9, 61)


@pytest.fixture(scope="module")
def passages():
    return {name: passage(built(design.changed("tolerance", COARSE))) for name, design in DESIGNS.items()}


@pytest.fixture(params=list(DESIGNS))
def around(request, passages):
    return passages[request.param]


def meridian(around, name, u, v):
    """(x, r) of points of a face."""
    points = around.surfaces[name](u, v)
    return np.stack([points[..., 0], np.hypot(points[..., 1], points[..., 2])], axis=-1)


def path_of(around, wall):
    design = around.blade.design
    return getattr(design.flow_path, wall).line(design.metre)


def distances(line, points):
    """Distances (m,) of points from a meridian, by Newton's method from the nearest of many of its points."""
    t = np.linspace(0.0, 1.0, 2001)
    t = t[cKDTree(line.values(t)).query(points)[1]]
    for _ in range(4):
        miss, slope = points - line.values(t), line.values(t, 1)
        t = np.clip(t + np.sum(miss * slope, axis=-1) / np.sum(slope**2, axis=-1), 0.0, 1.0)
    return np.linalg.norm(points - line.values(t), axis=-1)


def test_the_duct_reaches_from_end_to_end_of_the_flow_path(around):
    for row, wall in enumerate(("hub", "shroud")):
        line, duct = path_of(around, wall), around.duct
        ends = duct.lines(np.array([0.0, 1.0])).position(np.array([duct.low, duct.high]))[row]
        np.testing.assert_allclose(ends, line.values(np.array([0.0, 1.0])), atol=1e-14)
        for name, end in (("inlet", 0.0), ("outlet", 1.0)):
            corner = meridian(around, name, np.array([0.3]), np.array([float(row)]))
            np.testing.assert_allclose(corner, line.values(np.array([end])), atol=1e-8 * around.blade.chord)


def test_walls_lie_on_the_flow_path_from_end_to_end(around):
    """The duct's to rounding, the passage's within what its walls may be off."""
    u = around.duct.low + (around.duct.high - around.duct.low) * INNER
    lines = around.duct.lines(np.array([0.0, 1.0])).position(u)
    random = np.random.default_rng(2)
    for row, wall in enumerate(("hub", "shroud")):
        line = path_of(around, wall)
        assert np.max(distances(line, lines[row])) < 1e-12 * around.blade.chord
        for half in ("upper", "lower"):
            points = meridian(around, f"{wall}_{half}", random.random(200), random.random(200))
            assert np.max(distances(line, points)) < 1e-7 * around.blade.chord


def test_beside_the_blade_the_duct_is_the_blades_own_channel(around):
    exact = around.blade.exact
    u, v = np.linspace(-exact.before, 1.0 + exact.after, 31), np.linspace(0.0, 1.0, 7)
    own = np.stack([exact.full_channel.at(u, np.full_like(u, each))[0] for each in v])
    np.testing.assert_allclose(around.duct.lines(v).position(u), own, atol=1e-12 * around.blade.chord)


def test_stream_lines_of_the_duct_keep_their_curvature(around):
    """But where the walls have kinks of their own."""
    duct, v = around.duct, np.array([0.3, 0.6])
    own = np.concatenate([kinks(duct, row) for row in (0, 1)])
    joints = np.setdiff1d(duct.joints_within(), own)
    before, behind = (duct.stream_polynomials(v, joints + step) for step in (-1e-9, 1e-9))
    for order in range(3):
        scale = np.max(np.abs(behind[..., order, :]))
        np.testing.assert_allclose(before[..., order, :], behind[..., order, :], atol=1e-6 * scale)


def test_passage_and_blade_fill_the_duct_and_no_patch_folds(around):
    assert abs(around.ring_error) < 5e-9
    assert min(share for share, _, _ in around.folds.values()) > 0.05


def test_a_radial_inlet_stays_radial_and_a_flat_hub_flat(passages):
    inlet = passages[INFLOW_IN_PATH.name]
    for row, x in ((0, 0.0), (1, 6.5e-3)):
        u = np.linspace(inlet.duct.low, kinks(inlet.duct, row)[0], 21)
        points = inlet.duct.lines(np.array([float(row)])).position(u)[0]
        np.testing.assert_allclose(points[:, 0], x, atol=1e-12)
    behind = np.linspace(kinks(inlet.duct, 0)[-1], inlet.duct.high, 21)
    np.testing.assert_allclose(inlet.duct.lines(np.zeros(1)).position(behind)[0, :, 1], 14.5e-3, atol=1e-12)


def test_longer_extents_go_on_straight_and_shorter_ones_cut(passages):
    whole = passages[IMPELLER_IN_PATH.name]
    longer = passage(whole.blade, upstream=whole.knots.upstream + 0.5, downstream=0.3)
    assert longer.wall_error <= 1e-7
    u = np.linspace(longer.duct.low, whole.duct.low, 11)
    points = longer.duct.lines(np.array([0.0, 1.0])).position(u)
    np.testing.assert_allclose(points[..., 1], [[16e-3], [42e-3]] * np.ones(11), atol=1e-12)
    assert longer.duct.high < whole.duct.high
    assert abs(longer.ring_error) < 5e-9


def test_bent_walls_go_on_straight_too():
    made = passage(built(FAN_IN_PATH.changed("tolerance", COARSE)), upstream=2.5, downstream=2.0)
    for row, wall in enumerate(("hub", "shroud")):
        point, slope = (path_of(made, wall).values(np.array([1.0]), order)[0] for order in (0, 1))
        u = np.linspace(made.knots.end, made.duct.high, 5)
        beyond = made.duct.lines(np.array([float(row)])).position(u)[0] - point
        away = beyond @ np.array([slope[1], -slope[0]]) / np.hypot(*slope)
        np.testing.assert_allclose(away, 0.0, atol=1e-13)
    assert made.wall_error <= 1e-7


def test_walls_follow_a_corner_ahead_of_the_blade():
    hub = cornered((-40.0, 86.0), (-25.0, 93.0), (150.0, 123.0))
    made = passage(built(FAN_IN_PATH.changed({"flow_path.hub": hub, "tolerance": COARSE})))
    assert made.knots.start == made.knots.low
    assert kinks(made.duct, 0, corners=True).size == 1
    assert made.wall_error <= 1e-7


@pytest.mark.parametrize(
    ("design", "path"),
    [
        pytest.param(FAN_IN_PATH, "flow_path.hub.points[0].r", marks=pytest.mark.slow),
        (INFLOW_IN_PATH, "flow_path.shroud.radii[0]"),
        pytest.param(IMPELLER_IN_PATH, "channel.leading_edge[1].x", marks=pytest.mark.slow),
    ],
    ids=lambda each: getattr(each, "name", each),
)
def test_poles_follow_the_parameters(design, path):
    blade = built(design.changed("tolerance", COARSE))
    made = passage(blade)
    value = design.parameters()[path]

    def found(changed):
        again = passage(blade.design.changed(path, changed).build(knots=blade.knots), knots=made.knots)
        return np.concatenate(
            [again.surfaces[name].control_points.ravel() for name in ("hub_upper", "inlet", "outlet")]
        )

    exact = np.imag(found(value + 1e-30j)) / 1e-30
    step = 1e-3 * max(1.0, abs(value))

    def difference(h):
        return (found(value + h) - found(value - h)) / (2.0 * h)

    richardson = (4.0 * difference(step / 2.0) - difference(step)) / 3.0
    np.testing.assert_allclose(richardson, exact, rtol=0, atol=1e-6 * np.max(np.abs(exact)))
    assert np.max(np.abs(exact)) > 0.0


@pytest.mark.parametrize(
    "design",
    [INFLOW_IN_PATH, *(pytest.param(each, marks=pytest.mark.slow) for each in (FAN_IN_PATH, IMPELLER_IN_PATH))],
)
def test_blade_and_passage_pass_their_round_trips(design, passages, tmp_path):
    around = passages[design.name]
    for name, body in (("blade", around.blade), ("passage", around)):
        trip = cad.write(body, tmp_path / f"{name}.step", samples=500)
        assert trip.passed, trip.failures
