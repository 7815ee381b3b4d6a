"""Whether points are a sheet without thickness: one side of a blade, or a part of one."""

import numpy as np
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals

THINNEST_BLADE = 1.3e-3
"""roughness, of its width, below which a cloud is a smooth sheet: one side and no blade."""


def is_one_sided(points: Reals) -> bool:
    """Whether the points are a single sheet: a smooth one passes through the neighbours of most of them."""
    centred = points - np.mean(points, axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    own = centred @ axes.T
    along, height = own[:, :-1], own[:, -1]
    width = float(np.ptp(along[:, -1])) if along.shape[1] > 1 else float(np.ptp(along))
    count = 14 if along.shape[1] == 1 else 24
    some = np.linspace(0, len(points) - 1, 200).astype(int)
    neighbours = cKDTree(along).query(along[some], k=count)[1]
    residuals = []
    for rows in neighbours:
        t = along[rows] - np.mean(along[rows], axis=0)
        t = t / max(float(np.max(np.abs(t))), 1e-300)
        powers = [np.ones(count), *t.T, *(t.T**2), *([t[:, 0] * t[:, 1]] if t.shape[1] > 1 else [])]
        matrix = np.stack(powers, axis=-1)
        found = np.linalg.lstsq(matrix, height[rows], rcond=0.03)[0]
        residuals.append(float(np.sqrt(np.mean((height[rows] - matrix @ found) ** 2))))
    # where sections are dense at the edges most neighbourhoods are of an edge, which is thin
    return float(np.percentile(residuals, 90.0)) < THINNEST_BLADE * width
