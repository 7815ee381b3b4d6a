"""Nearest places of points on the native sides of a blade and on the walls of its channel."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import BSpline
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from bladewright.blade.knots import DEGREE, Knots
from bladewright.nurbs.basis import Reals, basis
from bladewright.nurbs.surface import Surface


@dataclass(frozen=True, kw_only=True)
class Feet:
    """The nearest places on the sides, one a point."""

    upper: np.ndarray
    """(n,) whether the place is on the upper side"""
    u: Reals
    v: Reals
    normal: Reals
    """(n, 3) unit normals of the surface there"""
    beyond: Reals
    """(n, 3) at an end of the blade the unit vector in the surface that points out of it; 0 inside"""
    miss: Reals
    """(n, 3) from the place to the point [m]"""

    @property
    def distances(self) -> Reals:
        return np.linalg.norm(self.miss, axis=-1)


def feet(points: Reals, upper: Surface, lower: Surface) -> Feet:
    """Nearest places: the best of a fine grid of each side, then Newton's method kept inside the side."""
    found = [_on_side(points, side) for side in (upper, lower)]
    distances = [np.linalg.norm(miss, axis=-1) for *_, miss in found]
    first = distances[0] <= distances[1]
    u, v, miss = (np.where(first if a.ndim == 1 else first[:, None], a, b) for a, b in zip(*found, strict=True))
    normal, beyond = np.empty_like(miss), np.zeros_like(miss)
    for side, mask in ((upper, first), (lower, ~first)):
        along_u, along_v = side.derivative(u[mask], v[mask], 1, 0), side.derivative(u[mask], v[mask], 0, 1)
        across = np.cross(along_u, along_v)
        normal[mask] = across / np.linalg.norm(across, axis=-1)[:, None]
        out = np.cross(normal[mask], along_u)
        out /= np.linalg.norm(out, axis=-1)[:, None]
        beyond[mask] = out * ((v[mask] >= 1.0).astype(float) - (v[mask] <= 0.0))[:, None]
    return Feet(upper=first, u=u, v=v, normal=normal, beyond=beyond, miss=miss)


def _on_side(points: Reals, side: Surface) -> tuple[Reals, Reals, Reals]:
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 161))) / 2.0
    v = np.linspace(0.0, 1.0, 4 * side.control_points.shape[1] - 19)
    grid = side.grid(u, v)
    _, index = cKDTree(grid.reshape(-1, 3)).query(points)
    at = [u[index // len(v)], v[index % len(v)]]
    best = list(at)
    nearest = np.sum((side(*at) - points) ** 2, axis=-1)
    for _ in range(12):
        d = side.derivatives(*at, 2)
        miss = d[0, 0] - points
        g = [np.sum(miss * d[1, 0], axis=-1), np.sum(miss * d[0, 1], axis=-1)]
        uu, uv, vv = (np.sum(a * b, axis=-1) for a, b in ((d[1, 0], d[1, 0]), (d[1, 0], d[0, 1]), (d[0, 1], d[0, 1])))
        full = [h + np.sum(miss * e, axis=-1) for h, e in ((uu, d[2, 0]), (uv, d[1, 1]), (vv, d[0, 2]))]
        convex = (full[0] > 0.0) & (full[2] > 0.0) & (full[0] * full[2] > full[1] ** 2)
        uu, uv, vv = (np.where(convex, f, h) for f, h in zip(full, (uu, uv, vv), strict=True))
        held_u = ((at[0] <= 0.0) & (g[0] > 0.0)) | ((at[0] >= 1.0) & (g[0] < 0.0))
        held_v = ((at[1] <= 0.0) & (g[1] > 0.0)) | ((at[1] >= 1.0) & (g[1] < 0.0))
        uv = np.where(held_u | held_v, 0.0, uv)
        g = [np.where(held_u, 0.0, g[0]), np.where(held_v, 0.0, g[1])]
        determinant = uu * vv - uv**2 + 1e-300
        step = [-(vv * g[0] - uv * g[1]) / determinant, -(uu * g[1] - uv * g[0]) / determinant]
        at = [np.clip(a + np.clip(s, -0.05, 0.05), 0.0, 1.0) for a, s in zip(at, step, strict=True)]
        squares = np.sum((side(*at) - points) ** 2, axis=-1)
        better = squares < nearest
        nearest = np.where(better, squares, nearest)
        best = [np.where(better, a, b) for a, b in zip(at, best, strict=True)]
    return best[0], best[1], points - side(*best)


def projected(knots: Knots, u: Reals, v: Reals, direction: Reals) -> csr_array:
    """Sparse matrix (n, n_u n_v 3) from a net to the displacements along `direction` (n, 3) at the places."""
    parts = [BSpline.design_matrix(at, each, DEGREE) for at, each in ((u, knots.u), (v, knots.v))]
    size = DEGREE + 1
    index, value = ([np.reshape(getattr(part, name), (-1, size)) for part in parts] for name in ("indices", "data"))
    columns = ((index[0][:, :, None] * knots.poles[1] + index[1][:, None, :])[..., None] * 3 + np.arange(3)).ravel()
    data = (value[0][:, :, None, None] * value[1][:, None, :, None] * direction[:, None, None, :]).ravel()
    starts = np.arange(len(u) + 1) * size * size * 3
    return csr_array((data, columns, starts), shape=(len(u), knots.poles[0] * knots.poles[1] * 3))


def wall_feet(channel: Any, wall: str, places: Reals) -> tuple[Reals, Reals, Reals]:
    """Nearest parameters on a wall continued by its own polynomial, unit normals and misses there."""
    line = channel.line(wall)
    points, degree, knots = np.real(line.points), line.degree, line.knots
    t = np.linspace(-0.03, 1.03, 400)
    _, index = cKDTree(basis(knots, degree, t) @ points).query(places)
    t = t[index]
    for _ in range(6):
        value, first, second = (basis(knots, degree, t, k) @ points for k in range(3))
        miss = value - places
        t = t - np.sum(miss * first, axis=-1) / (np.sum(first**2, axis=-1) + np.sum(miss * second, axis=-1))
    value, first = (basis(knots, degree, t, k) @ points for k in range(2))
    normal = np.stack([-first[:, 1], first[:, 0]], axis=-1) / np.linalg.norm(first, axis=-1)[:, None]
    return t, normal, places - value
