"""First sections from points in the plane."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bladewright.fitting.families.kinds import DesignHeader
from bladewright.fitting.families.unified import first_section
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Task, searched
from bladewright.fitting.model_selection.selection import GUESS_NOISE, nearest_from_other_edges
from bladewright.fitting.model_selection.structure import Structure
from bladewright.nurbs.closest import closest_on_curve
from bladewright.section.unified import UnifiedSection

HEADER = DesignHeader(name="blade", length_unit="mm")
CLOUDS = Path(__file__).resolve().parents[3] / "shared" / "data" / "clouds"
TRUTHS = {
    "turbine": UnifiedSection(
        name="turbine", length_unit="mm", axial_chord=40.0, leading_edge_x=-7.0, leading_edge_y=80.0, stagger=-40.0,
        metal_angle_in=20.0, metal_angle_out=-68.0, tangent_in=0.5, tangent_out=0.5, leading_edge_radius=0.08,
        trailing_edge_radius=0.015, thickness_upper=(0.12, 0.2, 0.2, 0.1, 0.04),
        thickness_lower=(0.08, 0.1, 0.08, 0.03),
    ),
    "compressor": UnifiedSection(
        name="compressor", length_unit="mm", axial_chord=40.0, stagger=66.0, metal_angle_in=70.0, metal_angle_out=61.0,
        tangent_in=0.9, tangent_out=0.9, leading_edge_radius=0.01, trailing_edge_radius=0.01,
        thickness_upper=(0.05, 0.1, 0.1, 0.05), thickness_lower=(0.05, 0.08, 0.08, 0.05),
    ),
    "impulse": UnifiedSection(
        name="impulse", length_unit="mm", axial_chord=40.0, stagger=0.0, metal_angle_in=65.0, metal_angle_out=-65.0,
        tangent_in=0.6, tangent_out=0.6, leading_edge_radius=0.01, trailing_edge_radius=0.01,
        thickness_upper=(0.03, 0.15, 0.25, 0.15, 0.03), thickness_lower=(0.03, 0.1, 0.12, 0.1, 0.03),
    ),
}  # fmt: skip


def _cloud(truth: UnifiedSection, count: int, seed: int = 1) -> np.ndarray:
    draw = np.random.default_rng(seed)
    curves = truth.build().curves
    # one side has twice the points of the other
    parts = [curves["upper"](draw.random(2 * count // 3)), curves["lower"](draw.random(count - 2 * count // 3))]
    return draw.permutation(np.concatenate(parts))


def _share(design: UnifiedSection, points: np.ndarray) -> float:
    built = design.build()
    distances = np.min([closest_on_curve(curve, points).distances for curve in built.curves.values()], axis=0)
    return float(np.mean(distances) / built.chord)


@pytest.mark.parametrize("count", [120, pytest.param(600, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", TRUTHS)
def test_a_first_section_lies_within_one_percent_of_the_chord_and_has_the_angles_of_the_truth(
    name: str, count: int
) -> None:
    truth = TRUTHS[name]
    points = _cloud(truth, count)
    found = first_section(points, HEADER)
    assert _share(found, points[:200]) < 0.01
    # the ends of the camber lie somewhere on round edges: within a radius of each other
    assert found.stagger == pytest.approx(truth.stagger, abs=6.0)
    assert found.axial_chord == pytest.approx(truth.axial_chord, rel=0.08)


def test_noise_outliers_and_duplicates_leave_a_first_section_close() -> None:
    truth = TRUTHS["turbine"]
    clean = _cloud(truth, 600)
    draw = np.random.default_rng(5)
    chord = float(truth.build().chord)
    points = clean + 0.001 * chord * draw.normal(size=clean.shape)
    points[::20] += 0.15 * chord * draw.normal(size=points[::20].shape)
    assert _share(first_section(np.concatenate([points, points[:100]]), HEADER), clean) < 0.01


def test_a_first_section_has_the_structure_that_was_asked_for() -> None:
    counts = {"thickness_upper": (4, 1), "thickness_lower": (7, 1)}
    asked = Structure(counts=counts, samples=12, clustering=0.5)
    found = first_section(_cloud(TRUTHS["turbine"], 300), replace(HEADER, length_unit="m"), asked)
    assert (len(found.thickness_upper), len(found.thickness_lower)) == (4, 7)
    assert (found.samples, found.clustering, found.length_unit) == (12, 0.5, "m")


@pytest.mark.parametrize("name", ["LS89_2D", "t106eiz_2D", "Impulse_2D", "Aachen_2D"])
def test_a_published_cloud_gives_a_first_section_within_a_fifth_of_a_percent(name: str) -> None:
    path = CLOUDS / f"{name}.txt"
    if not path.is_file():
        pytest.skip(f"{path} is not here")
    points = np.loadtxt(path)[:, 1:]
    assert _share(first_section(points, HEADER), points) < 0.002


def test_a_section_in_another_minimum_is_met_from_usual_edges_where_it_is_not_trusted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    truth = TRUTHS["turbine"]
    points = _cloud(truth, 200)
    task = Task(points=points, weights=np.ones(200), free=FreeParameters(), bounds={}, preliminary=True)
    off = truth.changed({"tangent_in": 0.9, "stagger": truth.stagger + 8.0})
    plain = searched(task, off, noise=GUESS_NOISE, min_reduction=ROUGH_REDUCTION)
    assert nearest_from_other_edges(task, plain) is plain
    monkeypatch.setattr("bladewright.fitting.model_selection.selection.GROSS_DEVIATION", (0.0, 0.0))
    nearer = nearest_from_other_edges(task, plain)
    assert nearer.mean_distance < 1e-3 * plain.mean_distance
