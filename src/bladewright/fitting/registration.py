"""The motion that brings a cloud into the machine's axes: onto a design's blade, about a named axis, or of a prism.

Onto a blade or section it is found by iterative closest points. The starts are the turns of a cube, or a square, that
lay the cloud's principal axes on the blade's. Each is followed with the nearest of many samples of the blade, point to
point (Besl and McKay 1992); the best, and others about as near, are followed with true footpoints, point to plane (Chen
and Medioni 1992), by steps of Gauss and Newton. All have Tukey's weights (Beaton and Tukey 1974), whose width at last
shrinks to what the noise needs (graduated non-convexity, Blake and Zisserman 1987): the few points at the ends, which
alone hold a prismatic blade along its span, take part before they could be taken for outliers.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from bladewright.blade.design.row_design import Arrangement
from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.checks import reals
from bladewright.fitting.clouds.thinning import MOST_POINTS, even_subset, random_subset, without_isolated_points
from bladewright.fitting.initial_guess.slices import furthest_apart
from bladewright.fitting.matching.footpoints import Footpoints, Side, concatenated, footpoints_at, nearest_footpoints
from bladewright.fitting.models.model import sides_of
from bladewright.numerics.elementary import length
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation, tukey_weights
from bladewright.nurbs.basis import Reals

GRID = {2: (2000, 1), 3: (241, 61)}
"""places along and across a side from which samples are chosen, by dimension"""
SAMPLES = 8000
"""evenly spread samples, as near to each other as true footpoints need to start (design/matching_constants.md)"""
SEARCH_POINTS, DECIDING_POINTS = 300, 3000
"""points that choose among starts, and that follow the nearest; they bound the time (design/matching_constants.md)"""
ROUGH_STEPS = 30
"""steps with closest samples (design/matching_constants.md)"""
FIRST_WIDTH, SHRINKING = 0.05, 4.0
"""first width of weights, of the blade's extent; largest ratio of two in turn (design/matching_constants.md)"""
LEAST_WIDTH, LAST_STEP = 1e-8, 1e-4
"""least width of the weights, to which footpoints are exact, of the blade's extent; and last step, of the width that
the noise needs (design/matching_constants.md)"""
MOST_STEPS = 60
"""steps with true footpoints at most: those of a blade of another shape do not settle (design/matching_constants.md)"""
WEAKEST_FREEDOM, LARGEST_DEVIATION = 1e-5, 0.01
"""singular value, of the largest, below which the points do not determine a degree of freedom, and standard deviation,
of the blade's extent, above which their noise does not let them (design/matching_constants.md)"""
AMBIGUOUS = 2.0
"""ratio of the mean distances of two motions to closest samples up to which neither is told from the other by a blade
whose shape is off (design/matching.md, design/matching_constants.md)"""
OTHER_BLADE, LEAST_SHARE = 5e-3, 0.7
"""distance, of the chord, within which points are of this blade, as far as a match may be off where no tolerance is
asked; and share of the points that must be (design/matching_constants.md)"""
OTHER_BLADE_NOTE = "the cloud does not lie on the design's blade"
"""what a note begins with where the cloud is of another blade"""
FREEDOMS = {2: ("turn", "shift_x", "shift_y"), 3: ("turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z")}
"""degrees of freedom by dimension: right-handed turns about the machine's axes, then shifts along them"""
TURN_AXES = {2: np.eye(3)[2:], 3: np.eye(3)}
"""(k, 3) axes of the turns by dimension"""
CUBE = {2: Rotation.create_group("C4"), 3: Rotation.create_group("O")}
"""turns of a square and a cube, by dimension"""

Touching = Callable[[Reals], tuple[Reals, NDArray[np.intp], Reals]]
"""where n points touch the blade: (n, d) from the nearest places to the points, the (m,) points of the m directions in
which they are held there, and these, unit vectors (m, d)"""


