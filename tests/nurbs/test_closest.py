import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from bladewright.errors import GeometryError
from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.bezier import patches
from bladewright.nurbs.closest import Descents, closest_on_curve, closest_on_surface
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.descent import polished
from bladewright.nurbs.domain import extended
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.refine import inserted
from bladewright.nurbs.revolution import arc, circle, revolved, segment
from bladewright.nurbs.skinning import ruled
from bladewright.nurbs.surface import Surface

SPHERE = revolved(arc((0.0, 0.0, 0.0), 2.0, 0.0, np.pi, axes=((-1, 0, 0), (0, 1, 0))))
TORUS = revolved(circle((0.0, 3.0, 0.0), 1.0, axes=((1, 0, 0), (0, 1, 0))))


def around(shape, count, seed=0):
    """Points in a box half as large again as that of the control points."""
    net = shape.control_points.real.reshape(-1, shape.control_points.shape[-1])
    low, high = net.min(axis=0), net.max(axis=0)
    return low - 0.25 * (high - low) + 1.5 * (high - low) * np.random.default_rng(seed).random((count, net.shape[1]))


def spiral():
    """Five turns, 0.1 apart: as many local minima of the distance to its middle."""
    angle = np.linspace(0.0, 10.0 * np.pi, 120)
    radius = 0.5 + 0.1 * angle / (2.0 * np.pi)
    return interpolated(
        np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1), angle / angle[-1], degree=3
    )


