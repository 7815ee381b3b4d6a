"""What a passage is made for: the blade, half its pitch, and the flow angles at inlet and outlet."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from scipy.spatial import cKDTree

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.native.blade import Blade
from bladewright.domain.camber_lines import CamberLines, camber_lines
from bladewright.domain.duct import Duct
from bladewright.domain.knots import PIECES, PassageKnots
from bladewright.domain.walls import WallHalf, WallStrip, wall_halves, wall_strips
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.trimmed import TrimmedSurface

FOOT_PLACES, OUTLINE_PLACES = 4001, 201
"""Points of a wall, and of each curve around a blade's end, among which the end's extremes are found."""
PlaneGeometry = tuple[CamberLines, Mapping[str, WallHalf], Mapping[str, WallStrip]]
"""Camber lines, the halves of the walls and their strips."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PassageSpec:
    """A blade and all that its passage depends on besides knots."""

    blade: Blade
    exact: ExactBlade
    """the exact blade from wall to wall, without clearances"""
    half_pitch: Array
    """() in theta, or y in a cascade"""
    turned: tuple[Array | None, Array | None]
    """() d theta / dm' at inlet and outlet, where an angle is stated"""

    @property
    def real_half_pitch(self) -> float:
        """Half the pitch of the real design."""
        return float(np.real(self.half_pitch).flat[0])

    def faces_at_walls(self) -> dict[str, TrimmedSurface]:
        """The pieces of walls with a clearance inside the blade's continuation, by wall, where an edge is blunt.

        The strips past its faces need something to begin at.
        """
        return {
            wall: cast(TrimmedSurface, self.blade.uncut.surfaces[wall])
            for wall in ("hub", "shroud")
            if wall not in self.blade.design.ends and self.blunt
        }

    @property
    def blunt(self) -> bool:
        """Whether a face lies between the sides' ends at an edge: a back face counts."""
        survey = self.exact.survey
        return "blunt" in survey.edge_kinds or survey.back is not None

    def duct(self, knots: PassageKnots) -> Duct:
        """The duct at given knots."""
        return Duct(
            channel=self.exact.meridional_channel(knots.noses, (knots.start, knots.end)),
            start=knots.start,
            end=knots.end,
            edges=knots.edges,
            length=knots.length,
            unit=knots.unit,
            bend=knots.bend,
            low=knots.low,
            high=knots.high,
            revolved=self.exact.mapping.revolved,
        )

    def camber(self, knots: PassageKnots, v: Reals) -> CamberLines:
        """Camber lines with stations at v (m,)."""
        joints = np.unique(self.exact.breaks_along_v())
        found = camber_lines(self.exact.sections(v), self.duct(knots), self.turned, joints, knots.correspondence)
        return replace(found, shift=knots.shift, straightening=knots.straightening)

    def middle_lines(self, knots: PassageKnots) -> Mapping[str, WallHalf]:
        """Halves of the walls between middle and periodic lines, past which the blade is not seen; they never fold."""
        ends = self.camber(knots, np.array([0.0, 1.0]))
        beside = {"hub": False, "shroud": False}
        return wall_halves(ends, beside, self.half_pitch, (1.0, 1.0), knots.cross_lines, knots.reaches)

    def feet(self, knots: PassageKnots) -> tuple[float, float] | None:
        """Least and greatest u of the ends of a blade with fillets or cuts on its walls; None of a plain one."""
        blade, found = self.blade, []
        if blade.before is None:
            return None
        duct = self.duct(knots)
        u = np.linspace(duct.low, duct.high, FOOT_PLACES)
        for row, wall in enumerate(("hub", "shroud")):
            if wall in blade.design.ends:
                line = real_first(duct.lines(np.array([float(row)])).position(u), 3)[0]
                curves = blade.end_outline(wall)
                points = np.concatenate([np.real(each(np.linspace(*each.domain, OUTLINE_PLACES))) for each in curves])
                radius = length(points[:, 1:]) if duct.revolved else points[:, 2]
                found.append(u[cKDTree(line).query(np.stack([points[:, 0], radius], axis=-1))[1]])
        return (float(np.min(np.concatenate(found))), float(np.max(np.concatenate(found)))) if found else None

    def winding(self, knots: PassageKnots) -> dict[str, float]:
        """The theta [rad], or y in a cascade, over which one pitch of `hub` and `shroud` reaches."""
        camber, t = self.camber(knots, np.array([0.0, 1.0])), np.linspace(0.0, 1.0, 65)
        lines = np.concatenate([real_first(camber.points(piece, t), 3)[..., 1] for piece in PIECES], axis=-1)
        return {
            name: float(np.ptp(line)) + 2.0 * self.real_half_pitch
            for name, line in zip(("hub", "shroud"), lines, strict=True)
        }

    def plane(self, knots: PassageKnots, v: Reals) -> PlaneGeometry:
        """Camber lines with stations at v (m,), hub first and shroud last, and the walls' halves and strips."""
        camber, ends = (self.camber(knots, places) for places in (v, v[[0, -1]]))
        beside = {wall: wall in self.blade.design.ends or any(camber.blunt) for wall in ("hub", "shroud")}
        halves = wall_halves(ends, beside, self.half_pitch, knots.departures, knots.cross_lines, knots.reaches)
        return camber, halves, wall_strips(ends, beside)
