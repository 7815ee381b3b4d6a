"""The runs of a sweep: which values the variables have in each."""

from __future__ import annotations

import csv
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

from bladewright.errors import FileError, StudyError
from bladewright.studies.variables import Range, Variable

Parameters = dict[str, Any]
"""Values of the variables of a run, by name."""


def grid(variables: Sequence[Variable], _samples: int, _seed: int) -> Iterator[Parameters]:
    """Every combination of the variables' values, of which the last variable changes fastest."""
    names = [each.name for each in variables]
    return (dict(zip(names, values, strict=True)) for values in product(*(each.choices for each in variables)))


def listed(variables: Sequence[Variable], _samples: int, _seed: int) -> Iterator[Parameters]:
    """The first value of every variable, then the second, and so on: all have as many."""
    counts = {each.name: len(each.choices) for each in variables}
    if len(set(counts.values())) > 1:
        words = ", ".join(f"{name} {count}" for name, count in counts.items())
        raise StudyError(f"sampling = 'list' takes as many values of every variable, and there are of {words}")
    names = list(counts)
    return (dict(zip(names, values, strict=True)) for values in zip(*(each.choices for each in variables), strict=True))


def latin_hypercube(variables: Sequence[Variable], samples: int, seed: int) -> Iterator[Parameters]:
    """Values of which every variable has one in each of `samples` equal parts of its range (McKay et al., 1979)."""
    from scipy.stats import qmc

    yield from _in_ranges(variables, qmc.LatinHypercube(len(variables), rng=seed).random(samples))


def sobol(variables: Sequence[Variable], samples: int, seed: int) -> Iterator[Parameters]:
    """The first entries of a scrambled Sobol sequence (Owen, 1998), best for a power of two of them."""
    from scipy.stats import qmc

    sequence = qmc.Sobol(len(variables), rng=seed)
    for start in range(0, samples, BLOCK):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # it is told that the number should be a power of two
            fractions = sequence.random(min(BLOCK, samples - start))
        yield from _in_ranges(variables, fractions)


RUN = "run"
"""The column of a table that numbers its runs."""
BLOCK = 4096
"""Entries of a Sobol sequence that are made at a time; a power of two, as the sequence is balanced over these."""
SAMPLINGS: Mapping[str, Callable[[Sequence[Variable], int, int], Iterator[Parameters]]] = {
    "grid": grid,
    "list": listed,
    "latin-hypercube": latin_hypercube,
    "sobol": sobol,
}
"""By the words of a study file."""


def count(sampling: str, variables: Sequence[Variable], samples: int) -> int:
    """How many runs there are."""
    if sampling in {"latin-hypercube", "sobol"}:
        return samples
    choices = [len(each.choices) for each in variables]
    return prod(choices) if sampling == "grid" else choices[0]


def read_table(path: str | os.PathLike[str]) -> dict[str, Range]:
    """The variables of a CSV file: a line of names, then a line of values for every run.

    A value is a number or a text; units behind a name, as `stagger [deg]`, and the column `run` are left out. Raises
    FileError where the table cannot be read.
    """
    try:
        with Path(path).open(encoding="utf-8-sig", newline="") as stream:
            rows = [row for row in csv.reader(stream) if any(cell.strip() for cell in row)]
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise FileError(f"the table '{path}' cannot be read: {reason}; give a CSV file in UTF-8") from error
    names = [name.partition(" [")[0].strip() for name in rows[0]] if rows else []
    if len(rows) < 2 or not all(names):
        raise FileError(f"'{path}' is no table of runs: write a line of variables such as stagger[0], then one a run")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise FileError(f"'{path}' has the column '{twice}' twice: leave one out")
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(names):
            raise FileError(f"'{path}' has {len(row)} values in row {number}, and {len(names)} columns")
    columns = zip(*rows[1:], strict=True)
    values = {name: tuple(_value(cell) for cell in column) for name, column in zip(names, columns, strict=True)}
    return {name: Range(values=found, together=True) for name, found in values.items() if name != RUN}


def _in_ranges(variables: Sequence[Variable], fractions: Any) -> Iterator[Parameters]:
    for row in fractions:
        yield {each.name: each.at(float(fraction)) for each, fraction in zip(variables, row, strict=True)}


def _value(cell: str) -> float | str:
    for kind in (int, float):
        with suppress(ValueError):
            return kind(cell)
    return cell.strip()
