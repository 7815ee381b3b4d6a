"""Reference points of sections: the point of each that is placed in its flow path."""

import numpy as np

from bladewright.blade.stacking import Stacking
from bladewright.numerics.elementary import Array, joined
from bladewright.numerics.quadrature import gauss, panels, settled
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.outline import Outline

PIECES = 6
"""pieces in equal steps that a side is cut into besides its joints"""


def reference_points(stacking: Stacking | None, outline: Outline, span: Span) -> Array:
    """Points (..., m, 2) of the sections in chords, unstaggered; the leading edge where there is no stacking."""
    which = "leading-edge" if stacking is None else stacking.reference
    if which == "centroid":
        return centroid(outline)
    ends = {"leading-edge": 0.0, "trailing-edge": 1.0}
    along = np.full(len(span.v), ends[which]) if which in ends else _fraction(stacking, span)
    return np.stack([along, np.zeros_like(along)], axis=-1)


def _fraction(stacking: Stacking | None, span: Span) -> Array:
    law = None if stacking is None else stacking.chord_fraction
    return span.values(0.0 if law is None else law)


def centroid(outline: Outline) -> Array:
    """Centres of area (..., 2) of sections in their planes, in chords, by Green's theorem and Gauss quadrature.

    Each side is the polynomial through the Gauss points of a panel, whose order is raised until the centre moves by
    less than 1e-13.
    """
    return settled(lambda order: _centroid(outline, order))


def _centroid(outline: Outline, order: int) -> Array:
    breaks = np.unique([*np.linspace(0.0, 1.0, PIECES + 1), *(joint.s for joint in outline.joints)])
    s, weights = panels(breaks, order)
    slopes = _slopes(order)
    widths = np.diff(breaks)[:, None, None]
    upper, lower = outline.points(s)
    area: Array = np.zeros(())
    first: Array = np.zeros(())
    second: Array = np.zeros(())
    for side, sign in ((upper, 1.0), (lower, -1.0)):
        pieces = side.reshape(*side.shape[:-2], len(breaks) - 1, order, 2)
        rates = ((slopes @ pieces) / widths).reshape(side.shape)
        x, y = side[..., 0], side[..., 1]
        area = area + sign * np.sum(weights * (x * rates[..., 1] - y * rates[..., 0]), axis=-1) / 2.0
        first = first + sign * np.sum(weights * x**2 * rates[..., 1], axis=-1) / 2.0
        second = second - sign * np.sum(weights * y**2 * rates[..., 0], axis=-1) / 2.0
    for start, end in _faces(outline):
        a, b = np.moveaxis(start, -1, 0), np.moveaxis(end, -1, 0)
        step = b - a
        area = area + (a[0] * b[1] - a[1] * b[0]) / 2.0
        first = first + step[1] * (a[0] ** 2 + a[0] * b[0] + b[0] ** 2) / 6.0
        second = second - step[0] * (a[1] ** 2 + a[1] * b[1] + b[1] ** 2) / 6.0
    return joined([(first / area)[..., None], (second / area)[..., None]], axis=-1)


def _faces(outline: Outline) -> list[tuple[Array, Array]]:
    """Ends (..., 2) of the straight faces of blunt edges, round the section as the upper side runs."""
    first, last = outline.leading_edge, outline.trailing_edge
    found = [(last.upper.point, last.lower.point)] if last.kind == "blunt" else []
    return found + ([(first.lower.point, first.upper.point)] if first.kind == "blunt" else [])


def _slopes(order: int) -> Reals:
    """Derivatives (order, order) at Gauss points of [0, 1] of the polynomial through values there, barycentric."""
    nodes = gauss(order)[0]
    apart = nodes[:, None] - nodes + np.eye(order)
    shares = 1.0 / np.prod(4.0 * apart, axis=1)
    matrix = shares / shares[:, None] / apart
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -np.sum(matrix, axis=1))
    return matrix
