"""Blades of sections with a clearance: cut off at the stated distance from a wall, and below as they are uncut."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright import cad
from bladewright.blade.design.meridional_curve import StraightsAndArcs
from bladewright.domain.build import passage
from bladewright.errors import DesignError
from bladewright.section.profiles.naca4 import Naca4
from machines import COARSE, built, stacked, stations
from machines.families import FAMILIES
from machines.sectioned import COMPRESSOR, DIFFUSER, IMPELLER, PLATE, VANE, through

STEP = 1e-30
CLEARED = {
    "curvature meanline, pair": COMPRESSOR.changed("tip_clearance", (1.2, 0.7)),
    "suction and pressure side": FAMILIES["suction-pressure"].changed("hub_clearance", 0.8),
    "wedge diffuser": DIFFUSER.changed("tip_clearance", 0.6),
    "camber angle, radial, pair": IMPELLER.changed("tip_clearance", (1.0, 0.4)),
    "profile in a cascade, a third of the span": VANE.changed("hub_clearance", 20.0),
    "blunt edges": PLATE.changed("tip_clearance", 1.0),
    "ruled": stacked.RULED.changed("hub_clearance", (0.5, 0.9)),
    "developable": stacked.MILLED.changed("tip_clearance", 1.0),
    "stacked": stacked.LINE.changed("hub_clearance", 0.7),
}


SLOW = ("suction and pressure side", "developable")


@pytest.fixture(params=[pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else []) for name in CLEARED])
def cleared(request):
    return coarse(request.param)


def coarse(name):
    """The built blade of a name, at the tolerance of tests of what does not depend on it."""
    return built(CLEARED[name].changed("tolerance", COARSE))


def stated(design):
    """The wall, and the design's distances at leading and trailing edge [m]."""
    wall, value = ("hub", design.hub_clearance) if design.tip_clearance is None else ("shroud", design.tip_clearance)
    return wall, 1e-3 * np.array(value if isinstance(value, tuple) else (value, value))


def uncut(design):
    """The same design from wall to wall."""
    return design.changed({"tip_clearance": None, "hub_clearance": None})


def meridional(design, points):
    """(x, r), or (x, z) in a cascade, of points in space."""
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([x, np.hypot(y, z) if design.arrangement == "annular" else z], axis=-1)


def nearest(curve, points):
    """Distances of points (n, 2) from a curve and their parameters, by ever closer looks around the nearest place."""
    t = np.linspace(0.0, 1.0, 2001)
    near = t[np.argmin(np.linalg.norm(curve.values(t)[:, None] - points, axis=-1), axis=0)]
    for _ in range(12):
        width = 10.0 ** -np.arange(4, 10)[:, None] * np.linspace(-6.0, 6.0, 13)
        places = near + width.ravel()[:, None]
        away = np.linalg.norm(curve.values(places.ravel()).reshape(*places.shape, 2) - points, axis=-1)
        near = np.take_along_axis(places, np.argmin(away, axis=0)[None], 0)[0]
    return away.min(axis=0), near


def test_every_promise_is_kept_and_the_cut_end_is_called_tip(cleared):
    wall, _ = stated(cleared.design)
    assert cleared.conformance.kept
    assert cleared.conformance.clearance < 1e-8
    assert cleared.orientations["tip"] == (1 if wall == "shroud" else -1)
    assert {"upper", "lower", "tip", {"hub": "shroud", "shroud": "hub"}[wall]} <= set(cleared.surfaces)


def test_the_tip_stands_at_the_stated_distance_from_the_wall(cleared):
    design = cleared.design
    wall, (leading, trailing) = stated(design)
    exact, row = cleared.exact.without_clearance(), 0 if wall == "hub" else -1
    lines = exact.sections(np.array([0.0, 1.0])[[row]]).lines
    first, last = lines.leading[0], lines.trailing[0]
    for boundary in cleared.surfaces["tip"].boundary:
        points = meridional(design, cleared.surfaces["tip"](*boundary(np.linspace(0.0, 1.0, 40)).T))
        away, foot = nearest(exact.surfaces.matched[row], points)
        u = (foot - first) / (last - first)
        assert away == pytest.approx(leading + (trailing - leading) * u, abs=1e-8 * cleared.chord)


