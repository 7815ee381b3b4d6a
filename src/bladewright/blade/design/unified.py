"""The unified blade as a design: camber and two thickness laws between hub and shroud (Agromayor et al. 2021)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

from bladewright.blade.design.flow_path import Channel, FlowPath
from bladewright.blade.design.row_design import RowDesign
from bladewright.blade.design.spanwise_steps import SpanwiseStep, steps_of_laws
from bladewright.designs import ChordwiseLaw, Law, parameter
from bladewright.errors import DesignError
from bladewright.section import checks
from bladewright.section.unified_limits import (
    ANGLE,
    ANGLES,
    RADII,
    RADIUS,
    TANGENT,
    TANGENTS,
    THICKNESS,
    THICKNESSES,
    WEIGHT,
    WEIGHTS,
    check_sampling,
)

if TYPE_CHECKING:
    from bladewright.blade.exact.unified import ExactUnifiedBlade
    from bladewright.blade.native.knots import Knots


@dataclass(frozen=True, kw_only=True)
class UnifiedBlade(RowDesign):
    """A blade of the unified family, axial, radial or mixed, in an annulus or a linear cascade.

    Every law is a number, or the control points of a clamped uniform B-spline of degree min(n - 1, 3) along the span,
    v = 0 at the hub and v = 1 at the shroud. With a clearance the blade ends on a surface at the stated distance from
    that wall: v = 0 and v = 1 are the blade's own ends, and so are those of the laws.
    Reference: Agromayor et al. 2021, sections 3 and 4.
    """

    reference_length: ClassVar[str] = "length"

    stagger: Law = parameter("deg", limits=ANGLE)
    """atan(delta theta / delta m') of the camber's ends, from the meridional direction [deg]"""
    metal_angle_in: Law = parameter("deg", limits=ANGLE)
    """camber angle at the leading edge, from the meridional direction [deg]"""
    metal_angle_out: Law = parameter("deg", limits=ANGLE)
    """camber angle at the trailing edge, from the meridional direction [deg]"""
    tangent_in: Law = parameter("-", limits=TANGENT)
    """length of the camber's tangent at the leading edge, of the meridional extent [-]"""
    tangent_out: Law = parameter("-", limits=TANGENT)
    """length of the camber's tangent at the trailing edge, of the meridional extent [-]"""
    leading_edge_radius: Law = parameter("-", limits=RADIUS)
    """radius of curvature at the leading edge, of the meridional length [-]"""
    trailing_edge_radius: Law = parameter("-", limits=RADIUS)
    """radius of curvature at the trailing edge, of the meridional length [-]"""
    thickness_upper: ChordwiseLaw = parameter("-", limits=THICKNESS)
    """half thickness of the upper side, control points along the chord, of the meridional length [-]"""
    thickness_lower: ChordwiseLaw = parameter("-", limits=THICKNESS)
    """half thickness of the lower side, control points along the chord, of the meridional length [-]"""
    weights_upper: ChordwiseLaw = parameter("-", limits=WEIGHT, default=())
    """weights of the upper side's control points, a law along the chord; none: a B-spline [-]"""
    weights_lower: ChordwiseLaw = parameter("-", limits=WEIGHT, default=())
    """weights of the lower side's control points, a law along the chord; none: a B-spline [-]"""
    flow_path: FlowPath | None = None
    """hub and shroud from upstream of the blade to downstream of it, which the channel's edges cut; instead of the
    channel's own"""
    channel: Channel
    """the meridional channel, from wall to wall"""
    mapping: Literal["conformal", "paper"] = "conformal"
    """sections in the plane (m', theta), or the mapping of Agromayor et al. 2021, eq. 28"""
    samples: int = 16
    """places along the chord where the thickness laws are taken, edges apart [-]"""
    clustering: float = 1.0
    """spacing of the samples: 0 uniform, 1 cosine towards both edges [-]"""

    def spanwise_steps(self) -> Iterator[SpanwiseStep]:
        names = ("leading_edge_theta", "leading_edge_y", *ANGLES, *TANGENTS, *RADII)
        yield from steps_of_laws((name, getattr(self, name)) for name in names)
        for name in (*THICKNESSES, *WEIGHTS):
            yield from steps_of_laws((f"{name}[{i}]", law) for i, law in enumerate(getattr(self, name)))
        if self.flow_path is None and self.tip_clearance is None and self.hub_clearance is None:
            yield from self.channel.spanwise_steps()

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.choice("mapping", self.mapping, ["conformal", "paper"])
        checks.parameters(self)
        check_sampling(self)
        if not isinstance(self.channel, Channel):
            raise DesignError(f"channel is {self.channel!r}: a Channel with leading_edge and trailing_edge is needed")
        self._check_flow_path()

    def _check_flow_path(self) -> None:
        """Refuse two hubs or shrouds, and what a channel between four curves has no use for."""
        path = self.flow_path
        if path is None:
            return
        if not isinstance(path, FlowPath):
            raise DesignError(f"flow_path is {path!r}: a FlowPath with hub and shroud is needed")
        for name in ("hub", "shroud"):
            if getattr(self.channel, name):
                raise DesignError(
                    f"channel.{name} is given together with flow_path, whose {name} the channel's edges cut: leave "
                    f"channel.{name} out, or flow_path"
                )
        for name in ("stream_surfaces", "quasi_orthogonals"):
            if getattr(path, name):
                raise DesignError(
                    f"flow_path.{name} is given: the stream surfaces of the unified family blend hub, shroud and both "
                    f"edges of the channel; leave {name} out, or take a family of sections"
                )
        if path.matched != "ends":
            raise DesignError(
                "flow_path.matched is 'edges': the unified family cuts the flow path at its channel's edges in any "
                "case; leave matched out"
            )

    @property
    def thickness_laws(self) -> Mapping[str, ChordwiseLaw]:
        """Half-thickness laws along the chord of the `upper` and the `lower` side."""
        return {"upper": self.thickness_upper, "lower": self.thickness_lower}

    def exact_blade(self, knots: Knots | None = None) -> ExactUnifiedBlade:
        from bladewright.blade.exact.unified import exact_unified_blade

        return exact_unified_blade(self, None if knots is None else knots.tip)

    def needs_own_search(self, paths: Iterable[str]) -> bool:
        """Where a clearance surface lies, and where edges cut a flow path, is found for one channel at a time."""
        searched = self.ends != ("hub", "shroud") or self.flow_path is not None
        return searched and any(path.startswith(("channel.", "flow_path.")) or "clearance" in path for path in paths)
