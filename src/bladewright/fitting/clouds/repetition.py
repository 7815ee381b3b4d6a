"""Several blades in one cloud: the same shape lies again a pitch away."""

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals

SMALLEST_PITCH = 0.12
"""smallest pitch that is looked for, of the cloud's extent: nearer shapes are the two sides of one blade."""
COMPARED_POINTS = 3000, 6000
"""points among which neighbours are compared: few join the rows of one blade, more part blades that stand close."""
TURNED_POINTS = 300
"""points that are turned by each trial pitch; it bounds the time."""
BLADE_COUNTS = range(4, 151)
"""numbers of blades around the axis that are tried"""
REPEATED_SHARE = 0.25
"""share of the points that must lie again a pitch to either side for the cloud to hold three blades or more."""
MULTIPLE_PITCH_GAIN = 0.8
"""ratio by which a longer pitch must bring the points nearer: it may be a multiple of the true one."""
PITCH_OVER_SPACING = 4.0
"""smallest pitch, in distances at which a point is found again: below it neighbours on the same blade are found."""


def repetition(points: Reals) -> str | None:
    """How far along the pitch, in words, part of the cloud is found again in another part; None where it is not."""
    points = points[np.random.default_rng(0).permutation(len(points))]
    for count in COMPARED_POINTS[: 2 if len(points) > COMPARED_POINTS[0] else 1]:
        some = points[:count]
        parts = [some[rows] for rows in _parts(some)]
        for i, part in enumerate(parts):
            for other in parts[i + 1 :]:
                found = _turned_onto(part, other)
                if found is not None:
                    return found
    points = points[: COMPARED_POINTS[-1]]
    return _around(points) if points.shape[1] == 3 else None


def _around(points: Reals) -> str | None:
    """The pitch of three blades or more around the axis, in words: those in the middle lie again on either side."""
    from scipy.spatial import cKDTree

    tree, radius = cKDTree(points), np.sqrt(points[:, 1] ** 2 + points[:, 2] ** 2)
    extent = float(np.hypot(np.ptp(points[:, 0]), np.ptp(radius)))
    near = 1.5 * float(np.median(tree.query(points[:TURNED_POINTS], k=2)[0][:, 1])) + 0.005 * extent
    x, y, z = points[:TURNED_POINTS].T
    nearest, pitch = np.inf, 0.0
    for count in reversed(BLADE_COUNTS):
        turn = 2.0 * np.pi / count
        if turn * float(np.median(radius)) < max(SMALLEST_PITCH * extent, PITCH_OVER_SPACING * near):
            continue
        c, s = np.cos(turn), np.sin(turn)
        sides = [np.stack([x, c * y + sign * s * z, c * z - sign * s * y], axis=-1) for sign in (1.0, -1.0)]
        away = np.max([tree.query(moved_points)[0] for moved_points in sides], axis=0)
        if np.mean(away < near) > REPEATED_SHARE and np.mean(away[away < near]) < MULTIPLE_PITCH_GAIN * nearest:
            nearest, pitch = float(np.mean(away[away < near])), turn
    return f"{np.degrees(pitch):.4g} deg" if pitch else None


def _parts(points: Reals) -> list[NDArray[np.intp]]:
    """Indices of the large parts of the cloud that stand apart from each other."""
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    tree = cKDTree(points)
    near = np.asarray(tree.query(points, k=2)[0])[:, 1]
    extent = float(np.max(np.ptp(points, axis=0)))
    gap = max((4.5 if points.shape[1] == 2 else 2.5) * float(np.percentile(near, 95.0)), 0.01 * extent)
    _, labels = connected_components(tree.sparse_distance_matrix(tree, gap), directed=False)
    counts = np.bincount(labels)
    return [np.flatnonzero(labels == label) for label in np.argsort(-counts)[:6] if counts[label] > 0.08 * len(points)]


def _turned_onto(part: Reals, other: Reals) -> str | None:
    """How far a part must be moved along y, or turned about x, to lie on the other; None where neither works."""
    from scipy.spatial import cKDTree

    if not 0.6 < len(part) / len(other) < 1.7:
        return None
    extent = float(np.sqrt(np.sum(np.ptp(part, axis=0) ** 2)))
    tree = cKDTree(other)
    step = np.zeros(part.shape[1])
    step[1] = np.mean(other[:, 1]) - np.mean(part[:, 1])
    moved = [(part + step, abs(float(step[1])), f"{abs(float(step[1])):.4g} m")]
    if part.shape[1] == 3:
        angles = [np.arctan2(np.mean(p[:, 1]), np.mean(p[:, 2])) for p in (part, other)]
        turn = float((angles[1] - angles[0] + np.pi) % (2.0 * np.pi) - np.pi)
        c, s = np.cos(turn), np.sin(turn)
        y, z = part[:, 1], part[:, 2]
        radius = float(np.mean(np.sqrt(y**2 + z**2)))
        turned = np.stack([part[:, 0], c * y + s * z, -s * y + c * z], axis=-1)
        moved.append((turned, abs(turn) * radius, f"{abs(np.degrees(turn)):.4g} deg"))
    for moved_points, distance, said in moved:
        if distance < SMALLEST_PITCH * extent:
            continue
        spacing = float(np.median(tree.query(other, k=2)[0][:, 1]))
        onto = float(np.mean(tree.query(moved_points)[0]))
        back = float(np.mean(cKDTree(moved_points).query(other)[0]))
        if max(onto, back) < 0.005 * extent + 1.5 * spacing:
            return said
    return None
