"""What is free in a fit, and what keeps its laws tame where the cloud says nothing."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

import bladewright.blade.stations as stations_module
from bladewright.blade.stations import Stations
from bladewright.blade.unified import UnifiedBlade
from bladewright.numerics.elementary import Array, dot, length
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

LAWS = (
    "leading_edge_theta", "stagger", "metal_angle_in", "metal_angle_out", "tangent_in", "tangent_out",
    "leading_edge_radius", "trailing_edge_radius", "thickness_upper", "thickness_lower",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Free:
    """A free parameter: the paths that share its value, its size (a change that matters) and its bounds."""

    paths: tuple[str, ...]
    size: float
    low: float = -np.inf
    high: float = np.inf


@dataclass(frozen=True, kw_only=True)
class Weights:
    """Of what keeps a fit tame, in chords of distance; all far below what the data say where they say anything."""

    smooth: float = 1e-3
    """second differences of the laws along span and chord, by parameter size"""
    centred: float = 1e-3
    """difference of upper and lower thickness: the camber line runs in the middle"""
    near: float = 1e-4
    """distance from the start, by parameter size"""
    channel: float = 1e-3
    """the same of the channel's control points, which the cloud lets slide along their curve"""
    edges: float = 1e-3
    """the outermost places at each edge, of the whole cloud: a blade that is too long stays so without them, because
    the places where it sticks out are nobody's nearest; but the camber's end of a staggered nose is not outermost"""
    held: float = 10.0
    """edge radii that the thickness beside them cannot hold; of the section's extent"""


def free_parameters(design: UnifiedBlade, chord: float, fixed: Sequence[str] = ()) -> list[Free]:
    """Every parameter of a design but those whose path begins with a name in `fixed`; `chord` in metres."""
    unit = UNITS[design.length_unit]
    sizes = {
        "leading_edge_theta": (np.degrees(0.05), -np.inf, np.inf),
        "leading_edge_y": (0.05 * chord / unit, -np.inf, np.inf),
        "stagger": (5.0, -85.0, 85.0),
        "metal_angle": (10.0, -85.0, 85.0),
        "tangent": (0.2, 0.15, 0.7),
        "leading_edge_radius": (0.003, 5e-4, 0.9),
        "trailing_edge_radius": (0.003, 5e-4, 0.9),
        "thickness": (0.05, 2e-3, 5.0),
        "channel": (0.005 * chord / unit, -np.inf, np.inf),
    }
    result = []
    for path in design.parameters():
        kind = next((kind for kind in sizes if path.startswith(kind)), None)
        if kind is None or any(path.startswith(name) for name in fixed):
            continue
        size, low, high = sizes[kind]
        result.append(Free(paths=(path,), size=size, low=low, high=high))
    return result


def taming(start: UnifiedBlade, free: Sequence[Free], weights: Weights) -> tuple[Reals, Reals]:
    """Rows and right-hand sides of the linear residuals, by size, that keep laws smooth, centred and near the start."""
    values, count = start.parameters(), len(free)
    index = {path: i for i, each in enumerate(free) for path in each.paths}
    near = [weights.channel if each.paths[0].startswith("channel") else weights.near for each in free]
    rows, aims = [np.diag(near)], [np.zeros(count)]

    for terms, weight, size in [*_second_differences(start, free, weights), *_sides_apart(start, weights)]:
        row = np.zeros(count)
        for path, factor in terms:
            if path in index:
                row[index[path]] += factor * free[index[path]].size
        rows.append(weight / size * row[None])
        aims.append(np.array([-weight / size * sum(factor * values[path] for path, factor in terms)]))
    return np.concatenate(rows), np.concatenate(aims)


Terms = list[tuple[str, float]]


def _second_differences(
    start: UnifiedBlade, free: Sequence[Free], weights: Weights
) -> Iterator[tuple[Terms, float, float]]:
    for name in LAWS:
        size = next((each.size for each in free if each.paths[0].startswith(name)), None)
        if size is None:
            continue
        grid = _paths(name, getattr(start, name))
        inner = grid[1:-1] if len(grid) > 2 and len(grid[0]) != len(grid[1]) else grid
        lines = [*grid, *zip(*inner, strict=True)]
        for line in lines:
            for before, at, after in zip(line, line[1:], line[2:], strict=False):
                yield [(before, 1.0), (at, -2.0), (after, 1.0)], weights.smooth, size


def _sides_apart(start: UnifiedBlade, weights: Weights) -> Iterator[tuple[Terms, float, float]]:
    above, below = (_paths(f"thickness_{s}", getattr(start, f"thickness_{s}")) for s in ("upper", "lower"))
    if [len(row) for row in above] == [len(row) for row in below]:
        for pair in zip(chain(*above), chain(*below), strict=True):
            yield list(zip(pair, (1.0, -1.0), strict=True)), weights.centred, 0.05


def _paths(name: str, law: Any) -> list[list[str]]:
    """Paths of a law, one list a chordwise control point."""
    chordwise = name.startswith("thickness")
    rows = []
    for i, entry in enumerate(law if chordwise else (law,)):
        stem = f"{name}[{i}]" if chordwise else name
        rows.append([f"{stem}[{j}]" for j in range(len(entry))] if isinstance(entry, tuple) else [stem])
    return rows


SOFT = 2e-4
"""width of the smooth step from fitting to overfull, of the section's extent"""


@contextmanager
def edges_unchecked() -> Iterator[None]:
    """The exact blade without the refusal of edge radii: a wall in the way of a step would stop the fit short of it."""
    kept = stations_module.check_edges
    stations_module.check_edges = lambda *_: None
    try:
        with np.errstate(invalid="ignore"):
            yield
    finally:
        stations_module.check_edges = kept


def overfull(stations: Stations) -> Array:
    """By how much a nose, 5 % higher, exceeds the thickness beside it, of the section's extent (..., 4, m)."""
    plane = stations.plane
    extent = plane.camber[..., 3, 0] - plane.camber[..., 0, 0]
    rows = []
    for side in (plane.upper, plane.lower):
        for first, second, third in (_ends(side, 0), _ends(side, -1)):
            height = length(second - first)
            beside = dot(third - first, second - first) / height
            rows.append((1.05 * height - beside) / extent)
    return np.stack(rows, axis=-2)


def _ends(side: Array, end: int) -> tuple[Array, Array, Array]:
    order = (0, 1, 2) if end == 0 else (-1, -2, -3)
    first, second, third = (side[..., i, :] for i in order)
    return first, second, third


def pressed(over: Array) -> Array:
    """A smooth max(over, 0): a kink there would stop the fit at it."""
    return (over + np.sqrt(over * over + SOFT**2)) / 2.0
