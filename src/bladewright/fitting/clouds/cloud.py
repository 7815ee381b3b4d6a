"""Clouds as they come, and what cannot be fitted of them: too few points, one side of a blade, several blades.

Several blades are a wheel that turns onto itself, or pieces that stand apart and are each other's copies. A single
blade is the further from itself the further it is turned, and its pieces are rows or sides without thickness.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from bladewright.domain.row import turn_matrix
from bladewright.errors import FitError
from bladewright.fitting.checks import checked_points
from bladewright.fitting.clouds.thinning import MOST_POINTS, even_subset, groups, random_subset
from bladewright.nurbs.basis import Reals

FEWEST_POINTS = {2: 24, 3: 100}
"""points that a fit of a section and of a blade needs, by dimension; fewer leave most parameters undetermined."""
FLATTEST = 1e-5
"""thickness, of its extent, below which a cloud lies on a line or a plane (design/matching_constants.md)"""
SHEET_SAMPLE = 3000
"""points by which a cloud of one side only is recognised; it bounds the time (design/matching_constants.md)"""
THINNEST_BLADE = 1.3e-3
"""roughness, of its width, below which a cloud is one side and no blade (design/matching_constants.md)"""
COMPARED_POINTS = 6000, 2000
"""points among which neighbours are joined: many part close blades, few join rows (design/matching_constants.md)"""
NEIGHBOURS = 8
"""neighbours with which a point may be joined; it bounds the time (design/matching_constants.md)"""
GAP = {2: 4.5, 3: 2.5}
"""distance that parts pieces, in the spacing of the points, by dimension (design/matching_constants.md)"""
PIECE_POINTS = {2: 24, 3: 50}
"""points of the smallest piece, by dimension"""
SAME_SHAPE = 0.005
"""distance within which copies lie on each other, of their extent (design/matching_constants.md)"""
BLADE_COUNTS = range(2, 152)
"""numbers of blades around the axis that are tried"""
TURNED_POINTS = 300
"""points that are turned by each trial pitch; it bounds the time (design/matching_constants.md)"""


def checked_cloud(cloud: ArrayLike) -> Reals:
    """The points (n, 2) or (n, 3) [m] as given.

    Raises FitError for anything but finite numbers in two or three columns, fewer than 24 different points (100 in
    space), points on one line or one plane, and one side of a blade only.
    """
    needed = "give (n, 2) with x and y, or (n, 3) with x, y and z, in metres"
    points = checked_points("the points of the cloud", cloud, (2, 3), needed)
    different, dimension = different_points(points), points.shape[1]
    spread = np.linalg.svd(different - np.mean(different, axis=0), compute_uv=False)
    if spread[1] < FLATTEST * spread[0]:
        raise FitError(
            f"all {len(points)} points lie on one line: a blade has two sides; give points of its whole surface"
        )
    if dimension == 3 and spread[2] < FLATTEST * spread[0]:
        raise FitError(
            f"all {len(points)} points lie on one plane: give two columns, x and y, for a section, or points of "
            "sections at several places along the span"
        )
    if is_one_sided(different[random_subset(len(different), SHEET_SAMPLE)]):
        raise FitError(
            "the cloud holds one side of a blade alone, a sheet without thickness: give the points of both sides"
        )
    return points


def different_points(points: Reals, kind: str = "") -> Reals:
    """The different ones of points (n, 2) or (n, 3) of a `kind`, thinned; raises FitError where they are too few."""
    different = np.unique(points[random_subset(len(points), MOST_POINTS)], axis=0)
    fewest = FEWEST_POINTS[points.shape[1]]
    if len(different) < fewest:
        raise FitError(
            f"the cloud has {len(different)} different points{kind}: at least {fewest} are needed; give more points of "
            "the blade's surface"
        )
    return different


def refuse_several_blades(points: Reals) -> None:
    """Raise FitError where points (n, 2) or (n, 3) [m] in the machine's axes are of two blades or more."""
    found = pitch_found(different_points(points))
    if found is not None:
        columns = ", or, where it is one, say which column is which (--columns): x must be the machine axis"
        raise FitError(
            f"the cloud holds two blades or more: {found} along the pitch lies the same shape again; give the points "
            f"of one blade{columns if points.shape[1] == 3 else ''}"
        )


