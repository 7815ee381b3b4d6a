import numpy as np
import pytest

from bladewright.errors import GeometryError
from bladewright.nurbs.compatible import compatible, joined
from bladewright.nurbs.domain import reversed, split  # noqa: A004
from bladewright.nurbs.revolution import arc, circle, revolved, segment
from bladewright.nurbs.skinning import coons, ruled, skinned
from bladewright.nurbs.transform import mirrored, rotated, scaled, translated

SAME = {"rtol": 0.0, "atol": 1e-13}
SWEEPS = [0.3, np.pi / 2, 1.9, np.pi, 4.0, 3 * np.pi / 2, 6.0, 2 * np.pi, -1.0, -2 * np.pi]
U = np.linspace(0.0, 1.0, 41)


@pytest.mark.parametrize("sweep", SWEEPS)
def test_an_arc_lies_on_its_circle_from_its_first_to_its_last_angle(sweep):
    curve = arc((1.0, -2.0), 3.0, 0.4, 0.4 + sweep)
    assert np.allclose(np.linalg.norm(curve(U) - [1.0, -2.0], axis=-1), 3.0, **SAME)
    for u, angle in ((0.0, 0.4), (0.5, 0.4 + sweep / 2), (1.0, 0.4 + sweep)):
        assert np.allclose(curve(u), [1.0 + 3.0 * np.cos(angle), -2.0 + 3.0 * np.sin(angle)], **SAME)


def test_an_arc_has_the_fewest_pieces_of_at_most_a_right_angle():
    assert [len(arc((0, 0), 1.0, 0.0, sweep).control_points) for sweep in SWEEPS] == [3, 3, 5, 5, 7, 7, 9, 9, 3, 9]


def test_a_circle_closes_to_the_bit():
    curve = circle((0.1, 0.2), 0.7)
    assert np.array_equal(curve.control_points[0], curve.control_points[-1])


@pytest.mark.parametrize("change", ["radius", "start", "end"])
def test_arcs_carry_an_imaginary_step(change):
    values = {"radius": 2.0, "start": 0.3, "end": 2.9}
    stepped = arc((0.0, 0.0), **{**values, change: values[change] + 1e-30j})
    up, down = (arc((0.0, 0.0), **{**values, change: values[change] + h}) for h in (1e-6, -1e-6))
    # a central difference at 1e-6 is good to about 1e-10
    assert np.allclose(stepped(U).imag / 1e-30, (up(U) - down(U)) / 2e-6, rtol=0.0, atol=1e-8)


def test_a_revolved_curve_has_the_points_of_the_turned_curve():
    profile = circle((0.0, 3.0, 0.0), 1.0, axes=((1, 0, 0), (0, 1, 0)))
    for origin, axis in (((0, 0, 0), (1, 0, 0)), ((1.0, 2.0, 3.0), (1.0, 1.0, -2.0))):
        surface = revolved(profile, 0.2, 1.6, origin=origin, axis=axis)
        for v, angle in ((0.0, 0.2), (0.5, 0.9), (1.0, 1.6)):
            assert np.allclose(
                surface(U, v), rotated(profile, angle, origin=origin, axis=axis)(U), rtol=0.0, atol=1e-12
            )


@pytest.mark.parametrize("turn", [(0.3, 1.0), (0.2, 0.2 + 2.0 * np.pi), (1.0, -2.5 + 1e-30j)])
def test_smooth_arcs_are_the_same_arcs_with_a_continuous_derivative(turn):
    profile = segment((0.0, 1.0, 0.0), (2.0, 1.5, 0.3))
    arcs, smooth = (revolved(profile, *turn, smooth=smooth) for smooth in (False, True))
    np.testing.assert_allclose(smooth.grid(U, U), arcs.grid(U, U), rtol=0, atol=3e-15)
    np.testing.assert_allclose(smooth.grid(U, U).imag, arcs.grid(U, U).imag, rtol=1e-13, atol=1e-44)
    joints = np.unique(smooth.knots_v)[1:-1]
    assert all(np.sum(smooth.knots_v == joint) == smooth.degree_v - 1 for joint in joints)
    assert np.min(np.real(smooth.weights)) > 0.9


def test_a_surface_of_revolution_keeps_radius_and_height_around():
    profile = arc((0.0, 3.0, 0.0), 1.0, 0.0, 2.0, axes=((1, 0, 0), (0, 1, 0)))
    around = revolved(profile).grid(U, U)
    assert np.allclose(np.linalg.norm(around[..., 1:], axis=-1), profile(U)[:, None, 1], **SAME)
    assert np.allclose(around[..., 0], profile(U)[:, None, 0], **SAME)


def test_turning_goes_from_y_to_z_about_x():
    quarter = rotated(segment((0, 1, 0), (0, 2, 0)), np.pi / 2)
    assert np.allclose(quarter(1.0), [0.0, 0.0, 2.0], **SAME)


def test_a_ruled_surface_is_straight_between_its_curves():
    first, second = circle((0, 0), 1.0), segment((3.0, 0.0), (4.0, 1.0))
    surface = ruled(first, second)
    assert np.allclose(surface(U, 0.0), first(U), **SAME)
    assert np.allclose(surface(U, 1.0), second(U), **SAME)
    points = surface(0.3, U)
    steps = points - points[0]
    assert np.allclose(steps[:, 0] * steps[-1, 1], steps[:, 1] * steps[-1, 0], **SAME)


