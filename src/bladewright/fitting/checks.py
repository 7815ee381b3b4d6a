"""Checks of the arguments of fits; each refusal names the argument, its value and what is needed."""

from collections.abc import Container, Iterable, Iterator
from contextlib import contextmanager
from numbers import Integral, Real
from typing import Any

import numpy as np

from bladewright.errors import DesignError, FitError, GeometryError
from bladewright.nurbs.basis import Reals


@contextmanager
def refusing() -> Iterator[None]:
    """Make refusals of values that no design, curve or surface can have those of a fit."""
    try:
        yield
    except (DesignError, GeometryError) as error:
        raise FitError(str(error)) from error


def is_number(value: Any) -> bool:
    """Whether the value is one real number, and no truth value."""
    return isinstance(value, Real) and not isinstance(value, bool)


def check_positive(name: str, value: Any, needed: str) -> None:
    """Refuse anything but a finite number above zero."""
    if not is_number(value) or not 0.0 < value < float("inf"):
        raise FitError(f"{name} is {value!r}: {needed}")


def check_whole(**counts: Any) -> None:
    """Refuse anything but whole numbers."""
    for name, value in counts.items():
        if not is_number(value) or not isinstance(value, Integral):
            raise FitError(f"{name} is {value!r}: a whole number is needed")


def check_kind(start: Any, kind: type) -> None:
    """Refuse a start of another kind."""
    if start is not None and not isinstance(start, kind):
        raise FitError(f"start is {start!r}: a {kind.__name__} is needed, or none")


def check_progress(progress: Any) -> None:
    """Refuse what cannot be told how far a fit is."""
    if progress is not None and not callable(progress):
        raise FitError(f"progress is {progress!r}: a function of one text is needed, such as print")


def reals(what: str, given: Any, cure: str) -> Reals:
    """A new array of what was given, which may be complex where no imaginary part is left; raises FitError else."""
    try:
        found = np.asarray(given)
        real = np.array(found.real if np.iscomplexobj(found) else found, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise FitError(f"{what} are not numbers ({error}): {cure}") from error
    if np.iscomplexobj(found) and np.any(found.imag):
        raise FitError(f"{what} are complex, and an imaginary part is not zero: {cure}")
    return real


def checked_points(what: str, given: Any, dimensions: Container[int], needed: str) -> Reals:
    """The finite points (n, d) that were given, with d among the dimensions; raises FitError for anything else."""
    points = reals(what, given, needed)
    if points.ndim != 2 or points.shape[1] not in dimensions:
        raise FitError(f"{what} have the shape {points.shape}: {needed}")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise FitError(
            f"{len(wrong)} of the {len(points)} rows of {what} are not finite, the first of them row {wrong[0]} "
            f"({points[wrong[0]].tolist()}): leave them out"
        )
    return points


def texts(name: str, given: Any) -> tuple[str, ...]:
    """The patterns of one argument, of one text or several."""
    found = (given,) if isinstance(given, str) else tuple(given) if isinstance(given, Iterable) else (given,)
    wrong = [each for each in found if not isinstance(each, str)]
    if wrong:
        raise FitError(f"{name} holds {wrong[0]!r}: patterns of parameters are needed, such as 'stagger[*]'")
    return found
