"""A small study: a 2D turbine section, which builds in a millisecond."""

from pathlib import Path

import pytest

from bladewright.files.examples import example_text

STUDY = """
design = "turbine-section.toml"

[variables]
stagger = { lower = -2, upper = 2, offset = true }
"thickness_upper*" = { lower = 0.9, upper = 1.1, relative = true, together = true }

[sweep]
samples = 8
quantities = ["area", "chord", "turning"]
"""


@pytest.fixture
def study_file(tmp_path: Path) -> Path:
    (tmp_path / "turbine-section.toml").write_text(example_text("turbine-section"))
    path = tmp_path / "vane-study.toml"
    path.write_text(STUDY)
    return path
