"""gmsh in a process of its own, seen from outside: its steps, its output, its end."""

import importlib.util
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from bladewright.errors import MeshError
from bladewright.meshing.job import STEP, Answer, Job

WORKER = "bladewright.meshing.worker"
MISSING = (
    "gmsh is not installed, which meshes the passage: install it with pip install 'bladewright[mesh]', or give the "
    "STEP file of `bladewright build --body passage` to another mesher"
)
LAST = 12
"""lines of gmsh's output that an error quotes where gmsh ended without an answer"""

Listener = Callable[[str], object]
"""takes one line"""


def check_installed() -> None:
    """Raise MeshError where gmsh is not installed."""
    if importlib.util.find_spec("gmsh") is None:
        raise MeshError(MISSING)


def answered(job: Job, directory: Path, *, step: Listener, log: Listener) -> Answer:
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
                if line.startswith(STEP):
                    step(line.removeprefix(STEP).strip())
                else:
                    output.append(line.rstrip())
                    log(line.rstrip())
        except BaseException:
            process.kill()
            raise
    answer = (
        Answer.taken(directory) if Answer.path(directory).exists() else Answer(error=_ended(process.returncode, output))
    )
    if answer.error:
        error = MeshError(answer.error)
        error.add_note("\n".join(output))
        raise error
    return answer


def _ended(status: int, output: list[str]) -> str:
    how = f"was ended by signal {-status}" if status < 0 else f"ended with status {status}"
    words = " ".join(line for line in output[-LAST:] if line)
    return f"gmsh {how} before it had a mesh: choose another size, or more memory; its last words: {words or 'none'}"
