"""Running the program in this process, as its entry point does."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from bladewright.cli import main
from bladewright.files.examples import example_text


@pytest.fixture(autouse=True, scope="module")
def few_samples():
    """Round trips in this process measure fewer points: how well they measure is asked in the tests of cad."""
    from bladewright import cad

    with pytest.MonkeyPatch.context() as patch:
        for door in (cad.write, cad.verify):
            patch.setitem(door.__kwdefaults__, "samples", 100)
        yield


@dataclass(frozen=True)
class Run:
    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Callable[..., Run]:
    """Calls the program with words, and gives its exit status and what it printed, also from native code."""

    def call(*words: object) -> Run:
        capfd.readouterr()
        status = main([str(word) for word in words])
        out, err = capfd.readouterr()
        return Run(status, out, err)

    return call


@pytest.fixture
def design_file(tmp_path: Path) -> Path:
    path = tmp_path / "fan-rotor.toml"
    path.write_text(example_text("fan-rotor"))
    return path


@pytest.fixture
def vane_file(tmp_path: Path) -> Path:
    """A prismatic vane, which builds faster than a blade in an annulus."""
    path = tmp_path / "vane.toml"
    path.write_text((Path(__file__).parent / "vane.toml").read_text())
    return path
