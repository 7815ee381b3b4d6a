"""A figure whose derivatives by the surface a solver's adjoint gives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, final

from bladewright.derivatives.net_jacobian import Bars
from bladewright.errors import StudyError
from bladewright.studies.quantities import BuiltDesign, Quantity, UserFunction, digest, imported


@final
@dataclass(frozen=True, kw_only=True)
class Adjoint(Quantity):
    """A scalar of one design that a user's function computes together with its derivatives by points of the surfaces.

    The function takes what is built and returns the scalar and, by name of a surface, (u, v, bar) as `pullback` takes
    it: bar is the derivative of the scalar by the points there, as an adjoint solver gives it [per metre].
    """

    function: Callable[[Any], tuple[float, Bars]]
    """the solver and its adjoint"""
    design: str

    def of(self, built: Mapping[str, BuiltDesign]) -> float:
        return self.solved(built)[0]

    @property
    def source(self) -> str:
        return digest(self.function)

    def solved(self, built: Mapping[str, BuiltDesign]) -> tuple[float, Bars]:
        """The scalar and its derivatives by points; StudyError where the function gives something else."""
        found: Any = self.function(built[self.design].built)
        try:
            value, bars = found
            return float(value), dict(bars)
        except (TypeError, ValueError) as error:
            raise StudyError(
                f"the adjoint '{self.name}' returned a {type(found).__name__}: it must return the figure and its "
                "derivatives by points, as (value, {'upper': (u, v, bar)})"
            ) from error


def adjoint_of(quantity: Quantity) -> Adjoint:
    """The user's function of a quantity as one that returns derivatives too; StudyError where it is none."""
    if not isinstance(quantity, UserFunction):
        raise StudyError(f"'{quantity.name}' is no function: only a function of yours can give an adjoint")
    if quantity.design is None:
        raise StudyError(f"the adjoint '{quantity.name}' is of several designs: give one for each design")
    function = quantity.function if callable(quantity.function) else imported(quantity.function, quantity.folder)
    return Adjoint(name=quantity.name, design=quantity.design, function=function)