def test_what_is_left_of_the_blade_is_the_uncut_blade(cleared):
    exact, whole = cleared.exact, uncut(cleared.design).exact_blade()
    v, s = np.array([0.0, 0.2, 0.6, 0.9, 0.97, 1.0]), np.array([0.0, 0.003, 0.3, 0.8, 1.0])
    sections = exact.sections(v)
    nodes = sections.uncut.points(s)[0][len(v) :]
    spans = exact.cut.span(v, exact.cut.crossing(nodes).span)
    points = whole.sections(spans.ravel()).points(s)[0].reshape(len(v), len(s), len(s), 3)
    expected = np.stack([points[:, j, j] for j in range(len(s))], axis=1)
    assert np.linalg.norm(sections.points(s)[0] - expected, axis=-1).max() < 1e-9 * cleared.chord
    kept = exact.cut.bend(v) == 0.0
    assert (spans[kept] == v[kept, None]).all()


@pytest.mark.parametrize("name", ["curvature meanline, pair", "stacked"])
def test_below_the_cut_curves_of_constant_v_are_the_designs_sections(name):
    blade = coarse(name)
    heights = np.linspace(0.0, blade.exact.bent_from, 61)
    u, v = np.linspace(0.0, 1.0, 61), heights if blade.exact.cut.end else 1.0 - heights
    whole = uncut(CLEARED[name]).exact_blade().sections(v).points(u)
    for side, own, exact in zip(blade.sides, blade.exact.sections(v).points(u), whole, strict=True):
        # the stretch of the flow path that lengths are counted along may differ: rounding
        assert np.max(np.abs(own - exact)) < 1e-14
        away = np.linalg.norm(side.grid(u, v).swapaxes(0, 1) - exact, axis=-1)
        assert np.max(away) < blade.tolerance * blade.chord


@pytest.mark.parametrize("name", ["blunt edges", "ruled"])
def test_sections_keep_their_span(name):
    cleared = coarse(name)
    whole = uncut(cleared.design).exact_blade()
    for v in whole.section_spans:
        own, other = cleared.section(v), whole.section(v)
        assert own.stagger == other.stagger
        assert np.array_equal(own.curves["upper"].control_points, other.curves["upper"].control_points)
    assert cleared.design.law_ends == ("hub", "shroud")


@pytest.mark.parametrize("name", ["curvature meanline, pair", "ruled"])
def test_stations_are_those_of_the_design_and_areas_those_of_what_is_left(name):
    blade, whole = coarse(name), built(uncut(CLEARED[name].changed("tolerance", COARSE)))
    cut, full = blade.report((0.0, 0.5, 1.0)), whole.report((0.0, 0.5, 1.0))
    # both are within their tolerance of the same exact blade
    for what in ("chord", "stagger", "metal_angle_in", "maximum_thickness", "wrap"):
        assert getattr(cut, what) == pytest.approx(getattr(full, what), rel=30.0 * COARSE)
    for what in ("inlet_area", "outlet_area"):
        assert 0.8 < getattr(cut, what) / getattr(full, what) < 0.999
    assert "clearance cuts it off" in cut.remarks[0]


def test_lines_of_a_ruled_blade_stay_straight():
    blade = coarse("ruled")
    for side in blade.sides:
        first, middle, last = np.moveaxis(side.grid(np.linspace(0.0, 1.0, 41), np.array([0.0, 0.4, 1.0])), 1, 0)
        assert middle == pytest.approx(first + 0.4 * (last - first), abs=1e-15)


