"""The notebooks in docs/ run as their page says, and are kept small."""

import ast
import json
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"
NOTEBOOKS = sorted(DOCS.glob("notebooks/*.ipynb"))
SHOWN = {
    "first-blade": ("data-scene", "at stations along the span", "image/png"),
    "files-and-passage": ("data-scene", "flow passage", "round trip, passed", "round trip, FAILED"),
    "derivatives-and-matching": ("fit, passed", "maximum thickness", "image/png"),
}
"""what the outputs of each hold"""


def cells(path):
    return json.loads(path.read_text())["cells"]


def test_there_are_the_notebooks_that_the_page_lists():
    page = (DOCS / "notebooks.md").read_text()
    assert {path.stem for path in NOTEBOOKS} == set(SHOWN) == set(re.findall(r"\(notebooks/(.*?)\.ipynb\)", page))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs(path):
    assert path.stat().st_size < 10_000
    code = [cell for cell in cells(path) if cell["cell_type"] == "code"]
    assert code
    assert all(not cell["outputs"] and cell["execution_count"] is None for cell in code)
    for cell in code:
        ast.parse("".join(cell["source"]))


@pytest.mark.slow
@pytest.mark.skipif(find_spec("nbconvert") is None or find_spec("ipykernel") is None, reason="bladewright[notebook]")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_by_the_command_of_its_page(path, tmp_path):
    line = next(line for line in (DOCS / "notebooks.md").read_text().splitlines() if line.startswith("jupyter "))
    words = shlex.split(
        line.replace("docs/notebooks/*.ipynb", shlex.quote(str(path))).replace("--to html", "--to notebook")
    )
    assert words[:2] == ["jupyter", "nbconvert"]
    run = [sys.executable, "-m", *words]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stderr
    outputs = [each for cell in cells(tmp_path / "out" / path.name) for each in cell.get("outputs", ())]
    text = json.dumps(outputs)
    assert not [word for word in SHOWN[path.stem] if word not in text]
