"""Sizes follow the chord, the edges and the gap, and the tetrahedra that they make can be told beforehand."""

from itertools import pairwise

import numpy as np
import pytest

from bladewright.meshing.sizes import DEFAULT_TETRAHEDRA, sizes


def test_without_a_size_the_expected_number_is_made(cascade, rotor):
    for case in (cascade, rotor):
        assert sizes(case.passage).expected == pytest.approx(DEFAULT_TETRAHEDRA, rel=1e-3)


def test_a_mesh_has_about_the_number_of_tetrahedra_that_was_expected(cascade_mesh, rotor_mesh):
    for _, report in (cascade_mesh, rotor_mesh):
        # an element or two across a passage is where they are least alike; design/meshes.md has those of all examples
        assert 0.5 * report.expected < report.tetrahedra < 2.0 * report.expected


def test_where_no_edge_asks_for_more_half_the_size_is_eight_times_the_elements(cascade):
    # one element on a circle as tight as the edges, which is larger than the others
    coarse, fine = (sizes(cascade.passage, size=size, curvature=1.0).expected for size in (0.09, 0.045))
    assert fine == pytest.approx(8 * coarse, rel=1e-4)


def test_smaller_elements_are_more(cascade):
    counts = [sizes(cascade.passage, size=size).expected for size in (0.4, 0.2, 0.1, 0.05)]
    assert all(finer > coarser for coarser, finer in pairwise(counts))


def test_an_edge_gets_the_elements_of_its_radius(cascade):
    plan = sizes(cascade.passage, size=0.2, smallest=1e-3, curvature=10.0)
    design = cascade.passage.blade.design
    radii = 0.03 * np.array([design.leading_edge_radius, design.trailing_edge_radius])
    assert [each.size for each in plan.sources] == pytest.approx(2.0 * np.pi * radii / 10.0, rel=1e-3)
    assert [each.extent for each in plan.sources] == pytest.approx([0.04, 0.04], rel=1e-9)


def test_limits_hold_what_edges_ask_for(cascade):
    plan = sizes(cascade.passage, size=0.2, smallest=0.15, curvature=1000.0)
    assert {each.size for each in plan.sources} == {plan.smallest}
    assert plan.smallest == pytest.approx(0.15 * plan.chord)


def test_a_gap_gets_elements_as_large_as_it_is(rotor):
    plan = sizes(rotor.passage, size=0.3, smallest=1e-3)
    (tip,) = [each for each in plan.sources if each.face == "tip"]
    assert tip.size == pytest.approx(1e-3, rel=1e-4)
    assert tip.extent > 0.0
