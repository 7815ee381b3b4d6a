"""Searches without derivatives: the Pareto set, the same from the same seed, and nothing lost when it is killed."""

import sys
from pathlib import Path

import numpy as np
import pytest

import bladewright as bw
from bladewright.errors import StudyError
from bladewright.files.examples import example_text
from bladewright.studies.optimise import Search
from bladewright.studies.pareto import nondominated
from bladewright.studies.study import read_study

pytest.importorskip("pymoo")

STUDY = """
design = "turbine-section.toml"

[variables]
stagger = { lower = -34, upper = -28 }
"thickness_*" = { lower = 0.7, upper = 1.3, relative = true, together = true }
pitch = { values = [24, 27, 30] }

[optimise]
objectives = [
    { quantity = "area" },
    { quantity = "throat", maximise = true },
    { quantity = "figures:known", figure = "wetted" },
]
constraints = [{ quantity = "maximum_thickness", lower = 7 }]
population = 8
generations = 3
"""
FIGURES = "def known(section): return {'wetted': 1e3 * section.perimeter, 'chord_mm': 1e3 * section.chord}\n"


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "turbine-section.toml").write_text(example_text("turbine-section"))
    (tmp_path / "figures.py").write_text(FIGURES)
    path = tmp_path / "search.toml"
    path.write_text(STUDY)
    return path


def test_the_set_is_what_a_comparison_of_all_pairs_leaves() -> None:
    costs = np.random.default_rng(3).integers(0, 6, (60, 3)).astype(float)
    better = [
        any(np.all(other <= own) and (np.any(other < own) or j < i) for j, other in enumerate(costs))
        for i, own in enumerate(costs)
    ]
    assert nondominated(costs).tolist() == [not each for each in better]
    assert nondominated(np.empty((0, 2))).tolist() == []


def test_a_search_that_was_killed_goes_on_and_ends_like_one_that_was_not(study: Path, tmp_path: Path) -> None:
    whole = Search(read_study(study)).pareto_set(tmp_path / "whole.jsonl", jobs=1)
    lines = (tmp_path / "whole.jsonl").read_bytes().splitlines(keepends=True)
    assert len(lines) == 1 + 24 == 1 + len(whole.runs)
    (tmp_path / "cut.jsonl").write_bytes(b"".join(lines[:12]) + lines[12][:40])
    asked = []
    again = Search(read_study(study)).pareto_set(tmp_path / "cut.jsonl", jobs=1, progress=asked.append)
    assert len(asked) == 24 - 11
    assert again.to_dict() == {**whole.to_dict(), "name": again.name}
    assert again.members
    assert np.all(again.best.figures["maximum_thickness"] >= 7.0 - 1e-5)
    assert {*again.runs.parameters["pitch"]} <= {24, 27, 30}
    number = again.members[0]
    section = again.design(number).build()
    assert section.area * 1e6 == pytest.approx(again.best.figures["area"][0], rel=1e-12)
    assert again.runs.parameters["stagger"][0] == pytest.approx(-31.0)  # the first run is the design of the study
    assert "run" in str(again)
    assert again.to_csv().count("\n") == 1 + len(again.members)


def test_a_function_is_known_by_its_name_when_a_search_goes_on(study: Path, tmp_path: Path) -> None:
    design = bw.read_design(study.parent / "turbine-section.toml")
    options = {"method": "nsga2", "population": 4, "generations": 1, "jobs": 1, "manifest": tmp_path / "runs.jsonl"}
    tables = []
    for _ in range(2):

        def slender(section):
            return section.perimeter / section.chord

        found = bw.optimise(design, {"stagger": (-34.0, -28.0)}, slender, {"chord": (30.0, None)}, **options)
        tables.append(found.runs.to_csv())
    assert tables[0] == tables[1]


def test_a_manifest_of_another_search_is_refused_and_stays(study: Path, tmp_path: Path) -> None:
    manifest = tmp_path / "runs.jsonl"
    Search(read_study(study)).pareto_set(manifest, jobs=1)
    before = manifest.read_bytes()
    study.write_text(STUDY.replace("population = 8", "population = 9"))
    with pytest.raises(StudyError, match="is the manifest of another study"):
        Search(read_study(study)).pareto_set(manifest, jobs=1)
    assert manifest.read_bytes() == before


def test_what_fails_in_every_run_ends_the_search_with_the_reason_and_keeps_the_runs(study: Path) -> None:
    (study.parent / "figures.py").write_text(
        "calls = []\n"
        "def known(section):\n"
        "    calls.append(1)\n"
        "    return {'wetted': 1.0 if len(calls) == 1 else float('nan')}\n"
    )
    manifest = study.with_suffix(".jsonl")
    with pytest.raises(
        StudyError, match=r"none of the 8 designs of the first generation gave figures; .*wetted is nan"
    ):
        Search(read_study(study)).pareto_set(manifest, jobs=1)
    assert len(manifest.read_bytes().splitlines()) == 9


def test_constraints_that_no_design_keeps_leave_an_empty_set_that_names_the_nearest(study: Path) -> None:
    study.write_text(STUDY.replace("lower = 7", "lower = 20").replace("generations = 3", "generations = 1"))
    found = Search(read_study(study)).pareto_set(jobs=1)
    assert (found.members, found.passed) == ((), False)
    _, limit, excess = found.nearest
    assert limit.figure == "maximum_thickness"
    assert 0.3 < excess < 0.7


def test_without_pymoo_the_search_names_the_extra(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pymoo.version", None)
    monkeypatch.setitem(sys.modules, "pymoo", None)
    with pytest.raises(StudyError, match=r"pip install 'bladewright\[search\]'"):
        Search(read_study(study)).pareto_set(jobs=1)


@pytest.mark.parametrize("aims", [1, 2, 3])
def test_sets_draw_themselves(study: Path, aims: int) -> None:
    design = bw.read_design(study.parent / "turbine-section.toml")
    asked = ["area", {"quantity": "throat", "maximise": True}, {"quantity": "perimeter"}][:aims]
    found = bw.optimise(design, {"stagger": (-34.0, -28.0)}, asked, method="nsga2", population=6, generations=1, jobs=1)
    figure = found.plot()
    titles = [axes.get_xlabel() for axes in figure.axes]
    assert len(titles) == {1: 2, 2: 1, 3: 4}[aims]
    assert "area [mm2]" in titles or aims == 1
    assert "Pareto set of" in found._repr_html_()


def test_the_component_of_openmdao_has_exact_partials(study: Path) -> None:
    om = pytest.importorskip("openmdao.api")
    design = bw.read_design(study.parent / "turbine-section.toml")
    variables = {"stagger": (-34.0, -28.0), "thickness_upper[1]": (0.15, 0.25)}
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("vane", bw.openmdao_component(design, variables, ["area", "throat"]), promotes=["*"])
    problem.setup(force_alloc_complex=False)
    problem.set_val("stagger", -30.0)
    problem.run_model()
    built = design.changed("stagger", -30.0).build()
    assert problem.get_val("area").item() == pytest.approx(built.area * 1e6)
    checks = problem.check_partials(out_stream=None, form="central", step=1e-5)["vane"]
    assert set(checks) == {(of, by) for of in ("area", "throat") for by in ("stagger", "thickness_upper_1")}
    for found in checks.values():
        assert found["J_fwd"] == pytest.approx(found["J_fd"], rel=1e-6)
