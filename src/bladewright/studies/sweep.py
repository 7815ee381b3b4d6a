"""A sweep: many designs are built, measured and written side by side, and every run is kept as it ends."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any, cast

from bladewright.designs import Design
from bladewright.errors import StudyError
from bladewright.files.writing import text_of
from bladewright.studies.manifest import Manifest, read_manifest
from bladewright.studies.operating_points import OperatingPoint
from bladewright.studies.quantities import Quantity
from bladewright.studies.run import Experiment, Record
from bladewright.studies.runs import Runs
from bladewright.studies.sampling import SAMPLINGS, count, read_table
from bladewright.studies.study import Format, Sampling, Study, SweepOptions
from bladewright.studies.variables import Range, resolved
from bladewright.studies.workers import workers

Given = Range | tuple[float, float] | Sequence[Any] | Mapping[str, Any]
"""A range of a variable: bounds as a pair in round brackets, choices as a list, or the keys of a study file."""
ENDINGS: Mapping[str, str] = {"step": ".step", "iges": ".igs", "brep": ".brep", "stl": ".stl", "3mf": ".3mf"}
"""Endings of the CAD files of each format."""


def sweep(
    design: Design | Mapping[str, Design],
    variables: Mapping[str, Given] | str | os.PathLike[str],
    quantities: Sequence[str | Callable[..., Any]] = (),
    *,
    polars: Mapping[str, OperatingPoint] | None = None,
    sampling: Sampling = "latin-hypercube",
    samples: int = 64,
    seed: int = 1,
    manifest: str | os.PathLike[str] | None = None,
    files: Sequence[Format] = (),
    directory: str | os.PathLike[str] = ".",
    jobs: int | None = None,
    scheduler: str | None = None,
    time_limit: float | None = None,
    retry: bool = False,
    progress: Callable[[Record], object] | None = None,
) -> Runs:
    """The runs of a design, or of several by name, with other values of some variables.

    `variables` has a range for each path or pattern: `{"stagger[1]": (20, 28), "blade_count": [20, 22]}`, where a pair
    in round brackets are bounds and a list are choices; or the keys of a study file, as
    `{"thickness*": {"lower": 0.9, "upper": 1.1, "relative": True}}`; or it is the path of a CSV table of runs.
    `quantities` are names (docs/sweeps.md), or functions of the blade or section; `polars` are operating points by
    name, whose quantities are `POINT.cl`, `POINT.cd` and so on. `sampling` is "grid", "list", "latin-hypercube" or
    "sobol", of which the latter two have so many `samples` of this `seed`.

    With a `manifest`, every run is a line of that file as soon as it has ended, and a sweep that was stopped goes on
    there; `retry` repeats the runs that have failed. CAD `files` such as "step" go to `directory`. `jobs` is the number
    of processes, by default one a processor, and 1 stays in this process; `scheduler` is the address of a Dask cluster
    in their place. A run ends at `time_limit` [s]. `progress` is called with every record.

    Raises StudyError for variables, quantities or a manifest that cannot be; what is wrong with single runs is in their
    records.
    """
    designs: dict[str, Any] = dict(design) if isinstance(design, Mapping) else {str(cast("Any", design).name): design}
    given = variables if isinstance(variables, Mapping) else {}
    ranges = {name: range_of(name, each) for name, each in given.items()}
    table = None if isinstance(variables, Mapping) else os.path.abspath(variables)  # noqa: PTH100 - of a text
    options = SweepOptions(
        sampling=sampling, samples=samples, seed=seed, table=table, files=tuple(files), time_limit=time_limit
    )
    study = Study(
        name="sweep" if manifest is None else Path(manifest).stem,
        folder=Path.cwd(),
        designs=designs,
        ranges=ranges,
        sweep=options,
        optimise=None,
        polars=polars or {},
    )
    plan = planned(study, quantities=quantities, directory=directory)
    return plan.carried_out(manifest, jobs=jobs, scheduler=scheduler, retry=retry, progress=progress)


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What a sweep will do."""

    study: Study
    experiment: Experiment
    total: int
    """number of runs"""
    header: Mapping[str, Any]
    """the first line of the manifest, from which the sweep can be repeated"""

    def runs(self) -> Iterator[tuple[int, dict[str, Any]]]:
        """Number and parameters of each run."""
        options = self.study.sweep
        return enumerate(SAMPLINGS[options.sampling](self.experiment.variables, options.samples, options.seed), start=1)

    def carried_out(
        self,
        manifest: str | os.PathLike[str] | None,
        *,
        jobs: int | None = None,
        scheduler: str | None = None,
        retry: bool = False,
        progress: Callable[[Record], object] | None = None,
        begun: Callable[[int], object] | None = None,
    ) -> Runs:
        """The runs, those included that the manifest has already, of which `begun` is told the number."""
        kept = list[Record]()
        with ExitStack() as stack:
            done = set[int]()
            append: Callable[[Record], object] = kept.append
            if manifest is not None:
                opened = stack.enter_context(Manifest(manifest, self.header, retry=retry))
                done, append = opened.done, opened.append
            if begun is not None:
                begun(len(done))
            if len(done) < self.total:
                pool = stack.enter_context(workers(self.experiment, jobs=jobs, scheduler=scheduler))
                for record in pool.records(each for each in self.runs() if each[0] not in done):
                    append(record)
                    if progress is not None:
                        progress(record)
        records = iter(kept) if manifest is None else read_manifest(manifest)[1]
        return Runs.of(records, self.experiment, self.study.name)


