"""The wheel: all blades on their disc, in their shroud ring or both, as one closed body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from bladewright.blade.native.blade import Blade, Faces
from bladewright.domain.carried_pitch import CarriedPitch
from bladewright.domain.row import blade_name, turn_matrix
from bladewright.domain.wheel_body import WheelBody, WheelKnots, pitches_of
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, angle
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.mass_properties import Face, MassProperties, repeated_properties
from bladewright.nurbs.revolution import FULL_TURN, Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.transform import transformed
from bladewright.nurbs.trimmed import TrimmedSurface

SEAMS = 180
"""Angles in a quarter of a turn of which that is taken for the seams whose quarter turns keep furthest from the ends of
the periodic lines, or there would be short edges: steps of half a degree."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Wheel(WheelBody):
    """All blades of a row with their disc, their shroud ring or both."""

    shown_as: ClassVar[str] = "wheel"

    @cached_property
    def turns(self) -> Array:
        """(n, 3, 3) rotations of the first blade to each of them."""
        count = int(self.blade.design.blade_count or 0)
        return np.stack([turn_matrix(k * FULL_TURN / count) for k in range(count)])

    @cached_property
    def _repeated(self) -> dict[str, Face]:
        """The faces of the first pitch: `{}` in their names is the blade's."""
        walls: dict[str, Face] = {f"{each.kind.wall}_": (each.face, -each.kind.side) for each in self.pitches}
        return {**self.wetted("blade_"), **walls}

    @cached_property
    def _whole(self) -> dict[str, Face]:
        """The faces of a whole turn."""
        faces: dict[str, Face] = {}
        for pitch in self.pitches:
            start = _seam(pitch)
            for name, piece in pitch.carrier.pieces.items():
                turned = Revolution(meridian=piece.curve, start=start, end=start + FULL_TURN)
                faces[name] = (turned.surface(smooth=True), pitch.kind.side)
        return faces

    def _names(self) -> list[str]:
        """Of all faces."""
        count = len(self.turns)
        numbers = [blade_name(k + 1, count).removeprefix("blade_") for k in range(count)]
        inside = [f"{pitch.kind.wall}_" for pitch in self.pitches]
        return [
            *(
                name + number if name in inside else name.replace("blade_", f"blade_{number}_", 1)
                for number in numbers
                for name in self._repeated
            ),
            *self._whole,
        ]

    @cached_property
    def surfaces(self) -> Faces:
        """`blade_01_upper`..., `hub_01`... by the blade's number, `rim_front`, `disc_1`... `bore`, `rim_back`."""
        copies = [
            face if k == 0 else _turned(face, turn, k * FULL_TURN / len(self.turns))
            for k, turn in enumerate(self.turns)
            for face, _ in self._repeated.values()
        ]
        return FrozenMapping(
            dict(zip(self._names(), [*copies, *(face for face, _ in self._whole.values())], strict=True))
        )

    @cached_property
    def orientations(self) -> Mapping[str, int]:
        """+1 for the faces whose dS/du x dS/dv points out of the wheel, -1 for the others."""
        copies = [sign for _, sign in self._repeated.values()] * len(self.turns)
        return FrozenMapping(
            dict(zip(self._names(), [*copies, *(sign for _, sign in self._whole.values())], strict=True))
        )

    @property
    def turned_faces(self) -> Mapping[str, tuple[str, Reals]]:
        """Of the faces of all blades but the first: the first one's, and the rotation (3, 3) from it."""
        names, count = self._names(), len(self._repeated)
        inside = {f"{pitch.kind.wall}_" for pitch in self.pitches}
        of_blades = [i for i, name in enumerate(self._repeated) if name not in inside]
        return FrozenMapping(
            {
                names[k * count + i]: (names[i], np.real(turn))
                for k, turn in enumerate(self.turns)
                for i in of_blades
                if k
            }
        )

    @cached_property
    def edges(self) -> tuple[Curve, ...]:
        """Curves in space along which trimmed faces meet: periodic lines, and those of the blades."""
        once = [*self.blade.edges, *(pitch.periodic(-1) for pitch in self.pitches)]
        return tuple(transformed(curve, turn) for turn in self.turns for curve in once)

    @cached_property
    def properties(self) -> MassProperties:
        """Volume [m^3], area [m^2], centroid [m] and inertia [m^5], by quadrature on the native surfaces."""
        return repeated_properties(list(self._repeated.values()), self.turns, list(self._whole.values()), self.middle)


def wheel(blade: Blade, *, knots: WheelKnots | None = None) -> Wheel:
    """All blades of a row with the `disc`, the `shroud_ring` or both that its design has, as one body.

    A wall is in one piece for each blade, the other faces of revolution are whole turns. Blades are turned copies of
    the native one. `knots=wheel.knots` holds another wheel's knots.

    Raises DesignError where the design has neither, an outline does not fit its wall or the blade, or there is but one
    blade.
    """
    pitches = pitches_of(blade, knots)
    if blade.design.blade_count == 1:
        raise DesignError("blade_count is 1: a wheel needs two blades at least, between which its wall is cut")
    return Wheel(blade=blade, pitches=pitches)


def _turned(face: Surface | TrimmedSurface, turn: Array, theta: float) -> Surface | TrimmedSurface:
    """A face turned about the machine axis."""
    moved: Any = transformed(face, turn)  # type: ignore[type-var]
    own = getattr(face, "revolution", None)
    return (
        moved if own is None else replace(moved, revolution=replace(own, start=own.start + theta, end=own.end + theta))
    )


def _seam(pitch: CarriedPitch) -> float:
    """theta of the seams, from which circles run in quarters of a turn."""
    net = np.real(pitch.line.control_points)
    ends = angle(net[[0, -1], 1], net[[0, -1], 2]) - pitch.half_pitch
    seams = np.linspace(0.0, 0.25 * FULL_TURN, SEAMS, endpoint=False)
    quarters = seams[:, None, None] + 0.25 * FULL_TURN * np.arange(4)[:, None] - ends
    steps = quarters / (2.0 * pitch.half_pitch)
    away = np.min((steps - np.round(steps)) ** 2, axis=(1, 2))
    return float(seams[int(np.argmax(away))])
