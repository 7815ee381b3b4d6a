"""Sections drawn through the points of a cloud: a short least squares in the sections' planes."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bladewright.errors import FitError
from bladewright.fitting.initial_guess.restraints import THINNEST_SECTION, limits, overhang_rows, regularisation_rows
from bladewright.fitting.initial_guess.section_shape import (
    EXTENT,
    ROOT_IN,
    ROOT_OUT,
    SectionShape,
    UnwrappedPoints,
    numbers_at,
    section_stations,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis

LEAST_SMOOTHING = 1e-3
"""least weight of the rows that keep even what the points leave open."""
SIDE_PLACES = np.linspace(0.0, 1.0, 65)
"""parameters along a side among which the nearest place is sought"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionMatch:
    """Laws of sections, and how far points lie from them."""

    laws: Reals
    """(k, q) control points along the span of each number of a section"""
    distances: Reals
    """(n,) of the points from the sections [m]"""
    mean: float
    """mean distance of the nearest 94 % of the points [m]"""
    s: Reals
    """(n,) places along the side"""
    upper: NDArray[np.bool_]
    """(n,) whether the nearest place is on the upper side"""


def nearest_places(
    shape: SectionShape, unwrapped: UnwrappedPoints, laws: Reals
) -> tuple[Reals, NDArray[np.bool_], Reals]:
    """Place along the side, side and distance [m] of each point."""
    at = section_stations(unwrapped)
    lines = np.stack(shape.polylines(numbers_at(laws, at), at, SIDE_PLACES), axis=1)
    place = np.clip(unwrapped.v, 0.0, 1.0) * (len(at) - 1)
    low = np.clip(place.astype(int), 0, max(0, len(at) - 2))
    high = np.minimum(low + 1, len(at) - 1)
    share = place - low
    squares = np.empty((len(low), 2, len(SIDE_PLACES)))
    for station in np.unique(low):
        mask = low == station
        part, p = share[mask, None, None], unwrapped.points[mask]
        total = np.zeros((len(p), 2, len(SIDE_PLACES)))
        for i in (0, 1):
            first = lines[station, ..., i]
            step = lines[min(station + 1, len(at) - 1), ..., i] - first
            total += (p[:, i, None, None] - first - part * step) ** 2
        squares[mask] = total
    if unwrapped.upper is not None and unwrapped.sure is not None:
        squares[unwrapped.sure, np.where(unwrapped.upper, 1, 0)[unwrapped.sure]] = np.inf
    index = np.argmin(squares.reshape(len(low), -1), axis=1)
    upper = index < len(SIDE_PLACES)
    side, vertex = index // len(SIDE_PLACES), index % len(SIDE_PLACES)

    def on(which: NDArray[np.intp]) -> Reals:
        part = share[:, None]
        return np.asarray((1.0 - part) * lines[low, side, which] + part * lines[high, side, which])

    best, s = np.full(len(low), np.inf), np.empty(len(low))
    middle = on(vertex)
    for way in (-1, 1):
        other = np.clip(vertex + way, 0, len(SIDE_PLACES) - 1)
        step = on(other) - middle
        t = np.sum((unwrapped.points - middle) * step, axis=-1) / (np.sum(step**2, axis=-1) + 1e-300)
        t = np.clip(t, 0.0, 1.0)
        distance = np.sqrt(np.sum((unwrapped.points - middle - t[:, None] * step) ** 2, axis=-1))
        nearer = distance < best
        best = np.where(nearer, distance, best)
        s = np.where(nearer, SIDE_PLACES[vertex] + t * (SIDE_PLACES[other] - SIDE_PLACES[vertex]), s)
    return s, upper, best / unwrapped.size


def matched_sections(
    shape: SectionShape,
    unwrapped: UnwrappedPoints,
    laws: Reals,
    *,
    turns: int = 25,
    stiff: float = 1.0,
    ends: bool = False,
    draw_in: bool = False,
) -> SectionMatch:
    """Laws near the given ones whose sections are near the points.

    `ends` holds the ends of the camber lines at those of the stream lines, `draw_in` draws in overhangs.
    """
    laws = within_limits(shape, unwrapped, laws)
    best: SectionMatch | None = None
    history: list[float] = []
    smooth = 3e-2 * stiff
    for turn in range(turns + 1):
        s, upper, distances = nearest_places(shape, unwrapped, laws)
        weight = _weights(unwrapped, s, upper, distances, turn / turns)
        # a cap on distances is added, so that a side that few points are near does not look good
        mean = float(np.sum(weight * distances) / np.sum(weight)) + 0.2 * float(
            np.mean(np.minimum(distances, 0.1 * unwrapped.chord))
        )
        history.append(mean)
        if best is None or mean < best.mean:
            best = SectionMatch(laws=laws, distances=distances, mean=mean, s=s, upper=upper)
        settled = len(history) > 6 and min(history[-3:]) > 0.97 * min(history[:-3])
        if turn == turns or (settled and smooth <= 1.01 * LEAST_SMOOTHING):
            break
        laws = within_limits(
            shape, unwrapped, laws + _step(shape, unwrapped, laws, s, upper, weight, smooth, ends, draw_in)
        )
        smooth = max(0.5 * smooth, LEAST_SMOOTHING)
    if best is None:
        raise FitError("no section was found near the points")
    return replace(best, mean=float(np.mean(np.sort(best.distances)[: max(1, int(0.94 * len(best.distances)))])))


