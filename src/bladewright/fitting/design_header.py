"""What a fitted design has besides its shape: a name, a unit and a row."""

from dataclasses import dataclass
from typing import Any, Literal

from bladewright.section.checks import UNITS

Unit = Literal["m", "cm", "mm", "um", "in", "ft"]
Arrangement = Literal["annular", "linear"]


@dataclass(frozen=True, kw_only=True)
class DesignHeader:
    """Name, unit and the row that a blade stands in; None where nobody has said it."""

    name: str
    length_unit: Unit
    pitch: float | None = None
    """[m]"""
    arrangement: Arrangement | None = None
    blade_count: int | None = None

    def row(self, like: Any = None) -> dict[str, Any]:
        """Arrangement, blade count and pitch [m]: those of a given design where they are not stated."""
        stated = {"arrangement": self.arrangement, "blade_count": self.blade_count, "pitch": self.pitch}
        if like is None:
            return stated
        pitch = None if like.pitch is None else like.pitch * UNITS[like.length_unit]
        known = {"arrangement": like.arrangement, "blade_count": like.blade_count, "pitch": pitch}
        return {name: known[name] if value is None else value for name, value in stated.items()}
