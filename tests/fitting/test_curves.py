"""Curves fitted to points."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import bladewright as bw
from bladewright.fitting.freeform.net import net_of
from bladewright.fitting.freeform.search import Problem, matched, placed
from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.closest import closest_on_curve

X = np.linspace(0.0, 1.0, 81)
BENT = np.stack([X, 0.3 * np.sin(3.0 * X) + 0.1 * X**2], axis=-1)
EXACT = 1e-9
"""of the extent: what fits of exact points must reach"""


def random_curve(seed, dimension, *, weighted):
    rng = np.random.default_rng(seed)
    net = np.concatenate([np.linspace(0.0, 1.0, 6)[:, None], 0.25 * rng.normal(size=(6, dimension - 1))], axis=1)
    weights = np.exp(0.4 * rng.normal(size=6)) if weighted else None
    return bw.Curve(control_points=net, weights=weights, knots=uniform_knots(6, 3), degree=3), rng


@pytest.mark.parametrize(
    ("seed", "dimension", "weights"), [(1, 2, "given"), (2, 3, "given"), (8, 2, "free"), (9, 3, "free"), (4, 5, "none")]
)
def test_points_of_a_known_curve_give_it_back(seed, dimension, weights):
    curve, rng = random_curve(seed, dimension, weighted=weights != "none")
    points = curve(np.concatenate([[0.0, 1.0], rng.random(150)]))
    points = points[np.argsort(points[:, 0])]
    asked = {"given": curve.weights, "free": "free", "none": "fixed"}[weights]
    fit = bw.fit_curve(points, weights=asked)
    assert fit.converged
    assert fit.rank == fit.unknowns
    assert fit.maximum < EXACT
    assert closest_on_curve(fit.curve, curve(np.linspace(0.0, 1.0, 200))).distances.max() < EXACT


def test_the_example_of_the_source_ends_at_its_end_points_and_stays_within_2e_4_of_its_length():
    fit = bw.fit_curve(BENT, power=4)
    assert np.array_equal(fit.curve.knots, [0, 0, 0, 0, 1 / 3, 2 / 3, 1, 1, 1, 1])
    np.testing.assert_allclose(fit.curve.control_points[[0, -1]], BENT[[0, -1]], atol=1e-15)
    assert fit.converged
    # the source states 0.2 mm for a curve of its own; that of this one is its approximation error
    assert fit.maximum < 2e-4
    assert fit.maximum < bw.fit_curve(BENT).maximum


@pytest.mark.parametrize("power", [2.0, pytest.param(4.0, marks=pytest.mark.slow)])
def test_finite_differences_as_in_the_source_find_nothing_lower(power):
    fit = bw.fit_curve(BENT[::4], power=power)

    def objective(inner):
        net = fit.curve.control_points.copy()
        net[1:-1] = inner.reshape(-1, 2)
        places = bw.Curve(control_points=net, knots=fit.curve.knots, degree=3)(np.linspace(0.0, 1.0, 801))
        step = np.diff(places, axis=0)
        away = BENT[::4, None] - places[:-1]
        share = np.clip(np.sum(away * step, axis=-1) / np.sum(step**2, axis=-1), 0.0, 1.0)
        distances = np.sqrt(np.min(np.sum((away - share[..., None] * step) ** 2, axis=-1), axis=1))
        # a unit of 1e-4 makes its fourth powers visible to the solver's absolute tolerance
        return np.mean((distances / 1e-4) ** power)

    start = fit.curve.control_points[1:-1].ravel()
    other = minimize(objective, start, method="SLSQP", options={"maxiter": 30, "ftol": 1e-12})
    # 2 % of a value is what the fit calls settled
    assert other.fun > 0.98 * objective(start)


def test_with_more_knots_the_distance_falls_by_the_order_of_the_degree_or_more():
    spans = np.array([4, 8, 16])
    maxima = [bw.fit_curve(BENT, control_points=int(count) + 2, degree=2).rms for count in spans]
    order = -np.polyfit(np.log(spans), np.log(maxima), 1)[0]
    # degree + 1 in general; free parameters let a plane curve do better (geometric Hermite interpolation)
    assert 2.7 < order < 4.5


@pytest.mark.parametrize("ends", ["free", "fixed"])
def test_the_deviation_of_noisy_points_in_any_order_is_their_noise(ends):
    rng = np.random.default_rng(3)
    points = rng.permutation(np.repeat(BENT, 4, axis=0)) + 1e-3 * rng.normal(size=(4 * len(BENT), 2))
    fit = bw.fit_curve(points, ends=ends)
    # one standard error of a deviation from 324 samples is 4 %
    assert fit.rms == pytest.approx(1e-3, rel=0.12)
    assert fit.noise == pytest.approx(1e-3, rel=0.2)
    assert closest_on_curve(fit.curve, BENT).distances.mean() < 5e-4


def test_a_tolerance_is_reached_with_no_more_knots_than_the_last_round_needs():
    fit = bw.fit_curve(BENT, tolerance=1e-5)
    assert fit.passed
    assert fit.maximum <= 1e-5
    assert len(fit.curve.control_points) <= 12
    assert len(bw.fit_curve(BENT, tolerance=1e-3).curve.control_points) == 6


def test_noise_above_the_tolerance_is_said_to_stop_it():
    rng = np.random.default_rng(3)
    fit = bw.fit_curve(BENT + 1e-3 * rng.normal(size=BENT.shape), tolerance=1e-4, ends="free")
    assert not fit.passed
    assert "noise" in fit.notes[0]
    assert len(fit.curve.control_points) < 12


def test_outliers_are_told_apart():
    rng = np.random.default_rng(5)
    points = np.repeat(BENT, 3, axis=0) + 1e-4 * rng.normal(size=(3 * len(BENT), 2))
    wrong = rng.choice(len(points), 12, replace=False)
    points[wrong, 1] += 0.02 + 0.1 * rng.random(12)
    fit = bw.fit_curve(points, robust=True, ends="free", start=bw.fit_curve(BENT).curve)
    assert not fit.inliers[wrong].any()
    assert (~fit.inliers).sum() <= 14
    assert fit.rms < 2e-4


def test_a_closed_curve_meets_itself_with_all_derivatives_below_its_degree():
    angle = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
    points = np.stack([np.cos(angle), 0.5 * np.sin(angle)], axis=-1)
    fit = bw.fit_curve(np.random.default_rng(0).permutation(points), closed=True, control_points=12)
    start, end = (fit.curve.derivatives(np.array([at]), 2) for at in fit.curve.domain)
    for first, last in zip(start, end, strict=True):
        np.testing.assert_allclose(first, last, rtol=1e-10, atol=1e-10)
    # the approximation error of 12 cubic spans on this ellipse
    assert fit.maximum < 2e-4


def test_a_gap_of_points_is_named_and_bridged_by_the_least_bending():
    gap = BENT[(X < 0.35) | (X > 0.6)]
    fit = bw.fit_curve(gap, control_points=20)
    assert fit.rank < fit.unknowns or fit.condition > 1e3
    assert closest_on_curve(fit.curve, BENT).distances.max() < 5e-3


def test_points_far_away_and_in_another_unit_are_fitted_alike():
    plain = bw.fit_curve(BENT)
    other = bw.fit_curve(100.0 + 1e3 * BENT)
    # the same digits but for the rounding of the moved points, on which descents end; the least squares are flat there
    assert other.rms == pytest.approx(1e3 * plain.rms, rel=1e-5)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("power", [2.0, 4.0])
def test_the_gradient_is_that_of_central_differences(weighted, closed, power):
    rng = np.random.default_rng(1)
    angle = np.arange(6) / 6 * 2 * np.pi
    count = 9 if closed else 6
    pattern = bw.Curve(control_points=np.zeros((count, 3)), knots=uniform_knots(count, 3), degree=3)
    net = replace(
        net_of(pattern, closed=closed),
        points=np.stack([np.cos(angle), np.sin(angle), 0.3 * rng.normal(size=6)], axis=-1),
        log_weights=0.2 * rng.normal(size=6) if weighted else np.zeros(6),
        weighted=weighted,
        boundary="free" if closed else "corners",
    )
    points = net.shape(rng.random(40)) + 0.02 * rng.normal(size=(40, 3))
    match = replace(placed(net, points), weights=rng.random(40), power=power, scale=0.05)
    problem = Problem(match, stiffness=1e-3)
    residuals, slopes = problem.values(problem.start)[0], problem.derivatives(problem.start)[0]
    step = 1e-6

    def cost(z):
        return np.sum(problem.values(z)[0] ** 2)

    found = [
        (cost(problem.start + step * e) - cost(problem.start - step * e)) / (4 * step)
        for e in np.eye(len(problem.start))
    ]
    exact = slopes.T @ residuals
    # rounding of a cost over the step
    np.testing.assert_allclose(found, exact, atol=1e-7 * np.abs(exact).max() + 1e-9 * residuals @ residuals)


def test_without_unknowns_a_match_is_a_projection():
    line = bw.Curve(control_points=[[0.0, 0.0], [3.0, 3.0]], knots=[0.0, 0.0, 1.0, 1.0], degree=1)
    net = replace(net_of(line), boundary="fixed")
    assert not net.free.any()
    found = matched(placed(net, np.array([[0.5, 0.6], [1.0, 1.5], [2.0, 2.2]])), 0.0)
    assert found.converged
    assert found.distances.max() < 0.5


NAN = np.where(np.arange(81)[:, None] == 7, np.nan, BENT)


@pytest.mark.parametrize(
    ("points", "asked", "words"),
    [
        (NAN, {}, "row 7"),
        ([["a", "b"]], {}, "not numbers"),
        (BENT[:, 0], {}, "shape"),
        (np.ones((9, 2)), {}, "one place"),
        (BENT[:5], {}, "take fewer control points"),
        (BENT, {"control_points": 3}, "at least 4"),
        (BENT, {"degree": 0}, "at least 1"),
        (BENT, {"knots": [0, 0, 0, 0, 2, 1, 3, 3, 3, 3]}, "non-decreasing"),
        (BENT, {"knots": [0, 0.5, 0.5, 0.7, 1.0], "closed": True}, "distinct"),
        (BENT, {"weights": "some"}, "'some'"),
        (BENT, {"weights": [1, 2]}, "shape"),
        (BENT, {"ends": "loose"}, "'loose'"),
        (BENT, {"ends": ([0, 0, 0], [1, 1, 1])}, "2 coordinates"),
        (BENT, {"power": 1}, "power"),
        (BENT, {"power": "2"}, "power '2'"),
        (BENT, {"tolerance": -1.0}, "positive"),
        (BENT, {"tolerance": "1"}, "tolerance is '1'"),
        (BENT, {"degree": 2.5}, "degree is 2.5: a whole number"),
        (BENT, {"control_points": True}, "control_points is True: a whole number"),
        (BENT, {"knots": ["a", "b"]}, "knots are not numbers"),
        (BENT, {"knots": 3}, "control points"),
        (BENT, {"weights": ["a", "b"]}, "weights are not numbers"),
        (BENT, {"start": 3}, "start is 3: a Curve"),
        (BENT, {"progress": 3}, "progress is 3"),
        (BENT, {"closed": True, "ends": "free"}, "closed and ends are both given"),
        (BENT, {"closed": True, "ends": BENT[[0, -1]]}, "closed and ends are both given"),
        (BENT + 1e-3j, {}, "an imaginary part is not zero"),
    ],
)  # fmt: skip
def test_what_cannot_be_fitted_is_refused_in_one_paragraph(points, asked, words):
    with pytest.raises(bw.BladewrightError, match=words) as caught:
        bw.fit_curve(points, **asked)
    assert type(caught.value).__name__ == "FitError"
    assert "\n" not in str(caught.value)
