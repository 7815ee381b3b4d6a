"""The front of any number of aims by pymoo's NSGA-II (Deb et al. 2002): no derivatives, every figure, side by side.

The search is a function of its seed and of the figures that it has asked for. It is resumed by being repeated: runs
that the manifest has are taken from there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from bladewright.errors import StudyError
from bladewright.nurbs.basis import Reals
from bladewright.studies.goals import Goals
from bladewright.studies.run import Record
from bladewright.studies.variables import Variable

REFUSED = 1e6
"""What a run without figures has as cost and as violation: worse than any that has some."""
Asked = list[tuple[int, Mapping[str, Any]]]
"""Numbers and parameters of runs."""


def nsga2(
    variables: Sequence[Variable],
    goals: Goals,
    carried_out: Callable[[Asked], Iterable[Record]],
    *,
    population: int,
    generations: int,
    seed: int,
) -> None:
    """Search through all generations; `carried_out` gives the records of runs, in any order, and keeps them.

    The first generation begins with the design of the study where it lies within the bounds. Raises StudyError where
    pymoo is missing or no run of the first generation gives figures.
    """
    algorithm = _algorithm(len(variables), goals, _start(variables), population, generations, seed)
    first = 1
    while algorithm.has_next():
        asked = algorithm.ask()
        places = asked.get("X")
        runs: Asked = [(first + place, _parameters(variables, x)) for place, x in enumerate(places)]
        found = {record.run: record for record in carried_out(runs)}
        records = [found[number] for number, _ in runs]
        if first == 1:
            _check_some(records)
        first += len(runs)
        _told(algorithm, asked, goals, records)


def pymoo_version() -> str:
    """The version of pymoo, on which the path of a search depends; StudyError where it is missing."""
    try:
        import pymoo.version
    except ImportError as error:
        raise StudyError(
            f"nsga2 needs pymoo, which is not installed ({error}): pip install 'bladewright[search]'; one "
            'objective, or two with derivatives, can be searched with method = "slsqp"'
        ) from error
    return str(pymoo.version.__version__)


def _algorithm(count: int, goals: Goals, start: Reals | None, population: int, generations: int, seed: int) -> Any:
    pymoo_version()
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem

    # a last constraint for runs without figures
    problem = Problem(n_var=count, n_obj=len(goals.aims), n_ieq_constr=len(goals.limits) + 1, xl=0.0, xu=1.0)
    sampling = np.random.default_rng(seed).random((population, count))
    if start is not None:
        sampling[0] = start
    algorithm = NSGA2(pop_size=population, sampling=sampling)
    algorithm.setup(problem, termination=("n_gen", generations), seed=seed, verbose=False)
    return algorithm


def _told(algorithm: Any, asked: Any, goals: Goals, records: Sequence[Record]) -> None:
    from pymoo.core.evaluator import Evaluator
    from pymoo.problems.static import StaticProblem

    costs = np.full((len(records), len(goals.aims)), REFUSED)
    excesses = np.full((len(records), len(goals.limits) + 1), REFUSED)
    for place, record in enumerate(records):
        if record.good:
            figures: Any = record.figures
            costs[place], excesses[place] = goals.costs(figures), [*goals.excesses(figures), 0.0]
    Evaluator().eval(StaticProblem(algorithm.problem, F=costs, G=excesses), asked)
    algorithm.tell(infills=asked)


def _parameters(variables: Sequence[Variable], x: Reals) -> dict[str, Any]:
    return {variable.name: variable.at(float(entry)) for variable, entry in zip(variables, x, strict=True)}


def _start(variables: Sequence[Variable]) -> Reals | None:
    """The vector of the design of the study; None where it has no place in the bounds."""
    found = []
    for variable in variables:
        if variable.continuous:
            found.append((variable.start - variable.at(0.0)) / (variable.at(1.0) - variable.at(0.0)))
        else:
            choices = variable.choices
            found.append((choices.index(variable.start) + 0.5) / len(choices) if variable.start in choices else -1.0)
    return np.array(found) if all(0.0 <= each <= 1.0 for each in found) else None


def _check_some(records: Sequence[Record]) -> None:
    if any(record.good for record in records):
        return
    reason, count = Counter(record.reason for record in records).most_common(1)[0]
    raise StudyError(
        f"none of the {len(records)} designs of the first generation gave figures; {count} of them: {reason}. Narrow "
        "the bounds of the variables, or cure what fails; what was found is kept"
    )
