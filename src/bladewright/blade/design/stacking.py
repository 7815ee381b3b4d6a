"""Stacking by reference point, as a design: the position of one point of each section on its stream surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from bladewright.blade.design.meridional_curve import Meridian, meridian_at
from bladewright.designs import Law, Limits, Part, parameter
from bladewright.errors import DesignError
from bladewright.section import checks

CHORD = Limits(0.0, float("inf"), "a chord must be positive")
FRACTION = Limits(
    low=0.0,
    high=1.0,
    cure="the reference point must lie on the chord line, from 0 at the leading to 1 at the trailing edge",
    closed=True,
)
HUB_PLACES = ("hub_x", "hub_r", "hub_m")
"""The fields of which one may give the hub's reference point."""


@dataclass(frozen=True, kw_only=True)
class Stacking(Part):
    """The reference point of each section, and its position.

    Alone it takes `chord` and one of `line`, `hub_x`, `hub_r` and `hub_m`. Beside prescribed edge curves, which give
    chord and meridional place, it gives the section's position around the axis alone. Voss et al. 2025,
    sections 4.1 and 4.2.
    """

    reference: Literal["leading-edge", "trailing-edge", "centroid", "chord-fraction"] = "centroid"
    """the point of each section that is placed: an end of its chord line, its centre of area in its plane, or the point
    at `chord_fraction` of its chord line"""
    chord_fraction: Law | None = parameter("-", limits=FRACTION, default=None)
    """fraction of the chord line from the leading edge, 0 to 1, where the reference is one [-]"""
    chord: Law | None = parameter("length", limits=CHORD, default=None)
    """chord, times cos(stagger) the meridional length from the leading to the trailing edge on the stream line; in the
    planes of true lengths, (m, r theta), (m, y) and (x, y), the length of the chord line itself [length]"""
    line: Meridian | None = None
    """the stacking line in (x, r), from hub to shroud or past them: each reference point lies where its stream line
    crosses it"""
    hub_x: float | None = parameter("length", default=None)
    """x of the hub's reference point [length]"""
    hub_r: float | None = parameter("length", default=None)
    """r of the hub's reference point, z in a cascade [length]"""
    hub_m: float | None = parameter("length", default=None)
    """meridional length of the hub from its start to its reference point [length]"""
    onwards: Literal["equal-x", "equal-r", "least-distance"] = "equal-x"
    """from the hub's reference point to the others: at its x, at its r, or each nearest to the one below it, which for
    sections without end is the line through the hub's point that crosses all stream lines at right angles"""
    theta: Law | None = parameter("deg", default=None)
    """circumferential position of the reference point, annular; 0 where not given [deg]"""
    y: Law | None = parameter("length", default=None)
    """tangential position of the reference point, linear; 0 where not given [length]"""

    def __post_init__(self) -> None:
        known = ["leading-edge", "trailing-edge", "centroid", "chord-fraction"]
        checks.choice("reference", self.reference, known)
        checks.choice("onwards", self.onwards, ["equal-x", "equal-r", "least-distance"])
        checks.parameters(self)
        if self.line is not None:
            meridian_at("line", self.line)
        self._check_reference()
        places = [name for name in ("line", *HUB_PLACES) if getattr(self, name) is not None]
        if len(places) > 1:
            raise DesignError(
                f"{places[0]} and {places[1]} are both given: one of line, hub_x, hub_r and hub_m says where the "
                "reference points stand; leave the others out"
            )
        if self.onwards != "equal-x" and not self.from_hub:
            raise DesignError(
                f"onwards is '{self.onwards}', but no point at the hub is given to start from: give hub_x, hub_r or "
                "hub_m, or leave onwards out"
            )

    @property
    def from_hub(self) -> bool:
        """Whether the places of the reference points follow from one at the hub."""
        return any(getattr(self, name) is not None for name in HUB_PLACES)

    def check_beside(self, *, edges: bool) -> None:
        """Refuse what contradicts prescribed edge curves, or is missing without them."""
        given = [name for name in ("chord", "line", *HUB_PLACES) if getattr(self, name) is not None]
        if edges and given:
            raise DesignError(
                f"stacking.{given[0]} is given together with leading_edge and trailing_edge: edge curves give the "
                "chord and the meridional place of each section, and stacking beside them its circumferential place "
                f"alone; leave out the edge curves, or {' and '.join(f'stacking.{name}' for name in given)}"
            )
        if not edges and self.chord is None:
            raise DesignError(
                "stacking.chord is missing: without leading_edge and trailing_edge the sections' chords must be given"
            )
        if not edges and len(given) == 1:
            raise DesignError(
                "stacking says nowhere where the reference points stand: give stacking.line, a curve in (x, r), or one "
                "of stacking.hub_x, stacking.hub_r and stacking.hub_m"
            )

    def _check_reference(self) -> None:
        if (self.reference == "chord-fraction") != (self.chord_fraction is not None):
            raise DesignError(
                f"reference is '{self.reference}' and chord_fraction is {self.chord_fraction}: the reference "
                "'chord-fraction', and it alone, takes chord_fraction, a number from 0 at the leading to 1 at the "
                "trailing edge"
            )
