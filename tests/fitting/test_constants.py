"""Whether a constant of matching that cites a page of `design/` is named there."""

import ast
import re
from itertools import pairwise
from pathlib import Path

import pytest

import bladewright

HOME = Path(bladewright.__file__).parents[2]
ROOM = Path(bladewright.__file__).parent / "fitting"
MEASURED = ("matching.md", "matching_constants.md")
"""pages that measure matching: either may name what the other measures"""


def cited(path: Path) -> list[tuple[str, set[str]]]:
    """The constants of a file that cite pages of design/, with these."""
    body, found = ast.parse(path.read_text(encoding="utf-8")).body, []
    for here, after in pairwise(body):
        text = after.value.value if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) else ""
        pages = set(re.findall(r"design/(\w+\.(?:md|py))", str(text)))
        if isinstance(here, ast.Assign) and pages:
            names = [node.id for target in here.targets for node in ast.walk(target) if isinstance(node, ast.Name)]
            found += [(name, pages) for name in names]
    return found


def unnamed(constants: list[tuple[str, set[str]]], design: Path) -> list[str]:
    """Those that no page which they cite names."""
    text = {page.name: page.read_text(encoding="utf-8") for page in design.iterdir() if page.suffix in {".md", ".py"}}
    return [
        name
        for name, pages in constants
        if not any(
            re.search(rf"\b{name}\b", text.get(page, ""))
            for page in (pages | set(MEASURED) if pages & set(MEASURED) else pages)
        )
    ]


@pytest.mark.parametrize("path", sorted(ROOM.rglob("*.py")), ids=lambda path: str(path.relative_to(ROOM)))
def test_a_constant_is_named_on_a_page_that_it_cites(path):
    if not (HOME / "design").is_dir():
        pytest.skip("the repository's design/ is not beside this installation")
    assert unnamed(cited(path), HOME / "design") == []


def test_a_constant_that_its_page_does_not_name_is_told(tmp_path):
    module, design = tmp_path / "room.py", tmp_path / "design"
    design.mkdir()
    (design / "matching.md").write_text("`NAMED` is measured", encoding="utf-8")
    module.write_text('NAMED = 1\n"""design/matching.md"""\nOTHER = 2\n"""design/matching.md"""\n', encoding="utf-8")
    assert unnamed(cited(module), design) == ["OTHER"]
