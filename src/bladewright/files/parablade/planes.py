"""A ParaBlade design's sections, brought to the planes in which the unified family has its own."""

from dataclasses import dataclass

import numpy as np

from bladewright.files.parablade.config import Config
from bladewright.files.parablade.shape import Shape, shape_at, side_basis
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.camber import bernstein, camber_points

SAMPLES = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 121))) / 2.0
"""places along the sides at which they are matched, dense at the edges"""


@dataclass(frozen=True, kw_only=True)
class Planes:
    """Sections at v (m,) whose camber lines run from (0, 0) to abscissa 1."""

    v: Reals
    camber: Reals
    """(m, 4, 2) control points"""
    upper: Reals
    """(m, k, 2) points"""
    lower: Reals
    """(m, k, 2) points"""
    radii: tuple[Reals, Reals]
    """(m,) of curvature at leading and trailing edge"""


def stretched(shape: Shape, factors: Reals) -> Planes:
    """Sections whose ordinates are multiplied by factors (m,)."""
    stretch = np.stack([np.ones_like(factors), factors], axis=-1)[:, None, :]
    sides = [side * stretch for side in shape.sides]
    return _planes(shape.v, shape.camber * stretch, sides, [side_basis(SAMPLES) @ side for side in sides])


def averaged(config: Config) -> tuple[Planes, Reals, float]:
    """The one section of a design in two dimensions, its leading edge (2,) [m] and its axial chord [m]."""
    shape = shape_at(config, np.zeros(1))
    u = SAMPLES
    # the channel is straight but for odd files, and then the mean of both ends is a Bezier curve again
    line = np.linalg.lstsq(bernstein(u), shape.points(camber_points(shape.camber, u)), rcond=None)[0]
    start, extent = line[0], float(line[3, 0] - line[0, 0])
    points = [(shape.points(side_basis(SAMPLES) @ side) - start) / extent for side in shape.sides]
    sides = [((shape.points(side) - start) / extent)[None] for side in shape.sides]
    found = _planes(np.zeros(1), (line - start)[None] / extent, sides, [each[None] for each in points])
    return found, start, extent


def _planes(v: Reals, camber: Reals, sides: list[Reals], points: list[Reals]) -> Planes:
    radii = []
    for end in (0.0, 1.0):
        rows = [basis(uniform_knots(sides[0].shape[1], 3), 3, np.array([end]), order)[0] for order in (1, 2)]
        bends = []
        for side in sides:
            first, second = (np.einsum("i,mid->md", row, side) for row in rows)
            turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
            bends.append(np.sqrt(turn**2) / np.sum(first**2, axis=-1) ** 1.5)
        radii.append(2.0 / (bends[0] + bends[1]))
    return Planes(v=v, camber=camber, upper=points[0], lower=points[1], radii=(radii[0], radii[1]))
