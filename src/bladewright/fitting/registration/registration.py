"""The motion that brings a cloud from anywhere onto the blade or section of a design: iterative closest points.

The starts are all ways to lay the cloud's principal axes on the blade's: 24 in space, 4 in the plane. Each is followed
with the nearest of many samples of the blade, first point to point (Besl and McKay 1992), then point to plane (Chen and
Medioni 1992); the best are followed with true footpoints. Every step is one of Gauss and Newton with Tukey's weights
(Beaton and Tukey 1974), whose width shrinks to what the noise needs (graduated non-convexity, Blake and Zisserman
1987): the few points at the ends, which alone hold a prismatic blade along its span, take part before they could be
taken for outliers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.clouds.thinning import even_subset, random_subset, without_isolated_points
from bladewright.fitting.matching.footpoints import Side, footpoints_at, nearest_footpoints
from bladewright.fitting.models.blunt_edges import sides_of
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation, tukey_weights
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

GRID = {2: (2000, 1), 3: (241, 61)}
"""places along and across a side from which samples are chosen, by dimension"""
SAMPLES = 8000
"""evenly spread samples, about a hundredth of the blade from each other: as near as true footpoints need to start"""
LOOKED_AT, SEARCH_POINTS, DECIDING_POINTS = 20_000, 300, 3000
"""points of the cloud among which isolated ones are told, those that choose among the starts, and those that decide.
They bound the time: the motion has six unknowns, and of 3000 points its noise is a fiftieth of theirs."""
FOLLOWED_STARTS, TRIAL_STEPS = 2, 5
"""starts that are followed with true footpoints, and steps that choose among them"""
POINT_STEPS, PLANE_STEPS, MOST_STEPS = 6, 24, 60
"""steps of a start point to point, then point to plane, and of a descent with true footpoints at most"""
FIRST_WIDTH, SHRINKING = 0.05, 4.0
"""first width of the weights, of the blade's extent, and the factor by which it shrinks at most in a step"""
LEAST_WIDTH, LAST_STEP = 1e-8, 1e-12
"""least width of the weights, to which footpoints are exact, and last step, which is rounding, of the blade's extent"""
LONGEST_TURN = 0.3
"""longest turn in a step [rad], within which a turn is about linear"""
WEAKEST_FREEDOM, LARGEST_DEVIATION = 1e-5, 0.01
"""singular value, of the largest, below which the points do not determine a degree of freedom, and standard deviation,
of the blade's extent, above which their noise does not let them"""
OTHER_BLADE, LEAST_SHARE = 5e-3, 0.7
"""typical distance, of the chord, above which the cloud is of another blade: as far as a match may be off where no
tolerance is asked; and share of the points that must take part"""
OTHER_BLADE_NOTE = "the cloud does not lie on the design's blade"
"""what a note begins with where the cloud is of another blade"""
FREEDOMS = {
    2: ("turn", "shift_x", "shift_y"),
    3: ("turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z"),
}
"""degrees of freedom by dimension: right-handed turns about the machine's axes, then shifts along them"""
GENERATORS = {
    2: np.array([[[0.0, -1.0], [1.0, 0.0]]]),
    3: np.array(
        [
            [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
            [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]],
            [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        ]
    ),
}
"""(k, d, d) rates of change of the rotation by a turn, in d dimensions"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Registration:
    """A motion that brings a cloud onto a blade or section, and how well it lies there."""

    motion: Motion
    rms: float
    """root mean square of the true distances of the points that took part [m]"""
    share: float
    """share of the points that took part; the others are outliers"""
    undetermined: tuple[str, ...]
    """degrees of freedom that the points do not determine"""
    covariance: Reals
    """(k, k) of the degrees of freedom, turns about the origin of the machine's axes [rad], then shifts [m]"""
    same: bool
    """whether it may be this blade, by the distances and the outliers"""
    notes: tuple[str, ...]
    """what else there is to know, each a sentence"""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Where n points touch the blade, and the m directions in which they are held there."""

    miss: Reals
    """(n, d) from the nearest places to the points"""
    rows: NDArray[np.intp]
    """(m,) the point of each direction"""
    directions: Reals
    """(m, d) unit vectors"""


Contacts = Callable[[Reals], Contact]
"""where points (n, d) touch the blade"""


def registration(points: Reals, design: Design) -> Registration:
    """The motion of points (n, d) [m] that lie anywhere onto what a design builds, found without a guess.

    Raises FitError where the points do not have the dimension of the design, or are too few.
    """
    built = design.build()
    sides = sides_of(built)
    dimension = int(np.real(sides[0].control_points).shape[-1])
    cloud = _checked(points, dimension)
    samples, normals = _samples(sides)
    extent = float(np.max(np.ptp(samples, axis=0)))
    few = without_isolated_points(cloud[random_subset(len(cloud), LOOKED_AT)])
    few = few[even_subset(few, SEARCH_POINTS)]

    def touching(moved: Reals) -> Contact:
        found = nearest_footpoints(moved, sides)
        past = np.flatnonzero(np.any(found.beyond != 0.0, axis=1))
        rows = np.concatenate([np.arange(len(moved)), past])
        return Contact(miss=found.miss, rows=rows, directions=np.concatenate([found.normals, found.beyond[past]]))

    def distance(motion: Motion) -> float:
        distances = nearest_footpoints(motion(few), sides).distances
        return float(np.mean(np.minimum(distances, FIRST_WIDTH * extent)))

    starts = sorted((_rough(few, samples, normals, start) for start in _starts(few, samples)), key=lambda each: each[0])
    near = [_descended(few, touching, start, extent, steps=TRIAL_STEPS) for _, start in starts[:FOLLOWED_STARTS]]
    some = cloud[random_subset(len(cloud), DECIDING_POINTS)]
    motion = _descended(some, touching, min(near, key=distance), extent)
    return _reported(some, touching, motion, extent, float(np.real(built.chord)))


def _checked(points: Reals, dimension: int) -> Reals:
    cloud = np.asarray(points, dtype=np.float64)
    if cloud.ndim != 2 or cloud.shape[1] != dimension:
        raise FitError(
            f"a cloud of shape {cloud.shape} was given for a design in {dimension} dimensions; give (n, {dimension})"
        )
    cloud = cloud[np.isfinite(cloud).all(axis=1)]
    if len(cloud) < 12:
        raise FitError(f"{len(cloud)} points were given: at least 12 are needed to find where they lie")
    return cloud


def _samples(sides: tuple[Side, Side]) -> tuple[Reals, Reals]:
    """Points (m, d) spread evenly over the sides, and the unit normals there."""
    found = []
    for k, side in enumerate(sides):
        along, across = GRID[3 if isinstance(side, Surface) else 2]
        u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, along))) / 2.0
        u, v = (each.ravel() for each in np.meshgrid(u, np.linspace(0.0, 1.0, across), indexing="ij"))
        points = side(u, v) if isinstance(side, Surface) else side(u)
        rows = even_subset(points, SAMPLES // 2)
        at = footpoints_at(points[rows], sides, np.full(len(rows), k, dtype=np.intp), u[rows], v[rows])
        found.append((at.points, at.normals))
    return np.concatenate([points for points, _ in found]), np.concatenate([normals for _, normals in found])


def _starts(cloud: Reals, samples: Reals) -> list[Motion]:
    """All rotations of the cloud's principal axes onto those of the samples, centre on centre."""
    pivot, centre = np.mean(cloud, axis=0), np.mean(samples, axis=0)
    axes, goals = (np.linalg.svd(each, full_matrices=False)[2] for each in (cloud - pivot, samples - centre))
    dimension = cloud.shape[1]
    found = []
    for order in permutations(range(dimension)):
        for signs in product((1.0, -1.0), repeat=dimension):
            rotation = goals.T @ (np.array(signs)[:, None] * axes[list(order)])
            if np.linalg.det(rotation) > 0.0:
                found.append(Motion(rotation=rotation, translation=centre - rotation @ pivot))
    return found


def _rough(points: Reals, samples: Reals, normals: Reals, motion: Motion) -> tuple[float, Motion]:
    """The motion that closest samples lead to, point to point, then point to plane, and the mean distance there."""
    tree, dimension = cKDTree(samples), points.shape[1]
    extent = float(np.max(np.ptp(samples, axis=0)))
    spacing = float(np.max(tree.query(samples, k=2)[0]))
    every = np.arange(len(points))

    def to_points(moved: Reals) -> Contact:
        index = tree.query(moved)[1]
        return Contact(
            miss=moved - samples[index],
            rows=np.repeat(every, dimension),
            directions=np.tile(np.eye(dimension), (len(points), 1)),
        )

    def to_planes(moved: Reals) -> Contact:
        index = tree.query(moved)[1]
        return Contact(miss=moved - samples[index], rows=every, directions=normals[index])

    for contacts, steps in ((to_points, POINT_STEPS), (to_planes, PLANE_STEPS)):
        for _ in range(steps):
            motion = composed(_step(motion(points), contacts(motion(points)), 0.0, extent), motion)
    contact = to_planes(motion(points))
    distances = np.sqrt(np.sum(contact.miss**2, axis=1))
    # between samples only the distance from the tangent plane says how far a point is off
    aside = np.where(distances > spacing, distances, np.abs(np.sum(contact.directions * contact.miss, axis=1)))
    return float(np.mean(np.minimum(aside, FIRST_WIDTH * extent))), motion


def _descended(points: Reals, contacts: Contacts, motion: Motion, extent: float, steps: int = MOST_STEPS) -> Motion:
    """The motion of least robust distances near a first one."""
    width = FIRST_WIDTH * extent
    for _ in range(steps):
        moved = motion(points)
        contact = contacts(moved)
        needed = max(_noise_width(contact), LEAST_WIDTH * extent)
        motion = composed(_step(moved, contact, width, extent), motion)
        if width <= needed and np.max(np.abs(motion(points) - moved)) < LAST_STEP * extent:
            break
        width = max(needed, width / SHRINKING)
    return motion


def _noise_width(contact: Contact) -> float:
    """Width of the weights that the points' own distances call for."""
    return TUKEY_WIDTH * median_deviation(np.sqrt(np.sum(contact.miss**2, axis=1)))


def _weights(contact: Contact, width: float) -> Reals:
    """Weights (n,) of the points, that of an outlier 0; their own distances may need a larger width."""
    return tukey_weights(np.sqrt(np.sum(contact.miss**2, axis=1)), max(width, _noise_width(contact)))


def _equations(moved: Reals, contact: Contact, weights: Reals, pivot: Reals) -> tuple[Reals, Reals]:
    """Weighted rows (m, k) of what turns about a pivot and shifts do to the distances, and right sides (m,)."""
    root = np.sqrt(weights[contact.rows])
    rows = np.einsum("md,mdk->mk", contact.directions, motion_rates(moved, pivot)[contact.rows]) * root[:, None]
    return rows, -np.sum(contact.directions * contact.miss[contact.rows], axis=1) * root


def _step(moved: Reals, contact: Contact, width: float, extent: float) -> Motion:
    """The step of Gauss and Newton, in the degrees of freedom that the points determine."""
    weights = _weights(contact, width)
    pivot = np.mean(moved, axis=0)
    rows, right = _equations(moved, contact, weights, pivot)
    scale = motion_scale(moved.shape[1], extent)
    change = scale * np.linalg.lstsq(rows * scale, right, rcond=WEAKEST_FREEDOM)[0]
    return motion_by(change, pivot)


def motion_rates(points: Reals, pivot: Reals) -> Reals:
    """Rates (n, d, k) of points (n, d) by turns about a pivot and shifts."""
    dimension = points.shape[1]
    turns = np.einsum("kde,ne->ndk", GENERATORS[dimension], points - pivot)
    return np.concatenate([turns, np.broadcast_to(np.eye(dimension), (len(points), dimension, dimension))], axis=2)


def motion_by(change: Reals, pivot: Reals) -> Motion:
    """The motion by turns about a pivot (d,), of no more than `LONGEST_TURN`, and shifts (k,)."""
    turns = change[: len(GENERATORS[len(pivot)])]
    largest = float(np.sqrt(np.sum(turns**2)))
    rotation = rotation_by(turns * min(1.0, LONGEST_TURN / max(largest, LAST_STEP)))
    return Motion(rotation=rotation, translation=pivot - rotation @ pivot + change[len(turns) :])


def motion_scale(dimension: int, extent: float) -> Reals:
    """Scales (k,) of the degrees of freedom by which all are lengths."""
    count = len(GENERATORS[dimension])
    return np.concatenate([np.full(count, 1.0 / extent), np.ones(dimension)])


def _reported(points: Reals, contacts: Contacts, motion: Motion, extent: float, chord: float) -> Registration:
    """The figures and notes of a motion."""
    moved, dimension = motion(points), points.shape[1]
    contact = contacts(moved)
    weights = _weights(contact, LEAST_WIDTH * extent)
    distances, taking = np.sqrt(np.sum(contact.miss**2, axis=1)), weights > 0.0
    scale = motion_scale(dimension, extent)
    rows, right = _equations(moved, contact, weights, np.mean(moved, axis=0))
    variance = float(np.sum(right**2)) / max(1, int(np.count_nonzero(right)) - rows.shape[1])
    _, values, across = np.linalg.svd(rows * scale, full_matrices=False)
    weak = across[values <= max(WEAKEST_FREEDOM * values[0], np.sqrt(variance) / (LARGEST_DEVIATION * extent))]
    undetermined = tuple(name for k, name in enumerate(FREEDOMS[dimension]) if np.any(np.abs(weak[:, k]) > 0.1))
    rows, _ = _equations(moved, contact, weights, np.zeros(dimension))
    covariance = variance * np.outer(scale, scale) * np.linalg.pinv((rows * scale).T @ (rows * scale))
    share, typical = float(np.mean(taking)), median_deviation(distances)
    same = typical <= OTHER_BLADE * chord and share >= LEAST_SHARE
    notes = []
    if undetermined:
        names = ", ".join(undetermined)
        notes.append(f"the points do not determine {names} of the motion: they stay where the search ended")
    if not same:
        notes.append(
            f"{OTHER_BLADE_NOTE}: {1.0 - share:.0%} of its points are away from it, the "
            f"others miss it by {typical:.3g} m, {typical / chord:.2%} of its chord; it is another blade, a mirrored "
            "one, or in another unit"
        )
    return Registration(
        motion=motion,
        rms=float(np.sqrt(np.mean(distances[taking] ** 2))) if np.any(taking) else np.inf,
        share=share,
        undetermined=undetermined,
        covariance=covariance,
        same=same,
        notes=tuple(notes),
    )


def rotation_by(turns: Reals) -> Reals:
    """The rotation (d, d) by an angle (1,) in the plane, or a rotation vector (3,) in space [rad]."""
    if len(turns) == 3:
        return np.asarray(Rotation.from_rotvec(turns).as_matrix())
    c, s = np.cos(turns[0]), np.sin(turns[0])
    return np.array([[c, -s], [s, c]])


def composed(second: Motion, first: Motion) -> Motion:
    """The motion that does `first`, then `second`."""
    return Motion(
        rotation=second.rotation @ first.rotation,
        translation=second.rotation @ first.translation + second.translation,
    )
