"""Blades that stand off a wall: the clearance surface against the design's own numbers, and what a build keeps."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from bladewright import cad
from bladewright.blade.design.flow_path import Channel
from bladewright.blade.exact.unified import exact_unified_blade
from bladewright.errors import DesignError
from bladewright.nurbs.mass_properties import mass_properties
from machines import COARSE, built
from machines.unified import CASCADE, FAN, IMPELLER, INFLOW

PRISM = CASCADE.changed(
    {
        "leading_edge_y": 0.0,
        "stagger": -30.0,
        "metal_angle_in": 20.0,
        "leading_edge_radius": 0.01,
        "channel": Channel(leading_edge=((0, 0), (0, 80)), trailing_edge=((60, 0), (60, 80))),
    }
)
CLEARED = {
    "fan": FAN.changed("tip_clearance", (1.0, 0.6)),
    "impeller, open inlet and narrow outlet": IMPELLER.changed("tip_clearance", (0.5, 0.15)),
    "inflow": INFLOW.changed("tip_clearance", 0.3),
    "cascade": CASCADE.changed("tip_clearance", (1.5, 3.0)),
    "cantilevered stator": FAN.changed("hub_clearance", (0.7, 1.1)),
    "cantilevered cascade": CASCADE.changed("hub_clearance", 2.0),
}
STEP = 1e-30


@pytest.fixture(params=list(CLEARED))
def cleared(request):
    return built(CLEARED[request.param])


def stated(design):
    """The design's clearance: its wall, and the distances at leading and trailing edge [m]."""
    wall, value = ("hub", design.hub_clearance) if design.tip_clearance is None else ("shroud", design.tip_clearance)
    pair = value if isinstance(value, tuple) else (value, value)
    return wall, 1e-3 * np.array(pair)


def curve_of(design, name):
    """A curve of the design's channel [m], made from its numbers alone."""
    channel, end = design.channel, -1 if name == "shroud" else 0
    points = getattr(channel, name)
    if name in {"hub", "shroud"}:
        points = [channel.leading_edge[end], *points, channel.trailing_edge[end]]
    degree = min(len(points) - 1, channel.degree)
    knots = np.concatenate([np.zeros(degree), np.linspace(0, 1, len(points) - degree + 1), np.ones(degree)])
    return BSpline(knots, 1e-3 * np.array(points), degree)


def distances(curve, points):
    """Distances of points (n, 2) from a curve, by ever closer looks around the nearest of many places."""
    low, high = np.full(len(points), -0.15), np.full(len(points), 1.15)
    for _ in range(12):
        t = low + (high - low) * np.linspace(0.0, 1.0, 61)[:, None]
        away = np.linalg.norm(curve(t) - points, axis=-1)
        nearest, step = np.take_along_axis(t, np.argmin(away, axis=0)[None], 0)[0], (high - low) / 60.0
        low, high = nearest - step, nearest + step
    return away.min(axis=0)


def meridional(blade, points):
    """(x, r), or (x, z) in a cascade, of points in space."""
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([x, np.hypot(y, z) if blade.design.arrangement == "annular" else z], axis=-1)


def test_the_end_off_the_wall_is_called_tip_and_every_promise_is_kept(cleared):
    wall, _ = stated(cleared.design)
    other = {"hub": "shroud", "shroud": "hub"}[wall]
    assert set(cleared.surfaces) == set(cleared.orientations) == {"upper", "lower", "tip", other}
    assert cleared.orientations["tip"] == (1 if wall == "shroud" else -1)
    assert cleared.conformance.kept
    assert cleared.conformance.clearance < 1e-8
    assert cleared.conformance.to_dict()["limits"]["clearance"] == 1e-8


def test_the_tip_face_stands_at_the_stated_distance_from_the_wall(cleared):
    wall, (leading, trailing) = stated(cleared.design)
    face = cleared.surfaces["tip"]
    for boundary in face.boundary:
        u, v = boundary(np.linspace(0.0, 1.0, 300)).T
        between = (u >= 0.0) & (u <= 1.0)
        assert between.sum() > 200
        points = meridional(cleared, face(u[between], v[between]))
        meant = leading + (trailing - leading) * u[between]
        found = distances(curve_of(cleared.design, wall), points)
        assert np.max(np.abs(found - meant)) < 1e-8 * cleared.chord


