"""Profiles fitted by camber and half thickness."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import bladewright as bw
from bladewright.fitting.freeform.net import net_of
from bladewright.fitting.freeform.profile import CamberThickness, abscissae_of
from bladewright.fitting.freeform.search import Problem, placed
from bladewright.nurbs.basis import uniform_knots

KNOTS = uniform_knots(6, 3)
CAMBER = np.stack([np.linspace(0.0, 1.0, 6), [0.0, 0.12, 0.2, 0.22, 0.15, 0.05]], axis=-1)


def profile(*, round_end):
    heights = [0.0, 0.03, 0.06, 0.07, 0.05, 0.0 if round_end else 0.01]
    thickness = bw.Curve(
        control_points=np.stack([abscissae_of(6, 0.0, 1.0, round_end=round_end), heights], axis=-1),
        knots=KNOTS,
        degree=3,
        weights=np.array([1.0, 1.1, 0.9, 1.2, 1.0, 0.9]),
    )
    return CamberThickness(
        camber=net_of(bw.Curve(control_points=CAMBER, knots=KNOTS, degree=3)),
        thickness=replace(net_of(thickness), weighted=True),
        round_end=round_end,
    )


def contour(of, count=70):
    t = np.linspace(0.0, 1.0, count) ** 2
    upper = np.repeat([True, False], count)
    return np.concatenate([of(t), of(np.minimum(-t, -1e-300))]), upper


@pytest.mark.parametrize("trailing_edge", ["blunt", "round"])
def test_a_known_profile_is_found_again_with_its_sides(trailing_edge):
    points, upper = contour(profile(round_end=trailing_edge == "round"))
    order = np.random.default_rng(0).permutation(len(points))
    fit = bw.fit_profile(points[order], trailing_edge=trailing_edge, ends=CAMBER[[0, -1]])
    assert fit.mean < 1e-4
    off_camber = np.min(np.sum((points[order][:, None] - points[None, [0, 69, 139]]) ** 2, axis=-1), axis=1) > 1e-3
    assert (fit.upper == upper[order])[off_camber].all()
    np.testing.assert_allclose(fit.camber.control_points[[0, -1]], CAMBER[[0, -1]], atol=1e-12)
    # the sides are reached at the parameters that are handed back
    rows = fit.upper
    reached = fit.side(fit.t[rows], upper=True)
    np.testing.assert_allclose(
        np.sqrt(np.sum((reached - points[order][rows]) ** 2, axis=-1)), fit.distances[rows], atol=1e-9
    )


def test_abscissae_stand_where_the_source_puts_them():
    points, _ = contour(profile(round_end=False))
    fit = bw.fit_profile(points, power=4, ends=CAMBER[[0, -1]])
    low, high = fit.camber.control_points[[0, -1], 0]
    share = (fit.thickness.control_points[:, 0] - low) / (high - low)
    np.testing.assert_allclose(share, [0.0, 0.0, 0.0625, 0.375, 0.6875, 1.0], atol=1e-12)
    assert fit.thickness.control_points[0, 1] == 0.0
    assert fit.maximum < 1e-3


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("round_end", [False, True])
def test_the_gradient_is_that_of_central_differences(fixed, round_end):
    of = profile(round_end=round_end)
    points, _ = contour(of, 30)
    points = points + 0.003 * np.random.default_rng(0).normal(size=points.shape)
    of = replace(of, camber=replace(of.camber, boundary="corners" if fixed else "free"))
    problem = Problem(placed(of, points), stiffness=1e-3)
    exact = problem.derivatives(problem.start)[0].T @ problem.values(problem.start)[0]
    step = 1e-6
    for k, e in enumerate(np.eye(len(exact))):
        ahead, behind = (problem.values(problem.start + way * step * e)[0] for way in (1.0, -1.0))
        # rounding of a cost over the step
        assert (ahead @ ahead - behind @ behind) / (4 * step) == pytest.approx(exact[k], rel=1e-6, abs=1e-8)


def test_the_leading_edge_is_round():
    of, step = profile(round_end=False), 1e-4
    ends = [of(sign * step * np.arange(1e-9, 4)) for sign in (1.0, -1.0)]
    # one side goes on as the other, along the camber's normal and with one curvature
    first = [(4.0 * end[1] - 3.0 * end[0] - end[2]) / (2.0 * step) for end in ends]
    second = [(2.0 * end[0] - 5.0 * end[1] + 4.0 * end[2] - end[3]) / step**2 for end in ends]
    bend = [float(d[0] * dd[1] - d[1] * dd[0]) / np.sum(d**2) ** 1.5 for d, dd in zip(first, second, strict=True)]
    assert bend[0] == pytest.approx(-bend[1], rel=1e-3)
    np.testing.assert_allclose(
        *(d / np.sqrt(np.sum(d**2)) * sign for d, sign in zip(first, (1.0, -1.0), strict=True)), atol=1e-6
    )


@cache
def plain():
    return bw.fit_profile(contour(profile(round_end=False), 30)[0], thickness=5, ends=CAMBER[[0, -1]], tolerance=1.0)


@pytest.mark.slow
def test_control_points_are_added_until_the_tolerance_is_kept():
    points = contour(profile(round_end=False), 30)[0]
    before, grown = (
        bw.fit_profile(points, camber=5, thickness=5, ends=CAMBER[[0, -1]], tolerance=tolerance)
        for tolerance in (1.0, 2e-4)
    )
    assert before.maximum > 2e-4 >= grown.maximum
    assert grown.passed
    counts = [len(of.camber.control_points) + len(of.thickness.control_points) for of in (before, grown)]
    assert counts[0] == 10 < counts[1]


def test_growth_ends_at_the_noise():
    points = contour(profile(round_end=False), 30)[0]
    noisy = points + 2e-3 * np.random.default_rng(2).normal(size=points.shape)
    found = bw.fit_profile(noisy, camber=4, thickness=5, ends=CAMBER[[0, -1]], tolerance=5e-4)
    assert not found.passed
    assert "noise" in found.notes[-1]


def test_a_tolerance_that_is_kept_adds_nothing():
    assert plain().passed
    assert len(plain().thickness.control_points) == 5
    assert plain().notes == ()


@pytest.mark.parametrize(
    ("points", "asked", "words"),
    [
        (np.ones((40, 3)), {}, "d = 2"),
        (np.linspace(0, 1, 60)[:, None] * np.ones(2), {}, "line"),
        (CAMBER, {}, "unknowns"),
        (CAMBER + 1e-3j, {}, "an imaginary part is not zero"),
        (contour(profile(round_end=True))[0], {"camber": 4.5}, "camber is 4.5: a whole number"),
        (contour(profile(round_end=True))[0], {"thickness": 4}, "at least 4 and 5"),
        (contour(profile(round_end=True))[0], {"trailing_edge": "sharp"}, "'sharp'"),
        (contour(profile(round_end=True))[0], {"ends": "loose"}, "'loose'"),
    ],
)
def test_what_cannot_be_fitted_is_refused_in_one_paragraph(points, asked, words):
    with pytest.raises(bw.BladewrightError, match=words) as caught:
        bw.fit_profile(points, **asked)
    assert type(caught.value).__name__ == "FitError"
    assert "\n" not in str(caught.value)