def within_limits(shape: SectionShape, unwrapped: UnwrappedPoints, laws: Reals) -> Reals:
    """The laws within the family's limits, with edge radii that fit into the thickness beside them."""
    low, high, _ = limits(shape, unwrapped, ends=False)
    laws = np.clip(laws, low, high)
    laws = _with_thin_edges(shape, unwrapped, laws)
    least = np.sqrt(2e-4 * unwrapped.ratio)
    at = section_stations(unwrapped)
    numbers = numbers_at(laws, at)
    for column, beside, end in ((ROOT_IN, 2, 0), (ROOT_OUT, -3, 1)):
        most = np.full(len(at), np.inf)
        for upper in (True, False):
            heights, *units, _ = shape.heights(numbers, at, upper)
            most = np.minimum(most, 0.97 * heights[:, beside] / units[end])
        excess = float(np.max(numbers[:, column] / most))
        if excess > 1.0 and len(laws) > 1:
            capped = np.linalg.lstsq(law_basis(len(laws), at), np.minimum(numbers[:, column], most), rcond=None)[0]
            laws[:, column] = np.maximum(capped, 0.2 * least)
            excess = float(np.max((law_basis(len(laws), at) @ laws[:, column]) / most))
        laws[:, column] /= max(excess, 1.0)
    if unwrapped.flat:
        laws[:, [ROOT_IN, ROOT_OUT]] = np.minimum(laws[:, [ROOT_IN, ROOT_OUT]], np.sqrt(0.9 * laws[:, [EXTENT]]))
    return laws


def _with_thin_edges(shape: SectionShape, unwrapped: UnwrappedPoints, laws: Reals) -> Reals:
    """The laws with edges so thin that the sides leave them inwards."""
    at = section_stations(unwrapped)
    numbers = numbers_at(laws, at)
    for side, upper in ((shape.upper, True), (shape.lower, False)):
        room = shape.thickness_limits(numbers, at, upper)
        for column, most in ((side.start, room[0]), (side.stop - 1, room[1])):
            share = float(np.min(0.8 * most / numbers[:, column]))
            laws[:, column] = np.maximum(laws[:, column] * min(1.0, share), 0.2 * THINNEST_SECTION * unwrapped.ratio)
    return laws


def _weights(
    unwrapped: UnwrappedPoints, s: Reals, upper: NDArray[np.bool_], distances: Reals, progress: float
) -> Reals:
    """Weights of the points: each part of a side counts alike, distant points count less."""
    bins = (
        (s * 11.999).astype(int)
        + 12 * upper
        + 24 * (np.clip(unwrapped.v, 0.0, 1.0) * 3.999).astype(int) * (not unwrapped.flat)
    )
    counts = np.bincount(bins)[bins]
    even = 1.0 / np.sqrt(counts / np.mean(counts) + 0.05)
    spread = 1.4826 * float(np.median(distances))
    width = max(5.0 * spread, unwrapped.chord * (0.05 * (1.0 - progress) ** 2 + 2e-3))
    return even / np.mean(even) / (1.0 + (distances / width) ** 2) ** 2


def _step(
    shape: SectionShape,
    unwrapped: UnwrappedPoints,
    laws: Reals,
    s: Reals,
    upper: NDArray[np.bool_],
    weight: Reals,
    smooth: float,
    ends: bool,
    draw_in: bool,
) -> Reals:
    """The step of a damped least squares within the limits."""
    numbers = numbers_at(laws, unwrapped.v)
    footpoint = shape.footpoints(numbers, unwrapped.v, s, upper)
    root = np.sqrt(weight / np.sum(weight)) / (unwrapped.size * unwrapped.chord)
    away = root * np.sum((unwrapped.points - footpoint.point) * footpoint.normal, axis=-1)
    rows = law_basis(len(laws), unwrapped.v)
    slopes = (root[:, None] * footpoint.slopes)[:, :, None] * rows[:, None, :]
    matrix = slopes.reshape(len(s), -1)
    for regularisation, rhs in (
        regularisation_rows(shape, unwrapped, laws, smooth),
        *([overhang_rows(shape, unwrapped, laws)] if draw_in else []),
    ):
        matrix, away = np.concatenate([matrix, regularisation]), np.concatenate([away, rhs])
    flat = laws.T.reshape(-1)
    low, high, most = (np.repeat(a, len(laws)) for a in limits(shape, unwrapped, ends=ends))
    free = np.ones(len(flat), dtype=bool)
    step = np.zeros(len(flat))
    normal, right = matrix.T @ matrix, matrix.T @ away
    normal[np.diag_indices_from(normal)] += 1e-4 * np.diag(normal) + 1e-12
    for _ in range(4):
        step[:] = 0.0
        step[free] = np.linalg.solve(normal[np.ix_(free, free)], right[free])
        out = free & (((flat <= low) & (step < 0.0)) | ((flat >= high) & (step > 0.0)))
        if not np.any(out):
            break
        free &= ~out
    step *= 1.0 / max(1.0, float(np.max(np.abs(step) / most)))
    new = np.clip(flat + step, low, high)
    return (new - flat).reshape(-1, len(laws)).T
