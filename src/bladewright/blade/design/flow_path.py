"""The flow past a blade as a design: the channel of unified blades, and the flow path of blades from sections."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from bladewright.blade.design.meridional_curve import Meridian, meridian_at
from bladewright.blade.design.spanwise_steps import SpanwiseStep, steps_of_edge, steps_of_walls
from bladewright.designs import Part, Points, parameter
from bladewright.errors import DesignError
from bladewright.section import checks


@dataclass(frozen=True, kw_only=True)
class Channel(Part):
    """Control points of the four meridional curves, in the (x, r) plane of the machine, or (x, z) of a cascade.

    Hub and shroud take their end points from the leading and trailing edge, so a corner is one parameter.
    """

    leading_edge: Points = parameter("length")
    """control points from hub to shroud, two or more [length]"""
    trailing_edge: Points = parameter("length")
    """control points from hub to shroud, two or more [length]"""
    hub: Points = parameter("length", default=())
    """inner control points from leading to trailing edge, none or more [length]"""
    shroud: Points = parameter("length", default=())
    """inner control points from leading to trailing edge, none or more [length]"""
    degree: Literal[1, 2, 3, 4, 5] = 5
    """highest degree of the four B-splines; each has min(n - 1, degree) for n control points"""

    def __post_init__(self) -> None:
        for name, least in (("leading_edge", 2), ("trailing_edge", 2), ("hub", 0), ("shroud", 0)):
            object.__setattr__(self, name, checks.points(f"channel.{name}", getattr(self, name), least))
        checks.integer("channel.degree", self.degree, 1, 5, "a whole number is needed")

    def spanwise_steps(self) -> Iterator[SpanwiseStep]:
        """Control points whose steps go together: those of an edge, and those of hub and shroud side by side.

        A stream line at v is (1 - v) hub(u) + v shroud(u), bowed by (1 - u) and u times how far the edges are off the
        straight lines between their ends.
        """
        for name in ("leading_edge", "trailing_edge"):
            yield from steps_of_edge(f"channel.{name}", len(getattr(self, name)), self.degree)
        if len(self.hub) == len(self.shroud):
            yield from steps_of_walls("channel.hub", "channel.shroud", len(self.hub))


Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class FlowPath(Part):
    """Hub and shroud from upstream of a blade to downstream of it, in (x, r), or in (x, z) of a cascade.

    Points of hub and shroud at equal fractions of their lengths are joined by straight lines, the quasi-orthogonals;
    the stream surface at the span fraction v divides each as v to 1 - v. Where stream surfaces are given, points at
    equal fractions are joined by a cubic spline in v through all of them.
    """

    hub: Meridian
    """from upstream to downstream"""
    shroud: Meridian
    """from upstream to downstream"""
    quasi_orthogonals: tuple[Pair, ...] = parameter("-", default=())
    """where the fractions differ: pairs of fractions of the hub's and the shroud's length that are joined, increasing
    inside 0 and 1; between them a smooth curve [-]"""
    stream_surfaces: tuple[Meridian, ...] = parameter("length", default=())
    """stream surfaces between hub and shroud, from hub to shroud; none: straight quasi-orthogonals"""
    stream_spans: tuple[float, ...] = ()
    """the span fraction of each of them, increasing inside 0 and 1; none given: in equal steps [-]"""
    matched: Literal["ends", "edges"] = "ends"
    """what fractions count from and to: the ends of hub, shroud and stream surfaces, or the leading- and trailing-edge
    curves of the blade, as is needed where stream surfaces do not start and end beside each other"""

    def __post_init__(self) -> None:
        put = object.__setattr__
        for name in ("hub", "shroud"):
            meridian_at(name, getattr(self, name))
        checks.choice("matched", self.matched, ["ends", "edges"])
        if not checks.is_sequence(self.stream_surfaces):
            raise DesignError(f"stream_surfaces is {self.stream_surfaces!r}: a list of curves in (x, r) is needed")
        for i, each in enumerate(self.stream_surfaces):
            meridian_at(f"stream_surfaces[{i}]", each)
        put(self, "stream_surfaces", tuple(self.stream_surfaces))
        put(self, "stream_spans", self._given_spans())
        put(self, "quasi_orthogonals", self._pairs())

    @property
    def spans(self) -> tuple[float, ...]:
        """Span fractions of hub, stream surfaces and shroud."""
        equal = np.linspace(0.0, 1.0, len(self.stream_surfaces) + 2)
        return (0.0, *self.stream_spans, 1.0) if self.stream_spans else tuple(float(v) for v in equal)

    def _given_spans(self) -> tuple[float, ...]:
        count = len(self.stream_surfaces)
        if not self.stream_spans:
            return ()
        if checks.is_sequence(self.stream_spans) and len(self.stream_spans) != count:
            raise DesignError(
                f"stream_spans has {len(self.stream_spans)} entries for {count} stream_surfaces: give one for each"
            )
        return increasing_spans("stream_spans", self.stream_spans, "; put stream_surfaces in the order from the hub")

    def _pairs(self) -> tuple[Pair, ...]:
        if not self.quasi_orthogonals:
            return ()
        if self.stream_surfaces or self.matched == "edges":
            raise DesignError(
                "quasi_orthogonals are given together with "
                + ("stream_surfaces" if self.stream_surfaces else "matched = 'edges'")
                + ": they join points of hub and shroud alone, at fractions of their whole lengths; leave one out"
            )
        pairs = []
        before = [0.0, 0.0]
        for i, pair in enumerate(self.quasi_orthogonals):
            if not checks.is_sequence(pair) or len(pair) != 2:
                raise DesignError(f"quasi_orthogonals[{i}] is {pair!r}: a pair of fractions, hub and shroud, is needed")
            both = [checks.number(f"quasi_orthogonals[{i}][{k}]", value) for k, value in enumerate(pair)]
            for k, value in enumerate(both):
                real = float(np.ravel(np.real(value))[0])
                if not before[k] < real < 1.0:
                    raise DesignError(
                        f"quasi_orthogonals[{i}][{k}] is {real:g}: fractions of the {('hub', 'shroud')[k]}'s length "
                        f"must increase from pair to pair between 0 and 1; it must be more than {before[k]:g}"
                    )
                before[k] = real
            pairs.append((both[0], both[1]))
        return tuple(pairs)


def increasing_spans(path: str, value: Any, cure: str = "") -> tuple[float, ...]:
    """Span fractions that increase inside 0 and 1, or a refusal that ends on a cure."""
    if not checks.is_sequence(value):
        raise DesignError(f"{path} is {value!r}: a list of span fractions is needed")
    given = tuple(checks.number(f"{path}[{i}]", v) for i, v in enumerate(value))
    for i, (before, v, after) in enumerate(zip((0.0, *given), given, (*given[1:], 1.0), strict=False)):
        if np.ndim(v) > 0 or np.iscomplexobj(v) or not before < v < after:
            raise DesignError(
                f"{path}[{i}] is {v}: span fractions are plain numbers that increase between 0 at the hub and 1 at the "
                f"shroud{cure}"
            )
    return given
