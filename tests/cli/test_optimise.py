"""`bladewright optimise`: what it prints and writes, and its exit statuses."""

from pathlib import Path

import pytest

from bladewright.files.examples import example_text
from bladewright.files.reading import read_design

STUDY = """
design = "turbine-section.toml"
[variables]
stagger = { lower = -34, upper = -28 }
"thickness_*" = { lower = 0.7, upper = 1.3, relative = true, together = true }
[optimise]
objectives = [{ quantity = "area" }]
constraints = [{ quantity = "throat", lower = 1.02, relative = true }]
"""
FRONT = STUDY.replace('[{ quantity = "area" }]', '[{ quantity = "area" }, { quantity = "chord" }]')


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "turbine-section.toml").write_text(example_text("turbine-section"))
    path = tmp_path / "search.toml"
    path.write_text(STUDY)
    return path


def test_an_optimum_becomes_a_design_file_and_proven_cad(run, study: Path) -> None:
    done = run("optimise", "search.toml", "--as", "step", "--picture", "search.png", "-d", "out", "--json")
    assert done.status == 0, done.err
    assert done.json["kkt"] < 1e-6
    assert done.json["figures"]["throat"] >= 1.02 * done.json["start_figures"]["throat"] - 1e-5
    design = read_design(study.parent / "out" / "turbine-section-optimum.toml")
    assert design.stagger == pytest.approx(done.json["parameters"]["stagger"], rel=1e-12)
    assert (study.parent / "out" / "turbine-section-optimum.step").stat().st_size > 10_000
    assert (study.parent / "search.png").stat().st_size > 10_000


def test_a_member_of_a_front_is_one_command_from_its_cad_file(run, study: Path) -> None:
    pytest.importorskip("pymoo")
    study.write_text(FRONT + "population = 6\ngenerations = 2\n")
    words = [
        "optimise",
        "search.toml",
        "--jobs",
        "1",
        "--csv",
        "front.csv",
        "--picture",
        "a.png",
        "--parallel",
        "b.png",
    ]
    done = run(*words, "--json")
    assert done.status == 0, done.err
    members = done.json["members"]
    assert members
    assert len((study.parent / "front.csv").read_text().splitlines()) == 1 + len(members)
    assert all((study.parent / name).stat().st_size > 10_000 for name in ("a.png", "b.png"))
    again = run("optimise", "search.toml", "--jobs", "1")
    assert f"--member {members[0]} --as step" in again.out
    built = run("optimise", "search.toml", "--member", str(members[0]), "--as", "step")
    assert built.status == 0, built.err
    assert (study.parent / f"turbine-section-{members[0]:04d}.step").is_file()
    lost = run("optimise", "search.toml", "--member", "99")
    assert (lost.status, "there is no run 99 in 'search.jsonl'" in lost.err) == (2, True)


def test_a_set_that_keeps_no_constraint_fails_with_the_nearest(run, study: Path) -> None:
    pytest.importorskip("pymoo")
    study.write_text(FRONT.replace("lower = 1.02", "lower = 3") + "population = 4\ngenerations = 1\n")
    done = run("optimise", "search.toml", "--jobs", "1")
    assert done.status == 1
    assert "no design of 4 keeps all constraints: run" in done.err
    assert "misses the limit of throat" in done.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--as", "step", "--jobs", "1"], "--as writes one design: name it with --member"),
        (["--member", "1", "--csv", "x.csv"], "--member writes one design"),
        (["--jobs", "1", "--scheduler", "tcp://x:1"], "leave one out"),
        (["--picture", "x.gif"], "a picture is drawn as"),
        (["--member", "1"], "there is no manifest 'search.jsonl'"),
    ],
)
def test_calls_that_ask_for_too_much_are_refused(run, study: Path, words: list[str], message: str) -> None:
    study.write_text(FRONT)
    done = run("optimise", "search.toml", *words)
    assert done.status == 2
    assert message in " ".join(done.err.split())
    assert sorted(each.name for each in study.parent.iterdir()) == ["search.toml", "turbine-section.toml"]
