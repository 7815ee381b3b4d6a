"""The direction of a prismatic cloud: along it every point projects onto one closed curve."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.registration.robust_motion import tukey_weights
from bladewright.nurbs.basis import Reals

PRISM_POINTS = 1_200
"""points by which directions are compared; it bounds the time."""
TRIAL_DIRECTIONS = 500
"""directions that are tried, spread evenly over half a sphere"""
GRID_CELLS = 40
"""cells of a grid in the cloud's extent by which directions are compared"""
FOLLOWED_DIRECTIONS = 6
"""directions that are followed to their minimum"""
CURVE_NEIGHBOURS = 60
"""points of the projection that a piece of the curve is laid through"""
SECTION_CELLS = 40
"""cells of the section's extent, in each of which the last point is taken"""
CURVED_END_RATIO, CURVED_END_SHARE = 3.0, 2e-4
"""an end bends where a plane misses it by this many times what a parabola leaves, and by more than
`CURVED_END_SHARE` of the extent."""
PRISM_STEPS = 12
"""steps of the least squares at most"""


@dataclass(frozen=True, kw_only=True)
class Prism:
    """A direction, and how thin the cloud's projection along it is."""

    direction: Reals
    """(3,) unit vector"""
    rms: float
    """distance of the projected points from the curve through their neighbours, but for outliers [m]"""


def prism_of(points: Reals) -> Prism:
    """The direction in which the projection of points (n, 3) is thinnest."""
    cloud = points[random_subset(len(points), PRISM_POINTS)]
    cloud = cloud - np.median(cloud, axis=0)
    directions = _hemisphere(TRIAL_DIRECTIONS)
    cell = float(np.max(np.ptp(cloud, axis=0))) / GRID_CELLS
    # a curve passes through few cells of a grid, whatever rows the points stand in
    scores = [len(np.unique(np.floor(cloud @ _across(d).T / cell).astype(int) @ [1, 10_000])) for d in directions]
    tried = [_followed(cloud, directions[k]) for k in np.argsort(scores)[:FOLLOWED_DIRECTIONS]]
    return min(tried, key=lambda prism: prism.rms)


def _followed(cloud: Reals, direction: Reals) -> Prism:
    """The prism near a direction."""
    rms = np.inf
    for _ in range(PRISM_STEPS):
        frame = _across(direction)
        flat, height = cloud @ frame.T, cloud @ direction
        near = cKDTree(flat).query(flat, k=CURVE_NEIGHBOURS)[1]
        local = flat[near] - flat[near].mean(axis=1, keepdims=True)
        axes = np.linalg.eigh(np.einsum("nki,nkj->nij", local, local))[1]
        normal, along = axes[:, :, 0], np.einsum("nki,ni->nk", local, axes[:, :, 1])
        residuals = np.einsum("nki,ni->nk", local, normal)
        # what smoothing by a parabola leaves of a point's distance and height
        scale = np.maximum(np.max(np.abs(along), axis=1, keepdims=True), 1e-300)
        vander = np.stack([np.ones_like(along), along / scale, (along / scale) ** 2], axis=-1)
        normal_matrix = np.einsum("nki,nkj->nij", vander, vander) + 1e-12 * np.eye(3)
        first = np.einsum("nki,ni->nk", vander, np.linalg.solve(normal_matrix, vander[:, 0, :, None])[..., 0])
        left = residuals[:, 0] - np.einsum("nj,nj->n", first, residuals)
        lift = height - np.einsum("nj,nj->n", first, height[near])
        width = max(4.685 * 1.4826 * float(np.median(np.abs(left))), 1e-15)
        root = np.sqrt(tukey_weights(np.abs(left), width))
        rows = -normal * lift[:, None] * root[:, None]
        step = np.linalg.lstsq(rows, -left * root, rcond=1e-9)[0]
        inner = np.abs(left) < width
        rms = float(np.sqrt(np.mean(left[inner] ** 2)))
        direction = direction + step @ frame
        direction = direction / np.sqrt(np.sum(direction**2))
        if np.max(np.abs(step)) < 1e-12:
            break
    return Prism(direction=direction, rms=rms)


def flat_ends(cloud: Reals, direction: Reals) -> bool:
    """Whether the highest and the lowest points along a direction lie on planes, not on surfaces that bend."""
    flat, height = cloud @ _across(direction).T, cloud @ direction
    flat = flat - flat.mean(axis=0)
    extent = float(np.max(np.ptp(cloud, axis=0)))
    cells = np.unique(np.floor(flat / np.max(np.ptp(flat, axis=0)) * SECTION_CELLS), axis=0, return_inverse=True)[
        1
    ].ravel()
    order = np.lexsort((height, cells))
    last = np.flatnonzero(np.diff(cells[order], append=-1))
    first = np.concatenate([[0], last[:-1] + 1])
    for rows in (order[first], order[last]):
        x, y = flat[rows].T / extent
        level = height[rows] / extent
        left = []
        for terms in ([np.ones_like(x), x, y], [np.ones_like(x), x, y, x * x, x * y, y * y]):
            design = np.stack(terms, axis=-1)
            weight = np.ones(len(x))
            for _ in range(8):
                root = np.sqrt(weight)
                plane = np.linalg.lstsq(design * root[:, None], level * root, rcond=1e-9)[0]
                residuals = np.abs(level - design @ plane)
                weight = tukey_weights(residuals, max(7.0 * float(np.median(residuals)), 1e-12))
            left.append(float(np.median(residuals)))
        if left[0] > CURVED_END_RATIO * left[1] and left[0] > CURVED_END_SHARE:
            return False
    return True


def _across(direction: Reals) -> Reals:
    """Two unit vectors (2, 3) perpendicular to a direction and to each other."""
    return np.linalg.svd(direction[None])[2][1:]


def _hemisphere(count: int) -> Reals:
    """Directions (count, 3) spread evenly over half a sphere (Gonzalez 2010)."""
    k = np.arange(count) + 0.5
    z, turn = k / count, np.pi * (1.0 + 5.0**0.5) * k
    return np.stack([np.sqrt(1.0 - z**2) * np.cos(turn), np.sqrt(1.0 - z**2) * np.sin(turn), z], axis=-1)
