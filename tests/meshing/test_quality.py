"""Measures of tetrahedra and of what they leave open."""

import numpy as np
import pytest

from bladewright.meshing.quality import condition_numbers, radius_ratios, volumes
from bladewright.meshing.verification import unmatched_facets

REGULAR = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1.0]])
RIGHT = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
ONE = np.array([[0, 1, 2, 3]])


def test_a_regular_tetrahedron_has_quality_one():
    for measure in (condition_numbers, radius_ratios):
        np.testing.assert_allclose(measure(REGULAR, ONE), 1.0, rtol=1e-14)
    np.testing.assert_allclose(volumes(REGULAR, ONE), 8.0 / 3.0, rtol=1e-15)


def test_the_corner_of_a_cube_has_its_closed_form():
    inscribed = 0.5 / (1.5 + np.sqrt(0.75))
    np.testing.assert_allclose(radius_ratios(RIGHT, ONE), 3.0 * inscribed / np.sqrt(0.75), rtol=1e-14)
    np.testing.assert_allclose(volumes(RIGHT, ONE), 1.0 / 6.0, rtol=1e-15)


def test_a_flat_tetrahedron_has_quality_zero_and_a_point_too():
    flat = RIGHT * [1.0, 1.0, 0.0]
    for measure in (condition_numbers, radius_ratios):
        np.testing.assert_array_equal(measure(flat, ONE), 0.0)
        np.testing.assert_array_equal(measure(np.zeros((4, 3)), ONE), 0.0)


def test_an_inverted_tetrahedron_has_the_negative_condition():
    inverted = ONE[:, [1, 0, 2, 3]]
    np.testing.assert_allclose(condition_numbers(RIGHT, inverted), -condition_numbers(RIGHT, ONE), rtol=1e-14)
    assert volumes(RIGHT, inverted) < 0.0


def test_quality_does_not_depend_on_place_size_or_turning():
    turn, _ = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))
    moved = 1e-3 * RIGHT @ (turn * np.sign(np.linalg.det(turn))) + [5.0, -2.0, 1.0]
    for measure in (condition_numbers, radius_ratios):
        # the place takes three of sixteen digits
        np.testing.assert_allclose(measure(moved, ONE), measure(RIGHT, ONE), rtol=1e-11)


def test_gmsh_gives_the_same_measures(gmsh, rotor_mesh):
    path, report = rotor_mesh
    gmsh.clear()
    gmsh.open(str(path))
    tags = gmsh.model.mesh.getElements(3)[1][0]
    for name, found in (("minSICN", report.min_sicn), ("gamma", report.gamma)):
        values = gmsh.model.mesh.getElementQualities(tags, name)
        # gmsh takes gamma from a quotient of differences
        assert found.worst == pytest.approx(values.min(), rel=1e-9)
        assert found.mean == pytest.approx(values.mean(), rel=1e-9)


TWO = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
SHELL = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 4], [1, 3, 4], [2, 3, 4]])


def test_a_boundary_that_is_covered_once_leaves_no_facet_loose():
    assert unmatched_facets(TWO, {"one": SHELL[:2], "other": SHELL[2:, ::-1]}) == 0


@pytest.mark.parametrize(
    ("groups", "loose"),
    [
        ({"one": SHELL[1:]}, 1),
        ({"one": SHELL, "twice": SHELL[:2]}, 2),
        ({"one": SHELL, "inside": np.array([[1, 2, 3]])}, 1),
        ({"one": SHELL, "nowhere": np.array([[0, 1, 4]])}, 1),
        ({}, 6),
    ],
    ids=["a hole", "a face twice", "a face inside", "a face of no tetrahedron", "no face"],
)
def test_what_does_not_close_is_counted(groups, loose):
    assert unmatched_facets(TWO, groups) == loose
