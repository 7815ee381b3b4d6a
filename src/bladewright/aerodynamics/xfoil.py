"""XFOIL (Drela 1989, version 6.99) in a process and a scratch folder of its own: angles in, converged points out."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from time import monotonic

from bladewright.aerodynamics import untrapped
from bladewright.aerodynamics.airfoil import Airfoil
from bladewright.aerodynamics.conditions import PANELS, Conditions
from bladewright.aerodynamics.xfoil_output import ConvergedPoint, read_polar_dump
from bladewright.errors import PolarError

VARIABLE = "BLADEWRIGHT_XFOIL"
"""The environment variable that names the program, where it is not the `xfoil` of the search path."""
FINER = 1.25
"""panels of the second attempt, over those of the first: where a common airfoil does not converge with 160 it mostly
does with 200, while more iterations or steps from other angles seldom help (design/polar_solvers.py)"""
HANGING, PER_ANGLE = 0.05, 0.5
"""[s] Time for each of the iterations that an angle may take, and for each angle, after which XFOIL hangs: alone on a
processor it needs 0.0025 for an iteration with 160 panels and 0.01 with 400, and 0.04 for an angle that converges"""
SAME = 1e-6
"""deg within which an angle of the output is the one that was asked for"""
TRAPPED = (-signal.SIGFPE, 128 + signal.SIGFPE)
"""Statuses of a program that stopped at a floating-point trap, and of a shell that started one."""
WORDS = 30
"""Last words of XFOIL's output that an error quotes: enough for Fortran's own error, and still one paragraph."""
MISSING = (
    f"XFOIL is not installed, which makes the polar: install it (apt-get install xfoil), name the program by "
    f"{VARIABLE}, or ask for the neural network with solver='neuralfoil' (--with neuralfoil)"
)
"""The message where there is no XFOIL."""


def xfoil_points(
    airfoil: Airfoil, angles: Sequence[float], conditions: Conditions
) -> tuple[str, list[ConvergedPoint | None], list[str], list[str]]:
    """The solver's name, for each angle [deg] the converged point or None, a sentence for each None, and remarks.

    Every angle starts from a fresh boundary layer, so that its result does not depend on the others; those that fail
    are tried once more with more panels. Raises PolarError where there is no XFOIL, or where not one angle comes out
    before the time limit.
    """
    program = _program()
    end = monotonic() + conditions.time_limit
    version, found, stops = _done(program, airfoil, angles, conditions, end)
    if stops and not found:
        raise PolarError(f"{airfoil.name}: no angle was done: {next(iter(stops.values()))}")
    failed = [angle for angle in angles if angle not in stops and _at(angle, found) is None]
    finer = replace(conditions, panels=min(round(FINER * conditions.panels), PANELS[1]))
    remarks = []
    if failed:
        _, more, later = _done(program, airfoil, failed, finer, end)
        found, stops = [*found, *more], {**stops, **later}
        if more:
            solved = ", ".join(f"{point.alpha:g}" for point in more)
            remarks = [f"alpha {solved}: with {finer.panels} panels, as XFOIL did not converge with fewer"]
    points = [_at(angle, found) for angle in angles]
    tried = f"{conditions.panels} or {finer.panels} panels"
    why = f"XFOIL did not converge in {conditions.iterations} iterations, with {tried}"
    missing = [angle for angle, point in zip(angles, points, strict=True) if point is None]
    return f"XFOIL {version}", points, [f"alpha {angle:g}: {stops.get(angle, why)}" for angle in missing], remarks


def _done(
    program: str, airfoil: Airfoil, angles: Sequence[float], conditions: Conditions, end: float
) -> tuple[str, list[ConvergedPoint], dict[float, str]]:
    """XFOIL's version, the points that converged, and why angles were not tried to their end.

    Where it hangs at one of several angles, those that are missing are done one by one.
    """
    version, found, ending, hangs = _run(program, airfoil, angles, conditions, end)
    missing = [angle for angle in angles if _at(angle, found) is None] if ending else []
    if not hangs or len(angles) == 1:
        return version, found, dict.fromkeys(missing, ending)
    stops: dict[float, str] = {}
    for angle in missing:
        own, more, stop = _done(program, airfoil, [angle], conditions, end)
        version, found, stops = own or version, [*found, *more], {**stops, **stop}
    return version, found, stops


def _at(angle: float, points: Sequence[ConvergedPoint]) -> ConvergedPoint | None:
    return next((point for point in points if abs(point.alpha - angle) < SAME), None)  # real: angles of a real solver


def _program() -> str:
    """The program to start."""
    named = os.environ.get(VARIABLE)
    found = shutil.which(named or "xfoil")
    if found is None:
        raise PolarError(f"{VARIABLE} is '{named}', which is no program that can be run" if named else MISSING)
    return str(Path(found).absolute())


def _run(
    program: str, airfoil: Airfoil, angles: Sequence[float], conditions: Conditions, end: float
) -> tuple[str, list[ConvergedPoint], str, bool]:
    """XFOIL's version, the points that converged, why it ended early, empty where it did not, and whether it hung.

    Where the program stops at a floating-point trap, the library against it is built, and it is started again.
    """
    patience = HANGING * conditions.iterations + PER_ANGLE * len(angles)
    hung = monotonic() + patience
    with tempfile.TemporaryDirectory(prefix="bladewright-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        coordinates = (f"{x:.12f} {y:.12f}" for x, y in airfoil.points)
        (folder / "airfoil.dat").write_text("\n".join(["airfoil", *coordinates, ""]))
        (folder / "script.txt").write_text(_script(angles, conditions))
        cured = untrapped.built()
        status = _ended(program, folder, min(end, hung))
        if status in TRAPPED and not cured:
            if not untrapped.built():  # by another process, in the meantime
                untrapped.build_library()
            status = _ended(program, folder, min(end, hung))
        version, points = read_polar_dump(folder / "dump.bin")
        if status is None and hung < end:
            return version, points, f"XFOIL hung, and was stopped after {patience:g} s", True
        if status is None:
            limit = f"XFOIL was stopped at the time limit of {conditions.time_limit:g} s"
            return version, points, f"{limit}; raise it, or ask for fewer angles", False
        if status in TRAPPED:
            return version, points, f"XFOIL stopped at a floating-point trap; set {untrapped.NAMED}", False
        if status != 0 or not version:
            words = " ".join((folder / "output.txt").read_text(errors="replace").split()[-WORDS:])
            how = f"with status {status}" if status else "without a polar dump"
            return version, points, f"XFOIL, '{program}', ended {how}; its last words: {words or 'none'}", False
        return version, points, "", False


def _script(angles: Sequence[float], conditions: Conditions) -> str:
    """What is typed into XFOIL."""
    forced = " ".join(f"{each:.6f}" for each in conditions.transition)
    lines = [
        *("PLOP", "G F", ""),
        "LOAD airfoil.dat",
        f"XYCM {conditions.moment_point:.9f} 0",
        *("PPAR", f"N {conditions.panels}", "", ""),
        "OPER",
        *("VPAR", f"N {conditions.n_crit:.6f}", f"XTR {forced}", ""),
        f"VISC {conditions.reynolds:.8e}",
        f"MACH {conditions.mach:.8f}",
        f"ITER {conditions.iterations}",
        *("PACC", "", "dump.bin"),
    ]
    # INIT toggles: before the first point there is no boundary layer to forget
    march = "\nINIT\n".join(f"ALFA {angle:.9f}" for angle in angles)
    return "\n".join([*lines, march, "", "QUIT", ""])


def _ended(program: str, folder: Path, end: float) -> int | None:
    """Run XFOIL on the script in a folder and return its status; None where it had to be stopped at the time `end`."""
    with (
        (folder / "script.txt").open("rb") as script,
        (folder / "output.txt").open("wb") as output,
        subprocess.Popen(  # noqa: S603  XFOIL, or what the user named in its place
            [program],
            stdin=script,
            stdout=output,
            stderr=subprocess.STDOUT,
            cwd=folder,
            env=untrapped.environment(),
            start_new_session=True,
        ) as process,
    ):
        try:
            return process.wait(max(0.0, end - monotonic()))
        except subprocess.TimeoutExpired:
            return None
        finally:
            _stop(process)


def _stop(process: subprocess.Popen[bytes]) -> None:
    """End a process, and what a wrapper started in its session."""
    if process.poll() is not None:
        return
    with suppress(OSError):
        if sys.platform == "win32":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)
