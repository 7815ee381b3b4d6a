"""One run of a study: designs with other parameters are built, measured and written, and the outcome is recorded."""

from __future__ import annotations

import ctypes
import json
import math
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np

from bladewright.blade.design.families import prismatic
from bladewright.designs import Design
from bladewright.errors import BladewrightError, DesignError, GeometryError
from bladewright.studies.quantities import BuiltDesign, Quantity, figures
from bladewright.studies.variables import Variable, changed_designs

Figures = dict[str, float | None]
"""What was measured, by name; None where a figure could not be found or is no finite number."""
Verdict = Literal["built", "verified", "refused", "failed"]
"""What came of a run. `built`: the designs were built and every quantity was found; `verified`: the files, too, passed
their round trips; `refused`: a design with these parameters is impossible; `failed`: anything else."""


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """What is done in every run of a study."""

    designs: Mapping[str, Design]
    """by name"""
    variables: tuple[Variable, ...]
    """what a run sets"""
    quantities: tuple[Quantity, ...] = ()
    """what is measured"""
    files: tuple[str, ...] = ()
    """endings of the CAD files that are written of every run, such as `.step`"""
    directory: str = "."
    """where they go"""
    time_limit: float | None = None
    """longest time of a run [s]; None: no limit"""

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of the quantities by name, where they are known."""
        found = {each.name: each.unit(self.designs) for each in self.quantities}
        return {name: unit for name, unit in found.items() if unit}

    def unit(self, figure: str) -> str:
        """Unit of a figure, or of the quantity of which it is a component; empty where it is not known."""
        return self.units.get(figure) or self.units.get(figure.rpartition(".")[0], "")


@dataclass(frozen=True, kw_only=True)
class Record:
    """What came of one run: a line of the manifest."""

    run: int
    """number of the run, from 1"""
    parameters: Mapping[str, Any]
    """values of the variables by name"""
    figures: Figures = field(default_factory=dict)
    """what was measured"""
    verdict: Verdict
    """what came of it"""
    reason: str = ""
    """why it was refused or has failed"""
    files: tuple[str, ...] = ()
    """names of the CAD files in the directory of the study"""
    seconds: float = 0.0
    """how long it took [s]"""

    @property
    def good(self) -> bool:
        """Whether the run gave what was asked for."""
        return self.verdict in {"built", "verified"}

    def line(self) -> str:
        """The record as one line of JSON, without its line end."""
        return json.dumps(asdict(self), ensure_ascii=False, allow_nan=False, default=str)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of `line`, of the JSON object on it."""
        return cls(**{**data, "files": tuple(data["files"])})


def headed(name: str, unit: str) -> str:
    """A name with its unit, where it has one."""
    return name if unit in {"", "-"} else f"{name} [{unit}]"


def record_of(experiment: Experiment, run: int, parameters: Mapping[str, Any]) -> Record:
    """Carry out one run. Whatever is wrong with it is in the record: nothing is raised but interrupts."""
    begin = time.perf_counter()
    found: dict[str, Any] = {"figures": {}, "verdict": "failed", "files": ()}
    try:
        with within(experiment.time_limit):
            _carry_out(experiment, run, parameters, found)
    except (DesignError, GeometryError) as error:
        found |= {"verdict": "refused", "reason": _one_line(error)}
    except TimeoutError:
        found |= {"verdict": "failed", "reason": f"it took longer than the limit of {experiment.time_limit:g} s"}
    except (BladewrightError, MemoryError) as error:
        found |= {"verdict": "failed", "reason": _one_line(error) or "there is not enough memory for this design"}
    except Exception as error:  # noqa: BLE001 - the other runs of a study are owed to the user
        found |= {"verdict": "failed", "reason": f"{type(error).__name__}: {_one_line(error)}"}
    return Record(run=run, parameters=dict(parameters), seconds=round(time.perf_counter() - begin, 4), **found)


