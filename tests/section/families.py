"""Examples of every family that is one part: the members of the shared contract tests.

A family adds its examples to `EXAMPLES`; each is asked the same questions in `test_families.py`.
"""

from dataclasses import dataclass
from typing import Any

from bladewright.section.planar import PlanarSection

from .oval import OVAL


@dataclass(frozen=True, kw_only=True)
class Example:
    """A 2D design, and what its section must have."""

    design: PlanarSection
    metal_angles: tuple[float, float] | None = None
    """[deg] of the built camber line at the leading and the trailing edge"""
    maximum_thickness: float | None = None
    """full thickness across the camber line, of the chord"""
    dead: tuple[str, ...] = ()
    """parameters that rightly have no effect on this example; say why beside it"""

    def part(self) -> Any:
        """The family's parameters."""
        return self.design.section


EXAMPLES: dict[str, Example] = {
    "oval": Example(design=OVAL, metal_angles=None, maximum_thickness=0.12),
}
"""By a name that says what is particular."""
