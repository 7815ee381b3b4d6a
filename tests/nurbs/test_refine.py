import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bladewright.errors import GeometryError
from bladewright.nurbs.basis import greville, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended, piece, reparametrised, reversed, split, swapped  # noqa: A004
from bladewright.nurbs.refine import elevated, inserted

SAME = {"rtol": 0.0, "atol": 1e-12}


def inside(domain, *fractions):
    return [domain[0] + fraction * (domain[1] - domain[0]) for fraction in fractions]


def test_knot_insertion_leaves_a_curve_where_it_is(curve, spread):
    new = inside(curve.domain, 0.31, 0.77, 0.77)[: 1 + curve.degree]
    refined = inserted(curve, new)
    u = spread(curve.domain)
    assert len(refined.control_points) == len(curve.control_points) + len(new) or curve.degree < 2
    assert np.allclose(refined(u), curve(u), **SAME)


def test_degree_elevation_leaves_a_curve_where_it_is(curve, spread):
    raised = elevated(curve, 2)
    u = spread(curve.domain)
    assert raised.degree == curve.degree + 2
    assert np.allclose(raised(u), curve(u), **SAME)


@pytest.mark.parametrize("direction", ["u", "v"])
def test_refinement_leaves_a_surface_where_it_is(surface, spread, direction):
    u, v = spread(surface.domain_u)[:, None], spread(surface.domain_v)
    domain = surface.domain_u if direction == "u" else surface.domain_v
    for refined in (inserted(surface, inside(domain, 0.31), direction), elevated(surface, 1, direction)):
        assert np.allclose(refined(u, v), surface(u, v), **SAME)


def test_an_inserted_knot_moves_only_control_points_near_it():
    curve = Curve(control_points=np.random.default_rng(0).random((12, 2)), knots=uniform_knots(12, 3), degree=3)
    refined = inserted(curve, 0.5)
    assert np.allclose(refined.control_points[:5], curve.control_points[:5], rtol=0.0, atol=1e-15)
    assert np.allclose(refined.control_points[-5:], curve.control_points[-5:], rtol=0.0, atol=1e-15)
    assert not np.allclose(refined.control_points[5:7], curve.control_points[5:7], rtol=0.0, atol=1e-3)


@given(
    degree=st.integers(1, 5), knots=st.lists(st.floats(0.01, 0.99), max_size=6, unique=True), seed=st.integers(0, 999)
)
def test_any_refinement_leaves_any_curve_where_it_is(degree, knots, seed):
    random = np.random.default_rng(seed)
    own = np.concatenate([np.zeros(degree + 1), np.sort(random.random(3)), np.ones(degree + 1)])
    curve = Curve(control_points=random.normal(size=(degree + 4, 2)), knots=own, degree=degree)
    u = np.linspace(0.0, 1.0, 41)
    # a divided difference loses as many digits as its knots are close
    near = np.diff(np.sort(np.concatenate([own[degree : -degree or None], knots])))
    tolerance = np.clip(1e-15 / max(near.min(), 1e-300), 1e-12, 1e-8)
    assert np.allclose(elevated(inserted(curve, knots) if knots else curve)(u), curve(u), rtol=0.0, atol=tolerance)


def test_the_control_polygon_tends_to_the_curve_with_the_square_of_the_knot_span():
    curve = Curve(control_points=np.random.default_rng(4).random((7, 2)), knots=uniform_knots(7, 3), degree=3)
    errors = []
    for pieces in (32, 64, 128):
        refined = inserted(curve, np.setdiff1d(np.arange(4 * pieces + 1) / (4 * pieces), curve.knots))
        errors.append(np.max(np.abs(refined.control_points - curve(greville(refined.knots, 3)))))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # the next term of the error is one order smaller: a thirty-second of the span
    assert np.allclose(orders, 2.0, atol=0.05)


def test_the_pieces_of_a_split_curve_are_its_pieces(curve):
    cuts = inside(curve.domain, 0.3, 0.55)
    parts = split(curve, cuts)
    ends = [curve.domain[0], *cuts, curve.domain[1]]
    for part, start, end in zip(parts, ends[:-1], ends[1:], strict=True):
        assert part.domain == (start, end)
        u = np.linspace(start, end, 9)[:-1]
        assert np.allclose(part(u), curve(u), **SAME)


@pytest.mark.parametrize("direction", ["u", "v"])
def test_a_piece_of_a_surface_lies_on_it(surface, direction):
    domain = surface.domain_u if direction == "u" else surface.domain_v
    part = piece(surface, *inside(domain, 0.23, 0.71), direction)
    (a, b), (c, d) = part.domain_u, part.domain_v
    u, v = np.linspace(a, b, 9)[:-1, None], np.linspace(c, d, 8)[:-1]
    assert np.allclose(part(u, v), surface(u, v), **SAME)


