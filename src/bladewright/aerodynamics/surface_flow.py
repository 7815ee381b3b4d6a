"""Pressure and friction around an airfoil at one angle, and what each part of its outline adds to lift and drag."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bladewright.errors import PolarError
from bladewright.frozen import FrozenRecord
from bladewright.nurbs.basis import Reals

SEGMENTS = (
    "upper trailing edge",
    "upper box",
    "upper leading edge",
    "lower leading edge",
    "lower box",
    "lower trailing edge",
    "base",
)
"""The parts of an outline between two cuts of each side and the nose, and the base of a blunt trailing edge."""
CUTS = (0.3, 0.7)
"""x/c at which leading edge, central box and trailing edge meet (Tortora, Concilio and Pecora 2023)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Segments(FrozenRecord):
    """Coefficients of the force on each part of an airfoil, square to the flow (lift) and along it (drag)."""

    names: tuple[str, ...]
    """(m,) those of `SEGMENTS`, numbered 1 to 6 in the paper; the base of a blunt trailing edge is the last"""
    lift_pressure: Reals
    """(m,) by pressure: their sum is XFOIL's cl"""
    lift_friction: Reals
    """(m,)"""
    drag_pressure: Reals
    """(m,) by pressure; the sum is a small difference of large numbers, so that cdp is cd less the friction's drag"""
    drag_friction: Reals
    """(m,)"""

    def scaled(self, factor: float) -> "Segments":
        """The coefficients times a factor: chord over reference length."""
        return Segments(names=self.names, **{name: factor * getattr(self, name) for name in COLUMNS})

    def to_dict(self) -> dict[str, object]:
        """The columns, for JSON."""
        return {name: list(getattr(self, name)) for name in ("names", *COLUMNS)}

    def __str__(self) -> str:
        rows = [("segment", *(name.replace("_", " ") for name in COLUMNS))]
        for number, name in enumerate(self.names, 1):
            figures = (f"{getattr(self, column)[number - 1]:.5f}" for column in COLUMNS)
            rows.append((f"{number} {name}", *figures))
        rows.append(("sum", *(f"{np.sum(getattr(self, column)):.5f}" for column in COLUMNS)))
        return "\n".join(f"{row[0]:<24}" + "".join(f"{cell:>16}" for cell in row[1:]) for row in rows)


COLUMNS = ("lift_pressure", "lift_friction", "drag_pressure", "drag_friction")
"""The columns of `Segments`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfaceFlow(FrozenRecord):
    """What a solver found at the nodes of its panels, from the trailing edge over the upper side to the lower one."""

    alpha: float
    """angle of attack [deg]"""
    x: Reals
    """(n,) [chords]"""
    y: Reals
    """(n,) [chords]"""
    cp: Reals
    """(n,) pressure coefficient"""
    cf: Reals
    """(n,) skin friction over the dynamic pressure of the flow far away; negative where the flow runs backwards"""
    stagnation: int
    """how many nodes lie between the trailing edge's upper end and the stagnation point"""

    @property
    def friction_drag(self) -> float:
        """Drag by friction, over the chord."""
        angle = np.radians(self.alpha)
        return float(_forces(self._nodes)[1] @ [np.cos(angle), np.sin(angle)])

    @property
    def _nodes(self) -> Reals:
        """x, y, cp, and cf along the nodes (n, 4): ahead of the stagnation point the flow runs against their order."""
        signs = np.where(np.arange(len(self.x)) < self.stagnation, -1.0, 1.0)
        return np.stack([self.x, self.y, self.cp, signs * self.cf], axis=-1)

    def segments(self, nose: tuple[float, float] = (0.0, 0.0), cuts: Sequence[float] = CUTS) -> Segments:
        """Lift and drag of each part of the outline between two cuts x/c, the nose, and the trailing edge.

        Pressure and friction are linear along the panels, as XFOIL sums them. Raises PolarError for cuts that do not
        lie in order on both sides.
        """
        if len(cuts) != 2 or not 0.0 < cuts[0] < cuts[1] < 1.0:
            raise PolarError(f"the cuts are {tuple(cuts)}: two numbers x/c between 0 and 1, the first the smaller")
        nodes = self._nodes
        last = len(nodes) - 1.0
        places = [
            0.0,
            *(_crossing(self.x, cut) for cut in reversed(cuts)),
            _nearest(nodes[:, :2], np.array(nose)),
            *(last - _crossing(self.x[::-1], cut) for cut in cuts),
            last,
        ]
        if sorted(places) != places:
            raise PolarError(f"the cuts {tuple(cuts)} do not lie in order on both sides: take others")
        parts = [_part(nodes, a, b) for a, b in pairwise(places)]
        if np.any(nodes[0, :2] != nodes[-1, :2]):
            parts.append(nodes[[-1, 0]] * [1.0, 1.0, 1.0, 0.0])
        forces = np.array([_forces(part) for part in parts])
        angle = np.radians(self.alpha)
        across, along = [-np.sin(angle), np.cos(angle)], [np.cos(angle), np.sin(angle)]
        return Segments(
            names=SEGMENTS[: len(parts)],
            lift_pressure=forces[:, 0] @ across,
            lift_friction=forces[:, 1] @ across,
            drag_pressure=forces[:, 0] @ along,
            drag_friction=forces[:, 1] @ along,
        )


def _forces(nodes: Reals) -> Reals:
    """Forces (2, 2) by pressure and by friction along x and y on nodes (k, 4): x, y, cp, and cf along the nodes."""
    dx, dy, *_ = np.diff(nodes, axis=0).T
    cp, cf = ((nodes[1:] + nodes[:-1]) / 2.0)[:, 2:].T
    return np.array([[-cp @ dy, cp @ dx], [cf @ dx, cf @ dy]])


def _part(nodes: Reals, first: float, last: float) -> Reals:
    """Nodes (k, 4) between two places, numbers of nodes with fractions along their panels."""
    numbers = np.arange(len(nodes), dtype=np.float64)
    inside = numbers[(numbers > first) & (numbers < last)]
    places = np.concatenate([[first], inside, [last]])
    return np.stack([np.interp(places, numbers, column) for column in nodes.T], axis=-1)


def _crossing(x: Reals, cut: float) -> float:
    """The place at which x (n,) from the trailing edge on first comes down to the cut."""
    i = int(np.argmax(x < cut))
    return i - 1.0 + float((x[i - 1] - cut) / (x[i - 1] - x[i])) if i > 0 else 0.0


def _nearest(points: Reals, to: Reals) -> float:
    """The place on the polyline (n, 2) that is nearest to a point (2,)."""
    step = np.diff(points, axis=0)
    share = np.clip(np.sum((to - points[:-1]) * step, axis=1) / np.sum(step * step, axis=1), 0.0, 1.0)
    i = int(np.argmin(np.hypot(*(points[:-1] + share[:, None] * step - to).T)))
    return i + float(share[i])
