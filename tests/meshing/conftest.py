"""Two passages and their STEP files, each meshed coarsely once a session."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import bladewright as bw
from bladewright import cad, meshing
from bladewright.files.examples import example_text

COARSE = 0.3
"""of the chord"""


@dataclass(frozen=True, eq=False)
class Case:
    passage: Any
    step: Path

    def mesh(self, path: Path, **options: Any) -> Any:
        return meshing.mesh(self.step, path, passage=self.passage, **{"size": COARSE, **options})


@pytest.fixture(scope="session")
def gmsh():
    """gmsh, quiet and with no model; tests that need it are skipped where its library does not load."""
    try:
        import gmsh
    except (ImportError, OSError) as error:
        pytest.skip(f"gmsh does not load here: {error}")
    gmsh.initialize(interruptible=False, readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield gmsh
    gmsh.finalize()


def example(name: str, directory: Path) -> Any:
    path = directory / "design.toml"
    path.write_text(example_text(name))
    return bw.read_design(path)


def case(design: Any, directory: Path) -> Case:
    passage = bw.passage(design.build())
    step = directory / "passage.step"
    assert cad.write(passage, step, samples=200).passed
    return Case(passage, step)


@pytest.fixture(scope="session")
def cascade(tmp_path_factory) -> Case:
    """Between the vanes of a linear cascade."""
    directory = tmp_path_factory.mktemp("cascade")
    return case(bw.prismatic(example("turbine-section", directory)), directory)


@pytest.fixture(scope="session")
def rotor(tmp_path_factory) -> Case:
    """Between the blades of a rotor that do not touch the shroud."""
    directory = tmp_path_factory.mktemp("rotor")
    return case(example("mixed-flow-pump", directory).changed("tip_clearance", 1.0), directory)


@pytest.fixture(scope="session")
def cascade_as(request, cascade, tmp_path_factory):
    """By the ending of a file: the cascade's mesh in that format, and its report."""
    request.getfixturevalue("gmsh")
    directory = tmp_path_factory.mktemp("mesh")

    @cache
    def made(ending):
        path = directory / f"cascade{ending}"
        return path, cascade.mesh(path)

    return made


@pytest.fixture(params=[".msh", ".su2", pytest.param(".cgns", marks=pytest.mark.slow)])
def cascade_mesh(request, cascade_as):
    """The cascade's mesh in each format, and its report."""
    return cascade_as(request.param)


@pytest.fixture(scope="session")
def rotor_mesh(request, rotor, tmp_path_factory):
    """The rotor's mesh, and its report."""
    request.getfixturevalue("gmsh")
    path = tmp_path_factory.mktemp("mesh") / "rotor.msh"
    return path, rotor.mesh(path)
