from dataclasses import replace

import numpy as np
import pytest

from bladewright.errors import GeometryError
from bladewright.nurbs.domain import swapped
from bladewright.nurbs.mass_properties import mass_properties, placed
from bladewright.nurbs.revolution import arc, circle, revolved, segment
from bladewright.nurbs.skinning import ruled
from bladewright.nurbs.transform import rotated, scaled, translated
from bladewright.nurbs.trimmed import TrimmedSurface


def sphere(radius=2.0):
    half = arc((0.0, 0.0, 0.0), radius, 0.0, np.pi, axes=((-1, 0, 0), (0, 1, 0)))
    return ((revolved(half), -1),)


def torus():
    return ((revolved(circle((0.0, 3.0, 0.0), 1.0, axes=((1, 0, 0), (0, 1, 0)))), 1),)


def box(a, b, c):
    """The box [0, a] x [0, b] x [0, c]."""
    faces = []
    for axis, size in enumerate((a, b, c)):
        p, q = (
            np.eye(3)[(axis + 1) % 3] * (a, b, c)[(axis + 1) % 3],
            np.eye(3)[(axis + 2) % 3] * (a, b, c)[(axis + 2) % 3],
        )
        low = ruled(segment((0, 0, 0), p), segment(q, p + q))
        faces += [(low, -1), (translated(low, size * np.eye(3)[axis]), 1)]
    return tuple(faces)


def cylinder(radius=1.5, height=4.0):
    """About x, closed by discs trimmed from squares."""
    wall = revolved(segment((0.0, radius, 0.0), (height, radius, 0.0)))
    side = 2.0 * abs(radius)
    square = ruled(segment((0, -side, -side), (0, side, -side)), segment((0, -side, side), (0, side, side)))
    disc = TrimmedSurface(surface=square, boundary=(circle((0.5, 0.5), radius / (2.0 * side)),))
    return ((wall, -1), (disc, -1), (translated(disc, (height, 0, 0)), 1))


def pipe(radius, height, bore):
    """The same with a hole along its axis."""
    outer, low, high = (face for face, _ in cylinder(radius, height))
    inner = revolved(segment((0.0, bore, 0.0), (height, bore, 0.0)))
    around = (arc((0.5, 0.5), bore / (4.0 * radius), 2.0 * np.pi, 0.0),)
    return ((outer, -1), (inner, 1), (replace(low, holes=(around,)), -1), (replace(high, holes=(around,)), 1))


def test_a_pipe_whose_ends_have_a_hole_has_its_volume_and_inertia():
    found = mass_properties(pipe(1.5, 4.0, 0.5 + 1e-30j))
    squares, fourths = 1.5**2 - 0.5**2, 1.5**4 - 0.5**4
    assert np.isclose(found.volume.real, np.pi * squares * 4.0, rtol=1e-12)
    assert np.isclose(found.volume.imag / 1e-30, -4.0 * np.pi, rtol=1e-11)
    across = np.pi * (3.0 * fourths * 4.0 + squares * 4.0**3) / 12.0
    assert np.allclose(found.inertia.real, np.diag([np.pi * fourths * 2.0, across, across]), rtol=1e-11, atol=1e-11)
    assert np.allclose(found.areas[2:].real, np.pi * squares, rtol=1e-12)
    assert found.openness < 1e-13


def test_a_sphere_has_its_volume_and_inertia():
    found = mass_properties(sphere())
    volume = 4.0 / 3.0 * np.pi * 8.0
    assert np.isclose(found.volume, volume, rtol=1e-13)
    assert np.allclose(found.centroid, 0.0, atol=1e-14)
    assert np.allclose(found.inertia, 0.4 * volume * 4.0 * np.eye(3), rtol=1e-12, atol=1e-11)


def test_a_torus_has_its_volume_and_inertia():
    found = mass_properties(torus())
    volume = 2.0 * np.pi**2 * 3.0
    assert np.isclose(found.volume, volume, rtol=1e-13)
    across = volume * (4 * 9.0 + 5.0) / 8.0
    assert np.allclose(found.inertia, np.diag([volume * (9.0 + 0.75), across, across]), rtol=1e-12, atol=1e-11)


def test_a_box_has_its_volume_centroid_and_inertia():
    found = mass_properties(box(1.0, 2.0, 3.0))
    assert np.isclose(found.volume, 6.0, rtol=1e-14)
    assert np.allclose(found.centroid, [0.5, 1.0, 1.5], rtol=1e-14)
    assert np.allclose(found.inertia, 0.5 * np.diag([13.0, 10.0, 5.0]), rtol=1e-13, atol=1e-13)
    assert np.isclose(found.area, 22.0)
    assert np.allclose(found.areas, [6.0, 6.0, 3.0, 3.0, 2.0, 2.0])


