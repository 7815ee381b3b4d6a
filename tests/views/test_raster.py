"""The depth buffer: what is nearer hides what is farther, and a surface has no holes."""

import numpy as np
import pytest

from bladewright.views.raster import Camera, Polyline, ShadedGrid, axes_towards, framing_camera, rendered

RED, BLUE = (0.9, 0.1, 0.1), (0.1, 0.1, 0.9)
FRONT = Camera(axes=np.eye(3), corner=np.array([-1.0, -1.0]), extent=np.array([2.0, 2.0]))


def square(half, z, colour):
    a = np.linspace(-half, half, 3)
    points = np.stack(np.broadcast_arrays(a[:, None], a, z), axis=-1)
    return ShadedGrid(points=points, normals=np.broadcast_to([0.0, 0.0, 1.0], points.shape), colour=colour)


def sphere(radius, colour):
    polar, around = np.linspace(0.0, np.pi, 61)[:, None], np.linspace(0.0, 2.0 * np.pi, 121)
    directions = np.stack(
        np.broadcast_arrays(np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)), axis=-1
    )
    return ShadedGrid(points=radius * directions, normals=directions, colour=colour)


@pytest.mark.parametrize("order", [1, -1])
def test_the_nearer_mesh_is_seen_whichever_comes_first(order):
    picture = rendered([square(0.4, 0.5, RED), square(0.8, 0.0, BLUE)][::order], [], FRONT, 100)
    assert picture[50, 50, 0] > picture[50, 50, 2]
    assert picture[50, 15, 2] > picture[50, 15, 0]


def test_nothing_is_drawn_where_nothing_is():
    picture = rendered([square(0.4, 0.0, RED)], [], FRONT, 100)
    assert (picture[:29, :, 3] == 0.0).all()
    assert (picture[31:69, 31:69, 3] == 1.0).all()
    assert rendered([], [], FRONT, 20)[..., 3].max() == 0.0


@pytest.mark.parametrize("eye", [(1.0, 0.0, 0.2), (-0.74, 0.42, 0.52), (0.3, -0.8, 0.9)])
def test_a_sphere_covers_a_disc_without_holes_from_everywhere(eye):
    camera = Camera(axes=axes_towards(eye, (0.0, 0.0, 1.0)), corner=FRONT.corner, extent=FRONT.extent)
    picture = rendered([sphere(0.8, BLUE)], [], camera, 200)
    y, x = np.mgrid[:200, :200] + 0.5
    inside = np.hypot(x - 100.0, y - 100.0) < 78.0  # a pixel and the mesh's facets inside the radius of 80
    assert (picture[inside, 3] == 1.0).all()
    # the rim is known within half a fine pixel on average: 2 pi 80 / 4 of pi 80^2, 0.6 %
    assert picture[..., 3].sum() == pytest.approx(np.pi * 80.0**2, rel=0.01)


def test_the_sense_of_normals_does_not_matter():
    ball = sphere(0.8, BLUE)
    turned = ShadedGrid(points=ball.points, normals=-ball.normals, colour=BLUE)
    assert np.array_equal(rendered([ball], [], FRONT, 60), rendered([turned], [], FRONT, 60))


def test_a_trace_is_seen_before_a_mesh_and_hidden_behind_it():
    across = np.array([[-0.9, 0.0, 0.0], [0.9, 0.0, 0.0]])
    for z, seen in ((0.5, True), (-0.5, False)):
        line = Polyline(points=across + np.array([0.0, 0.0, z]), colour=(0.0, 0.0, 0.0), width=4)
        picture = rendered([square(0.4, 0.0, RED)], [line], FRONT, 100)
        assert (picture[49:51, 50, 0].min() < 0.1) == seen
        assert picture[49:51, 10, 3].max() > 0.9


def test_a_framed_camera_holds_every_point():
    points = np.random.default_rng(3).normal(size=(200, 3)) * [1.0, 5.0, 0.2]
    camera = framing_camera(axes_towards((-0.7, 0.4, 0.5), (0.0, 0.0, 1.0)), points)
    flat = camera.seen(points)[:, :2]
    assert (flat > camera.corner).all()
    assert (flat < camera.corner + camera.extent).all()
    assert np.allclose(camera.axes @ camera.axes.T, np.eye(3), atol=1e-14)  # rounding
    assert np.linalg.det(camera.axes) == pytest.approx(1.0)