def test_at_its_edges_the_blade_ends_at_the_stated_distance_on_the_edges_of_the_channel(cleared):
    wall, meant = stated(cleared.design)
    v = 1.0 if wall == "shroud" else 0.0
    for u, edge, distance in ((0.0, "leading_edge", meant[0]), (1.0, "trailing_edge", meant[1])):
        point = meridional(cleared, cleared.surfaces["upper"](np.array([u]), v))
        assert distances(curve_of(cleared.design, wall), point) == pytest.approx(distance, abs=1e-8 * cleared.chord)
        # twelve looks at 61 places resolve the parameter to 1e-16: what is left is the blade's own 1e-9
        assert distances(curve_of(cleared.design, edge), point)[0] < 1e-8 * cleared.chord
        other = meridional(cleared, cleared.surfaces["upper"](np.array([u]), 1.0 - v))
        corner = 1e-3 * np.array(getattr(cleared.design.channel, edge)[0 if v else -1])
        assert other[0] == pytest.approx(corner, abs=1e-12)


def test_the_tips_outline_lies_where_the_sides_end(cleared):
    face, v = cleared.surfaces["tip"], 1.0 if cleared.design.ends[1] == "tip" else 0.0
    lower, upper = face.boundary
    s = np.linspace(0.0, 1.0, 401)
    for curve, name, at in ((lower, "lower", s), (upper, "upper", 1.0 - s)):
        gap = face(*curve(s).T) - cleared.surfaces[name](at, v)
        assert np.max(np.linalg.norm(gap, axis=-1)) < 1e-7 * cleared.chord


def test_the_laws_run_from_the_blades_one_end_to_its_other(cleared):
    design = cleared.design
    for v, place in ((0.0, 0), (1.0, -1)):
        section = cleared.section(v)
        for name in ("stagger", "metal_angle_in", "metal_angle_out"):
            law = getattr(design, name)
            asked = law[place] if isinstance(law, tuple) else law
            assert np.degrees(getattr(section, name)) == pytest.approx(asked, abs=1e-10)


@pytest.mark.parametrize("name", ["cantilevered stator", "cascade"])
def test_the_properties_agree_with_the_divergence_theorem_over_all_faces(name):
    for blade in (built(CLEARED[name]), built(CLEARED[name]).extended(0.1)):
        own = blade.properties
        general = mass_properties([(blade.surfaces[face], sign) for face, sign in blade.orientations.items()])
        assert own.volume == pytest.approx(general.volume, rel=1e-7)
        assert own.centroid == pytest.approx(general.centroid, abs=1e-8 * blade.chord)
        assert own.areas == pytest.approx(general.areas, rel=1e-9)
        assert own.openness < 1e-8


@pytest.mark.parametrize(("name", "row"), [("tip_clearance", 1), ("hub_clearance", 0)])
def test_a_prismatic_blade_with_clearance_is_the_same_blade_cut_off(name, row):
    whole, section = PRISM.build(), PRISM.build().section(0.5)
    cut = PRISM.changed(name, 4.0).build()
    assert cut.properties.volume == pytest.approx(section.area * 76e-3, rel=1e-7)
    assert cut.surfaces["tip"].area() == pytest.approx(section.area, rel=1e-7)
    u, v = np.linspace(0.0, 1.0, 33), np.linspace(0.0, 1.0, 5)
    z = v * 76.0 / 80.0 + (0.0 if row else 4.0 / 80.0)
    for side in ("upper", "lower"):
        assert cut.surfaces[side].grid(u, v) == pytest.approx(whole.surfaces[side].grid(u, z), abs=1e-15)


def test_a_blade_of_the_same_section_at_every_radius_is_cut_off_where_its_stream_lines_are():
    laws = {"stagger": 30.0, "metal_angle_in": 40.0, "metal_angle_out": 15.0, "leading_edge_theta": 0.0}
    cylinders = Channel(leading_edge=((0, 100), (0, 140)), trailing_edge=((50, 100), (50, 140)))
    design = FAN.changed({**laws, "leading_edge_radius": 0.003, "trailing_edge_radius": 0.003, "channel": cylinders})
    whole, cut = exact_unified_blade(design), exact_unified_blade(design.changed("tip_clearance", 3.0))
    v, s = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 33)
    for short, long in zip(cut.sections(v).points(s), whole.sections(37.0 / 40.0 * v).points(s), strict=True):
        assert short == pytest.approx(long, abs=1e-14)


