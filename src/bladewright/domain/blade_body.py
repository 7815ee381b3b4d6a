"""What passage, row, sector and wheel take from the blade that they are made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bladewright.blade.native.blade import Blade
from bladewright.display import Shown
from bladewright.frozen import FrozenRecord


@dataclass(frozen=True, kw_only=True, eq=False)
class BladeBody(FrozenRecord, Shown):
    """Base of the bodies that are made of a blade: its name and the texts for the header of CAD files."""

    dimension: ClassVar[int] = 3

    blade: Blade

    @property
    def name(self) -> str:
        """The blade's name and what this is."""
        return f"{self.blade.name}-{self.shown_as}"

    @property
    def description(self) -> str:
        """One line for the header of CAD files."""
        return self.blade.description

    @property
    def author(self) -> str:
        """For the header of CAD files."""
        return self.blade.author

    @property
    def organisation(self) -> str:
        """For the header of CAD files."""
        return self.blade.organisation
