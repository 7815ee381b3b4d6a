"""Clouds as they come: what can be fitted at all, and what is suspicious: several blades, one side, a unit."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bladewright.errors import FitError
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.nurbs.basis import Reals

ROUNDED_DIGITS = 1e-8
"""digit, of the cloud's extent, from which on others than zero show that coordinates were not rounded for writing."""
ROUNDED_SAMPLE = 200
"""points whose digits are looked at"""


def is_rounded(points: Reals) -> bool:
    """Whether all coordinates of points (n, d) are multiples of a power of ten that is coarse for their extent."""
    extent = float(np.max(np.ptp(points, axis=0)))
    finest = int(np.floor(-np.log10(ROUNDED_DIGITS * extent)))
    some = points[:: max(1, len(points) // ROUNDED_SAMPLE)]
    # a unit that scales by a power of ten leaves the last digits as they are, but for rounding
    return bool(np.all(np.abs(np.round(some, finest) - some) < 1e-4 * ROUNDED_DIGITS * extent))


CHECKED_POINTS = 20_000
"""points that are looked at, at random; it bounds the time."""
FEWEST_POINTS = {2: 24, 3: 100}
"""points that a fit of a section and of a blade needs, by dimension; fewer leave most parameters undetermined."""
FLATTEST = 1e-5
"""thickness, of its extent, below which a cloud lies on a line or a plane."""
LARGEST, SMALLEST = 20.0, 5e-3
"""extents of a blade [m] beyond which the cloud's unit is suspected: larger than `LARGEST`, smaller than `SMALLEST`; a
blade of 4 inches read as millimetres is below 5 mm (design/fit_clouds.md)."""
SHEET_SAMPLE = 3000
"""points by which a cloud of one side only is recognised; it bounds the time."""
THINNEST_BLADE = 1.3e-3
"""roughness, of its width, below which a cloud is a smooth sheet: one side and no blade."""


def checked_cloud(cloud: ArrayLike) -> tuple[Reals, tuple[str, ...]]:
    """The points (n, 2) or (n, 3) [m] as given, and notes on what is suspicious about them.

    Raises FitError for anything but finite numbers in two or three columns, fewer than 24 different points (100 in
    space), points on one line or one plane, two blades, and one side of a blade only.
    """
    points = _numbers(cloud)
    different = np.unique(points[random_subset(len(points), CHECKED_POINTS)], axis=0)
    dimension = points.shape[1]
    if len(different) < FEWEST_POINTS[dimension]:
        raise FitError(
            f"the cloud has {len(different)} different points: at least {FEWEST_POINTS[dimension]} are needed; "
            "give more "
            "points of the blade's surface"
        )
    middle = np.mean(different, axis=0)
    spread = np.linalg.svd(different - middle, compute_uv=False)
    if spread[1] < FLATTEST * spread[0]:
        raise FitError(
            f"all {len(points)} points lie on one line: a blade has two sides; give points of its whole surface"
        )
    if dimension == 3 and spread[2] < FLATTEST * spread[0]:
        raise FitError(
            f"all {len(points)} points lie on one plane: give two columns, x and y, for a section, or points of "
            "sections at several places along the span"
        )
    some = different[np.random.default_rng(0).permutation(len(different))[:SHEET_SAMPLE]]
    found = repetition(different)
    if found is not None:
        # the sections of one blade lie again along y where that is its span
        columns = ", or, where it is one, say which column is which (--columns): x must be the machine axis"
        raise FitError(
            f"the cloud holds two blades or more: {found} along the pitch lies the same shape again; give the points "
            f"of one blade{columns if dimension == 3 else ''}"
        )
    if is_one_sided(some):
        raise FitError(
            "the cloud holds one side of a blade alone, a sheet without thickness: give the points of both sides"
        )
    extent = float(np.max(np.ptp(points, axis=0)))
    notes: tuple[str, ...] = ()
    if not SMALLEST <= extent <= LARGEST:
        note = (
            f"the cloud extends over {extent:.4g} m, which is unusual for a blade: the unit of its coordinates may be "
            "another one (--unit on the command line)"
        )
        notes = (note,)
    return points, notes


def _numbers(cloud: ArrayLike) -> Reals:
    try:
        points = np.asarray(cloud, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise FitError(f"the cloud is not an array of numbers ({error}): give (n, 2) or (n, 3) in metres") from error
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise FitError(
            f"the cloud has the shape {points.shape}: give (n, 2) with x and y, or (n, 3) with x, y and z, in metres"
        )
    bad = ~np.all(np.isfinite(points), axis=1)
    if np.any(bad):
        raise FitError(
            f"{np.count_nonzero(bad)} of {len(points)} points are not finite numbers, the first of them point "
            f"{int(np.argmax(bad))}: leave them out"
        )
    return points


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
    tree = cKDTree(points)
    near = np.asarray(tree.query(points, k=2)[0])[:, 1]
    extent = float(np.max(np.ptp(points, axis=0)))
    gap = max((4.5 if points.shape[1] == 2 else 2.5) * float(np.percentile(near, 95.0)), 0.01 * extent)
    _, labels = connected_components(tree.sparse_distance_matrix(tree, gap), directed=False)
    counts = np.bincount(labels)
    return [np.flatnonzero(labels == label) for label in np.argsort(-counts)[:6] if counts[label] > 0.08 * len(points)]


def _turned_onto(part: Reals, other: Reals) -> str | None:
    """How far a part must be moved along y, or turned about x, to lie on the other; None where neither works."""
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
