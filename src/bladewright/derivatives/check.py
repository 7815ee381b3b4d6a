"""Derivatives by the complex step against central differences, over a sweep of steps for each parameter.

The error of a central difference falls with the square of its step while truncation rules and rises with its inverse
where rounding does; that of the complex step falls with the square and stays at rounding. Agromayor et al. 2021,
section 5 and figure 13.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bladewright.blade.blade import Blade
from bladewright.derivatives.quantities import Named
from bladewright.derivatives.steps import stepped, varied, varied_nets
from bladewright.derivatives.tangents import STEP
from bladewright.derivatives.variables import Variables
from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

STEPS = 10.0 ** -np.arange(2.0, 11.0)
"""of central differences, in units of a parameter's scale"""
IMAGINARY = 10.0 ** -np.array([30.0, 20.0, 16.0, 12.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0])
"""of complex steps, in units of a parameter's scale; real parts are found for the smallest first"""
LIMIT = 1e-5
"""relative difference from the closest central difference that passes

Decades apart, central differences come as close as the 2/3 power of a build's rounding, some 1e-15 of its coordinates,
over the parameter's own share of them, which is 1e-5 at least for the radius of an edge: 3e-7 for every parameter of
the built-in examples. A derivative with anything left out misses by more than 1e-3.
"""
NOTHING = 1e-11
"""change of a quantity by one scale of a parameter, of the quantity, that is rounding"""
ELSEWHERE = {"pitch": "places the next blade", "span": "is the height of the section's solid"}
"""parameters that leave the shape of a blade or section as it is"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """The derivative of a quantity by one parameter, and the errors of differences and complex steps."""

    path: str
    size: float
    """root mean square of the derivative, in the quantity's unit per unit of the field"""
    scale: float
    """what steps are counted in, in units of the field"""
    steps: Reals
    """(k,) steps of the differences, of the scale"""
    errors: Reals
    """(k,) their errors over `size`"""
    imaginary: Reals
    """(m,) complex steps, of the scale"""
    floor: Reals
    """(m,) their errors over `size`"""
    failure: str = ""
    """why it fails; empty where it passes"""
    note: str = ""
    """why it has no effect where it need not"""

    @property
    def best(self) -> float:
        """The smallest error of a central difference; nan where there is none."""
        return float(np.min(self.errors)) if len(self.errors) else float("nan")


def sweeps(design: Design, base: Any, quantity: Named, space: Variables) -> Iterator[Sweep]:
    """The check of every parameter of `space` in turn; `base` is the design's build, whose knots are held."""
    whole = size_of(np.real(np.asarray(quantity.of(base))), quantity)
    for path, scale, carrying in zip(space.paths, space.scale, stepped(design, base, space.paths), strict=True):
        exact = np.imag(np.asarray(quantity.of(carrying))) / STEP
        yield _sweep(design, base, quantity, path, float(scale), exact, whole)


def size_of(rate: Array, quantity: Named) -> float:
    """Root mean square of a derivative: of the lengths of the points' vectors, or of the entries of anything else."""
    per_entry = rate.shape[-1] if quantity.points else 1
    return float(np.sqrt(per_entry * np.mean(np.square(rate))))


def _sweep(design: Design, base: Any, quantity: Named, path: str, scale: float, exact: Reals, whole: float) -> Sweep:
    size = size_of(exact, quantity)
    none: Reals = np.empty(0)
    bare = Sweep(path=path, size=size, scale=scale, steps=none, errors=none, imaginary=none, floor=none)
    if not np.isfinite(size):
        return replace(bare, failure=f"{path}: the derivative of the {quantity.name} is not finite")
    if size * scale <= NOTHING * whole:
        idle = f"{path} has no effect on the {quantity.name}"
        if quantity.points and path not in ELSEWHERE:
            return replace(bare, failure=idle)
        return replace(bare, note=f"{idle}: it {ELSEWHERE[path]}" if path in ELSEWHERE else idle)
    value = design.parameters()[path]
    steps, found = _differences(design, base, quantity, path, scale)
    carried = np.imag(_values(design, base, quantity, path, value + 1j * scale * IMAGINARY))
    sweep = replace(
        bare,
        steps=steps,
        errors=_errors(found, exact, quantity),
        imaginary=IMAGINARY,
        floor=_errors(carried / _beside(scale * IMAGINARY, carried), exact, quantity),
    )
    if sweep.best <= LIMIT:
        return sweep
    reason = (
        f"{path}: the closest central difference of the {quantity.name} is {sweep.best:.2g} of the derivative away, "
        f"at most {LIMIT:g} is allowed"
        if len(steps)
        else f"{path}: the design cannot be built beside its value, so that its derivative cannot be checked"
    )
    return replace(sweep, failure=reason)


def _differences(design: Design, base: Any, quantity: Named, path: str, scale: float) -> tuple[Reals, Array]:
    """Steps (k,) and central differences (k, ...), without the largest steps where these leave what can be built."""
    value = design.parameters()[path]
    for first in range(len(STEPS)):
        steps = STEPS[first:] * scale
        try:
            found = _values(design, base, quantity, path, np.ravel([value + steps, value - steps]))
        except DesignError:
            continue
        return STEPS[first:], (found[: len(steps)] - found[len(steps) :]) / _beside(2.0 * steps, found)
    return np.empty(0), np.empty(0)


def _values(design: Design, base: Any, quantity: Named, path: str, values: Array) -> Array:
    """The quantity (k, ...) at values (k,) of one parameter."""
    changes = [{path: value} for value in values]
    if not (quantity.points and isinstance(base, Blade)):
        return np.array([quantity.of(each) for each in varied(design, base, changes)])
    nets = [net.reshape(len(values), -1, 3) for net in varied_nets(base, changes)]
    return np.concatenate(nets, axis=1)


def _errors(found: Array, exact: Array, quantity: Named) -> Reals:
    size = size_of(exact, quantity)
    return np.array([size_of(each - exact, quantity) / size for each in found])


def _beside(steps: Reals, values: Array) -> Reals:
    return steps.reshape(-1, *(1,) * (values.ndim - 1))
