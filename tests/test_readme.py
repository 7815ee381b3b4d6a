"""The README's commands and its Python examples do what they say."""

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import click
import pytest

from bladewright.cli.program import program
from bladewright.files.examples import example_text

README = (Path(__file__).parents[1] / "README.md").read_text()


def block(mark: str, language: str) -> str:
    """The fenced text after `<!-- mark -->`."""
    found = re.search(rf"<!-- {mark} -->\n```{language}\n(.*?)```", README, re.DOTALL)
    assert found, f"README.md has no {language} block after <!-- {mark} -->"
    return found[1].strip()


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory in which the build line ran, but for its installation."""
    directory = tmp_path_factory.mktemp("readme")
    steps = block("build", "bash").split(" && ")
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


def test_the_python_examples_run_one_after_another(built: Path) -> None:
    blocks = re.findall(r"<!-- python -->\n```python\n(.*?)```", README, re.DOTALL)
    assert len(blocks) == 3
    (built / "turbine-section.toml").write_text(example_text("turbine-section"))
    run = subprocess.run(
        [
            sys.executable,
            "-c",
            "\n".join(blocks) + "\nassert trip.passed and fit.passed and upper.passed\nassert fit.maximum < 1e-4"
            "\nprint(gradient['stagger[1]'], slopes['stagger[0]'])",
        ],
        cwd=built,
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    assert run.stdout


@pytest.mark.parametrize("line", re.findall(r"^bladewright (.*)$", README, re.MULTILINE))
def test_every_command_line_is_one_that_the_program_takes(line: str) -> None:
    words = shlex.split(line)
    command = program.commands[words[0]]
    assert isinstance(command.make_context(words[0], words[1:]), click.Context)
