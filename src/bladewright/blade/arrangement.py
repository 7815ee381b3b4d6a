"""What a design of a blade says of its row: around the machine axis, or side by side in a cascade."""

from typing import TYPE_CHECKING

from bladewright.errors import DesignError
from bladewright.section import checks

if TYPE_CHECKING:
    from bladewright.blade.sectioned import SectionedBlade
    from bladewright.blade.unified import UnifiedBlade


def check_arrangement(design: "UnifiedBlade | SectionedBlade") -> None:
    """Refuse what the other arrangement has; bring what this one has to numbers."""
    put = object.__setattr__
    own, other = ("annular", "linear") if design.arrangement == "annular" else ("linear", "annular")
    fields_of = {"annular": ("blade_count", "leading_edge_theta"), "linear": ("pitch", "leading_edge_y")}
    for name in fields_of[other]:
        if getattr(design, name) is not None:
            mine = fields_of[own][fields_of[other].index(name)]
            raise DesignError(f"{name} is given, but arrangement is '{own}': give {mine}, or arrangement = '{other}'")
    count, place = fields_of[own]
    if getattr(design, count) is None:
        raise DesignError(f"{count} is missing: arrangement '{own}' needs it")
    put(design, place, checks.law(place, 0.0 if getattr(design, place) is None else getattr(design, place)))
    if own == "annular":
        put(design, count, checks.integer(count, design.blade_count, 1, 10_000, "a whole number of blades is needed"))
    else:
        put(design, count, checks.number(count, design.pitch))
        checks.between(count, design.pitch, 0.0, float("inf"), "the pitch must be positive")
