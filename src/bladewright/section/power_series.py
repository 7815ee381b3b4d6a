"""Truncated power series: a formula evaluated with them gives its exact derivatives along with its values."""

from collections.abc import Callable, Sequence
from math import comb, factorial

import numpy as np

from bladewright.numerics.elementary import Array, Reals

NEAR = 0.2
"""size of z up to which log(1 + z) / z is summed as a power series: beyond it the quotient loses less than a digit
[-]"""
TERMS = 26
"""terms of that power series: 0.2^26 is below 1e-18"""


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


def logarithm(at: Series) -> Series:
    """The natural logarithm of a series with a positive value."""
    a = at.coefficients
    terms = [np.log(a[0])]
    for k in range(1, len(a)):
        rest = a[k] - sum(i * terms[i] * a[k - i] for i in range(1, k)) / k
        terms.append(rest / a[0])
    return Series(terms)


def sine_and_cosine(phase: Series) -> tuple[Series, Series]:
    """Sine and cosine of a series."""
    a = phase.coefficients
    sine, cosine = [np.sin(a[0])], [np.cos(a[0])]
    for k in range(1, len(a)):
        sine.append(sum((i * a[i] * cosine[k - i] for i in range(2, k + 1)), a[1] * cosine[k - 1]) / k)
        cosine.append(-sum((i * a[i] * sine[k - i] for i in range(2, k + 1)), a[1] * sine[k - 1]) / k)
    return Series(sine), Series(cosine)


def hyperbolic_tangent(at: Series) -> Series:
    """The hyperbolic tangent of a series."""
    a = at.coefficients
    terms, slopes = [np.tanh(a[0])], [1.0 - np.tanh(a[0]) ** 2]
    for k in range(1, len(a)):
        terms.append(sum((i * a[i] * slopes[k - i] for i in range(2, k + 1)), a[1] * slopes[k - 1]) / k)
        slopes.append(-sum((terms[i] * terms[k - i] for i in range(1, k + 1)), terms[0] * terms[k]))
    return Series(terms)


def composed(outer: Series, inner: Series) -> Series:
    """The series of outer(inner - its value), as far as both are known; `outer` is about the inner's value."""
    terms = inner.coefficients
    step = Series([np.zeros(np.shape(terms[0])), *terms[1:]])
    value: Series | Array = outer.coefficients[inner.order]
    for k in range(inner.order - 1, -1, -1):
        value = step * value + outer.coefficients[k]
    return value if isinstance(value, Series) else Series([value])


def differentiated(series: Series) -> Series:
    """The derivative of a series, one order less."""
    return Series([(k + 1) * each for k, each in enumerate(series.coefficients[1:])])


def relative_log_series(at: Series) -> Series:
    """log(1 + z) / z of a series with a real part above -1, also about zero."""
    z = at.value
    near = np.real(z * z) < NEAR**2
    close, wide = np.where(near, z, 0.0), np.where(near, 1.0, z)
    logs = [np.log(1.0 + wide), *((-1.0) ** (k + 1) / k / (1.0 + wide) ** k for k in range(1, at.order + 1))]
    terms: list[Array] = []
    for k, log in enumerate(logs):
        power = sum((-1.0) ** n / (n + 1.0) * comb(n, k) * close ** (n - k) for n in range(k, TERMS))
        terms.append(np.where(near, power, (log - terms[-1] if k else log) / wide))
    return composed(Series(terms), at)


def relative_exponential(z: Array) -> Array:
    """(exp(z) - 1) / z, also at zero; an imaginary part to first order."""
    return _by_argument(z, np.expm1, np.exp, lambda x: 0.5 + x / 3.0 + x * x / 8.0)


def relative_logarithm(w: Array) -> Array:
    """log(1 + w) / w for real parts above -1, also at zero; an imaginary part to first order."""
    return _by_argument(w, np.log1p, lambda x: 1.0 / (1.0 + x), lambda x: -0.5 + x * 2.0 / 3.0 - x * x * 0.75)


RealFunction = Callable[[Reals], Reals]


def _by_argument(z: Array, function: RealFunction, slope: RealFunction, near_zero: RealFunction) -> Array:
    """f(z) / z of a function with f(0) = 0 and f'(0) = 1; its derivative near zero by a power series."""
    real = np.real(z)
    nonzero = np.where(real == 0.0, 1.0, real)
    value = np.where(real == 0.0, 1.0, function(nonzero) / nonzero)
    if not np.iscomplexobj(z):
        return value
    near = real * real < 1e-6
    wide = np.where(near, 1.0, real)
    growth = np.where(near, near_zero(real), (slope(wide) - function(wide) / wide) / wide)
    return value + 1j * np.imag(z) * growth


def polynomial_points(coefficients: Array, t: Array) -> Array:
    """Values (..., k, d) of polynomials with coefficients (..., n, d) at t (k,) or (..., k)."""
    found = coefficients[..., -1:, :] + 0.0 * t[..., None]
    for power in range(coefficients.shape[-2] - 2, -1, -1):
        found = found * t[..., None] + coefficients[..., power : power + 1, :]
    return found


def point_derivatives(x: Series, y: Series) -> Array:
    """Points and their derivatives (..., k, 2, order + 1) of two coordinates (..., k)."""
    return np.stack(np.broadcast_arrays(x.derivatives(), y.derivatives()), axis=-2)
