"""Searches: the best design of one aim with exact derivatives, or the Pareto set of several."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any, cast

import numpy as np

from bladewright.designs import Design
from bladewright.errors import StudyError
from bladewright.nurbs.basis import Reals
from bladewright.studies.adjoint import adjoint_of
from bladewright.studies.front import Tracing, front
from bladewright.studies.goals import Constraint, Method, Objective, SearchOptions, entry_keys, entry_of, goals_of
from bladewright.studies.gradient_search import least
from bladewright.studies.manifest import Manifest, read_manifest
from bladewright.studies.nsga2 import Asked as AskedRuns
from bladewright.studies.nsga2 import nsga2, pymoo_version
from bladewright.studies.operating_points import OperatingPoint
from bladewright.studies.optimality import Optimality
from bladewright.studies.optimum import Optimum
from bladewright.studies.pareto import ParetoSet
from bladewright.studies.problem import Problem
from bladewright.studies.quantities import Quantity
from bladewright.studies.run import Experiment, Record, built_designs, measured, within
from bladewright.studies.runs import Runs
from bladewright.studies.study import Study
from bladewright.studies.sweep import Given, header_of, range_of
from bladewright.studies.variables import resolved
from bladewright.studies.workers import Workers, workers

Asked = str | Callable[..., Any] | Mapping[str, Any]
"""An objective: the name of a quantity, a function, or the keys of a study file."""
Limits = Mapping[str, tuple[float | None, float | None]] | Sequence[Mapping[str, Any] | Constraint]
"""Constraints: lowest and highest value by name of a quantity, or the keys of a study file."""

Watch = Callable[[Mapping[str, Any]], object]
"""Called with the figures of each iteration or run."""


def optimise(
    design: Design | Mapping[str, Design],
    variables: Mapping[str, Given],
    objectives: Asked | Objective | Sequence[Asked | Objective],
    constraints: Limits = (),
    *,
    polars: Mapping[str, OperatingPoint] | None = None,
    method: Method | None = None,
    tolerance: float = 1e-6,
    iterations: int = 200,
    members: int = 15,
    population: int = 100,
    generations: int = 40,
    seed: int = 1,
    manifest: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    time_limit: float | None = None,
    progress: Watch | None = None,
) -> Optimum | ParetoSet:
    """The best design in one objective, or the Pareto set of several, of one design or of several by name.

    `variables` are ranges as `sweep` takes them. An objective is the name of a quantity, a function of the blade or
    section, or a table such as `{"quantity": "throat_area", "maximise": True}`; `constraints` are lowest and highest
    values by name, `{"throat_area": (5e3, None)}`, or tables such as
    `{"quantity": thickness, "lower": 0.9, "relative": True}`. With `"adjoint": True` a function returns the figure and
    its derivatives by points of the surfaces, as `pullback` takes them. `polars` are operating points by name, whose
    quantities are `POINT.cl`, `POINT.cd` and so on.

    `method` "slsqp" and "trust-constr" take exact derivatives at held knots: one objective gives an `Optimum`, two give
    a front of so many `members`, each of which meets the conditions of an optimum within `tolerance`. "nsga2" needs no
    derivatives and takes any number of objectives, in `generations` of a `population`, in `jobs` processes. By default
    it is slsqp for one objective and nsga2 for several. With a `manifest` every run or iteration is kept, and a
    search that was stopped goes on there. `progress` is called with the figures of each iteration or run.

    Raises StudyError for what cannot be searched, and DesignError where the search cannot begin at the design.
    """
    designs: dict[str, Any] = dict(design) if isinstance(design, Mapping) else {str(cast("Any", design).name): design}
    alone = callable(objectives) or isinstance(objectives, str | Mapping | Objective)
    asked = cast("Sequence[Any]", [objectives] if alone else objectives)
    if isinstance(constraints, Mapping):
        constraints = [{"quantity": name, "lower": low, "upper": high} for name, (low, high) in constraints.items()]
    options = SearchOptions(
        objectives=tuple(entry_of(Objective, each) for each in asked),
        constraints=tuple(entry_of(Constraint, each) for each in constraints),
        method=method,
        tolerance=tolerance,
        iterations=iterations,
        members=members,
        population=population,
        generations=generations,
        seed=seed,
        time_limit=time_limit,
    )
    study = Study(
        name="-".join(designs) if manifest is None else Path(manifest).stem,
        folder=Path.cwd(),
        designs=designs,
        ranges={name: range_of(name, given) for name, given in variables.items()},
        optimise=options,
        polars=polars or {},
    )
    return Search(study).carried_out(manifest, jobs=jobs, scheduler=scheduler, progress=progress)


class Search:
    """What the search of a study will do."""

    def __init__(self, study: Study) -> None:
        """Build the designs that it begins with.

        Raises StudyError where a variable, a quantity, an objective or a constraint is none, or one of them has no
        figure at the start; DesignError where a design is impossible.
        """
        if study.optimise is None:
            raise StudyError(
                "the study has no table [optimise]: give it one with objectives = "
                "[{ quantity = \"mass\" }], or sweep it with 'bladewright sweep'"
            )
        self.study, self.options = study, study.optimise
        variables = resolved(study.ranges, study.designs)
        entries: list[Objective | Constraint] = [*self.options.objectives, *self.options.constraints]
        by_entry = [self._quantities(entry) for entry in entries]
        unique = {each.name: each for found in by_entry for each in found}
        self.experiment = Experiment(
            designs=study.designs,
            variables=variables,
            quantities=tuple(unique.values()),
            time_limit=self.options.time_limit,
        )
        self.start = {variable.name: variable.start for variable in variables}
        self.figures, names = self._begun()
        by_number = {
            number: [name for each in found for name in names[each.name]] for number, found in enumerate(by_entry)
        }
        self.goals = goals_of(self.options, by_number, self.figures)
        self.method: Method = self.options.method or ("slsqp" if len(self.goals.aims) == 1 else "nsga2")
        if self.method != "nsga2" and len(self.goals.aims) > 2:
            raise StudyError(
                f"{len(self.goals.aims)} objectives: a front with derivatives has two; leave one out, make one a "
                'constraint, or search with method = "nsga2"'
            )
        held = next((limit for limit in self.goals.limits if limit.equal), None)
        if self.method == "nsga2" and held is not None:
            raise StudyError(
                f"the constraint on {held.figure} has equal limits, {held.lower:g}, which no random design meets: give "
                'nsga2 a band, or search with method = "slsqp"'
            )

    @property
    def single(self) -> bool:
        """Whether it searches one optimum, and no Pareto set."""
        return self.method != "nsga2" and len(self.goals.aims) == 1

    @property
    def total(self) -> int:
        """Number of runs of a Pareto set."""
        options = self.options
        return options.population * options.generations if self.method == "nsga2" else options.members

    def carried_out(
        self,
        manifest: str | os.PathLike[str] | None = None,
        *,
        jobs: int | None = None,
        scheduler: str | None = None,
        progress: Watch | None = None,
    ) -> Optimum | ParetoSet:
        """Its result, as `optimum` or `pareto_set` gives it."""
        if self.single:
            return self.optimum(manifest, progress=progress)
        return self.pareto_set(manifest, jobs=jobs, scheduler=scheduler, progress=progress)

    def optimum(self, manifest: str | os.PathLike[str] | None = None, *, progress: Watch | None = None) -> Optimum:
        """The best design of one aim, by exact derivatives.

        Every iteration is added to the manifest, and the search goes on at the last one that is there.
        """
        began = time.perf_counter()
        problem, start = self._problem()
        with self._keeping(manifest, progress) as (kept, keep):

            def note(x: Reals, figures: Mapping[str, float]) -> None:
                parameters = problem.parameters(x)
                if not kept or kept[len(kept)].parameters != parameters:
                    keep(Record(run=len(kept) + 1, parameters=parameters, figures=dict(figures), verdict="built"))

            if not kept:
                note(start, self.figures)
            found = least(
                problem,
                problem.vector(kept[len(kept)].parameters),
                self.goals.aims[0],
                self.goals.limits,
                method=self.method,
                tolerance=self.options.tolerance,
                iterations=self.options.iterations,
                watch=note,
            )
            note(found.x, found.figures)
        return Optimum(
            name=self.study.name,
            experiment=self.experiment,
            goals=self.goals,
            designs=problem.designs_at(found.x),
            parameters=problem.parameters(found.x),
            start_parameters=self.start,
            figures=found.figures,
            start_figures=self.figures,
            optimality=found.optimality,
            tolerance=self.options.tolerance,
            history=np.array([self._state(record) for record in kept.values()]),
            rounds=found.rounds,
            evaluations=found.evaluations,
            refusal=found.refusal,
            seconds=time.perf_counter() - began,
        )

    def pareto_set(
        self,
        manifest: str | os.PathLike[str] | None = None,
        *,
        jobs: int | None = None,
        scheduler: str | None = None,
        progress: Watch | None = None,
    ) -> ParetoSet:
        """The Pareto set; what the manifest has is taken from there, and every run is added to it."""
        optima: dict[int, Optimality] = {}
        with ExitStack() as stack:
            kept, keep = stack.enter_context(self._keeping(manifest, progress))
            if self.method == "nsga2":
                self._evolve(stack.enter_context(workers(self.experiment, jobs=jobs, scheduler=scheduler)), kept, keep)
            else:
                for record, optimum in self._traced(kept):
                    optima[record.run] = optimum
                    keep(record)
        return ParetoSet(
            name=self.study.name,
            runs=Runs.of(kept.values(), self.experiment, self.study.name),
            goals=self.goals,
            start_figures=self.figures,
            optimality=optima,
            tolerance=self.options.tolerance,
        )

    @contextmanager
    def _keeping(
        self, manifest: str | os.PathLike[str] | None, progress: Watch | None
    ) -> Iterator[tuple[dict[int, Record], Callable[[Record], None]]]:
        """The records by number, to begin with those of the manifest, and what adds one."""
        watch, kept = progress or _nothing, dict[int, Record]()
        with ExitStack() as stack:
            opened = None
            if manifest is not None:
                opened = stack.enter_context(Manifest(manifest, self._header()))
                kept |= {record.run: record for record in read_manifest(manifest)[1]}

            def keep(record: Record) -> None:
                if opened is not None and record.run not in kept:
                    opened.append(record)
                kept[record.run] = record
                watch(record.figures)

            yield kept, keep

    def _state(self, record: Record) -> tuple[float, float]:
        """The aim's figure of an iteration, and the largest violation of a limit, in its size."""
        figures = cast("Mapping[str, float]", record.figures)
        return figures[self.goals.aims[0].figure], float(np.max(self.goals.excesses(figures), initial=0.0))

    def _quantities(self, entry: Objective | Constraint) -> list[Quantity]:
        found = self.study.quantities(entry.quantity)
        return [adjoint_of(each) for each in found] if entry.adjoint else found

    def _begun(self) -> tuple[dict[str, float], dict[str, list[str]]]:
        """The figures that the search begins with, and their names by quantity."""
        limit = self.options.time_limit
        try:
            with within(limit):
                return self._measured()
        except TimeoutError as error:
            raise StudyError(
                f"the search cannot begin: the design of the study takes longer than the limit of {limit:g} s; raise "
                "time_limit, or find what hangs"
            ) from error

    def _measured(self) -> tuple[dict[str, float], dict[str, list[str]]]:
        built = built_designs(self.experiment, self.start)
        found: dict[str, float] = {}
        names: dict[str, list[str]] = {}
        for quantity in self.experiment.quantities:
            own, problems = measured([quantity], built)
            if problems:
                raise StudyError(
                    f"the search cannot begin at the design of the study, where a figure is missing: {problems[0]}"
                )
            twice = next((name for name in own if name in found), None)
            if twice is not None:
                raise StudyError(f"two quantities give the figure '{twice}': rename it in one of them")
            found |= cast("dict[str, float]", own)
            names[quantity.name] = list(own)
        return found, names

    def _problem(self) -> tuple[Problem, Reals]:
        """The problem of a search with derivatives, and the vector of its start."""
        problem = Problem(self.study.designs, self.experiment.variables, self.experiment.quantities)
        return problem, problem.start

    def _traced(self, kept: Mapping[int, Record]) -> Iterator[tuple[Record, Optimality]]:
        """The members of a front with derivatives as they are found; those that are kept are checked."""
        problem, start = self._problem()
        tracing = Tracing(
            members=self.options.members,
            method=self.method,
            tolerance=self.options.tolerance,
            iterations=self.options.iterations,
        )
        known = {number: problem.vector(record.parameters) for number, record in kept.items()}
        began = time.perf_counter()
        for number, found in front(problem, start, self.goals, tracing, known=known):
            record = Record(
                run=number,
                parameters=problem.parameters(found.x),
                figures=dict(found.figures),
                verdict="built",
                seconds=round(time.perf_counter() - began, 4),
            )
            yield record, found.optimality
            began = time.perf_counter()

    def _evolve(self, pool: Workers, kept: Mapping[int, Record], keep: Callable[[Record], None]) -> None:
        """Carry out NSGA-II; runs that are kept are taken as they are."""

        def carried_out(asked: AskedRuns) -> Iterator[Record]:
            for number, parameters in asked:
                if number in kept and dict(kept[number].parameters) != dict(parameters):
                    raise StudyError(
                        f"run {number} of the manifest has other parameters than this search asks for: a quantity "
                        "gives other figures than before; name another manifest with -o"
                    )
            yield from (kept[number] for number, _ in asked if number in kept)
            for record in pool.records([each for each in asked if each[0] not in kept]):
                keep(record)
                yield record

        options = self.options
        nsga2(
            self.experiment.variables,
            self.goals,
            carried_out,
            population=options.population,
            generations=options.generations,
            seed=options.seed,
        )

    def _header(self) -> dict[str, Any]:
        """The first line of the manifest: what determines the runs."""
        options = asdict(self.options)
        for more in ("generations", "iterations"):  # a search goes on with more of them
            del options[more]
        return {
            **header_of("optimise", self.study, self.experiment.quantities),
            "optimise": {
                **options,
                "objectives": [entry_keys(each) for each in self.options.objectives],
                "constraints": [entry_keys(each) for each in self.options.constraints],
                "method": self.method,
            },
            **({"pymoo": pymoo_version()} if self.method == "nsga2" else {}),
        }


def _nothing(_: Mapping[str, Any]) -> None:
    """What is done with figures that nobody asks for."""
