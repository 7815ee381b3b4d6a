"""Elementary functions that are analytic, so that a complex step keeps its imaginary part."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
"""An array of float64, or of complex128 where a complex step is carried: a type checker cannot follow which."""
Reals = NDArray[np.float64]
"""An array that is real by nature, such as knots."""


def length(vectors: Array) -> Array:
    """Euclidean length of vectors (..., d) as (...), analytic: sqrt(sum x^2) without conjugation."""
    return np.sqrt(dot(vectors, vectors))


def cumulative_length(line: Array) -> Array:
    """Arc lengths (n,) along a polyline (n, d), from 0 at its first point."""
    steps = length(np.diff(line, axis=0))
    return np.concatenate([np.zeros(1, dtype=steps.dtype), np.cumsum(steps)])


def unit(vectors: Array) -> Array:
    """Vectors (..., d) divided by their `length`."""
    return vectors / length(vectors)[..., None]


def dot(a: Array, b: Array) -> Array:
    """Sum of products over the last axis, without conjugation."""
    # np.sum over an axis of two or three entries takes three times as long
    return np.asarray(np.einsum("...i,...i->...", a, b))


def cross(a: Array, b: Array) -> Array:
    """The vector product of vectors (..., 3), in a third of the time of `np.cross`."""
    product = np.empty(np.broadcast_shapes(a.shape, b.shape), dtype=np.result_type(a, b))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        np.multiply(a[..., i], b[..., j], out=product[..., k])
        product[..., k] -= a[..., j] * b[..., i]
    return product


def cross2(a: Array, b: Array) -> Array:
    """The scalar a_x b_y - a_y b_x of plane vectors (..., 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def turned_left(vectors: Array) -> Array:
    """Plane vectors (..., 2) turned by +90 deg: the tangent of a camber line becomes its normal to the upper side."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def magnitude(values: Array) -> Array:
    """|values| for real or complex values with a nonzero real part: the sign of the real part times the value."""
    return np.where(np.real(values) < 0.0, -values, values)


def angle(y: Array, x: Array) -> Array:
    """atan2(y, x) [rad] that carries complex parts: the real angle plus the first-order imaginary part."""
    real = np.arctan2(np.real(y), np.real(x))
    if not (np.iscomplexobj(y) or np.iscomplexobj(x)):
        return real
    square = np.real(x) ** 2 + np.real(y) ** 2
    return real + 1j * (np.real(x) * np.imag(y) - np.real(y) * np.imag(x)) / square


def concatenated(parts: Sequence[Array], axis: int) -> Array:
    """Arrays concatenated along a negative axis, the other axes broadcast: some may carry a batch, others not."""
    own = [part.shape[axis] for part in parts]
    rest = np.broadcast_shapes(*[(*part.shape[:axis], 1, *part.shape[axis:][1:]) for part in parts])
    shapes = [(*rest[:axis], count, *rest[axis:][1:]) for count in own]
    return np.concatenate([np.broadcast_to(part, shape) for part, shape in zip(parts, shapes, strict=True)], axis=axis)


def radians(degrees: Array) -> Array:
    """Degrees to radians for real or complex values."""
    return np.asarray(degrees) * (np.pi / 180.0)


def degrees(values: Array) -> Array:
    """Radians to degrees for real or complex values."""
    return np.asarray(values) * (180.0 / np.pi)


def frozen(values: Any) -> Array:
    """A read-only array of float64, or of complex128 where the values are complex."""
    array = np.array(values, dtype=np.complex128 if np.iscomplexobj(values) else np.float64)
    array.setflags(write=False)
    return array
