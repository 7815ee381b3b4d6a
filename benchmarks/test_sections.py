"""Blades from sections: a row, and a compressor's thirteen, from design files to verified STEP files."""

import subprocess
import sys
import time
from pathlib import Path

from bladewright.files.writing import write_design

sys.path.insert(0, str(Path(__file__).parent))
from compressor_rows import rows


def test_a_row_to_a_verified_step_file(benchmark, tmp_path):
    from bladewright import cad

    design = rows()[1]
    numbers = sum(path.startswith("section.") for path in design.parameters())

    def made():
        assert cad.write(design.build(), tmp_path / "row.step").passed

    benchmark.pedantic(made, rounds=4, warmup_rounds=1)
    best = benchmark.stats.stats.min
    print(f"\na row of {numbers} numbers in its sections to a verified STEP file: {best:.2f} s, to reach 1.5 s")
    assert best <= 1.5


def test_thirteen_rows_to_verified_step_files(tmp_path):
    designs = rows()
    for design in designs:
        write_design(design, tmp_path / f"{design.name}.toml")
    numbers = sum(len(design.parameters()) for design in designs)
    files = [str(tmp_path / f"{design.name}.toml") for design in designs]
    before = time.perf_counter()
    words = ["build", *files, "--as", "step", "-o", str(tmp_path / "made"), "--quiet", "--jobs", "2"]
    subprocess.run([sys.executable, "-m", "bladewright", *words], check=True)
    seconds = time.perf_counter() - before
    print(f"\n{len(designs)} rows of {numbers} numbers in all: {seconds:.1f} s from files to files, to reach 15 s")
    assert len(list((tmp_path / "made").glob("*.step"))) == len(designs)
    assert seconds <= 15.0
