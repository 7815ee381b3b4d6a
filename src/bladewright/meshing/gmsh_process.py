"""gmsh in a process of its own: its job and its answer as files in one directory, its steps and output on the way."""

import importlib.util
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from pydantic import TypeAdapter

from bladewright.errors import MeshError

CONTENT_FILE = "arrays.npz"
"""Name of the file in which the process leaves the content of the mesh file."""
STEP_PREFIX = "@step "
"""Beginning of the lines of output in which the process names its step."""
WORKER = "bladewright.meshing.worker"
"""The module that is run in the process."""
MISSING = (
    "gmsh is not installed, which meshes the passage: install it with pip install 'bladewright[mesh]', or give the "
    "STEP file of `bladewright build --body passage` to another mesher"
)
"""The message where gmsh is not installed."""
QUOTED_LINES = 12
"""Last lines of gmsh's output that an error quotes where the process ended without an answer: enough for gmsh's own
error and the steps before it, and still one paragraph."""
Listener = Callable[[str], object]
"""Is called with one line of text."""


class Message:
    """A frozen record, kept in a JSON file that is named after its type."""

    @classmethod
    def path(cls, directory: Path) -> Path:
        """The path of the record in a directory."""
        return directory / f"{cls.__name__.lower()}.json"

    def write(self, directory: Path) -> None:
        """Write the record into a directory."""
        self.path(directory).write_bytes(TypeAdapter(type(self)).dump_json(self))

    @classmethod
    def read(cls, directory: Path) -> Self:
        """Read the record from a directory."""
        return TypeAdapter(cls).validate_json(cls.path(directory).read_bytes())


@dataclass(frozen=True, kw_only=True)
class SizeSource:
    """A curve or face from which element sizes grow."""

    face: str
    """name of the face; empty for a curve"""
    place: tuple[float, float, float]
    """middle of the curve [mm]"""
    size: float
    """size of the elements there [mm]"""


@dataclass(frozen=True, kw_only=True)
class Job(Message):
    """A mesh that gmsh is to make."""

    step: str
    """the STEP file, in millimetres"""
    faces: tuple[str, ...]
    """names of its faces in the order of the shell"""
    motion: tuple[float, ...]
    """(16,) affine matrix from the lower to the upper periodic boundary, row by row [mm]"""
    largest: float
    """size of the elements far from every source [mm]"""
    smallest: float
    """smallest size [mm]"""
    growth: float
    """increase of the size over the distance from a source [-]"""
    sources: tuple[SizeSource, ...]
    mesh: str
    """the file to write"""
    scale: float
    """the millimetre in the unit of that file"""


@dataclass(frozen=True, kw_only=True)
class Answer(Message):
    """How gmsh made a mesh, or why it did not."""

    error: str = ""
    """why there is no mesh; empty where there is one"""
    gmsh: str = ""
    """version of gmsh"""
    surface: tuple[str, ...] = ()
    """algorithms that meshed the faces"""
    volume: tuple[str, ...] = ()
    """algorithms that meshed and improved the volume"""
    nodes: int = 0
    """nodes before the file was written"""
    tetrahedra: int = 0
    """tetrahedra before the file was written"""


def check_installed() -> None:
    """Raise MeshError where gmsh is not installed."""
    if importlib.util.find_spec("gmsh") is None:
        raise MeshError(MISSING)


def run_gmsh(job: Job, directory: Path, *, step: Listener, log: Listener) -> Answer:
    """Run gmsh on a job in a process of its own, and return its answer.

    `step` is called with the name of each step, `log` with each line that gmsh prints. The process ends with this
    call, however the call ends. Raises MeshError, with gmsh's output as a note, where there is no mesh.
    """
    job.write(directory)
    output: list[str] = []
    with subprocess.Popen(  # noqa: S603  it is this Python, and a module of our own
        [sys.executable, "-m", WORKER, str(directory)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    ) as process:
        try:
            for line in process.stdout or ():
                if line.startswith(STEP_PREFIX):
                    step(line.removeprefix(STEP_PREFIX).strip())
                else:
                    output.append(line.rstrip())
                    log(line.rstrip())
        except BaseException:
            process.kill()
            raise
    if Answer.path(directory).exists():
        answer = Answer.read(directory)
    else:
        answer = Answer(error=_failure(process.returncode, output))
    if answer.error:
        error = MeshError(answer.error)
        error.add_note("\n".join(output))
        raise error
    return answer


def _failure(status: int, output: list[str]) -> str:
    """The message for a process that ended without an answer."""
    how = f"was ended by signal {-status}" if status < 0 else f"ended with status {status}"
    words = " ".join(line for line in output[-QUOTED_LINES:] if line)
    return f"gmsh {how} before it had a mesh: choose another size, or more memory; its last words: {words or 'none'}"
