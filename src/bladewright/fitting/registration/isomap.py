"""A blade's cloud as a sheet: unrolled by distances along it, with its four corners and the sides between them.

The unrolling is landmark Isomap (Tenenbaum et al. 2000, de Silva and Tenenbaum 2004): multidimensional scaling of the
shortest paths through a graph of neighbours. Both sides of a blade come to lie on each other.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import ConvexHull, cKDTree

from bladewright.fitting.clouds.thinning import even_subset
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals

GRAPH_NEIGHBOURS = 12
"""neighbours of a point in the graph"""
GRAPH_POINTS = 900
"""evenly spread points that make the graph; it bounds the time."""
LANDMARKS = 60
"""points from which path lengths are measured"""
HULL_CORNERS = 36
"""corners of the convex hull from which four are chosen"""
RIM_NEIGHBOURS = 24
"""neighbours whose centre shows whether a point is on the rim"""
INSIDE_COST = 12.0
"""factor by which a path inside the sheet costs more than one along the rim."""


@dataclass(frozen=True, kw_only=True)
class UnrolledSheet:
    """Points of a blade unrolled into a plane."""

    points: Reals
    """(n, 3) the points that are unrolled"""
    flat: Reals
    """(n, 2) the same, unrolled"""
    spacing: float
    """typical distance of evenly spread points among them [m]"""
    sides: tuple[Reals, ...]
    """(m, 2) for each of the four sides, in order around the sheet, the path in the plane from corner to corner"""

    def along(self, side: int) -> tuple[Reals, Reals]:
        """Places (n,) in [0, 1] of all points along a side, and how far inside of it they are (n,) [m]."""
        line = self.sides[side]
        way = cumulative_length(line)
        at = np.linspace(0.0, way[-1], 400)
        fine = np.stack([np.interp(at, way, line[:, k]) for k in (0, 1)], axis=-1)
        index = cKDTree(fine).query(self.flat)[1]
        tangent = np.gradient(fine, axis=0)
        tangent /= np.maximum(np.sqrt(np.sum(tangent**2, axis=1, keepdims=True)), 1e-300)
        # the corners run counter-clockwise
        inward = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1)
        return at[index] / way[-1], np.sum((self.flat - fine[index]) * inward[index], axis=1)


def unrolled_sheet(points: Reals) -> UnrolledSheet:
    """The sheet of points (n, 3) that are spread over a blade's sides."""
    even = points[even_subset(points, GRAPH_POINTS)]
    graph = _graph(even)
    label = connected_components(graph, directed=False)[1]
    most = np.flatnonzero(label == np.argmax(np.bincount(label)))
    even, graph = even[most], csr_array(graph[most][:, most])
    flat = _scaled_coordinates(graph, even)
    order = _corners(flat)
    astray = _insideness(flat)
    start, end = graph.nonzero()
    costs = graph.data * (1.0 + INSIDE_COST * 0.5 * (astray[start] + astray[end]))
    rim = csr_array((costs, (start, end)), shape=graph.shape)
    _, before = dijkstra(rim, directed=False, indices=order, return_predecessors=True)
    ways = [_path(before[k], order[k], order[(k + 1) % 4]) for k in range(4)]
    spacing = float(np.median(cKDTree(even).query(even, k=5)[0][:, -1]))
    kept = points[cKDTree(even).query(points)[0] < 3.0 * spacing]
    distances, index = cKDTree(even).query(kept, k=4)
    weights = 1.0 / (distances + 1e-3 * spacing) ** 2
    unwrapped = np.einsum("nk,nkd->nd", weights / weights.sum(axis=1, keepdims=True), flat[index])
    return UnrolledSheet(points=kept, flat=unwrapped, spacing=spacing, sides=tuple(flat[way] for way in ways))


def _graph(points: Reals) -> csr_array:
    distances, index = cKDTree(points).query(points, k=GRAPH_NEIGHBOURS + 1)
    start = np.repeat(np.arange(len(points)), GRAPH_NEIGHBOURS)
    graph = csr_array(
        (np.maximum(distances[:, 1:].ravel(), 1e-300), (start, index[:, 1:].ravel())), shape=(len(points),) * 2
    )
    return csr_array(graph.maximum(graph.T))


def _scaled_coordinates(graph: csr_array, points: Reals) -> Reals:
    """Coordinates (n, 2) whose distances are nearest to the path lengths through the graph."""
    marks = even_subset(points, LANDMARKS)
    square = dijkstra(graph, directed=False, indices=marks) ** 2
    own = square[:, marks]
    mean = own.mean(axis=0)
    inner = -0.5 * (own - mean - mean[:, None] + mean.mean())
    values, vectors = np.linalg.eigh(inner)
    chosen = vectors[:, -2:] / np.sqrt(values[-2:])
    return np.asarray(-0.5 * (square.T - mean) @ chosen)


def _corners(flat: Reals) -> NDArray[np.intp]:
    """The four points, in order around the sheet, with the largest area between them."""
    hull = ConvexHull(flat).vertices
    while len(hull) > HULL_CORNERS:
        sides = np.sqrt(np.sum((flat[hull] - flat[np.roll(hull, 1)]) ** 2, axis=1))
        hull = np.delete(hull, np.argmin(sides + np.roll(sides, -1)))
    chosen = np.array(list(combinations(range(len(hull)), min(4, len(hull)))))
    corner = flat[hull][chosen]
    after = np.roll(corner, -1, axis=1)
    area = np.sum(corner[..., 0] * after[..., 1] - corner[..., 1] * after[..., 0], axis=1)
    return np.asarray(hull[chosen[np.argmax(area)]])


def _insideness(flat: Reals) -> Reals:
    """0 on the rim to 1 inside (n,), by how far the centre of a point's neighbours is off the point."""
    distances, index = cKDTree(flat).query(flat, k=RIM_NEIGHBOURS + 1)
    aside = np.sqrt(np.sum((flat[index].mean(axis=1) - flat) ** 2, axis=1)) / distances[:, -1]
    return np.asarray(np.clip(1.0 - aside / 0.4, 0.0, 1.0))


def _path(before: NDArray[np.intp], start: int, end: int) -> NDArray[np.intp]:
    found = [int(end)]
    while found[-1] != start and before[found[-1]] >= 0:
        found.append(int(before[found[-1]]))
    return np.array(found[::-1])