def built_designs(experiment: Experiment, parameters: Mapping[str, Any]) -> dict[str, BuiltDesign]:
    """The designs of a run by name, built; DesignError where one is impossible.

    Where no quantity needs curves and no files are written, sections are left at their exact outlines.
    """
    designs = changed_designs(experiment.designs, experiment.variables, parameters)
    wanted = experiment.quantities
    curves = bool(experiment.files) or not wanted or any(each.needs_curves for each in wanted)
    outlines = {name: None if curves else design.exact() for name, design in designs.items()}
    return {
        name: BuiltDesign(design, design.build() if outlines[name] is None else None, outlines[name])
        for name, design in designs.items()
    }


def measured(quantities: Sequence[Quantity], built: Mapping[str, BuiltDesign]) -> tuple[Figures, list[str]]:
    """The figures of a run by name, and why those are None that could not be found."""
    found: Figures = {}
    problems: dict[str, list[str]] = {}
    blank: list[str] = []
    for quantity in quantities:
        try:
            values = figures(quantity.of(built), quantity.name)
            numbers = {name: float(np.real(value)) for name, value in values.items()}
        except TimeoutError:
            raise
        except BladewrightError as error:
            found[quantity.name] = None
            problems.setdefault(_one_line(error), []).append(quantity.name)
        except Exception as error:  # noqa: BLE001 - a user's function may raise anything
            found[quantity.name] = None
            problems.setdefault(f"{type(error).__name__}: {_one_line(error)}", []).append(quantity.name)
        else:
            for name, number in numbers.items():
                found[name] = number if math.isfinite(number) else None
                blank += [] if math.isfinite(number) else [f"{name} is {number}, no finite number"]
    return found, [*blank, *(f"{', '.join(names)}: {why}" for why, names in problems.items())]


def _carry_out(experiment: Experiment, run: int, parameters: Mapping[str, Any], found: dict[str, Any]) -> None:
    """Build, measure and write; `found` is filled as it comes, so that what was found is kept where the rest fails."""
    built = built_designs(experiment, parameters)
    found["figures"], problems = measured(experiment.quantities, built)
    found["verdict"] = "built"
    if experiment.files:
        found["files"], failures = _written(experiment, run, built)
        problems += failures
        found["verdict"] = "verified"
    if problems:
        found |= {"verdict": "failed", "reason": "; ".join(problems)}


def _written(experiment: Experiment, run: int, built: Mapping[str, BuiltDesign]) -> tuple[tuple[str, ...], list[str]]:
    """The names of the CAD files of a run, and why round trips have failed."""
    from bladewright import cad

    directory = Path(experiment.directory)
    directory.mkdir(parents=True, exist_ok=True)
    files: list[str] = []
    failures: list[str] = []
    for own in built.values():
        body = own.built if own.design.dimension == 3 else prismatic(own.design).build()
        for ending in experiment.files:
            files.append(f"{own.design.name}-{run:04d}{ending}")
            trip = cad.write(body, directory / files[-1])
            failures += [f"{files[-1]}: {text}" for text in trip.failures]
    return tuple(files), failures


@contextmanager
def within(seconds: float | None) -> Iterator[None]:
    """A context that raises TimeoutError after so many seconds, in a thread as soon as it is back in Python."""
    alarm: int | None = getattr(signal, "SIGALRM", None)  # Windows has none
    if seconds is None:
        yield
        return
    if alarm is None or threading.current_thread() is not threading.main_thread():
        with _within_thread(seconds):
            yield
        return

    def stop(*_: object) -> None:
        raise TimeoutError

    before: Callable[..., Any] | int | None = signal.signal(alarm, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(alarm, before)


@contextmanager
def _within_thread(seconds: float) -> Iterator[None]:
    """The same in a thread that no signal reaches, such as that of a cluster's worker."""
    raised, thread = ctypes.pythonapi.PyThreadState_SetAsyncExc, ctypes.c_ulong(threading.get_ident())
    timer = threading.Timer(seconds, raised, (thread, ctypes.py_object(TimeoutError)))
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        raised(thread, None)


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split())
