"""The finished blade: the plain one, cut and then filleted, each from the blade before it at knots of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.edge_cut import cut_edges
from bladewright.blade.native.end_cut import cut_ends
from bladewright.blade.native.fillet import filleted
from bladewright.blade.native.knots import Knots
from bladewright.blade.native.side_corners import side_corner
from bladewright.blade.native.stepped_fillet import SteppedFillets
from bladewright.errors import DesignError

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign


class Finish(Protocol):
    """Cuts or fillets a blade."""

    def __call__(self, blade: Blade, design: RowDesign, knots: Knots | None, *, fine: bool) -> Blade:
        """The blade from the one before, for the design that asks for it, at its own knots where they are held.

        Its `before` is the blade that it was given, and the `before` of its knots those of that blade.
        """


def finishes(design: RowDesign) -> list[Finish]:
    """What a design asks for, in order: cuts of edges, cuts of ends with their clearances, fillets."""
    wanted: list[Finish] = []
    cut = design.cut
    if cut is not None and (cut.leading_edge is not None or cut.trailing_edge is not None):
        wanted.append(cut_edges)
    if cut is not None and (cut.hub is not None or cut.tip is not None):
        wanted.append(cut_ends)
    if design.hub_fillet is not None or design.shroud_fillet is not None:
        wanted.append(_filleted)
    return wanted


def _filleted(blade: Blade, design: RowDesign, knots: Knots | None, *, fine: bool) -> Blade:
    """The same as `filleted`; where a side has a corner, an error says so, as that may be what stops the ball."""
    try:
        return filleted(blade, design, knots, fine=fine)
    except DesignError as error:
        corner = side_corner(blade)
        if corner is None:
            raise
        side, u, angle = corner
        raise DesignError(
            f"{error}. The {side} side has a corner of {np.degrees(angle):.2g} deg at u = {u:.3f}, over which no ball "
            "rolls: the curvature of the sections' mean line jumps there. Take one without a jump (camber_position = "
            "0.5 with naca-4, or another profile)"
        ) from error


def finished(plain: Blade, design: RowDesign, knots: Knots | None = None, *, fine: bool = False) -> Blade:
    """The blade of a design, from the blade of `design.plain`; `knots` hold those of another build of it.

    Raises DesignError where it cannot be cut or filleted as the design asks.
    """
    wanted = finishes(design)
    held = [None] * len(wanted) if knots is None else knots.chain[1:]
    return _after(plain, design, list(zip(wanted, held, strict=True)), fine=fine)


def _after(
    blade: Blade, design: RowDesign, finishes: Sequence[tuple[Finish, Knots | None]], *, fine: bool = False
) -> Blade:
    for finish, own in finishes:
        blade = finish(blade, design, own, fine=fine)
    return blade


def stepped_finishes(base: Blade) -> Callable[[Sequence[Blade], Sequence[RowDesign]], list[Blade]]:
    """Finishes plain blades that carry a complex step each, as their designs ask, at the knots of `base`.

    They are cut one by one, and get their fillets all at once.
    """
    wanted = list(zip(finishes(base.design), base.knots.chain[1:], strict=True))
    fillets = SteppedFillets(base) if wanted[-1][0] is _filleted else None
    cuts = wanted if fillets is None else wanted[:-1]

    def finish(plains: Sequence[Blade], designs: Sequence[RowDesign]) -> list[Blade]:
        cut = [_after(*each, cuts) for each in zip(plains, designs, strict=True)]
        return cut if fillets is None else fillets(cut, designs)

    return finish
