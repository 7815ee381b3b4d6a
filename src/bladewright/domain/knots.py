"""Knots of a passage, and all else that is real and held while a design is differentiated."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from bladewright.blade.native.knots import DEGREE, clamped
from bladewright.domain.camber_correspondence import CamberCorrespondence
from bladewright.domain.middle_shift import MiddleShift
from bladewright.domain.walls import CrossLines
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import frozen
from bladewright.nurbs.basis import Reals, greville

Walls = Literal["patches", "trimmed"]
"""What hub and shroud of a passage are made of."""
PIECES = ("inlet", "blade", "outlet")
"""Pieces of a passage's faces along the flow."""
BLADE_AT = (0.25, 0.75)
"""u of the leading and the trailing edge on the passage's faces: a convention, since each piece has knots of its
own."""
MIDDLE = (0.5,)
"""u of inlet and outlet where the halves of the walls meet."""
STRIP_AT = (0.4, 0.6)
"""u of inlet and outlet where a strip between the halves begins and ends: a convention too."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PassageKnots(FrozenRecord):
    """Knots of the passage's faces over [0, 1], and the real numbers that its shape depends on besides the design."""

    length: float
    """mean meridional length of the blade [m], the unit of extents"""
    unit: float
    """how much of the channel's u such a length takes"""
    edges: tuple[float, float]
    """mean u of the blade's edges"""
    upstream: float
    """extent upstream of the leading edge, in mean meridional lengths"""
    downstream: float
    """extent downstream of the trailing edge, in mean meridional lengths"""
    low: float
    """u of the inlet"""
    high: float
    """u of the outlet"""
    start: float
    """u down to which the duct is the channel or flow path; it goes on straight upstream"""
    end: float
    """u up to which it is"""
    noses: tuple[float, float]
    """least and greatest u of the blade"""
    bend: float
    """how much of u the duct takes to straighten there; 0 where it is straight at once"""
    departures: tuple[float, float]
    """o of the walls' halves on hub and shroud: the rate at which cross-lines leave the blade"""
    blunt: tuple[bool, bool]
    """whether a face lies between the sides' ends at the leading, and at the trailing edge"""
    back: float | None
    """u from which the sides themselves form a back face; None where they do not"""
    tail: Reals
    """the blade's own inner knots along u on the back face"""
    cross_lines: CrossLines
    """how cross-lines leave the edges and turn back"""
    reaches: tuple[float, float]
    """shares of the way to inlet and outlet over which the skew of cross-lines fades"""
    correspondence: CamberCorrespondence
    """how periodic boundaries follow the blade's sides"""
    blade: Reals
    """knots beside the blade along u: its own, without a back face, and those that the walls need as well"""
    inlet: Reals
    """knots of the piece upstream of the blade along u"""
    outlet: Reals
    """knots of the piece downstream of the blade along u"""
    across: Reals
    """knots from the blade to a periodic boundary"""
    span: Reals
    """knots of inlet, outlet and periodic boundaries along v"""
    walls: Walls = "patches"
    """whether hub and shroud are untrimmed patches, or trimmed faces of their exact surfaces"""
    shift: MiddleShift | None = None
    """how the periodic boundaries lie beside those of the camber surface, where the blade needs it"""
    straightening: float | None = None
    """share of the ways up- and downstream over which they turn to the meridional direction; None where they do not"""

    def __post_init__(self) -> None:
        for name in (*PIECES, "across", "span", "tail"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    def sites(self, piece: str) -> Reals:
        """Interpolation sites of a piece, or of `across` or `span`, in its own [0, 1]."""
        return greville(getattr(self, piece), DEGREE)

    @cached_property
    def u(self) -> Reals:
        """Knots along the flow: the three pieces, which meet in knots of full multiplicity at the blade's edges."""
        low, high = BLADE_AT
        ends = (0.0, low, high, 1.0)
        parts = [
            start + (end - start) * getattr(self, piece)[DEGREE + 1 : -DEGREE - 1]
            for piece, start, end in zip(PIECES, ends, ends[1:], strict=False)
        ]
        full = [np.full(DEGREE, edge) for edge in BLADE_AT]
        return clamped(np.concatenate([parts[0], full[0], parts[1], full[1], parts[2]]))

    def around(self, edge: int) -> Reals:
        """Knots of inlet (0) or outlet (1) between periodic boundaries, of full multiplicity at creases."""
        inner = self.across[DEGREE + 1 : -DEGREE - 1]
        cuts = self.cuts(edge)
        low, high = cuts[0], cuts[-1]
        full = [np.full(DEGREE, cut) for cut in cuts]
        if self.blunt[edge]:
            full[1:1] = [low + (high - low) * self.strip(edge)[DEGREE + 1 : -DEGREE - 1]]
        return clamped(np.concatenate([low - low * inner[::-1], *full, high + (1.0 - high) * inner]))

    @property
    def side(self) -> Reals:
        """Knots of the blade's sides along u, of full multiplicity where a back face begins."""
        if self.back is None:
            return self.blade
        inner = [self.back * self.blade[DEGREE + 1 : -DEGREE - 1], np.full(DEGREE, self.back)]
        return clamped(np.concatenate([*inner, self.tail[DEGREE + 1 : -DEGREE - 1]]))

    def strip(self, edge: int) -> Reals:
        """Knots across a strip, from lower to upper half: none inside, or those of both sides of a back face."""
        if self.back is None or not edge:
            return clamped(np.empty(0))
        ahead = 0.5 * (self.tail[DEGREE + 1 : -DEGREE - 1] - self.back) / (1.0 - self.back)
        return clamped(np.concatenate([ahead, np.full(DEGREE, 0.5), 1.0 - ahead[::-1]]))

    def cuts(self, edge: int) -> tuple[float, ...]:
        """u of inlet (0) or outlet (1) at which walls have creases: two where the edge is blunt."""
        return STRIP_AT if self.blunt[edge] else MIDDLE
