"""Starts and growth of the families that are one part."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.fitting.design_header import DesignHeader
from bladewright.fitting.families.kinds import FAMILIES, family_of
from bladewright.fitting.families.law_extension import law_extensions
from bladewright.fitting.families.polyline import nearest_on
from bladewright.fitting.families.profile import starts, through_points
from bladewright.fitting.families.rounded_edge import edge_through
from bladewright.fitting.families.sections import _design_maker, _through_points, section_samples
from bladewright.fitting.families.suction_pressure import templates
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection.match_target import MatchTarget
from bladewright.fitting.models.feasibility import infeasibility
from bladewright.section.laws import Span
from bladewright.section.profiles.flat_plate import FlatPlate
from machines.sectioned import COMPRESSOR, DESIGNS, DIFFUSER
from machines.suction_pressure import STATOR, section

PLACES = np.linspace(0.0, 1.0, 33)
ALONE = Span(np.zeros(1))


def outline(part, v):
    """Both sides of the sections of a part at places along the span."""
    return np.stack([np.real(side) for side in part.outline(Span(v)).points(PLACES)])


@pytest.mark.parametrize("design", [COMPRESSOR, DIFFUSER, DESIGNS["inlet-vane"]], ids=lambda design: design.name)
def test_a_blade_with_a_control_point_more_along_the_span_is_the_same_blade(design):
    v = np.linspace(0.0, 1.0, 5)
    grown = 0
    for widening in law_extensions(design, family_of(design)):
        if not widening.law.startswith("section.") or "chord" in widening.law:
            continue
        wider = widening.applied(design)
        assert len(FreeParameters()(wider)) > len(FreeParameters()(design)), widening.law
        # constants and laws of up to three control points are held by one more; others come near
        assert outline(wider.section, v) == pytest.approx(outline(design.section, v), abs=1e-3), widening.law
        grown += 1
    assert grown


def test_every_law_along_the_chord_of_a_blade_may_grow():
    chordwise = [
        each for each in law_extensions(COMPRESSOR, FAMILIES["curvature-meanline"]) if "along the chord" in each.law
    ]
    assert chordwise
    for widening in chordwise:
        assert len(FreeParameters()(widening.applied(COMPRESSOR))) > len(FreeParameters()(COMPRESSOR))


def test_a_blade_whose_sections_do_not_grow_alike_is_left_as_it_is():
    ways = iter([2, *[1] * 50])
    kind = replace(FAMILIES["curvature-meanline"], extensions=lambda part, _: [part] * next(ways))
    last = [each for each in law_extensions(COMPRESSOR, kind) if "along the chord" in each.law][-1]
    with pytest.raises(DesignError, match="do not grow alike"):
        last.applied(COMPRESSOR)


def test_an_edges_corners_are_found_on_the_sides_of_a_section():
    samples = section_samples(section(STATOR).build())
    found = edge_through(samples, 1, np.radians(10.0), "C2")
    assert found.radius == pytest.approx(STATOR.trailing_edge_radius, rel=0.05)
    assert samples.stagger + found.angle == pytest.approx(np.radians(STATOR.metal_angle_out), abs=np.radians(2.0))


def test_templates_have_nearly_as_many_parameters_as_are_asked_for():
    samples = section_samples(section(STATOR).build())
    for count in (22, 26, 30):
        for part in templates(samples, count):
            assert len(FreeParameters()(section(part))) == count


def test_an_outline_of_points_follows_what_no_profile_of_a_kind_does():
    built = section(STATOR).build()
    samples = section_samples(built)
    points = np.concatenate([side(np.random.default_rng(4).random(150)) for side in built.curves.values()])
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    made = _design_maker(FAMILIES["profile"], samples, DesignHeader(name="found", length_unit="mm"), task)
    found = searched(task, made(starts(samples, FlatPlate(thickness=0.06))[0]), rounds=1)
    outline, reason = _through_points(task, found, MatchTarget(parameters=26), partial(through_points, samples), made)
    assert len(outline.problem.paths) == 26
    assert (reason, outline.design.section.kind) == ("", "points")
    # so many points come within a thousandth of the chord; the plate has no camber
    assert outline.rms < 1e-3
    assert found.rms > 10.0 * outline.rms


def test_a_section_on_too_short_a_tangent_is_crowded_before_it_is_refused():
    assert np.max(np.real(infeasibility(STATOR, ALONE))) < 0.0
    reach = 0.1
    while np.max(np.real(infeasibility(replace(STATOR, pressure_tangent_in=reach), ALONE))) <= 0.0:
        reach *= 0.998
    # crowding begins while the section can still be made
    assert replace(STATOR, pressure_tangent_in=reach).outline(ALONE).points(PLACES)[0].shape == (1, 33, 2)


def test_the_nearest_places_on_a_line_of_points_have_its_tangents_and_sides():
    line = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    found = nearest_on(line, np.array([[0.5, 0.2], [1.3, 0.5], [-1.0, -0.5]]))
    assert found.points == pytest.approx(np.array([[0.5, 0.0], [1.0, 0.5], [-1.0, 0.0]]))
    assert found.heights == pytest.approx([0.2, -0.3, -0.5])
    assert found.normals[1] == pytest.approx([-1.0, 0.0])
