"""What every design of a blade has: its row, around the machine axis or side by side in a cascade, and its build."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np

from bladewright.blade.design.cut import Cut
from bladewright.blade.design.disc import Disc
from bladewright.blade.design.fillet import Fillet
from bladewright.blade.design.spanwise_steps import SpanwiseStep
from bladewright.designs import Design, Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.section import checks
from bladewright.section.unified_limits import check_labels, check_range

if TYPE_CHECKING:
    from bladewright.blade.exact.exact_blade import ExactBlade
    from bladewright.blade.native.blade import Blade
    from bladewright.blade.native.knots import Knots

LengthUnit = Literal["m", "cm", "mm", "um", "in", "ft"]
Arrangement = Literal["annular", "linear"]
BLADES = Limits(1, 10_000, "a whole number of blades is needed (1 to 10000)", closed=True)
DENSITY = Limits(0.0, float("inf"), "a density must be positive")
FIELDS_OF = {"annular": ("blade_count", "leading_edge_theta"), "linear": ("pitch", "leading_edge_y")}
"""The fields that an arrangement alone has: how far apart blades stand, and where the leading edge does."""

DISCS = {"disc": Disc, "shroud_ring": Disc}
"""The fields that hold what carries or joins the blades."""

TURNS = {"clockwise": -1, "counterclockwise": 1, "none": 0}
"""Towards which theta, or y in a cascade, a row of each `rotation` moves: theta turns z towards y, which to an observer
upstream, who looks along +x with z up, is the way to the left."""


@dataclass(frozen=True, kw_only=True)
class RowDesign(Design):
    """Base of the designs of blades: the row that the blade stands in, its tolerance, and its labels.

    A final subclass adds the parameters of its family, and says which exact blade they define.
    """

    dimension: ClassVar[int] = 3

    name: str
    """the part's name, used in files"""
    length_unit: LengthUnit
    """unit of every length in the design"""
    arrangement: Arrangement = "annular"
    """blades around the machine axis, or side by side in a cascade"""
    blade_count: int | None = field(default=None, metadata={"limits": BLADES})
    """number of blades of an annular row [-]"""
    pitch: float | None = parameter("length", default=None)
    """tangential distance of neighbours in a linear cascade [length]"""
    rotation: Literal["clockwise", "counterclockwise", "none"] | None = None
    """how the row turns, seen from upstream: clockwise is towards -theta, counterclockwise towards +theta (-y, +y in a
    cascade), none of a vane; left out where it is not known"""
    leading_edge_theta: Law | None = parameter("deg", default=None)
    """circumferential position of the leading edge, annular; 0 where neither it nor a stacking is given [deg]"""
    leading_edge_y: Law | None = parameter("length", default=None)
    """tangential position of the leading edge, linear; 0 where neither it nor a stacking is given [length]"""
    tip_clearance: float | tuple[float, float] | None = parameter("length", default=None)
    """meridional distance of the blade's end from the shroud, at leading and trailing edge where two [length]"""
    hub_clearance: float | tuple[float, float] | None = parameter("length", default=None)
    """meridional distance of the blade's end from the hub, at leading and trailing edge where two [length]"""
    density: float | None = parameter("kg/m^3", limits=DENSITY, default=None)
    """density of the metal, for masses [kg/m^3]"""
    cut: Cut | None = None
    """what is cut off the blade"""
    hub_fillet: Fillet | None = None
    """the fillet between blade and hub"""
    shroud_fillet: Fillet | None = None
    """the fillet between blade and shroud"""
    disc: Disc | None = None
    """what carries the blades under the hub"""
    shroud_ring: Disc | None = None
    """what joins the blades around the shroud"""
    tolerance: float = 1e-6
    """largest distance of the native surfaces from the exact blade, of the chord [-]"""
    description: str = ""
    """one line for the header of CAD files"""
    author: str = ""
    """for the header of CAD files"""
    organisation: str = ""
    """for the header of CAD files"""

    def spanwise_steps(self) -> Iterator[SpanwiseStep]:
        """Steps of parameters that shape the exact section at v by their weights at v alone."""
        yield from ()

    def __post_init__(self) -> None:
        check_labels(self)
        checks.choice("arrangement", self.arrangement, list(FIELDS_OF))
        if self.rotation is not None:
            checks.choice("rotation", self.rotation, list(TURNS))
        self._check_arrangement()
        self._check_clearances()
        self._check_parts()
        check_range(self, "tolerance", 1e-9, 1e-2)

    @property
    def plain(self) -> Self:
        """The design of the blade before cuts and fillets: itself, where there are none.

        A clearance at an end that is cut keeps its distance from the cut, so that the plain blade has none.
        """
        names = ["cut", "hub_fillet", "shroud_fillet"]
        if self.cut is not None:
            names += ["hub_clearance"] if self.cut.hub is not None else []
            names += ["tip_clearance"] if self.cut.tip is not None else []
        given = [name for name in names if getattr(self, name) is not None]
        return self.changed(dict.fromkeys(given)) if given else self

    @property
    def ends(self) -> tuple[str, str]:
        """Names of the blade's ends at v = 0 and v = 1: `hub` and `shroud`, or `tip` where there is a clearance."""
        hub = "hub" if self.hub_clearance is None else "tip"
        return hub, "shroud" if self.tip_clearance is None else "tip"

    @property
    def law_ends(self) -> tuple[str, str]:
        """What the laws' and the sections' span fractions 0 and 1 are called: the blade's own ends."""
        return self.ends

    @property
    def metre(self) -> float:
        """Metres in the design's unit of length."""
        return checks.UNITS[self.length_unit]

    @property
    def spacing(self) -> Any:
        """From one blade to the next: angle [rad], or distance along y [m] in a cascade; complex where `pitch` is."""
        return 2.0 * np.pi / self.blade_count if self.blade_count else self.metre * np.asarray(self.pitch)

    @property
    def turns(self) -> int:
        """+1 where the row turns towards larger theta, or y, -1 towards smaller, 0 where it stands or is not known."""
        return TURNS[self.rotation or "none"]

    @abstractmethod
    def exact_blade(self, knots: Knots | None = None) -> ExactBlade:
        """The blade that the design defines, in metres and radians, which native surfaces interpolate.

        `knots` are those that a build holds. Raises DesignError where there is no such blade.
        """

    @abstractmethod
    def needs_own_search(self, paths: Iterable[str]) -> bool:
        """Whether a real change of these parameters moves what is found by a search for one real design at a time."""

    def build(self, knots: Knots | None = None, *, fine: bool = False) -> Blade:
        """The native blade in metres; `knots=blade.knots` holds another build's knots and interpolation sites.

        With `fine` its ends lie within 1e-7 mm of hub and shroud, the smallest tolerance of CAD programs, where 1e-7 of
        the chord is the rule; it takes up to 1.7 times the control points along the chord.
        Raises DesignError where the shape is impossible or the tolerance cannot be reached within 200 x 100 poles.
        """
        from bladewright.blade.native.blade import native_blade
        from bladewright.blade.native.finishing import finished

        plain, own = self.plain, None if knots is None else knots.chain[0]
        exact = plain.exact_blade(own)
        exact.check()
        return finished(native_blade(exact, own, fine=fine), self, knots, fine=fine)

    def _check_arrangement(self) -> None:
        """Refuse what the other arrangement has; bring what this one has to numbers."""
        own, other = ("annular", "linear") if self.arrangement == "annular" else ("linear", "annular")
        for mine, theirs in zip(FIELDS_OF[own], FIELDS_OF[other], strict=True):
            if getattr(self, theirs) is not None:
                raise DesignError(
                    f"{theirs} is given, but arrangement is '{own}': give {mine}, or arrangement = '{other}'"
                )
        count, place = FIELDS_OF[own]
        self._check_position(place, FIELDS_OF[other][1])
        if getattr(self, count) is None:
            raise DesignError(f"{count} is missing: arrangement '{own}' needs it")
        if own == "annular":
            number = checks.integer(
                count, self.blade_count, int(BLADES.low), int(BLADES.high), "a whole number of blades is needed"
            )
            object.__setattr__(self, count, number)
        else:
            object.__setattr__(self, count, checks.number(count, self.pitch))
            checks.between(count, self.pitch, 0.0, float("inf"), "the pitch must be positive")

    def _check_clearances(self) -> None:
        given = [name for name in ("tip_clearance", "hub_clearance") if getattr(self, name) is not None]
        if len(given) == 2:
            raise DesignError(
                "tip_clearance and hub_clearance are both given: a blade stands on one of the walls; leave out the one "
                "of the wall that it stands on"
            )
        for name in given:
            value = getattr(self, name)
            if checks.is_sequence(value) and len(value) != 2:
                raise DesignError(
                    f"{name} is {value!r}: give one number, or two, at the leading and at the trailing edge"
                )
            value = checks.control_points(name, value)
            what = "a clearance must be positive; leave it out where the blade stands on that wall"
            checks.between(name, value, 0.0, float("inf"), what)
            object.__setattr__(self, name, value)

    def _check_parts(self) -> None:
        """Refuse fillets, discs and rings where the blade does not stand on the wall, and discs in a cascade."""
        if self.density is not None:
            object.__setattr__(self, "density", checks.number("density", self.density))
            checks.between("density", self.density, DENSITY.low, DENSITY.high, DENSITY.cure)
        for name, kind in (("cut", Cut), ("hub_fillet", Fillet), ("shroud_fillet", Fillet), *DISCS.items()):
            value = getattr(self, name)
            if value is not None and not isinstance(value, kind):
                raise DesignError(f"{name} is {value!r}: a table is needed")
            if value is not None and name in DISCS and self.arrangement != "annular":
                raise DesignError(f"{name} is given, but arrangement is 'linear': wheels are annular; leave it out")
        for wall, clearance, on_wall in (
            ("hub", "hub_clearance", ("hub_fillet", "disc")),
            ("shroud", "tip_clearance", ("shroud_fillet", "shroud_ring")),
        ):
            for name in on_wall:
                if getattr(self, clearance) is not None and getattr(self, name) is not None:
                    raise DesignError(
                        f"{name} is given together with {clearance}: the blade does not touch the {wall} there; leave "
                        "one of the two out"
                    )

    def _check_position(self, place: str, other: str) -> None:
        """Bring the leading edge's tangential position to a law: 0 where none is given."""
        del other
        given = getattr(self, place)
        object.__setattr__(self, place, checks.law(place, 0.0 if given is None else given))
