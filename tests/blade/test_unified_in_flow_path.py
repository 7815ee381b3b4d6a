"""Unified blades in a flow path: walls, cut edges, straight ends, derivatives through the cuts, and what is refused."""

import numpy as np
import pytest

from bladewright.blade.design.flow_path import Channel, FlowPath
from bladewright.blade.exact.unified import exact_unified_blade
from bladewright.errors import DesignError
from bladewright.nurbs.closest import closest_on_curve
from machines import COARSE, built
from machines.flow_paths import cornered, on, through
from machines.unified import CASCADE
from machines.unified_paths import DESIGNS, FAN_IN_PATH, IMPELLER_IN_PATH, INFLOW_IN_PATH

ENDS = (("hub", 0.0), ("shroud", 1.0))


@pytest.fixture(scope="module", params=list(DESIGNS))
def blade(request):
    return built(DESIGNS[request.param])


def test_it_keeps_all_that_a_blade_keeps(blade):
    assert blade.conformance.kept, blade.conformance
    assert blade.approximation_error.distance < 1e-6


def test_its_ends_lie_on_the_flow_path_past_the_edges_too(blade):
    exact = blade.exact
    u = np.linspace(*exact.full_channel.hub.ends, 41)
    for name, v in ENDS:
        inside = u[(u > exact.full_channel.line(name).ends[0]) & (u < exact.full_channel.line(name).ends[1])]
        points = exact.full_channel.at(inside, np.full_like(inside, v))[0]
        curve = getattr(exact.design.flow_path, name).line(exact.design.metre).curve()
        assert np.max(closest_on_curve(curve, points).distances) < 1e-13


def test_u_is_in_proportion_to_the_length_of_each_wall(blade):
    for name, _ in ENDS:
        slope = blade.exact.full_channel.line(name).values(np.linspace(0.0, 1.0, 51), 1)
        speed = np.sqrt(np.sum(slope**2, axis=-1))
        np.testing.assert_allclose(speed, speed[0], rtol=1e-11)


def test_its_edges_lie_on_the_curves_of_the_design_and_end_on_the_walls(blade):
    channel, v = blade.exact.full_channel, np.linspace(0.0, 1.0, 33)
    for name, u in (("leading_edge", 0.0), ("trailing_edge", 1.0)):
        points = channel.at(np.full_like(v, u), v)[0]
        extended = channel.line(name).curve_over(-0.1, 1.1)
        assert np.max(closest_on_curve(extended, points).distances) < 1e-12
        for wall, end in ((channel.hub, 0), (channel.shroud, -1)):
            np.testing.assert_allclose(points[end], wall.values(np.array([u]))[0], atol=1e-15)


def test_past_its_ends_the_flow_path_goes_on_straight(blade):
    for name, _ in ENDS:
        wall = blade.exact.full_channel.line(name)
        line = getattr(blade.design.flow_path, name).line(blade.design.metre)
        for end, (u, away) in enumerate(zip(wall.ends, (-1.0, 1.0), strict=True)):
            point, slope = (line.values(np.array([float(end)]), order)[0] for order in (0, 1))
            slope = slope / np.hypot(*slope)
            beyond = wall.values(u + away * np.array([0.0, 0.1, 0.7])) - point
            np.testing.assert_allclose(beyond[:, 0] * slope[1] - beyond[:, 1] * slope[0], 0.0, atol=2e-14)
            assert np.all(away * np.diff(beyond @ slope) > 0.0)


def test_a_radial_inlet_stays_radial_and_a_flat_hub_flat():
    inflow, impeller = (built(each).exact.full_channel for each in (INFLOW_IN_PATH, IMPELLER_IN_PATH))
    for wall, x in ((inflow.hub, 0.0), (inflow.shroud, 6.5e-3)):
        inlet = wall.values(np.linspace(wall.ends[0] - 1.0, wall.ends[0] + 0.1, 21))
        np.testing.assert_allclose(inlet[:, 0], x, atol=1e-15)
    behind = inflow.hub.values(np.linspace(1.4, 3.0, 21))
    np.testing.assert_allclose(behind[:, 1], 14.5e-3, atol=1e-15)
    ahead = impeller.hub.values(impeller.hub.ends[0] - np.linspace(0.0, 1.0, 5))
    np.testing.assert_allclose(ahead[:, 1], 16e-3, atol=1e-15)


def test_straight_walls_give_the_blade_of_the_channel_without_a_flow_path():
    """Where walls have equal speed in both parameters nothing else may differ."""
    edges = {"leading_edge": ((0.0, 0.0), (1.0, 50.0), (1.0, 100.0)), "trailing_edge": ((60.0, 3.0), (58.0, 97.0))}
    plain = CASCADE.changed("channel", Channel(**edges))
    longer = {name: ((2 * a[0] - b[0], 2 * a[1] - b[1]), (2 * b[0] - a[0], 2 * b[1] - a[1]))
              for name, a, b in (("hub", (0.0, 0.0), (60.0, 3.0)), ("shroud", (1.0, 100.0), (58.0, 97.0)))}  # fmt: skip
    path = FlowPath(**{name: on(*points) for name, points in longer.items()})
    blade = plain.build()
    same = plain.changed("flow_path", path).build(knots=blade.knots)
    for name in ("upper", "lower"):
        np.testing.assert_allclose(
            same.surfaces[name].control_points, blade.surfaces[name].control_points, atol=1e-13 * blade.chord
        )


