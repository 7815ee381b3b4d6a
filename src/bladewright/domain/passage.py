"""The flow passage around one blade: native patches that close up pole for pole."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import ClassVar, cast

import numpy as np

from bladewright.blade.native.blade import Faces
from bladewright.blade.native.properties import blade_properties
from bladewright.domain.blade_body import BladeBody
from bladewright.domain.camber_lines import CamberLines
from bladewright.domain.cut_duct import outline_volume
from bladewright.domain.duct import Duct, annulus_volume
from bladewright.domain.knots import BLADE_AT, PIECES, PassageKnots
from bladewright.domain.periodic_sector import PeriodicSector, periodic_sector, sector_of
from bladewright.domain.skin import Skin, skin_moments
from bladewright.domain.walls import STRIPS, WallHalf, WallStrip
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reparametrised, split
from bladewright.nurbs.mass_properties import MassProperties, mass_properties
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

OUTWARD = FrozenMapping(
    {
        "hub": -1,
        "shroud": 1,
        "hub_upper": -1,
        "hub_lower": 1,
        "shroud_upper": 1,
        "shroud_lower": -1,
        "inlet": -1,
        "outlet": 1,
        "periodic_upper": -1,
        "periodic_lower": 1,
        "hub_stagnation": -1,
        "hub_wake": -1,
        "shroud_stagnation": 1,
        "shroud_wake": 1,
        "hub_gap": -1,
        "shroud_gap": 1,
    }
)
"""+1 for the faces whose dS/du x dS/dv points out of the passage, -1 for the others; the blade's are its own."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Passage(BladeBody):
    """The flow passage around one blade: half a pitch to each side of it, from inlet to outlet."""

    shown_as: ClassVar[str] = "passage"

    whole: Faces
    """walls' halves (u inlet to outlet, v from the blade to a periodic boundary), periodic boundaries (u inlet to
    outlet, v hub to shroud), inlet and outlet (u from the lower to the upper periodic boundary, v hub to shroud), the
    blade's sides, and its tip where there is a clearance; where an edge is blunt, its face as `blade_trailing_edge`,
    and the strips of the walls downstream of it, `hub_wake` and `shroud_wake` (u along the flow, v from the lower to
    the upper half), or `blade_leading_edge`, `hub_stagnation` and `shroud_stagnation`, and where there is a gap besides
    `shroud_gap` or `hub_gap`, the piece of that wall between its halves; metres. Where the walls are trimmed, `hub` and
    `shroud` are one face each, with the blade's end as a hole, and there are neither strips nor gap faces"""
    knots: PassageKnots
    """as `passage(..., knots=...)` takes them, to hold them"""
    camber: CamberLines
    """continued camber lines, from hub to shroud"""
    half_pitch: Array
    """() in theta, or y in a cascade"""
    walls: Mapping[str, WallHalf] = field(default_factory=dict)
    """the exact halves of hub and shroud that the native ones interpolate; none where the walls are trimmed"""
    strips: Mapping[str, WallStrip] = field(default_factory=dict)
    """the exact strips between them past blunt edges"""
    skin: Skin | None = None
    """what a passage with trimmed walls is made from"""
    split: bool = False
    """whether `surfaces` are cut where the whole faces have a crease"""

    @cached_property
    def surfaces(self) -> Faces:
        """The passage's faces by name: the whole ones, or `hub_upper_inlet`, `inlet_lower`... where they are split."""
        if not self.split:
            return self.whole
        pieces: dict[str, Surface | TrimmedSurface] = {}
        for name, face in self.whole.items():
            pieces |= {name: face} if isinstance(face, TrimmedSurface) else pieces_of(name, face, self.knots)
        return FrozenMapping(pieces)

    def __repr__(self) -> str:
        extents = f"{self.knots.upstream:.3g} upstream, {self.knots.downstream:.3g} downstream"
        return f"<Passage '{self.name}': {len(self.surfaces)} faces; {extents}, each x {self.knots.length:.6g} m>"

    @property
    def edges(self) -> tuple[Curve, ...]:
        """Space curves [m] along which trimmed faces meet: those of the blade, and of trimmed walls around its cuts."""
        return self.blade.edges

    @property
    def duct(self) -> Duct:
        """The channel with its continuations."""
        return self.camber.duct

    @property
    def orientations(self) -> Mapping[str, int]:
        """+1 for the faces whose dS/du x dS/dv points out of the passage, -1 for the others."""
        around = self.blade.orientations
        senses = {**OUTWARD, **{f"blade_{name}": -sense for name, sense in around.items()}}
        if "tip" in self.whole:
            senses["tip"] = -around["tip"]
        whole = sorted(self.whole, key=len, reverse=True)
        return FrozenMapping(
            {name: senses[next(face for face in whole if name.startswith(face))] for name in self.surfaces}
        )

    @cached_property
    def properties(self) -> MassProperties:
        """Volume [m^3], area [m^2], centroid [m] and inertia [m^5], by quadrature on the native surfaces."""
        if self.skin is not None:
            moments = partial(skin_moments, self.skin, self.surfaces, self.orientations)
            return blade_properties(self.surfaces, self.orientations, revolved=self.duct.revolved, moments=moments)
        return mass_properties([(self.surfaces[name], sign) for name, sign in self.orientations.items()])

    @property
    def ring(self) -> Array:
        """Volume () [m^3] of the annulus between inlet and outlet: blade count x (passage + blade).

        In a cascade, of one pitch of the duct.
        """
        cut = self.skin is not None and (self.skin.is_cut("hub") or self.skin.is_cut("shroud"))
        if self.skin is not None and cut:
            volume = outline_volume(self.skin.middle, revolved=self.duct.revolved)
        else:
            volume = annulus_volume(self.duct, self.camber.joints)
        return volume if self.duct.revolved else volume * 2.0 * self.half_pitch

    @cached_property
    def ring_error(self) -> float:
        """blade count x (passage + blade) over the ring, less one; in a cascade, one of each over a pitch."""
        share = (self.blade.design.blade_count or 1) * (self.properties.volume + self.blade.properties.volume)
        return float(np.real(share / self.ring - 1.0))

    @cached_property
    def periodic_sector(self) -> PeriodicSector:
        """One blade's share of the duct, fluid and blade together, between exact surfaces of revolution."""
        if self.skin is not None:
            return sector_of(self.skin, f"{self.blade.name}-sector")
        faces = {name: face for name, face in self.whole.items() if isinstance(face, Surface)}
        cuts = self.knots.cuts(0), self.knots.cuts(1)
        return periodic_sector(f"{self.blade.name}-sector", faces, self.duct, self.blade.chord, cuts)

    @property
    def sector(self) -> PeriodicSector:
        """Deprecated: `periodic_sector`, of which this is the old name."""
        warnings.warn("Passage.sector is deprecated: use Passage.periodic_sector", DeprecationWarning, stacklevel=2)
        return self.periodic_sector

    @cached_property
    def folds(self) -> dict[str, tuple[float, float, float]]:
        """By the name of a wall's half: least Jacobian in (m', theta) over its median, and the u, v where it is.

        Nothing where the walls are trimmed.
        """
        return {name: self._least(name, wall) for name, wall in self.walls.items()}

    @cached_property
    def wall_error(self) -> float:
        """Largest distance of hub and shroud from their surfaces of revolution, in chords.

        Where they are trimmed, of the edges on them.
        """
        if self.skin is not None:
            return self.skin.wall_error / self.blade.chord
        halves = [self._wall_distance(name, wall) for name, wall in self.walls.items()]
        strips = [self._strip_distance(name, strip) for name, strip in self.strips.items()]
        return max([*halves, *strips]) / self.blade.chord

    def _least(self, name: str, wall: WallHalf) -> tuple[float, float, float]:
        face = cast(Surface, self.whole[name])
        v = _between(self.knots.across, (0.0, 0.5))
        lowest, places = [], []
        for piece, start, end in self._pieces():
            t = _between(getattr(self.knots, piece), (1e-6, 0.3, 0.7, 1.0 - 1e-6))
            u = start + (end - start) * t
            normal = np.cross(np.real(face.grid(u, v, 1, 0)), np.real(face.grid(u, v, 0, 1)))
            points, normals = (np.real(part) for part in wall.in_space(piece, t, v))
            radius = points[..., 1] ** 2 + points[..., 2] ** 2 if self.duct.revolved else 1.0
            lowest.append(wall.sign * dot(normal, normals) / radius)
            places.append(u)
        jacobian, u = np.concatenate(lowest), np.concatenate(places)
        i, j = np.unravel_index(int(np.argmin(jacobian)), jacobian.shape)
        return float(jacobian[i, j] / np.median(jacobian)), float(u[i]), float(v[j])

    def _wall_distance(self, name: str, wall: WallHalf) -> float:
        face = cast(Surface, self.whole[name])
        v = _between(self.knots.across, (0.0, 0.31, 0.74))
        worst = 0.0
        for piece, start, end in self._pieces():
            t = _between(getattr(self.knots, piece), (0.31, 0.74))
            points, normals = (np.real(part) for part in wall.in_space(piece, t, v))
            distances = dot(np.real(face.grid(start + (end - start) * t, v)) - points, normals)
            worst = max(worst, float(np.max(np.abs(distances))))  # real: a measured distance
        return worst

    def _strip_distance(self, name: str, strip: WallStrip) -> float:
        face = cast(Surface, self.whole[name])
        t, v = _between(getattr(self.knots, strip.piece), (0.31, 0.74)), np.linspace(0.0, 1.0, 9)
        points, normals = (np.real(part) for part in strip.in_space(strip.piece, t, v))
        return float(np.max(np.abs(dot(np.real(face.grid(t, v)) - points, normals))))  # real: a measured distance

    @staticmethod
    def _pieces() -> tuple[tuple[str, float, float], ...]:
        ends = (0.0, *BLADE_AT, 1.0)
        return tuple(zip(PIECES, ends, ends[1:], strict=False))


def _between(knots: Reals, shares: tuple[float, ...]) -> Reals:
    """Parameters at shares of each knot span, and the last knot where 0 is among them."""
    spans = breaks(knots)
    places = np.concatenate([spans[:-1] + share * np.diff(spans) for share in shares])
    return np.sort(np.append(places, spans[-1]) if 0.0 in shares else places)


def pieces_of(name: str, face: Surface, knots: PassageKnots) -> dict[str, Surface]:
    """The smooth pieces of a face between its creases, each over [0, 1], by names that begin with the face's."""
    trimmed_walls = knots.walls == "trimmed" and not name.startswith("periodic")
    if name.startswith("blade") or name.endswith(STRIPS) or trimmed_walls:
        return {name: face}
    cuts: tuple[float, ...] = BLADE_AT
    ends: tuple[str, ...] = PIECES
    if name in {"inlet", "outlet"}:
        edge = int(name == "outlet")
        cuts = knots.cuts(edge)
        ends = ("lower", STRIPS[edge], "upper") if knots.blunt[edge] else ("lower", "upper")
    parts = split(face, np.array(cuts), "u")
    return {f"{name}_{end}": reparametrised(part) for end, part in zip(ends, parts, strict=True)}
