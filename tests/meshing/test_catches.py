"""Each check of a mesh fails where the mesh breaks exactly that."""

import dataclasses

import numpy as np
import pytest

from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import Answer
from bladewright.meshing.mesh_file import read_mesh
from bladewright.meshing.names import GROUP_PREFIX
from bladewright.meshing.periodicity import match_periodic, periodicity
from bladewright.meshing.quality import condition_numbers
from bladewright.meshing.verification import check_complete, deviation_limit, deviations, unmatched_facets


@pytest.fixture(scope="module")
def held(rotor_mesh):
    """What the rotor's mesh file holds."""
    return read_mesh(rotor_mesh[0])


def triangles(held):
    return {name.removeprefix(GROUP_PREFIX): rows for name, rows in held.items() if name.startswith(GROUP_PREFIX)}


def inner(held, group):
    """A node of a group's triangles that no other group has."""
    others = [rows for name, rows in triangles(held).items() if name != group]
    return np.setdiff1d(held[GROUP_PREFIX + group], np.concatenate(others))[0]


def test_one_inverted_tetrahedron_is_seen(held):
    tetrahedra = np.array(held["tetrahedra"])
    assert (condition_numbers(held["nodes"], tetrahedra) > 0.0).all()
    tetrahedra[5] = tetrahedra[5][[1, 0, 2, 3]]
    assert np.flatnonzero(condition_numbers(held["nodes"], tetrahedra) < 0.0) == [5]


@pytest.mark.parametrize("group", ["blade_upper", "hub_lower", "tip", "inlet"])
def test_a_node_off_its_surface_is_seen(group, held, rotor):
    allowed = deviation_limit(rotor.passage.blade.chord)
    points = held["nodes"][held[GROUP_PREFIX + group][:3]].reshape(-1, 3)
    off = deviations(rotor.passage.surfaces, group, points, allowed)
    assert off.max() <= allowed
    # off along a side of the passage is off in space, if by less
    moved = deviations(rotor.passage.surfaces, group, points + 1e-4 / np.sqrt(3.0), allowed)
    assert moved.min() > 100.0 * allowed
    assert moved.max() <= 1e-4 + allowed


def test_a_native_surface_that_the_mesh_does_not_follow_is_seen(held, rotor):
    side = rotor.passage.surfaces["blade_lower"]
    net = np.array(side.control_points)
    net[len(net) // 2] += [0.0, 1e-5, 1e-5]
    other = {"blade_lower": dataclasses.replace(side, control_points=net)}
    points = held["nodes"][np.unique(held[GROUP_PREFIX + "blade_lower"])]
    allowed = deviation_limit(rotor.passage.blade.chord)
    assert deviations(other, "blade_lower", points, allowed).max() > 5.0 * allowed


def test_a_periodic_node_off_its_partner_is_seen(held, rotor):
    motion = periodicity(rotor.passage.surfaces)
    rows = held[GROUP_PREFIX + "periodic_lower"], held[GROUP_PREFIX + "periodic_upper"]
    assert match_periodic(motion, held["nodes"], *rows).mismatch < 1e-12
    nodes = np.array(held["nodes"])
    nodes[inner(held, "periodic_upper"), 0] += 3e-9 * motion.pitch
    found = match_periodic(motion, nodes, *rows)
    assert found.mismatch == pytest.approx(3e-9, rel=1e-3)
    assert found.triangles


def test_periodic_boundaries_with_other_nodes_or_triangles_are_seen(held, rotor):
    motion = periodicity(rotor.passage.surfaces)
    lower, upper = held[GROUP_PREFIX + "periodic_lower"], held[GROUP_PREFIX + "periodic_upper"]
    fewer = upper[(upper != inner(held, "periodic_upper")).all(axis=1)]
    assert match_periodic(motion, held["nodes"], lower, fewer).mismatch == np.inf
    assert not match_periodic(motion, held["nodes"], lower, upper[1:]).triangles


def test_a_hole_in_the_boundary_is_seen(held):
    groups = triangles(held)
    assert unmatched_facets(held["tetrahedra"], groups) == 0
    assert unmatched_facets(held["tetrahedra"], {**groups, "outlet": groups["outlet"][1:]}) == 1


def test_a_mesh_that_passes_has_no_failures(rotor_mesh):
    assert rotor_mesh[1].passed
    assert rotor_mesh[1].failures == ()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"inverted": 2}, "2 of"),
        ({"loose": 3}, "3 facets"),
        ({"deviation_limit_mm": 1e-9}, "tip: nodes lie up to"),
        ({"periodic_mismatch": 2e-9}, "2e-09 of the pitch"),
        ({"periodic_mismatch": float("nan")}, "nan of the pitch"),
        ({"periodic_triangles": False}, "triangles of the periodic boundaries"),
    ],
    ids=str,
)
def test_a_figure_beyond_its_limit_is_one_failure(change, words, rotor_mesh):
    report = dataclasses.replace(rotor_mesh[1], **change)
    (failure,) = report.failures
    assert words in failure
    assert not report.passed
    assert report.to_dict()["failures"] == [failure]
    assert f"FAILED: {failure}" in str(report)


def test_a_file_without_a_group_or_with_fewer_elements_is_refused(held, rotor):
    groups, counts = triangles(held), (len(held["nodes"]), len(held["tetrahedra"]))
    answer = Answer(nodes=counts[0], tetrahedra=counts[1])
    check_complete(groups, rotor.passage, *counts, answer)
    without = {name: rows for name, rows in groups.items() if name != "tip"}
    with pytest.raises(MeshError, match="but the passage has the faces"):
        check_complete(without, rotor.passage, *counts, answer)
    with pytest.raises(MeshError, match="were written"):
        check_complete(groups, rotor.passage, counts[0], counts[1] - 1, answer)
