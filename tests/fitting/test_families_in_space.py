"""Blades from sections, found again from points in space."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from bladewright.errors import FitError
from bladewright.fitting import free_parameters
from bladewright.fitting.assessment.acceptance import MatchTarget
from bladewright.fitting.families import blades, first_blades
from bladewright.fitting.families.blades import contours_along, matched_blade
from bladewright.fitting.families.closed_blade import CONTINUATIONS, ClosedChannel, section_shape, unrolled
from bladewright.fitting.families.first_blades import (
    LAW_COUNT,
    part_along_span,
    with_mean_laws,
)
from bladewright.fitting.families.kinds import FAMILIES, DesignHeader
from bladewright.fitting.families.sections import CONTOUR_POINTS, misfits
from bladewright.fitting.fit import fit
from bladewright.fitting.free_parameters import FreeParameters, gauge_parameters, scales_of, sliding_coordinate
from bladewright.fitting.initial_guess.blade import UPRIGHT
from bladewright.fitting.matching.footpoints import footpoints_at, nearest_footpoints
from bladewright.fitting.matching.search import Task
from bladewright.fitting.model_selection.structure import structure_of
from bladewright.fitting.models.model import FACE_SHARE, model_of, sides_of
from bladewright.section.laws import Span, law_points, named_laws
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.wedge_diffuser import WedgeDiffuser, WedgeDiffuserSection
from machines import example
from machines.sectioned import BLUNT, COMPRESSOR, DESIGNS, DIFFUSER

VANE = replace(DIFFUSER, tolerance=1e-4)
"""a blade that is built fast"""
MODELS = {each.name: replace(each, tolerance=1e-3) for each in (DIFFUSER, DESIGNS["inlet-vane"], BLUNT)}


@cache
def cloud(count=120):
    """Points of the vane [m]."""
    random = np.random.default_rng(4)
    return np.concatenate([side(*random.random((2, count))) for side in sides_of(VANE.build())])


def shaken(design, part=0.05):
    """The design with every parameter that a fit finds moved by a part of what matters."""
    paths, values = FreeParameters()(design), design.parameters()
    size = scales_of(design, paths, 0.1).size
    random = np.random.default_rng(3)
    return design.changed(
        {p: float(values[p] + part * s * random.uniform(-1.0, 1.0)) for p, s in zip(paths, size, strict=True)}
    )


@pytest.mark.parametrize("name", MODELS)
def test_the_derivatives_of_a_blades_sides_are_those_of_the_sides_built_with_a_difference(name):
    design = MODELS[name]
    model, paths = model_of(design, 1e-7), FreeParameters()(design)
    values, sizes = design.parameters(), scales_of(design, paths, model.chord).size
    direction = sizes * np.random.default_rng(5).uniform(0.5, 1.0, len(paths))
    shape, random = model.shape(design), np.random.default_rng(6)
    # a blunt face moves as a straight one does
    own = 1.0 - FACE_SHARE if model.blunt[1] else 1.0
    points = np.concatenate([side(own * random.random(40), random.random(40)) for side in shape.sides])
    on, ends = nearest_footpoints(points, shape.sides), []
    for step in (1e-5, -1e-5):
        changed = {path: float(values[path] + step * way) for path, way in zip(paths, direction, strict=True)}
        sides = model.shape(design.changed(changed)).sides
        ends.append(footpoints_at(points, sides, on.side, on.u, on.v).points)
    for axis, slope in zip(np.eye(3), ((ends[0] - ends[1]) / 2e-5).T, strict=True):
        rates = model.along(shape, on, np.broadcast_to(axis, points.shape), paths)
        # of second order in the step, as of sections
        assert rates @ direction == pytest.approx(slope, abs=1e-6 * model.chord)


@pytest.mark.slow
def test_a_vane_is_found_again_from_a_start_that_is_off():
    found = fit(cloud(), start=shaken(VANE))
    assert found.maximum < 1e-9 * found.built.chord
    assert found.passed
    assert not any(each.path.startswith("flow_path") for each in found.estimates)


def test_a_start_takes_the_structure_of_another_design():
    like = VANE.changed("leading_edge_theta", (0.0, 0.0))
    found = fit(cloud(), start=VANE, like=like)
    assert found.maximum < 1e-9 * found.built.chord
    assert structure_of(found.design) == structure_of(like)


def test_flow_path_and_the_way_along_edge_curves_stand():
    assert gauge_parameters(COMPRESSOR.changed("density", 7800.0)) - gauge_parameters(COMPRESSOR) == {"density"}
    held = gauge_parameters(COMPRESSOR)
    assert {"flow_path.hub.points[0].x", "leading_edge.points[1].r", "section.curvature[1]"} <= held
    assert "leading_edge.points[1].x" not in held
    assert sliding_coordinate(COMPRESSOR, "trailing_edge") == "r"
    assert sliding_coordinate(DIFFUSER, "trailing_edge") == "x"


def test_a_part_of_laws_is_made_again_from_its_sections_and_its_numbers_of_control_points():
    part, v = DESIGNS["compressor-rotor"].section, np.linspace(0.0, 1.0, 7)
    at = Span(v)
    parts = []
    for i in range(len(v)):
        numbers = with_mean_laws(part).parameters()
        angles = {name: float(at.values(getattr(part, name))[i]) for name in ("metal_angle_in", "metal_angle_out")}
        parts.append(with_mean_laws(part).changed({path: angles.get(path, value) for path, value in numbers.items()}))
    counts = {path: len(law_points(law)) for path, law in named_laws(part)}
    again = part_along_span(parts, counts)
    assert again.metal_angle_in == pytest.approx(part.metal_angle_in, abs=1e-9)
    assert {path: len(law_points(law)) for path, law in named_laws(again)} == counts


def test_a_section_for_the_flow_from_the_other_side_has_its_edges_exchanged_and_its_sides_kept():
    shape = section_shape(COMPRESSOR.build().section(0.5))
    other = shape.reversed()
    assert np.all(np.interp(0.5, *other.upper.T) > np.interp(0.5, *other.lower.T))
    assert other.radii == shape.radii[::-1]
    again = other.reversed()
    assert again.upper == pytest.approx(shape.upper, abs=1e-15)
    assert again.start == pytest.approx(shape.start, abs=1e-15)
    assert again.stagger == shape.stagger


def test_edges_of_another_kind_than_points_are_refused():
    with pytest.raises(FitError, match="give the design as start"):
        ClosedChannel(exact=None).edge_like("leading_edge", None, 1e-3)


def test_an_edge_whose_corner_has_slid_along_its_wall_runs_on_as_the_rest_of_it():
    lines = {
        "trailing_edge": lambda t: 1e-3 * np.stack([51.0 - 8.0 * t, 100.0 + 4.0 * np.exp(-t / 0.05)], axis=-1),
        "hub": lambda t: 1e-3 * np.stack([51.0 + 0.0 * t, 55.0 + 49.0 * t], axis=-1),
        "shroud": lambda t: 1e-3 * np.stack([43.0 + 0.0 * t, 55.0 + 45.0 * t], axis=-1),
    }
    channel = SimpleNamespace(line=lambda name: SimpleNamespace(values=lines[name]))
    found = ClosedChannel(exact=SimpleNamespace(channel=channel)).edge("trailing_edge", 1e-3)
    steps = np.diff(np.array(found.points), axis=0)
    assert np.all(np.abs(steps[:, 1]) < np.abs(steps[:, 0]))


@pytest.mark.parametrize("place", [-60.0, 0.0, 60.0])
def test_walls_of_a_cascade_go_on_wherever_its_span_lies(place):
    walls = {"hub": place, "shroud": place + 40.0}

    def line(name):
        return SimpleNamespace(values=lambda t: 1e-3 * np.stack([20.0 * t, walls[name] - 2.0 * t], axis=-1))

    found = ClosedChannel(exact=SimpleNamespace(channel=SimpleNamespace(line=line))).flow_path(1e-3, revolved=False)
    for name, r in walls.items():
        first, last = getattr(found, name).points[0], getattr(found, name).points[-1]
        assert first == pytest.approx((-CONTINUATIONS[0] * 20.0, r + CONTINUATIONS[0] * 2.0))
        assert last == pytest.approx((20.0 * (1.0 + CONTINUATIONS[0]), r - 2.0 - CONTINUATIONS[0] * 2.0))


def test_a_section_is_laid_out_by_lengths_on_a_cone():
    """On a cone r = r0 exp(k m'), so that m = (r - r0) / k."""
    radius, k = 0.3, 0.6
    section = SimpleNamespace(scale=lambda x: radius * np.exp(k * x))
    points = np.array([[-0.05, 0.2], [0.0, 0.1], [0.4, -0.3]])
    r = radius * np.exp(k * points[:, 0])
    found = unrolled(section, points)
    np.testing.assert_allclose(found, np.stack([(r - radius) / k, r * points[:, 1]], axis=-1), atol=1e-8)


def test_a_wedge_opens_downstream_whichever_way_its_flow_leads():
    wedge = WedgeDiffuser(stagger_angle=30.0, leading_edge_radius=0.01, trailing_edge_radius=0.02, wedge_angle=9.0)
    section = WedgeDiffuserSection(name="vane", length_unit="mm", chord=50.0, section=wedge).build()
    shape = section_shape(section)
    edges = SimpleNamespace(values=lambda name, _: np.array([[0.0, 2.0 if name == "leading_edge" else 1.0]]))
    flow = [
        first_blades._backwards(edges, FAMILIES["wedge-diffuser"], None, each) for each in (shape, shape.reversed())
    ]
    assert flow == [False, True]


def test_a_turned_section_is_one_whose_points_all_stand_further_around_the_axis():
    section = SimpleNamespace(scale=lambda x: 0.3 * np.exp(0.6 * x))
    points = np.array([[0.0, 0.1], [0.4, -0.3]])
    assert unrolled(section, points, 0.7) == pytest.approx(unrolled(section, points + np.array([0.0, 0.7])), abs=1e-15)


def test_where_radii_differ_the_machine_may_be_turned_until_the_leading_edge_stands_at_zero():
    wedge = WedgeDiffuser(stagger_angle=30.0, leading_edge_radius=0.01, trailing_edge_radius=0.02, wedge_angle=9.0)
    shape = section_shape(WedgeDiffuserSection(name="vane", length_unit="mm", chord=50.0, section=wedge).build())
    shape = replace(shape, start=np.array([0.0, 0.4]))
    task = Task(points=cloud(), weights=np.ones(240), free=FreeParameters(), bounds={})

    def planes(last, arrangement="annular"):
        exact = SimpleNamespace(design=SimpleNamespace(arrangement=arrangement))
        radii = {"leading_edge": 1.0, "trailing_edge": last}
        edges = SimpleNamespace(values=lambda name, _: np.array([[0.0, radii[name]]]), exact=exact, backwards=False)
        return first_blades._planes(task, edges, None, shape)

    assert planes(1.5) == [("m'-theta", 0.0), ("m-r*theta", 0.0), ("m-r*theta", -0.4)]
    assert planes(1.01) == planes(1.5, "linear") == [("m'-theta", 0.0)]


def test_parts_along_the_span_are_the_searched_one_where_shapes_are_alike_and_turn_as_they_do():
    wedge = WedgeDiffuser(stagger_angle=30.0, leading_edge_radius=0.01, trailing_edge_radius=0.02, wedge_angle=9.0)
    shape = section_shape(WedgeDiffuserSection(name="vane", length_unit="mm", chord=50.0, section=wedge).build())
    searched = wedge.changed({"wedge_angle": 9.5, "leading_edge_radius": 0.012})
    shapes = [
        replace(shape, stagger=shape.stagger + np.radians(turn)) for turn in (-2.0, -1.0, -0.5, 0.0, 1.0, 2.0, 4.0)
    ]
    parts = first_blades._along_span(shapes, searched)
    assert parts[3].parameters() == pytest.approx(searched.parameters())
    assert [each.stagger_angle for each in parts] == pytest.approx([28.0, 29.0, 29.5, 30.0, 31.0, 32.0, 34.0])
    assert {each.wedge_angle for each in parts} == {9.5}


def test_contours_of_a_profile_that_tapers_keep_its_kind_of_edge_and_its_shape():
    profile = Naca4(stagger_angle=(30.0, 50.0), thickness=(0.12, 0.08), camber=0.04, camber_position=0.4)
    contours = contours_along(profile)
    span, s = Span(np.linspace(0.0, 1.0, 5)), np.linspace(0.0, 1.0, 8001)
    own, given = (each.outline(span) for each in (contours, profile))
    assert own.trailing_edge.kind == "sharp"
    for side, true in zip(own.points(s), given.points(s), strict=True):
        off = [cKDTree(np.real(line)).query(np.real(points))[0].max() for points, line in zip(side, true, strict=True)]
        # a start for a search: a third of the nose's radius
        assert max(off) < 5e-3
    # one coordinate of each point slides it along the contour, and both of the two ends
    assert len(free_parameters._along_contour(contours)) == LAW_COUNT * (CONTOUR_POINTS[3] + 2)


def stood_in(distances, left_out=()):
    """What matches are compared by: distances of points to a section of chord 2 m, some of them outliers."""
    taken = np.delete(np.array(distances), left_out)
    return SimpleNamespace(
        rms=float(np.sqrt(np.mean(taken**2))) / 2.0,
        model=SimpleNamespace(chord=2.0),
        state=SimpleNamespace(footpoints=SimpleNamespace(distances=np.array(distances))),
        ends=SimpleNamespace(on_end_face=np.zeros(len(distances), dtype=bool)),
    )


def test_matches_are_compared_by_their_outliers_too_but_by_none_more_than_is_far():
    near, alike = stood_in([2.0] * 20), stood_in([2.1] * 20)
    short = stood_in([1.9] * 18 + [9.0] * 2, left_out=[18, 19])
    planted = [stood_in([miss] * 19 + [off], left_out=[19]) for miss, off in ((2.0, 500.0), (2.1, 400.0))]
    assert misfits([near, alike]) == pytest.approx([1.0, 1.05])
    assert misfits([near, short])[1] > 1.5
    # both count the far one alike
    clipped = np.sqrt((19.0 * np.array([1.0, 1.05]) ** 2 + 6.0**2) / 20.0)
    assert misfits(planted) == pytest.approx(clipped.tolist())


@pytest.mark.parametrize("rows", [np.linspace(0.0, 1.0, 41), np.array([0.1, 0.3, 0.7, 0.95])])
def test_a_cloud_of_few_sections_shows_the_section_between_them(rows):
    design = example("compressor-stator")
    closed = model_of(design).shape(design)
    u = np.tile((np.arange(40) + 0.5) / 40.0, len(rows))
    v = np.repeat(rows, 40)
    points = np.concatenate(
        [footpoints_at(np.zeros((len(u), 3)), closed.sides, np.full(len(u), side), u, v).points for side in (0, 1)]
    )
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    band = first_blades._band(task, closed, 0.5)
    # the points are on the blade, so that these are on its section; both sides are among them
    assert 0.1 * len(points) < len(band) < 0.6 * len(points)
    curves = [
        np.real(closed.exact.section(0.5).curves[name](np.linspace(0.0, 1.0, 4001))) for name in ("upper", "lower")
    ]
    off = [cKDTree(curve).query(band)[0] for curve in curves]
    assert np.max(np.min(off, axis=0)) < 1e-3 * np.ptp(curves[0][:, 0])
    assert min(np.mean(off[0] < off[1]), np.mean(off[1] < off[0])) > 0.4


@pytest.mark.parametrize(("misses", "chosen"), [((1.2, 1.0, 1.1), 0), ((1.3, 1.1, 1.0), 2), ((1.0, 1.1, 1.2), 0)])
def test_in_doubt_sections_are_in_the_plane_that_designs_have_by_default(misses, chosen):
    default = type(VANE).__dataclass_fields__["plane"].default
    planes = (first_blades.CONFORMAL, first_blades.UNROLLED, first_blades.UNROLLED)
    tried = [(stood_in([miss] * 20), SimpleNamespace(plane=plane)) for miss, plane in zip(misses, planes, strict=True)]
    assert first_blades._nearest(tried) is tried[chosen]
    assert default == first_blades.CONFORMAL


@pytest.mark.parametrize(
    ("missed", "trial", "taken"),
    [(False, 1.0, ["annular"]), (True, 2.9, ["annular", "linear"]), (True, 3.1, ["annular"])],
)
def test_a_blade_that_is_missed_around_the_axis_is_sought_in_a_cascade_that_begins_about_as_near(
    monkeypatch, missed, trial, taken
):
    tried = []

    def first(_task, begun, _kind, _like, _header):
        arrangement = begun.design.arrangement
        return begun.turn, begun.design, {"annular": 1.0, "linear": trial}[arrangement]

    def rich(task, design, _like, _target, *, guessed):
        assert guessed
        tried.append((design.arrangement, task.turn))
        return SimpleNamespace(match=SimpleNamespace(design=design))

    def reduced(rich, _target):
        match = SimpleNamespace(design=rich.match.design, noise_estimate=SimpleNamespace(correlation=0.0))
        return match, match.design.arrangement

    begun = [
        SimpleNamespace(design=SimpleNamespace(arrangement=arrangement), turn=turn)
        for arrangement, turn in (("annular", 0.0), ("linear", UPRIGHT))
    ]
    monkeypatch.setattr(blades, "first_blades", lambda *_, **__: begun)
    monkeypatch.setattr(blades, "first_of_family", first)
    monkeypatch.setattr(blades, "misfits", lambda trials: trials)
    monkeypatch.setattr(blades, "_rich", rich)
    monkeypatch.setattr(blades, "reduced_match", reduced)
    monkeypatch.setattr(blades, "is_far", lambda *_: missed)
    monkeypatch.setattr(blades, "criterion", lambda match, _: match.design.arrangement == "annular")
    task = Task(points=cloud(), weights=np.ones(len(cloud())), free=FreeParameters(), bounds={})
    kind, header = FAMILIES["camber-angle"], DesignHeader(name="vane", length_unit="mm")
    _, reason = matched_blade(task, kind, None, None, header, MatchTarget())
    assert tried == list(zip(taken, (0.0, UPRIGHT), strict=False))
    assert reason == taken[-1]


def test_where_no_first_blade_has_a_shape_the_first_refusal_is_told(monkeypatch):
    begun = [SimpleNamespace(turn=0.0, design=arrangement) for arrangement in ("annular", "linear")]

    def refused(_task, begun, _kind, _like, _header):
        raise FitError(f"refused as {begun.design}")

    monkeypatch.setattr(blades, "first_blades", lambda *_, **__: begun)
    monkeypatch.setattr(blades, "first_of_family", refused)
    task = Task(points=cloud(), weights=np.ones(len(cloud())), free=FreeParameters(), bounds={})
    header = DesignHeader(name="vane", length_unit="mm")
    with pytest.raises(FitError, match="refused as annular"):
        matched_blade(task, FAMILIES["wedge-diffuser"], None, None, header, MatchTarget())
