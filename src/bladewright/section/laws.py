"""Laws of evolution: clamped uniform B-splines of degree min(n - 1, 3) over [0, 1], or splines through stations.

What a law is stands in `bladewright.designs`; everything that depends on its kind is asked here.
"""

from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from scipy.interpolate import CubicSpline

from bladewright.designs import ChordwiseLaw, Law, Part, Stations
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, basis, greville, uniform_knots
from bladewright.section.stations import linear_weights, monotone_values, natural_weights

DEGREE = 3
"""highest degree of a law: cubic laws are twice differentiable, so curvature along the span is continuous"""
OVERSHOOT = 1e-3
"""How far a law must pass its stations to be said to overshoot, of the range of its values: less shows in no drawing,
and the rounded top of values that rise and fall passes the highest of them by as much [-]"""
SAMPLES = 33
"""Places between two stations at which a law's limits are checked: an extreme is missed by a 1/8,000 of the bend"""
_STEP = 1e-30
"""Complex step of the derivatives of a monotone spline by its values: nothing is subtracted, so it may be tiny [-]"""


def stacked(leaves: Any) -> Array:
    """Numbers, some of which may be batches (...), stacked as one array (..., n)."""
    if not any(isinstance(leaf, np.ndarray) for leaf in leaves):
        return np.array(leaves)
    return np.stack(np.broadcast_arrays(*[np.asarray(leaf) for leaf in leaves]), axis=-1)


def law_points(law: Law) -> tuple[Any, ...]:
    """The numbers of a law: its control points, or its values at stations; a constant has one."""
    if isinstance(law, Stations):
        return law.values
    return law if isinstance(law, tuple) else (law,)


def points_word(law: Law) -> str:
    """What a law's numbers are called: control points, or stations."""
    return "stations" if isinstance(law, Stations) else "control points"


def is_list(law: Law) -> bool:
    """Whether a law is given by a list of numbers: control points, or values at stations, also if there is only one."""
    return isinstance(law, tuple | Stations)


def stations_of(law: Law) -> Stations | None:
    """The stations at which a law is given; None for one by control points."""
    return law if isinstance(law, Stations) else None


def plain_law(points: Reals) -> float | tuple[float, ...]:
    """The law of real control points (n,): a number where there is one."""
    return tuple(points.tolist()) if len(points) > 1 else float(points[0])


def sampled_at(law: Law, stations: Stations) -> Stations:
    """A law of real numbers given by its own values at other stations, interpolated as theirs are."""
    return with_values(stations, np.real(Span(np.array(stations.span)).values(law)))


def with_values(stations: Stations, values: Reals) -> Stations:
    """The same stations with other values (n,)."""
    return replace(stations, values=tuple(values.tolist()))


def number_paths(law: Law, path: str) -> list[str]:
    """The paths of the numbers of the law that stands at a path."""
    if isinstance(law, Stations):
        return [f"{path}.values[{i}]" for i in range(len(law.values))]
    return [f"{path}[{i}]" for i in range(len(law))] if isinstance(law, tuple) else [path]


def places_of(law: Law) -> Reals:
    """Span fractions (n,) at which its numbers stand: stations, or Greville abscissae; those of a constant at 0.5."""
    if isinstance(law, Stations):
        return np.array(law.span)
    count = len(law_points(law))
    degree = min(count - 1, DEGREE)
    return np.array([0.5]) if count == 1 else greville(uniform_knots(count, degree), degree)


def same_kind(first: Law, second: Law) -> bool:
    """Whether two laws of equal numbers are equal along the span."""
    ways = [(each.span, each.interpolation) if isinstance(each, Stations) else None for each in (first, second)]
    return ways[0] == ways[1] and len(law_points(first)) == len(law_points(second))


def law_basis(count: int, v: Reals) -> Reals:
    """Values (len(v), count) of the basis functions of a law with `count` control points."""
    if count == 1:
        return np.ones((len(v), 1))
    degree = min(count - 1, DEGREE)
    return basis(uniform_knots(count, degree), degree, v)


def law_weights(law: Law, v: Reals) -> Reals:
    """Weights (m, n) with which a law's numbers make its values at v (m,).

    Those of a monotone spline through stations depend on the numbers, and are the derivatives by them: they sum to 1 as
    well, and a step of the whole law is a step of its value everywhere.
    """
    if not isinstance(law, Stations):
        return law_basis(len(law_points(law)), v)
    if law.interpolation == "linear":
        return linear_weights(law.span, v)
    if law.interpolation == "natural":
        return natural_weights(law.span, v)
    stepped = np.real(np.array(law.values)) + _STEP * 1j * np.eye(len(law.values))
    return np.imag(monotone_values(law.span, stepped, v)).T / _STEP


