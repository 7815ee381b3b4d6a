"""The README and the pages in docs/ are true: their commands and examples run, and the files they name exist."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import click
import numpy as np
import pytest

import bladewright as bw
from bladewright.cli.program import program
from bladewright.files.examples import example_text
from bladewright.files.families import FAMILIES
from bladewright.files.reading import design_from

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
PAGES = sorted((ROOT / "docs").glob("*.md"))
LONG = ("derivatives", "passage-and-mesh", "wheels", "notebooks", "build", "verify")
"""pages whose Python takes seconds: a whole Jacobian, a passage and its mesh, results in a notebook, files and
their round trips"""
TEXTS = [*sorted(ROOT.glob("*.md")), *PAGES, *sorted(ROOT.glob("*/README.md")), *sorted((ROOT / "design").glob("*.md"))]
COMPLETED_BY = {"hub_fillet": "marine-propeller", "cut": "pump-impeller", "disc": "pump-impeller"}
"""the example whose file a table on a page is put into, by the table"""
EXAMPLES = (
    "fan-rotor",
    "turbine-section",
    "compressor-stator",
    "inlet-guide-vane",
    "propeller",
    "pump-inducer",
    "marine-propeller",
    "morphing-airfoil",
)
"""design files that stand in the directory in which a page's blocks run, as `bladewright new` writes them"""
MADE_WITH_THE_SITE = {f"generated/keys-{family}.md" for family in FAMILIES} | {"generated/gallery.md"}
"""pages that docs/generated_pages.py writes"""
TBLADE3 = ROOT.parent / "shared" / "data" / "tblade3" / "Wennerstrom_r37_v1.2.5" / "input"
"""a case of T-Blade3, which is too large to be kept in this tree"""


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


def blocks(path: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)


def marked(mark: str, language: str) -> str:
    """The fenced text after `<!-- mark -->` of the README."""
    found = re.search(rf"<!-- {mark} -->\n```{language}\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert found, f"README.md has no {language} block after <!-- {mark} -->"
    return found[1].strip()


def commands(path: Path) -> list[str]:
    """Lines of a page's shell blocks that call the program, in their order."""
    lines = "\n".join(blocks(path, "bash")).splitlines()
    return [line for line in lines if line.startswith("bladewright ")]


def is_whole(text: str) -> bool:
    """Whether a block is a whole design file, and not some of its tables."""
    return "family = " in text


COMMANDS = [line for path in (README, *PAGES) for line in commands(path)]


def skip_without_xfoil(path: Path) -> None:
    if path.stem == "polars" and shutil.which("xfoil") is None:
        pytest.skip("XFOIL is not installed: apt-get install xfoil")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with the files that the pages begin with."""
    monkeypatch.chdir(tmp_path)
    for name in EXAMPLES:
        (tmp_path / f"{name}.toml").write_text(example_text(name))
    (tmp_path / "rotor.csv").write_text(blocks(ROOT / "docs" / "design.md", "csv")[0])
    (tmp_path / "study.toml").write_text(blocks(ROOT / "docs" / "sweeps.md", "toml study")[0])
    (tmp_path / "search.toml").write_text(blocks(ROOT / "docs" / "searches.md", "toml search")[0])
    (tmp_path / "naca-23012.toml").write_text(blocks(ROOT / "docs" / "polars.md", "toml airfoil")[0])
    (tmp_path / "vane.cfg").write_text(blocks(ROOT / "docs" / "import.md", "ini")[0])
    return tmp_path


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory in which the README's build line ran, but for its installation."""
    directory = tmp_path_factory.mktemp("readme")
    steps = marked("build", "bash").split(" && ")
    assert steps[:2] == ["python3 -m venv .venv", ".venv/bin/pip install ."]
    home = Path(sys.executable).parent
    line = " && ".join(step.replace(".venv/bin/", f"{shlex.quote(str(home))}/") for step in steps[2:])
    subprocess.run(
        ["bash", "-c", line], cwd=directory, check=True, timeout=300, env={**os.environ, "MPLBACKEND": "Agg"}
    )
    return directory


@pytest.mark.parametrize("suffix", ["step", "igs"])
def test_the_build_line_makes_a_cad_file(built: Path, suffix: str) -> None:
    assert (built / "out" / f"fan-rotor.{suffix}").stat().st_size > 10_000


def test_the_build_line_proves_what_it_made(built: Path) -> None:
    reports = [json.loads(each.read_text()) for each in sorted((built / "out").glob("*.roundtrip.json"))]
    assert {each["format"] for each in reports} == {"STEP", "IGES"}
    assert all(each["passed"] for each in reports)


def test_the_readme_is_short_and_its_python_is_about_ten_lines() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 110
    assert len(marked("python", "python").splitlines()) <= 12


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=[pytest.mark.slow] if path.stem in LONG else [], id=name_of(path))
        for path in (README, *PAGES)
        if blocks(path, "python")
    ],
)
@pytest.mark.usefixtures("place")
def test_the_python_of_a_page_runs(path: Path) -> None:
    skip_without_xfoil(path)
    names: dict[str, object] = {}
    exec(compile("\n".join(blocks(path, "python")), name_of(path), "exec"), names)  # noqa: S102  our own pages
    for name in ("trip", "fit", "upper"):
        assert getattr(names.get(name), "passed", True)
    for name in ("slopes", "gradient"):
        values = names.get(name, {"": 1.0})
        assert np.isfinite([float(value) for value in values.values()]).all()
        assert any(values.values())


