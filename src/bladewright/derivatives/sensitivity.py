"""Derivatives of any quantity of what a design builds, by the complex step."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from bladewright.derivatives.complex_step import STEP, built, stepped, varied
from bladewright.derivatives.patterns import Patterns, chosen
from bladewright.designs import Design
from bladewright.errors import BladewrightError, DerivativeError
from bladewright.numerics.elementary import Array

Quantity = Callable[[Any], Any]
"""An analytic function of what is built: it carries complex numbers."""
NUDGE = 1e-6
"""Relative change of a parameter by which a quantity that returned real numbers is tested for having lost a derivative:
small enough for any design to be built, and far above rounding."""
UNCHANGED = 1e-10
"""Relative change of a quantity below which it counts as rounding: NUDGE times 1e-4."""
_CURE = (
    "use what carries complex numbers: sqrt(sum(x * x)) for a norm or abs, values compared on .real, no float(), and "
    "the fields of the build that are arrays"
)


def sensitivity(design: Design, quantity: Quantity, *, free: Patterns = None, knots: Any = None) -> dict[str, Array]:
    """Derivatives of a quantity by the design's parameters, by path, in the order of `design.parameters()`.

    `quantity` takes what the design builds and returns a number or an array of any shape, in metres and radians; the
    derivative has its shape, per unit of the parameter's field. It is exact to rounding: the quantity is computed for a
    build that carries a complex step (Squire and Trapp 1998), so it must be made of analytic operations that carry
    complex numbers. `free` are patterns of paths such as "stagger[*]", where None every parameter; `knots` are
    held, where None the design's own.

    Raises DerivativeError where the quantity loses the imaginary part or gives no finite numbers, and DesignError where
    a pattern matches no parameter or the design cannot be built.

    >>> import bladewright as bw
    >>> section = bw.UnifiedSection(
    ...     name="vane", length_unit="mm", axial_chord=40.0, stagger=-30.0, metal_angle_in=10.0, metal_angle_out=-60.0,
    ...     tangent_in=0.4, tangent_out=0.5, leading_edge_radius=0.02, trailing_edge_radius=0.01,
    ...     thickness_upper=(0.05, 0.08, 0.03), thickness_lower=(0.05, 0.06, 0.03),
    ... )
    >>> found = bw.sensitivity(section, lambda section: section.area, free="axial_chord")
    >>> bool(abs(found["axial_chord"] * 40.0 / (2.0 * section.build().area) - 1.0) < 1e-12)
    True
    """
    base = built(design, knots)
    paths = chosen(design, free)
    return differentiated(design, base, quantity, paths, stepped(design, base, paths))


def differentiated(
    design: Design, base: Any, quantity: Quantity, paths: Sequence[str], carried: Iterable[Any]
) -> dict[str, Array]:
    """Derivatives of a quantity by path, from builds that carry a step on each parameter; `base` is the design's own.

    Raises as `sensitivity` does.
    """
    value = value_of(quantity, base)
    found: dict[str, Array] = {}
    real: list[str] = []
    for path, carrying in zip(paths, carried, strict=True):
        rate = _value(quantity, carrying, path)
        if rate.shape != value.shape:
            raise DerivativeError(f"the quantity has shape {value.shape}, but {rate.shape} with a step on {path}")
        if not np.iscomplexobj(rate):
            real.append(path)
        found[path] = np.imag(rate) / STEP
        _check_finite(found[path], path)
    _check_real(design, base, quantity, value, real)
    return found


def value_of(quantity: Quantity, base: Any) -> Array:
    """The quantity of what a design builds, as an array of numbers."""
    return _array(quantity(base), "the design")


def _value(quantity: Quantity, carrying: Any, path: str) -> Array:
    try:
        with warnings.catch_warnings(), np.errstate(invalid="ignore", divide="ignore"):
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            return _array(quantity(carrying), f"a design that carries a complex step on {path}")
    except BladewrightError:
        raise
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise DerivativeError(f"the quantity fails with a complex step on {path} ({reason}): {_CURE}") from error


def _array(value: Any, what: str) -> Array:
    try:
        array = np.asarray(value)
    except ValueError:
        array = np.asarray(None)
    if array.dtype.kind not in "fciu":
        raise DerivativeError(
            f"the quantity of {what} is a {type(value).__name__}: a number or an array of numbers is needed; return "
            "one array, made of several by np.concatenate or np.stack"
        )
    return array


def _check_finite(value: Array, path: str) -> None:
    if not np.isfinite(value).all():
        raise DerivativeError(
            f"the derivative by {path} is not finite: the quantity has a root, a quotient or an angle that is singular "
            "at this design; leave out the points where it is, or change the design a little"
        )


def _check_real(design: Design, base: Any, quantity: Quantity, value: Array, paths: Sequence[str]) -> None:
    """Refuse a quantity that stayed real for steps on these parameters, but changes when they all change a little."""
    if not paths:
        return
    own = design.parameters()
    nudges = {path: own[path] + NUDGE * (own[path] or 1.0) for path in paths}
    nudged = value_of(quantity, next(varied(design, base, [nudges])))
    change = np.max(np.abs(nudged - value), initial=0.0)  # real: a difference of real values
    if change > UNCHANGED * np.max(np.abs(value), initial=0.0):  # real: the same
        others = f" and {len(paths) - 1} others" if len(paths) > 1 else ""
        raise DerivativeError(
            f"the quantity is real for a design that carries a complex step on {paths[0]}{others}, yet changes by "
            f"{change:.3g} when they grow by {NUDGE:g} of themselves: its derivative was lost; {_CURE}"
        )