def planned(
    study: Study,
    *,
    quantities: Sequence[str | Callable[..., Any]] | None = None,
    directory: str | os.PathLike[str] = ".",
) -> Plan:
    """What the sweep of a study will do; `quantities` and `directory` are those of `sweep`.

    Raises StudyError where a variable or a quantity is none, and FileError where its table cannot be read.
    """
    options = study.sweep
    if options.table is not None:
        study = replace(study, ranges=read_table(study.folder / options.table))
        options = replace(options, sampling="list", table=None)
        study = replace(study, sweep=options)
    variables = resolved(study.ranges, study.designs)
    asked = options.quantities if quantities is None else quantities
    found = [each for name in asked for each in study.quantities(name)]
    names = [each.name for each in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise StudyError(f"the quantity '{twice}' is asked for twice: leave one out")
    experiment = Experiment(
        designs=study.designs,
        variables=variables,
        quantities=tuple(found),
        files=tuple(ENDINGS[each] for each in options.files),
        directory=str(Path(directory).absolute()),
        time_limit=options.time_limit,
    )
    return Plan(
        study=study,
        experiment=experiment,
        total=count(options.sampling, variables, options.samples),
        header=_header(study, asked, found),
    )


def _header(study: Study, asked: Sequence[str | Callable[..., Any]], found: Sequence[Quantity]) -> dict[str, Any]:
    """What determines the runs of a sweep."""
    random = study.sweep.sampling in {"latin-hypercube", "sobol"}
    names = [each if isinstance(each, str) else f"{each.__module__}:{each.__qualname__}" for each in asked]
    return {
        **header_of("sweep", study, found),
        "sweep": {
            "sampling": study.sweep.sampling,
            **({"samples": study.sweep.samples, "seed": study.sweep.seed} if random else {}),
            "quantities": names,
            "files": list(study.sweep.files),
            "time_limit": study.sweep.time_limit,
        },
    }


def header_of(kind: str, study: Study, quantities: Sequence[Quantity]) -> dict[str, Any]:
    """What the first line of a manifest says of any study, of one `kind`."""
    from bladewright import __version__

    return {
        "kind": kind,
        "bladewright": __version__,
        "name": study.name,
        "folder": str(study.folder.absolute()),
        "designs": {name: text_of(design) for name, design in study.designs.items()},
        "variables": {name: given_keys(each) for name, each in study.ranges.items()},
        "polars": {name: given_keys(each) for name, each in study.polars.items()},
        "functions": {each.name: each.source for each in quantities if each.source},
    }


def given_keys(given: Range | OperatingPoint) -> dict[str, Any]:
    """The keys of a table that are not left out."""
    return {each.name: asdict(given)[each.name] for each in fields(given) if getattr(given, each.name) != each.default}


def range_of(name: str, given: Given) -> Range:
    """The range that a pair, a list or a table stands for."""
    if isinstance(given, Range):
        return given
    if isinstance(given, Mapping):
        try:
            return Range(**{**given, "values": tuple(given.get("values", ()))})
        except TypeError as error:
            known = ", ".join(each.name for each in fields(Range))
            raise StudyError(f"variable '{name}' has a key that does not exist ({error}); known are {known}") from error
    if isinstance(given, tuple) and len(given) == 2:
        return Range(lower=given[0], upper=given[1])
    if isinstance(given, list) and given:
        return Range(values=tuple(given))
    raise StudyError(
        f"variable '{name}' is {given!r}: give a pair (lower, upper), a list of choices, or a table such as "
        '{"lower": 0.9, "upper": 1.1, "relative": True}'
    )
