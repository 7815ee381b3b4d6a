"""The machine's axes of a cloud without a design: from its prism in a cascade, from its two ends in an annulus."""

from dataclasses import dataclass

import numpy as np

from bladewright.errors import FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.clouds.isolated import has_neighbours
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.design_header import Arrangement
from bladewright.fitting.registration.axis_of_revolution import EndPoints, RevolutionAxis, axis_of
from bladewright.fitting.registration.end_planes import EndPlane, end_planes, first_axes
from bladewright.fitting.registration.isomap import UnrolledSheet, unrolled_sheet
from bladewright.fitting.registration.prism import Prism, flat_ends, prism_of
from bladewright.fitting.registration.rigid_motion import composed
from bladewright.nurbs.basis import Reals

AXES_POINTS = 50_000
"""points that are looked at; it bounds the time, and more say little new about where a blade lies."""
PRISM_THICKNESS = 1e-3
"""thickness of a projection, of the cloud's extent, below which the cloud is a prism."""
COMPARED_DEGREES = (1, 2, 4)
"""degrees of the meridional lines while axes are compared"""
LAST_STEPS = 200
"""steps of the least squares that decides"""
COMPARED_END_POINTS, DECIDING_END_POINTS = 150, 400
"""points of an end by which axes are compared, and those that decide (`DECIDING_END_POINTS`)"""
DIRECTION_LIMIT = 0.2 * np.pi / 180.0
"""largest standard deviation of the axis' direction [rad]; a less certain axis is refused."""
OFFSET_LIMIT = 0.01
"""largest standard deviation of the axis' distance, of the blade's extent; a less certain axis is refused."""
REVOLUTION_LIMIT = 2e-6
"""largest distance of the ends from surfaces of revolution, of the blade's extent. The ends of a fan lie 6e-7 off its
true axis and 5e-6 off axes eight degrees away, so that no noise may pass (design/fit_clouds.md)."""
AMBIGUITY_RATIO = 5.0
"""ratio by which the ends must lie further off any other axis; otherwise the axis is ambiguous."""
OTHER_AXIS_COSINE = np.cos(2.0 * np.pi / 180.0)
"""cosine of the angle from which axes count as different."""


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

    A prism is a blade of a linear cascade: its direction is the span z, and the chord line is laid along x. Otherwise
    both ends must lie on surfaces of revolution about the machine axis, and be shown by rows of points without noise;
    then x = 0 is at the foremost point and theta = 0 in the middle. Raises FitError where the points do not determine
    the axes.
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
        prism = prism_of(cloud)
        extent = float(np.max(np.ptp(cloud, axis=0)))
        if prism.rms < PRISM_THICKNESS * extent and (arrangement == "linear" or flat_ends(cloud, prism.direction)):
            return _cascade(cloud, prism)
        if arrangement == "linear":
            raise FitError(
                f"the cloud is no prism: along the best direction its section is blurred by {prism.rms:.3g} m, more "
                f"than {PRISM_THICKNESS * extent:.3g} m; "
                "of a cascade's tapered or twisted blade the axes are not found. Give "
                "--start, or move the points into the machine's axes (x downstream, z along the span)"
            )
    return _annular(cloud)


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
    from scipy.spatial import ConvexHull

    hull = flat[ConvexHull(flat).vertices]
    square = np.sum((hull[:, None] - hull[None]) ** 2, axis=-1)
    i, j = np.unravel_index(np.argmax(square), square.shape)
    one, other = hull[i], hull[j]
    along = (other - one) / np.sqrt(square[i, j])
    x = (flat - one) @ along / np.sqrt(square[i, j])
    y = (flat - one) @ np.array([-along[1], along[0]])
    ends = [float(np.ptp(y[near])) if near.any() else 0.0 for near in (x < 0.1, x > 0.9)]
    return np.array([one, other] if ends[0] >= ends[1] else [other, one])


def _annular(cloud: Reals) -> MachineAxes:
    """The axes of a blade between surfaces of revolution."""
    sheet = unrolled_sheet(cloud)
    pieces = [end_planes(sheet, side) for side in range(4)]
    tried: list[tuple[RevolutionAxis, int]] = []
    for pair in (0, 1):
        ends = _ends(sheet, pieces[pair], pieces[pair + 2], COMPARED_END_POINTS)
        if ends is None:
            continue
        for _, start in first_axes([*pieces[pair], *pieces[pair + 2]]):
            axis = axis_of(ends, start, COMPARED_DEGREES)
            if axis is not None:
                tried.append((axis, pair))
    tried.sort(key=lambda each: each[0].rms)
    extent = float(np.max(np.ptp(cloud, axis=0)))
    if not tried:
        raise _undetermined("no end of the blade is shown by a row of points")
    best, pair = tried[0]
    ends = _ends(sheet, pieces[pair], pieces[pair + 2], DECIDING_END_POINTS)
    axis = axis_of(ends, best.motion, steps=LAST_STEPS) if ends is not None else None
    if axis is None or axis.rms > best.rms:
        axis = best
    _check(axis, [other for other, _ in tried[1:]], extent)
    motion, notes = _placed(cloud, sheet, axis, pair)
    return MachineAxes(
        motion=motion,
        arrangement="annular",
        notes=notes,
    )


