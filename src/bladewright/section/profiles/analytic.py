"""Functions of truncated power series, and of numbers that carry an imaginary step, where numpy loses digits."""

from math import comb

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.section.thickness.series import Series

NEAR = 0.2
"""size of z up to which log(1 + z) / z is taken from its power series"""
TERMS = 26
"""of that series: 0.2^26 is below 1e-18"""


def logarithm(at: Series) -> Series:
    """The natural logarithm of a series with a positive value."""
    a = at.coefficients
    terms = [np.log(a[0])]
    for k in range(1, len(a)):
        rest = a[k] - sum(i * terms[i] * a[k - i] for i in range(1, k)) / k
        terms.append(rest / a[0])
    return Series(terms)


def waves(phase: Series) -> tuple[Series, Series]:
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


def slope(series: Series) -> Series:
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
    real = np.real(z)
    apart = np.where(real == 0.0, 1.0, real)
    value = np.where(real == 0.0, 1.0, np.expm1(apart) / apart)
    if not np.iscomplexobj(z):
        return value
    near = real * real < 1e-6
    wide = np.where(near, 1.0, real)
    growth = np.where(near, 0.5 + real / 3.0 + real * real / 8.0, (np.exp(wide) - np.expm1(wide) / wide) / wide)
    return value + 1j * np.imag(z) * growth


def relative_logarithm(w: Array) -> Array:
    """log(1 + w) / w for real parts above -1, also at zero; an imaginary part to first order."""
    real = np.real(w)
    apart = np.where(real == 0.0, 1.0, real)
    value = np.where(real == 0.0, 1.0, np.log1p(apart) / apart)
    if not np.iscomplexobj(w):
        return value
    near = real * real < 1e-6
    wide = np.where(near, 1.0, real)
    growth = np.where(
        near, -0.5 + real * 2.0 / 3.0 - real * real * 0.75, (1.0 / (1.0 + wide) - np.log1p(wide) / wide) / wide
    )
    return value + 1j * np.imag(w) * growth
