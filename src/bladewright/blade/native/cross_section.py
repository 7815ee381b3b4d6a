"""Cross-sections of a fillet: curves from blade to wall about the ball's centre, tangent to both."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import Reals, basis

ARC_DEGREE = 8
"""Degree across a fillet: one span of it with exact end tangents is within 1e-9 of the radius of an arc of 120 deg."""
_CLAMPED = np.repeat([0.0, 1.0], ARC_DEGREE + 1)
QUINTIC = 5
"""Degree of a cross-section with point, tangent and curvature at both ends."""
Bend = Callable[[Array], Array]
"""Second derivatives (k,) of cross-sections along a normal, from their first (k, 3)."""
_INNER = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, ARC_DEGREE - 2) / (ARC_DEGREE - 2))
"""s at which an arc is interpolated, besides its ends and their tangents"""


@dataclass(frozen=True, kw_only=True, eq=False)
class CrossSections(FrozenRecord, ABC):
    """Cross-sections of a fillet at k sites, s from 0 on the blade to 1 on the wall."""

    blade: Array
    """where they leave the blade (k, 3) [m]"""
    wall: Array
    """where they reach the wall (k, 3) [m]"""
    normals: tuple[Array, Array]
    """unit normals (k, 3) of blade and wall into the fluid"""
    centre: Array
    """of the ball (k, 3) [m]"""
    sizes: tuple[Array, Array]
    """distances (k,) of the centre from blade and wall [m]"""

    @property
    def angle(self) -> Array:
        """w (k,) between the normals [rad]."""
        return np.arccos(dot(*self.normals))

    @abstractmethod
    def points(self, s: Reals, order: int = 0) -> Array:
        """Points (len(s), k, 3), or first derivatives by s."""

    @abstractmethod
    def net(self) -> Array:
        """Control points (n, k, 3) of one polynomial of s each, whose ends and end tangents are exact."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class ConicSections(CrossSections):
    """Arcs about the ball's centre, or of ellipses.

    The conic with the ends B and W, the corner A at which their tangents meet, and the angle w between the normals:

        F(s) = C + [sin((1 - s) w) (B - C) + sin(s w) (W - C)] / sin w,   C = (B + W - (1 + cos w) A) / (1 - cos w),

    which is the arc about the ball's centre where that is one.
    """

    @property
    def corner(self) -> Array:
        """A (k, 3) [m]: where the tangent planes of blade and wall meet, in the plane of the normals."""
        cosine = dot(*self.normals)
        on_blade, on_wall = self.sizes
        first = (on_wall * cosine - on_blade) / (1.0 - cosine**2)
        second = (on_blade * cosine - on_wall) / (1.0 - cosine**2)
        return self.centre + first[:, None] * self.normals[0] + second[:, None] * self.normals[1]

    def curved(self, of_blade: Bend, of_wall: Bend) -> QuinticSections:
        """Those with the same ends and end tangents, and the curvatures of blade and wall there.

        Both give d2F/ds2 along their normals (k,) from dF/ds (k, 3).
        """
        start, end = self.points(np.array([0.0, 1.0]), 1)
        return QuinticSections(
            blade=self.blade,
            wall=self.wall,
            normals=self.normals,
            centre=self.centre,
            sizes=self.sizes,
            slopes=(start, end),
            bends=(of_blade(start), of_wall(end)),
        )

    def points(self, s: Reals, order: int = 0) -> Array:
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
        start, end = self.points(np.array([0.0, 1.0]), 1) / ARC_DEGREE
        outer = np.stack([self.blade, self.blade + start, self.wall - end, self.wall])
        matrix = basis(_CLAMPED, ARC_DEGREE, _INNER)
        right = self.points(_INNER) - np.tensordot(matrix[:, [0, 1, -2, -1]], outer, axes=1)
        inner = np.tensordot(np.linalg.inv(matrix[:, 2:-2]), right, axes=1)
        return np.concatenate([outer[:2], inner, outer[2:]])


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class QuinticSections(CrossSections):
    """Quintic Hermite curves that leave blade and wall as the arcs do, with the surfaces' own curvatures there."""

    slopes: tuple[Array, Array]
    """dF/ds (k, 3) on blade and wall [m]"""
    bends: tuple[Array, Array]
    """d2F/ds2 along the normals (k,) [m]"""

    def points(self, s: Reals, order: int = 0) -> Array:
        return np.asarray(
            np.tensordot(basis(np.repeat([0.0, 1.0], QUINTIC + 1), QUINTIC, s, order), self.net(), axes=1)
        )

    def net(self) -> Array:
        (start, end), pairs = self.slopes, zip(self.bends, self.normals, strict=True)
        first, last = (bend[:, None] * normal / (QUINTIC * (QUINTIC - 1)) for bend, normal in pairs)
        start, end = start / QUINTIC, end / QUINTIC
        near = [self.blade, self.blade + start, self.blade + 2.0 * start + first]
        return np.stack([*near, self.wall - 2.0 * end + last, self.wall - end, self.wall])
