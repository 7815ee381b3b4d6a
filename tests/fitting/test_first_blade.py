"""First blades from points in space."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.native.blade import Blade
from bladewright.domain.row import turn_matrix
from bladewright.errors import FitError
from bladewright.fitting.families.kinds import DesignHeader
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.initial_guess.blade import (
    UPRIGHT,
    ArrangedPoints,
    FirstBlade,
    first_blades,
    likely_arrangements,
    spans_along_y,
)
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Task, evaluated, searched
from bladewright.fitting.model_selection.selection import GUESS_NOISE, nearest_from_other_edges
from bladewright.nurbs.closest import closest_on_surface
from bladewright.section.laws import Span
from machines import COARSE, built, example

HEADER = DesignHeader(name="blade", length_unit="mm").known()


def _first(points: np.ndarray, header: dict[str, object]) -> FirstBlade:
    return next(first_blades(points, header))


def _arrangements(points: np.ndarray, arrangement: str | None = None) -> list[str]:
    found = likely_arrangements(points, {**HEADER, "arrangement": arrangement})
    return [each.header["arrangement"] for each in found]


def _truth(name: str) -> Blade:
    return built(example(name).changed("tolerance", COARSE))


def _cloud(blade: Blade, count: int, low: float = 0.0, high: float = 1.0) -> np.ndarray:
    draw = np.random.default_rng(3)
    sides = [blade.surfaces[name] for name in ("upper", "lower")]
    parts = [side(draw.random(count // 2), low + (high - low) * draw.random(count // 2)) for side in sides]
    return draw.permutation(np.concatenate(parts))


def _share(design: UnifiedBlade, points: np.ndarray) -> float:
    blade = design.changed("tolerance", COARSE).build()
    on = [closest_on_surface(blade.surfaces[name], points[:150], tolerance=1e-5) for name in ("upper", "lower")]
    return float(np.mean(np.min([each.distances for each in on], axis=0)) / blade.chord)


@pytest.mark.slow
def test_a_first_blade_lies_within_one_percent_of_the_chord() -> None:
    points = _cloud(_truth("centrifugal-impeller"), 600)
    assert _share(_first(points, {**HEADER, "arrangement": "annular"}).design, points) < 0.01


def test_a_first_blade_has_its_corners_within_one_percent_and_its_angles_and_the_count_and_unit_asked_for() -> None:
    truth = _truth("radial-turbine")
    points, span = _cloud(truth, 1000), Span(np.linspace(0.0, 1.0, 6))
    found = _first(points, {**HEADER, "arrangement": "annular", "blade_count": 20, "length_unit": "m"}).design
    assert (found.blade_count, found.length_unit) == (20, "m")
    assert _share(found, points) < 0.01
    for edge in ("leading_edge", "trailing_edge"):
        there, here = (
            design.metre * np.array(getattr(design.channel, edge))[[0, -1]] for design in (truth.design, found)
        )
        assert np.max(np.sqrt(np.sum((there - here) ** 2, axis=1))) < 0.01 * truth.chord
    for name in ("metal_angle_in", "metal_angle_out"):
        there, here = (np.real(span.values(getattr(design, name))) for design in (truth.design, found))
        assert np.max(np.abs(there - here)) < 20.0


@pytest.mark.slow
def test_the_search_of_a_first_blade_leaves_the_metal_angles_of_its_slices() -> None:
    truth, span = _truth("propeller"), Span(np.linspace(0.0, 1.0, 6))
    found = _first(_cloud(truth, 1000), {**HEADER, "arrangement": "annular"}).design
    for name in ("metal_angle_in", "metal_angle_out"):
        there, here = (np.real(span.values(getattr(design, name))) for design in (truth.design, found))
        assert np.max(np.abs(there - here)) < 20.0


@pytest.mark.slow
def test_a_first_blade_is_brought_nearer_from_usual_edges() -> None:
    points = _cloud(_truth("vki-ls89"), 600)
    first = _first(points, {**HEADER, "arrangement": "linear"})
    task = Task(
        points=points, weights=np.ones(600), free=FreeParameters(), bounds={}, preliminary=True, outline=first.walls
    )
    plain = searched(task, first.design, noise=GUESS_NOISE, min_reduction=ROUGH_REDUCTION)
    nearer = nearest_from_other_edges(task, plain)
    assert nearer.mean_distance < 0.7 * plain.mean_distance


def test_the_regularisation_of_a_preliminary_search_counts_against_independent_points() -> None:
    truth = _truth("compressor-stator")
    points, start = _cloud(truth, 400), truth.design.changed("stagger", 20.0)
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    usual, held = (evaluated(replace(task, preliminary=each), start, noise=1e-3) for each in (False, True))
    share = usual.noise_estimate.independent_share(len(usual.problem.paths))
    assert share < 0.5
    first, second = (np.diag(each.problem.regularisation.matrix) for each in (usual, held))
    np.testing.assert_allclose(second, first / np.sqrt(share))


def _disturbed(clean: np.ndarray, chord: float) -> np.ndarray:
    """The points with noise, and with one of twenty anywhere near."""
    draw = np.random.default_rng(2)
    points = clean + 5e-4 * chord * draw.normal(size=clean.shape)
    points[::20] += 0.1 * chord * draw.normal(size=points[::20].shape)
    return points


def test_a_first_blade_is_found_from_noisy_points_of_part_of_the_span_on_the_other_side_of_the_machine() -> None:
    truth = _truth("compressor-stator")
    clean = _cloud(truth, 700, 0.3, 0.8) * np.array([1.0, -1.0, -1.0])
    points = _disturbed(clean, truth.chord)
    assert _share(_first(points, {**HEADER, "arrangement": "annular"}).design, clean) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("name", ["compressor-stator", "mixed-flow-pump"])
def test_noise_and_outliers_leave_a_first_blade_close(name: str) -> None:
    truth = _truth(name)
    clean = _cloud(truth, 700)
    points = _disturbed(clean, truth.chord)
    assert _share(_first(points, {**HEADER, "arrangement": "annular"}).design, clean) < 0.015


@pytest.mark.parametrize(("name", "arrangement"), [("vki-ls89", "linear"), ("aachen-stator", "annular")])
def test_rows_at_the_ends_tell_a_cascade_from_a_ring_whose_sections_are_met_alike(name: str, arrangement: str) -> None:
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 40))) / 2.0
    u, v = (each.ravel() for each in np.meshgrid(u, np.linspace(0.0, 1.0, 9)))
    points = np.concatenate([np.real(side(u, v)) for side in _truth(name).sides])
    # far from the axis, with noise
    points[:, 2] += 0.5 if arrangement == "linear" else 0.0
    points = points + 2e-5 * np.random.default_rng(0).normal(size=points.shape)
    assert _arrangements(points) == [arrangement]


def test_a_cascade_whose_span_lies_along_y_is_told_from_one_along_z() -> None:
    points = _cloud(_truth("vki-ls89"), 700)
    assert spans_along_y(points[:, [0, 2, 1]])
    assert not spans_along_y(points)


def test_what_cannot_be_sliced_as_a_cascade_still_stands_around_the_axis(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: np.ndarray) -> bool:
        raise FitError("no slices")

    monkeypatch.setattr("bladewright.fitting.initial_guess.blade.spans_along_y", refused)
    assert _arrangements(_cloud(_truth("vki-ls89"), 400) @ turn_matrix(-UPRIGHT).T) == ["annular"]


def test_a_blade_whose_slices_are_far_around_the_axis_is_sought_in_a_cascade_with_its_span_along_y() -> None:
    points = _cloud(_truth("vki-ls89"), 400) @ turn_matrix(-UPRIGHT).T
    found = _first(points, HEADER)
    assert found.turn == UPRIGHT
    assert _share(found.design, points @ turn_matrix(found.turn).T) < 0.01


def _with_rows(blade: Blade, draw: np.random.Generator, noise: float = 0.0) -> np.ndarray:
    """Points strewn over the sides, and rows of points at both ends."""
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 60))) / 2.0
    at = [draw.random((2, 1500)), np.stack([u, np.zeros(60)]), np.stack([u, np.ones(60)])]
    points = np.concatenate([np.real(side(*each)) for side in blade.sides for each in at])
    return points + noise * blade.chord * draw.normal(size=points.shape)


@pytest.mark.parametrize("noise", [0.0, 1e-4])
@pytest.mark.parametrize(("name", "arrangement"), [("vki-ls89", "linear"), ("compressor-stator", "annular")])
def test_rows_at_the_ends_of_first_blades_tell_their_arrangement(name: str, arrangement: str, noise: float) -> None:
    blade = _truth(name)
    points = _with_rows(blade, np.random.default_rng(5), noise)
    # a cascade so far from the axis that nothing else tells
    points[:, 2] += 5.0 * blade.chord if arrangement == "linear" else 0.0
    assert _arrangements(points) == [arrangement]
    assert _arrangements(points, "annular") == ["annular"]


@pytest.mark.parametrize(
    ("around", "level", "found"),
    [
        (1e-6, 1e-6, ["annular"]),
        (9e-4, 3e-4, ["linear"]),
        (6e-4, 9e-4, ["annular", "linear"]),
        (4e-3, 1e-2, ["annular", "linear"]),
        (np.inf, np.inf, ["annular", "linear"]),
    ],
)
def test_rows_decide_where_those_of_one_arrangement_are_narrow_and_clearly_narrower(
    monkeypatch: pytest.MonkeyPatch, around: float, level: float, found: list[str]
) -> None:
    spread = {"annular": around, "linear": level}
    monkeypatch.setattr(ArrangedPoints, "row_spread", lambda own: spread[own.header["arrangement"]])
    assert _arrangements(_cloud(_truth("compressor-stator"), 400)) == found


def test_without_rows_at_its_ends_a_blade_may_stand_in_both_arrangements() -> None:
    assert _arrangements(_cloud(_truth("compressor-stator"), 1500, 0.05, 0.95)) == ["annular", "linear"]
