"""Clouds as they come: what can be fitted at all, and what is suspicious: several blades, one side, a unit."""

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import FitError
from bladewright.fitting.clouds.repetition import pitch_found
from bladewright.fitting.clouds.sheet import is_one_sided
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.nurbs.basis import Reals

CHECKED_POINTS = 20_000
"""points that are looked at, at random; it bounds the time."""
FEWEST_POINTS = {2: 24, 3: 100}
"""points that a fit of a section and of a blade needs, by dimension; fewer leave most parameters undetermined."""
FLATTEST = 1e-5
"""thickness, of its extent, below which a cloud lies on a line or a plane."""
LARGEST, SMALLEST = 20.0, 5e-3
"""extents of a blade [m] beyond which the cloud's unit is suspected: larger than `LARGEST`, smaller than `SMALLEST`; a
blade of 4 inches read as millimetres is below 5 mm."""
SHEET_SAMPLE = 3000
"""points by which a cloud of one side only is recognised; it bounds the time."""


def checked_cloud(cloud: ArrayLike) -> tuple[Reals, tuple[str, ...]]:
    """The points (n, 2) or (n, 3) [m] as given, and notes on what is suspicious about them.

    Raises FitError for anything but finite numbers in two or three columns, fewer than 24 different points (100 in
    space), points on one line or one plane, and one side of a blade only.
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


def refuse_several_blades(points: Reals) -> None:
    """Raise FitError where points (n, 2) or (n, 3) [m] in the machine's axes are of two blades or more."""
    found = pitch_found(np.unique(points[random_subset(len(points), CHECKED_POINTS)], axis=0))
    if found is not None:
        columns = ", or, where it is one, say which column is which (--columns): x must be the machine axis"
        raise FitError(
            f"the cloud holds two blades or more: {found} along the pitch lies the same shape again; give the points "
            f"of one blade{columns if points.shape[1] == 3 else ''}"
        )


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
