"""A whole row: one blade, and where each of its copies stands."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from bladewright.blade.native.blade import Blade, Faces
from bladewright.blade.native.mass import MetalBody
from bladewright.domain.blade_body import BladeBody
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array
from bladewright.nurbs.mass_properties import MassProperties, placed
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.transform import transformed
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.section import checks

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign


@dataclass(frozen=True, kw_only=True, eq=False)
class Placement(FrozenRecord):
    """Where a copy of the blade stands: its points are `turn` x + `shift`."""

    name: str
    """`blade_01`, `blade_02`..."""
    turn: Array
    """(3, 3) rotation about the machine axis"""
    shift: Array
    """(3,) along y in a cascade [m]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Row(BladeBody, MetalBody):
    """The blades of a row, one beside the other: one part, `blade_01`, and its placements."""

    shown_as: ClassVar[str] = "row"

    placements: tuple[Placement, ...]
    """of the blade and its copies, a pitch apart, towards larger theta, or y in a cascade"""

    def __repr__(self) -> str:
        return f"<Row '{self.name}': {len(self.placements)} of {self.blade!r}>"

    @property
    def metal(self) -> RowDesign:
        """The design that states the density."""
        return self.blade.design

    @cached_property
    def surfaces(self) -> Faces:
        """The faces of all blades by name, such as `blade_07_upper`; metres."""
        faces: dict[str, Surface | TrimmedSurface] = {}
        for place in self.placements:
            for name, face in self.blade.surfaces.items():
                moved: Any = transformed(face, place.turn, place.shift)  # type: ignore[type-var]
                faces[f"{place.name}_{name}"] = moved
        return FrozenMapping(faces)

    @property
    def orientations(self) -> Mapping[str, int]:
        """+1 for the faces whose dS/du x dS/dv points out of a blade, -1 for the others."""
        own = self.blade.orientations
        return FrozenMapping({f"{place.name}_{name}": sign for place in self.placements for name, sign in own.items()})

    @cached_property
    def properties(self) -> MassProperties:
        """Volume [m^3], area [m^2], centroid [m] and inertia [m^5] of all blades together."""
        turns, shifts = (np.stack([getattr(each, part) for each in self.placements]) for part in ("turn", "shift"))
        return placed(self.blade.properties, turns, shifts)


def row(blade: Blade, blades: int | None = None) -> Row:
    """The row of a blade: all of its blades, or the first `blades` of them.

    A cascade has no end: there `blades` says how many stand beside each other. Raises DesignError where it is missing
    there, or where an annular row has fewer.
    """
    design = blade.design
    if blades is None and design.blade_count is None:
        raise DesignError(f"row: '{design.name}' is a cascade, which has no end: say how many blades, such as blades=5")
    most = design.blade_count or 10_000
    count = most if blades is None else checks.integer("blades", blades, 1, most, "a row has a whole number of blades")
    return Row(blade=blade, placements=tuple(_placement(design, k, count) for k in range(count)))


def blade_name(number: int, count: int) -> str:
    """The name of a blade of a row of `count`, counted from 1: `blade_07`."""
    return f"blade_{number:0{max(2, len(str(count)))}d}"


def of_every_blade(face: str) -> str:
    """The name of a face with an asterisk for its blade's number: `blade_*_upper` of `blade_07_upper`."""
    return re.sub(r"^(blade|hub|shroud)_\d{2,}", r"\1_*", face)


def turn_matrix(theta: complex) -> Array:
    """The rotation (3, 3) about the machine axis by `theta` [rad], which turns z towards y."""
    cos, sin = np.cos(theta), np.sin(theta)
    return np.array([[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]])


def _placement(design: RowDesign, k: int, count: int) -> Placement:
    name = blade_name(k + 1, count)
    if design.blade_count:
        turn = turn_matrix(k * design.spacing) if k else np.eye(3)
        return Placement(name=name, turn=turn, shift=np.zeros(3))
    return Placement(name=name, turn=np.eye(3), shift=k * design.spacing * np.array([0.0, 1.0, 0.0]))