def test_the_volume_is_that_of_the_uncut_blade_less_what_is_cut_off():
    # straight sides of one section between plane walls: the tip is the section
    straight = replace(
        VANE,
        flow_path=replace(VANE.flow_path, shroud=through((-60, 50), (120, 50))),
        leading_edge=through((0, 0), (0, 60)),
        trailing_edge=through((40, 0), (40, 60)),
        leading_edge_y=0.0,
        section=Naca4(thickness=0.1, stagger_angle=30.0),
    )
    whole, cut = built(straight), built(straight.changed("tip_clearance", 2.0))
    assert cut.properties.volume / whole.properties.volume == pytest.approx(48.0 / 50.0, rel=1e-9)
    for blade in (coarse("camber angle, radial, pair"), coarse("ruled")):
        assert blade.properties.openness < 1e-8


@pytest.mark.slow
def test_opencascade_cuts_off_the_same_volume():
    import cadquery as cq

    design = CLEARED["curvature meanline, pair"]
    blade, whole = built(design), built(uncut(design))
    meridian = blade.exact.cut.meridian
    line = 1e3 * meridian.values(np.linspace(*meridian.curve().domain, 201))
    (x, r), (end_x, end_r) = line[0], line[-1]
    rest = [(x - 50.0, r), (x - 50.0, 10.0), (end_x + 50.0, 10.0), (end_x + 50.0, end_r)]
    plane = cq.Workplane("XY").moveTo(x, r).spline([tuple(each) for each in line[1:]], includeCurrent=True)
    for each in reversed(rest):
        plane = plane.lineTo(*each)
    below = plane.close().revolve(360.0, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)).val()
    kept = 1e-9 * cad.solid(whole).intersect(below).Volume(1e-10)
    off = whole.properties.volume - blade.properties.volume
    assert whole.properties.volume - kept == pytest.approx(off, rel=1e-4)


DIFFERENTIATED = {
    "curvature meanline, pair": ["tip_clearance[1]", "flow_path.shroud.points[2].r"],
    "ruled": ["hub_clearance[0]"],
    "blunt edges": ["section.stagger_angle[1]"],
}


@pytest.mark.parametrize(
    ("name", "path"),
    [
        pytest.param(name, path, marks=[pytest.mark.slow] if name == "ruled" else [])
        for name in DIFFERENTIATED
        for path in DIFFERENTIATED[name]
    ],
)
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
        # the square of the step, beside rounding of 1e-16 m over it
        assert analytic == pytest.approx(central, abs=1e-5 * np.max(np.abs(analytic)))
    analytic = np.imag(moved.properties.volume) / STEP
    central = (ahead.properties.volume - back.properties.volume) / (2.0 * step)
    assert analytic == pytest.approx(central, rel=1e-4, abs=1e-6 * np.abs(ahead.properties.volume))


def test_a_batch_of_imaginary_steps_is_the_single_steps_one_by_one():
    exact = coarse("camber angle, radial, pair").exact
    design, values = exact.design, exact.design.parameters()
    paths = ["tip_clearance[0]", "tip_clearance[1]", "section.camber_angle[0][1]"]
    changes = {path: values[path] + STEP * 1j * np.eye(len(paths))[i] for i, path in enumerate(paths)}
    v, s = np.array([0.0, 0.9, 1.0]), np.linspace(0.0, 1.0, 17)
    moved = exact.moved_to(design.changed(changes)).sections(v)
    for i, path in enumerate(paths):
        single = exact.moved_to(design.changed(path, values[path] + STEP * 1j)).sections(v)
        for many, one in (
            (moved.points(s)[0], single.points(s)[0]),
            (moved.leading_edge()[2], single.leading_edge()[2]),
        ):
            scale = np.max(np.abs(np.imag(one)))
            assert np.imag(many[i]) == pytest.approx(np.imag(one), abs=1e-12 * scale)


def test_held_knots_hold_those_of_the_cut_too():
    blade = coarse("camber angle, radial, pair")
    design = blade.design
    again = design.build(knots=blade.knots)
    assert np.array_equal(again.sides[0].control_points, blade.sides[0].control_points)
    wider = design.changed("tip_clearance", 1.5).build(knots=blade.knots)
    assert wider.exact.bent_from == blade.exact.bent_from
    assert np.array_equal(wider.exact.tip_knots, blade.knots.tip)