def test_a_cylinder_with_trimmed_ends_has_its_volume_centroid_and_inertia():
    found = mass_properties(cylinder())
    volume = np.pi * 1.5**2 * 4.0
    across = volume * (3 * 1.5**2 + 4.0**2) / 12.0
    assert np.isclose(found.volume, volume, rtol=1e-12)
    assert np.allclose(found.centroid, [2.0, 0.0, 0.0], rtol=1e-12, atol=1e-13)
    assert np.allclose(found.inertia, np.diag([volume * 1.5**2 / 2.0, across, across]), rtol=1e-11, atol=1e-11)
    assert np.allclose(found.areas, [12.0 * np.pi, 2.25 * np.pi, 2.25 * np.pi], rtol=1e-12)


@pytest.mark.parametrize(
    "body", [sphere(), torus(), box(1.0, 2.0, 3.0), cylinder()], ids=["sphere", "torus", "box", "cylinder"]
)
def test_moving_a_solid_moves_its_centroid_and_turns_its_inertia(body):
    before = mass_properties(body)
    turn = {"origin": (1.0, 2.0, 3.0), "axis": (1.0, -1.0, 0.5)}
    moved = [(translated(rotated(face, 0.8, **turn), (5.0, -4.0, 7.0)), sign) for face, sign in body]
    after = mass_properties(moved)
    assert np.isclose(after.volume, before.volume, rtol=1e-12)
    assert np.allclose(np.linalg.eigvalsh(after.inertia), np.linalg.eigvalsh(before.inertia), rtol=1e-11)
    place = rotated(segment(before.centroid, before.centroid + 1.0), 0.8, **turn).control_points[0]
    assert np.allclose(after.centroid, place + np.array([5.0, -4.0, 7.0]), rtol=1e-12)


def test_a_closed_set_of_faces_is_told_from_an_open_one():
    assert mass_properties(cylinder()).openness < 1e-13
    assert mass_properties(cylinder()[:2]).openness > 0.1


def test_the_derivative_of_volume_by_radius_is_the_area():
    found = mass_properties([(scaled(face, 1.0 + 0.5e-30j, (0, 0, 0)), sign) for face, sign in sphere()])
    assert np.isclose(found.volume.imag / 1e-30, 16.0 * np.pi, rtol=1e-12)
    assert np.isclose(found.inertia[0, 0].imag / 1e-30, 0.4 * 5.0 / 2.0 * 4.0 / 3.0 * np.pi * 32.0, rtol=1e-11)


def test_the_derivative_of_a_trimmed_cylinder_by_radius_is_its_wall():
    assert np.isclose(mass_properties(cylinder(1.5 + 1e-30j)).volume.imag / 1e-30, 12.0 * np.pi, rtol=1e-11)


@pytest.mark.parametrize(
    ("faces", "says"),
    [
        ((), "at least one"),
        (((sphere()[0][0], 2),), "each"),
        (((sphere()[0][0], 1),), "outwards"),
        (((swapped(sphere()[0][0]), -1),), "outwards"),
    ],
)
def test_faces_that_enclose_nothing_are_refused_with_the_reason(faces, says):
    with pytest.raises(GeometryError, match=says):
        mass_properties(faces)


def test_two_boxes_side_by_side_are_one_of_twice_the_length():
    one, both = mass_properties(box(1.0, 2.0, 3.0)), mass_properties(box(2.0, 2.0, 3.0))
    found = placed(one, np.stack([np.eye(3)] * 2), np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    assert np.isclose(found.volume, both.volume, rtol=1e-14)
    assert np.allclose(found.centroid, both.centroid, rtol=1e-14)
    assert np.allclose(found.inertia, both.inertia, rtol=1e-13, atol=1e-13)
    assert np.isclose(found.area, 2.0 * one.area, rtol=1e-14)


def test_boxes_turned_around_an_axis_have_the_inertia_of_the_faces_that_they_are():
    angles = 2.0 * np.pi * np.arange(5) / 7.0
    turns = np.array([[[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]] for a in angles])
    shape = [(translated(face, (0.3, 4.0, 0.2)), sign) for face, sign in box(1.0, 2.0, 3.0)]
    found = placed(mass_properties(shape), turns, np.zeros((5, 3)))
    naive = mass_properties([(rotated(face, angle), sign) for angle in angles for face, sign in shape])
    assert np.allclose(found.centroid, naive.centroid, rtol=1e-12)
    assert np.allclose(found.inertia, naive.inertia, rtol=1e-11, atol=1e-9)