class Span:
    """Evaluates laws at fixed span fractions v (m,); keeps the weights of each kind of law."""

    def __init__(self, v: Reals) -> None:
        self.v = v
        self._weights: dict[Any, Reals] = {}

    def values(self, law: Law) -> Array:
        """The law's values (..., m)."""
        leaves = law_points(law)
        key: Any = len(leaves)
        if isinstance(law, Stations):
            if law.interpolation == "monotone":
                return monotone_values(law.span, stacked(leaves), self.v)
            key = law.span, law.interpolation
        if key not in self._weights:
            self._weights[key] = law_weights(law, self.v)
        return stacked(leaves) @ self._weights[key].T

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
    kind: Any = type(part)
    hints = _hints(kind)
    for each in fields(part):
        value, hint = getattr(part, each.name), hints[each.name]
        if value is None:
            continue
        if Stations in get_args(hint):
            yield each.name, value
        elif get_origin(hint) is tuple and Stations in get_args(get_args(hint)[0]):
            yield from ((f"{each.name}[{i}]", law) for i, law in enumerate(value))
        elif isinstance(value, Part):
            yield from ((f"{each.name}.{path}", law) for path, law in named_laws(value))


@cache
def _hints(kind: Any) -> dict[str, Any]:
    """The types of a part's fields, which take longer to find than anything else of a change."""
    return get_type_hints(kind)


def check_plain(laws: Iterable[tuple[str, Law]]) -> None:
    """Refuse laws along the span among paths and laws: a single section has none."""
    for path, law in laws:
        if is_list(law):
            what = "given at stations" if isinstance(law, Stations) else "a list"
            raise DesignError(f"{path} is {what}: a law along the span; a single section takes a number")


def joints_of(law: Law) -> Iterator[tuple[float, int]]:
    """Places inside (0, 1) where a law is not analytic, and how many of its derivatives are continuous there."""
    if isinstance(law, Stations):
        smooth = 0 if law.interpolation == "linear" else 2
        yield from ((place, smooth) for place in law.span[1:-1])
        return
    count = len(law_points(law))
    if count > 1:
        degree = min(count - 1, DEGREE)
        yield from ((float(knot), degree - 1) for knot in uniform_knots(count, degree)[degree + 1 : -degree - 1])


class Overshoot(NamedTuple):
    """Where a law between two stations passes the values of both."""

    law: str
    """path of the law"""
    v: float
    """span fraction of the farthest place"""
    value: float
    """the law's value there, in its unit"""
    amount: float
    """how far that is beyond the nearer of both values, in the unit of the law"""


def overshoots_of(law: Law, path: str) -> Iterator[Overshoot]:
    """The overshoots of a law of real numbers; only a natural spline through stations has any."""
    if not isinstance(law, Stations) or law.interpolation != "natural":
        return
    values, span = np.real(np.array(law.values)), np.array(law.span)
    spline = CubicSpline(span, values, bc_type="natural")
    for v in spline.derivative().roots(extrapolate=False):
        if np.isnan(v):
            continue
        piece = min(int(np.searchsorted(span, v, side="right")) - 1, len(span) - 2)
        value, ends = float(spline(v)), values[piece : piece + 2]
        amount = max(value - float(np.max(ends)), float(np.min(ends)) - value)
        if amount > OVERSHOOT * float(np.ptp(values)):
            yield Overshoot(path, float(v), value, amount)


def extremes_between(law: Law) -> tuple[tuple[float, float], ...]:
    """Places and real values where a law is smallest and largest between stations; none for one that stays between."""
    if not isinstance(law, Stations) or law.interpolation != "natural":
        return ()
    v = np.unique(np.concatenate([np.linspace(*pair, SAMPLES) for pair in pairwise(law.span)]))
    values = np.real(Span(v).values(law)).reshape(-1, len(v))
    found = (np.unravel_index(int(at), values.shape) for at in (np.argmin(values), np.argmax(values)))
    return tuple((float(v[at[1]]), float(values[at])) for at in found)


def bounds_of(law: Law) -> tuple[Any, ...]:
    """Numbers between the smallest and the largest of which a law stays, all along the span."""
    return (*law_points(law), *(value for _, value in extremes_between(law)))
