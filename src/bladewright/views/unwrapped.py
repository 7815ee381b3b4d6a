"""The plane of a passage's wall, (m', theta) or (m, y) in a cascade: native points of the wall laid out in it."""

from typing import TYPE_CHECKING, cast

import numpy as np
from scipy.spatial import cKDTree

from bladewright.domain.knots import PIECES
from bladewright.numerics.elementary import angle, dot
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.sections import COORDINATES, along_curve
from bladewright.views.style import MILLIMETRES

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage

HALVES = ("upper", "lower")


def unwrapped_face(passage: "Passage", name: str, u: Reals, v: Reals) -> Reals:
    """Points (k, l, 2) at u (k,) and v (l,) of a wall's native half in its plane [mm]."""
    face, half = cast(Surface, passage.whole[name]), passage.walls[name]
    aside = half.sign * float(np.real(half.half_pitch)) * np.broadcast_to(v, (len(u), len(v)))
    return unwrapped(passage, name.partition("_")[0], np.real(face.grid(u, v)), aside)


def blade_foot(passage: "Passage", wall: str) -> Reals:
    """The closed outline (n, 2) in the wall's plane [mm] of the blade's end on or nearest to it."""
    end = np.array([0.0 if wall == "hub" else 1.0])
    sides = [cast(Surface, passage.whole[f"blade_{half}"]).grid(along_curve(), end)[:, 0] for half in HALVES]
    return unwrapped(passage, wall, np.real(np.concatenate([sides[0], sides[1][::-1]])))


def pitch_on(passage: "Passage", wall: str) -> float:
    """Distance of neighbours in the wall's plane [mm]."""
    return 2.0 * float(np.real(passage.walls[f"{wall}_upper"].half_pitch)) * size_on(passage, wall)


def size_on(passage: "Passage", wall: str) -> float:
    """Millimetres in a unit of the wall's plane: the mean radius beside the blade, or a metre's in a cascade."""
    if not passage.duct.revolved:
        return MILLIMETRES
    line = passage.walls[f"{wall}_upper"].line
    return float(np.mean(np.real(line.position(np.linspace(0.0, 1.0, 65))[..., 1]))) * MILLIMETRES


def coordinates(passage: "Passage") -> tuple[str, str]:
    """Names of the plane's axes."""
    return COORDINATES["m'-theta" if passage.duct.revolved else "m-y"]


def unwrapped(passage: "Passage", wall: str, points: Reals, aside: Reals | float = 0.0) -> Reals:
    """Points (..., 3) [m] on or near a wall in its plane (..., 2) [mm], by the nearest place of its meridian.

    `aside` (...) is how far, within half a turn, theta is from that of the continued camber line.
    """
    x, y, z = np.moveaxis(points, -1, 0)
    revolved, line = passage.duct.revolved, passage.walls[f"{wall}_upper"].line
    target = np.stack([x, np.sqrt(y * y + z * z) if revolved else z], axis=-1).reshape(-1, 2)
    places = np.linspace(passage.duct.low, passage.duct.high, 2001)
    u = places[cKDTree(np.real(line.position(places))[0]).query(target)[1]]
    for _ in range(3):
        slope = np.real(line.position(u, 1))[0]
        u = u + dot(target - np.real(line.position(u))[0], slope) / dot(slope, slope)
    abscissa = np.real(line.abscissa(u))[0].reshape(points.shape[:-1])
    ordinate = y
    if revolved:
        about = _camber_theta(passage, wall, abscissa) + aside
        ordinate = about + np.mod(angle(y, z) - about + np.pi, 2.0 * np.pi) - np.pi
    return np.asarray(np.stack([abscissa, ordinate], axis=-1) * size_on(passage, wall))


def _camber_theta(passage: "Passage", wall: str, abscissa: Reals) -> Reals:
    """theta (...) of the wall's continued camber line at abscissae (...)."""
    row, t = passage.walls[f"{wall}_upper"].row, np.linspace(0.0, 1.0, 101)
    line = np.concatenate([np.real(passage.camber.points(piece, t))[row] for piece in PIECES])
    return np.asarray(np.interp(abscissa, line[:, 0], line[:, 1]))
