"""Native faces as grids of points and their borders as lines, for the views in space."""

import numpy as np

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.views.style import per_metre

Face = Surface | TrimmedSurface
LINE_POINTS = 161
"""Points of a border, between which it is straight in a picture."""
INSIDE = 1e-6
"""How far the first and the last column of points across a trimmed face stand inside it, of its width: a boundary that
runs along a column does not cross it."""
CLOSED = 1e-6
"""Distance of a line's ends, of its size, below which it is a closed one."""


def sampled(face: Face, u: Reals, v: Reals) -> tuple[Reals, Reals]:
    """Points (m, n, 3) [unit of the picture] of a face at shares u (m,) and v (n,), and normals along dS/du x dS/dv.

    Of a trimmed face u is a share of its width, and v of the way across from border to border there; its holes are
    covered.
    """
    if isinstance(face, TrimmedSurface):
        surface, at = face.surface, _across(face, u, v)
    else:
        ends = zip((face.domain_u, face.domain_v), (u, v), strict=True)
        columns, rows = np.meshgrid(*(a + (b - a) * share for (a, b), share in ends), indexing="ij")
        surface, at = face, (columns, rows)
    along, aside = (np.real(surface.derivative(*at, *order)) for order in ((1, 0), (0, 1)))
    normals = np.cross(along, aside)
    size = np.sqrt(np.sum(normals**2, axis=-1, keepdims=True))
    return per_metre() * np.real(surface(*at)), normals / np.maximum(size, 1e-300)


def _across(face: TrimmedSurface, u: Reals, v: Reals) -> tuple[Reals, Reals]:
    """Parameters (m, n) between the lowest and the highest crossing of each line u = const with the boundary."""
    loop = np.concatenate(_boundary(face))
    low, high = loop[:, 0].min(), loop[:, 0].max()
    column = (low + (high - low) * (INSIDE + (1.0 - 2.0 * INSIDE) * u))[:, None]
    start, end = loop, np.roll(loop, -1, axis=0)
    crossed = (start[:, 0] <= column) != (end[:, 0] <= column)
    step = np.where(crossed, end[:, 0] - start[:, 0], 1.0)
    place = start[:, 1] + (column - start[:, 0]) / step * (end[:, 1] - start[:, 1])
    lowest = np.where(crossed, place, np.inf).min(axis=1)[:, None]
    highest = np.where(crossed, place, -np.inf).max(axis=1)[:, None]
    return np.broadcast_to(column, (len(u), len(v))), lowest + v * (highest - lowest)


def _boundary(face: TrimmedSurface) -> list[Reals]:
    """Points (n, 2) in (u, v) of each boundary curve of a trimmed face."""
    share = np.linspace(0.0, 1.0, LINE_POINTS)
    return [np.real(curve(a + (b - a) * share)) for curve in face.boundary for a, b in [curve.domain]]


def borders(face: Face) -> list[Reals]:
    """Lines (n, 3) [unit of the picture] around a face: v = 0, v = 1, u = 0 and u = 1, or its boundary curves."""
    if isinstance(face, TrimmedSurface):
        return [per_metre() * np.real(face.surface(*line.T)) for line in _boundary(face)]
    share, ends = np.linspace(0.0, 1.0, LINE_POINTS), np.array([0.0, 1.0])
    along, across = sampled(face, share, ends)[0], sampled(face, ends, share)[0]
    return [along[:, 0], along[:, 1], across[0], across[1]]


def is_closed(line: Reals) -> bool:
    """Whether a line (n, 3) ends where it begins, as a circle does."""
    gap = line[-1] - line[0]
    return float(gap @ gap) < (CLOSED * float(np.ptp(line, axis=0).max())) ** 2


def meridian_line(face: Face) -> Reals:
    """The line (n, 2) in (x, r) [unit of the picture] that a face of revolution is turned from."""
    share, middle = np.linspace(0.0, 1.0, LINE_POINTS), np.array([0.5])
    return _flat(sampled(face, middle, share)[0][0] if turns_along_u(face) else sampled(face, share, middle)[0][:, 0])


def turns_along_u(face: Face) -> bool:
    """Whether u of a face of revolution is the one that runs around the axis."""
    share, middle = np.linspace(0.0, 1.0, 5), np.array([0.5])
    first, second = _flat(sampled(face, share, middle)[0][:, 0]), _flat(sampled(face, middle, share)[0][0])
    return float(np.ptp(first, axis=0).max()) < float(np.ptp(second, axis=0).max())


def _flat(points: Reals) -> Reals:
    """Points (n, 3) in (x, r)."""
    return np.stack([points[:, 0], np.hypot(points[:, 1], points[:, 2])], axis=-1)