def registrations(points: Reals, design: Design) -> list[tuple[Motion, tuple[str, ...]]]:
    """The motions of points (n, d) [m] onto what a design builds, nearest first with those about as near, and notes."""
    built = design.build()
    sides = sides_of(built)
    samples = _samples(sides, points.shape[1])
    extent = float(np.max(np.ptp(samples.points, axis=0)))
    few = without_isolated_points(points[random_subset(len(points), MOST_POINTS)])
    few = few[even_subset(few, SEARCH_POINTS)]

    def touching(moved: Reals) -> tuple[Reals, NDArray[np.intp], Reals]:
        found = nearest_footpoints(moved, sides)
        past = np.flatnonzero(np.any(found.beyond != 0.0, axis=1))
        rows = np.concatenate([np.arange(len(moved)), past])
        return found.miss, rows, np.concatenate([found.normals, found.beyond[past]])

    some = points[random_subset(len(points), DECIDING_POINTS)]
    starts = _starts(few, samples.points)
    tried = sorted((_rough(few, samples, start, extent) for start in starts), key=lambda each: each[0])
    apart = list[Motion]()
    for off, motion in tried:
        same = (np.max(length(motion(few) - other(few))) < FIRST_WIDTH * extent for other in apart)
        if off <= AMBIGUOUS * tried[0][0] and not any(same):
            apart.append(motion)
    found = [_followed(some, motion, touching, extent) for motion in apart]
    chord = float(np.real(built.chord))
    return [(motion, _notes(motion(some), touching, extent, chord)) for motion in found]


