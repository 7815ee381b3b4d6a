"""How far ruled sides are from what the flank of a cylindrical cutter makes."""

from dataclasses import dataclass

import numpy as np

from bladewright.numerics.elementary import cross, dot, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

ENDS = np.array([0.0, 1.0])
SHARES = np.array([0.0, 0.25, 0.5, 0.75])
"""places in each knot span along a side"""


@dataclass(frozen=True, kw_only=True)
class Twist:
    """The largest turn of a side's normal along one of its straight lines, from v = 0 to v = 1."""

    angle: float
    """[rad]"""
    u: float
    side: str
    """`upper` or `lower`"""

    @property
    def cut(self) -> float:
        """Depth to which a cylinder along that line cuts into the side at its ends, of the cylinder's radius [-].

        R (1 - cos(angle / 2)): the cylinder touches the line with its normal amid those of its ends, and beside the
        line the side is taken for flat. Where the angle is nothing all along a side, it is developable.
        """
        return float(1.0 - np.cos(self.angle / 2.0))


def twist_of(sides: tuple[Surface, Surface]) -> Twist:
    """The largest twist of sides whose lines of constant u are straight."""
    found = []
    for name, side in zip(("upper", "lower"), sides, strict=True):
        u = _places(side.knots_u)
        normals = side.normal(u[:, None], ENDS)
        # by both sine and cosine: either alone is inexact near 0 or a quarter turn
        sine, cosine = length(cross(normals[:, 0], normals[:, 1])), dot(normals[:, 0], normals[:, 1])
        angles = np.arctan2(sine, cosine)  # real: measured on the real surfaces
        worst = int(np.argmax(angles))
        found.append(Twist(angle=float(angles[worst]), u=float(u[worst]), side=name))
    return max(found, key=lambda each: each.angle)


def _places(knots: Reals) -> Reals:
    spans = np.unique(knots)
    return np.append((spans[:-1, None] + np.diff(spans)[:, None] * SHARES).ravel(), spans[-1])
