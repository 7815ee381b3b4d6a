"""Laws of the families that are one part, with other numbers of control points; where their matches begin."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from scipy.spatial import cKDTree

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.designs import Point
from bladewright.errors import DesignError
from bladewright.fitting.assessment.acceptance import MatchTarget
from bladewright.fitting.families.closed_blade import section_shape
from bladewright.fitting.families.first_parts import through_points
from bladewright.fitting.families.kinds import FAMILIES, DesignHeader
from bladewright.fitting.families.sections import _design_of, contour_match, criterion, first_designs
from bladewright.fitting.free_parameters import EDGES, FreeParameters
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection import structure as structures
from bladewright.fitting.model_selection.elimination import LinearModel
from bladewright.fitting.model_selection.structure import (
    reshaped,
    resizable_laws,
    rich_structure,
    structure_of,
)
from bladewright.fitting.models.designs import PlanarModel, infeasibility
from bladewright.section.camber_angle import CamberAngleSection
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.part import SuctionPressureSection
from machines import example
from machines.camber_angles import CAMBER_ANGLES
from machines.meanlines import BLUNT, on_meanline
from machines.sectioned import COMPRESSOR, DESIGNS, DIFFUSER
from machines.sections import EXAMPLES
from machines.suction_pressure import STATOR, section

PLACES = np.linspace(0.0, 1.0, 33)
ALONE = Span(np.zeros(1))
BENT = tuple(Point(x, 50.0 + 0.002 * x**2) for x in (-60.0, -10.0, 20.0, 50.0, 80.0, 140.0))
OUTER = tuple(Point(each.x, 80.0 + 0.3 * each.r) for each in BENT)
ROWS = on_meanline(curvature=(0.8, 1.0, 0.4), thickness=BLUNT, thickness_multiplier=(0.1, 0.0, 0.1, 0.2))


def outline(part, v):
    """Both sides of the sections of a part at places along the span."""
    return np.stack([np.real(side) for side in part.outline(Span(v)).points(PLACES)])


@pytest.mark.parametrize("design", [COMPRESSOR, DIFFUSER, DESIGNS["inlet-vane"]], ids=lambda design: design.name)
def test_a_blade_with_more_control_points_along_the_span_is_the_same_blade(design):
    v, structure = np.linspace(0.0, 1.0, 5), structure_of(design)
    # the largest control point of a row that counts by ratios alone is held
    for law in (each for each in resizable_laws(design) if set(each.paths(design)) & set(FreeParameters()(design))):
        *along, across = structure.counts[law.name]
        wider = reshaped(design, structure.resized(law.name, (*along, across + 3)))
        assert len(FreeParameters()(wider)) > len(FreeParameters()(design)), law.name
        # constants and laws of up to three control points are held by more; others come near
        assert outline(wider.section, v) == pytest.approx(outline(design.section, v), abs=1e-3), law.name
        for edge in EDGES:
            line, own = (getattr(each, edge).line(1.0).values(np.linspace(0.0, 1.0, 801)) for each in (wider, design))
            assert np.max(cKDTree(line).query(own)[0]) < 5e-3 * np.max(np.ptp(own, axis=0)), law.name


def test_where_a_wider_structure_has_no_shape_those_laws_get_wider_that_leave_one(monkeypatch):
    own = structure_of(COMPRESSOR)
    wide = rich_structure(COMPRESSOR, COMPRESSOR.parameters(), 100_000)
    # a law of the metal angle with more control points takes the shape away
    monkeypatch.setattr(
        structures, "_has_shape", lambda design: structure_of(design).counts["section.metal_angle_in"] == most
    )
    most = wide.counts["section.metal_angle_in"]
    assert structure_of(structures.widened_where_feasible(COMPRESSOR, wide)) == wide
    most = own.counts["section.metal_angle_in"]
    found = structure_of(structures.widened_where_feasible(COMPRESSOR, wide)).counts
    assert found == {**wide.counts, "section.metal_angle_in": most}


def test_walls_get_points_where_they_are_free_alone():
    flow_path = replace(COMPRESSOR.flow_path, hub=ThroughPoints(points=BENT), shroud=ThroughPoints(points=OUTER))
    design = replace(COMPRESSOR, flow_path=flow_path)
    own, free = structure_of(design), FreeParameters(walls=True)(design)
    for wall, points in (("hub", BENT), ("shroud", OUTER)):
        law = next(each for each in resizable_laws(design) if each.name == f"flow_path.{wall}")
        assert own.counts[law.name] == (len(points),)
        assert rich_structure(design, FreeParameters()(design), 9000).counts[law.name] == (len(points),)
        assert rich_structure(design, free, 9000).counts[law.name] > (len(points),)
        wider = reshaped(design, own.resized(law.name, (9,)))
        lines = [getattr(each.flow_path, wall).line(1.0).values(np.linspace(0.0, 1.0, 801)) for each in (design, wider)]
        assert np.max(cKDTree(lines[1]).query(lines[0])[0]) < 1e-3 * np.max(np.ptp(lines[0], axis=0))
        # the other way round, points of a wall are those of the narrower one that are nearest to its
        values = [np.array([each.parameters()[path] for path in law.paths(each)]) for each in (design, wider)]
        back = {each.name: each for each in resizable_laws(wider)}[law.name]
        near = back.embedding(back.counts_of(wider), (len(points),)) @ values[0]
        assert near == pytest.approx(values[1], abs=0.02 * np.max(np.ptp(lines[0], axis=0)))


@pytest.mark.parametrize("design", [ROWS, section(STATOR), EXAMPLES["camber-angle-blunt"].design])
def test_a_section_with_more_control_points_along_the_chord_is_nearly_the_same(design):
    wider = reshaped(design, rich_structure(design, design.parameters(), 100_000))
    assert len(FreeParameters()(wider)) > len(FreeParameters()(design))
    before, after = (section_shape(replace(each, tolerance=1e-6).build()) for each in (design, wider))
    for place in np.linspace(0.05, 0.95, 10):
        assert after.half(place) == pytest.approx(before.half(place), abs=0.02)
    model = LinearModel(searched(task(design), wider, rounds=0), 0)
    # a row that may be left out, too
    fewest = [each.of.fewest for each in model.laws]
    assert model.prediction(fewest).parameters < len(FreeParameters()(design))
    assert len(model.designed(model.prediction(fewest)).parameters()) <= len(design.parameters())


def test_segments_with_more_control_points_that_hold_the_old_ones_are_the_same_segments():
    design = example("morphing-airfoil").changed("section.morph", None)
    wider = reshaped(design, rich_structure(design, design.parameters(), 100_000))
    for law in resizable_laws(design):
        few, many = (np.array([each.parameters()[path] for path in law.paths(each)]) for each in (design, wider))
        assert len(many) > len(few)
        counts, own = law.counts_of(wider), law.counts_of(design)
        # between the same ends control points are an affine function of fewer
        found = law.embedding(counts, own) @ few + law.offset(design, counts, own)
        assert found == pytest.approx(many, abs=1e-12), law.name
    before, after = (np.real(each.section.outline(ALONE).points(PLACES)[0]) for each in (design, wider))
    tree = cKDTree(np.real(wider.section.outline(ALONE).points(np.linspace(0.0, 1.0, 20_001))[0][0]))
    assert before.shape == after.shape
    assert np.max(tree.query(before[0])[0]) < 1e-4


def task(design, count=120):
    random = np.random.default_rng(4)
    points = np.concatenate([side(random.random(count)) for side in design.build().curves.values()])
    return Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})


def test_kinds_with_a_blunt_edge_begin_inside_the_points_by_half_its_thickness():
    kind, header = FAMILIES["camber-angle"], DesignHeader(name="found", length_unit="mm")
    shape = section_shape(section(STATOR).build())
    chords = {
        each.section.trailing_edge: 1e-3 * each.chord / shape.chord
        for each in first_designs(kind, shape, None, header, task(section(STATOR)))
    }
    assert chords == pytest.approx({"round": 1.0, "sharp": 1.0, "blunt": 1.0 - shape.radii[1]})


def test_an_outline_of_points_follows_what_no_profile_of_a_kind_does():
    some, kind, header = task(section(STATOR)), FAMILIES["profile"], DesignHeader(name="found", length_unit="mm")
    shape = section_shape(section(STATOR).build())
    firsts = islice(first_designs(kind, shape, None, header, some), 3)
    found = [searched(some, each, rounds=1) for each in firsts]
    target = MatchTarget(parameters=34)
    part = through_points(shape, 32)
    outline, _ = contour_match(some, found[0], target, lambda: _design_of(kind, shape, part, header, some))
    assert len(outline.problem.paths) == 34
    assert outline.design.section.kind == "points"
    # so many points come within three ten-thousandths of the chord
    assert outline.rms < 3e-4
    assert min(each.rms for each in found) > 2.0 * outline.rms
    assert criterion(outline, target) < min(criterion(each, target) for each in found)
    # of those that keep a tolerance the one of fewest parameters is the best
    best = min([outline, *found], key=lambda each: criterion(each, MatchTarget(tolerance=1.0)))
    assert len(best.problem.paths) == min(len(each.problem.paths) for each in found) < 34


def test_a_contour_has_points_on_the_corners_of_a_blunt_edge():
    shape = section_shape(EXAMPLES["naca-6409-blunt"].design.build())
    part = through_points(shape, 40)
    assert (part.abscissas[0], part.ordinates[0]) == pytest.approx(tuple(shape.upper[-1]))
    assert (part.abscissas[-1], part.ordinates[-1]) == pytest.approx(tuple(shape.lower[-1]))


def test_a_side_with_more_heights_keeps_a_tangent_that_its_edge_needs():
    blade = replace(
        STATOR,
        stagger_angle=-30.62,
        metal_angle_in=44.87,
        metal_angle_out=-88.95,
        skeleton="pseudo",
        leading_edge_radius=0.01958,
        leading_edge_stretch=2.992,
        leading_edge_skew=-0.3472,
        trailing_edge_radius=0.009281,
        trailing_edge_stretch=0.7172,
        trailing_edge_skew=-0.09825,
        leading_edge_wedge=24.79,
        trailing_edge_wedge=49.85,
        suction_side="upper",
        suction_tangent_in=0.06996,
        suction_tangent_out=0.005125,
        pressure_tangent_in=0.0842,
        pressure_tangent_out=0.1255,
        suction_heights=(0.107, 0.09263, 0.003362, -0.03285),
        pressure_heights=(-0.03329, -0.05162, -0.06533, -0.06489),
    )
    design = section(blade)
    for law in resizable_laws(design):
        richer = reshaped(design, structure_of(design).resized(law.name, (8, 1))).section
        richer.outline(ALONE)
        assert richer.suction_tangent_out == blade.suction_tangent_out
        assert (richer.pressure_tangent_out < blade.pressure_tangent_out) == (law.name == "section.pressure_heights")


def test_a_section_on_too_short_a_tangent_is_crowded_before_it_is_refused():
    assert np.max(np.real(infeasibility(STATOR, ALONE))) < 0.0
    reach = 0.1
    while np.max(np.real(infeasibility(replace(STATOR, pressure_tangent_in=reach), ALONE))) <= 0.0:
        reach *= 0.99
    # crowding begins while the section can still be made
    assert replace(STATOR, pressure_tangent_in=reach).outline(ALONE).points(PLACES)[0].shape == (1, 33, 2)


@pytest.mark.parametrize(
    ("kind", "part", "change", "words"),
    [
        (SuctionPressureSection, STATOR, {"suction_tangent_in": 0.0008}, "turn back"),
        (SuctionPressureSection, STATOR, {"pressure_heights": (0.2, 0.25, 0.2)}, "cross"),
        (
            CamberAngleSection,
            CAMBER_ANGLES["camber-angle"],
            {"half_thickness": (0.002, 0.04, 0.04, 0.03, 0.008)},
            "rises beside",
        ),
    ],
    ids=["turns back", "cross", "rises"],
)
def test_a_search_sees_sections_that_are_refused_and_by_how_much(kind, part, change, words):
    refused = replace(part, **change)
    with pytest.raises(DesignError, match=words):
        refused.outline(ALONE).check_limits([""])
    for each, sign in ((part, -1.0), (refused, 1.0)):
        design = kind(name="refused", length_unit="mm", chord=50.0, section=each)
        shape = PlanarModel(design, 1e-3).shape(design)
        assert shape.finite
        assert sign * np.max(shape.constraints) > 0.0