def _ends(
    sheet: UnrolledSheet, low: list[EndPlane], high: list[EndPlane], count: int
) -> tuple[EndPoints, EndPoints] | None:
    """Points of the two ends, at most `count` of each; None where an end has no planes."""
    found = []
    for pieces in (low, high):
        if not pieces:
            return None
        rows, first = np.unique(np.concatenate([piece.rows for piece in pieces]), return_index=True)
        along = np.concatenate([piece.along for piece in pieces])[first]
        some = random_subset(len(rows), count)
        found.append(EndPoints(points=sheet.points[rows[some]], along=along[some]))
    return found[0], found[1]


def _check(axis: RevolutionAxis, others: list[RevolutionAxis], extent: float) -> None:
    """Refuses an axis that the points do not determine."""
    if axis.rms > REVOLUTION_LIMIT * extent:
        raise _undetermined(
            f"of all axes tried, the ends still lie {axis.rms:.3g} m off surfaces of revolution about the best, more "
            f"than {REVOLUTION_LIMIT * extent:.3g} m"
        )
    if axis.direction > DIRECTION_LIMIT or axis.offset > OFFSET_LIMIT * extent:
        raise _undetermined(
            f"the axis' direction is uncertain by {np.degrees(axis.direction):.2g} deg and its distance by "
            f"{axis.offset:.2g} m, more than {np.degrees(DIRECTION_LIMIT):g} deg and {OFFSET_LIMIT * extent:.2g} m"
        )
    for other in others:
        other_direction = abs(other.motion.rotation[0] @ axis.motion.rotation[0]) < OTHER_AXIS_COSINE
        if other_direction and other.rms < AMBIGUITY_RATIO * max(axis.rms, 1e-9 * extent):
            raise _undetermined(
                f"another axis fits nearly as well: the ends lie {other.rms:.3g} m off it, and {axis.rms:.3g} m "
                "off the best"
            )


def _undetermined(why: str) -> FitError:
    return FitError(
        f"the machine axis cannot be told from the points alone: {why}. Give --start with a design of about this "
        "blade, or move the points into the machine's axes (x downstream along the machine axis) and leave out --align"
    )


def _placed(cloud: Reals, sheet: UnrolledSheet, axis: RevolutionAxis, pair: int) -> tuple[Motion, tuple[str, ...]]:
    """The motion with x from leading to trailing edge and from the foremost point, theta from the middle."""
    motion = axis.motion
    edges = []
    for side in (1 - pair, 3 - pair):
        inside = sheet.along(side)[1]
        edges.append(sheet.points[np.abs(inside) < 2.0 * sheet.spacing])
    places = [float(np.mean(motion(edge)[:, 0])) for edge in edges]
    thick = [_thickness(edge) for edge in edges]
    leading = 0 if thick[0] >= thick[1] else 1
    placed = (
        "the machine axis is found from the blade's ends; x = 0 is at the foremost point and theta = 0 in the middle"
    )
    notes = [placed]
    sign = 1.0 if places[1 - leading] >= places[leading] else -1.0
    if max(thick) < 1.3 * min(thick):
        notes.append("the edges are about equally thick: which one is leading, and with it the sense of x, is a guess")
    else:
        notes.append("the thicker edge is taken as the leading one, a guess, and x points from it to the other")
    turn = Motion(rotation=np.diag([sign, sign, 1.0]), translation=np.zeros(3))
    moved = composed(turn, motion)(cloud)
    middle = np.arctan2(*np.mean(moved[:, 1:] / np.sqrt(np.sum(moved[:, 1:] ** 2, axis=1, keepdims=True)), axis=0))
    c, s = np.cos(middle), np.sin(middle)
    upright = Motion(
        rotation=np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]),
        translation=np.array([-float(np.min(moved[:, 0])), 0.0, 0.0]),
    )
    return composed(upright, composed(turn, motion)), tuple(notes)


def _thickness(edge: Reals) -> float:
    """Median extent of points across the plane that they nearly lie in, piece by piece [m]."""
    from scipy.spatial import cKDTree

    near = edge[cKDTree(edge).query(edge, k=min(24, len(edge)))[1]]
    local = near - near.mean(axis=1, keepdims=True)
    return float(np.median(np.sqrt(np.maximum(np.linalg.eigvalsh(np.einsum("nki,nkj->nij", local, local))[:, 0], 0.0))))
