"""The ends of a blade's cloud in short pieces: the outermost points of each, and the plane that they lie on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.alignment.descent import tukey
from bladewright.fitting.alignment.sheet import Sheet
from bladewright.nurbs.basis import Reals

WINDOWS = 20
"""pieces of an end"""
DEEP = 2.5
"""how far inside points are looked at, of the points' spacing"""
FIRST, LAST, ROUNDS = 1.5, 0.03, 24
"""widths of the weights, of the points' spacing, and how often they narrow"""
ON = 0.1
"""of the points' spacing: nearer points are on the plane"""
TAME = 1e-3
"""holds the tilt across a loop that is thin for its points' spacing"""


@dataclass(frozen=True, kw_only=True)
class Piece:
    """A short piece of a side of the sheet."""

    side: int
    point: Reals
    normal: Reals
    """(3,) of the plane"""
    rows: NDArray[np.intp]
    """indices of the sheet's points on the plane"""
    along: Reals
    """their places along the side, 0 to 1"""
    crowding: float
    """how much denser the points stand on the plane than inside of it"""


def pieces_of(sheet: Sheet, side: int) -> list[Piece]:
    """Pieces of a side of the sheet on which planes can be laid.

    The weights are one-sided, 1 outside and Tukey's inside, and narrow: the plane moves out to the last points.
    """
    along, inside = sheet.along(side)
    found = []
    for place in (np.arange(WINDOWS) + 0.5) / WINDOWS:
        rows = np.flatnonzero((np.abs(along - place) < 0.7 / WINDOWS) & (np.abs(inside) < DEEP * sheet.spacing))
        if len(rows) >= 12:
            piece = _piece(sheet, side, rows, along[rows], inside[rows])
            if piece is not None:
                found.append(piece)
    return found


def _piece(sheet: Sheet, side: int, rows: NDArray[np.intp], along: Reals, inside: Reals) -> Piece | None:
    points, spacing = sheet.points[rows], sheet.spacing
    local = points - points.mean(axis=0)
    inward = np.linalg.lstsq(local, inside - inside.mean(), rcond=1e-3)[0]
    size = np.sqrt(np.sum(inward**2))
    if not size > 0.0:
        return None
    frame = np.linalg.svd((inward / size)[None])[2]
    frame[0] = inward / size
    height, across = local @ frame[0], local @ frame[1:].T
    plane = np.array([float(np.quantile(height, 0.05)), 0.0, 0.0])
    design = np.concatenate([np.ones((len(height), 1)), across], axis=1)
    tame = np.diag([0.0, 1.0, 1.0]) * TAME * spacing**2 * len(height)
    for width in spacing * np.geomspace(FIRST, LAST, ROUNDS):
        off = height - design @ plane
        weight = np.where(off < 0.0, 1.0, tukey(np.abs(off), width))
        plane = np.linalg.solve((design.T * weight) @ design + tame, (design.T * weight) @ height)
    off = height - design @ plane
    on = np.abs(off) < ON * spacing
    if np.count_nonzero(on) < 4:
        return None
    normal = frame[0] - plane[1] * frame[1] - plane[2] * frame[2]
    inner = np.count_nonzero((off >= ON * spacing) & (off < 1.1 * spacing))
    return Piece(
        side=side,
        point=points[on].mean(axis=0),
        normal=normal / np.sqrt(np.sum(normal**2)),
        rows=rows[on],
        along=along[on],
        crowding=float(np.count_nonzero(on) / max(0.2 * inner, 1.0)),
    )
