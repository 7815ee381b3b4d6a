"""Several designs built into CAD files at once, each in a process of its own."""

import os
import signal
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path

from bladewright.cli.build_files import BuildOptions, build_files
from bladewright.cli.load_design import load_design
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import Bar, Silent
from bladewright.errors import BladewrightError, DesignError


def build_batch(paths: Sequence[Path], options: BuildOptions, jobs: int | None, bar: Bar) -> Outcome:
    """Build the designs in many files, `jobs` at a time, or as many as there are processors.

    A design that cannot be built does not keep the others from being built; it is a refusal in the outcome. Raises
    DesignError, before any is built, where two designs have the same name.
    """
    _check_names(paths, options)
    built: dict[Path, Outcome] = {}
    refused: dict[Path, str] = {}
    count = min(jobs or os.cpu_count() or 1, len(paths))
    pool = ProcessPoolExecutor(count, get_context("spawn"), initializer=_ignore_interrupts)
    try:
        waiting = {pool.submit(_build_one, path, options): path for path in paths}
        for done in as_completed(waiting):
            path, result = waiting[done], done.result()
            if isinstance(result, str):
                refused[path] = result
            else:
                built[path] = result
            bar.set_description_str(path.name)
            bar.update(1)
    finally:
        pool.shutdown(cancel_futures=True)
    outcomes = [built[path] for path in paths if path in built]
    return Outcome(
        data={
            "passed": not refused and all(each.data["passed"] for each in outcomes),
            "designs": [each.data for each in outcomes],
            "refused": [{"file": str(path), "message": refused[path]} for path in paths if path in refused],
        },
        text="\n".join(each.text for each in outcomes),
        failures=tuple(text for each in outcomes for text in each.failures),
        refusals=tuple(refused[path] for path in paths if path in refused),
    )


def _check_names(paths: Sequence[Path], options: BuildOptions) -> None:
    """Raise DesignError where two designs have the same name; files that cannot be read are reported later."""
    names: dict[str, Path] = {}
    for path in paths:
        try:
            name = load_design(path, options.changes).name
        except BladewrightError:
            continue
        if name in names:
            raise DesignError(
                f"'{names[name]}' and '{path}' are both named {name!r}, and their files would be the same: change the "
                "name in one of them, or build them into directories of their own"
            )
        names[name] = path


def _ignore_interrupts() -> None:
    """Leave an interrupt to the parent process, so that files being written are finished."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _build_one(path: Path, options: BuildOptions) -> Outcome | str:
    """The outcome of one design, or the message of its refusal."""
    try:
        return build_files(path, options, Silent())
    except BladewrightError as error:
        text = str(error)
        return text if str(path) in text else f"{path}: {text}"
