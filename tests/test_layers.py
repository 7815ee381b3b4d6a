"""What the package promises about itself before any geometry: light to import, every public name there, floors kept."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

import bladewright
from bladewright.designs import Design
from bladewright.files.families import FAMILIES as IN_FILES

PACKAGE = Path(bladewright.__file__).parent
EXTRAS = {"gmsh", "neuralfoil", "aerosandbox", "pymoo", "openmdao", "distributed", "dask", "cloudpickle"}
"""what the package is installed without, unless an extra is asked for"""
HEAVY = ("OCP", "cadquery", "gmsh", "matplotlib", "numba", "pydantic", "scipy")
SOURCES = sorted(PACKAGE.rglob("*.py"))


def loaded_by(*statements: str) -> list[set[str]]:
    """Top-level names of the modules in a fresh interpreter after each of the statements."""
    told = "print(*sorted({name.partition('.')[0] for name in sys.modules}))"
    program = "\n".join(["import sys", *(line for each in statements for line in (each, told))])
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=120)
    assert run.returncode == 0, run.stderr
    return [set(line.split()) for line in run.stdout.splitlines()]


def module_name(source: Path) -> str:
    parts = source.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_neither_package_nor_command_line_loads_a_heavy_library_when_imported_and_openmdao_s_room_no_kernel() -> None:
    package, line, openmdao = loaded_by(
        "import bladewright", "import bladewright.cli", "import bladewright.studies.openmdao"
    )
    assert not package.intersection(HEAVY)
    assert not line.intersection({"OCP", "cadquery", "gmsh", "matplotlib"})
    assert not openmdao.intersection({"OCP", "cadquery", "gmsh"})


def test_no_room_but_cad_and_the_command_line_loads_opencascade_and_none_an_extra_before_it_is_asked_for() -> None:
    # OpenMDAO's component is a class of its library, and stands in a module of its own
    own = ("bladewright.__main__", "bladewright.studies.openmdao")
    rooms = [name for name in map(module_name, SOURCES) if name not in own]
    kernel = [name for name in rooms if name.split(".")[1:2] in (["cad"], ["cli"])]
    others = [name for name in rooms if name not in kernel]
    first, every = loaded_by(f"import {', '.join(others)}", f"import {', '.join(kernel)}")
    assert not first.intersection({"OCP", "cadquery", "gmsh"})
    assert "OCP" in every
    assert not every.intersection(EXTRAS)


def test_every_public_name_is_there() -> None:
    listed = dir(bladewright)
    missing = [name for name in bladewright.__all__ if getattr(bladewright, name, None) is None or name not in listed]
    assert not missing, missing


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="attribute blade_wright"):
        _ = bladewright.blade_wright


def test_type_checkers_see_the_public_names() -> None:
    tree = ast.parse((PACKAGE / "__init__.pyi").read_text())
    seen = {alias.asname for line in tree.body if isinstance(line, ast.ImportFrom) for alias in line.names}
    assert seen == set(bladewright.__all__) - {"__version__"}


def test_a_file_holds_one_idea() -> None:
    lengths = {module_name(source): len(source.read_text().splitlines()) for source in SOURCES}
    longer = {name: length for name, length in lengths.items() if length > 400}
    assert not longer, longer


parsed = cache(ast.parse)


def imported(name: str, text: str, known: set[str]) -> Iterator[str]:
    """The known modules that a module imports anywhere, also inside functions, but for those that only types need."""
    tree = parsed(text)
    nodes = list(ast.walk(tree))
    checks = [each for each in nodes if isinstance(each, ast.If) and getattr(each.test, "id", "") == "TYPE_CHECKING"]
    skipped = {id(inner) for check in checks for line in check.body for inner in ast.walk(line)}
    for node in nodes:
        if id(node) in skipped:
            continue
        targets = []
        if isinstance(node, ast.Import):
            targets = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            targets = [str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names)]
        yield from (target for target in targets if target in known and target != name)


def circles(texts: dict[str, str]) -> list[list[str]]:
    """Modules that import each other in a circle, late imports included: strongly connected components."""
    names = sorted(texts)
    graph = np.zeros((len(names), len(names)), dtype=bool)
    for row, name in enumerate(names):
        graph[row, [names.index(target) for target in imported(name, texts[name], set(names))]] = True
    count, part = connected_components(graph, connection="strong")
    parts = [[name for name, number in zip(names, part, strict=True) if number == each] for each in range(count)]
    return [members for members in parts if len(members) > 1]


def test_no_modules_import_each_other_in_a_circle() -> None:
    found = circles({module_name(source): source.read_text() for source in SOURCES})
    assert not found, "\n".join(map(", ".join, found))


def test_a_circle_is_seen_though_its_imports_are_late() -> None:
    texts = {
        "house.one": "from house.two import door\n",
        "house.two": "def open():\n    import house.three\n",
        "house.three": "class Window:\n    def look(self):\n        from house import one\n",
        "house.four": "import house.one\n",
        "house.five": "if TYPE_CHECKING:\n    from house.six import wall\n",
        "house.six": "import house.five\n",
    }
    assert circles(texts) == [["house.one", "house.three", "house.two"]]


FOREIGN = {"cad", "cli", "files", "atomic_write.py"}
"""what asks the objects of other libraries, and of results that it prints, for what they have"""


def final_designs(kind: type) -> set[str]:
    """Names of the classes under a class that have none under them."""
    below = kind.__subclasses__()
    return set().union(*map(final_designs, below)) if below else {kind.__name__}


def kinds_asked(text: str, kinds: set[str], *, attributes: bool) -> Iterator[str]:
    """Calls that ask an object for one of the kinds, or for whether it has an attribute."""
    for node in ast.walk(parsed(text)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            named = {each.id for part in node.args[1:] for each in ast.walk(part) if isinstance(each, ast.Name)}
            if (node.func.id == "isinstance" and named & kinds) or (node.func.id == "hasattr" and attributes):
                yield f"line {node.lineno}: {ast.unparse(node)}"


def test_designs_answer_for_themselves_and_are_not_asked_for_their_kind() -> None:
    # fitting searches in the unified family and in the others by different ways, and does ask
    kinds, found = final_designs(Design), []
    assert kinds >= {kind.__name__ for kind in IN_FILES.values()}
    for source in SOURCES:
        room = source.relative_to(PACKAGE).parts[0]
        asked = kinds_asked(source.read_text(), set() if room == "fitting" else kinds, attributes=room not in FOREIGN)
        found += [f"{module_name(source)}, {each}" for each in asked]
    assert not found, "\n".join(found)


def test_asking_a_design_for_its_kind_is_seen() -> None:
    text = "if isinstance(design, UnifiedBlade | Other) or hasattr(built, 'camber') or isinstance(design, Design): pass"
    assert len(list(kinds_asked(text, {"UnifiedBlade"}, attributes=True))) == 2
