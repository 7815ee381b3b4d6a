"""The unified blade as a design: camber and two thickness laws between hub and shroud (Agromayor et al. 2021)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.row_design import check_arrangement
from bladewright.designs import ChordwiseLaw, Design, Law, parameter
from bladewright.errors import DesignError
from bladewright.section import checks
from bladewright.section.unified_limits import check_labels, check_laws, check_range, check_sampling

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade
    from bladewright.blade.native.knots import Knots


@dataclass(frozen=True, kw_only=True)
class UnifiedBlade(Design):
    """A blade of the unified family, axial, radial or mixed, in an annulus or a linear cascade.

    Every law is a number, or the control points of a clamped uniform B-spline of degree min(n - 1, 3) along the span,
    v = 0 at the hub and v = 1 at the shroud. With a clearance the blade ends on a surface at the stated distance from
    that wall: v = 0 and v = 1 are the blade's own ends, and so are those of the laws.
    Reference: Agromayor et al. 2021, sections 3 and 4.
    """

    dimension: ClassVar[int] = 3
    reference_length: ClassVar[str] = "length"

    name: str
    """the part's name, used in files"""
    length_unit: Literal["m", "cm", "mm", "um", "in", "ft"]
    """unit of every length in the design"""
    arrangement: Literal["annular", "linear"] = "annular"
    """blades around the machine axis, or side by side in a cascade"""
    blade_count: int | None = None
    """number of blades of an annular row [-]"""
    pitch: float | None = parameter("length", default=None)
    """tangential distance of neighbours in a linear cascade [length]"""
    leading_edge_theta: Law | None = parameter("deg", default=None)
    """circumferential position of the leading edge, annular; 0 where not given [deg]"""
    leading_edge_y: Law | None = parameter("length", default=None)
    """tangential position of the leading edge, linear; 0 where not given [length]"""
    stagger: Law = parameter("deg")
    """atan(delta theta / delta m') of the camber's ends, from the meridional direction [deg]"""
    metal_angle_in: Law = parameter("deg")
    """camber angle at the leading edge, from the meridional direction [deg]"""
    metal_angle_out: Law = parameter("deg")
    """camber angle at the trailing edge, from the meridional direction [deg]"""
    tangent_in: Law = parameter("-")
    """length of the camber's tangent at the leading edge, of the meridional extent [-]"""
    tangent_out: Law = parameter("-")
    """length of the camber's tangent at the trailing edge, of the meridional extent [-]"""
    leading_edge_radius: Law = parameter("-")
    """radius of curvature at the leading edge, of the meridional length [-]"""
    trailing_edge_radius: Law = parameter("-")
    """radius of curvature at the trailing edge, of the meridional length [-]"""
    thickness_upper: ChordwiseLaw = parameter("-")
    """half thickness of the upper side, control points along the chord, of the meridional length [-]"""
    thickness_lower: ChordwiseLaw = parameter("-")
    """half thickness of the lower side, control points along the chord, of the meridional length [-]"""
    weights_upper: ChordwiseLaw = parameter("-", default=())
    """weights of the upper side's control points, a law along the chord; none: a B-spline [-]"""
    weights_lower: ChordwiseLaw = parameter("-", default=())
    """weights of the lower side's control points, a law along the chord; none: a B-spline [-]"""
    tip_clearance: float | tuple[float, float] | None = parameter("length", default=None)
    """meridional distance of the blade's end from the shroud, at leading and trailing edge where two [length]"""
    hub_clearance: float | tuple[float, float] | None = parameter("length", default=None)
    """meridional distance of the blade's end from the hub, at leading and trailing edge where two [length]"""
    channel: Channel
    """the meridional channel, from wall to wall"""
    mapping: Literal["conformal", "paper"] = "conformal"
    """sections laid in the plane (m', theta), or the mapping of Agromayor et al. 2021, eq. 28"""
    samples: int = 16
    """places along the chord where the thickness laws are taken, edges apart [-]"""
    clustering: float = 1.0
    """spacing of the samples: 0 uniform, 1 cosine towards both edges [-]"""
    tolerance: float = 1e-6
    """largest distance of the native surfaces from the exact blade, of the chord [-]"""
    description: str = ""
    """one line for the header of CAD files"""
    author: str = ""
    """for the header of CAD files"""
    organisation: str = ""
    """for the header of CAD files"""

    def __post_init__(self) -> None:
        check_labels(self)
        checks.choice("arrangement", self.arrangement, ["annular", "linear"])
        checks.choice("mapping", self.mapping, ["conformal", "paper"])
        check_laws(self)
        check_arrangement(self)
        self._check_clearances()
        check_sampling(self)
        check_range(self, "tolerance", 1e-9, 1e-2)
        if not isinstance(self.channel, Channel):
            raise DesignError(f"channel is {self.channel!r}: a Channel with leading_edge and trailing_edge is needed")

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
            value = checks.law(name, value)
            what = "a clearance must be positive; leave it out where the blade stands on that wall"
            checks.between(name, value, 0.0, float("inf"), what)
            object.__setattr__(self, name, value)

    @property
    def ends(self) -> tuple[str, str]:
        """Names of the blade's ends at v = 0 and v = 1: `hub` and `shroud`, or `tip` where there is a clearance."""
        hub = "hub" if self.hub_clearance is None else "tip"
        return hub, "shroud" if self.tip_clearance is None else "tip"

    @property
    def thickness_laws(self) -> Mapping[str, ChordwiseLaw]:
        """Half-thickness laws along the chord of the `upper` and the `lower` side."""
        return {"upper": self.thickness_upper, "lower": self.thickness_lower}

    def build(self, knots: Knots | None = None) -> Blade:
        """The native blade in metres; `knots=blade.knots` holds another build's knots and interpolation sites.

        Raises DesignError where the shape is impossible or the tolerance cannot be reached within 200 x 100 poles.
        """
        from bladewright.blade.native.build import built

        return built(self, knots)
