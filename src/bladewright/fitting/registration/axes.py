"""The axes of a prismatic blade of a cascade that its cloud alone shows.

Along the span every point projects onto one closed curve. The axis of an annular blade is not sought: its ends lie on
surfaces of revolution about axes degrees apart within less than any noise (design/fit_clouds.md).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

from bladewright.errors import FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.clouds.isolated import has_neighbours
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.design_header import Arrangement
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation, tukey_weights
from bladewright.nurbs.basis import Reals

AXES_POINTS = 50_000
"""points that are looked at; it bounds the time, and more say little new about where a blade lies."""
PRISM_THICKNESS = 1e-3
"""thickness of a projection, of the cloud's extent, below which the cloud is a prism."""
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


@dataclass(frozen=True, kw_only=True)
class MachineAxes:
    """The machine's axes as a cloud alone shows them."""

    motion: Motion
    """from the points as given to the machine's axes"""
    arrangement: Arrangement
    notes: tuple[str, ...]
    """what is a convention, each a sentence"""


def found_axes(points: Reals, *, arrangement: Arrangement | None = None) -> MachineAxes:
    """The machine's axes of a cloud (n, 3) [m] of one blade that lies anywhere, without a design.

    A prism is a blade of a linear cascade: its direction is the span z, and the chord line is laid along x. Raises
    FitError where the blade is none, or is called annular.
    """
    cloud = np.asarray(points, dtype=np.float64)
    if cloud.ndim != 2 or cloud.shape[1] != 3:
        raise FitError(f"axes were asked of a cloud of shape {cloud.shape}: give points (n, 3)")
    cloud = cloud[np.isfinite(cloud).all(axis=1)]
    cloud = cloud[random_subset(len(cloud), AXES_POINTS)]
    cloud = cloud[has_neighbours(cloud)]
    if len(cloud) < 100:
        raise FitError(f"axes were asked of {len(cloud)} points: at least 100 are needed; give --start, or the axes")
    if arrangement != "annular":
        prism = _prism_of(cloud)
        extent = float(np.max(np.ptp(cloud, axis=0)))
        if prism.rms < PRISM_THICKNESS * extent and (arrangement == "linear" or _flat_ends(cloud, prism.direction)):
            return _cascade(cloud, prism)
        if arrangement == "linear":
            raise FitError(
                f"the cloud is no prism: along the best direction its section is blurred by {prism.rms:.3g} m, more "
                f"than {PRISM_THICKNESS * extent:.3g} m; "
                "of a cascade's tapered or twisted blade the axes are not found. Give "
                "--start, or move the points into the machine's axes (x downstream, z along the span)"
            )
    raise FitError(
        "the machine axis of an annular blade cannot be told from its points alone: give --start with a design of "
        "about this blade, or move the points into the machine's axes (x downstream along the machine axis) and leave "
        "out --align; a prismatic blade of a cascade needs --arrangement linear"
    )


def _cascade(cloud: Reals, prism: Prism) -> MachineAxes:
    """The axes of a prism."""
    span = prism.direction
    frame = np.linalg.svd(span[None])[2][1:]
    flat = cloud @ frame.T
    chord = _chord(flat)
    ahead = (chord[1] - chord[0]) @ frame
    ahead /= np.sqrt(np.sum(ahead**2))
    rotation = np.stack([ahead, np.cross(span, ahead), span])
    moved = cloud @ rotation.T
    bulge = np.mean(moved[:, 1]) - rotation[1] @ (chord[0] @ frame)
    if bulge < 0.0:
        rotation = rotation * np.array([[1.0], [-1.0], [-1.0]])
        moved = cloud @ rotation.T
    leading_edge = rotation @ (chord[0] @ frame)
    origin = np.array([leading_edge[0], leading_edge[1], np.min(moved[:, 2])])
    return MachineAxes(
        motion=Motion(rotation=rotation, translation=-origin),
        arrangement="linear",
        notes=(
            "the cloud is a prism, taken as a blade of a linear cascade with its span along z",
            (
                "a prism does not show where the machine axis lies in its section: x is laid along the chord, from the "
                "thicker edge (leading) to the thinner one, so that stagger is 0 and all angles count from the chord; "
                "the camber bulges towards +y, the origin is at the leading edge's lower end"
            ),
        ),
    )


def _chord(flat: Reals) -> Reals:
    """Leading and trailing edge (2, 2) of a section: its points that are furthest apart, the thicker end first."""
    hull = flat[ConvexHull(flat).vertices]
    square = np.sum((hull[:, None] - hull[None]) ** 2, axis=-1)
    i, j = np.unravel_index(np.argmax(square), square.shape)
    one, other = hull[i], hull[j]
    along = (other - one) / np.sqrt(square[i, j])
    x = (flat - one) @ along / np.sqrt(square[i, j])
    y = (flat - one) @ np.array([-along[1], along[0]])
    ends = [float(np.ptp(y[near])) if near.any() else 0.0 for near in (x < 0.1, x > 0.9)]
    return np.array([one, other] if ends[0] >= ends[1] else [other, one])


def _prism_of(points: Reals) -> Prism:
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
        width = max(TUKEY_WIDTH * median_deviation(left), 1e-15)
        root = np.sqrt(tukey_weights(left, width))
        rows = -normal * lift[:, None] * root[:, None]
        step = np.linalg.lstsq(rows, -left * root, rcond=1e-9)[0]
        inner = np.abs(left) < width
        rms = float(np.sqrt(np.mean(left[inner] ** 2)))
        direction = direction + step @ frame
        direction = direction / np.sqrt(np.sum(direction**2))
        if np.max(np.abs(step)) < 1e-12:
            break
    return Prism(direction=direction, rms=rms)


def _flat_ends(cloud: Reals, direction: Reals) -> bool:
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
                weight = tukey_weights(residuals, max(TUKEY_WIDTH * median_deviation(residuals), 1e-12))
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
