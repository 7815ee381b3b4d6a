"""Faces in pieces: cut at creases always, and on request wherever OpenCASCADE's default quadrature needs it."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import cast

import numpy as np
from numpy.typing import NDArray

from bladewright.cad.native_body import ClosedBody
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import breaks
from bladewright.nurbs.domain import piece
from bladewright.nurbs.refine import Direction, direction_of
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

CREASE = 1e-3
"""Smallest jump of a derivative at a crease, as a fraction of the derivative's size beside it. The jumps of second
derivatives at repeated knots of the examples are either above 0.4 or below 4e-7 (design/other_programs.md)."""
ROUNDING = 1e-10
"""What else may be rounding, as a fraction of the face's extent over the knot span to the power of the derivative: of a
straight side the second derivative is nothing but that."""
PLACES = 41
"""Places along a knot line at which the jump across it is measured: a law that bends there bends along a stretch."""
SPANS_U, SPANS_V = 9, 24
"""Most knot spans of a piece along u and along v where faces are cut for OpenCASCADE's quadrature, which takes at most
61 Gauss points a direction on a face. The volumes of the examples are then within 5e-6, with 5 pieces where a side has
45 spans along u; along v the integrand is smooth, and 24 spans do (design/other_programs.md)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyInPieces:
    """A body whose untrimmed faces may be cut in pieces along their parameter lines."""

    built: ClosedBody
    """the body of whole faces"""
    cuts: Mapping[str, tuple[tuple[float, ...], tuple[float, ...]]]
    """ends of the pieces along u and along v, those of the face included, of each untrimmed face"""

    @property
    def name(self) -> str:
        """The body's name."""
        return self.built.name

    def names(self, face: str) -> NDArray[np.str_]:
        """Names (pieces along u, along v) of a face's pieces.

        They are numbered along u, and row after row along v where a face is cut in both directions.
        """
        along_u, along_v = (len(ends) - 1 for ends in self.cuts[face])
        if along_u * along_v == 1:
            return np.array([[face]])
        numbers = np.arange(1, along_u * along_v + 1).reshape(along_v, along_u).T
        return np.array([[f"{face}_{number}" for number in row] for row in numbers])

    @cached_property
    def surfaces(self) -> Mapping[str, Surface | TrimmedSurface]:
        """The pieces, which keep the parameters of their faces, and the faces that are whole."""
        pieces: dict[str, Surface | TrimmedSurface] = {}
        for name, face in self.built.surfaces.items():
            if not isinstance(face, Surface) or self.names(name).size == 1:
                pieces[name] = face
                continue
            along_u, along_v = (list(pairwise(ends)) for ends in self.cuts[name])
            columns = [piece(face, *ends, "u") for ends in along_u]
            found = [piece(column, *ends, "v") for ends in along_v for column in columns]
            pieces |= zip(self.names(name).T.ravel().tolist(), found, strict=True)
        return pieces

    @cached_property
    def orientations(self) -> Mapping[str, int]:
        """As those of the whole faces."""
        whole = self.built.orientations
        return {name: whole[whole_name(name, whole) or name] for name in self.surfaces}


def in_pieces(built: ClosedBody) -> BodyInPieces:
    """The body with its untrimmed faces cut at their creases."""
    cuts = {
        name: (_at_creases(face, "u"), _at_creases(face, "v"))
        for name, face in built.surfaces.items()
        if isinstance(face, Surface)
    }
    return BodyInPieces(built=built, cuts=cuts)


def in_fine_pieces(built: ClosedBody, faces: Collection[str]) -> BodyInPieces:
    """The body with some untrimmed faces also cut into pieces of few knot spans; of two sides, both or none."""
    cuts = dict(in_pieces(built).cuts)
    for name in cuts:
        other = re.sub("upper|lower", lambda found: {"upper": "lower", "lower": "upper"}[found[0]], name)
        if name in faces or other in faces:
            face = cast(Surface, built.surfaces[name])
            cuts[name] = _at_few_spans(face, "u", cuts[name][0]), _at_few_spans(face, "v", cuts[name][1])
    return BodyInPieces(built=built, cuts=cuts)


def whole_name(name: str, faces: Collection[str]) -> str | None:
    """The one of `faces` that has a name, or of which that names a piece; None where there is none."""
    stem = re.sub(r"_[1-9]\d*$", "", name)
    return next((known for known in (name, stem) if known in faces), None)


def creases(face: Surface, direction: Direction) -> list[float]:
    """The knots along u or v across which a first or second derivative jumps.

    It can only at a knot of multiplicity degree - 1 or more; there it is measured from both sides. Where the weights
    vary along that direction, as on the arcs of a surface of revolution, only corners count: the parameter's own
    derivatives jump between arcs, which leaves the surface smooth.
    """
    knots, degree = direction_of(face, direction)
    inner, counts = np.unique(knots[degree + 1 : -degree - 1], return_counts=True)
    ends = breaks(knots).tolist()
    return [
        knot
        for knot, count in zip(inner.tolist(), counts.tolist(), strict=True)
        if count >= degree - 1 and _jumps(face, knot, direction, ends)
    ]


def _jumps(face: Surface, knot: float, direction: Direction, ends: list[float]) -> bool:
    at = ends.index(knot)
    before = piece(face, ends[at - 1], knot, direction)
    after = piece(face, knot, ends[at + 1], direction)
    extent = float(np.ptp(face.control_points, axis=(0, 1)).max())
    if _varies(face.weights, direction):
        one, other = (_derivative(side, knot, direction, 1) for side in (before, after))
        return _largest(np.cross(one, other)) > CREASE * _largest(one) * _largest(other)
    step = min(knot - ends[at - 1], ends[at + 1] - knot)
    for order in (1, 2):
        one, other = (_derivative(side, knot, direction, order) for side in (before, after))
        rounding = ROUNDING * extent / step**order
        if _largest(other - one) > CREASE * (_largest(one) + _largest(other)) + rounding:
            return True
    return False


def _varies(weights: Array | None, direction: Direction) -> bool:
    return weights is not None and bool(np.ptp(weights, axis=0 if direction == "u" else 1).max() > 0.0)


def _derivative(face: Surface, knot: float, direction: Direction, order: int) -> Array:
    """(PLACES, 3) derivatives along u or v at places on the line of a knot."""
    if direction == "u":
        return face.derivative(knot, np.linspace(*face.domain_v, PLACES), order, 0)
    return face.derivative(np.linspace(*face.domain_u, PLACES), knot, 0, order)


def _largest(vectors: Array) -> float:
    return float(np.sqrt(np.max(np.sum(vectors * vectors, axis=-1))))


def _at_creases(face: Surface, direction: Direction) -> tuple[float, ...]:
    first, last = face.domain_u if direction == "u" else face.domain_v
    return first, *creases(face, direction), last


def _at_few_spans(face: Surface, direction: Direction, ends: tuple[float, ...]) -> tuple[float, ...]:
    """Ends of pieces with few knot spans: at creases, along u at the section's joints too, and evenly between them."""
    knots, degree = direction_of(face, direction)
    values, counts = np.unique(knots, return_counts=True)
    most = SPANS_U if direction == "u" else SPANS_V
    if direction == "u" or _varies(face.weights, direction):
        # a third derivative may jump there, or arcs join
        ends = tuple(values[counts >= degree - 2].tolist())
    found = [0]
    for start, end in pairwise(np.searchsorted(values, ends).tolist()):
        count = -(-(end - start) // most)
        found += np.round(np.linspace(start, end, count + 1)).astype(int)[1:].tolist()
    return tuple(values[found].tolist())
