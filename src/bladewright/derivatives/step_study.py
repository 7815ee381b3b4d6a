"""Derivatives by the complex step against central differences, over a range of steps for each parameter.

The error of a central difference falls with the square of its step until rounding, which grows as its inverse, takes
over; that of the complex step falls with the square and stays at rounding. Agromayor et al. 2021, section 5 and figure
13.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from bladewright.derivatives.complex_step import STEP, stepped, varied, varied_nets
from bladewright.derivatives.quantities import NamedQuantity
from bladewright.derivatives.variables import Variables
from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

STEPS = 10.0 ** -np.arange(2.0, 11.0)
"""Steps of the differences, in units of a parameter's scale."""
IMAGINARY = 10.0 ** -np.array([30.0, 20.0, 16.0, 12.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0])
"""Complex steps, in units of a parameter's scale; the smallest is taken first."""
LIMIT = 1e-5
"""Largest relative error of the best difference that passes.

With steps a decade apart, central differences reach the 2/3 power of a build's rounding, some 1e-15 of its coordinates,
over the parameter's share of them, which is 1e-5 at least (for the radius of an edge): 3e-7 for every parameter of the
built-in examples. A derivative in which anything is left out is off by more than 1e-3.
"""
ROUNDING = 1e-13
"""Error of the best difference by one scale of the parameter, of the quantity's size, that passes as rounding: that of
a build, some 1e-15, over steps of a hundredth of a scale. The throat of LS89 has 3e-10 of its last thicknesses."""
DIFFERENCES = (
    ((1.0, -1.0), (0.5, -0.5)),
    ((0.0, 1.0, 2.0), (-1.5, 2.0, -0.5)),
    ((0.0, -1.0, -2.0), (1.5, -2.0, 0.5)),
)
"""Offsets in steps, and weights: a central difference, and one-sided ones of the same order for a parameter that lies
at its limit."""
NO_EFFECT = 1e-11
"""Relative change of a quantity by one scale of a parameter below which the parameter has no effect: it is rounding."""
ELSEWHERE = {
    "pitch": "places the next blade",
    "span": "is the height of the section's solid",
    "density": "is that of the metal",
    "disc": "shapes the wheel",
    "shroud_ring": "shapes the wheel",
}
"""Parameters and tables that do not change the shape of a blade or section, and what they do instead."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StepStudy:
    """The derivative of a quantity by one parameter, and the errors of differences and complex steps."""

    path: str
    size: float
    """root mean square of the derivative, in the quantity's unit per unit of the field"""
    scale: float
    """unit of the steps, in the unit of the field"""
    steps: Reals
    """(k,) steps of the differences, in scales"""
    errors: Reals
    """(k,) their errors over `size`"""
    imaginary: Reals
    """(m,) complex steps, in scales"""
    floor: Reals
    """(m,) their errors over `size`"""
    failure: str = ""
    """why it fails; empty where it passes"""
    note: str = ""
    """why it has no effect, where that is allowed"""

    @property
    def best(self) -> float:
        """The smallest error of a central difference; nan where there is none."""
        return float(np.min(self.errors)) if len(self.errors) else float("nan")


def step_studies(
    design: Design,
    base: Any,
    quantity: NamedQuantity,
    space: Variables,
    *,
    steps: Reals = STEPS,
    imaginary: Reals = IMAGINARY,
) -> Iterator[StepStudy]:
    """The study of every parameter of `space` in turn; `base` is the design's build, whose knots are held.

    `steps` are those of the differences and `imaginary` the complex steps, smallest first, in units of a parameter's
    scale.
    """
    whole = size_of(np.real(np.asarray(quantity.of(base))), quantity)
    for path, scale, carrying in zip(space.paths, space.scale, stepped(design, base, space.paths), strict=True):
        exact = np.imag(np.asarray(quantity.of(carrying))) / STEP
        yield _step_study(_Derivative(design, base, quantity, path, float(scale), exact, whole), steps, imaginary)


def size_of(rate: Array, quantity: NamedQuantity) -> float:
    """Root mean square of a derivative: of the lengths of the points' vectors, or of the entries of anything else."""
    per_entry = rate.shape[-1] if quantity.points else 1
    return float(np.sqrt(per_entry * np.mean(np.square(rate))))