@pytest.mark.parametrize(("start", "end"), [(-0.1, 1.15), (0.0, 1.2), (-0.1, 1.0), (0.2, 1.1)])
def test_an_extended_curve_is_the_same_function_past_its_ends(curve, start, end, spread):
    longer = extended(curve, *inside(curve.domain, start, end))
    u = spread(longer.domain)[:-1]
    # a polynomial of degree five, a fifth of its interval outside, enlarges rounding by Lebesgue's hundred
    assert np.allclose(longer(u), curve(u), rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("direction", ["u", "v"])
def test_an_extended_surface_is_the_same_function_past_its_ends(surface, direction):
    domain = surface.domain_u if direction == "u" else surface.domain_v
    longer = extended(surface, *inside(domain, -0.05, 1.05), direction)
    (a, b), (c, d) = longer.domain_u, longer.domain_v
    u, v = np.linspace(a, b, 9)[:-1, None], np.linspace(c, d, 8)[:-1]
    assert np.allclose(longer(u, v), surface(u, v), rtol=1e-11, atol=1e-11)


def test_a_reversed_curve_runs_backwards(curve, spread):
    u = spread(curve.domain)
    assert np.allclose(reversed(curve)(curve.domain[0] + curve.domain[1] - u), curve(u), **SAME)
    assert np.allclose(reversed(curve).derivative(curve.domain[0]), -curve.derivative(curve.domain[1]), rtol=1e-12)


def test_a_surface_reversed_in_u_or_swapped_turns_its_normal(real_surface):
    (a, b), (c, d) = real_surface.domain_u, real_surface.domain_v
    u, v = a + 0.3 * (b - a), c + 0.6 * (d - c)
    normal = real_surface.normal(u, v)
    assert np.allclose(reversed(real_surface).normal(a + b - u, v), -normal, **SAME)
    assert np.allclose(reversed(real_surface, "v").normal(u, c + d - v), -normal, **SAME)
    assert np.allclose(swapped(real_surface).normal(v, u), -normal, **SAME)
    assert np.allclose(swapped(real_surface)(v, u), real_surface(u, v), **SAME)


def test_a_reparametrised_curve_is_the_same_at_mapped_parameters(curve, spread):
    mapped = reparametrised(curve, 2.0, 5.0)
    u = spread(curve.domain)
    fraction = (u - curve.domain[0]) / (curve.domain[1] - curve.domain[0])
    assert mapped.domain == (2.0, 5.0)
    assert np.allclose(mapped(2.0 + 3.0 * fraction)[:-1], curve(u)[:-1], **SAME)


CUBIC = Curve(control_points=np.random.default_rng(0).random((5, 2)), knots=uniform_knots(5, 3), degree=3)
WEIGHTED = Curve(control_points=CUBIC.control_points, knots=CUBIC.knots, degree=3, weights=[1.0, 5.0, 1.0, 5.0, 1.0])


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: inserted(CUBIC, 1.0), "inside"),
        (lambda: inserted(CUBIC, [0.5, 0.5, 0.5]), "at most 3"),
        (lambda: inserted(CUBIC, 0.5, "v"), "direction 'v'"),
        (lambda: elevated(CUBIC, -1), "lowered"),
        (lambda: piece(CUBIC, -0.1, 0.5), "inside"),
        (lambda: split(CUBIC, [1.0]), "cut"),
        (lambda: extended(CUBIC, 1.0, 1.0), "below"),
        (lambda: extended(WEIGHTED, -1.0, 1.0), "extend it less far"),
        (lambda: reparametrised(CUBIC, 1.0, 0.0), "below"),
    ],
)
def test_what_cannot_be_done_is_refused_with_the_reason(ask, says):
    with pytest.raises(GeometryError, match=says):
        ask()


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-8, 1e-10])
def test_knots_that_nearly_coincide_cost_no_digits(gap):
    knots = np.concatenate([np.zeros(6), [0.1, 0.15, 0.15 + gap, 0.15 + 2.0 * gap, 0.5], np.ones(6)])
    points = np.random.default_rng(1).normal(size=(len(knots) - 6, 3))
    curve = Curve(control_points=points, knots=knots, degree=5)
    t = np.linspace(0.0, 1.0, 101)
    assert inserted(curve, [0.22, 0.7])(t) == pytest.approx(curve(t), abs=1e-13)
    assert piece(curve, 0.12, 0.8)(t[12:80]) == pytest.approx(curve(t[12:80]), abs=1e-13)
