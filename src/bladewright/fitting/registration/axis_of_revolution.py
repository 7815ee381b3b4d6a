"""The axis about which both ends of a blade lie on surfaces of revolution.

The axis has four degrees of freedom; each end's meridional line is a polynomial of low degree in the (x, r) plane, over
the direction from edge to edge. All are found at once by least squares of the distances in that plane.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.registration.rigid_motion import GENERATORS, composed, rotation_by
from bladewright.fitting.registration.robust_motion import tukey_weights
from bladewright.nurbs.basis import Reals

LINE_DEGREES = (1, 2, 3, 4, 5, 6, 7, 8)
"""degrees of the meridional lines that are tried; the Bayesian information criterion chooses (Schwarz 1978)."""
AXIS_STEPS = 25
"""steps of the least squares at most"""
HALVINGS = 4
"""times that a step is shortened that raises the cost"""
LEAST_WIDTH = 1e-13
"""least width of the weights, of the ends' extent: rounding."""
LEAST_NOISE = 1e-8
"""noise that points are taken to have at least, of the ends' extent, so that what nothing determines has a large
standard deviation."""
WEAKEST_DIRECTION = 1e-10
"""singular value, of the largest, below which a direction of the unknowns stays."""
FEWEST_END_POINTS = 40
"""points that an end must keep"""


@dataclass(frozen=True, kw_only=True)
class EndPoints:
    """Points on one end of a blade."""

    points: Reals
    """(n, 3) [m]"""
    along: Reals
    """(n,) place from edge to edge, 0 to 1"""


@dataclass(frozen=True, kw_only=True)
class RevolutionAxis:
    """An axis found from two ends."""

    motion: Motion
    """into axes of which the first is the machine's axis"""
    rms: float
    """distance of the ends' points from their surfaces [m]"""
    direction: float
    """standard deviation of the direction [rad]"""
    offset: float
    """standard deviation of the distance from the blade [m]"""
    score: float
    """Bayesian information criterion, by the median of the residuals"""


@dataclass(frozen=True, kw_only=True)
class _Line:
    """A meridional line: the ordinate as a polynomial of the abscissa, in axes along and across it."""

    turn: Reals
    """(2, 2) from (x, r) to abscissa and ordinate"""
    middle: float
    half: float
    coefficients: Reals


def axis_of(
    ends: tuple[EndPoints, EndPoints], start: Motion, degrees: tuple[int, ...] = LINE_DEGREES, steps: int = AXIS_STEPS
) -> RevolutionAxis | None:
    """The axis near a first one, with lines of the degree that the points need; None where an end loses its points.

    Each degree starts anew: lines of a high degree and the axis compensate each other under noise.
    """
    centre = np.concatenate([start(end.points) for end in ends]).mean(axis=0)
    back = Motion(rotation=np.eye(3), translation=np.array([-centre[0], 0.0, 0.0]))
    best: RevolutionAxis | None = None
    for degree in degrees:
        motion, lines, width = _axis_and_lines(ends, composed(back, start), degree, steps)
        axis = _axis(ends, motion, lines, width, degree)
        if axis is not None and (best is None or axis.score < best.score):
            best = axis
    return best


def _axis_and_lines(
    ends: tuple[EndPoints, EndPoints], motion: Motion, degree: int, steps: int
) -> tuple[Motion, list[_Line], float]:
    """Axis and lines where the steps end, and the width of the weights that the residuals need."""
    extent = _extent(ends)
    lines = [_first_line(end, motion, degree) for end in ends]
    misses = _equations(ends, motion, lines, np.inf)[2]
    wide = max(7.0 * float(np.median(np.abs(np.concatenate(misses)))), LEAST_WIDTH * extent)
    before = _cost(misses, wide)
    for _ in range(steps):
        rows, right, misses = _equations(ends, motion, lines, wide)
        scale = np.ones(rows.shape[1])
        scale[:2] = 1.0 / extent
        found = np.linalg.lstsq(rows * scale, right, rcond=WEAKEST_DIRECTION)[0]
        share = min(1.0, 0.1 * extent / max(float(np.max(np.abs(found[:4]))), 1e-300))
        for _ in range(HALVINGS):
            trial, curves = _changed(motion, lines, share * found * scale)
            misses = _equations(ends, trial, curves, np.inf)[2]
            cost = _cost(misses, wide)
            if cost <= before:
                break
            share *= 0.4
        else:
            break
        motion, lines = trial, curves
        narrow = max(7.0 * float(np.median(np.abs(np.concatenate(misses)))), LEAST_WIDTH * extent)
        narrow, wide = wide, min(wide, narrow)
        before = _cost(misses, wide)
        if share * np.max(np.abs(found)) < 1e-12 * extent or (
            share * np.max(np.abs(found)) < 1e-3 * wide and wide > 0.99 * narrow
        ):
            break
    return motion, lines, wide


def _changed(motion: Motion, lines: list[_Line], step: Reals) -> tuple[Motion, list[_Line]]:
    change = Motion(rotation=rotation_by(np.array([0.0, *step[:2]])), translation=np.array([0.0, *step[2:4]]))
    curves = [
        replace(line, coefficients=line.coefficients + part)
        for line, part in zip(lines, np.split(step[4:], 2), strict=True)
    ]
    return composed(change, motion), curves


