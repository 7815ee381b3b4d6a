"""Which parameters of a design a fit may change, whatever its structure."""

from collections.abc import Mapping
from dataclasses import dataclass

from bladewright.blade.unified import UnifiedBlade
from bladewright.derivatives.patterns import Patterns, chosen, matching
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.families.standing import standing

GIVEN = ("pitch", "span", "tip_clearance", "hub_clearance")
"""fields that a cloud of one blade's points says nothing of"""


@dataclass(frozen=True, kw_only=True)
class Freedom:
    """Patterns of what is free, and of what is held at which values."""

    free: Patterns = None
    fixed: tuple[str, ...] = ()
    values: Mapping[str, float] | None = None
    walls: bool = False
    """whether hub and shroud of a blade from sections are found too"""

    def __call__(self, design: Design) -> tuple[str, ...]:
        """The free parameters of a design; raises FitError where there are none."""
        try:
            wanted = chosen(design, self.free)
            held = {path for pattern in self.fixed for path in matching(pattern, design.parameters())}
        except DesignError as error:
            raise FitError(str(error)) from error
        if self.free is None:
            held |= standing(design, walls=self.walls) | {path for path in wanted if path.startswith(GIVEN)}
        found = tuple(path for path in wanted if path not in held)
        if not found:
            raise FitError("no parameter is left to fit: free at least one, or fix fewer")
        return found

    def applied(self, design: Design) -> Design:
        """The design with the values that are given."""
        if not self.values:
            return design
        try:
            known = list(design.parameters())
            changes = {path: value for pattern, value in self.values.items() for path in matching(pattern, known)}
            return design.changed(changes)
        except DesignError as error:
            raise FitError(str(error)) from error


def freedom_of(free: Patterns, fixed: "Patterns | Mapping[str, float]", *, started: bool) -> Freedom:
    """The freedom that was asked for; raises FitError where what is held has no value."""
    if isinstance(fixed, Mapping):
        return Freedom(free=free, fixed=tuple(fixed), values=dict(fixed))
    names = () if fixed is None else (fixed,) if isinstance(fixed, str) else tuple(fixed)
    if (names or free is not None) and not started:
        held = names[0] if names else "what is not free"
        raise FitError(f"{held} is to be held, but has no value: give a start design, or the value itself")
    return Freedom(free=free, fixed=names)


def corner_radii(design: Design) -> tuple[str, ...]:
    """Paths of the radii at which the edges of a blade stand on hub and shroud."""
    if not isinstance(design, UnifiedBlade):
        return ()
    last = {edge: len(getattr(design.channel, edge)) - 1 for edge in ("leading_edge", "trailing_edge")}
    return tuple(f"channel.{edge}[{place}].r" for edge, end in last.items() for place in (0, end))
