"""How far points lie off a blade's faces but for its sides: fillets, edges that are cut, and the walls of its ends."""

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.native.blade import Blade
from bladewright.fitting.matching.blade_ends import END_PARAMETERS, WallPoints
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import Descents
from bladewright.nurbs.surface import Surface

LONGEST_NAME = 20
"""characters of the longest name of such a face, cut trailing edge"""


def meridional_places(points: Reals, built: Blade) -> Reals:
    """Places (n, 2) of points (n, 3) in (x, r), or in (x, z) of a cascade."""
    around = np.hypot(points[:, 1], points[:, 2]) if built.exact.mapping.revolved else points[:, 2]
    return np.stack([points[:, 0], around], axis=-1)


def off_walls(points: Reals, built: Blade) -> dict[str, Reals]:
    """Distances (n,) [m] of points (n, 3) from the walls and faces of revolution that cuts and fillets have changed."""
    places = meridional_places(points, built)
    return {name: np.sqrt(Descents((curve,)).nearest(places).square) for name, (curve, _) in built.walls.items()}


def off_finished_faces(points: Reals, built: Blade) -> tuple[NDArray[np.str_], Reals]:
    """The nearest of these faces for each of points (n, 3), such as `cut trailing edge`, and how far it is [m]."""
    off = {f"cut {name}" if name.endswith("_edge") else name: far for name, far in off_walls(points, built).items()}
    for wall, name in zip(END_PARAMETERS, built.design.ends, strict=True):
        if name not in off:
            places = meridional_places(points, built)
            off[name] = np.abs(WallPoints(name=wall, places=places, spread=0.0).distances(built.exact))
    for name, face in built.surfaces.items():
        if "_fillet" in name and isinstance(face, Surface):
            own = f"{name.partition('_')[0]} fillet"
            far = np.sqrt(Descents((face,)).nearest(points).square)
            off[own] = np.minimum(off.get(own, np.inf), far)
    names, every = np.array([name.replace("_", " ") for name in off]), np.stack(list(off.values()))
    nearest = np.argmin(every, axis=0)
    return names[nearest], every[nearest, np.arange(len(points))]
