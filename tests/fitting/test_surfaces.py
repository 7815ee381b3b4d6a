"""Surfaces fitted to scattered points."""

from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright.fitting.freeform.net import net_of
from bladewright.fitting.freeform.search import Problem, placed
from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.closest import closest_on_surface

RNG = np.random.default_rng(0)
U, V = RNG.random((2, 200))
HILL = np.stack([1.3 * U, V, 0.2 * np.sin(2.0 * U + V)], axis=-1)


def bent_surface(weights=None):
    rng = np.random.default_rng(1)
    x, y = np.meshgrid(np.linspace(0.0, 1.5, 4), np.linspace(0.0, 1.0, 5), indexing="ij")
    net = np.stack([x, y, 0.15 * rng.normal(size=x.shape)], axis=-1)
    return bw.Surface(
        control_points=net,
        weights=weights,
        knots_u=uniform_knots(4, 3),
        knots_v=uniform_knots(5, 3),
        degree_u=3,
        degree_v=3,
    )


def test_points_of_a_known_surface_give_it_back():
    weights = np.exp(0.2 * np.random.default_rng(2).normal(size=(4, 5)))
    surface = bent_surface(weights)
    points = surface(np.append(U, [0, 0, 1, 1]), np.append(V, [0, 1, 0, 1]))
    start = bw.Surface(
        control_points=surface.control_points + 0.01 * np.random.default_rng(3).normal(size=(4, 5, 3)),
        weights=weights, knots_u=surface.knots_u, knots_v=surface.knots_v, degree_u=3, degree_v=3,
    )  # fmt: skip
    fit = bw.fit_surface(points, start=start)
    # 1e-9 of the extent
    assert fit.maximum < 1.5e-9
    assert fit.converged


@pytest.mark.slow
def test_without_a_start_the_deviation_of_noisy_points_is_their_noise():
    noisy = HILL + 1e-3 * np.random.default_rng(1).normal(size=HILL.shape)
    fit = bw.fit_surface(noisy, control_points=(4, 4))
    # 200 points less some 20 directions that the surface follows
    assert fit.rms == pytest.approx(1e-3, rel=0.25)
    assert fit.noise == pytest.approx(1e-3, rel=0.2)
    again = bw.fit_surface(noisy, start=fit.surface, tolerance=5e-4)
    assert not again.passed
    assert "noise" in again.notes[0]


def test_a_tolerance_adds_knots_until_it_is_reached():
    wave = np.stack([1.3 * U, V, 0.1 * np.sin(7.0 * U)], axis=-1)[:120]
    coarse = bw.fit_surface(wave, control_points=(4, 4))
    assert bw.fit_surface(wave, start=coarse.surface).rms <= coarse.rms, "places are those of the start"
    fit = bw.fit_surface(wave, start=coarse.surface, tolerance=0.2 * coarse.maximum)
    assert fit.maximum <= 0.2 * coarse.maximum
    assert fit.surface.control_points.size > coarse.surface.control_points.size


def test_control_points_without_points_bend_as_little_as_they_can():
    away = (U < 0.45) | (U > 0.7)
    fit = bw.fit_surface(HILL[away], control_points=(8, 4))
    assert closest_on_surface(fit.surface, HILL[~away], tolerance=1e-3).distances.max() < 5e-3


def test_held_boundaries_do_not_move():
    surface = bent_surface()
    points = surface(U, V) + np.array([0.0, 0.0, 0.01])
    fixed = bw.fit_surface(points, start=surface, boundary="fixed").surface.control_points
    np.testing.assert_allclose(fixed[0], surface.control_points[0], atol=1e-14)
    np.testing.assert_allclose(fixed[:, -1], surface.control_points[:, -1], atol=1e-14)
    assert np.abs(fixed - surface.control_points).max() > 1e-3


@pytest.mark.parametrize("weighted", [False, True])
def test_the_gradient_is_that_of_central_differences(weighted):
    rng = np.random.default_rng(1)
    surface = bent_surface()
    logs = 0.2 * rng.normal(size=20) if weighted else np.zeros(20)
    net = replace(net_of(surface), log_weights=logs, weighted=weighted)
    points = net.shape(U[:60], V[:60]) + 0.02 * rng.normal(size=(60, 3))
    problem = Problem(placed(net, points), stiffness=1e-3)
    exact = problem.derivatives(problem.start)[0].T @ problem.values(problem.start)[0]
    step = 1e-6
    for e in rng.normal(size=(8, len(problem.start))):
        ahead, behind = (problem.values(problem.start + way * step * e)[0] for way in (1.0, -1.0))
        # rounding of a cost over the step
        assert (ahead @ ahead - behind @ behind) / (4 * step) == pytest.approx(exact @ e, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("points", "asked", "words"),
    [
        (HILL[:, :2], {}, "d = 3"),
        (np.where(HILL > 1.2, np.inf, HILL), {}, "not finite"),
        (np.linspace(0, 1, 50)[:, None] * np.ones(3), {}, "on a line"),
        (HILL[:20], {}, "take fewer control points"),
        (HILL, {"control_points": (3, 6)}, "at least 4"),
        (HILL, {"degrees": (3, 3, 3)}, "one for u and v"),
        (HILL, {"degrees": 3}, "one for u and v"),
        (HILL, {"degrees": (3, 2.5)}, "degree is 2.5: a whole number"),
        (HILL, {"knots": 3}, "one for u and v"),
        (HILL, {"start": 3}, "start is 3: a Surface"),
        (HILL + 1e-3j, {}, "an imaginary part is not zero"),
        (HILL, {"boundary": "loose"}, "'loose'"),
        (HILL, {"boundary": "fixed"}, "without `start`"),
        (HILL, {"weights": np.ones(3)}, "shape"),
        (HILL, {"power": 0}, "power"),
    ],
)
def test_what_cannot_be_fitted_is_refused_in_one_paragraph(points, asked, words):
    with pytest.raises(bw.BladewrightError, match=words) as caught:
        bw.fit_surface(points, **asked)
    assert type(caught.value).__name__ == "FitError"
    assert "\n" not in str(caught.value)