@pytest.mark.parametrize(
    ("path", "text"),
    [
        pytest.param(path, text, marks=[] if is_whole(text) else [pytest.mark.slow], id=f"{name_of(path)} {number}")
        for path in PAGES
        for number, text in enumerate(blocks(path, "toml"))
    ],
)
def test_a_design_file_of_a_page_builds_and_a_table_of_one_in_the_file_of_an_example(path: Path, text: str) -> None:
    given = tomllib.loads(text)
    document = given if is_whole(text) else tomllib.loads(example_text(COMPLETED_BY[next(iter(given))])) | given
    assert design_from(document, path.stem).build().properties.volume > 0.0


def test_the_design_file_that_is_explained_is_the_example() -> None:
    def settings(text: str) -> list[str]:
        return [line.partition("#")[0].strip() for line in text.splitlines()]

    assert settings(blocks(ROOT / "docs" / "design.md", "toml")[0]) == settings(example_text("fan-rotor"))


def test_every_command_line_is_one_that_the_program_takes() -> None:
    for line in COMMANDS:
        words = shlex.split(line)[1:]
        command = program.commands[words[0]]
        assert isinstance(command.make_context(words[0], words[1:]), click.Context)


def test_every_command_is_in_the_readme_and_on_a_page() -> None:
    named = set(re.findall(r"^\| `bladewright (\S+)` \|", README.read_text(encoding="utf-8"), re.MULTILINE))
    assert named == set(program.commands)
    assert {line.split()[1] for line in COMMANDS} == named


def _scan(place: Path) -> None:
    section = bw.read_design(place / "turbine-section.toml").build()
    random = np.random.default_rng(1)
    points = np.concatenate([curve(random.uniform(size=300)) for curve in section.curves.values()])
    np.savetxt(place / "scan.csv", 1e3 * points + random.normal(scale=0.02, size=points.shape), delimiter=",")


def _blade(place: Path) -> None:
    blade = bw.read_design(place / "compressor-stator.toml").build()
    u, v = (part.ravel() for part in np.meshgrid(np.linspace(0.0, 1.0, 60), np.linspace(0.0, 1.0, 15)))
    points = np.concatenate([blade.surfaces[name](u, v) for name in ("upper", "lower")])
    table = np.column_stack([np.arange(len(points)), 1e3 * points[:, ::-1]])
    np.savetxt(place / "blade.csv", table, delimiter=",")


def _moved(place: Path) -> None:
    from bladewright import cad

    blade = bw.read_design(place / "compressor-stator.toml").build()
    cad.write(blade, place / "moved.stl", chordal_deviation=1e-4)


def _start(place: Path) -> None:
    shutil.copy(place / "compressor-stator.toml", place / "stator.toml")


def _case(place: Path) -> None:
    if not TBLADE3.exists():
        pytest.skip("a case of T-Blade3 does not stand beside this tree")
    for path in TBLADE3.iterdir():
        shutil.copy(path, place)


def _adjoint(place: Path) -> None:
    points = bw.read_surface_points(place / "points.dat")
    rows = [[number, *row, 1.0, 0.0, 0.0] for number, row in zip(points.ids, points.points, strict=True)]
    names = "PointID,x,y,z,Sensitivity_x,Sensitivity_y,Sensitivity_z"
    lines = [",".join([str(row[0]), *map(repr, map(float, row[1:]))]) for row in rows]
    (place / "surface_sens.csv").write_text("\n".join([names, *lines, ""]))


INPUTS = {
    "scan.csv": _scan,
    "blade.csv": _blade,
    "moved.stl": _moved,
    "3dbgbinput.1.dat": _case,
    "surface_sens.csv": _adjoint,
}
"""files that a reader brings along, by their name, and what makes one"""


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in PAGES if commands(path)], ids=name_of)
def test_the_commands_of_a_page_run_one_after_another(path: Path, place: Path) -> None:
    skip_without_xfoil(path)
    if path.stem == "match":
        _start(place)
    for text in filter(is_whole, blocks(path, "toml")):
        (place / f"{tomllib.loads(text)['name']}.toml").write_text(text)
    for line in commands(path):
        for name, make in INPUTS.items():
            if name in line and not (place / name).exists():
                make(place)
        words = shlex.split(line)[1:]
        if words[0] == "new" and len(words) > 1:
            words.append("--force")
        run = subprocess.run(
            [sys.executable, "-m", "bladewright", *words], capture_output=True, text=True, timeout=900, check=False
        )
        assert run.returncode == 0, f"{line}\n{run.stdout}{run.stderr}"


def _anchors(path: Path) -> set[str]:
    heads = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_links_lead_somewhere() -> None:
    for path in TEXTS:
        for target in re.findall(r"\]\(([^)\s]+)\)", path.read_text(encoding="utf-8")):
            file, _, anchor = target.partition("#")
            if file.startswith(("http:", "https:")) or file in MADE_WITH_THE_SITE:
                continue
            found = path.parent / file if file else path
            assert found.exists(), f"{name_of(path)} links to {target}, which is not there"
            assert not anchor or anchor in _anchors(found), f"{name_of(path)}: {file} has no heading {anchor}"


def test_files_and_folders_that_are_named_exist() -> None:
    homes = [ROOT / each for each in ("src", "tests", "docs", "design", "examples", "benchmarks", "exports")]
    there = {f"/{path.relative_to(ROOT)}" + "/" * path.is_dir() for home in homes for path in [home, *home.rglob("*")]}
    gone = []
    for path in TEXTS:
        text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        named = set(re.findall(r"`((?:[\w.-]+/)*[\w.-]+\.pyi?|(?:[\w-]+/)+)(?:[ :][^`]*)?`", text)) - {"out/"}
        gone += [(name_of(path), each) for each in sorted(named) if not any(one.endswith(f"/{each}") for one in there)]
    assert not gone
