"""Checks of the arguments of fits; each refusal names the argument, its value and what is needed."""

from collections.abc import Iterator
from contextlib import contextmanager
from numbers import Real
from typing import Any

from bladewright.errors import DesignError, FitError


@contextmanager
def refusing() -> Iterator[None]:
    """Make refusals of values that no design can have those of a fit."""
    try:
        yield
    except DesignError as error:
        raise FitError(str(error)) from error


def is_number(value: Any) -> bool:
    """Whether the value is one real number, and no truth value."""
    return isinstance(value, Real) and not isinstance(value, bool)


def check_positive(name: str, value: Any, needed: str) -> None:
    """Refuse anything but a finite number above zero."""
    if not is_number(value) or not 0.0 < value < float("inf"):
        raise FitError(f"{name} is {value!r}: {needed}")
