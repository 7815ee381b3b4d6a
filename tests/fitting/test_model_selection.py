"""How many control points: narrower laws as linear subspaces, predictions of their matches, and what is chosen."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from bladewright.errors import FitError
from bladewright.fitting.assessment.acceptance import MatchTarget
from bladewright.fitting.free_parameters import corner_radii, free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection import selection
from bladewright.fitting.model_selection.elimination import LinearModel, best_of_size, eliminated, reweighted
from bladewright.fitting.model_selection.selection import RichMatch, selected_match
from bladewright.fitting.model_selection.structure import (
    reshaped,
    resizable_laws,
    rich_structure,
    structure_of,
    wider_structure,
)
from bladewright.fitting.model_selection.structure_search import StructureSearch
from bladewright.section.unified_limits import THICKNESSES
from machines import example
from machines.stations import AXIAL

BASE = example("turbine-section")
MADE = replace(
    BASE, thickness_upper=(0.05, 0.13, 0.21, 0.16, 0.12, 0.05, 0.03), thickness_lower=(0.04, 0.07, 0.11, 0.05, 0.02)
)
STATOR = example("compressor-stator")
FREE = free_parameters_of(None, None, started=True)


@cache
def task(noise=0.0):
    """Points of the made section."""
    curves, random = MADE.build().curves, np.random.default_rng(4)
    points = np.concatenate([curves[side](random.random(90)) for side in ("upper", "lower")])
    points += noise * random.normal(size=points.shape)
    return Task(points=points, weights=np.ones(180), free=FREE, bounds={})


@cache
def model(noise=1e-4):
    start = reshaped(MADE, structure_of(MADE).resized("thickness_upper", (9, 1)).resized("thickness_lower", (8, 1)))
    return LinearModel(searched(task(noise), start, rounds=2), 16)


@pytest.mark.parametrize("design", [MADE, STATOR], ids=lambda design: design.name)
def test_control_points_of_a_wider_law_are_the_embedding_of_those_of_a_narrower_one(design):
    wide = reshaped(design, wider_structure(design, design.parameters(), 10_000))
    for law in resizable_laws(wide):
        counts = structure_of(design).counts[law.name]
        narrow = structure_of(wide).resized(law.name, counts)
        few, many = reshaped(wide, narrow), reshaped(reshaped(wide, narrow), structure_of(wide))
        few_values, many_values = ([each.parameters()[path] for path in law.paths(each)] for each in (few, many))
        embedded = law.embedding(law.counts_of(wide), counts) @ np.array(few_values)
        assert embedded == pytest.approx(np.array(many_values), rel=1e-9, abs=1e-9), law.name


@pytest.mark.parametrize("samples", [8, 16, 40])
def test_a_sampled_structure_needs_no_further_samples_and_loses_no_control_points(samples):
    design = replace(MADE, samples=samples)
    own = structure_of(design)
    found = rich_structure(design, design.parameters(), 10_000, sampled=True)
    few, many = ([each.counts[name][0] for name in THICKNESSES] for each in (own, found))
    assert found.samples <= max(samples, max(few) + 4)
    assert np.all(np.array(few) <= many)
    assert max(many) <= rich_structure(design, design.parameters(), 10_000).counts["thickness_upper"][0]


def test_a_law_at_stations_keeps_them():
    design = AXIAL["unified"]
    names = {law.name for law in resizable_laws(design)}
    assert structure_of(design).stations
    assert not names & set(structure_of(design).stations)
    structure = rich_structure(design, design.parameters(), 1000)
    assert structure.stations == structure_of(design).stations
    rich = reshaped(design, structure)
    assert rich.metal_angle_out.span == design.metal_angle_out.span


def test_a_prediction_is_the_least_squares_of_the_linear_problem():
    linear = model()
    counts = [(5, 1), (6, 1)]
    found = linear.prediction(counts)
    subspace, shift = linear.subspace(counts)
    problem = linear.match.problem
    ridge = np.sqrt(linear.ridge) * np.eye(linear.slopes.shape[1])
    columns = np.concatenate([linear.slopes, problem.regularisation.matrix, ridge])
    rows = [linear.residuals, problem.regularisation.residuals(problem.vector(linear.design)), np.zeros(len(ridge))]
    step, rest, *_ = np.linalg.lstsq(columns @ subspace, -(np.concatenate(rows) + columns @ shift), rcond=None)
    assert found.cost == pytest.approx(float(rest[0]), rel=1e-6)
    assert found.parameters == len(step) == linear.slopes.shape[1] - 6
    designed = linear.designed(found)
    assert structure_of(designed).counts == {"thickness_upper": (5, 1), "thickness_lower": (6, 1)}
    # a narrower structure leaves no less
    assert linear.prediction(linear.counts).cost <= found.cost


def test_the_loss_of_a_nested_law_is_the_rise_of_the_least_squares():
    # laws of four control points hold those of three
    linear = model()
    now = linear.prediction([(4, 1), (6, 1)])
    fewer = linear.prediction([(3, 1), (6, 1)])
    losses = {(law, counts): loss * number for loss, number, law, counts in linear.losses(now)}
    assert losses[0, (3, 1)] == pytest.approx(fewer.cost - now.cost, rel=1e-3)


def test_structures_lose_parameters_step_by_step_and_the_best_of_a_size_comes_first():
    linear = model()
    found = eliminated(linear, 16)
    sizes = [each.parameters for each in found]
    assert sizes == sorted(set(sizes), reverse=True)
    assert sizes[0] == linear.slopes.shape[1]
    assert sizes[-1] <= 16
    best = best_of_size(linear, 20)
    assert all(each.parameters <= 20 for each in best)
    assert best[0].cost <= min(each.cost for each in eliminated(linear, 20) if each.parameters <= 20)


def test_weights_rise_with_distances_and_keep_their_sum():
    weights = reweighted(np.array([1.0, 1.0, 1.0, 0.0]), np.array([0.1, 1.0, 2.0, 9.0]), 1.0)
    assert weights[0] < weights[1] < weights[2]
    assert weights[3] == 0.0
    assert np.sum(weights) == pytest.approx(3.0)


def test_the_fewest_control_points_that_keep_a_tolerance_are_fewer_where_it_is_wide():
    counts = []
    for tolerance in (4e-3, 1e-3):
        chord = float(MADE.build().chord)
        found, reason = selected_match(task(), BASE, MatchTarget(tolerance=tolerance * chord), like=None, guessed=False)
        assert not reason
        assert found.maximum <= tolerance * chord
        counts.append(len(found.problem.paths))
    assert counts[0] < counts[1]


def test_noise_is_not_followed_where_nothing_is_asked():
    noise = 1e-3 * float(MADE.build().chord)
    found, _ = selected_match(task(noise), BASE, MatchTarget(), like=None, guessed=False)
    # a rich structure has 58
    assert len(found.problem.paths) < 40
    assert found.rms * found.model.chord < 1.2 * noise


def test_no_point_that_a_rich_match_meets_is_an_outlier_of_narrower_ones(monkeypatch):
    seen = []

    def within(search, rich, _):
        seen.append((search.task.trusted, rich.rows))
        return rich, ""

    monkeypatch.setattr(StructureSearch, "within", within)
    selected_match(task(), BASE, MatchTarget(tolerance=1e-5), like=None, guessed=False)
    trusted, rows = seen[0]
    assert np.array_equal(trusted, rows)


def test_a_widened_match_comes_nearer_by_a_round():
    narrow = structure_of(MADE)
    for name in THICKNESSES:
        narrow = narrow.resized(name, (3, 1))
    found = searched(task(), reshaped(MADE, narrow), rounds=2)
    search = StructureSearch(task=task(), samples=0, first=found.design)
    plain, after = (search._widened(found, rounds) for rounds in (0, 1))
    assert structure_of(plain.design) == structure_of(after.design) != narrow
    assert after.misfit < 0.5 * min(plain.misfit, found.misfit)


def test_few_points_have_a_structure_of_few_control_points():
    sizes = [
        len(reshaped(BASE, rich_structure(BASE, BASE.parameters(), points)).parameters()) for points in (30, 60, 1000)
    ]
    assert sizes[0] == len(BASE.parameters())
    assert sizes[0] < sizes[1] <= 30 < sizes[2]


def test_the_radii_of_the_corners_are_those_of_both_edges_at_both_walls():
    last = len(STATOR.channel.leading_edge) - 1
    assert len(corner_radii(STATOR)) == 4
    assert {"channel.leading_edge[0].r", f"channel.leading_edge[{last}].r"} < set(corner_radii(STATOR))
    assert set(corner_radii(STATOR)) < set(STATOR.parameters())
    assert corner_radii(BASE) == ()


def test_where_points_that_were_not_drawn_exceed_a_tolerance_a_nearer_structure_is_sought(monkeypatch):
    """A fan of 8,000 points had 45 parameters, which kept 0.05 mm at 4,000 of them and 0.07 at all; 51 keep it."""
    asked = list[float]()

    def within(_, tolerance):
        asked.append(tolerance)
        return tolerance, ""

    few, many = task(), replace(task(), points=np.zeros((10_000, 2)))
    search = SimpleNamespace(task=few, within=within)
    begun = RichMatch(match=None, first=None, search=search, many=many, note="")
    # of all points the largest is a half further off
    monkeypatch.setattr(selection, "_reweighted_further", lambda _, limit, __: SimpleNamespace(maximum=1.5 * limit))
    found, reason = selection.reduced_match(begun, MatchTarget(tolerance=3e-5))
    assert asked == pytest.approx([3e-5, 2e-5])
    assert found.maximum == pytest.approx(3e-5)
    assert reason == ""


@pytest.mark.parametrize("target", [MatchTarget(), MatchTarget(tolerance=1e-5)], ids=["open", "tolerance"])
def test_a_match_without_a_shape_at_the_knots_of_more_points_is_not_refused(target, monkeypatch):
    def without_a_shape(*_args, **_names):
        raise FitError("the start design has no shape")

    def searched_few(task, *given, **named):
        return without_a_shape() if len(task.points) > 90 else searched(task, *given, **named)

    monkeypatch.setattr(selection, "evaluated", without_a_shape)
    monkeypatch.setattr(selection, "searched", searched_few)
    monkeypatch.setattr(selection, "SEVERAL_POINTS", 90)
    found, _ = selected_match(task(), BASE, target, like=None, guessed=False)
    assert found.maximum < 1e-5
