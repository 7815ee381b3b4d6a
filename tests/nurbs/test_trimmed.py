import numpy as np
import pytest

from bladewright.errors import GeometryError
from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed  # noqa: A004
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.refine import elevated
from bladewright.nurbs.revolution import Revolution, arc, circle, revolved, segment
from bladewright.nurbs.skinning import ruled
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.transform import scaled, transformed
from bladewright.nurbs.trimmed import TrimmedSurface

PLANE = ruled(segment((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), segment((0.0, 1.0, 0.0), (1.0, 1.0, 0.0)))
KNOTTED = Surface(
    control_points=0.3 * np.random.default_rng(0).random((7, 6, 3))
    + np.arange(7.0)[:, None, None] * [1, 0, 0]
    + np.arange(6.0)[:, None] * [0, 1, 0],
    knots_u=uniform_knots(7, 2),
    knots_v=uniform_knots(6, 3),
    degree_u=2,
    degree_v=3,
)
SPHERE = revolved(arc((0.0, 0.0, 0.0), 2.0, 0.0, np.pi, axes=((-1, 0, 0), (0, 1, 0))))


def frame(a, b, c, d):
    corners = [(a, c), (b, c), (b, d), (a, d)]
    return tuple(segment(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True))


def disc(surface=PLANE, radius=0.3):
    return TrimmedSurface(surface=surface, boundary=(circle((0.5, 0.5), radius),))


def blob():
    """A smooth closed B-spline that is not star-shaped, with ears in u."""
    angle = np.linspace(0.0, 2.0 * np.pi, 33)
    radius = 0.25 + 0.15 * np.cos(3 * angle)
    points = np.stack([0.5 + radius * np.cos(angle), 0.5 + radius * np.sin(angle)], axis=-1)
    points[-1] = points[0]
    return interpolated(points, angle / (2 * np.pi), degree=3)


def test_the_area_of_a_disc_is_pi_times_the_square_of_its_radius():
    assert np.isclose(disc().area(), np.pi * 0.09, rtol=1e-12)


def test_a_face_trimmed_along_its_own_edges_has_the_area_of_the_surface():
    whole = TrimmedSurface(surface=SPHERE, boundary=frame(0.0, 1.0, 0.0, 1.0))
    assert np.isclose(whole.area(), 16.0 * np.pi, rtol=1e-12)


def test_a_zone_of_a_sphere_has_the_area_of_the_cylinder_around_it():
    zone = TrimmedSurface(surface=SPHERE, boundary=frame(0.2, 0.7, 0.0, 0.5))
    height = SPHERE(0.7, 0.0)[0] - SPHERE(0.2, 0.0)[0]
    assert np.isclose(zone.area(), np.pi * 2.0 * height, rtol=1e-12)


def test_polynomials_over_a_triangle_have_their_moments():
    corners = [(0.1, 0.2), (0.9, 0.3), (0.4, 0.8)]
    sides = tuple(segment(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True))
    triangle = TrimmedSurface(surface=PLANE, boundary=sides)
    (x0, y0), (x1, y1), (x2, y2) = corners
    size = 0.5 * ((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0))
    found = triangle.integral(lambda u, v: np.stack([np.ones_like(u), u, v, u * u], axis=-1))
    second = (x0**2 + x1**2 + x2**2 + x0 * x1 + x1 * x2 + x2 * x0) / 6.0
    assert np.allclose(found, size * np.array([1.0, (x0 + x1 + x2) / 3, (y0 + y1 + y2) / 3, second]), rtol=1e-13)


@pytest.mark.parametrize(
    "boundary",
    [circle((0.5, 0.5), 0.4), blob(), elevated(blob(), 6), elevated(circle((0.5, 0.5), 0.4), 5)],
    ids=["disc", "blob", "blob of degree 9", "disc of degree 7"],
)
def test_a_trimmed_integral_is_the_mean_over_points_inside(boundary):
    face = TrimmedSurface(surface=KNOTTED, boundary=(boundary,))

    def height(u, v):
        return np.sum(KNOTTED(u, v) ** 2, axis=-1)

    u, v = face.interior_points(10_000, seed=1)
    values = height(u, v)
    mean = face.integral(height) / face.parametric_area
    # four standard errors of the sample
    assert abs(values.mean() - mean) < 4.0 * values.std() / np.sqrt(len(values))


def test_knots_that_the_boundary_crosses_do_not_spoil_the_accuracy():
    """A face cut in two along a curve that follows no knot: the parts add up to the whole."""
    cut = Curve(control_points=[[0.1, 0.0], [0.7, 0.3], [0.2, 0.6], [0.8, 1.0]], knots=uniform_knots(4, 3), degree=3)
    left = (cut, segment((0.8, 1.0), (0.0, 1.0)), segment((0.0, 1.0), (0.0, 0.0)), segment((0.0, 0.0), (0.1, 0.0)))
    right = (
        segment((0.1, 0.0), (1.0, 0.0)),
        segment((1.0, 0.0), (1.0, 1.0)),
        segment((1.0, 1.0), (0.8, 1.0)),
        reversed(cut),
    )
    parts = [TrimmedSurface(surface=KNOTTED, boundary=boundary).area() for boundary in (left, right)]
    whole = TrimmedSurface(surface=KNOTTED, boundary=frame(0.0, 1.0, 0.0, 1.0)).area()
    assert np.isclose(sum(parts), whole, rtol=1e-12)


def test_points_are_inside_the_disc_that_bounds_them():
    u, v = np.random.default_rng(0).random((2, 5000))
    inside = (u - 0.5) ** 2 + (v - 0.5) ** 2 < 0.09
    assert np.array_equal(disc().contains(u, v), inside)


def test_points_are_inside_a_boundary_with_ears_when_a_fine_polygon_winds_around_them():
    boundary = blob()
    u, v = np.random.default_rng(0).random((2, 500))
    polygon = boundary(np.linspace(0.0, 1.0, 4001))
    turned = np.unwrap(np.arctan2(polygon[:, 1] - v[:, None], polygon[:, 0] - u[:, None]), axis=1)
    winding = np.rint((turned[:, -1] - turned[:, 0]) / (2.0 * np.pi))
    assert np.array_equal(TrimmedSurface(surface=PLANE, boundary=(boundary,)).contains(u, v), winding == 1)


def test_rays_through_corners_and_along_edges_count_once():
    square = TrimmedSurface(surface=PLANE, boundary=frame(0.25, 0.75, 0.25, 0.75))
    diamond = TrimmedSurface(
        surface=PLANE,
        boundary=tuple(
            segment(p, q)
            for p, q in (
                ((0.5, 0.25), (0.75, 0.5)),
                ((0.75, 0.5), (0.5, 0.75)),
                ((0.5, 0.75), (0.25, 0.5)),
                ((0.25, 0.5), (0.5, 0.25)),
            )
        ),
    )
    assert square.contains(0.5, 0.5)
    assert diamond.contains(0.4, 0.5)
    assert not square.contains([0.1, 0.1, 0.9], [0.25, 0.75, 0.5]).any()
    assert not diamond.contains([0.1, 0.1, 0.1, 0.9], [0.25, 0.5, 0.75, 0.5]).any()


def test_interior_points_are_inside_and_the_same_for_the_same_seed():
    face = TrimmedSurface(surface=PLANE, boundary=(blob(),))
    u, v = face.interior_points(2000, seed=3)
    again = face.interior_points(2000, seed=3)
    assert len(u) == 2000
    assert face.contains(u, v).all()
    assert np.array_equal(u, again[0])
    assert np.array_equal(v, again[1])
    assert not np.array_equal(u, face.interior_points(2000, seed=4)[0])


def test_a_trimmed_surface_has_the_points_and_normals_of_its_surface():
    face = disc(SPHERE)
    assert np.array_equal(face(0.3, 0.4), SPHERE(0.3, 0.4))
    assert np.array_equal(face.normal(0.3, 0.4), SPHERE.normal(0.3, 0.4))


def test_a_transformed_face_keeps_its_boundary():
    face = transformed(disc(), np.diag([2.0, 3.0, 1.0]))
    assert np.isclose(face.area(), 6.0 * np.pi * 0.09, rtol=1e-12)


def test_the_area_carries_an_imaginary_step_of_the_boundary_and_of_the_surface():
    assert np.isclose(disc(radius=0.3 + 1e-30j).area().imag / 1e-30, 2.0 * np.pi * 0.3, rtol=1e-11)
    grown = disc(scaled(PLANE, 1.0 + 1e-30j, (0.0, 0.0, 0.0)))
    assert np.isclose(grown.area().imag / 1e-30, 2.0 * np.pi * 0.09, rtol=1e-11)
    curved = disc(SPHERE, 0.2 + 1e-30j).area().imag / 1e-30
    up, down = (disc(SPHERE, 0.2 + h).area() for h in (1e-5, -1e-5))
    assert np.isclose(curved, (up - down) / 2e-5, rtol=1e-7)


@pytest.mark.parametrize(
    ("boundary", "says"),
    [
        ((), "at least one"),
        ((segment((0, 0, 0), (1, 1, 1)),), "at least one"),
        (frame(0.0, 1.0, 0.0, 1.0)[:3], "away from the end"),
        (frame(0.0, 1.0, 0.0, 1.0)[::-1], "away from the end"),
        ((reversed(circle((0.5, 0.5), 0.3)),), "counter-clockwise"),
    ],
)
def test_a_boundary_that_encloses_nothing_is_refused_with_the_reason(boundary, says):
    with pytest.raises(GeometryError, match=says):
        TrimmedSurface(surface=PLANE, boundary=boundary)


def hole(u, v, radius, angle=2.0 * np.pi):
    """A clockwise circle."""
    return (arc((u, v), radius, angle, angle - 2.0 * np.pi),)


def test_a_disc_with_holes_lacks_their_areas_and_their_points():
    boundary, holes = (circle((0.5, 0.5), 0.45),), (hole(0.35, 0.4, 0.1), hole(0.7, 0.6, 0.05, 1.0))
    face = TrimmedSurface(surface=PLANE, boundary=boundary, holes=holes)
    assert np.isclose(face.area(), np.pi * (0.45**2 - 0.1**2 - 0.05**2), rtol=1e-12)
    assert np.isclose(face.parametric_area, face.area(), rtol=1e-12)
    u, v = np.random.default_rng(0).random((2, 5000))
    inside = (u - 0.5) ** 2 + (v - 0.5) ** 2 < 0.45**2
    inside &= ((u - 0.35) ** 2 + (v - 0.4) ** 2 > 0.1**2) & ((u - 0.7) ** 2 + (v - 0.6) ** 2 > 0.05**2)
    assert np.array_equal(face.contains(u, v), inside)
    assert face.contains(*face.interior_points(500)).all()
    moment = face.integral(lambda u, v: u + 0.0 * v)
    assert np.isclose(moment, np.pi * (0.45**2 * 0.5 - 0.1**2 * 0.35 - 0.05**2 * 0.7), rtol=1e-12)
    assert "outside 2 holes" in repr(face)
    assert face.curves == (*boundary, *holes[0], *holes[1])


def test_what_a_hole_lacks_is_what_its_own_face_has():
    boundary, cut = frame(0.05, 0.99, 0.1, 0.95), blob()
    whole, inside = (TrimmedSurface(surface=KNOTTED, boundary=loop) for loop in (boundary, (cut,)))
    rest = TrimmedSurface(surface=KNOTTED, boundary=boundary, holes=((reversed(cut),),))
    assert np.isclose(rest.area() + inside.area(), whole.area(), rtol=1e-12)


def test_a_hole_in_the_wall_of_a_cylinder_carries_an_imaginary_step():
    """A window of a cylinder, in which a rectangle of heights and angles is missing."""
    wall = Revolution(meridian=segment((0.0, 2.0), (3.0, 2.0)), start=-0.5, end=1.1)

    def rectangle(x, start, end):
        low, high = (wall.v(np.asarray(angle)) for angle in (start, end))
        return frame(x[0] / 3.0, x[1] / 3.0, low, high)

    around = rectangle((0.5, 2.5), -0.2, 0.9)
    missing = tuple(reversed(side) for side in rectangle((1.0, 1.0 + 0.7 * (1.0 + 1e-30j)), 0.1, 0.4)[::-1])
    face = TrimmedSurface(surface=wall.surface(), boundary=around, holes=(missing,), revolution=wall)
    area = face.area()
    assert np.isclose(area.real, 2.0 * (2.0 * 1.1 - 0.7 * 0.3), rtol=1e-12)
    assert np.isclose(area.imag / 1e-30, -2.0 * 0.7 * 0.3, rtol=1e-11)


@pytest.mark.parametrize(
    ("holes", "says"),
    [
        (((),), "a hole 1 of curves"),
        ((frame(0.4, 0.6, 0.4, 0.6)[:3],), "hole 1 curve 0 starts"),
        ((hole(0.5, 0.5, 0.1), (circle((0.8, 0.5), 0.1),)), "hole 2 encloses .* must run clockwise"),
        ((hole(0.9, 0.5, 0.2),), "hole 1 passes"),
        ((hole(0.5, 0.5, 0.2), hole(0.5, 0.5, 0.1)), "inside another hole"),
    ],
)
def test_a_hole_that_is_none_is_refused_with_the_reason(holes, says):
    with pytest.raises(GeometryError, match=says):
        TrimmedSurface(surface=PLANE, boundary=frame(0.0, 1.0, 0.0, 1.0), holes=holes)
