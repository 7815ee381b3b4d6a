"""Truncated power series: a formula evaluated with them gives its exact derivatives along with its values."""

from collections.abc import Sequence
from math import factorial

import numpy as np

from bladewright.numerics.elementary import Array


class Series:
    """Power series c0 + c1 x + ... + cn x^n of many quantities at once, their coefficients (n + 1 arrays) of one shape.

    Sums, products and quotients with each other, with numbers and with arrays are series of the same order; with a
    single coefficient they are plain values. Reference: Griewank and Walther 2008, Evaluating Derivatives, table 13.1.
    """

    __array_ufunc__ = None  # an array on the left leaves the operation to the series

    def __init__(self, coefficients: Sequence[Array]) -> None:
        self.coefficients = tuple(coefficients)

    @property
    def value(self) -> Array:
        """The first coefficient."""
        return self.coefficients[0]

    @property
    def order(self) -> int:
        """The highest power kept."""
        return len(self.coefficients) - 1

    def derivatives(self) -> Array:
        """Value and derivatives (..., order + 1)."""
        scaled = [factorial(k) * np.asarray(each) for k, each in enumerate(self.coefficients)]
        return np.stack(np.broadcast_arrays(*scaled), axis=-1)

    def taken(self, where: slice) -> "Series":
        """The series at some places of the last axis."""
        return Series([each[..., where] for each in self.coefficients])

    def __neg__(self) -> "Series":
        return Series([-each for each in self.coefficients])

    def __add__(self, other: "Series | Array | complex") -> "Series":
        if not isinstance(other, Series):
            return Series([self.coefficients[0] + other, *self.coefficients[1:]])
        return Series([a + b for a, b in zip(self.coefficients, other.coefficients, strict=True)])

    def __sub__(self, other: "Series | Array | complex") -> "Series":
        if not isinstance(other, Series):
            return self + (-other)
        return Series([a - b for a, b in zip(self.coefficients, other.coefficients, strict=True)])

    def __rsub__(self, other: Array | complex) -> "Series":
        return -self + other

    def __mul__(self, other: "Series | Array | complex") -> "Series":
        if not isinstance(other, Series):
            return Series([each * other for each in self.coefficients])
        a, b = self.coefficients, other.coefficients
        return Series([_total([a[i] * b[k - i] for i in range(k + 1)]) for k in range(len(a))])

    def __truediv__(self, other: "Series | Array | complex") -> "Series":
        if not isinstance(other, Series):
            return Series([each / other for each in self.coefficients])
        quotient: list[Array] = []
        b = other.coefficients
        for k, a in enumerate(self.coefficients):
            known = [quotient[i] * b[k - i] for i in range(k)]
            quotient.append((a - _total(known) if known else a) / b[0])
        return Series(quotient)

    def __rtruediv__(self, other: Array | complex) -> "Series":
        return Series([np.asarray(other), *[np.zeros(())] * self.order]) / self

    def sqrt(self) -> "Series":
        """The root with a positive value; the value must not be zero where the order is above zero."""
        roots = [np.sqrt(self.coefficients[0])]
        for k in range(1, self.order + 1):
            known = [roots[i] * roots[k - i] for i in range(1, k)]
            rest = self.coefficients[k] - _total(known) if known else self.coefficients[k]
            roots.append(rest / (2.0 * roots[0]))
        return Series(roots)

    __radd__ = __add__
    __rmul__ = __mul__


def _total(terms: Sequence[Array]) -> Array:
    total = terms[0]
    for each in terms[1:]:
        total = total + each
    return total


def variable(values: Array, order: int, slope: float = 1.0) -> Series:
    """The series of values + slope * x, cut at an order."""
    zeros = np.zeros(np.shape(values))
    return Series([values, np.full(np.shape(values), slope), *[zeros] * order][: order + 1])


def sine(angle: Series) -> Series:
    """The sine of a series."""
    sines, cosines = [np.sin(angle.value)], [np.cos(angle.value)]
    steps = [power * each for power, each in enumerate(angle.coefficients)]
    for k in range(1, angle.order + 1):
        sines.append(_total([steps[i] * cosines[k - i] for i in range(1, k + 1)]) / k)
        cosines.append(-_total([steps[i] * sines[k - i] for i in range(1, k + 1)]) / k)
    return Series(sines)


def polynomial(coefficients: Sequence[Array], at: Series) -> Series:
    """c0 + c1 x + ... by Horner's rule at a series."""
    value: Series | Array = coefficients[-1]
    for each in reversed(coefficients[:-1]):
        value = value * at + each
    return at * 0.0 + value if not isinstance(value, Series) else value


def joined_series(parts: Sequence[Series]) -> Series:
    """Series put together along their last axis."""
    orders = range(parts[0].order + 1)
    rest = np.broadcast_shapes(*[np.shape(part.coefficients[k])[:-1] for part in parts for k in orders])

    def row(part: Series, k: int) -> Array:
        count = max(np.shape(each)[-1] for each in part.coefficients)
        return np.broadcast_to(part.coefficients[k], (*rest, count))

    return Series([np.concatenate([row(part, k) for part in parts], axis=-1) for k in orders])