@pytest.mark.parametrize(("degree", "name"), [(2, "tip_clearance"), (3, "hub_clearance")])
def test_a_wall_with_joints_is_followed_as_well(degree, name):
    places = np.linspace(0.0, 1.0, 8)[1:-1]
    walls = {f"channel.{wall}": tuple(map(tuple, 1e3 * curve_of(CASCADE, wall)(places))) for wall in ("hub", "shroud")}
    blade = CASCADE.changed({**walls, "channel.degree": degree, name: 0.5}).build()
    assert blade.conformance.kept
    # the foot passes the wall's joint elsewhere than the line u = const does that of the channel
    inner, counts = np.unique(blade.knots.tip[6:-6], return_counts=True)
    joints = inner[counts == 6 - degree]
    assert len(joints) == 2 * (8 - degree - 1)
    assert np.min(np.diff(joints)) > 1e-5


def test_without_a_clearance_the_blades_channel_is_the_whole_one():
    exact = exact_unified_blade(FAN)
    assert exact.channel is exact.full_channel
    assert exact.clearance is None
    assert exact.tip_knots is None


def test_held_knots_hold_those_of_the_clearance_surface_too(cleared):
    again = cleared.design.build(knots=cleared.knots)
    assert np.array_equal(again.knots.tip, cleared.knots.tip)
    assert np.array_equal(again.surfaces["tip"].surface.control_points, cleared.surfaces["tip"].surface.control_points)
    name = "tip_clearance" if cleared.design.hub_clearance is None else "hub_clearance"
    wider = cleared.design.changed(name, 1.7).build(knots=cleared.knots)
    assert np.array_equal(wider.exact.tip_knots, cleared.knots.tip)


def test_the_extended_blade_grows_past_the_wall_that_it_stands_on_only(cleared):
    longer = cleared.extended(0.1)
    assert longer.surfaces["tip"] is cleared.surfaces["tip"]
    low, high = (0.0 if name == "tip" else 0.1 for name in cleared.design.ends)
    u, v = np.linspace(0.0, 1.0, 31), np.linspace(0.0, 1.0, 9)
    for name in ("upper", "lower"):
        inside = longer.surfaces[name].grid(u, (v + low) / (1.0 + low + high))
        assert inside == pytest.approx(cleared.surfaces[name].grid(u, v), abs=1e-13)
    assert longer.properties.volume > cleared.properties.volume
    assert longer.properties.openness < 1e-8


DIFFERENTIATED = {
    "impeller, open inlet and narrow outlet": [
        "tip_clearance[0]",
        "tip_clearance[1]",
        "channel.shroud[1].r",
        "channel.leading_edge[1].r",
        "channel.trailing_edge[0].x",
    ],
    "cantilevered cascade": ["hub_clearance", "channel.leading_edge[0].x", "channel.hub[1].r"],
}


@pytest.mark.parametrize(("name", "path"), [(name, path) for name in DIFFERENTIATED for path in DIFFERENTIATED[name]])
def test_the_complex_step_is_the_derivative_at_held_knots(name, path):
    design = CLEARED[name].changed("tolerance", COARSE)
    knots, value = built(design).knots, design.parameters()[path]
    step = 1e-3
    moved = design.changed(path, value + STEP * 1j).build(knots=knots)
    ahead, back = (design.changed(path, value + sign * step).build(knots=knots) for sign in (1, -1))
    for side in ("upper", "lower"):
        analytic = np.imag(moved.surfaces[side].control_points) / STEP
        central = (ahead.surfaces[side].control_points - back.surfaces[side].control_points) / (2.0 * step)
        assert np.max(np.abs(analytic)) > 0.0
        # the square of a step of 1e-3 mm, beside rounding of 1e-16 m over it
        assert analytic == pytest.approx(central, abs=1e-6 * np.max(np.abs(analytic)))
    for what in ("volume", "area"):
        analytic = np.imag(getattr(moved.properties, what)) / STEP
        central = (getattr(ahead.properties, what) - getattr(back.properties, what)) / (2.0 * step)
        assert analytic == pytest.approx(central, rel=1e-5)


