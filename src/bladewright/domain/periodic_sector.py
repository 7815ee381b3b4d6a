"""The periodic sector of the annulus: fluid and blade together, between exact surfaces of revolution."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bladewright.blade.native.blade import Faces
from bladewright.blade.native.end_faces import Near, WallSurface, followed
from bladewright.domain.duct import Duct
from bladewright.domain.knots import BLADE_AT
from bladewright.domain.skin import Skin, wall_face
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array, angle
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.domain import split
from bladewright.nurbs.mass_properties import MassProperties, mass_properties
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

PLACES = 65
"""Points of an edge whose parameters on the wall are found by search; between them they are interpolated and polished,
so that half or twice as many give the same volume (design/passage_constants.md)."""
MERIDIAN_POINTS = 2001
"""Points of the wall's meridian among which that search looks for the nearest: a quarter of them, or four times as
many, give the same volume (design/passage_constants.md)."""
OVERHANG = 0.02
"""How far the untrimmed walls reach past inlet and outlet, in mean meridional lengths: trimming needs a margin. A tenth
of it, or ten times as much, gives the same volume (design/passage_constants.md)."""
ANGULAR_OVERHANG = 0.05
"""The same in theta (y in a cascade), as a share of the sector's width."""
OUTWARD = FrozenMapping({"hub": -1, "shroud": 1, "inlet": -1, "outlet": 1, "periodic_upper": -1, "periodic_lower": 1})
"""+1 for the faces whose dS/du x dS/dv points out of the sector, -1 for the others."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PeriodicSector(FrozenRecord):
    """One blade's share of the duct; with the blade cut out of it, the passage is left."""

    name: str
    surfaces: Faces
    """`hub` and `shroud`, trimmed pieces of the duct's own walls, and the passage's other outer faces; metres"""

    @property
    def orientations(self) -> Mapping[str, int]:
        """+1 for the faces whose dS/du x dS/dv points out of the sector, -1 for the others."""
        return OUTWARD

    @cached_property
    def properties(self) -> MassProperties:
        """Volume [m^3], area [m^2], centroid [m] and inertia [m^5], by quadrature on the native surfaces."""
        return mass_properties([(self.surfaces[name], sign) for name, sign in OUTWARD.items()])


Cuts = tuple[tuple[float, ...], tuple[float, ...]]
"""u of inlet and outlet at which their ends have creases."""


def periodic_sector(name: str, faces: Mapping[str, Surface], duct: Duct, chord: float, cuts: Cuts) -> PeriodicSector:
    """The sector of a passage with the given faces: its inlet, outlet and periodic boundaries."""
    surfaces: dict[str, Surface | TrimmedSurface] = {
        wall: _wall(faces, duct, row, wall, chord, cuts) for wall, row in (("hub", 0), ("shroud", -1))
    }
    surfaces |= {face: faces[face] for face in ("inlet", "outlet", "periodic_upper", "periodic_lower")}
    return PeriodicSector(name=name, surfaces=FrozenMapping(surfaces))


def sector_of(skin: Skin, name: str) -> PeriodicSector:
    """The sector of a skin, from its inlet to its outlet."""
    walls = {wall: wall_face(skin, wall, hole=False) for wall in ("hub", "shroud")}
    return PeriodicSector(name=name, surfaces=FrozenMapping(walls | skin.ends | skin.periodic))


def _wall(faces: Mapping[str, Surface], duct: Duct, row: int, name: str, chord: float, cuts: Cuts) -> TrimmedSurface:
    """A wall within its edges: along the lower periodic boundary, the outlet, and back."""
    margin = OVERHANG * duct.unit
    meridian = replace(duct, low=duct.low - margin, high=duct.high + margin).wall(name)
    edges = [
        edge
        for face, at in (
            ("periodic_lower", BLADE_AT),
            ("outlet", cuts[1]),
            ("periodic_upper", BLADE_AT),
            ("inlet", cuts[0]),
        )
        for edge in _wall_curves(faces[face], row, np.array(at), meridian, duct)
    ]
    across = np.concatenate([near[2] for _, near in edges])
    margin = ANGULAR_OVERHANG * float(np.ptp(across))
    if duct.revolved and float(np.ptp(across)) + 2.0 * margin >= 2.0 * np.pi:
        raise DesignError(
            f"upstream or downstream: the passage winds {np.degrees(np.ptp(across)):.0f} deg around the axis at the "
            f"{name}, and a sector's wall is one trimmed face of less than 327 deg: shorten them, or let the flow turn "
            "to a lower inlet_angle or outlet_angle"
        )
    wall = WallSurface(
        meridian=meridian,
        inner=np.empty(0),
        revolved=duct.revolved,
        low=float(across.min()) - margin,
        high=float(across.max()) + margin,
    )
    curves = [followed(wall, *edge, chord) for edge in edges]
    first, last = (len(BLADE_AT) + 2 + len(cuts[1])), len(cuts[0]) + 1
    ahead, back = curves[:first], [run_back(curve) for curve in curves[first:][::-1]]
    # the upper boundary and the inlet run against their own sense: outlet to inlet, then upper to lower
    boundary = (*ahead, *back[last:], *back[:last])
    return TrimmedSurface(surface=wall.surface, boundary=boundary, revolution=wall.revolution)


def _wall_curves(face: Surface, row: int, at: Reals, meridian: Curve, duct: Duct) -> list[tuple[Curve, Near]]:
    edge = Curve(control_points=np.real(face.control_points[:, row]), knots=face.knots_u, degree=face.degree_u)
    return [_wall_curve(piece, meridian, duct) for piece in split(edge, at)]


def _wall_curve(edge: Curve, meridian: Curve, duct: Duct) -> tuple[Curve, Near]:
    places = np.linspace(*edge.domain, PLACES)
    points = edge(places)
    radius = np.sqrt(points[:, 1] ** 2 + points[:, 2] ** 2) if duct.revolved else points[:, 2]
    across = np.unwrap(angle(points[:, 1], points[:, 2])) if duct.revolved else points[:, 1]
    return edge, (places, _nearest(meridian, np.stack([points[:, 0], radius], 1)), across)


def _nearest(meridian: Curve, points: Array) -> Reals:
    """Parameters of the nearest of MERIDIAN_POINTS points on the meridian."""
    u = np.linspace(*meridian.domain, MERIDIAN_POINTS)
    line = np.real(meridian(u))
    miss = np.sum((points[:, None, :] - line) ** 2, axis=-1)
    return np.asarray(u[np.argmin(miss, axis=1)])