def _cost(misses: list[Reals], width: float) -> float:
    """Sum of Tukey's losses, 1 for each point outside of the width."""
    inside = np.minimum(1.0, (np.concatenate(misses) / width) ** 2)
    return float(np.sum(1.0 - (1.0 - inside) ** 3))


def _first_line(end: EndPoints, motion: Motion, degree: int) -> _Line:
    """The meridional line of an end about a first axis, by Tukey's weights."""
    flat = _meridional(motion(end.points))
    way = (end.along - np.median(end.along)) @ (flat - np.median(flat, axis=0))
    c, s = way / max(float(np.sqrt(np.sum(way**2))), 1e-300)
    turn = np.array([[c, s], [-s, c]])
    abscissa, ordinate = turn @ flat.T
    low, high = np.min(abscissa), np.max(abscissa)
    middle, half = 0.5 * float(low + high), 0.5 * float(high - low)
    vander = chebyshev.chebvander((abscissa - middle) / half, degree)
    weight = np.ones(len(flat))
    for _ in range(10):
        root = np.sqrt(weight)
        coefficients = np.linalg.lstsq(vander * root[:, None], ordinate * root, rcond=1e-9)[0]
        distances = np.abs(ordinate - vander @ coefficients)
        weight = tukey_weights(distances, max(7.0 * float(np.median(distances)), 1e-12))
    return _Line(turn=turn, middle=middle, half=half, coefficients=coefficients)


def _equations(
    ends: tuple[EndPoints, EndPoints], motion: Motion, lines: list[_Line], width: float
) -> tuple[Reals, Reals, list[Reals]]:
    """Weighted rows by the axis' four degrees of freedom and the lines' coefficients, right sides, and distances."""
    blocks, rights, misses = [], [], []
    size = len(lines[0].coefficients)
    for k, (end, line) in enumerate(zip(ends, lines, strict=True)):
        points = motion(end.points)
        flat = _meridional(points)
        abscissa, ordinate = line.turn @ flat.T
        place = (abscissa - line.middle) / line.half
        vander = chebyshev.chebvander(place, size - 1)
        slope = chebyshev.chebval(place, chebyshev.chebder(line.coefficients)) / line.half
        cosine = 1.0 / np.sqrt(1.0 + slope**2)
        distances = (ordinate - vander @ line.coefficients) * cosine
        radial = points[:, 1:] / flat[:, 1:]
        rates = np.einsum("kde,ne->nkd", GENERATORS[3][1:], points)
        rates = np.concatenate([rates, np.broadcast_to(np.eye(3)[1:], (len(points), 2, 3))], axis=1)
        moves = np.stack([rates[..., 0], np.einsum("nkd,nd->nk", rates[..., 1:], radial)])
        along, across = np.einsum("ab,bnk->ank", line.turn, moves)
        block = np.zeros((len(points), 4 + 2 * size))
        block[:, :4] = (across - slope[:, None] * along) * cosine[:, None]
        block[:, 4 + k * size : 4 + (k + 1) * size] = -vander * cosine[:, None]
        root = np.sqrt(tukey_weights(np.abs(distances), width)) if np.isfinite(width) else np.ones(len(distances))
        blocks.append(block * root[:, None])
        rights.append(-distances * root)
        misses.append(distances)
    return np.concatenate(blocks), np.concatenate(rights), misses


def _axis(
    ends: tuple[EndPoints, EndPoints], motion: Motion, lines: list[_Line], width: float, degree: int
) -> RevolutionAxis | None:
    """The axis with its figures; None where an end has too few points on its surface."""
    rows, right, misses = _equations(ends, motion, lines, width)
    inside = [np.abs(miss) < width for miss in misses]
    kept = [miss[each] for miss, each in zip(misses, inside, strict=True)]
    if min(np.count_nonzero(each) for each in inside) < FEWEST_END_POINTS:
        return None
    extent = _extent(ends)
    scale = np.ones(rows.shape[1])
    scale[:2] = 1.0 / extent
    _, values, across = np.linalg.svd(rows * scale, full_matrices=False)
    half = across.T / np.maximum(values, WEAKEST_DIRECTION * values[0])
    spread = float(np.sum(right**2)) / max(1, np.count_nonzero(right) - rows.shape[1])
    spread = max(spread, (LEAST_NOISE * extent) ** 2)
    covariance = (spread * half @ half.T)[:4, :4]
    return RevolutionAxis(
        motion=motion,
        rms=float(np.sqrt(np.mean(np.concatenate(kept) ** 2))),
        direction=float(np.sqrt(np.linalg.eigvalsh(covariance[:2, :2])[-1])) / extent,
        offset=float(np.sqrt(np.linalg.eigvalsh(covariance[2:, 2:])[-1])),
        score=len(rows) * 2.0 * float(np.log(width)) + 2 * (degree + 1) * float(np.log(len(rows))),
    )


def _meridional(points: Reals) -> Reals:
    return np.stack([points[:, 0], np.sqrt(points[:, 1] ** 2 + points[:, 2] ** 2)], axis=-1)


def _extent(ends: tuple[EndPoints, EndPoints]) -> float:
    """Largest extent of both ends [m]."""
    return float(np.max(np.ptp(np.concatenate([end.points for end in ends]), axis=0)))
