"""Laws of evolution: clamped uniform B-splines of degree min(n - 1, 3) over [0, 1]."""

from collections.abc import Iterator
from dataclasses import fields
from typing import Any, get_args, get_type_hints

import numpy as np

from bladewright.designs import ChordwiseLaw, Law, Part
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, basis, uniform_knots

DEGREE = 3
"""highest degree of a law: cubic laws are twice differentiable, so curvature along the span is continuous"""


def stacked(leaves: Any) -> Array:
    """Numbers, some of which may be batches (...), stacked as one array (..., n)."""
    if not any(isinstance(leaf, np.ndarray) for leaf in leaves):
        return np.array(leaves)
    return np.stack(np.broadcast_arrays(*[np.asarray(leaf) for leaf in leaves]), axis=-1)


def law_points(law: Law) -> tuple[Any, ...]:
    """The control points of a law: a constant has one."""
    return law if isinstance(law, tuple) else (law,)


def law_basis(count: int, v: Reals) -> Reals:
    """Values (len(v), count) of the basis functions of a law with `count` control points."""
    if count == 1:
        return np.ones((len(v), 1))
    degree = min(count - 1, DEGREE)
    return basis(uniform_knots(count, degree), degree, v)


class Span:
    """Evaluates laws at fixed span fractions v (m,); keeps the basis functions of each number of control points."""

    def __init__(self, v: Reals) -> None:
        self.v = v
        self._basis: dict[int, Reals] = {}

    def values(self, law: Law) -> Array:
        """The law's values (..., m)."""
        leaves = law_points(law)
        if len(leaves) not in self._basis:
            self._basis[len(leaves)] = law_basis(len(leaves), self.v)
        return stacked(leaves) @ self._basis[len(leaves)].T

    def control_values(self, laws: ChordwiseLaw) -> Array:
        """Values (..., m, n) of laws along the span (n,), one a control point along the chord."""
        return np.stack(np.broadcast_arrays(*[self.values(law) for law in laws]), axis=-1)

    def chordwise(self, laws: ChordwiseLaw, u: Reals) -> Array:
        """Values (..., m, len(u)) at u along the chord of control points that are laws along the span."""
        return self.control_values(laws) @ law_basis(len(laws), u).T


def laws_of(part: Part) -> Iterator[Law]:
    """The laws of evolution among the parameters of a part, constant ones too, and of the parts in it."""
    return (law for _, law in named_laws(part))


def named_laws(part: Part) -> Iterator[tuple[str, Law]]:
    """The laws of evolution among the parameters of a part, each with its path in the part."""
    hints = get_type_hints(type(part))
    for each in fields(part):
        value = getattr(part, each.name)
        if isinstance(value, Part):
            yield from ((f"{each.name}.{path}", law) for path, law in named_laws(value))
        elif "unit" not in each.metadata or value is None:
            continue
        elif float in get_args(hints[each.name]) or not isinstance(value, tuple):
            yield each.name, value
        else:
            # a list of numbers is a row of laws unless one number could be given instead
            yield from ((f"{each.name}[{i}]", law) for i, law in enumerate(value))


def inner_knots(count: int) -> Reals:
    """Inner knots of a law of `count` control points, where it is only twice differentiable."""
    return np.unique(uniform_knots(count, min(count - 1, DEGREE))[1:-1])[1:-1] if count > 1 else np.empty(0)