def test_a_coons_surface_has_its_four_curves_for_edges():
    south, north = segment((0, 0, 0), (1, 0, 0.5)), arc((0.5, 1, 0), 0.5, np.pi, 0.0, axes=((1, 0, 0), (0, 0, 1)))
    west = arc((0, 0.5, 0), 0.5, -np.pi / 2, np.pi / 2, axes=((0, 0, 1), (0, 1, 0)))
    east = segment((1, 0, 0.5), (1, 1, 0))
    surface = coons(south, north, west, east)
    for edge, points in ((south, surface(U, 0)), (north, surface(U, 1)), (west, surface(0, U)), (east, surface(1, U))):
        assert np.allclose(points, edge(U), **SAME)


def test_a_coons_surface_between_straight_edges_is_bilinear():
    a, b, c, d = np.random.default_rng(0).random((4, 3))
    surface = coons(segment(a, b), segment(c, d), segment(a, c), segment(b, d))
    assert np.allclose(surface(0.3, 0.6), 0.7 * 0.4 * a + 0.3 * 0.4 * b + 0.7 * 0.6 * c + 0.3 * 0.6 * d, **SAME)


def test_a_skinned_surface_goes_through_its_sections():
    sites = [0.0, 0.2, 0.5, 0.7, 1.0]
    sections = [arc((0.1 * k, k, 0), 1.0 + 0.2 * k, 0.0, 2.0, axes=((1, 0, 0), (0, 0, 1))) for k in range(4)]
    sections.append(segment((2.0, 5.0, 0.0), (0.0, 5.0, 2.0)))
    surface = skinned(sections, sites)
    for section, v in zip(sections, sites, strict=True):
        assert np.allclose(surface(U, v), section(U), rtol=0.0, atol=1e-12)


def test_compatible_curves_keep_their_shape_and_share_degree_and_knots():
    curves = (circle((0, 0), 1.0), segment((0, 0), (1, 1)), *split(circle((0, 0), 2.0), [0.3])[1:])
    found = compatible(curves)
    assert len({(curve.degree, tuple(curve.knots), curve.weights is None) for curve in found}) == 1
    for old, new in zip(curves, found, strict=True):
        a, b = old.domain
        assert np.allclose(new(U), old(a + (b - a) * U), rtol=0.0, atol=1e-12)


def test_a_split_curve_joins_again(curve):
    a, b = curve.domain
    parts = split(curve, [a + 0.3 * (b - a), a + 0.55 * (b - a)])
    again = joined(parts)
    assert np.allclose(again.domain, (0.0, b - a))
    assert np.allclose(again((b - a) * U), curve(a + (b - a) * U), rtol=0.0, atol=1e-12)


def test_curves_of_different_degree_and_weights_join_where_they_meet():
    path = joined(
        [segment((-1.0, 1.0), (0.0, 1.0)), arc((0.0, 0.0), 1.0, np.pi / 2, -np.pi / 2), segment((0, -1), (-1, -1))]
    )
    assert np.allclose(
        path([0.0, 0.5, 1.0, 1.5, 2.0, 3.0])[[0, 2, 3, 4, 5]], [[-1, 1], [0, 1], [1, 0], [0, -1], [-1, -1]], **SAME
    )


def test_rigid_motions_keep_distances(surface, spread):
    u, v = spread(surface.domain_u), spread(surface.domain_v)
    points = surface(u, v).real
    normal = np.array([1.0, 2.0, -1.0])
    moves = (
        lambda s: translated(s, [1.0, 2.0, 3.0]),
        lambda s: rotated(s, 0.7, origin=(1.0, 0.0, 2.0), axis=(0.0, 1.0, 1.0)),
        lambda s: mirrored(s, origin=(1.0, 0.0, 0.0), normal=normal),
    )
    for move in moves:
        moved = move(surface)(u, v).real
        before, after = (np.linalg.norm(p - p[:1], axis=-1) for p in (points, moved))
        assert np.allclose(after, before, rtol=0.0, atol=1e-12)


def test_a_reflection_is_undone_by_itself_and_keeps_its_plane(surface):
    plane = {"origin": (1.0, 0.0, 0.0), "normal": (1.0, 2.0, -1.0)}
    twice = mirrored(mirrored(surface, **plane), **plane)
    assert np.allclose(twice.control_points, surface.control_points, rtol=0.0, atol=1e-12)
    line = segment((1.0, 0.0, 0.0), (1.0, 1.0, 2.0))
    assert np.allclose(mirrored(line, **plane).control_points, line.control_points, **SAME)


def test_scaling_keeps_its_centre_and_multiplies_distances():
    line = scaled(segment((1.0, 1.0), (2.0, 3.0)), 3.0, (1.0, 1.0))
    assert np.allclose(line.control_points, [[1.0, 1.0], [4.0, 7.0]], **SAME)


LINE = segment((0.0, 0.0), (1.0, 0.0))


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: arc((0, 0), -1.0, 0.0, 1.0), "positive"),
        (lambda: arc((0, 0), 1.0, 1.0, 1.0), "2 pi"),
        (lambda: arc((0, 0), 1.0, 0.0, 7.0), "2 pi"),
        (lambda: revolved(LINE), "n, 3"),
        (lambda: ruled(LINE, segment((0, 0, 0), (1, 1, 1))), "one dimension"),
        (lambda: compatible([]), "at least one"),
        (lambda: joined([LINE, LINE]), "starts 1 away"),
        (lambda: coons(LINE, LINE, LINE, LINE), "corner"),
        (lambda: coons(*(reversed(LINE),) * 4), "corner"),
        (lambda: translated(LINE, (1.0, 2.0, 3.0)), "matrix"),
    ],
)
def test_what_cannot_be_constructed_is_refused_with_the_reason(ask, says):
    with pytest.raises(GeometryError, match=says):
        ask()
