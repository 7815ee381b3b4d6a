"""What the package promises about itself before any geometry: light to import, every public name there, floors kept."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import bladewright

PACKAGE = Path(bladewright.__file__).parent
HEAVY = ("OCP", "cadquery", "gmsh", "matplotlib", "numba", "pydantic", "scipy")
SOURCES = sorted(PACKAGE.rglob("*.py"))


def loaded_by(statement: str) -> set[str]:
    """Top-level names of the modules in a fresh interpreter that has run the statement."""
    program = f"import sys\n{statement}\nprint(*sorted({{name.partition('.')[0] for name in sys.modules}}))"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=120)
    assert run.returncode == 0, run.stderr
    return set(run.stdout.split())


def module_name(source: Path) -> str:
    parts = source.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_importing_the_package_loads_no_heavy_library() -> None:
    assert not loaded_by("import bladewright").intersection(HEAVY)


def test_no_room_but_cad_and_the_command_line_loads_opencascade_and_none_loads_gmsh() -> None:
    rooms = [name for name in map(module_name, SOURCES) if name.split(".")[1:2] not in (["cad"], ["cli"], ["__main__"])]
    assert not loaded_by(f"import {', '.join(rooms)}").intersection({"OCP", "cadquery", "gmsh"})


def test_the_command_line_starts_without_opencascade() -> None:
    assert not loaded_by("import bladewright.cli").intersection({"OCP", "cadquery", "gmsh", "matplotlib"})


@pytest.mark.parametrize("name", bladewright.__all__)
def test_every_public_name_is_there(name: str) -> None:
    assert getattr(bladewright, name) is not None
    assert name in dir(bladewright)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="attribute blade_wright"):
        _ = bladewright.blade_wright


def test_type_checkers_see_the_public_names() -> None:
    tree = ast.parse((PACKAGE / "__init__.pyi").read_text())
    seen = {alias.asname for line in tree.body if isinstance(line, ast.ImportFrom) for alias in line.names}
    assert seen == set(bladewright.__all__) - {"__version__"}


@pytest.mark.parametrize("source", SOURCES, ids=module_name)
def test_a_file_holds_one_idea(source: Path) -> None:
    assert len(source.read_text().splitlines()) <= 400
