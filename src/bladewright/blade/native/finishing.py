"""The finished blade: the plain one, cut and then filleted, each from the blade before it at knots of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.fillet import filleted
from bladewright.blade.native.knots import Knots

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

Finish = Callable[[Blade, "RowDesign", Knots | None], Blade]
"""Makes a blade from the one before, for the design that asks for it, at its own knots where they are held: with
`before` the blade that it was given, and in its knots `before` those of that blade."""


def finishes(design: RowDesign) -> list[Finish]:
    """What a design asks for, in order: cuts of edges, cuts of ends with their clearances, fillets."""
    filleted_at = [design.hub_fillet, design.shroud_fillet]
    return [filleted] if any(each is not None for each in filleted_at) else []


def finished(plain: Blade, design: RowDesign, knots: Knots | None = None) -> Blade:
    """The blade of a design, from the blade of `design.plain`; `knots` hold those of another build of it.

    Raises DesignError where it cannot be cut or filleted as the design asks.
    """
    blade, wanted = plain, finishes(design)
    held = [None] * len(wanted) if knots is None else knots.chain[1:]
    for finish, own in zip(wanted, held, strict=True):
        blade = finish(blade, design, own)
    return blade
