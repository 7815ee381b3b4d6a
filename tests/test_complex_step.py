"""Floors 0 to 4 carry an imaginary step: what would drop it silently does not occur there.

A use that is right because its value is real by nature says so on its line: `# real: <reason>`.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import bladewright

PACKAGE = Path(bladewright.__file__).parent
FLOORS = ("numerics", "nurbs", "section", "blade", "domain", "derivatives")
SAFE_FORMS = PACKAGE / "numerics" / "elementary.py"
"""the one file that may use them: it builds the analytic forms"""

METHODS = {"conj", "conjugate"}
FUNCTIONS = METHODS | {
    "abs", "absolute", "fabs", "sign", "angle", "vdot", "arctan2", "hypot",
    "norm", "lstsq", "qr", "cholesky", "cho_factor", "svd", "pinv", "eigh", "matrix_rank",
}  # fmt: skip
LIBRARIES = {"np", "numpy", "scipy", "linalg"}
REASON = re.compile(r"#\s*real:\s*\S+")


def root(node: ast.expr) -> str:
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def is_hazard(node: ast.AST) -> bool:
    match node:
        case ast.Call(func=ast.Name(id="abs")):
            return True
        case ast.Call(func=ast.Attribute(attr=name)) if name in METHODS:
            return True
        case ast.Attribute(attr=name) if name in FUNCTIONS:
            return root(node) in LIBRARIES
        case ast.ImportFrom(module=str(module), names=names):
            return root(ast.parse(module, mode="eval").body) in LIBRARIES and any(a.name in FUNCTIONS for a in names)
    return False


def hazards(text: str) -> Iterator[str]:
    """Lines that would drop an imaginary part and give no reason."""
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        if is_hazard(node) and not any(REASON.search(line) for line in lines[node.lineno - 1 : node.end_lineno]):
            yield f"line {node.lineno}: {lines[node.lineno - 1].strip()}"


def test_no_file_of_floors_0_to_4_drops_an_imaginary_part() -> None:
    sources = [each for floor in FLOORS for each in sorted((PACKAGE / floor).rglob("*.py")) if each != SAFE_FORMS]
    assert len(sources) > 100
    found = [f"{each.relative_to(PACKAGE)}, {hazard}" for each in sources for hazard in hazards(each.read_text())]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "line",
    [
        "abs(x)",
        "np.abs(x)",
        "np.linalg.norm(x, axis=-1)",
        "scipy.linalg.lstsq(a, b)",
        "linalg.qr(a)",
        "x.conj()",
        "(a @ b).conjugate()",
        "np.arctan2(y, x)",
        "sorted(x, key=np.abs)",
        "from numpy import hypot",
        "from numpy.linalg import norm",
        "np.abs(x)  # real:",
        "np.abs(x)  # a remark without the marker",
    ],
)
def test_the_check_sees(line: str) -> None:
    assert list(hazards(line))


@pytest.mark.parametrize(
    "line",
    ["np.abs(x)  # real: knots are", "np.sqrt(x * x)", "magnitude(x)", "surface.norm(x)", "from scipy import linalg"],
)
def test_the_check_passes(line: str) -> None:
    assert not list(hazards(line))
