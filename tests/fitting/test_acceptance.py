"""What is called a failure, by what was asked."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.fitting.assessment.acceptance import Acceptance, MatchTarget
from bladewright.fitting.assessment.measurement import measured, parameter_estimates
from bladewright.fitting.free_parameters import free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from machines import COARSE, example
from machines import built as builds

STATOR = example("aachen-stator").changed("tolerance", COARSE)


def matched(points, design, free="stagger"):
    """A design as it stands, before a search."""
    chosen = free_parameters_of(free, None, started=True)
    return searched(Task(points=points, weights=np.ones(len(points)), free=chosen, bounds={}), design, rounds=0)


def said_of(points, design, target, free="stagger"):
    """Why a design as it stands does not pass for points."""
    found = matched(points, design, free)
    return tuple(accepted(found, measured(points, builds(design)), target).failures())


def accepted(found, measurement, target):
    return Acceptance(match=found, measurement=measurement, statistics=parameter_estimates(found), target=target)


@pytest.mark.parametrize(
    ("miss", "said"), [(4e-4, ()), (1.2e-3, ("not found",)), (1.2e-2, ("mean", "largest", "not found"))]
)
@pytest.mark.parametrize("target", [MatchTarget(), MatchTarget(structured=True)])
def test_a_match_is_trusted_where_it_is_nearer_than_half_a_thousandth_of_the_chord_everywhere(miss, said, target):
    built = builds(STATOR)
    u, v = (
        each.ravel() for each in np.meshgrid((1.0 - np.cos(np.pi * np.linspace(0, 1, 40))) / 2, np.linspace(0, 1, 9))
    )
    points = np.concatenate([np.real(side(u, v)) for side in built.sides])
    points[:, 1] += miss * built.chord * (points[:, 0] - points[:, 0].min()) / np.ptp(points[:, 0])
    found = said_of(points, STATOR, target)
    assert len(found) == len(said)
    assert all(word in each for word, each in zip(said, found, strict=True))


@pytest.mark.parametrize(("noise", "passed"), [(0.0, False), (4e-4, True)])
def test_deviations_that_are_the_clouds_own_noise_do_not_make_a_match_coarse(noise, passed):
    built, random = builds(STATOR), np.random.default_rng(8)
    points = np.concatenate([np.real(side(*random.random((2, 400)))) for side in built.sides])
    points[:, 1] += 0.0 if noise else 1.0e-3 * built.chord * np.sin(8.0 * points[:, 0] / built.chord)
    points += noise * built.chord * random.normal(size=points.shape)
    found = said_of(points, STATOR, MatchTarget(structured=True))
    assert any("not found" in each for each in found) is not passed


@pytest.mark.parametrize(("together", "off", "said"), [(True, 1e-3, True), (True, 4e-4, False), (False, 1e-3, False)])
def test_outliers_beside_each_other_are_a_shape_that_is_not_found_unless_they_are_near(together, off, said):
    built, draw = builds(STATOR), np.random.default_rng(8)
    u, v = draw.random((2, 1000))
    points = np.concatenate([np.real(side(u, v)) for side in built.sides])
    found, measurement = matched(points, STATOR), measured(points, built)
    number = int(0.08 * len(points))
    left_out = np.argsort(np.concatenate([u, 2.0 + u]))[:number] if together else draw.permutation(len(points))[:number]
    inliers = np.ones(len(points), dtype=bool)
    inliers[left_out] = False
    deviations = np.where(inliers, measurement.deviations, off * built.chord)
    measurement = replace(measurement, inliers=inliers, deviations=deviations)
    failures = accepted(found, measurement, MatchTarget(structured=True)).failures()
    assert any("beside each other" in each for each in failures) is said


@pytest.mark.parametrize("inside", [True, False])
def test_outliers_that_all_lie_inside_the_blade_are_a_shape_that_is_not_found(inside):
    built, draw = builds(STATOR), np.random.default_rng(8)
    places = draw.random((2, 2, 800))
    points = np.concatenate([np.real(side(*place)) for side, place in zip(built.sides, places, strict=True)])
    at, normals = (getattr(measured(points, built).footpoints, name) for name in ("points", "normals"))
    moved = np.flatnonzero(np.abs(places[:, 0].ravel() - 0.5) < 0.3)[::30]
    ways = -np.ones(len(moved)) if inside else draw.choice([-1.0, 1.0], len(moved))
    points[moved] = at[moved] + 0.01 * built.chord * ways[:, None] * normals[moved]
    said = said_of(points, STATOR, MatchTarget())
    assert any("inside the blade" in each for each in said) is inside


def test_points_of_a_solid_on_its_end_faces_are_set_aside():
    built = builds(STATOR)
    random = np.random.default_rng(4)
    u, v, across = random.random((3, 600))
    sides = np.concatenate([np.real(side(u, v)) for side in built.sides])
    upper, lower = (np.real(side(0.1 + 0.8 * u[:200], np.round(v[:200]))) for side in built.sides)
    face = upper + across[:200, None] * (lower - upper)
    stray = np.mean(sides, axis=0) + 0.5 * np.ptp(sides, axis=0)
    points = np.concatenate([sides, face, stray[None]])
    at = measured(points, built)
    allow_outliers = ~at.inliers[len(sides) : -1]
    # those beside the outline are as near to the sides, on which an exact cloud has them
    on_faces = at.set_aside != ""
    assert np.mean(on_faces[len(sides) : -1][allow_outliers]) > 0.95
    assert not np.any(on_faces[: len(sides)])
    assert not on_faces[-1]
    assert set(at.regions[on_faces]) == {"ends"}
    assert set(at.places[on_faces]) == set(at.set_aside[on_faces]) == set(STATOR.ends)
    found = matched(points, STATOR)
    said = [
        " ".join(accepted(found, each, MatchTarget(structured=True)).failures())
        for each in (replace(at, set_aside=np.full(len(points), "")), at)
    ]
    assert "lie off the blade" in said[0]
    assert "lie off the blade" not in said[1]


@pytest.mark.parametrize(("noise", "failure"), [(0.0, False), (3e-4, True)])
def test_an_end_that_no_row_of_points_shows_is_a_note_where_the_sides_are_met_everywhere(noise, failure):
    built, draw = builds(STATOR), np.random.default_rng(8)
    points = np.concatenate([np.real(side(*draw.random((2, 150)))) for side in built.sides])
    points += noise * built.chord * draw.normal(size=points.shape)
    found = matched(points, STATOR, free="channel.leading_edge[*].r")
    verdict = accepted(found, measured(points, built), MatchTarget())
    words = "where the blade ends"
    assert any(words in each for each in verdict.failures()) is failure
    assert any(words in each for each in verdict.notes()) is not failure


@pytest.mark.parametrize(("share", "sheet"), [(1.0, False), (0.012, True)])
def test_a_blade_that_is_laid_through_one_side_is_called_a_sheet(share, sheet):
    powers = {"thickness_upper": 1, "thickness_lower": 1, "leading_edge_radius": 2, "trailing_edge_radius": 2}
    values = {path: (value, powers.get(path.partition("[")[0], 0)) for path, value in STATOR.parameters().items()}
    blade = STATOR.changed({path: value * share**power for path, (value, power) in values.items() if power})
    built = blade.build()
    u, v = np.random.default_rng(5).random((2, 300))
    points = np.concatenate([np.real(side(u, v)) for side in built.sides])
    said = said_of(points, blade, MatchTarget(structured=True))
    assert any("the blade is a sheet" in each for each in said) == sheet


@pytest.mark.parametrize(("count", "few"), [(10, True), (400, False)])
def test_a_blade_of_which_nothing_is_asked_has_no_more_parameters_than_its_points_determine(count, few):
    built, random = builds(STATOR), np.random.default_rng(6)
    points = np.concatenate([np.real(side(*random.random((2, count)))) for side in built.sides])
    said = [" ".join(said_of(points, STATOR, aim, free=None)) for aim in (MatchTarget(), MatchTarget(parameters=30))]
    assert ("the points determine" in said[0]) == few
    assert "the points determine" not in said[1]


@pytest.mark.parametrize(("gap", "free", "said"), [(0.0, None, False), (0.5, None, True), (0.5, "stagger", False)])
def test_a_side_is_shown_by_points_or_by_parameters_that_are_held(gap, free, said):
    design, draw = example("turbine-section"), np.random.default_rng(3)
    built = design.build()
    u = (1.0 - np.cos(np.pi * draw.random((2, 60)))) / 2.0
    u = u[0][np.abs(u[0] - 0.45) >= gap / 2.0], u[1]
    points = np.concatenate([np.real(built.curves[side](at)) for side, at in zip(("upper", "lower"), u, strict=True)])
    points += 5e-4 * built.chord * draw.normal(size=points.shape)
    found = said_of(points, design, MatchTarget(), free)
    assert any(each.startswith("the points do not show the upper side at u = 0.") for each in found) is said


@pytest.mark.parametrize(("low", "high", "said"), [(0.02, 0.06, "at the leading edge"), (0.3, 0.7, "inside the blade")])
def test_outliers_inside_are_said_once_and_where_they_crowd(low, high, said):
    built, draw = builds(STATOR), np.random.default_rng(8)
    points = [np.real(side(*draw.random((2, 1500)))) for side in built.sides]
    for side, other in zip(built.sides, built.sides[::-1], strict=True):
        u, v = draw.uniform(low, high, 12), np.linspace(0.1, 0.9, 12)
        on, opposite = np.real(side(u, v)), np.real(other(u, v))
        inward = (opposite - on) / np.linalg.norm(opposite - on, axis=-1)[:, None]
        points.append(on + 5e-3 * built.chord * inward)
    found = [each for each in said_of(np.concatenate(points), STATOR, MatchTarget()) if " outliers lie " in each]
    assert len(found) == 1
    assert said in found[0]
