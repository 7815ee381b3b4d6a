"""Stream lines and their planes against closed forms."""

import numpy as np
import pytest

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.flow_path.channel import transfinite_channel
from bladewright.blade.flow_path.stream_surface_map import Cascade, Conformal, Paper
from bladewright.blade.flow_path.streamlines import stream_lines

V = np.array([0.0, 0.3, 1.0])


def lines(leading, trailing, mapping, hub=(), shroud=(), before=0.1, after=0.1):
    channel = transfinite_channel(Channel(leading_edge=leading, trailing_edge=trailing, hub=hub, shroud=shroud), 1.0)
    return stream_lines(channel, mapping, V, before, after)


def test_on_a_cylinder_the_conformal_length_is_x_over_r():
    found = lines(((0.0, 2.0), (0.0, 3.0)), ((1.0, 2.0), (1.0, 3.0)), Conformal())
    assert found.extents() == pytest.approx(1.0 / (2.0 + V), rel=1e-14)
    assert found.lengths == pytest.approx(np.ones(3), rel=1e-14)


def test_on_a_disc_where_x_stands_still_the_conformal_length_is_the_logarithm_of_r():
    found = lines(((0.0, 1.0), (-0.5, 1.0)), ((0.0, 4.0), (-0.5, 4.0)), Conformal())
    assert found.extents() == pytest.approx(np.full(3, np.log(4.0)), rel=1e-13)


def test_on_a_cone_the_conformal_length_is_the_logarithm_of_r_over_the_sine():
    found = lines(((0.0, 1.0), (-0.4, 2.0)), ((2.0, 1.0 + 2.0), (1.6, 4.0)), Conformal())
    radii = 1.0 + V, 3.0 + V
    assert found.extents() == pytest.approx(np.log(radii[1] / radii[0]) * np.sqrt(2.0), rel=1e-13)


CURVED = {"hub": ((0.3, 1.1), (0.8, 1.6)), "shroud": ((0.2, 2.1), (0.6, 2.5))}


@pytest.mark.parametrize("mapping", [Conformal(), Cascade(), Paper(revolved=True)], ids=lambda m: m.plane)
def test_the_inverse_of_the_abscissa_is_exact_from_nose_to_nose(mapping):
    found = lines(((0.0, 1.0), (-0.1, 2.0)), ((1.0, 2.0), (0.7, 2.9)), mapping, **CURVED)
    low, high = found.starts[:, :1], found.starts[:, -1:]
    abscissa = low + np.linspace(0.001, 0.999, 40) * (high - low)
    u = found.u_at(abscissa)
    order = 40
    x, w = np.polynomial.legendre.leggauss(order)
    inner = u[..., None] * (x + 1.0) / 2.0
    flat = inner.reshape(len(V), -1)
    density = mapping.density(found.position(flat), found.position(flat, 1)).reshape(inner.shape)
    assert np.sum(density * w, axis=-1) * u / 2.0 == pytest.approx(abscissa, abs=1e-13)


@pytest.mark.parametrize("mapping", [Conformal(), Cascade()], ids=lambda m: m.plane)
def test_the_inverse_carries_an_imaginary_step(mapping):
    found = lines(((0.0, 1.0), (-0.1, 2.0)), ((1.0, 2.0), (0.7, 2.9)), mapping, **CURVED)
    abscissa = np.linspace(0.1, 0.9, 7) * found.extents()[:, None]
    u = found.u_at(abscissa + 1e-30j)
    slope = 1.0 / mapping.density(found.position(np.real(u)), found.position(np.real(u), 1))
    assert np.imag(u) / 1e-30 == pytest.approx(slope, rel=1e-12)


@pytest.mark.parametrize("mapping", [Conformal(), Cascade(), Paper(revolved=True)], ids=lambda m: m.plane)
def test_the_slope_of_the_density_is_its_derivative(mapping):
    found = lines(((0.0, 1.0), (-0.1, 2.0)), ((1.0, 2.0), (0.7, 2.9)), mapping, **CURVED)
    u, step = np.linspace(0.05, 0.95, 9), 1e-5

    def density(at):
        return mapping.density(found.position(at), found.position(at, 1))

    central = (density(u + step) - density(u - step)) / (2.0 * step)
    slope = mapping.density_slope(found.position(u), found.position(u, 1), found.position(u, 2))
    assert slope == pytest.approx(central, abs=1e-8)


def test_stream_lines_are_the_transfinite_interpolation_of_the_four_curves():
    channel = transfinite_channel(
        Channel(leading_edge=((0.0, 1.0), (0.1, 1.6), (-0.1, 2.0)), trailing_edge=((1.0, 2.0), (0.7, 2.9)), **CURVED),
        1.0,
    )
    found = stream_lines(channel, Conformal(), V, 0.0, 0.0)
    u = np.linspace(0.0, 1.0, 11)
    curves = {wall: channel.curve(wall) for wall in ("leading_edge", "trailing_edge", "hub", "shroud")}
    for i, v in enumerate(V):
        ruled_u = (1 - u)[:, None] * curves["leading_edge"](v) + u[:, None] * curves["trailing_edge"](v)
        ruled_v = (1 - v) * curves["hub"](u) + v * curves["shroud"](u)
        corners = [curves["hub"](0.0), curves["hub"](1.0), curves["shroud"](0.0), curves["shroud"](1.0)]
        blend = ((1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v)
        both = sum(b[:, None] * c for b, c in zip(blend, corners, strict=True))
        assert found.position(u)[i] == pytest.approx(ruled_u + ruled_v - both, abs=1e-15)


def test_past_the_edges_a_wall_continues_its_own_polynomial():
    hub = ((0.2, 1.3), (0.5, 0.9), (0.8, 1.4))
    channel = transfinite_channel(
        Channel(leading_edge=((0.0, 1.0), (0.0, 2.0)), trailing_edge=((1.0, 1.0), (1.0, 2.0)), hub=hub), 1.0
    )
    found = stream_lines(channel, Cascade(), np.array([0.0]), 0.2, 0.2)
    inside = np.linspace(0.0, 1.0, 9)
    fit = np.polynomial.Polynomial.fit(inside, found.position(inside)[0, :, 1], 4)
    outside = np.array([-0.2, -0.1, 1.1, 1.2])
    assert found.position(outside)[0, :, 1] == pytest.approx(fit(outside), abs=1e-12)


def test_slopes_of_the_channel_are_its_derivatives():
    channel = transfinite_channel(
        Channel(leading_edge=((0.0, 1.0), (0.1, 1.6), (-0.1, 2.0)), trailing_edge=((1.0, 2.0), (0.7, 2.9)), **CURVED),
        1.0,
    )
    u, v, step = np.linspace(-0.1, 1.1, 7), np.linspace(0.05, 0.95, 5), 1e-6
    by_u, by_v = channel.slopes(u, v)

    def at(places):
        return stream_lines(channel, Conformal(), places, 0.2, 0.2)

    assert by_u == pytest.approx(at(v).position(u, 1), abs=1e-13)
    central = (at(v + step).position(u) - at(v - step).position(u)) / (2.0 * step)
    assert by_v == pytest.approx(central, abs=1e-8)