def test_a_batch_of_imaginary_steps_is_the_single_steps_one_by_one():
    design = CLEARED["impeller, open inlet and narrow outlet"]
    paths = ["tip_clearance[0]", "tip_clearance[1]", "channel.shroud[1].r", "channel.leading_edge[1].x", "stagger[1]"]
    values, changes = design.parameters(), {}
    for i, path in enumerate(paths):
        steps = np.full(len(paths), values[path], dtype=complex)
        steps[i] += STEP * 1j
        changes[path] = steps
    v, s = np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 17)
    batch = np.stack(exact_unified_blade(design.changed(changes)).sections(v).points(s))
    for i, path in enumerate(paths):
        single = np.stack(exact_unified_blade(design.changed(path, values[path] + STEP * 1j)).sections(v).points(s))
        scale = np.max(np.abs(np.imag(single)))
        assert scale > 0.0
        assert np.imag(batch[:, i]) == pytest.approx(np.imag(single), abs=1e-13 * scale)


@pytest.mark.parametrize(
    ("name", "suffix"),
    [
        ("impeller, open inlet and narrow outlet", ".step"),
        ("cantilevered cascade", ".igs"),
        pytest.param("impeller, open inlet and narrow outlet", ".igs", marks=pytest.mark.slow),
        pytest.param("cantilevered cascade", ".step", marks=pytest.mark.slow),
    ],
)
def test_a_cad_file_holds_the_tip_by_its_name_and_passes_its_round_trip(name, suffix, tmp_path):
    blade = built(CLEARED[name])
    trip = cad.write(blade, tmp_path / f"blade{suffix}", samples=1000)
    assert trip.passed, trip.failures
    assert [face.name for face in trip.faces] == list(blade.surfaces)
    assert "tip" in blade.surfaces


@pytest.mark.parametrize(
    ("design", "changes", "words"),
    [
        (FAN, {"tip_clearance": 0.0}, ["tip_clearance is 0", "positive", "leave it out"]),
        (FAN, {"hub_clearance": (1.0, -0.5)}, ["hub_clearance[1] is -0.5", "positive"]),
        (FAN, {"tip_clearance": float("inf")}, ["tip_clearance", "finite"]),
        (FAN, {"tip_clearance": float("nan")}, ["tip_clearance", "finite"]),
        (FAN, {"tip_clearance": "wide"}, ["tip_clearance", "'wide'", "number"]),
        (FAN, {"tip_clearance": (1.0,)}, ["tip_clearance", "leading", "trailing"]),
        (FAN, {"tip_clearance": ()}, ["tip_clearance", "leading", "trailing"]),
        (FAN, {"tip_clearance": (1.0, 2.0, 3.0)}, ["tip_clearance", "leading", "trailing"]),
        (
            FAN,
            {"tip_clearance": 1.0, "hub_clearance": 1.0},
            ["tip_clearance", "hub_clearance", "both", "stands on one"],
        ),
        (FAN, {"tip_clearance": 160.0}, ["tip_clearance is 160 mm", "u = ", "the hub is 13", "smaller than the span"]),
        # 6 mm wide at the trailing edge
        (IMPELLER, {"tip_clearance": (0.5, 6.0)}, ["6 mm at u = 1.000", "the hub is 6 mm", "lower tip_clearance"]),
        (IMPELLER, {"hub_clearance": 7.0}, ["hub_clearance is 7 mm at u = 1.000", "the shroud is 6 mm", "lower"]),
        (CASCADE, {"tip_clearance": 100.0}, ["tip_clearance is 100 mm", "mm from the shroud", "lower"]),
        (FAN, {"tip_clearance": 8.0, "channel.shroud[0].r": 262.0}, ["curvature", "folds over", "channel.shroud"]),
        # linear in u they would be nothing at u = -0.0001 and 1.0001, and the noses reach further
        (FAN, {"tip_clearance": (1e-4, 1.0)}, ["tip_clearance", "u = -0.0", "leading edge", "nearer to each other"]),
        (CASCADE, {"hub_clearance": (1.0, 1e-4)}, ["hub_clearance", "u = 1.0", "trailing edge", "meet the hub"]),
        (FAN, {"tip_clearance": 1.0, "channel.hub[0].r": 290.0}, ["channel", "fold"]),
    ],
)
def test_an_impossible_clearance_is_refused_with_path_value_and_cure(design, changes, words):
    with pytest.raises(DesignError) as caught:
        design.changed(changes).build()
    message = str(caught.value)
    assert all(word in message for word in words), message
    assert "\n" not in message