QUICK = ("blunt edges",)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in CLEARED]
)
def test_cad_files_of_the_blade_and_of_its_passage_pass_their_round_trips(name, tmp_path):
    blade = coarse(name)
    around = passage(blade)
    assert around.ring_error == pytest.approx(0.0, abs=1e-8)
    assert around.properties.openness < 1e-6
    assert "tip" in around.surfaces
    for body in (blade, around):
        trip = cad.write(body, tmp_path / f"{body.name}.step", samples=500)
        assert trip.passed, trip.failures


def test_where_an_edge_is_blunt_the_wall_of_the_gap_has_a_face_between_its_halves():
    blade, whole = coarse("wedge diffuser"), built(uncut(CLEARED["wedge diffuser"].changed("tolerance", COARSE)))
    around = passage(blade)
    assert around.wall_error < 1e-7
    assert {"shroud_gap", "tip", "shroud_wake", "hub_wake"} <= set(around.surfaces)
    assert around.surfaces["shroud_gap"].area() == pytest.approx(whole.surfaces["shroud"].area(), rel=1e-9)
    assert around.ring_error == pytest.approx(0.0, abs=1e-8)


CORNERED = replace(
    COMPRESSOR.flow_path, shroud=StraightsAndArcs(corners=((-60, 170), (20, 166), (120, 166)), radii=(0.0,))
)
TIGHT = replace(
    COMPRESSOR.flow_path, shroud=StraightsAndArcs(corners=((-60, 162), (20, 170), (120, 162)), radii=(4.0,))
)


@pytest.mark.parametrize(
    ("design", "changes", "words"),
    [
        (COMPRESSOR, {"tip_clearance": 0.0}, ["tip_clearance is 0", "positive", "leave it out"]),
        (COMPRESSOR, {"hub_clearance": (1.0, -0.5)}, ["hub_clearance[1] is -0.5", "positive"]),
        (COMPRESSOR, {"tip_clearance": (1.0, 2.0, 3.0)}, ["tip_clearance", "leading", "trailing"]),
        (COMPRESSOR, {"tip_clearance": 1.0, "hub_clearance": 1.0}, ["both", "stands on one"]),
        (COMPRESSOR, {"tip_clearance": 80.0}, ["tip_clearance is 80 mm", "the hub is ", "smaller than the span"]),
        (PLATE, {"hub_clearance": 70.0}, ["hub_clearance is 70 mm", "the shroud is ", "lower hub_clearance"]),
        (COMPRESSOR, {"tip_clearance": (1e-3, 2.0)}, ["falls to -", "leading edge", "nearer to each other"]),
        (
            COMPRESSOR,
            {"tip_clearance": 5.0, "flow_path": TIGHT},
            ["radius of curvature", "folds", "flow_path"],
        ),
        (COMPRESSOR, {"tip_clearance": 1.0, "flow_path": CORNERED}, ["corner beside the blade", "round the corner"]),
    ],
)
def test_an_impossible_clearance_is_refused_with_path_value_and_cure(design, changes, words):
    with pytest.raises(DesignError) as refused:
        design.changed(changes).build()
    for word in words:
        assert word in str(refused.value)


@pytest.mark.parametrize("wall", ["tip_clearance", "hub_clearance"])
@pytest.mark.parametrize("clearance", [0.15, 0.75, 1.5, 3.0, 6.0])
def test_knots_of_a_cut_blade_are_equal_or_well_apart(wall, clearance):
    """Of a span of 60: where curves begin to bend, or a span that grows from there, lies on a station of the laws."""
    design = stations.AXIAL["curvature-meanline"].changed(wall, clearance)
    places = np.unique(design.exact_blade().breaks_along_v())
    assert np.diff(places).min() > 1e-3
