"""The machine's axes of a cloud: by an axis of rotation that is named, or of a prism by its span and chord."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

from bladewright.blade.design.row_design import Arrangement
from bladewright.errors import FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.clouds.thinning import random_subset, without_isolated_points
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation, tukey_weights
from bladewright.nurbs.basis import Reals

AXES_POINTS = 2000
"""points that are looked at; it bounds the time."""
PRISM_THICKNESS = 1e-3
"""thickness of a projection, of the cloud's extent, below which the cloud is a prism: a few times the noise of a
scan."""
NORMAL_NEIGHBOURS, CURVE_NEIGHBOURS = 12, 60
"""nearest points that a plane is laid through, and a parabola of the section, on which many stand above each other:
with fewer, 16 x 10 points of a stator pass for a prism."""
STEPS, SETTLED = 12, 1e-8
"""steps of the least squares at most, and the last turn [rad]"""
EDGE = 0.1
"""part of the chord whose thickness is that of an edge"""
CURES = (
    "name the axis of rotation (--axis z), give a design of about this blade (--align --start), or move the points "
    "into the machine's axes, x downstream"
)
"""what to do where axes are not found"""


def axis_motion(axis: str | Sequence[float], dimension: int) -> Motion:
    """The turn about the origin of points (n, d) whose axis of rotation has a name or a direction: it becomes x.

    Names are x, y and z, also with a sign. It is the smallest such turn, so that from an axis across z a span along z
    stays there; the opposite of x is turned about z.
    """
    names = "xyz"[:dimension]
    units = dict(zip(names, np.eye(dimension), strict=True))
    if isinstance(axis, str):
        word = axis.strip().lower()
        direction = units.get(word.lstrip("+-"), np.zeros(dimension)) * (-1.0 if word.startswith("-") else 1.0)
    else:
        direction = np.array([float(each) for each in axis])
    size = float(np.sqrt(np.sum(direction**2)))
    if direction.shape != (dimension,) or not 0.0 < size < np.inf:
        raise FitError(
            f"axis is {axis!r}: the direction of the machine's axis in the points' coordinates is needed, one of "
            f"{', '.join(names)}, also with a minus before it, or {dimension} numbers that are not all zero"
        )
    direction /= size
    middle = direction + units["x"]
    if middle @ middle < np.finfo(float).eps:
        return Motion(rotation=np.diag([-1.0, -1.0, 1.0][:dimension]), translation=np.zeros(dimension))
    # the reflection across the direction, then the one across the middle
    first, second = (np.eye(dimension) - 2.0 * np.outer(a, a) / (a @ a) for a in (direction, middle))
    return Motion(rotation=second @ first, translation=np.zeros(dimension))


def found_axes(points: Reals, *, arrangement: Arrangement | None = None) -> tuple[Motion, tuple[str, ...]]:
    """The motion of points (n, 3) [m] of a linear cascade's blade into the machine's axes, and notes on it.

    A prism is such a blade: its direction is the span z, and its chord line is laid along x. Raises FitError for any
    other blade, of which the points do not show the axis.
    """
    if points.shape[1] != 3:
        raise FitError(f"axes are found of points in space, and these have {points.shape[1]} coordinates: {CURES}")
    if arrangement == "annular":
        raise FitError(f"the machine axis of an annular blade cannot be told from its points alone: {CURES}")
    cloud = without_isolated_points(points[random_subset(len(points), AXES_POINTS)])
    span, thickness = prism_of(cloud)
    limit = PRISM_THICKNESS * float(np.max(np.ptp(cloud, axis=0)))
    if not thickness <= limit:
        raise FitError(
            "the cloud is no prism, whose axes would be found, and the machine axis of another blade cannot be told "
            f"from its points alone: along the best direction its section is blurred by {thickness:.3g} m, and "
            f"{limit:.3g} m are allowed; {CURES}"
        )
    leading, trailing = (edge @ _across(span) for edge in _chord(cloud @ _across(span).T))
    x = (trailing - leading) / np.sqrt(np.sum((trailing - leading) ** 2))
    # the camber bulges towards y, and the span points where y leaves it
    span = span if np.mean((cloud - leading) @ np.cross(span, x)) > 0.0 else -span
    rotation = np.stack([x, np.cross(span, x), span])
    moved = cloud @ rotation.T
    origin = np.append((rotation @ leading)[:2], np.min(moved[:, 2]))
    return Motion(rotation=rotation, translation=-origin), (
        (
            "the cloud is a prism, taken as a blade of a linear cascade with its span along z; of one in an annular "
            "row name the axis of rotation"
        ),
        (
            "a prism does not show where the machine axis lies in its section: x is laid along the chord, from the "
            "thicker edge (leading) to the thinner one, so that stagger is 0 and all angles count from the chord; the "
            "camber bulges towards +y, the origin is at the leading edge's lower end"
        ),
    )


def prism_of(points: Reals) -> tuple[Reals, float]:
    """The direction (3,) along which the projection of points (n, 3) is thinnest, and how thick that is [m]."""
    near = points[cKDTree(points).query(points, k=NORMAL_NEIGHBOURS)[1]]
    local = near - near.mean(axis=1, keepdims=True)
    normals = np.linalg.eigh(np.einsum("nki,nkj->nij", local, local))[1][:, :, 0]
    # the normals of a prism's sides are perpendicular to its direction
    starts = np.linalg.eigh(normals.T @ normals)[1].T
    found = [_thinnest(points, start) for start in starts]
    return min(found, key=lambda each: each[1])


def _thinnest(points: Reals, direction: Reals) -> tuple[Reals, float]:
    """A direction near a first one, and the distance [m] of the projected points from the curve through neighbours."""
    rms = np.inf
    for _ in range(STEPS):
        frame = _across(direction)
        flat, height = points @ frame.T, points @ direction
        near = cKDTree(flat).query(flat, k=CURVE_NEIGHBOURS)[1]
        local = flat[near] - flat[near].mean(axis=1, keepdims=True)
        axes = np.linalg.eigh(np.einsum("nki,nkj->nij", local, local))[1]
        off, along = (np.einsum("nki,ni->nk", local, axes[:, :, k]) for k in (0, 1))
        # the weights by which a parabola through the neighbours gives its value at the point itself
        along /= np.max(np.abs(along), axis=1, keepdims=True)
        terms = np.stack([np.ones_like(along), along, along**2], axis=-1)
        matrix = np.einsum("nki,nkj->nij", terms, terms)
        smoothing = np.einsum("nki,nij,nj->nk", terms, np.linalg.pinv(matrix, hermitian=True), terms[:, 0])
        left = off[:, 0] - np.sum(smoothing * off, axis=1)
        lift = height - np.sum(smoothing * height[near], axis=1)
        weights = tukey_weights(left, max(TUKEY_WIDTH * median_deviation(left), np.finfo(float).tiny))
        root = np.sqrt(weights)
        step = np.linalg.lstsq(-axes[:, :, 0] * (lift * root)[:, None], -left * root, rcond=1e-9)[0]
        rms = float(np.sqrt(np.mean(left[weights > 0.0] ** 2)))
        direction = direction + step @ frame
        direction /= np.sqrt(np.sum(direction**2))
        if np.max(np.abs(step)) < SETTLED:
            break
    return direction, rms


def _across(direction: Reals) -> Reals:
    """Two unit vectors (2, 3) perpendicular to a direction and to each other."""
    return np.linalg.svd(direction[None])[2][1:]


def _chord(flat: Reals) -> Reals:
    """Leading and trailing edge (2, 2) of a section: its points that are furthest apart, the thicker end first."""
    hull = flat[ConvexHull(flat).vertices]
    square = np.sum((hull[:, None] - hull[None]) ** 2, axis=-1)
    i, j = np.unravel_index(np.argmax(square), square.shape)
    one, other = hull[i], hull[j]
    along = (other - one) / square[i, j]
    x, y = (flat - one) @ along, (flat - one) @ np.array([-along[1], along[0]])
    ends = [float(np.ptp(y[near])) if np.any(near) else 0.0 for near in (x < EDGE, x > 1.0 - EDGE)]
    return np.array([one, other] if ends[0] >= ends[1] else [other, one])
