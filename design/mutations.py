"""Whether tests see faults: each room's code is broken in one place of a copy of the tree, and its tests must fail.

    python design/mutations.py [--tree DIRECTORY] [--only ROOM ...] [--record design/mutations.md]

`--tree` names another state of the project. Where a file has another name there, the one file that holds the text is
taken, and of the tests named those that are there. Exit status 1 where a fault is not seen.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

HOME = Path(__file__).parents[1]
COPIED = ("src", "tests", "design", "examples", "pyproject.toml", "README.md")


@dataclass(frozen=True)
class Mutation:
    """A fault: its room, what it does, the file below src/bladewright, the text and what takes its place."""

    room: str
    says: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]


MUTATIONS = (
    Mutation(
        "numerics",
        "the derivative of a root has the wrong sign",
        "numerics/roots.py",
        "root - 1j * np.imag(value)",
        "root + 1j * np.imag(value)",
        ("tests/numerics/test_roots.py",),
    ),
    Mutation(
        "nurbs",
        "the volume of a solid is a thousandth too small",
        "nurbs/mass_properties.py",
        "flux.sum(axis=-1, keepdims=True) / 3.0",
        "flux.sum(axis=-1, keepdims=True) / 3.003",
        ("tests/nurbs/test_mass_properties.py",),
    ),
    Mutation(
        "section",
        "the nose of a modified NACA profile is a third of a per cent blunter",
        "section/thickness/modified_naca.py",
        "RADIUS = 2.2038",
        "RADIUS = 2.2110",
        ("tests/section/test_smoothness.py", "tests/section/thickness"),
    ),
    Mutation(
        "section",
        "the second derivatives of native curves and sides at an edge are a fifth too small",
        "section/native.py",
        "(near / (DEGREE * (DEGREE - 1)))",
        "(near / (DEGREE * DEGREE))",
        ("tests/test_convergence.py", "tests/section/test_native.py"),
    ),
    Mutation(
        "blade",
        "true sweep leans a section to the wrong side",
        "blade/exact/sweep_lean.py",
        "along * turned[1] + across",
        "-along * turned[1] + across",
        ("tests/blade/test_stacking.py",),
    ),
    Mutation(
        "domain",
        "cross-lines of a passage's walls lean to the wrong side at an edge",
        "domain/walls.py",
        "- outwards * sign * sine)",
        "+ outwards * sign * sine)",
        ("tests/domain/test_sectioned.py", "tests/domain/test_passage.py"),
    ),
    Mutation(
        "derivatives",
        "the rates of a blade's nets are a ten-thousandth too large",
        "derivatives/complex_step.py",
        "np.imag(rows) / STEP, (count",
        "1.0001 * np.imag(rows) / STEP, (count",
        ("tests/derivatives/test_jacobian.py",),
    ),
    Mutation(
        "cad",
        "an edge that only one face has is not counted as free",
        "cad/closure.py",
        "free += forward + backward < 2",
        "free += forward + backward < 1",
        ("tests/cad/test_catches.py::test_a_missing_face",),
    ),
    Mutation(
        "nurbs",
        "a point left of any two crossings of a boundary counts as inside",
        "nurbs/trim_loop.py",
        "minlength=len(u)) % 2 == 1",
        "minlength=len(u)) > 0",
        ("tests/nurbs/test_trimmed.py",),
    ),
    Mutation(
        "blade",
        "the arcs of a fillet are a millionth too small",
        "blade/native/cross_section.py",
        "return found if order else middle + found",
        "return found if order else middle + (1.0 - 1e-6) * found",
        ("tests/blade/test_fillets.py::test_a_fillet_of_constant_radius_lies_on_the_ball",),
    ),
    Mutation(
        "blade",
        "the rate of a crossing of a cut has the wrong sign",
        "blade/native/cut_lines.py",
        "place - 1j * np.imag(steps.place)",
        "place + 1j * np.imag(steps.place)",
        ("tests/blade/test_cuts.py::test_the_volume_falls_with_the_face_of_a_trim",),
    ),
    Mutation(
        "domain",
        "the volume under the outline of a disc is a millionth too small",
        "domain/disc.py",
        "np.pi * np.sum(weights * curve(t)[:, 1] ** 2",
        "(1.0 - 1e-6) * np.pi * np.sum(weights * curve(t)[:, 1] ** 2",
        ("tests/domain/test_wheel.py::test_a_wheel_is_its_sectors_and_both_are_the_ring_and_the_blades",),
    ),
    Mutation(
        "cad",
        "the nearest vertex of a boundary is taken for the nearest place of it",
        "cad/region.py",
        "doubtful = np.flatnonzero(distance > limit)\n        if len(doubtful):\n            uv[doubtful], distance",
        "doubtful = np.flatnonzero(distance < 0.0)\n        if len(doubtful):\n            uv[doubtful], distance",
        ("tests/cad/test_region.py",),
    ),
    Mutation(
        "files",
        "numbers of a binary STL file are read in the other byte order",
        "files/clouds/stl.py",
        '("corners", "<f4", (3, 3))',
        '("corners", ">f4", (3, 3))',
        ("tests/files/test_clouds.py",),
    ),
    Mutation(
        "fitting",
        "the noise of a cloud is the median of its deviations, not its standard deviation",
        "numerics/robust.py",
        "DEVIATION_OVER_MEDIAN = 1.4826",
        "DEVIATION_OVER_MEDIAN = 1.0",
        ("tests/fitting/test_noise.py",),
    ),
    Mutation(
        "meshing",
        "the quality of a tetrahedron is a thirtieth too small",
        "meshing/quality.py",
        "3.0 * determinant /",
        "2.9 * determinant /",
        ("tests/meshing/test_quality.py",),
    ),
    Mutation(
        "views",
        "the neighbour of a linear cascade is drawn at half the pitch",
        "views/sections.py",
        "return design.pitch *",
        "return 0.5 * design.pitch *",
        ("tests/views/test_drawn_geometry.py",),
    ),
    Mutation(
        "cli",
        "a check that fails ends with status 0",
        "cli/outcome.py",
        "return 1 if outcome.failures else 0",
        "return 0",
        ("tests/cli/test_build_and_verify.py::test_a_check_that_fails_gives_status_one_and_the_files_stay",),
    ),
)


def place_of(mutation: Mutation, package: Path) -> Path:
    """The file of the tree that holds the text."""
    named = package / mutation.file
    if named.is_file() and mutation.old in named.read_text():
        return named
    room = package / mutation.file.partition("/")[0]
    (found,) = (each for each in room.rglob("*.py") if mutation.old in each.read_text())
    return found


def failures(mutation: Mutation, tree: Path) -> list[str]:
    """The tests that fail where the tree has the fault, up to the first; none where it is not seen."""
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "tree"
        copy.mkdir()
        for name in COPIED:
            source = tree / name
            (shutil.copytree if source.is_dir() else shutil.copy)(source, copy / name)
        shared = tree.parent / "shared"
        if shared.is_dir():
            (Path(scratch) / "shared").symlink_to(shared.resolve())
        file = place_of(mutation, copy / "src" / "bladewright")
        file.write_text(file.read_text().replace(mutation.old, mutation.new, 1))
        tests = [name for name in mutation.tests if (copy / name.partition("::")[0]).exists()]
        run = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests],
            cwd=copy,
            env={**os.environ, "PYTHONPATH": str(copy / "src"), "OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg"},
            capture_output=True,
            text=True,
            check=False,
        )
    return re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", run.stdout, re.MULTILINE)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tree", type=Path, default=HOME, help="state of the project to break (default: this one)")
    parser.add_argument("--only", nargs="*", help="rooms")
    parser.add_argument("--record", type=Path, help="Markdown file for the result")
    asked = parser.parse_args()
    rows = []
    for mutation in MUTATIONS:
        if asked.only and mutation.room not in asked.only:
            continue
        found = failures(mutation, asked.tree.resolve())
        rows.append((mutation, found))
        print(f"{mutation.room}: {found[0] if found else 'NOT SEEN'}", flush=True)
    if asked.record:
        lines = ["# Faults that the tests see", "", "`python design/mutations.py --record design/mutations.md`", ""]
        lines += ["| room | fault | first test that fails |", "|---|---|---|"]
        lines += [f"| {each.room} | {each.says} | `{found[0] if found else 'none'}` |" for each, found in rows]
        asked.record.write_text("\n".join(lines) + "\n")
    return 0 if all(found for _, found in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
