"""Who carries out the runs of a study: this process, others on this machine, or a Dask cluster."""

from __future__ import annotations

import faulthandler
import os
import pickle
import signal
import sys
import threading
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from concurrent.futures.process import ProcessPoolExecutor
from contextlib import contextmanager
from functools import cache, lru_cache
from itertools import islice
from multiprocessing import get_context, parent_process
from pathlib import Path
from typing import Any, Self, TextIO, final

from bladewright.errors import StudyError
from bladewright.studies.run import Experiment, Record, record_of

Run = tuple[int, Mapping[str, Any]]
"""Number of a run, and its parameters."""
GRACE = 5.0
"""[s] Time after its limit for which a run may ignore that it is asked to end; then its process is stopped."""
QUEUED = 2
"""Runs under way and waiting for each process: one waits, so that no process does."""


class Workers(ABC):
    """A context in which runs of one experiment are carried out."""

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """End what was started for it."""
        return

    @abstractmethod
    def records(self, runs: Iterable[Run]) -> Iterator[Record]:
        """The records of runs as these end, in no order; runs are taken as there is room for them."""


def workers(experiment: Experiment, *, jobs: int | None = None, scheduler: str | None = None) -> Workers:
    """Those that a study asks for: `jobs` processes, by default one a processor, or the cluster of a Dask scheduler."""
    if scheduler is not None:
        return Cluster(experiment, scheduler)
    count = jobs or processors()
    return Processes(experiment, count) if count > 1 else ThisProcess(experiment)


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


@final
class ThisProcess(Workers):
    """The process of the study itself, one run after another."""

    def records(self, runs: Iterable[Run]) -> Iterator[Record]:
        return (record_of(self.experiment, run, parameters) for run, parameters in runs)


class _Pool(Workers):
    """Base of what carries out several runs at a time through `concurrent.futures`."""

    _executor: Executor
    _room: int
    """runs under way and waiting"""
    _sent: bytes
    """the experiment, pickled once"""

    def records(self, runs: Iterable[Run]) -> Iterator[Record]:
        left = iter(runs)
        waiting: dict[Future[Record], Run] = {}
        while True:
            lost: list[Run] = []
            for each in islice(left, self._room - len(waiting)):
                self._submit(each, waiting, lost)
            if not waiting and not lost:
                return
            done = wait(waiting, return_when=FIRST_COMPLETED).done if waiting else set()
            for future in done:
                each = waiting.pop(future)
                record = self._result(future, each)
                if record is None:
                    lost.append(each)
                else:
                    yield record
            if lost:
                # all runs under way are lost with the process that stopped: each is repeated alone to find which did it
                lost += waiting.values()
                waiting.clear()
                yield from map(self._alone, lost)

    def _submit(self, run: Run, waiting: dict[Future[Record], Run], lost: list[Run]) -> None:
        try:
            waiting[self._executor.submit(_carried_out, self._sent, *run)] = run
        except BrokenExecutor:
            lost.append(run)

    @abstractmethod
    def _result(self, future: Future[Record], run: Run) -> Record | None:
        """The record of a run that has ended; None where its process has stopped with it."""

    def _alone(self, run: Run) -> Record:
        """The record of a run, repeated while no other is under way."""
        return _stopped(run, self.experiment.time_limit)


@final
class Processes(_Pool):
    """Processes of this machine."""

    def __init__(self, experiment: Experiment, count: int) -> None:
        super().__init__(experiment)
        self._count, self._room = count, QUEUED * count
        try:
            self._sent = pickle.dumps(experiment)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise StudyError(
                f"a quantity cannot be sent to other processes ({error}): define its function in a module, or use one "
                "process with jobs=1"
            ) from error

    def __enter__(self) -> Self:
        self._executor = self._started()
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown(cancel_futures=True)

    def records(self, runs: Iterable[Run]) -> Iterator[Record]:
        with _one_thread_each():
            yield from super().records(runs)

    def _started(self) -> Executor:
        return ProcessPoolExecutor(self._count, get_context("spawn"), initializer=_prepare)

    def _result(self, future: Future[Record], run: Run) -> Record | None:  # noqa: ARG002 - a cluster asks for it
        try:
            return future.result()
        except BrokenExecutor:
            return None

    def _alone(self, run: Run) -> Record:
        self._restart()
        try:
            return self._executor.submit(_carried_out, self._sent, *run).result()
        except BrokenExecutor:
            self._restart()
            return _stopped(run, self.experiment.time_limit)

    def _restart(self) -> None:
        self._executor.shutdown(cancel_futures=True)
        self._executor = self._started()
        try:
            self._executor.submit(_ready).result()
        except BrokenExecutor as error:
            raise StudyError(
                'the processes of the study cannot start: in a script, call it under `if __name__ == "__main__":`, and '
                "define the functions of quantities in a module; or use one process with jobs=1"
            ) from error