def _samples(sides: Sequence[Side], dimension: int) -> Footpoints:
    """Places spread evenly over the sides."""
    along, across = GRID[dimension]
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, along))) / 2.0
    u, v = (each.ravel() for each in np.meshgrid(u, np.linspace(0.0, 1.0, across), indexing="ij"))
    every = [footpoints_at(None, sides, k, u, v) for k in (0, 1)]
    return concatenated([each.part(even_subset(each.points, SAMPLES // 2)) for each in every])


def _starts(cloud: Reals, samples: Reals) -> list[Motion]:
    """All rotations of the cloud's principal axes onto those of the samples, centre on centre."""
    pivot, centre = np.mean(cloud, axis=0), np.mean(samples, axis=0)
    axes, goals = (np.linalg.svd(each, full_matrices=False)[2] for each in (cloud - pivot, samples - centre))
    axes[-1] *= np.sign(np.linalg.det(axes) * np.linalg.det(goals))
    dimension = cloud.shape[1]
    turns = CUBE[dimension].as_matrix()[:, :dimension, :dimension]
    rotations = [goals.T @ turn @ axes for turn in turns]
    return [Motion(rotation=each, translation=centre - each @ pivot) for each in rotations]


def _rough(points: Reals, samples: Footpoints, motion: Motion, extent: float) -> tuple[float, Motion]:
    """The motion that closest samples lead to, and the mean distance of the points from the planes through these."""
    tree = cKDTree(samples.points)
    for _ in range(ROUGH_STEPS):
        distances, index = tree.query(motion(points))
        weights = tukey_weights(distances, TUKEY_WIDTH * median_deviation(distances))
        motion = _laid(points, samples.points[index], weights)
    distances, index = tree.query(motion(points))
    heights = np.sum(samples.normals[index] * (motion(points) - samples.points[index]), axis=1)
    # between samples only the distance from the tangent plane says how far a point is off
    aside = np.where(distances > np.max(tree.query(samples.points, k=2)[0]), distances, np.abs(heights))
    return float(np.mean(np.minimum(aside, FIRST_WIDTH * extent))), motion


def _laid(points: Reals, goals: Reals, weights: Reals) -> Motion:
    """The motion of points (n, d) nearest to goals (n, d) by weighted least squares (Kabsch 1976)."""
    pivot, centre = (np.average(each, axis=0, weights=weights) for each in (points, goals))
    left, _, right = np.linalg.svd((weights[:, None] * (goals - centre)).T @ (points - pivot))
    left[:, -1] *= np.sign(np.linalg.det(left) * np.linalg.det(right))
    return Motion(rotation=left @ right, translation=centre - left @ right @ pivot)


def _followed(points: Reals, motion: Motion, touching: Touching, extent: float) -> Motion:
    """The motion that true footpoints of points (n, d) lead to, with ever narrower weights."""
    width = FIRST_WIDTH * extent
    for _ in range(MOST_STEPS):
        moved = motion(points)
        rows, right, distances = _equations(moved, touching, width)
        change = np.asarray(np.linalg.lstsq(rows, right, rcond=WEAKEST_FREEDOM)[0], dtype=np.float64)
        motion = motion_by(change, moved).after(motion)
        needed = max(TUKEY_WIDTH * median_deviation(distances), LEAST_WIDTH * extent)
        if width <= needed and np.max(np.abs(motion(points) - moved)) < LAST_STEP * needed:
            break
        width = max(needed, width / SHRINKING)
    return motion


def _equations(moved: Reals, touching: Touching, width: float) -> tuple[Reals, Reals, Reals]:
    """Weighted rows (m, k) of what motions do to distances, right sides (m,), and the distances (n,)."""
    miss, rows, directions = touching(moved)
    distances = length(miss)
    # no narrower than the points' own distances call for
    root = np.sqrt(tukey_weights(distances, max(width, TUKEY_WIDTH * median_deviation(distances))))[rows]
    slopes = np.einsum("md,mdk->mk", directions, motion_rates(moved)[rows])
    return slopes * root[:, None], -np.sum(directions * miss[rows], axis=1) * root, distances


def _notes(moved: Reals, touching: Touching, extent: float, chord: float) -> tuple[str, ...]:
    """What there is to say where the points do not determine the motion, or are of another blade."""
    rows, right, distances = _equations(moved, touching, LEAST_WIDTH * extent)
    share, typical = float(np.mean(distances <= OTHER_BLADE * chord)), median_deviation(distances)
    deviation = np.sqrt(np.sum(right**2) / max(1, int(np.count_nonzero(right)) - rows.shape[1]))
    _, values, across = np.linalg.svd(rows, full_matrices=False)
    weak = across[values <= max(WEAKEST_FREEDOM * values[0], deviation / (LARGEST_DEVIATION * extent))]
    undetermined = [name for k, name in enumerate(FREEDOMS[moved.shape[1]]) if np.any(np.abs(weak[:, k]) > 0.1)]
    notes = []
    if undetermined:
        names = ", ".join(undetermined)
        notes.append(f"the points do not determine {names} of the motion: they stay where the search ended")
    if share < LEAST_SHARE:
        notes.append(
            f"{OTHER_BLADE_NOTE}: {1.0 - share:.0%} of its points are more than {OTHER_BLADE:.1%} of the chord off, "
            f"and they typically miss it by {typical:.3g} m, {typical / chord:.2%} of the chord; it is another blade, "
            "a mirrored one, or in another unit"
        )
    return tuple(notes)


def motion_rates(points: Reals) -> Reals:
    """Rates (n, d, k) of points (n, d) by turns about their mean, in radians times their extent, and by shifts."""
    count, dimension = points.shape
    arm = np.pad(points - np.mean(points, axis=0), ((0, 0), (0, 3 - dimension))) / np.max(np.ptp(points, axis=0))
    turns = np.cross(TURN_AXES[dimension], arm[:, None])[..., :dimension]
    shifts = np.broadcast_to(np.eye(dimension), (count, dimension, dimension))
    return np.concatenate([np.moveaxis(turns, 1, 2), shifts], axis=2)


def motion_by(change: Reals, points: Reals) -> Motion:
    """The motion by a change (k,) of what `motion_rates` of the points are rates of."""
    pivot, dimension = np.mean(points, axis=0), points.shape[1]
    turn = change[:-dimension] @ TURN_AXES[dimension] / np.max(np.ptp(points, axis=0))
    rotation = np.asarray(Rotation.from_rotvec(turn).as_matrix())[:dimension, :dimension]
    return Motion(rotation=rotation, translation=pivot - rotation @ pivot + change[-dimension:])


AXES_POINTS = 2000
"""points that are looked at; it bounds the time (design/matching_constants.md)."""
PRISM_THICKNESS = 1e-3
"""thickness of a prism's projection, of the extent: a few times a scan's noise (design/matching_constants.md)"""
NORMAL_NEIGHBOURS, CURVE_NEIGHBOURS = 12, 60
"""nearest points of a plane, and of a parabola of the section, where many are in line (design/matching_constants.md)"""
STEPS, SETTLED = 12, 1e-8
"""steps of the least squares at most, and the last turn [rad] (design/matching_constants.md)"""
EDGE = 0.1
"""part of the chord whose thickness is that of an edge (design/matching_constants.md)"""
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
        direction = reals("the numbers of axis", axis, f"give {dimension} that are not all zero")
    largest = np.max(np.abs(direction), initial=0.0)
    if direction.shape != (dimension,) or not 0.0 < largest < np.inf:
        raise FitError(
            f"axis is {axis!r}: the direction of the machine's axis in the points' coordinates is needed, one of "
            f"{', '.join(names)}, also with a minus before it, or {dimension} numbers that are not all zero"
        )
    direction = direction / largest
    direction /= np.sqrt(np.sum(direction**2))
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
    one, other = furthest_apart(flat)
    along = (other - one) / np.sum((other - one) ** 2)
    x, y = (flat - one) @ along, (flat - one) @ np.array([-along[1], along[0]])
    first, last = (np.ptp(y[near]) for near in (x < EDGE, x > 1.0 - EDGE))
    return np.array([one, other] if first >= last else [other, one])
