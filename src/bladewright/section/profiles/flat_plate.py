"""Flat plates with round, elliptic or blunt edges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.laws import Span
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.profiles.profile import THICKNESS, Profile

EDGE = 0.15
"""s that an edge's ellipse takes: a plate's edges are short, and their curvature asks for more than their share of the
parameter [-]"""
NOSE = 0.75
"""angular speed of the ellipse's parameter at the nose, of its mean: below 1 so that it grows towards the straight side
[-]"""
PlateEdge = Literal["round", "elliptic", "blunt"]

RATIO = Limits(0.1, 20.0, "it must lie above 0.1 and below 20")


@dataclass(frozen=True, kw_only=True)
class FlatPlate(Profile):
    """A flat plate: straight sides, and edges that are half circles, half ellipses or cut off."""

    kind: Literal["flat-plate"] = "flat-plate"
    """which kind of profile this is"""
    thickness: Law = parameter("-", limits=THICKNESS)
    """of the chord [-]"""
    leading_edge: PlateEdge = "round"
    """how the leading edge ends"""
    leading_edge_ratio: Law | None = parameter("-", limits=RATIO, default=None)
    """of an elliptic edge: its length over half the thickness [-]"""
    trailing_edge: PlateEdge = "round"
    """how the trailing edge ends"""
    trailing_edge_ratio: Law | None = parameter("-", limits=RATIO, default=None)
    """of an elliptic edge: its length over half the thickness [-]"""

    def __post_init__(self) -> None:
        super().__post_init__()
        for edge in ("leading_edge", "trailing_edge"):
            checks.choice(edge, getattr(self, edge), ("round", "elliptic", "blunt"))
            name = f"{edge}_ratio"
            elliptic, ratio = getattr(self, edge) == "elliptic", getattr(self, name)
            if elliptic != (ratio is not None):
                cure = "give it, 3 for instance" if elliptic else "leave it out, or make the edge elliptic"
                state = "missing" if elliptic else "given"
                raise DesignError(f"{name} is {state} and {edge} is {getattr(self, edge)!r}: {cure}")

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        half = 0.5 * span.values(self.thickness)
        lengths: list[Array | None] = []
        for edge in ("leading_edge", "trailing_edge"):
            kind, ratio = getattr(self, edge), getattr(self, f"{edge}_ratio")
            lengths.append(None if kind == "blunt" else half if ratio is None else half * span.values(ratio))
        left = 1.0 - sum(np.real(each) for each in lengths if each is not None)
        if np.any(left <= 0.0):
            raise DesignError(f"thickness is {2.0 * np.max(np.real(half)):g}: the edges take the whole chord; lower it")
        return PlateOutline(half=half, lengths=(lengths[0], lengths[1]))


@dataclass(frozen=True, kw_only=True)
class PlateOutline(Outline):
    """Sections (...) of an ellipse, a straight line and an ellipse on each side."""

    half: Array
    """half the thickness (...)"""
    lengths: tuple[Array | None, Array | None]
    """of the ellipses (...); None: a blunt edge"""

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Where ellipses end."""
        return tuple(Joint(place, 1) for place in self._straight if 0.0 < place < 1.0)

    @property
    def leading_edge(self) -> Edge:
        """Round or blunt."""
        return self._edge(0)

    @property
    def trailing_edge(self) -> Edge:
        """Round or blunt."""
        return self._edge(1)

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the chord line."""
        along = s + 0.0 * self.half[..., None]
        return np.stack([along, 0.0 * along], axis=-1)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        first, last = self._straight
        start, end = (np.zeros(()) if each is None else each for each in self.lengths)
        straight = 1.0 - start - end
        along = straight[..., None] + 0.0 * (s + self.half[..., None])
        across = self.half[..., None] + 0.0 * along
        middle = (s >= first) & (s <= last)
        speeds, step = self._speeds(), last - first
        share = (s[middle] - first) / step
        rise = [(each * step)[..., None] for each in speeds]
        rest = 1.0 - share
        position = share * (
            rise[0] * rest**2 - rise[1] * share * rest + straight[..., None] * share * (3.0 - 2.0 * share)
        )
        along[..., middle] = start[..., None] + position
        for on_edge, size, trailing in ((s < first, start, False), (s > last, end, True)):
            angle = _angle((1.0 - s[on_edge] if trailing else s[on_edge]) / EDGE)
            # 1 - cos without cancellation
            from_edge = size[..., None] * 2.0 * np.sin(0.5 * angle) ** 2
            along[..., on_edge] = 1.0 - from_edge if trailing else from_edge
            across[..., on_edge] = self.half[..., None] * np.sin(angle)
        upper, lower = (np.stack([along, sign * across], axis=-1) for sign in (1.0, -1.0))
        return upper, lower

    @property
    def _straight(self) -> tuple[float, float]:
        """s where the straight piece begins and ends."""
        return 0.0 if self.lengths[0] is None else EDGE, 1.0 if self.lengths[1] is None else 1.0 - EDGE

    def _speeds(self) -> list[Array]:
        """dx/ds (...) at both ends of the straight piece."""
        first, last = self._straight
        lengths = [np.zeros(()) if each is None else each for each in self.lengths]
        mean = (1.0 - lengths[0] - lengths[1]) / (last - first)
        leaving = 0.5 * np.pi * (3.0 - 2.0 * NOSE) / EDGE
        return [mean if each is None else each * leaving + 0.0 * mean for each in self.lengths]

    def _edge(self, end: int) -> Edge:
        starts, size = [], self.lengths[end]
        sense = -1.0 if end else 1.0
        zero = 0.0 * self.half + 0.0 * self._speeds()[end]
        for sign in (1.0, -1.0):
            if size is None:
                speeds, step = self._speeds(), self._straight[1] - self._straight[0]
                other = speeds[1 - end]
                # a cubic by Hermite, whose speed at a blunt edge is the mean
                growth = sense * (2.0 * speeds[end] - 2.0 * other) / step
                rows = [(zero + end, sign * self.half), (speeds[end], zero), (growth, zero)]
            else:
                turn = 0.5 * np.pi * NOSE / EDGE
                rows = [(zero + end, zero), (zero, sense * sign * self.half * turn), (sense * size * turn**2, zero)]
            starts.append(EdgeDerivatives(*(np.stack(np.broadcast_arrays(*row), axis=-1) for row in rows)))
        return Edge(kind="blunt" if size is None else "round", upper=starts[0], lower=starts[1])


def _angle(share: Reals) -> Reals:
    """The ellipse's parameter, from 0 at the edge to a right angle."""
    found: Reals = 0.5 * np.pi * share * (NOSE + (1.0 - NOSE) * share**2)
    return found
