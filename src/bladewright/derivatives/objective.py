"""A quantity of what a design builds, as a function of a vector, with its derivatives."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from bladewright.derivatives.sensitivity import Quantity, differentiated, value_of
from bladewright.derivatives.steps import built, stepped
from bladewright.designs import Design
from bladewright.numerics.elementary import Array


@final
class Builds:
    """What a vector's design builds, and builds that carry a step; those of the last vector are kept."""

    def __init__(self, *, design_of: Callable[[Array], Design], paths: Sequence[str], knots: Any) -> None:
        self.design_of, self.paths, self.knots = design_of, tuple(paths), knots
        self._last: bytes = b""
        self._design: Any = None
        self._base: Any = None
        self._stepped: list[Any] | None = None

    def at(self, x: ArrayLike) -> tuple[Design, Any]:
        """The design of a vector and what it builds."""
        values = np.array(x, dtype=np.float64)
        if values.tobytes() != self._last or self._base is None:
            self._base, self._stepped = None, None
            self._design = self.design_of(values)
            self._base = built(self._design, self.knots)
            self._last = values.tobytes()
        return self._design, self._base

    def stepped(self, x: ArrayLike) -> list[Any]:
        """Builds that carry a step on each parameter in turn."""
        design, base = self.at(x)
        if self._stepped is None:
            self._stepped = list(stepped(design, base, self.paths))
        return self._stepped


@final
class Objective:
    """A quantity of what a design builds as a function of the vector of `Variables`, at held knots.

    Several objectives of the same variables share one build a vector. An objective itself gives value and derivatives
    together, as scipy.optimize.minimize takes them with jac=True.
    """

    def __init__(
        self, *, builds: Builds, gradient: Callable[[Mapping[str, ArrayLike]], Array], quantity: Quantity
    ) -> None:
        self._builds, self._gradient, self.quantity = builds, gradient, quantity

    def __call__(self, x: ArrayLike) -> tuple[Any, Array]:
        """Value and derivatives."""
        return self.value(x), self.jacobian(x)

    def value(self, x: ArrayLike) -> Any:
        """The quantity, a float or an array (...); raises DesignError where the design cannot be built."""
        found = value_of(self.quantity, self._builds.at(x)[1])
        return float(found) if found.ndim == 0 else found

    def jacobian(self, x: ArrayLike) -> Array:
        """Its derivatives (..., n) by the entries of x."""
        design, base = self._builds.at(x)
        return self._gradient(differentiated(design, base, self.quantity, self._builds.paths, self._builds.stepped(x)))
