"""One run and its record, and the manifest that keeps it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import bladewright as bw
from bladewright.derivatives.complex_step import STEP
from bladewright.errors import DesignError, FileError, StudyError
from bladewright.files.examples import example_text
from bladewright.section.section import Section
from bladewright.studies.manifest import Manifest, notes, read_manifest
from bladewright.studies.operating_points import polar_figures
from bladewright.studies.quantities import BuiltDesign, quantities_of
from bladewright.studies.run import Experiment, Record, built_designs, record_of
from bladewright.studies.study import read_study
from machines import segmented

HERE = {"stagger": -30.0, "thickness_upper*": 1.0}


@pytest.fixture
def experiment(study_file: Path) -> Experiment:
    (study_file.parent / "figures.py").write_text(
        "import math\n"
        "def slender(section): return {'chord_mm': 1e3 * section.chord, 'ratio': section.perimeter / section.chord}\n"
        "def nothing(section): return math.nan\n"
        "def raises(section): raise KeyError('no solver')\n"
        "def hangs(section):\n    while True: pass\n"
    )
    study = read_study(study_file)
    asked = [*study.sweep.quantities, "throat", "figures:slender"]
    return Experiment(
        designs=study.designs,
        variables=study.variables,
        quantities=tuple(each for name in asked for each in study.quantities(name)),
        directory=str(study_file.parent / "files"),
    )


def asking(experiment: Experiment, *names: str) -> Experiment:
    folder = Path(experiment.directory).parent
    found = tuple(each for name in names for each in quantities_of(name, experiment.designs, folder))
    return replace(experiment, quantities=found)


def test_figures_are_those_of_the_build_in_the_units_of_the_design(experiment: Experiment) -> None:
    record = record_of(experiment, 3, HERE)
    section = experiment.designs["turbine-section"].changed("stagger", -30.0).build()
    table = section.report().to_dict()["stations"]
    expected = {
        "area": section.area * 1e6,
        "chord": section.chord * 1e3,
        "turning": table["turning"][0],
        "throat": table["throat"][0],
        "chord_mm": section.chord * 1e3,
        "ratio": section.perimeter / section.chord,
    }
    assert (record.run, record.verdict, record.reason, record.parameters) == (3, "built", "", HERE)
    assert record.figures == pytest.approx(expected, rel=1e-14)
    assert experiment.units == {"area": "mm2", "chord": "mm", "turning": "deg", "throat": "mm"}
    assert Record.from_dict(json.loads(record.line())) == record


def test_figures_carry_a_complex_step(experiment: Experiment) -> None:
    [design] = experiment.designs.values()
    chord, *_ = quantities_of("chord", experiment.designs)
    values = [
        chord.of({"turbine-section": BuiltDesign(each, each.build())})
        for each in (design.changed("stagger", -31.0 + step) for step in (1j * STEP, 1e-4, -1e-4))
    ]
    assert values[0].imag / STEP == pytest.approx((values[1] - values[2]) / 2e-4, rel=1e-7)


def test_what_cannot_be_built_is_refused_and_what_cannot_be_measured_has_failed(experiment: Experiment) -> None:
    refused = record_of(experiment, 1, {**HERE, "stagger": 89.9})
    assert refused.verdict == "refused"
    assert "the camber turns too fast" in refused.reason
    failed = record_of(asking(experiment, "area", "figures:nothing", "figures:raises"), 1, HERE)
    assert failed.verdict == "failed"
    assert failed.figures["nothing"] is None
    assert failed.figures["area"] is not None
    assert "nothing is nan" in failed.reason
    assert "KeyError: 'no solver'" in failed.reason


def test_a_run_that_hangs_ends_at_its_limit(experiment: Experiment) -> None:
    record = record_of(replace(asking(experiment, "figures:hangs"), time_limit=0.2), 1, HERE)
    assert (record.verdict, record.reason) == ("failed", "it took longer than the limit of 0.2 s")


def test_vectors_and_columns_at_a_span_are_named(tmp_path: Path) -> None:
    (tmp_path / "vki-ls89.toml").write_text(example_text("vki-ls89"))
    (tmp_path / "study.toml").write_text('design = "vki-ls89.toml"')
    study = read_study(tmp_path / "study.toml")
    asked = [each for name in ("volume", "centroid", "chord@0.5", "throat_area") for each in study.quantities(name)]
    experiment = Experiment(designs=study.designs, variables=(), quantities=tuple(asked))
    blade = study.designs["vki-ls89"].build()
    record = record_of(experiment, 1, {})
    assert record.figures["volume"] == pytest.approx(float(blade.properties.volume) * 1e9)
    assert [record.figures[f"centroid.{axis}"] for axis in "xyz"] == pytest.approx(blade.properties.centroid * 1e3)
    assert record.figures["chord@0.5"] == pytest.approx(float(blade.report([0.5]).chord[0]) * 1e3)
    assert record.figures["throat_area"] == pytest.approx(float(np.ravel(blade.report([0.5]).throat_area)[0]) * 1e6)


RECORDS = [Record(run=run, parameters={"a": run / 3}, figures={"b": None}, verdict="failed") for run in (1, 3, 2)]


def test_a_manifest_gives_back_what_was_written_and_goes_on_after_a_kill(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    with Manifest(path, {"seed": 1}) as manifest:
        manifest.append(RECORDS[0])
        manifest.note({"generation": 4})
        manifest.append(RECORDS[1])
    whole = path.read_bytes()
    ends = [place + 1 for place, byte in enumerate(whole) if byte == ord("\n")]
    near = {place + step for place in ends for step in (-2, -1, 0, 1)}
    for cut in sorted({*range(0, len(whole), 29), *near}):
        path.write_bytes(whole[:cut])
        with Manifest(path, {"seed": 1}) as manifest:
            for record in RECORDS[:2]:
                if record.run not in manifest.done:
                    manifest.append(record)
        header, records = read_manifest(path)
        assert header == {"seed": 1}
        assert list(records) == RECORDS[:2]
    assert list(notes(path)) == [{"generation": 4}]


def test_failed_runs_are_dropped_to_be_done_again(tmp_path: Path) -> None:
    path, good = tmp_path / "runs.jsonl", replace(RECORDS[0], verdict="built", figures={"b": 1.0})
    with Manifest(path, {}) as manifest:
        for record in (good, *RECORDS[1:]):
            manifest.append(record)
    with Manifest(path, {}, retry=True) as manifest:
        assert manifest.done == {1}
        manifest.append(RECORDS[1])
    assert list(read_manifest(path)[1]) == [good, RECORDS[1]]


def test_a_manifest_of_another_study_or_of_another_process_is_refused_and_stays(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    with Manifest(path, {"seed": 1, "samples": 8}) as manifest:
        manifest.append(RECORDS[0])
        with pytest.raises(StudyError, match="another process"):
            Manifest(path, {"seed": 1, "samples": 8})
    before = path.read_bytes()
    with pytest.raises(StudyError, match="another study: it differs in seed: 1 there, 2 here"):
        Manifest(path, {"seed": 2, "samples": 8})
    assert path.read_bytes() == before
    path.write_text("x,y\n1,2\n")
    with pytest.raises(FileError, match="no manifest of a study"):
        Manifest(path, {"seed": 2})
    with pytest.raises(FileError, match="no manifest"):
        read_manifest(tmp_path / "nothing.jsonl")


def test_polars_are_quantities_at_operating_points(study_file: Path) -> None:
    pytest.importorskip("neuralfoil", reason="the extra 'polar' is not installed")
    with study_file.open("a") as file:
        file.write('[polars.cruise]\nreynolds = 1e6\nalpha = 2\nsolver = "neuralfoil"\n')
        file.write('[polars.climb]\nreynolds = 1e6\nalpha = [2, 5]\nsolver = "neuralfoil"\n')
    study = read_study(study_file)
    asked = [each for name in ("cruise.cl", "climb.lift_to_drag") for each in study.quantities(name)]
    record = record_of(Experiment(designs=study.designs, variables=(), quantities=tuple(asked)), 1, {})
    polar = bw.polar(study.designs["turbine-section"].build(), 1e6, [2.0, 5.0], solver="neuralfoil")
    expected = [polar.cl[0], *polar.lift_to_drag]
    assert list(record.figures) == ["cruise.cl", "climb.lift_to_drag@2", "climb.lift_to_drag@5"]
    assert list(record.figures.values()) == pytest.approx(expected)
    with pytest.raises(StudyError, match="did you mean 'cd'"):
        study.quantities("cruise.cpd")


def test_a_section_is_left_at_its_exact_outline_where_polars_alone_are_asked() -> None:
    design = segmented.airfoil_of(segmented.REDUCED).changed("section.morph", bw.Morph(trailing_edge=-15.0))
    designs = {"airfoil": design}
    lift = polar_figures("cruise.cl", {"cruise": bw.OperatingPoint(reynolds=1e6, alpha=2.0)}, designs)
    alone = Experiment(designs=designs, variables=(), quantities=tuple(lift or ()))
    assert built_designs(alone, {})["airfoil"].built is None
    assert np.array_equal(
        built_designs(alone, {})["airfoil"].outline.points(np.ones(1)), design.exact().points(np.ones(1))
    )
    for more in ({"quantities": (*alone.quantities, *quantities_of("chord", designs))}, {"files": (".step",)}):
        assert isinstance(built_designs(replace(alone, **more), {})["airfoil"].built, Section)
    skin = bw.Skin(inner=0.001, outer=0.001, ordinates=(0.05,))
    beyond = design.changed("section.upper.leading_edge.skin", skin)
    with pytest.raises(DesignError) as refusal:
        beyond.build()
    record = record_of(replace(alone, designs={"airfoil": beyond}), 1, {})
    assert (record.verdict, record.reason) == ("refused", " ".join(str(refusal.value).split()))


def test_a_solver_that_is_missing_is_said_in_the_record(study_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BLADEWRIGHT_XFOIL", "/no/xfoil")
    with study_file.open("a") as file:
        file.write("[polars.cruise]\nreynolds = 1e6\nalpha = 2\n")
    study = read_study(study_file)
    asked = [each for name in ("area", "cruise.cl", "cruise.cd") for each in study.quantities(name)]
    record = record_of(Experiment(designs=study.designs, variables=(), quantities=tuple(asked)), 1, {})
    assert (record.verdict, record.figures["cruise.cl"]) == ("failed", None)
    assert record.figures["area"] is not None
    # the solver was asked for once, and its answer is said once
    assert record.reason.startswith("cruise.cl, cruise.cd: ")
    assert record.reason.count("/no/xfoil") == 1
