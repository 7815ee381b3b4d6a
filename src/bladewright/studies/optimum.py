"""The optimum that a search of one aim with derivatives has found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, final

from bladewright.designs import Design
from bladewright.display import Shown
from bladewright.nurbs.basis import Reals
from bladewright.studies.goals import Goals
from bladewright.studies.optimality import Optimality
from bladewright.studies.run import Experiment, headed


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Optimum(Shown):
    """The best design of a search, with what it began with."""

    shown_as: ClassVar[str] = "optimum"

    name: str
    """of the study"""
    experiment: Experiment
    """designs, variables and quantities"""
    goals: Goals
    """what the search was after"""
    designs: Mapping[str, Design]
    """the designs found, by name"""
    parameters: Mapping[str, float]
    """values of the variables"""
    start_parameters: Mapping[str, float]
    """those that the search began with"""
    figures: Mapping[str, float]
    """of the designs found, at knots of their own; lengths in the design's unit, angles in degrees"""
    start_figures: Mapping[str, float]
    """of the designs that the search began with"""
    optimality: Optimality
    """how well the conditions of an optimum hold"""
    tolerance: float
    """of these conditions"""
    history: Reals
    """(1 + iterations, 2) the aim's figure, and the largest violation of a limit, in its size"""
    rounds: int
    """how often the knots were chosen"""
    evaluations: int
    """how many designs were built"""
    refusal: str
    """why the design was refused at which the search had to end; empty where none was"""
    seconds: float

    @property
    def design(self) -> Any:
        """The design found; where the study has several, all of them by name."""
        return next(iter(self.designs.values())) if len(self.designs) == 1 else self.designs

    @property
    def passed(self) -> bool:
        """Whether the search has ended at an optimum."""
        return not self.failures

    @property
    def failures(self) -> tuple[str, ...]:
        """Why it is no optimum."""
        end = f": it ended where a design is refused: {self.refusal}" if self.refusal else ""
        return tuple(f"{each}{end}" for each in self.optimality.failures(self.tolerance))

    @property
    def aim(self) -> str:
        """What was to be small or large, with its unit."""
        return self.heading(self.goals.aims[0].figure)

    @property
    def rows(self) -> list[tuple[str, float, float]]:
        """Name with unit, start and end of each variable, then of each figure."""
        variables = [(name, self.start_parameters[name], value) for name, value in self.parameters.items()]
        figures = [(self.heading(name), self.start_figures[name], value) for name, value in self.figures.items()]
        return [*variables, *figures]

    def heading(self, figure: str) -> str:
        """The name of a figure, with its unit."""
        return headed(figure, self.experiment.unit(figure))

    def to_dict(self) -> dict[str, Any]:
        """All figures, for JSON."""
        return {
            "name": self.name,
            "passed": self.passed,
            "failures": list(self.failures),
            "aim": {"figure": self.goals.aims[0].figure, "maximise": self.goals.aims[0].maximise},
            "parameters": dict(self.parameters),
            "start_parameters": dict(self.start_parameters),
            "figures": dict(self.figures),
            "start_figures": dict(self.start_figures),
            "kkt": self.optimality.residual,
            "violation": self.optimality.violation,
            "multipliers": dict(self.optimality.multipliers),
            "iterations": len(self.history) - 1,
            "rounds": self.rounds,
            "evaluations": self.evaluations,
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        aim = self.goals.aims[0]
        before, after = self.start_figures[aim.figure], self.figures[aim.figure]
        change = f" ({100.0 * (after / before - 1.0):+.2f} %)" if before else ""
        word, found = "most" if aim.maximise else "least", self.optimality
        rounds = "1 round" if self.rounds == 1 else f"{self.rounds} rounds"
        effort = f"{len(self.history) - 1} iterations, {rounds}, {self.evaluations} designs, {self.seconds:.1f} s"
        lines = [
            f"{self.name}: {word} {self.aim}: {before:.6g} at the start, {after:.6g} found{change}",
            f"  {effort}; KKT residual {found.residual:.1e}, largest violation {found.violation:.1e}",
        ]
        rows = [("", "start", "found"), *((name, f"{x:.6g}", f"{y:.6g}") for name, x, y in self.rows)]
        widths = [max(len(row[place]) for row in rows) for place in range(3)]
        lines += [f"  {row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]:>{widths[2]}}" for row in rows]
        held = self.optimality.multipliers
        lines += [f"  held by {', '.join(held)}"] if held else []
        return "\n".join([*lines, *self.failures])

    def __repr__(self) -> str:
        return f"<Optimum of {self.name}: {'passed' if self.passed else 'not an optimum'}>"
