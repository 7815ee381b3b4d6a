"""The sector: one pitch of a wheel, a blade on its share of the disc or of the shroud ring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from bladewright.blade.native.blade import Blade, Faces
from bladewright.domain.cyclic_faces import CyclicFace, CyclicKnots, cyclic_face
from bladewright.domain.wheel_body import WheelBody, WheelKnots, pitches_of
from bladewright.frozen import FrozenMapping
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.mass_properties import Face, MassProperties, repeated_properties
from bladewright.nurbs.revolution import LEFT_HANDED, revolved
from bladewright.nurbs.transform import rotated


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Sector(WheelBody):
    """A blade on one pitch of its disc, of its shroud ring, or of both."""

    shown_as: ClassVar[str] = "sector"

    cyclic: tuple[CyclicFace, ...]
    """through the middle of the pitch, one for each of `pitches`"""

    @property
    def cyclic_knots(self) -> Mapping[str, CyclicKnots]:
        """The knots of cyclic faces, by `disc` and `shroud_ring`."""
        return FrozenMapping({face.carrier.kind.field: face.knots for face in self.cyclic})

    @cached_property
    def _oriented(self) -> dict[str, Face]:
        faces: dict[str, Face] = self.wetted("blade_")
        for pitch, cyclic in zip(self.pitches, self.cyclic, strict=True):
            kind, half = pitch.kind, pitch.half_pitch
            faces[kind.wall] = (pitch.face, -kind.side)
            for name, edge in cyclic.edges.items():
                faces[name] = (revolved(edge, -half, half, axis=LEFT_HANDED), kind.side)
            for name, sign in (("low", -1), ("high", 1)):
                turned = rotated(cyclic.surface, sign * half, axis=LEFT_HANDED)
                faces[f"{kind.cyclic}_{name}"] = (turned, -sign * kind.side)
        return faces

    @cached_property
    def surfaces(self) -> Faces:
        """The blade's faces as `blade_upper`...; `hub`, `rim_front`, `disc_1`... `bore`, `rim_back`; cyclic ones."""
        return FrozenMapping({name: face for name, (face, _) in self._oriented.items()})

    @cached_property
    def orientations(self) -> Mapping[str, int]:
        """+1 for the faces whose dS/du x dS/dv points out of the sector, -1 for the others."""
        return FrozenMapping({name: sign for name, (_, sign) in self._oriented.items()})

    @property
    def edges(self) -> tuple[Curve, ...]:
        """Curves in space along which trimmed faces meet: those of the blade."""
        return self.blade.edges

    @cached_property
    def properties(self) -> MassProperties:
        """Volume [m^3], area [m^2], centroid [m] and inertia [m^5], by quadrature on the native surfaces."""
        return repeated_properties(list(self._oriented.values()), np.eye(3)[None], [], self.middle)


def sector(blade: Blade, *, knots: WheelKnots | None = None) -> Sector:
    """One pitch of the wheel of a blade whose design has a `disc`, a `shroud_ring` or both.

    Its cyclic faces carry the periodic line's theta along straight lines in (x, r) from the wall to the outline; one
    turned by a pitch is the other. `knots=sector.knots` holds another sector's knots.

    Raises DesignError where the design has neither, an outline does not fit its wall or the blade, or those lines
    cross.
    """
    pitches = pitches_of(blade, knots)
    cyclic = tuple(cyclic_face(each, None if knots is None else knots.cyclic[each.kind.field]) for each in pitches)
    for face in cyclic:
        face.check(blade.design.metre)
    return Sector(blade=blade, pitches=pitches, cyclic=cyclic)
