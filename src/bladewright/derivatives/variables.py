"""A design as a vector for an optimiser: scaled, bounded variables, and objectives with exact gradients."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self, final

import numpy as np
from numpy.typing import ArrayLike

from bladewright.derivatives.complex_step import built, stepped
from bladewright.derivatives.patterns import Patterns, chosen, matching
from bladewright.derivatives.sensitivity import Quantity, differentiated, value_of
from bladewright.designs import Design, unit_at
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, frozen
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS


@final
class Builds:
    """What the design of a vector builds, and the builds that carry a step; those of the last vector are cached."""

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
        """The builds that carry a step on each parameter in turn."""
        design, base = self.at(x)
        if self._stepped is None:
            self._stepped = list(stepped(design, base, self.paths))
        return self._stepped


@final
class Objective:
    """A quantity of what a design builds as a function of the vector of `Variables`, at held knots.

    Several objectives of the same variables share one build of each vector. Called as a function, an objective returns
    value and derivatives together, as scipy.optimize.minimize takes them with jac=True.
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


ANGLE_SCALE = 10.0
"""Scale of an angle [deg]: with LENGTH_SCALE, one unit of either moves the surface by about a tenth of the chord."""
LENGTH_SCALE = 0.1
"""Scale of a length, in chords."""
Bounds = Mapping[str, tuple[float, float]]
"""Lowest and highest values by pattern."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Variables:
    """Some parameters of a design as a vector x, each divided by its scale; made by `variables`."""

    origin: Design
    """the design from which a search starts"""
    paths: tuple[str, ...]
    """the parameters, in the order of x"""
    scale: Reals
    """(n,) what one unit of x is, in the units of the parameters' fields"""
    low: Reals
    """(n,) lowest values, in the units of the fields"""
    high: Reals
    """(n,) highest values, in the units of the fields"""
    knots: Any
    """held in all builds; None for designs without knots"""

    @property
    def x0(self) -> Reals:
        """The vector (n,) of the origin."""
        return self.vector(self.origin)

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Lowest and highest entry of x, as scipy.optimize takes them."""
        return [
            (float(low), float(high)) for low, high in zip(self.low / self.scale, self.high / self.scale, strict=True)
        ]

    def vector(self, design: Design) -> Reals:
        """The vector (n,) of a design."""
        values = design.parameters()
        return np.array([values[path] for path in self.paths]) / self.scale

    def design(self, x: ArrayLike) -> Design:
        """The design of a vector; raises DesignError where a value is refused."""
        values = np.asarray(x, dtype=np.float64) * self.scale
        return self.origin.changed({path: float(value) for path, value in zip(self.paths, values, strict=True)})

    def build(self, x: ArrayLike) -> Any:
        """What the design of a vector builds, at the held knots."""
        return built(self.design(x), self.knots)

    def gradient(self, sensitivities: Mapping[str, ArrayLike]) -> Array:
        """Derivatives (..., n) by x of a quantity (...) whose derivatives by path are given, as `sensitivity` does."""
        missing = [path for path in self.paths if path not in sensitivities]
        if missing:
            raise DesignError(f"the derivative by {missing[0]} is missing: give all of {', '.join(self.paths)}")
        columns = [np.asarray(sensitivities[path]) * scale for path, scale in zip(self.paths, self.scale, strict=True)]
        return np.stack(columns, axis=-1)

    def objective(self, quantity: Quantity) -> Objective:
        """A quantity of the build as a function of x, with its derivatives."""
        return Objective(builds=self._builds, gradient=self.gradient, quantity=quantity)

    def restarted(self, x: ArrayLike) -> Self:
        """The same variables from another origin, at the knots that its own build selects.

        For use between the stages of a search: within one, knots are held, or a refinement would make the objective
        jump.
        """
        design = self.design(x)
        return replace(self, origin=design, knots=getattr(design.build(), "knots", None))

    @cached_property
    def _builds(self) -> Builds:
        return Builds(design_of=self.design, paths=self.paths, knots=self.knots)


def variables(
    design: Design,
    *,
    free: Patterns = None,
    bounds: Bounds | None = None,
    changes: Bounds | None = None,
    scale: Mapping[str, float] | None = None,
    knots: Any = None,
) -> Variables:
    """Some parameters of a design as a scaled and bounded vector, for scipy.optimize and others.

    `free` are patterns of paths, where None every parameter. `bounds` are lowest and highest values by pattern, in the
    unit of the field; `changes` the same counted from the design's own value, such as {"stagger*": (-5.0, 5.0)}; what
    neither names is unbounded. `scale` is what one unit of x is, by pattern, in the unit of the field; elsewhere an
    angle's is 10 deg, a length's a tenth of the chord and a proportion's the largest of its field, so that one unit of
    any entry moves the surface by a similar amount. `knots` are held, where None those that the design selects.

    Raises DesignError where a pattern matches no free parameter, two patterns bound or scale one parameter, or the
    design lies outside its bounds.

    >>> import bladewright as bw
    >>> from scipy.optimize import NonlinearConstraint, minimize
    >>> vane = bw.UnifiedSection(
    ...     name="vane", length_unit="mm", axial_chord=40.0, stagger=-30.0, metal_angle_in=10.0, metal_angle_out=-60.0,
    ...     tangent_in=0.4, tangent_out=0.5, leading_edge_radius=0.02, trailing_edge_radius=0.01,
    ...     thickness_upper=(0.05, 0.08, 0.03), thickness_lower=(0.05, 0.06, 0.03),
    ... )
    >>> space = bw.variables(vane, free=["thickness*", "stagger"], bounds={"thickness*": (0.02, 0.2)})
    >>> area, x0 = space.objective(lambda section: 1e4 * section.area), space.x0
    >>> target = NonlinearConstraint(area.value, 2.2, 2.2, jac=area.jacobian)
    >>> found = minimize(lambda x: (((x - x0) ** 2).sum(), 2.0 * (x - x0)), x0, jac=True, bounds=space.bounds,
    ...                  constraints=target, method="SLSQP")
    >>> f"{1e4 * space.build(found.x).area:.6f} cm2"
    '2.200000 cm2'
    """
    paths = chosen(design, free)
    values = design.parameters()
    base = built(design, knots)
    own = np.array([values[path] for path in paths])
    sizes = _by_path(scale or {}, paths, "scale")
    scales = np.array(
        [_checked_scale(path, sizes[path]) if path in sizes else _scale(design, base, path) for path in paths]
    )
    low, high = np.full(len(paths), -np.inf), np.full(len(paths), np.inf)
    absolute, relative = _by_path(bounds or {}, paths, "bounds"), _by_path(changes or {}, paths, "changes")
    for place, path in enumerate(paths):
        if path in absolute and path in relative:
            raise DesignError(f"{path} is bounded twice, by bounds and by changes: name it in one of them")
        if path in absolute:
            low[place], high[place] = absolute[path]
        elif path in relative:
            low[place], high[place] = own[place] + np.asarray(relative[path])
        if not low[place] <= own[place] <= high[place]:
            raise DesignError(
                f"{path} is {own[place]:g}: it lies outside its bounds, {low[place]:g} to {high[place]:g}; widen them, "
                "or change the design"
            )
    return Variables(
        origin=design,
        paths=paths,
        scale=frozen(scales),
        low=frozen(low),
        high=frozen(high),
        knots=getattr(base, "knots", None) if knots is None else knots,
    )


def _by_path(given: Mapping[str, Any], paths: Sequence[str], what: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for pattern, value in given.items():
        for path in matching(pattern, paths):
            if path in found:
                raise DesignError(f"{path} is matched by two patterns in {what}: let one of them leave it out")
            found[path] = value
    return found


def _checked_scale(path: str, value: float) -> float:
    if not 0.0 < value < np.inf:
        raise DesignError(f"the scale of {path} is {value}: it must be positive and finite")
    return float(value)


def _scale(design: Design, base: Any, path: str) -> float:
    unit = unit_at(design, path)
    if unit == "deg":
        return ANGLE_SCALE
    if unit == "length":
        metre = UNITS[getattr(design, "length_unit", "m")]
        return LENGTH_SCALE * float(np.real(base.chord)) / metre
    field = path.partition("[")[0]
    squares = [float(value) ** 2 for name, value in design.parameters().items() if name.partition("[")[0] == field]
    return float(np.sqrt(max(squares))) or 1.0
