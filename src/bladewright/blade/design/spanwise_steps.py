"""Parameters that move the section at a span fraction v by their weights at v alone, stepped as one for derivatives."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from bladewright.designs import Law
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.laws import law_weights, number_paths


@dataclass(frozen=True, eq=False)
class SpanwiseStep:
    """A step of several parameters by the same amount.

    The derivative of the section at v by one of them is its weight at v times the derivative by their common step.
    """

    paths: tuple[str, ...]
    """(n,) of the parameters"""
    weights: Callable[[Reals], Reals]
    """(m, n) weights at v (m,)"""


def steps_of_laws(laws: Iterable[tuple[str, Law | None]]) -> Iterator[SpanwiseStep]:
    """Whole laws that shape the section at v by their values at v alone, by path: their weights make these values."""
    for path, law in laws:
        if law is not None:
            yield SpanwiseStep(tuple(number_paths(law, path)), partial(law_weights, law))


def step_alone(path: str) -> SpanwiseStep:
    """The step of a single parameter."""
    return SpanwiseStep((path,), _one)


def _one(v: Reals) -> Reals:
    return np.ones((len(v), 1))


def steps_of_edge(path: str, count: int, degree: int) -> Iterator[SpanwiseStep]:
    """Inner control points, of so many, of a channel's edge: at v it bows a stream line by its own point there."""
    for axis in "xr":
        paths = tuple(f"{path}[{i}].{axis}" for i in range(1, count - 1))
        if paths:
            yield SpanwiseStep(paths, partial(_edge_weights, count, min(count - 1, degree)))


def _edge_weights(count: int, degree: int, v: Reals) -> Reals:
    inner = basis(uniform_knots(count, degree), degree, v)[:, 1:-1]
    total = np.sum(inner, axis=1, keepdims=True)
    return np.asarray(inner / np.where(total > 0.0, total, 1.0))


def steps_of_walls(first: str, second: str, count: int) -> Iterator[SpanwiseStep]:
    """Inner control points, of as many on hub as on shroud: a stream line at v follows them by 1 - v and v."""
    for i in range(count):
        for axis in "xr":
            yield SpanwiseStep((f"{first}[{i}].{axis}", f"{second}[{i}].{axis}"), _between_walls)


def _between_walls(v: Reals) -> Reals:
    return np.stack([1.0 - v, v], axis=1)
