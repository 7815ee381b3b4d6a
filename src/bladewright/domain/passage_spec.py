"""What a passage is made for: the blade, half its pitch, and the flow angles at inlet and outlet."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.native.blade import Blade
from bladewright.domain.camber_lines import CamberLines, camber_lines
from bladewright.domain.duct import Duct
from bladewright.domain.knots import PassageKnots
from bladewright.domain.walls import WallHalf, WallStrip, wall_halves, wall_strips
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

Planes = tuple[CamberLines, Mapping[str, WallHalf], Mapping[str, WallStrip]]
"""camber lines, walls' halves and strips"""


@dataclass(frozen=True, kw_only=True, eq=False)
class PassageSpec:
    """A blade and what its passage depends on besides knots."""

    blade: Blade
    full: ExactBlade
    """the exact blade without gaps"""
    half: Array
    """half the pitch, in theta or in y"""
    turned: tuple[Array | None, Array | None]
    """d theta / dm' at inlet and outlet, where stated"""

    @property
    def real_half(self) -> float:
        """Half the pitch of the real design."""
        return float(np.real(self.half).flat[0])

    def duct(self, knots: PassageKnots) -> Duct:
        """The duct at given knots."""
        return Duct(
            channel=self.full.meridians,
            start=knots.start,
            end=knots.end,
            edges=knots.edges,
            length=knots.length,
            unit=knots.unit,
            low=knots.low,
            high=knots.high,
            revolved=self.full.mapping.revolved,
        )

    def camber(self, knots: PassageKnots, v: Reals) -> CamberLines:
        """Camber lines with stations at v (m,)."""
        joints = np.unique(self.full.breaks_along_v())
        return camber_lines(self.full.stations(v), self.duct(knots), self.turned, joints, knots.correspondence)

    def plane(self, knots: PassageKnots, v: Reals) -> Planes:
        """Camber lines with stations at v (m,), hub first and shroud last, and walls' halves and strips."""
        camber, ends = (self.camber(knots, places) for places in (v, v[[0, -1]]))
        touched = {wall: wall in self.blade.design.ends for wall in ("hub", "shroud")}
        return camber, wall_halves(ends, touched, self.half, knots.opening, knots.crossing), wall_strips(ends, touched)
