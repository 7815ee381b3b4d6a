"""The figures of a study as functions of one vector, with exact derivatives at held knots."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Self, final

import numpy as np

from bladewright.derivatives.complex_step import built, stepped
from bladewright.derivatives.net_jacobian import Bars, pullback
from bladewright.derivatives.sensitivity import differentiated
from bladewright.designs import Design, value_at
from bladewright.errors import DerivativeError, StudyError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.studies.adjoint import Adjoint
from bladewright.studies.quantities import BuiltDesign, Quantity, figures
from bladewright.studies.variables import Variable, changed_designs

Figures = Mapping[str, float]
Gradients = Mapping[str, Reals]
"""By name of a figure, its derivatives (n,) by the vector."""


@final
class Problem:
    """Figures of designs as functions of a vector x (n,), whose entries go from 0 to 1 between their bounds.

    Knots are held, because a refinement would make the figures jump; `renewed` takes others. What the last vector
    builds is kept, so that values and derivatives share it.
    """

    def __init__(
        self,
        designs: Mapping[str, Design],
        variables: Sequence[Variable],
        quantities: Sequence[Quantity],
        knots: Mapping[str, Any] | None = None,
    ) -> None:
        """At held knots by name of a design; without them every design selects its own.

        Raises StudyError where a variable has no derivative.
        """
        for variable in variables:
            if not variable.continuous:
                raise StudyError(
                    f"variable '{variable.name}' has choices, and a search with derivatives varies numbers between "
                    'bounds: leave it out, or search with method = "nsga2"'
                )
        self.designs, self.variables, self.quantities = dict(designs), tuple(variables), tuple(quantities)
        self.knots = dict(knots or {})
        self.low = np.array([variable.at(0.0) for variable in variables])
        self.width = np.array([variable.at(1.0) for variable in variables]) - self.low
        self._x: bytes = b""
        self._built: dict[str, BuiltDesign] = {}
        self._values: dict[str, Any] = {}
        self._bars: dict[str, Bars] = {}

    @property
    def start(self) -> Reals:
        """The vector (n,) of the designs as the study has them; StudyError where they lie outside the bounds."""
        return _within(self.vector({variable.name: variable.start for variable in self.variables}), self.variables)

    def vector(self, parameters: Mapping[str, Any]) -> Reals:
        """The vector (n,) of values of the variables by name."""
        values = np.array([float(parameters[variable.name]) for variable in self.variables])
        return (values - self.low) / self.width

    def parameters(self, x: Reals) -> dict[str, float]:
        """The values of the variables of a vector, by name."""
        values = self.low + np.asarray(x) * self.width
        return {variable.name: float(value) for variable, value in zip(self.variables, values, strict=True)}

    def designs_at(self, x: Reals) -> dict[str, Design]:
        """The designs of a vector by name; DesignError where one is refused."""
        return changed_designs(self.designs, self.variables, self.parameters(x))

    def renewed(self, x: Reals) -> Self:
        """The same problem at the knots that the designs of a vector select; DesignError where one is impossible."""
        knots = {name: getattr(design.build(), "knots", None) for name, design in self.designs_at(x).items()}
        return type(self)(self.designs, self.variables, self.quantities, knots)

    def figures(self, x: Reals) -> Figures:
        """The figures of a vector by name; DesignError where a design is impossible."""
        found: dict[str, float] = {}
        for quantity in self.quantities:
            values = figures(self._value(quantity, x), quantity.name)
            found |= {name: float(np.real(value)) for name, value in values.items()}
        for name, value in found.items():
            if not np.isfinite(value):
                raise StudyError(f"{name} is {value}, no finite number, so a search cannot begin or go on from there")
        return found

    def gradients(self, x: Reals) -> Gradients:
        """Their derivatives (n,) by the vector; DerivativeError where a quantity loses them."""
        total: dict[str, Array] = {name: np.zeros(len(self.variables)) for name in self.figures(x)}
        for name in self.designs:
            factors = self._factors(name)
            for figure, rates in self._rates(name, x, list(factors)).items():
                for path, rate in rates.items():
                    place, factor = factors[path]
                    total[figure][place] += factor * rate
        return total

    def _at(self, x: Reals) -> dict[str, BuiltDesign]:
        x = np.array(x, dtype=np.float64)
        if x.tobytes() != self._x:
            self._x, self._built, self._values, self._bars = b"", {}, {}, {}
            designs = self.designs_at(x)
            self._built = {name: BuiltDesign(each, built(each, self.knots.get(name))) for name, each in designs.items()}
            self._x = x.tobytes()
        return self._built

    def _value(self, quantity: Quantity, x: Reals) -> Any:
        own = self._at(x)
        if quantity.name not in self._values:
            if isinstance(quantity, Adjoint):
                self._values[quantity.name], self._bars[quantity.name] = quantity.solved(own)
            else:
                self._values[quantity.name] = quantity.of(own)
        return self._values[quantity.name]

    def _factors(self, name: str) -> dict[str, tuple[int, float]]:
        """Of the paths of a design: the entry of the vector that moves it, and its derivative by that."""
        found: dict[str, tuple[int, float]] = {}
        for place, variable in enumerate(self.variables):
            for design, path in variable.targets:
                if design == name:
                    own = value_at(self.designs[name], path) if variable.relative else 1.0
                    found[path] = place, float(own) * self.width[place]
        return found

    def _rates(self, name: str, x: Reals, paths: list[str]) -> dict[str, dict[str, Any]]:
        """Derivatives of the figures by the paths of one design, by figure and path."""
        own = self._at(x)
        design, base = own[name].design, own[name].built
        concerned = [each for each in self.quantities if each.design in {None, name}]
        found: dict[str, dict[str, Any]] = {}
        for quantity in concerned:
            if isinstance(quantity, Adjoint):
                self._value(quantity, x)
                found[quantity.name] = pullback(
                    design, self._bars[quantity.name], free=paths, knots=self.knots.get(name)
                )
        direct = [each for each in concerned if not isinstance(each, Adjoint)]
        if not (paths and direct):
            return found
        try:
            rates = differentiated(design, base, self._stacked(direct, name, x), paths, stepped(design, base, paths))
        except DerivativeError as error:
            asked = ", ".join(each.name for each in direct)
            cure = 'a figure of a solver needs its adjoint, or a search with method = "nsga2"'
            raise DerivativeError(f"{asked}: {error}; {cure}") from error
        names = [figure for each in direct for figure in figures(self._value(each, x), each.name)]
        for place, figure in enumerate(names):
            found[figure] = {path: rate[place] for path, rate in rates.items()}
        return found

    def _stacked(self, quantities: Sequence[Quantity], name: str, x: Reals) -> Callable[[Any], Array]:
        """The quantities as one array of what one of the designs builds, the others held."""
        own = self._at(x)

        def of(carrying: Any) -> Array:
            all_built = {**own, name: BuiltDesign(own[name].design, carrying)}
            return np.array([value for each in quantities for value in figures(each.of(all_built), each.name).values()])

        return of


def _within(x: Reals, variables: Sequence[Variable]) -> Reals:
    """A vector inside the bounds; StudyError where it is not."""
    for entry, variable in zip(x, variables, strict=True):
        if not -1e-9 <= entry <= 1.0 + 1e-9:
            raise StudyError(
                f"variable '{variable.name}' is {variable.start:g} in the design, outside its bounds "
                f"{variable.at(0.0):g} to {variable.at(1.0):g}: widen them, or begin with another design"
            )
    return np.clip(x, 0.0, 1.0)