def is_one_sided(points: Reals) -> bool:
    """Whether the points are a single sheet: a smooth one passes through the neighbours of most of them."""
    centred = points - np.mean(points, axis=0)
    own = centred @ np.linalg.svd(centred, full_matrices=False)[2].T
    along, height = own[:, :-1], own[:, -1]
    some = np.linspace(0, len(points) - 1, 200).astype(int)
    residuals = []
    for rows in cKDTree(along).query(along[some], k=14 if along.shape[1] == 1 else 24)[1]:
        t = along[rows] - np.mean(along[rows], axis=0)
        t = t / max(float(np.max(np.abs(t))), 1e-300)
        matrix = np.column_stack([np.ones(len(t)), t, t**2, t[:, :1] * t[:, 1:]])
        found = np.linalg.lstsq(matrix, height[rows], rcond=0.03)[0]
        residuals.append(float(np.sqrt(np.mean((height[rows] - matrix @ found) ** 2))))
    # where sections are dense at the edges most neighbourhoods are of an edge, which is thin
    return float(np.percentile(residuals, 90.0)) < THINNEST_BLADE * float(np.ptp(along[:, -1]))


def pitch_found(points: Reals) -> str | None:
    """By how much, in words, a blade in the cloud (n, 2) or (n, 3) [m] lies beside the next; None of a single blade."""
    if points.shape[1] == 3 and (wheel := _pitch_of_wheel(points)):
        return wheel
    for count in COMPARED_POINTS:
        some = points[even_subset(points, count)]
        pieces = [some[rows] for rows in _pieces(some)]
        if len(pieces) < 2 or is_one_sided(pieces[0]):
            continue
        found = list(filter(None, (_moved_onto(pieces[0], other) for other in pieces[1:])))
        if found:
            return min(found)[1]
    return None


def _pieces(points: Reals) -> list[NDArray[np.intp]]:
    """Indices of the points of each piece that stands apart, largest first."""
    near, index = cKDTree(points).query(points, k=NEIGHBOURS + 1)
    dimension = points.shape[1]
    labels = groups(near < GAP[dimension] * float(np.percentile(near[:, 1], 95.0)), index)
    counts = np.bincount(labels)
    return [np.flatnonzero(labels == i) for i in np.argsort(-counts) if counts[i] >= PIECE_POINTS[dimension]]


def _moved_onto(piece: Reals, other: Reals) -> tuple[float, str] | None:
    """How far [m] a piece must be moved along y, or turned about x, to lie on another one; None where neither works."""
    tree = cKDTree(other)
    near = SAME_SHAPE * float(np.sqrt(np.sum(np.ptp(piece, axis=0) ** 2)))
    near += 1.5 * float(np.median(tree.query(other, k=2)[0][:, 1]))
    step = float(np.mean(other[:, 1]) - np.mean(piece[:, 1]))
    moved = [(piece + step * np.eye(piece.shape[1])[1], abs(step), f"{abs(step):.4g} m")]
    if piece.shape[1] == 3:
        angles = [np.arctan2(np.mean(p[:, 1]), np.mean(p[:, 2])) for p in (piece, other)]
        turn = float((angles[1] - angles[0] + np.pi) % (2.0 * np.pi) - np.pi)
        radius = float(np.mean(np.sqrt(piece[:, 1] ** 2 + piece[:, 2] ** 2)))
        moved.append((piece @ turn_matrix(turn).T, abs(turn) * radius, f"{abs(np.degrees(turn)):.4g} deg"))
    missed = [max(np.mean(tree.query(copy)[0]), np.mean(cKDTree(copy).query(other)[0])) for copy, *_ in moved]
    best = int(np.argmin(missed))
    return moved[best][1:] if missed[best] < near else None


def _pitch_of_wheel(points: Reals) -> str | None:
    """The pitch of blades around the axis, in words: turned by it most points lie twice as near as by half of it."""
    tree, some = cKDTree(points), points[random_subset(len(points), TURNED_POINTS)]

    def away(turn: float) -> float:
        return float(np.median(np.max([tree.query(some @ turn_matrix(each).T)[0] for each in (turn, -turn)], axis=0)))

    whole = np.array([away(2.0 * np.pi / count) for count in BLADE_COUNTS])
    lowest = 1 + np.flatnonzero(whole[1:-1] < np.minimum(whole[:-2], whole[2:]))
    counts = [BLADE_COUNTS[i] for i in lowest if whole[i] < 0.5 * away(np.pi / BLADE_COUNTS[i])]
    return f"{360.0 / max(counts):.4g} deg" if counts else None
