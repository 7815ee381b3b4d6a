"""How far points lie off the faces that cuts and fillets give a blade: fillets, cut edges, walls of its ends."""

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.native.blade import Blade
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import Descents
from bladewright.nurbs.surface import Surface


def off_walls(points: Reals, built: Blade) -> dict[str, Reals]:
    """Distances (n,) [m] of points (n, 3) from the walls and faces of revolution that cuts and fillets have changed."""
    around = np.hypot(points[:, 1], points[:, 2]) if built.exact.mapping.revolved else points[:, 2]
    places = np.stack([points[:, 0], around], axis=-1)
    return {name: np.sqrt(Descents((curve,)).nearest(places).square) for name, (curve, _) in built.walls.items()}


def off_finished_faces(points: Reals, built: Blade) -> tuple[NDArray[np.str_], Reals]:
    """The nearest of these faces for each of points (n, 3), such as `cut trailing edge`, and how far it is [m]."""
    off = {f"cut {name}" if name.endswith("_edge") else name: far for name, far in off_walls(points, built).items()}
    for name, face in built.surfaces.items():
        if "_fillet" in name and isinstance(face, Surface):
            own = f"{name.partition('_')[0]} fillet"
            far = np.sqrt(Descents((face,)).nearest(points).square)
            off[own] = np.minimum(off.get(own, np.inf), far)
    names, every = np.array([name.replace("_", " ") for name in off]), np.stack(list(off.values()))
    nearest = np.argmin(every, axis=0)
    return names[nearest], every[nearest, np.arange(len(points))]
