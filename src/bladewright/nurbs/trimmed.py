"""A piece of a surface inside closed boundary curves in its parameter plane."""

from dataclasses import dataclass

from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface


@dataclass(frozen=True, kw_only=True, eq=False)
class TrimmedSurface:
    """The part of `surface` to the left of `boundary`, a closed chain of curves in (u, v) run counter-clockwise."""

    surface: Surface
    """the untrimmed surface"""
    boundary: tuple[Curve, ...]
    """curves of dimension 2, each ending where the next one starts"""