@final
class Cluster(_Pool):
    """The workers of a Dask cluster."""

    def __init__(self, experiment: Experiment, scheduler: str) -> None:
        super().__init__(experiment)
        try:
            import cloudpickle
            from distributed import Client
        except ImportError as error:
            raise StudyError(
                f"a scheduler is named, and Dask is not installed ({error}): pip install 'bladewright[cluster]'"
            ) from error
        self._sent = cloudpickle.dumps(experiment)
        try:
            self._client = Client(scheduler, timeout=10, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise StudyError(
                f"there is no Dask scheduler at '{scheduler}': {error}; start one by 'dask scheduler'"
            ) from error

    def __enter__(self) -> Self:
        self._executor = self._client.get_executor(pure=False)
        threads = sum(self._client.nthreads().values())
        if threads == 0:
            raise StudyError(
                f"the scheduler at '{self._client.scheduler.address}' has no workers: start some by 'dask worker'"
            )
        self._room = QUEUED * threads
        try:
            self._executor.submit(_ready).result()
        except Exception as error:
            raise StudyError(f"the workers of the cluster cannot import bladewright: {error}") from error
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def _result(self, future: Future[Record], run: Run) -> Record | None:
        try:
            return future.result()
        except CancelledError as error:
            raise StudyError("the cluster has gone: start it again, and the same command goes on") from error
        except Exception as error:  # noqa: BLE001 - a run that stops its workers has failed, the others go on
            return _stopped(run, self.experiment.time_limit, f"{type(error).__name__}: {error}")


@lru_cache(maxsize=1)
def _experiment(sent: bytes) -> Experiment:
    found: Experiment = pickle.loads(sent)  # noqa: S301 - the study's own process has sent it
    return found


def _carried_out(sent: bytes, run: int, parameters: Mapping[str, Any]) -> Record:
    """Carry out a run in a worker."""
    experiment = _experiment(sent)
    limit = experiment.time_limit
    if limit is not None and _alone_in_process():
        faulthandler.dump_traceback_later(limit + GRACE, exit=True, file=_nowhere())
    try:
        return record_of(experiment, run, parameters)
    finally:
        faulthandler.cancel_dump_traceback_later()


def _alone_in_process() -> bool:
    """Whether a run has this process to itself, and another process would start it again where it is stopped."""
    if threading.current_thread() is threading.main_thread():
        return True
    try:
        from distributed import get_worker

        worker = get_worker()
    except (ImportError, ValueError):
        return False
    return worker.nanny is not None and worker.state.nthreads == 1


def _ready() -> int:
    """What a worker answers that can carry out runs."""
    return os.getpid()


@cache
def _nowhere() -> TextIO:
    """Where what a stopped process says is not seen: the record says it."""
    return Path(os.devnull).open("w", encoding="utf-8")


def _prepare() -> None:
    """Let a worker leave interrupts to the process of the study, and end with it, also where that is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let new processes use one thread each for linear algebra: they share the processors already."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    new = [name for name in names if name not in os.environ]
    os.environ.update(dict.fromkeys(new, "1"))
    try:
        yield
    finally:
        for name in new:
            os.environ.pop(name, None)


def _stopped(run: Run, limit: float | None, why: str = "") -> Record:
    """The record of a run whose process has stopped."""
    words = why or "the process that carried it out has stopped: killed, out of memory, or stopped by the system"
    words += f", or it ignored its limit of {limit:g} s" if limit else ""
    return Record(run=run[0], parameters=dict(run[1]), verdict="failed", reason=words)
