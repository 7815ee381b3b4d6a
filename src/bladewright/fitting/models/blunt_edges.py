"""The sides of sections and blades with blunt edges, each with its half of the edge's face: they close the outline.

A side and half a face are one curve, or surface, with a corner, so that a point's nearest place may lie on either.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import comb

from bladewright.blade.native.blade import Blade
from bladewright.fitting.free_parameters import EDGES
from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.section.section import Section

FACE_SHARE = 0.02
"""share of a side's parameter that half a face takes, which changes no shape (design/matching_constants.md)"""
BluntEdges = tuple[bool, bool]
"""whether the leading and the trailing edge are blunt"""


def closed_knots(knots: Reals, degree: int, blunt: BluntEdges) -> Reals:
    """Knots of a side with half a face at its blunt edges, from those of the side over [0, 1]."""
    low, high = side_bounds(blunt)
    inner = low + (high - low) * knots[degree + 1 : -degree - 1]
    corner = [np.full(degree, at) if is_blunt else np.empty(0) for at, is_blunt in zip((low, high), blunt, strict=True)]
    return np.concatenate([np.zeros(degree + 1), corner[0], inner, corner[1], np.ones(degree + 1)])


def closed_nets(upper: Array, lower: Array, degree: int, blunt: BluntEdges) -> tuple[Array, Array]:
    """Control points (..., n, d) of both sides with half a face at their blunt edges."""
    steps = (np.arange(1, degree + 1) / degree)[:, None]
    found = []
    for side, other in ((upper, lower), (lower, upper)):
        corners = [(side[..., [at], :], other[..., [at], :]) for at in (0, -1)]
        first, last = (corner + steps * (0.5 * (corner + across) - corner) for corner, across in corners)
        parts = [*[first[..., ::-1, :]] * blunt[0], side, *[last] * blunt[1]]
        found.append(np.concatenate(parts, axis=-2))
    return found[0], found[1]


def side_bounds(blunt: BluntEdges) -> tuple[float, float]:
    """Parameters at which the side itself begins and ends."""
    return (FACE_SHARE if blunt[0] else 0.0), (1.0 - FACE_SHARE if blunt[1] else 1.0)


def closed_with(upper: Surface, lower: Surface, faces: Mapping[str, Surface]) -> tuple[Surface, Surface]:
    """Two sides of a blade with the halves of the faces of its blunt edges, given by name."""
    if not faces:
        return upper, lower
    knots = closed_knots(upper.knots_u, upper.degree_u, ("leading_edge" in faces, "trailing_edge" in faces))
    found = []
    for side, step in ((upper, 1), (lower, -1)):
        net = side.control_points
        for name, face in faces.items():
            half = _first_half(face.control_points[::step])
            net = np.concatenate([half[:0:-1], net] if name == "leading_edge" else [net, half[1:]])
        found.append(replace(side, control_points=net, knots_u=knots))
    return found[0], found[1]


def _first_half(net: Reals) -> Reals:
    """The first half of a polynomial with control points (n, ...), by de Casteljau's construction."""
    number = np.arange(len(net))
    return np.tensordot(comb(number[:, None], number) / 2.0 ** number[:, None], net, axes=1)


def sides_of(built: Blade | Section) -> tuple[Curve, Curve] | tuple[Surface, Surface]:
    """The sides of what is built with the halves of the faces of its blunt edges."""
    if isinstance(built, Blade):
        faces = {name: face for name in EDGES if isinstance(face := built.surfaces.get(name), Surface)}
        return closed_with(*built.sides, faces)
    upper, lower, blunt = built.curves["upper"], built.curves["lower"], blunt_edges_of(built)
    if not any(blunt):
        return upper, lower
    knots = closed_knots(upper.knots, upper.degree, blunt)
    nets = closed_nets(upper.control_points, lower.control_points, upper.degree, blunt)
    first, last = (Curve(control_points=net, knots=knots, degree=upper.degree) for net in nets)
    return first, last


def blunt_edges_of(built: Blade | Section) -> BluntEdges:
    """Which edges of what is built are blunt."""
    if isinstance(built, Blade):
        return "leading_edge" in built.surfaces, "trailing_edge" in built.surfaces
    return built.edges[0] == "blunt", built.edges[1] == "blunt"


def on_sides(footpoints: Footpoints, blunt: BluntEdges) -> tuple[Footpoints, NDArray[np.intp]]:
    """Footpoints by the sides' own parameters, and -1 for those on the leading face, 1 on the trailing face, 0 else."""
    low, high = side_bounds(blunt)
    faces = np.where(footpoints.u < low, -1, np.where(footpoints.u > high, 1, 0))
    return replace(footpoints, u=np.clip((footpoints.u - low) / (high - low), 0.0, 1.0)), faces
