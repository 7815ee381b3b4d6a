"""Which pieces of an outline are the walls: there the sides stand apart, and at the edges they meet."""

from itertools import pairwise

import numpy as np
import pytest

from bladewright.fitting.clouds.thinning import even_subset, without_isolated_points
from bladewright.fitting.initial_guess.channel import machine_coordinates, pairings, ranked_channels
from bladewright.fitting.initial_guess.meridional_outline import alpha_boundary, corner_sets
from machines import built, example


def cloud(name, count=1000):
    """Points on the sides of an example."""
    blade, random = built(example(name)), np.random.default_rng(3)
    return np.concatenate([side(*random.random((2, count // 2))) for side in blade.sides]), blade


@pytest.mark.parametrize("name", ["propeller", "centrifugal-impeller", "compressor-stator", "radial-turbine"])
def test_the_walls_of_long_short_and_radial_blades_are_told_from_their_edges(name):
    points, blade = cloud(name)
    machine = machine_coordinates(points, "annular")
    pieces = corner_sets(alpha_boundary(machine[:, :2]))[0]
    tried = pairings(machine, pieces, revolved=True)
    assert len(tried) == 1
    middles = [np.mean(piece, axis=0) for piece in pieces]
    channel = blade.exact.channel.real()
    walls = [channel.line(name).values(np.array([0.5]))[0] for name in ("hub", "shroud")]
    for wall in walls:
        nearest = int(np.argmin([np.sum((wall - middle) ** 2) for middle in middles]))
        assert nearest % 2 == tried[0]


def test_corners_stand_where_the_outline_does():
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]])
    closed = np.concatenate([square, square[:1]])
    line = np.concatenate([a + (b - a) * np.linspace(0.0, 1.0, 37)[:-1, None] for a, b in pairwise(closed)])
    pieces = corner_sets(line)[0]
    found = np.array([piece[0] for piece in pieces])
    off = np.min(np.sum((found[:, None] - square) ** 2, axis=-1), axis=1) ** 0.5
    assert np.max(off) < 10.0 / 1200.0


def test_the_likeliest_channel_follows_the_outline_where_outliers_bend_it():
    blade, draw = built(example("radial-turbine")), np.random.default_rng(15)
    u, v = np.meshgrid((1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 80))) / 2.0, np.linspace(0.0, 1.0, 21))
    points = np.concatenate([np.real(side(u.ravel(), v.ravel())) for side in blade.sides])
    points = points + 2e-5 * draw.normal(size=points.shape)
    off = draw.random(len(points)) < 0.03
    points = points + off[:, None] * draw.uniform(-0.05, 0.05, points.shape) * np.ptp(points)
    points = without_isolated_points(points)
    found = ranked_channels(points, even_subset(points, 1200), "annular")[0]
    true = blade.exact.channel.real()
    for edge in ("leading_edge", "trailing_edge"):
        ends = true.line(edge).values(np.array([0.0, 1.0]))
        away = np.sqrt(np.sum((found.channel.curves[edge][[0, -1]] - ends) ** 2, axis=-1))
        assert np.max(away) < 0.1 * blade.chord


@pytest.mark.parametrize(
    "name",
    ["compressor-stator", pytest.param("centrifugal-impeller", marks=pytest.mark.slow), "radial-turbine", "fan-rotor"],
)
def test_the_corners_of_a_first_channel_stand_where_those_of_the_blade_do(name):
    count = 4000
    points, blade = cloud(name, count)
    found, true = ranked_channels(points, np.arange(1200), "annular")[0], blade.exact.channel.real()
    for edge in ("leading_edge", "trailing_edge"):
        ends = true.line(edge).values(np.array([0.0, 1.0]))
        away = np.sqrt(np.sum((found.channel.curves[edge][[0, -1]] - ends) ** 2, axis=-1))
        # as far as the points of a side stand apart
        assert np.max(away) < blade.chord / np.sqrt(count / 2)
