"""Mass, centre and inertia of what is made of one metal: a blade, a row, a sector, a wheel."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.errors import DesignError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign
    from bladewright.nurbs.mass_properties import MassProperties


@dataclass(frozen=True, kw_only=True, eq=False)
class MassReport(FrozenRecord):
    """Mass, centre and inertia; tensors are integrals of density ((x.x) I - x x^T)."""

    density: Array
    """() [kg/m^3]"""
    mass: Array
    """() [kg]"""
    centre: Array
    """(3,) centre of mass [m]"""
    inertia: Array
    """(3, 3) about the centre of mass [kg m^2]"""
    inertia_about_axis: Array
    """(3, 3) about the origin, which lies on the machine axis: its first entry is the moment of inertia about that axis
    [kg m^2]"""

    def to_dict(self) -> dict[str, Any]:
        """All figures, for JSON."""
        units = {"density": "kg_m3", "mass": "kg", "centre": "m", "inertia": "kg_m2", "inertia_about_axis": "kg_m2"}
        return {f"{name}_{unit}": np.real(getattr(self, name)).tolist() for name, unit in units.items()}


class MetalBody:
    """Base of the bodies that have a mass where their design states a density."""

    __slots__ = ()

    @property
    @abstractmethod
    def properties(self) -> MassProperties:
        """Volume, area, centroid and inertia for unit density."""

    @property
    @abstractmethod
    def metal(self) -> RowDesign:
        """The design that states the density."""

    @property
    def mass(self) -> Array:
        """Mass () [kg]. Raises DesignError where the design states no density."""
        return np.asarray(self._density() * self.properties.volume)

    def mass_report(self) -> MassReport:
        """Mass, centre and inertia, also about the machine axis. Raises DesignError without a density."""
        density, found = self._density(), self.properties
        centre, inertia = np.asarray(found.centroid), density * found.inertia
        moved = np.sum(centre * centre) * np.eye(3) - np.outer(centre, centre)
        return MassReport(
            density=density,
            mass=self.mass,
            centre=centre,
            inertia=inertia,
            inertia_about_axis=inertia + self.mass * moved,
        )

    def _density(self) -> Array:
        if self.metal.density is None:
            raise DesignError(
                f"density is missing: the mass of '{self.metal.name}' needs that of the metal; add density = 4430 "
                "[kg/m^3], which is titanium, or 7800, which is steel"
            )
        return np.asarray(self.metal.density)