def corrugated():
    """A sheet with five waves, whose troughs are nearly equally near to points far below."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 31), np.linspace(0.0, 1.0, 9), indexing="ij")
    height = 0.1 * np.sin(10.0 * np.pi * u) - 1e-3 * np.sin(np.pi * u) * v
    return Surface(
        control_points=np.stack([u, v, height], axis=-1),
        knots_u=uniform_knots(31, 3),
        knots_v=uniform_knots(9, 3),
        degree_u=3,
        degree_v=3,
    )


def sampled(shape, count):
    if isinstance(shape, Curve):
        return shape(np.linspace(*shape.domain, count))
    return shape.grid(np.linspace(*shape.domain_u, count), np.linspace(*shape.domain_v, count)).reshape(-1, 3)


def test_no_sample_of_a_curve_is_nearer_than_the_closest_point(real_curve):
    points = around(real_curve, 300)
    found = closest_on_curve(real_curve, points)
    nearest, _ = cKDTree(sampled(real_curve, 20_001)).query(points)
    assert (found.distances <= nearest + 1e-12).all()
    # samples are at most this far from each other, and from the closest point half of it
    step = np.max(np.linalg.norm(np.diff(sampled(real_curve, 20_001), axis=0), axis=-1))
    assert (found.distances >= nearest - step).all()


def test_no_sample_of_a_surface_is_nearer_than_the_closest_point(real_surface):
    points = around(real_surface, 200)
    found = closest_on_surface(real_surface, points)
    nearest, _ = cKDTree(sampled(real_surface, 301)).query(points)
    assert (found.distances <= nearest + 1e-12).all()
    assert np.allclose(real_surface(found.u, found.v), found.points, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("make", [spiral, lambda: inserted(spiral(), 0.77)], ids=["spiral", "refined"])
def test_on_a_spiral_the_nearest_turn_is_found(make):
    curve = make()
    points = around(curve, 2000)
    found = closest_on_curve(curve, points)
    samples = sampled(curve, 200_001)
    nearest, _ = cKDTree(samples).query(points)
    assert (found.distances <= nearest + 1e-12).all()
    # samples are 1.3e-4 apart, so that one is at most half of that further away
    assert np.allclose(found.distances, nearest, rtol=0.0, atol=7e-5)


def test_of_nearly_equal_troughs_the_nearest_is_found():
    sheet = corrugated()
    points = np.stack([*np.random.default_rng(0).random((2, 300)), np.full(300, -20.0)], axis=-1)
    found = closest_on_surface(sheet, points)
    nearest, _ = cKDTree(sampled(sheet, 601)).query(points)
    assert (found.distances <= nearest + 1e-12).all()


@given(
    control=st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1)), min_size=4, max_size=9),
    point=st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
    degree=st.integers(1, 3),
)
def test_the_closest_point_on_any_curve_beats_all_samples(control, point, degree):
    curve = Curve(control_points=control, knots=uniform_knots(len(control), degree), degree=degree)
    found = closest_on_curve(curve, point)
    nearest = np.linalg.norm(sampled(curve, 2001) - point, axis=-1).min()
    # the search may stop where nothing is nearer by more than 1e-9 of the extent, which is at most two
    assert found.distances <= nearest + 3e-9
    assert np.isclose(np.linalg.norm(curve(found.u) - point), found.distances, rtol=0.0, atol=1e-14)


@settings(max_examples=30)
@given(seed=st.integers(0, 100_000), rational=st.booleans())
def test_the_closest_point_on_any_surface_beats_all_samples(seed, rational):
    random = np.random.default_rng(seed)
    surface = Surface(
        control_points=random.random((6, 5, 3)),
        knots_u=uniform_knots(6, 3),
        knots_v=uniform_knots(5, 2),
        degree_u=3,
        degree_v=2,
        weights=0.2 + 3.0 * random.random((6, 5)) if rational else None,
    )
    points = around(surface, 20, seed)
    found = closest_on_surface(surface, points)
    nearest, _ = cKDTree(sampled(surface, 101)).query(points)
    assert (found.distances <= nearest + 3e-9).all()


def test_points_of_a_shape_are_found_where_they_are(real_curve, real_surface):
    u = np.linspace(*real_curve.domain, 37)
    assert np.allclose(closest_on_curve(real_curve, real_curve(u)).distances, 0.0, atol=1e-9)
    v = np.linspace(*real_surface.domain_v, 11)
    s = np.linspace(*real_surface.domain_u, 13)[:, None]
    assert np.allclose(closest_on_surface(real_surface, real_surface(s, v)).distances, 0.0, atol=1e-9)


def test_a_search_ends_where_a_whole_line_is_nearest_but_for_the_error_of_interpolation():
    angle = np.linspace(0.0, 1.5, 50) ** 3 / 1.5**2
    rings = [
        interpolated(np.stack([np.cos(angle), np.sin(angle), np.full(50, z)], axis=-1), angle / 1.5, degree=5)
        for z in (0.0, 2.0)
    ]
    points = np.stack([np.zeros(44), np.zeros(44), np.linspace(0.1, 1.9, 44)], axis=-1)
    assert np.allclose(closest_on_surface(ruled(*rings), points).distances, 1.0, rtol=0.0, atol=1e-8)


def test_a_search_ends_where_distances_are_rounding_of_a_rational_surface():
    cone, (u, v) = revolved(segment((0.0, 1.0, 0.0), (1.0, 2.0, 0.0))), np.random.default_rng(1).random((2, 44))
    points = cone(u, v) + 2e-8 * cone.normal(u, v)
    assert np.allclose(closest_on_surface(cone, points).distances, 2e-8, rtol=0.0, atol=1e-13)


def test_distances_to_a_circle_are_those_of_the_closed_form():
    points = around(circle((1.0, 2.0), 3.0), 1000)
    found = closest_on_curve(circle((1.0, 2.0), 3.0), points)
    expected = np.linalg.norm(points - [1.0, 2.0], axis=-1) - 3.0
    assert np.allclose(found.distances, np.abs(expected), rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("distance", [1e-6, 1.0, 1e3, 1e6])
def test_distances_to_a_torus_are_those_of_the_closed_form(distance):
    direction = np.random.default_rng(0).normal(size=(50, 3))
    points = (
        TORUS(*np.random.default_rng(1).random((2, 50)))
        + distance * direction / np.linalg.norm(direction, axis=-1)[:, None]
    )
    found = closest_on_surface(TORUS, points)
    expected = np.hypot(np.hypot(points[:, 1], points[:, 2]) - 3.0, points[:, 0]) - 1.0
    assert np.allclose(found.distances, np.abs(expected), rtol=1e-14, atol=1e-13)


def test_where_everything_is_equally_near_anything_is_right():
    assert np.isclose(closest_on_curve(circle((1.0, 2.0), 3.0), (1.0, 2.0)).distances, 3.0, rtol=1e-13)
    assert np.isclose(closest_on_surface(SPHERE, (0.0, 0.0, 0.0)).distances, 2.0, rtol=1e-13)
    assert np.isclose(closest_on_surface(TORUS, (0.3, 0.0, 0.0)).distances, np.hypot(3.0, 0.3) - 1.0, rtol=1e-13)


def test_beyond_its_ends_the_end_is_closest():
    line = segment((0.0, 0.0), (2.0, 0.0))
    found = closest_on_curve(line, [[-1.0, 1.0], [3.0, -1.0], [0.5, 4.0]])
    assert np.array_equal(found.u[:2], [0.0, 1.0])
    assert np.allclose(found.u[2], 0.25)
    assert np.allclose(found.distances, [np.sqrt(2.0), np.sqrt(2.0), 4.0])
    square = ruled(segment((0, 0, 0), (1, 0, 0)), segment((0, 1, 0), (1, 1, 0)))
    corner = closest_on_surface(square, [[2.0, 3.0, 1.0], [0.4, -1.0, 1.0]])
    assert np.allclose(corner.points, [[1.0, 1.0, 0.0], [0.4, 0.0, 0.0]], rtol=0.0, atol=1e-14)


def test_a_kink_may_be_the_closest_point():
    corner = Curve(control_points=[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]], knots=[0, 0, 0.37, 1, 1], degree=1)
    found = closest_on_curve(corner, [[-1.0, -2.0], [-0.1, 0.5]])
    assert found.u[0] == 0.37
    assert np.isclose(found.distances[0], np.sqrt(5.0))
    assert np.isclose(found.distances[1], 0.1)
    roof = ruled(*(segment((x, 0, 0), (x, 1, 0)) for x in (0.0, 1.0)))
    net = np.array([[[0, 0, 0], [0, 1, 0]], [[1, 0, 1], [1, 1, 1]], [[2, 0, 0], [2, 1, 0]]], dtype=float)
    roof = Surface(control_points=net, knots_u=[0, 0, 0.37, 1, 1], knots_v=roof.knots_v, degree_u=1, degree_v=1)
    ridge = closest_on_surface(roof, [[1.1, 0.4, 3.0]])
    assert np.allclose(ridge.points, [[1.0, 0.4, 1.0]], rtol=0.0, atol=1e-9)


def test_beside_a_corner_a_long_side_is_found_though_the_samples_of_a_short_face_are_nearer():
    net = np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, -0.001], [1.0, -0.002]])
    outline = Curve(control_points=net, knots=np.array([0.0, 0.0, 0.0, 0.9, 0.9, 1.0, 1.0, 1.0]), degree=2)
    below = np.linspace(1e-5, 9e-4, 50)
    points = np.stack([np.full(50, 1.0 - 9.5e-4), -below], axis=-1)
    found = Descents((outline,)).nearest(points)
    np.testing.assert_allclose(np.sqrt(found.square), below, rtol=1e-9)


def test_parameters_move_with_the_data_as_when_searched_again():
    base = spiral()
    control, change = base.control_points, np.random.default_rng(0).normal(size=base.control_points.shape)
    points = around(base, 40)

    def curve(step):
        return Curve(control_points=control + step * change, knots=base.knots, degree=3)

    stepped = closest_on_curve(curve(1e-30j), points)
    up, down = (closest_on_curve(curve(h), points) for h in (1e-6, -1e-6))
    same = np.abs(up.u - down.u) < 1e-3
    assert same.sum() > 35
    for name in ("u", "points", "distances"):
        difference = (getattr(up, name) - getattr(down, name))[same] / 2e-6
        size = np.max(np.abs(difference))
        # rounding over a step of 1e-6, and its square times a third derivative
        assert np.allclose(getattr(stepped, name).imag[same] / 1e-30, difference, rtol=1e-5, atol=1e-6 * size)


def test_parameters_of_a_surface_move_with_points_as_when_searched_again():
    sheet = corrugated()
    points = np.random.default_rng(1).random((40, 3)) * [1.4, 1.4, 0.2] - [0.2, 0.2, 0.0]
    change = np.random.default_rng(0).normal(size=points.shape)
    stepped = closest_on_surface(sheet, points + 1e-30j * change)
    up, down = (closest_on_surface(sheet, points + h * change) for h in (1e-6, -1e-6))
    same = (np.abs(up.u - down.u) < 1e-3) & (np.abs(up.v - down.v) < 1e-3)
    assert same.sum() > 35
    for name in ("u", "v", "points", "distances"):
        difference = (getattr(up, name) - getattr(down, name))[same] / 2e-6
        size = np.max(np.abs(difference))
        assert np.allclose(getattr(stepped, name).imag[same] / 1e-30, difference, rtol=1e-4, atol=1e-5 * size)


def test_the_closest_point_does_not_depend_on_how_the_curve_is_cut():
    curve, points = spiral(), around(spiral(), 200)
    whole = closest_on_curve(curve, points)
    cut = closest_on_curve(extended(inserted(curve, [0.111, 0.5004, 0.77]), 0.0, 1.0), points)
    assert np.allclose(whole.distances, cut.distances, rtol=0.0, atol=1e-13)


def test_points_keep_their_shape():
    assert closest_on_curve(spiral(), np.zeros((2, 3, 2))).u.shape == (2, 3)
    assert closest_on_surface(TORUS, np.ones(3)).distances.shape == ()


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: closest_on_curve(spiral(), np.zeros(3)), "2 dimensions"),
        (lambda: closest_on_curve(spiral(), [np.nan, 0.0]), "finite"),
        (lambda: closest_on_surface(TORUS, np.zeros((0, 3))), "at least one"),
    ],
)
def test_points_that_cannot_be_compared_are_refused_with_the_reason(ask, says):
    with pytest.raises(GeometryError, match=says):
        ask()


def test_places_on_a_folded_sheet_that_leans_are_found_but_beside_the_fold():
    way = np.array([*((1.0 - t, 0.0, 0.0) for t in np.linspace(0.0, 1.0, 9))])
    fold = np.concatenate([way, way[-2::-1] @ [[np.cos(1.4), np.sin(1.4), 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]])
    knots, lean = uniform_knots(len(fold), 1), np.array([-0.3, 0.3, 1.0])
    sheet = ruled(*(Curve(control_points=fold + at, knots=knots, degree=1) for at in (np.zeros(3), lean)))
    points = sheet(*np.random.default_rng(0).random((2, 2000)))
    # a descent may begin on the wrong leg where the fold is as near as the lean from one sample across to the next
    assert np.max(Descents((sheet,)).nearest(points).square) < (np.sqrt(0.18) / 20.0) ** 2


def test_a_descent_that_oversteps_a_corner_stays_on_its_side_and_one_beyond_it_ends_on_the_corner() -> None:
    side, face = [(0.0, 0.0), (0.2, 0.15), (0.8, 0.2), (1.0, 0.0)], [(1.0, -0.1), (1.0, -0.2), (1.0, -0.3)]
    net = np.array([[(*point, 0.0), (*point, 1.0)] for point in (*side, *face)])
    knots = np.repeat([0.0, 0.5, 1.0], (4, 3, 4))
    bent = Surface(control_points=net, knots_u=knots, knots_v=np.repeat([0.0, 1.0], 2), degree_u=3, degree_v=1)
    queries = np.array([[0.22119348, -0.1094632, 0.15009043], [1.3, 0.2, 0.5]])
    starts = np.array([[0.02544791, 0.9820701], [0.9, 0.1]])
    found = polished(patches(bent), queries, np.zeros(2, dtype=np.intp), starts)
    assert found.patch[0] == 0
    assert found.square[0] == pytest.approx(closest_on_surface(bent, queries[0]).distances ** 2, rel=1e-12)
    assert found.square[1] == pytest.approx(0.3**2 + 0.2**2, rel=1e-12)
