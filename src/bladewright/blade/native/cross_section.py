"""Cross-sections of a fillet: curves from blade to wall about the ball's centre, tangent to both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import Reals, basis

ARC_DEGREE = 8
"""Degree across a fillet: one span of it with exact end tangents is within 1e-9 of the radius of an arc of 120 deg."""
CLAMPED = np.repeat([0.0, 1.0], ARC_DEGREE + 1)
_INNER = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, ARC_DEGREE - 2) / (ARC_DEGREE - 2))
"""s at which an arc is interpolated, besides its ends and their tangents"""


@dataclass(frozen=True, kw_only=True, eq=False)
class CrossSections(FrozenRecord):
    """Cross-sections of a fillet at k sites, s from 0 on the blade to 1 on the wall.

    The conic with the ends B and W, the corner A at which their tangents meet, and the angle w between the normals:

        F(s) = C + [sin((1 - s) w) (B - C) + sin(s w) (W - C)] / sin w,   C = (B + W - (1 + cos w) A) / (1 - cos w),

    which is the arc about the ball's centre where that is one.
    """

    blade: Array
    """B (k, 3) [m]"""
    wall: Array
    """W (k, 3) [m]"""
    normals: tuple[Array, Array]
    """unit normals (k, 3) of blade and wall into the fluid"""
    centre: Array
    """of the ball (k, 3) [m]"""
    sizes: tuple[Array, Array]
    """distances (k,) of the centre from blade and wall [m]"""

    @property
    def angle(self) -> Array:
        """w (k,) [rad]."""
        return np.arccos(dot(*self.normals))

    @property
    def corner(self) -> Array:
        """A (k, 3) [m]: where the tangent planes of blade and wall meet, in the plane of the normals."""
        cosine = dot(*self.normals)
        on_blade, on_wall = self.sizes
        first = (on_wall * cosine - on_blade) / (1.0 - cosine**2)
        second = (on_blade * cosine - on_wall) / (1.0 - cosine**2)
        return self.centre + first[:, None] * self.normals[0] + second[:, None] * self.normals[1]

    def points(self, s: Reals, order: int = 0) -> Array:
        """Points (len(s), k, 3), or derivatives by s."""
        w, cosine = self.angle, dot(*self.normals)[:, None]
        middle = (self.blade + self.wall - (1.0 + cosine) * self.corner) / (1.0 - cosine)
        at = np.asarray(s)[:, None]
        if order == 0:
            first, second = np.sin((1.0 - at) * w) / np.sin(w), np.sin(at * w) / np.sin(w)
        else:
            first, second = -w * np.cos((1.0 - at) * w) / np.sin(w), w * np.cos(at * w) / np.sin(w)
        found = first[..., None] * (self.blade - middle) + second[..., None] * (self.wall - middle)
        return found if order else middle + found

    def net(self) -> Array:
        """Control points (ARC_DEGREE + 1, k, 3) of polynomials of s; the ends and their tangents are exact."""
        start, end = self.points(np.array([0.0, 1.0]), 1) / ARC_DEGREE
        outer = np.stack([self.blade, self.blade + start, self.wall - end, self.wall])
        matrix = basis(CLAMPED, ARC_DEGREE, _INNER)
        right = self.points(_INNER) - np.tensordot(matrix[:, [0, 1, -2, -1]], outer, axes=1)
        inner = np.tensordot(np.linalg.inv(matrix[:, 2:-2]), right, axes=1)
        return np.concatenate([outer[:2], inner, outer[2:]])
