"""Searches with derivatives: the vector, the conditions of an optimum, optima, fronts."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import approx_fprime

import bladewright as bw
from bladewright.errors import StudyError
from bladewright.files.examples import example_text
from bladewright.studies.adjoint import adjoint_of
from bladewright.studies.goals import Limit
from bladewright.studies.manifest import read_manifest
from bladewright.studies.optimality import Rows, optimality
from bladewright.studies.optimise import Search
from bladewright.studies.problem import Problem
from bladewright.studies.quantities import quantities_of
from bladewright.studies.study import read_study
from bladewright.studies.variables import Range, resolved

THICKNESS = {"lower": 0.7, "upper": 1.3, "relative": True, "together": True}
"""The range of all thicknesses of a side as one variable."""
THICK = {"quantity": "maximum_thickness", "lower": 0.95, "relative": True}


@pytest.fixture(scope="module")
def section(tmp_path_factory):
    path = tmp_path_factory.mktemp("designs") / "turbine-section.toml"
    path.write_text(example_text("turbine-section"))
    return bw.read_design(path)


def test_gradients_are_those_of_differences_for_shared_relative_and_whole_patterns(section) -> None:
    designs = {"one": section, "two": section.changed("stagger", -25.0)}
    ranges = {
        "metal_angle_out": Range(lower=-72.0, upper=-60.0),
        "one:stagger": Range(lower=-33.0, upper=-29.0),
        "thickness_upper*": Range(**THICKNESS),
    }
    asked = [each for name in ("area", "turning") for each in quantities_of(name, designs)]
    problem = Problem(designs, resolved(ranges, designs), asked)
    problem = problem.renewed(problem.start)
    names = list(problem.figures(problem.start))
    assert names == ["one:area", "two:area", "one:turning", "two:turning"]
    gradients = problem.gradients(problem.start)
    differences = approx_fprime(problem.start, lambda x: np.array([problem.figures(x)[name] for name in names]), 1e-7)
    assert np.array([gradients[name] for name in names]) == pytest.approx(differences, rel=1e-4, abs=1e-4)
    assert gradients["two:area"][1] == 0.0


def test_a_figure_of_several_designs_has_the_derivatives_of_all(section) -> None:
    designs = {"one": section, "two": section}
    ranges = {"stagger": Range(lower=-33.0, upper=-29.0)}

    def both(built):
        return built["one"].area + 2.0 * built["two"].area

    quantities = [*quantities_of(both, designs), *quantities_of("one:area", designs)]
    problem = Problem(designs, resolved(ranges, designs), quantities)
    gradients = problem.gradients(problem.start)
    assert 1e6 * gradients["both"] == pytest.approx(3.0 * gradients["one:area"], rel=1e-12)


def test_an_adjoint_gives_the_derivatives_of_the_same_figure_without_one(section) -> None:
    u = np.linspace(0.1, 0.9, 7)

    def plain(built):
        return (built.curves["upper"](u) ** 2).sum() / 2.0

    def solver(built):
        points = np.real(built.curves["upper"](u))
        return (points**2).sum() / 2.0, {"upper": (u, points)}

    designs = {"vane": section}
    ranges = {"stagger": Range(lower=-33.0, upper=-29.0), "thickness_*": Range(**THICKNESS)}
    quantities = [*quantities_of(plain, designs), *map(adjoint_of, quantities_of(solver, designs))]
    problem = Problem(designs, resolved(ranges, designs), quantities)
    gradients = problem.gradients(problem.start)
    assert gradients["solver"] == pytest.approx(gradients["plain"], rel=1e-12)
    found = bw.optimise(section, {"stagger": (-33.0, -29.0)}, {"quantity": solver, "adjoint": True})
    assert found.passed, found.failures
    assert found.figures["solver"] < found.start_figures["solver"]


def test_the_conditions_of_an_optimum_hold_with_the_multipliers_of_a_known_one() -> None:
    # the least of (a - 2)^2 + (b - 2)^2 where a + b <= 1 and b <= 0.25: a = 0.75, b = 0.25, multipliers 2.5 and 1
    x = np.array([0.75, 0.25])
    at = Rows(
        cost=0.0,
        slope=2.0 * (x - 2.0),
        names=("sum", "b"),
        rows=np.zeros(2),
        slopes=np.array([[-1.0, -1.0], [0.0, -1.0]]),
        equal=(False, False),
    )
    found = optimality(x, at, ("a", "b"))
    assert found.worst == pytest.approx(0.0, abs=1e-12)
    assert found.multipliers == pytest.approx({"sum": 2.5, "b": 1.0})
    elsewhere = optimality(np.array([0.5, 0.5]), at, ("a", "b"))
    assert elsewhere.residual == found.residual  # the rows decide, not the place
    loose = Rows(**{**{name: getattr(at, name) for name in Rows.__dataclass_fields__}, "rows": np.ones(2)})
    assert optimality(x, loose, ("a", "b")).residual == pytest.approx(3.5)


@pytest.mark.parametrize("method", ["slsqp", "trust-constr"])
def test_the_smallest_section_of_given_chord_has_that_chord(section, method: str) -> None:
    variables = {"axial_chord": (20.0, 40.0), "thickness_*": THICKNESS}
    chord = {"quantity": "axial_chord", "lower": 25.0}
    found = bw.optimise(section, variables, "area", [chord], method=method)
    assert found.passed, found.failures
    assert found.parameters["axial_chord"] == pytest.approx(25.0, abs=1e-5)
    assert found.parameters["thickness_*"] == pytest.approx(0.7, abs=1e-5)
    assert found.figures["area"] < found.start_figures["area"]
    assert any("axial_chord" in name for name in found.optimality.multipliers)
    assert found.design.build().area * 1e6 == pytest.approx(found.figures["area"], rel=1e-9)
    assert "held by" in str(found)


def test_every_member_of_a_front_is_an_optimum_and_nsga2_finds_none_better(section, tmp_path: Path) -> None:
    pytest.importorskip("pymoo")
    variables = {"metal_angle_out": (-72.0, -64.0), "thickness_*": THICKNESS}
    aims = ["area", {"quantity": "turning", "maximise": True}]
    front = bw.optimise(section, variables, aims, [THICK], method="slsqp", members=3, manifest=tmp_path / "a.jsonl")
    assert front.passed, front.failures
    assert max(found.worst for found in front.optimality.values()) < 1e-6
    assert len(front.members) == 3
    assert np.diff(front.table[:, 1]) == pytest.approx(4.0, abs=1e-4)  # equal steps of the turning
    evolved = bw.optimise(section, variables, aims, [THICK], population=12, generations=4, jobs=1)
    for area, turning in evolved.table[:, :2]:
        assert area > np.interp(turning, front.table[:, 1], front.table[:, 0]) - 1e-3
    again = bw.optimise(section, variables, aims, [THICK], method="slsqp", members=3, manifest=tmp_path / "a.jsonl")
    assert again.table == pytest.approx(front.table, rel=2e-6)  # rows count as held within 1e-6


def test_a_search_that_is_interrupted_goes_on_at_its_last_iteration(section, tmp_path: Path) -> None:
    variables, manifest = {"axial_chord": (20.0, 40.0), "thickness_*": THICKNESS}, tmp_path / "runs.jsonl"
    chord = {"quantity": "axial_chord", "lower": 25.0}
    seen = list[float]()

    def stop(figures) -> None:
        seen.append(figures["area"])
        if len(seen) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bw.optimise(section, variables, "area", [chord], manifest=manifest, progress=stop)
    assert len(list(read_manifest(manifest)[1])) == 2
    found = bw.optimise(section, variables, "area", [chord], manifest=manifest, iterations=100)
    assert found.passed
    assert found.history[:2, 0].tolist() == seen
    assert found.parameters["axial_chord"] == pytest.approx(25.0, abs=1e-5)
    again = bw.optimise(section, variables, "area", [chord], manifest=manifest)
    assert (again.parameters, again.figures, again.rounds) == (found.parameters, found.figures, 0)
    with pytest.raises(StudyError, match="manifest of another study: it differs in variables"):
        bw.optimise(section, {"axial_chord": (20.0, 41.0)}, "area", [chord], manifest=manifest)


HANGS = "def hangs(section):\n    while True: pass\n"


def study(folder: Path, optimise: str, variables: str = "stagger = { lower = -34, upper = -28 }") -> Path:
    (folder / "turbine-section.toml").write_text(example_text("turbine-section"))
    (folder / "figures.py").write_text(
        "def nothing(section): return float('nan')\ndef solver(section): return 1.0\n" + HANGS
    )
    path = folder / "search.toml"
    path.write_text(f'design = "turbine-section.toml"\n[variables]\n{variables}\n[optimise]\n{optimise}\n')
    return path


AREA = 'objectives = [{ quantity = "area" }]'
REFUSED = {
    "a quantity that there is not": ('objectives = [{ quantity = "aera" }]', "aera"),
    "an unknown key": ('objectives = [{ quantity = "area", maximize = true }]', "did you mean 'maximise'?"),
    "an unknown key of the table": (f"{AREA}\niteration = 3", "did you mean 'iterations'?"),
    "limits the wrong way round": (
        f'{AREA}\nconstraints = [{{ quantity = "chord", lower = 40, upper = 30 }}]',
        "lower must not be above upper; change them round",
    ),
    "a constraint without limits": (f'{AREA}\nconstraints = [{{ quantity = "chord" }}]', "has no limit: give lower"),
    "an objective without a figure": ('objectives = [{ quantity = "figures:nothing" }]', "nothing is nan"),
    "an objective of several figures": ('objectives = [{ quantity = "centroid" }]', "name one, as figure ="),
    "three objectives with derivatives": (
        'objectives = [{ quantity = "area" }, { quantity = "chord" }, { quantity = "turning" }]\nmethod = "slsqp"',
        "a front with derivatives has two",
    ),
    "equal limits without derivatives": (
        f'{AREA}\nmethod = "nsga2"\nconstraints = [{{ quantity = "chord", lower = 30, upper = 30 }}]',
        "which no random design meets",
    ),
    "a figure that takes too long": (
        'objectives = [{ quantity = "figures:hangs" }]\ntime_limit = 0.2',
        "takes longer than the limit of 0.2 s",
    ),
    "an adjoint that is no function": ('objectives = [{ quantity = "area", adjoint = true }]', "is no function"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_searched_is_refused_in_a_paragraph(case: str, tmp_path: Path) -> None:
    text, words = REFUSED[case]
    with pytest.raises(StudyError, match=r"(?s).+") as refused:
        Search(read_study(study(tmp_path, text)))
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_derivatives_are_asked_of_numbers_between_bounds_and_of_figures_that_carry_them(tmp_path: Path) -> None:
    choices = study(tmp_path, AREA, "samples = { values = [15, 16, 17] }")
    with pytest.raises(StudyError, match="has choices, and a search with derivatives varies numbers"):
        Search(read_study(choices)).optimum()
    outside = study(tmp_path, AREA, "stagger = { lower = -28, upper = -20 }")
    with pytest.raises(StudyError, match="stagger' is -31 in the design, outside its bounds -28 to -20"):
        Search(read_study(outside)).optimum()
    adjoint = study(tmp_path, 'objectives = [{ quantity = "figures:solver", adjoint = true }]')
    with pytest.raises(StudyError, match="it must return the figure and its derivatives by points"):
        Search(read_study(adjoint)).optimum()


def test_a_search_that_runs_into_a_refusal_says_so(section) -> None:
    # a trailing edge as round as it can be: the thickness beside it is what refuses more
    found = bw.optimise(
        section, {"trailing_edge_radius": (0.01, 0.2)}, {"quantity": "trailing_edge_radius", "maximise": True}
    )
    assert not found.passed
    assert "it ended where a design is refused" in found.failures[0]
    assert found.design.build().area > 0.0  # what was found can be built all the same


def test_limits_count_their_excess_in_sizes() -> None:
    limit = Limit(figure="a", lower=1.0, upper=3.0, size=2.0)
    assert [limit.excess({"a": value}) for value in (0.0, 2.0, 7.0)] == [0.5, 0.0, 2.0]