@pytest.mark.parametrize("clearance", ["tip_clearance", "hub_clearance"])
@pytest.mark.parametrize("design", [IMPELLER_IN_PATH, INFLOW_IN_PATH], ids=lambda each: each.name)
def test_a_clearance_keeps_its_distance(design, clearance):
    blade = design.changed({clearance: (0.5, 0.3), "tolerance": COARSE}).build()
    assert blade.conformance.kept, blade.conformance
    assert blade.conformance.clearance < 1e-8


def test_a_nose_may_stand_past_the_end_of_the_flow_path():
    path = FlowPath(hub=through((0.0, 96.0), (89.0, 117.0)), shroud=through((23.0, 255.0), (65.0, 248.0)))
    edges = Channel(leading_edge=((0.0, 96.0), (23.0, 255.0)), trailing_edge=((88.0, 116.0), (64.0, 249.0)))
    blade = FAN_IN_PATH.changed({"flow_path": path, "channel": edges, "tolerance": COARSE}).build()
    assert blade.exact.full_channel.hub.ends[0] == pytest.approx(0.0, abs=1e-9)
    assert blade.conformance.kept, blade.conformance


PARAMETERS = [
    (FAN_IN_PATH, "flow_path.hub.points[2].r"),
    pytest.param(FAN_IN_PATH, "channel.leading_edge[3].x", marks=pytest.mark.slow),
    (IMPELLER_IN_PATH, "flow_path.shroud.control_points[3].x"),
    pytest.param(IMPELLER_IN_PATH, "channel.trailing_edge[0].r", marks=pytest.mark.slow),
    pytest.param(INFLOW_IN_PATH, "flow_path.shroud.radii[0]", marks=pytest.mark.slow),
    (INFLOW_IN_PATH.changed("tip_clearance", 0.4), "flow_path.shroud.corners[1].r"),
]


@pytest.mark.parametrize(("design", "path"), PARAMETERS, ids=lambda each: getattr(each, "name", each))
def test_derivatives_go_through_the_cuts(design, path):
    start = built(design.changed("tolerance", COARSE))
    value = design.parameters()[path]

    def poles(changed):
        blade = start.design.changed(path, changed).build(knots=start.knots)
        return np.concatenate([blade.surfaces[name].control_points.ravel() for name in ("upper", "lower")])

    exact = np.imag(poles(value + 1e-30j)) / 1e-30
    step = 1e-3 * abs(value)

    def difference(h):
        return (poles(value + h) - poles(value - h)) / (2.0 * h)

    # Richardson's step leaves an error of the fourth power of the step, and rounding over it
    found = (4.0 * difference(step / 2.0) - difference(step)) / 3.0
    np.testing.assert_allclose(found, exact, rtol=0, atol=2e-7 * np.max(np.abs(exact)))
    assert np.max(np.abs(exact)) > 0.0


REFUSED = [
    ({"channel.hub": ((20.0, 100.0),)}, r"channel\.hub is given together with flow_path.*leave channel\.hub out"),
    ({"flow_path.quasi_orthogonals": ((0.4, 0.5),)}, r"flow_path\.quasi_orthogonals is given.*leave"),
    ({"flow_path.stream_surfaces": (through((-80, 150), (150, 160)),)}, r"flow_path\.stream_surfaces is given"),
    ({"flow_path.matched": "edges"}, "flow_path.matched is 'edges'"),
    ({"flow_path": "hub"}, "flow_path is 'hub': a FlowPath"),
    (
        {"channel.leading_edge[0].r": 130.0},
        r"channel\.leading_edge does not meet flow_path\.hub: they pass 0\.03\d+ m apart.*lengthen",
    ),
    (
        {"channel.leading_edge": ((-120.0, 80.0), (-120.0, 270.0))},
        r"channel\.leading_edge does not meet flow_path\.hub.*lengthen hub and shroud",
    ),
    (
        {
            "channel.leading_edge": FAN_IN_PATH.channel.trailing_edge,
            "channel.trailing_edge": FAN_IN_PATH.channel.leading_edge,
        },
        "cross or are swapped: on flow_path.hub",
    ),
]


@pytest.mark.parametrize(("changes", "said"), REFUSED)
def test_what_cannot_be_is_refused_with_its_cure(changes, said):
    with pytest.raises(DesignError, match=said):
        exact_unified_blade(FAN_IN_PATH.changed(changes))


def test_a_cascade_has_a_flow_path_too():
    path = FlowPath(hub=through((-30.0, 0.0), (90.0, 2.0)), shroud=cornered((-30.0, 100.0), (90.0, 97.0)))
    edges = Channel(leading_edge=((0.0, -2.0), (1.0, 102.0)), trailing_edge=((60.0, -1.0), (58.0, 99.0)))
    blade = CASCADE.changed({"flow_path": path, "channel": edges, "tolerance": COARSE}).build()
    assert blade.conformance.kept, blade.conformance
