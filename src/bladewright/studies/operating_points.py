"""Polars as quantities: lift, drag and moment of a section at the operating points of a study."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

import numpy as np

from bladewright.aerodynamics.airfoil import airfoil_of, exact_airfoil
from bladewright.aerodynamics.polar import COLUMNS, Polar, Solver, polar
from bladewright.designs import Design, unknown
from bladewright.errors import PolarError, StudyError
from bladewright.studies.quantities import BuiltDesign, Quantity
from bladewright.studies.variables import STRICT

COEFFICIENTS = (*COLUMNS[1:], "lift_to_drag")
"""What a polar gives at each angle of attack."""


@dataclass(frozen=True, kw_only=True)
class OperatingPoint:
    """The flow around a section, as `bw.polar` has it: a table `[polars.NAME]`."""

    __pydantic_config__: ClassVar[Mapping[str, Any]] = STRICT

    reynolds: float
    """by the chord, or by `reference_length`"""
    alpha: float | tuple[float, ...]
    """angle of attack, or several [deg]"""
    mach: float = 0.0
    """of the stream"""
    solver: Solver = "xfoil"
    """which program makes the polar"""
    n_crit: float = 9.0
    """exponent of the e^n method"""
    transition: tuple[float, float] = (1.0, 1.0)
    """x/c of forced transition on the upper and the lower side"""
    reference_length: float | None = None
    """length of the Reynolds number and the coefficients [m]; the chord where none is given"""
    moment_point: float = 0.25
    """x/c of the moment"""
    span: float = 0.5
    """where on a blade the section is taken; a 2D design has but one"""
    time_limit: float = 60.0
    """longest time of the solver [s]"""

    @property
    def angles(self) -> tuple[float, ...]:
        """The angles of attack [deg]."""
        return self.alpha if isinstance(self.alpha, tuple) else (self.alpha,)

    def polar(self, built: BuiltDesign) -> Polar:
        """The polar of what is built; PolarError where the solver is missing or gives nothing."""
        if built.outline is not None:
            subject = exact_airfoil(built.design, built.outline)
        else:
            subject = airfoil_of(built.built if built.design.dimension == 2 else built.built.section(self.span))
        own = {"reynolds", "alpha", "span"}
        conditions: dict[str, Any] = {name: value for name, value in asdict(self).items() if name not in own}
        return polar(subject, self.reynolds, self.angles, **conditions)


@dataclass(frozen=True, kw_only=True)
class PolarFigure(Quantity):
    """A coefficient at an operating point; at several angles one figure each, as `cruise.cl@4`."""

    point: OperatingPoint
    """the flow"""
    coefficient: str
    """one of COEFFICIENTS"""
    design: str
    needs_curves: ClassVar[bool] = False

    def of(self, built: Mapping[str, BuiltDesign]) -> Any:
        own = built[self.design]
        found: Polar = own.once(self.point, lambda: self.point.polar(own))
        if not np.any(found.converged):
            raise PolarError("; ".join(found.failures) or f"{found.solver} did not converge")
        values = getattr(found, self.coefficient)
        if len(self.point.angles) == 1:
            return values[0]
        return {f"{self.name}@{angle:g}": value for angle, value in zip(found.alpha, values, strict=True)}

    def unit(self, designs: Mapping[str, Design]) -> str:  # noqa: ARG002 - coefficients have the same everywhere
        return "-"


def polar_figures(
    asked: str, points: Mapping[str, OperatingPoint], designs: Mapping[str, Design]
) -> list[Quantity] | None:
    """The quantities that `POINT.COEFFICIENT` or `DESIGN:POINT.COEFFICIENT` asks for.

    None where no such point is known; StudyError where there is no such coefficient.
    """
    design, sign, rest = asked.rpartition(":")
    point, _, coefficient = rest.partition(".")
    if point not in points or (sign and design not in designs):
        return None
    if coefficient not in COEFFICIENTS:
        raise StudyError(unknown(f"the quantity '{asked}'", coefficient, list(COEFFICIENTS)))
    several = len(designs) > 1
    return [
        PolarFigure(
            name=f"{each}:{rest}" if several else rest, design=each, point=points[point], coefficient=coefficient
        )
        for each in ([design] if sign else designs)
    ]
