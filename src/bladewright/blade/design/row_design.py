"""What every design of a blade says of its row: around the machine axis, or side by side in a cascade."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bladewright.errors import DesignError
from bladewright.section import checks

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade
    from bladewright.blade.design.unified import UnifiedBlade


def check_arrangement(design: UnifiedBlade | SectionedBlade) -> None:
    """Refuse what the other arrangement has; bring what this one has to numbers."""
    put = object.__setattr__
    own, other = ("annular", "linear") if design.arrangement == "annular" else ("linear", "annular")
    fields_of = {"annular": ("blade_count", "leading_edge_theta"), "linear": ("pitch", "leading_edge_y")}
    for name in fields_of[other]:
        if getattr(design, name) is not None:
            mine = fields_of[own][fields_of[other].index(name)]
            raise DesignError(f"{name} is given, but arrangement is '{own}': give {mine}, or arrangement = '{other}'")
    count, place = fields_of[own]
    _check_place(design, place, fields_of[other][1])
    if getattr(design, count) is None:
        raise DesignError(f"{count} is missing: arrangement '{own}' needs it")
    if own == "annular":
        put(design, count, checks.integer(count, design.blade_count, 1, 10_000, "a whole number of blades is needed"))
    else:
        put(design, count, checks.number(count, design.pitch))
        checks.between(count, design.pitch, 0.0, float("inf"), "the pitch must be positive")


def _check_place(design: UnifiedBlade | SectionedBlade, place: str, other: str) -> None:
    """Refuse two tangential positions; without any, the leading edge's is 0."""
    stacking = getattr(design, "stacking", None)
    if stacking is None:
        given = getattr(design, place)
        object.__setattr__(design, place, checks.law(place, 0.0 if given is None else given))
        return
    of = {"leading_edge_theta": "theta", "leading_edge_y": "y"}
    if getattr(design, place) is not None:
        raise DesignError(
            f"{place} is given together with stacking, whose {of[place]} places the reference point: leave {place} "
            f"out and give stacking.{of[place]}"
        )
    if getattr(stacking, of[other]) is not None:
        raise DesignError(
            f"stacking.{of[other]} is given, but arrangement is '{design.arrangement}': give stacking.{of[place]}"
        )
