"""gmsh in a process of its own: the job it is given, the answer it leaves, its steps and output on the way."""

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
"""name of the file beside them that holds what the mesh file holds"""
STEP_PREFIX = "@step "
"""what a line of the process's output begins with that says what it does"""


class Message:
    """A frozen record in a file that bears its type's name."""

    @classmethod
    def path(cls, directory: Path) -> Path:
        """The file in a directory."""
        return directory / f"{cls.__name__.lower()}.json"

    def put(self, directory: Path) -> None:
        """Write the record into a directory."""
        self.path(directory).write_bytes(TypeAdapter(type(self)).dump_json(self))

    @classmethod
    def taken(cls, directory: Path) -> Self:
        """The record in a directory."""
        return TypeAdapter(cls).validate_json(cls.path(directory).read_bytes())


@dataclass(frozen=True, kw_only=True)
class SizeSource:
    """A curve or face that sizes grow away from."""

    face: str
    """name of the face; empty for a curve"""
    place: tuple[float, float, float]
    """middle of the curve [mm]"""
    size: float
    """[mm]"""


@dataclass(frozen=True, kw_only=True)
class Job(Message):
    """A mesh to make."""

    step: str
    """the STEP file, in millimetres"""
    faces: tuple[str, ...]
    """names of its faces, in the order of the shell"""
    motion: tuple[float, ...]
    """(16,) affine matrix from the lower to the upper periodic boundary, by rows [mm]"""
    largest: float
    """[mm]"""
    smallest: float
    """[mm]"""
    growth: float
    """[-]"""
    near: tuple[SizeSource, ...]
    mesh: str
    """the file to write"""
    scale: float
    """of its unit in a millimetre"""


@dataclass(frozen=True, kw_only=True)
class Answer(Message):
    """How a mesh was made."""

    error: str = ""
    """why there is none"""
    gmsh: str = ""
    """version"""
    surface: tuple[str, ...] = ()
    """what meshed the faces"""
    volume: tuple[str, ...] = ()
    """what meshed the volume and improved it"""
    nodes: int = 0
    """that the mesh had before it was written"""
    tetrahedra: int = 0


WORKER = "bladewright.meshing.worker"
MISSING = (
    "gmsh is not installed, which meshes the passage: install it with pip install 'bladewright[mesh]', or give the "
    "STEP file of `bladewright build --body passage` to another mesher"
)
QUOTED_LINES = 12
"""lines of gmsh's output that an error quotes where gmsh ended without an answer"""

Listener = Callable[[str], object]
"""takes one line"""


def check_installed() -> None:
    """Raise MeshError where gmsh is not installed."""
    if importlib.util.find_spec("gmsh") is None:
        raise MeshError(MISSING)


def run_gmsh(job: Job, directory: Path, *, step: Listener, log: Listener) -> Answer:
    """The answer of a process that was given a job in a directory; `step` hears what it does, `log` what gmsh prints.

    The process ends with this call, however that ends. Raises MeshError, with gmsh's output as a note, where there is
    no mesh.
    """
    job.put(directory)
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
    answer = (
        Answer.taken(directory)
        if Answer.path(directory).exists()
        else Answer(error=_failure(process.returncode, output))
    )
    if answer.error:
        error = MeshError(answer.error)
        error.add_note("\n".join(output))
        raise error
    return answer


def _failure(status: int, output: list[str]) -> str:
    how = f"was ended by signal {-status}" if status < 0 else f"ended with status {status}"
    words = " ".join(line for line in output[-QUOTED_LINES:] if line)
    return f"gmsh {how} before it had a mesh: choose another size, or more memory; its last words: {words or 'none'}"
