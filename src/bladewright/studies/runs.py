"""The runs of a study as a table: parameters, figures and verdicts by columns."""

from __future__ import annotations

import csv
import io
from array import array
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np

from bladewright.atomic_write import atomic_write
from bladewright.designs import Design, unit_at
from bladewright.display import Shown
from bladewright.errors import StudyError
from bladewright.nurbs.basis import Reals
from bladewright.studies.run import Experiment, Record, Verdict, headed
from bladewright.studies.variables import Variable, changed_designs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN_REASONS = 3
"""Reasons of refusals and failures that the text gives, the most frequent ones."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Runs(Shown):
    """The runs of a study that have ended, in the order of their numbers."""

    shown_as: ClassVar[str] = "runs"

    name: str
    """of the study"""
    experiment: Experiment
    """what was done in every run"""
    numbers: tuple[int, ...]
    """of the runs"""
    parameters: Mapping[str, Sequence[Any]]
    """values of each variable (n,)"""
    figures: Mapping[str, Reals]
    """values of each quantity (n,), nan where it was not found; lengths in the design's unit, angles in degrees"""
    verdicts: tuple[Verdict, ...]
    """what came of each"""
    reasons: Mapping[int, str]
    """why runs were refused or have failed, by their numbers"""
    files: Mapping[int, tuple[str, ...]]
    """names of their CAD files, by their numbers"""

    @classmethod
    def of(cls, records: Iterable[Record], experiment: Experiment, name: str) -> Self:
        """The table of records, which are read one after another."""
        numbers, verdicts = array("q"), list[Verdict]()
        parameters: dict[str, list[Any]] = {each.name: [] for each in experiment.variables}
        figures: dict[str, array[float]] = {}
        reasons, files = dict[int, str](), dict[int, tuple[str, ...]]()
        for record in records:
            for variable, values in parameters.items():
                values.append(record.parameters[variable])
            for figure, value in record.figures.items():
                column = figures.setdefault(figure, array("d"))
                column.extend([np.nan] * (len(numbers) - len(column)))
                column.append(np.nan if value is None else value)
            numbers.append(record.run)
            verdicts.append(record.verdict)
            if record.reason:
                reasons[record.run] = record.reason
            if record.files:
                files[record.run] = record.files
        order = np.argsort(np.array(numbers), kind="stable")
        whole = {figure: [*column, *[np.nan] * (len(numbers) - len(column))] for figure, column in figures.items()}
        return cls(
            name=name,
            experiment=experiment,
            numbers=tuple(numbers[place] for place in order),
            parameters={each: tuple(values[place] for place in order) for each, values in parameters.items()},
            figures={each: np.array(values)[order] for each, values in whole.items() if not np.all(np.isnan(values))},
            verdicts=tuple(verdicts[place] for place in order),
            reasons=dict(sorted(reasons.items())),
            files=files,
        )

    def __len__(self) -> int:
        return len(self.numbers)

    @property
    def good(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Whether each run (n,) gave what was asked for."""
        return np.array([verdict in {"built", "verified"} for verdict in self.verdicts], dtype=bool)

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of the variables and of the figures by name, where they are known."""
        found = {each.name: _unit(each, self.experiment.designs) for each in self.experiment.variables}
        for name in self.figures:
            found[name] = self.experiment.unit(name)
        return {name: unit for name, unit in found.items() if unit}

    def design(self, run: int) -> Any:
        """The design of a run; where the study has several, all of them by name. StudyError where there is none."""
        if run not in self.numbers:
            raise StudyError(f"there is no run {run}: the runs are {self.numbers[0]} to {self.numbers[-1]}")
        place = self.numbers.index(run)
        parameters = {name: values[place] for name, values in self.parameters.items()}
        designs = changed_designs(self.experiment.designs, self.experiment.variables, parameters)
        return next(iter(designs.values())) if len(designs) == 1 else designs

    def heading(self, name: str) -> str:
        """The name of a variable or figure, with its unit."""
        return headed(name, self.units.get(name, ""))

    def plot(self, drawing: Literal["parallel", "scatter", "effects"] = "parallel") -> Figure:
        """A matplotlib figure: parallel coordinates, a scatter matrix, or the main effects of the variables.

        Raises StudyError where no run has figures.
        """
        if not self.figures:
            raise StudyError("there is nothing to draw: no run has figures, as `reasons` says")
        from bladewright.views.runs import DRAWINGS

        return DRAWINGS[drawing](self)

    def to_csv(self, path: str | Path | None = None) -> str:
        """One line a run under a line of names with units, as text; written to `path` where one is given.

        Raises FileError where the file cannot be written.
        """
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["run", *map(self.heading, [*self.parameters, *self.figures]), "verdict", "reason"])
        columns = [*self.parameters.values(), *([_cell(x) for x in column] for column in self.figures.values())]
        reasons = [self.reasons.get(run, "") for run in self.numbers]
        writer.writerows(zip(self.numbers, *columns, self.verdicts, reasons, strict=True))
        if path is not None:
            with atomic_write(path) as unfinished:
                Path(unfinished).write_text(text.getvalue(), encoding="utf-8")
        return text.getvalue()

    def to_dict(self) -> dict[str, Any]:
        """Counts of the verdicts, and the columns with their units, for JSON."""
        return {
            "name": self.name,
            "runs": len(self),
            "verdicts": dict(Counter(self.verdicts)),
            "units": self.units,
            "numbers": list(self.numbers),
            "parameters": {name: list(values) for name, values in self.parameters.items()},
            "figures": {name: values.tolist() for name, values in self.figures.items()},
            "reasons": {str(run): reason for run, reason in self.reasons.items()},
        }

    def __str__(self) -> str:
        """Counts of the verdicts, what each figure ranges over, and the most frequent reasons of refusals."""
        counts = ", ".join(f"{count} {verdict}" for verdict, count in Counter(self.verdicts).most_common())
        lines = [f"{self.name}: {len(self)} runs: {counts or 'none'}"]
        rows = []
        for name, values in self.figures.items():
            found = np.flatnonzero(np.isfinite(values))
            low, high = found[np.argmin(values[found])], found[np.argmax(values[found])]
            ends = [f"{values[place]:.6g} in run {self.numbers[place]}" for place in (low, high)]
            rows.append([self.heading(name), ends[0], "to", ends[1], f"mean {np.mean(values[found]):.6g}"])
        widths = [max(len(row[place]) for row in rows) for place in range(5)] if rows else []
        lines += ["  " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
        for reason, count in Counter(self.reasons.values()).most_common(SHOWN_REASONS):
            first = next(run for run, text in self.reasons.items() if text == reason)
            lines.append(f"  {count} {'run' if count == 1 else 'runs'}, such as {first}: {reason}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        """One line."""
        return f"<Runs of {self.name}: {len(self)}, {int(np.count_nonzero(self.good))} of them built>"


def _unit(variable: Variable, designs: Mapping[str, Design]) -> str:
    if variable.relative:
        return "-"
    design, path = variable.targets[0]
    of: Any = designs[design]
    unit = unit_at(of, path) or ""
    return str(of.length_unit) if unit == "length" else unit


def _cell(value: float) -> str:
    return repr(float(value)) if np.isfinite(value) else ""