class _Derivative(NamedTuple):
    """One derivative that is studied."""

    design: Design
    base: Any
    quantity: NamedQuantity
    path: str
    scale: float
    exact: Reals
    """by the complex step"""
    whole: float
    """size of the quantity"""

    def values(self, offsets: Array) -> Array:
        """The quantity (k, ...) at offsets (k,) of the parameter, in units of its scale."""
        value = self.design.parameters()[self.path]
        changes = [{self.path: value + self.scale * offset} for offset in offsets]
        if not (self.quantity.points and self.base.dimension == 3):
            return np.array([self.quantity.of(each) for each in varied(self.design, self.base, changes)])
        nets = [net.reshape(len(changes), -1, 3) for net in varied_nets(self.base, changes)]
        return np.concatenate(nets, axis=1)

    def errors(self, found: Array) -> Reals:
        """Errors (k,) of derivatives (k, ...) by one scale of the parameter, over the derivative's size."""
        size = size_of(self.exact, self.quantity)
        return np.array([size_of(each / self.scale - self.exact, self.quantity) / size for each in found])

    def differences(self, steps: Reals) -> tuple[Reals, Reals]:
        """Steps (k,) and errors (k,) of differences, without the largest steps where those cannot be built.

        They are central, or one-sided of the same order where a value lies at its limit.
        """
        for offsets, weights in DIFFERENCES:
            for first in range(len(steps)):
                kept = steps[first:]
                try:
                    found = self.values(np.outer(kept, offsets).ravel())
                except DesignError:
                    continue
                rows = np.tensordot(found.reshape(len(kept), len(offsets), *found.shape[1:]), weights, axes=(1, 0))
                return kept, self.errors(rows / _aligned(kept, rows))
        return np.empty(0), np.empty(0)

    def complex_steps(self, imaginary: Reals) -> tuple[Reals, Reals]:
        """Complex steps (k,) and errors (k,) of their derivatives, without the largest where those cannot be built."""
        for last in range(len(imaginary), 0, -1):
            kept = imaginary[:last]
            try:
                with np.errstate(all="ignore"):
                    carried = np.imag(self.values(1j * kept))
            except DesignError:
                continue
            return kept, self.errors(carried / _aligned(kept, carried))
        return np.empty(0), np.empty(0)


def _step_study(derivative: _Derivative, steps: Reals, imaginary: Reals) -> StepStudy:
    path, quantity, size = derivative.path, derivative.quantity, size_of(derivative.exact, derivative.quantity)
    none: Reals = np.empty(0)
    unmeasured = StepStudy(
        path=path, size=size, scale=derivative.scale, steps=none, errors=none, imaginary=none, floor=none
    )
    if not np.isfinite(size):
        return replace(unmeasured, failure=f"{path}: the derivative of the {quantity.name} is not finite")
    if size * derivative.scale <= NO_EFFECT * derivative.whole:
        no_effect = f"{path} has no effect on the {quantity.name}"
        elsewhere = ELSEWHERE.get(path.partition(".")[0])
        if quantity.points and elsewhere is None:
            return replace(unmeasured, failure=no_effect)
        return replace(unmeasured, note=f"{no_effect}: it {elsewhere}" if elsewhere else no_effect)
    small, floor = derivative.complex_steps(imaginary)
    kept, errors = derivative.differences(steps)
    study = replace(unmeasured, steps=kept, errors=errors, imaginary=small, floor=floor)
    if study.best <= LIMIT or study.best * size * derivative.scale <= ROUNDING * derivative.whole:
        return study
    reason = (
        f"{path}: the closest difference of the {quantity.name} is {study.best:.2g} of the derivative away, "
        f"at most {LIMIT:g} is allowed"
        if len(kept)
        else f"{path}: the design cannot be built beside its value, so that its derivative cannot be checked"
    )
    return replace(study, failure=reason)


def _aligned(steps: Reals, values: Array) -> Reals:
    """Steps (k,) with as many axes as values (k, ...)."""
    return steps.reshape(-1, *(1,) * (values.ndim - 1))
