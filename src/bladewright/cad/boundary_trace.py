"""Which edges of a body a curve of a trimmed face follows, though its parameter is another."""

import numpy as np

from bladewright.cad.region import greville_spaced
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.trimmed import TrimmedSurface

ON_BOUNDARY = 1e-6
"""Largest distance of a trimmed face's boundary from the edge that it runs along, as a fraction of the body's extent.
It only decides which edge is meant: the distance itself is measured, and becomes the gap of the edge."""


class BoundaryTrace:
    """A curve of a trimmed face as a dense polyline in space."""

    def __init__(self, face: TrimmedSurface, boundary: Curve, tolerance: float) -> None:
        self.face, self.boundary, self.tolerance = face, boundary, tolerance
        self.s = greville_spaced(boundary.knots, boundary.degree, 2001)
        self.line = face.surface(*boundary(self.s).T)

    def followed(self, probes: Array, name: str) -> list[tuple[int, bool, tuple[float, float]]]:
        """The edges that the curve follows one after another: their index, whether along them, and over which span.

        `probes` (n, 5, 3) are points of all edges, their ends among them.
        """
        line, tolerance = self.line, self.tolerance
        margin = 100.0 * tolerance
        within = (probes >= line.min(axis=0) - margin) & (probes <= line.max(axis=0) + margin)
        found = []
        for edge in np.flatnonzero(within.all(axis=(1, 2))).tolist():
            middle = self.foot(probes[edge, 2])
            if max(middle[0], *(self.foot(end)[0] for end in probes[edge, [0, -1]])) <= tolerance:
                found.append((middle[1], edge))
        place, reached, edges = line[0], float(self.s[0]), []
        for at, edge in sorted(found):
            first, early, _, late, last = probes[edge]
            along = _distance(place, first) <= _distance(place, last)
            if _distance(first, last) <= tolerance:
                along = self.foot(early)[1] < self.foot(late)[1]
            start, end = (first, last) if along else (last, first)
            if _distance(place, start) > tolerance:
                break
            past = self.foot(end, after=at)[1]
            edges.append((edge, along, (reached, past)))
            place, reached = end, past
        if not found or _distance(place, line[-1]) > tolerance:
            raise CadError(
                f"{name} runs along no edge of another face: the nearest is {self._nearest(probes):.3g} m away, and at "
                f"most {tolerance:.3g} m is taken for the same; let the neighbour end on this curve, or declare the "
                "edge where that is a trimmed face too"
            )
        return edges

    def foot(self, point: Array, after: float = -np.inf) -> tuple[float, float]:
        """Distance of a point from the curve, and the curve's parameter there, not before `after`."""
        s, line = self.s, self.line
        begin = max(0, int(np.searchsorted(s, after, side="right")) - 1)
        away, at = _to_polyline(point, line[begin:])
        if away > 100.0 * self.tolerance:
            return away, float(np.interp(begin + at, np.arange(len(s)), s))
        # the polyline cuts the corner around a nose, a finer one less
        low, high = s[max(begin + int(at) - 1, begin)], s[min(begin + int(at) + 2, len(s) - 1)]
        near = np.linspace(float(low), float(high), 61)
        away, at = _to_polyline(point, self.face.surface(*self.boundary(near).T))
        return away, float(np.interp(at, np.arange(len(near)), near))

    def _nearest(self, probes: Array) -> float:
        """How far the nearest edge is from the curve, at its ends and its middle."""
        distances = [
            max(_distance(self.line[0], start), _distance(self.line[-1], end), self.foot(middle)[0])
            for first, _, middle, _, last in probes
            for start, end in ((first, last), (last, first))
        ]
        return min(distances, default=np.inf)


def _distance(a: Array, b: Array) -> float:
    return float(np.sqrt(np.sum((a - b) ** 2)))


def _to_polyline(point: Array, line: Array) -> tuple[float, float]:
    """Distance of a point from a polyline, and where it is nearest, in segments from the start."""
    start, step = line[:-1], np.diff(line, axis=0)
    share = np.clip(np.sum((point - start) * step, axis=-1) / np.sum(step * step, axis=-1), 0.0, 1.0)
    away = np.sum((start + share[:, None] * step - point) ** 2, axis=-1)
    nearest = int(np.argmin(away))
    return float(np.sqrt(away[nearest])), float(nearest + share[nearest])
