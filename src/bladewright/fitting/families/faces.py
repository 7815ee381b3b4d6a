"""The sides of sections with a blunt edge, each with its half of the straight face: together they close the outline.

A side and half a face are one curve with a corner, so that the nearest place of a point may lie on either.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.feet import Feet
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.section.section import Section

SHARE = 0.02
"""part of the parameter that half a face takes"""
Blunt = tuple[bool, bool]
"""whether the leading and the trailing edge are blunt"""


def closed_knots(knots: Reals, degree: int, blunt: Blunt) -> Reals:
    """Knots of a side with half a face at its blunt edges, from those of the side over [0, 1]."""
    low, high = bounds_of(blunt)
    inner = low + (high - low) * knots[degree + 1 : -degree - 1]
    corner = [np.full(degree, at) if is_blunt else np.empty(0) for at, is_blunt in zip((low, high), blunt, strict=True)]
    return np.concatenate([np.zeros(degree + 1), corner[0], inner, corner[1], np.ones(degree + 1)])


def closed_nets(upper: Array, lower: Array, degree: int, blunt: Blunt) -> tuple[Array, Array]:
    """Control points (..., n, d) of both sides with half a face at their blunt edges."""
    found = []
    for side, other in ((upper, lower), (lower, upper)):
        parts = [side]
        for end, is_blunt in enumerate(blunt):
            if is_blunt:
                at = (0, -1)[end]
                corner = side[..., at, :][..., None, :]
                middle = 0.5 * (corner + other[..., at, :][..., None, :])
                steps = (np.arange(1, degree + 1) / degree)[:, None]
                face = corner + steps * (middle - corner)
                parts = [face[..., ::-1, :], *parts] if end == 0 else [*parts, face]
        found.append(np.concatenate(parts, axis=-2))
    return found[0], found[1]


def bounds_of(blunt: Blunt) -> tuple[float, float]:
    """Where the side itself begins and ends."""
    return (SHARE if blunt[0] else 0.0), (1.0 - SHARE if blunt[1] else 1.0)


def closed_sides(section: Section) -> tuple[Curve, Curve]:
    """The sides of a section with the halves of the faces of its blunt edges."""
    upper, lower, blunt = section.curves["upper"], section.curves["lower"], blunt_of(section.edges)
    if not any(blunt):
        return upper, lower
    knots = closed_knots(upper.knots, upper.degree, blunt)
    nets = closed_nets(upper.control_points, lower.control_points, upper.degree, blunt)
    first, last = (Curve(control_points=net, knots=knots, degree=upper.degree) for net in nets)
    return first, last


def blunt_of(edges: Sequence[str]) -> Blunt:
    """Which of two edges are blunt."""
    return edges[0] == "blunt", edges[1] == "blunt"


def on_sides(on: Feet, edges: Sequence[str]) -> tuple[Feet, NDArray[np.intp]]:
    """Feet by the parameters of the sides themselves, and -1 where one is on the leading, 1 on the trailing face."""
    low, high = bounds_of(blunt_of(edges))
    faces = np.where(on.u < low, -1, np.where(on.u > high, 1, 0))
    return replace(on, u=np.clip((on.u - low) / (high - low), 0.0, 1.0)), faces
