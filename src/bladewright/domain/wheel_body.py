"""What a sector and a wheel have in common: blades on the walls that a disc or a shroud ring carries."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.native.blade import Blade, Faces
from bladewright.blade.native.mass import MetalBody
from bladewright.domain.blade_body import BladeBody
from bladewright.domain.carried_pitch import CarriedPitch, carried_pitches
from bladewright.domain.cyclic_faces import CyclicKnots
from bladewright.domain.knots import PassageKnots
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.mass_properties import Face

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign


@dataclass(frozen=True, kw_only=True, eq=False)
class WheelKnots(FrozenRecord):
    """What `sector` and `wheel` hold while a design is differentiated."""

    skin: PassageKnots
    lines: Mapping[str, Reals]
    """knots of the walls' lines, by `disc` and `shroud_ring`"""
    cyclic: Mapping[str, CyclicKnots]
    """those of a sector's cyclic faces"""


@dataclass(frozen=True, kw_only=True, eq=False)
class WheelBody(BladeBody, MetalBody):
    """Base of sector and wheel."""

    pitches: tuple[CarriedPitch, ...]
    """of the walls that are carried"""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} '{self.name}': {len(self.surfaces)} faces>"

    @property
    @abstractmethod
    def surfaces(self) -> Faces:
        """Faces by name; metres."""

    @property
    def metal(self) -> RowDesign:
        """The design that states the density."""
        return self.blade.design

    @property
    def knots(self) -> WheelKnots:
        """As `sector(..., knots=...)` and `wheel(..., knots=...)` take them, to hold them."""
        return WheelKnots(
            skin=self.pitches[0].skin.knots,
            lines=FrozenMapping({pitch.kind.field: pitch.knots for pitch in self.pitches}),
            cyclic=self.cyclic_knots,
        )

    @property
    def cyclic_knots(self) -> Mapping[str, CyclicKnots]:
        """The knots of cyclic faces, where there are any."""
        return FrozenMapping({})

    @property
    def middle(self) -> Reals:
        """The point (3,) of the machine axis from which moments are measured: in the blade's middle [m]."""
        x = np.real(self.blade.sides[0].control_points[..., 0])
        return np.array([0.5 * (x.min() + x.max()), 0.0, 0.0])

    def wetted(self, prefix: str) -> dict[str, Face]:
        """The blade's faces but for its ends on walls that are carried, with their orientations.

        `prefix` comes before their names.
        """
        inside = {pitch.kind.wall for pitch in self.pitches}
        signs = self.blade.orientations
        return {
            f"{prefix}{name}": (face, signs[name]) for name, face in self.blade.surfaces.items() if name not in inside
        }


def pitches_of(blade: Blade, knots: WheelKnots | None) -> tuple[CarriedPitch, ...]:
    """The carried walls of a blade, at given knots or at their own; raises DesignError as `sector` does."""
    if blade.dimension == 2:
        raise DesignError("a 2D section was given, and discs carry blades: build prismatic(design) first")
    known = (None, None) if knots is None else (knots.skin, knots.lines)
    return tuple(carried_pitches(blade, *known))
