"""Stacking without edge curves: the positions of the sections' reference points in the flow path."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.blade.design.stacking import HUB_PLACES, Stacking
from bladewright.blade.exact.chord_placement import chord_placement
from bladewright.blade.exact.orthogonal_trajectory import OrthogonalTrajectory, orthogonal_trajectory
from bladewright.blade.exact.placement import Placed, Placement, check_stagger, family_sections, reference_points
from bladewright.blade.flow_path.blade_streamlines import BladeStreamlines, blade_streamlines, labels
from bladewright.blade.flow_path.intersections import curve_joints, intersections
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first, spline_on
from bladewright.blade.flow_path.stream_surface_map import Cascade, StreamSurfaceMap
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.outline import Outline

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade

OVERHANG = 0.1
"""How far a line of equal x, or equal r, reaches past the flow path, as a share of it: so that it meets hub and
shroud."""
ROUNDS = 60
"""Rounds in which a chord line's angle and its place, which depend on each other, must converge; mostly five
suffice."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StackingAxis(Placement):
    """The reference points of a stacking without edge curves, in a flow path."""

    stacking: Stacking
    metre: float
    """metres in the design's unit of length"""

    def placed(self, design: "SectionedBlade", mapping: StreamSurfaceMap, span: Span) -> Placed:
        stacking, v, part = self.stacking, span.v, design.section
        chord = self.metre * span.values(0.0 if stacking.chord is None else stacking.chord)
        around = chord_placement(self.surfaces, v, mapping, self.t(v), chord)

        def on_lines(outline: Outline, stagger: Array) -> Placed:
            check_stagger(stagger, v)
            reference = reference_points(stacking, outline, span)
            share = reference[..., 0] - reference[..., 1] * np.tan(stagger)
            lines = around.between(share, chord * np.cos(stagger))
            return lines, outline, stagger, reference

        outline, stagger = part.outline(span), part.stagger(span)
        if not (part.depends_on_stream_surface and mapping.plane == "m'-theta"):
            return on_lines(outline, stagger)
        return _settled(on_lines, partial(family_sections, design, span), outline, stagger)

    def span_joints(self) -> list[tuple[float, int]]:
        if self.stacking.onwards == "least-distance":
            # stream lines keep one derivative at least, and the line across them one more
            return [(float(joint), 2) for joint in self.path.joints]
        if self.stacking.line is None:
            return []
        v = np.linspace(0.0, 1.0, 17)
        return curve_joints(self.surfaces, self.line, v, self.intersections(v))

    def t(self, v: Reals) -> Array:
        """t (..., m) of the reference points at v (m,); raises DesignError where there is none, or more than one."""
        return self.path.t(v) if self.stacking.onwards == "least-distance" else self.intersections(v)[0]

    def intersections(self, v: Reals) -> tuple[Array, Array]:
        """Where the stream lines at v (m,) meet the stacking line: t, and the line's parameter."""
        name = "stacking.line" if self.stacking.line is not None else f"stacking.{self.given}"
        try:
            return intersections(partial(self.surfaces.position, v), self.surfaces.extent, self.line, name, labels(v))
        except DesignError as error:
            if not self.stacking.from_hub:
                raise
            raise DesignError(
                f"{error}; or take stacking.onwards = 'least-distance', for which the stream lines need not have one "
                f"{self.stacking.onwards[-1]} in common"
            ) from error

    @property
    def given(self) -> str:
        """The name of the hub's place."""
        return next(name for name in HUB_PLACES if getattr(self.stacking, name) is not None)

    @cached_property
    def line(self) -> MeridionalCurve:
        """The stacking line in (x, r), straight where it follows from the hub's point."""
        if self.stacking.line is not None:
            return self.stacking.line.line(self.metre)
        if (self.given, self.stacking.onwards) in (("hub_x", "equal-x"), ("hub_r", "equal-r")):
            return self._straight(self.given[-1], self._value)
        point = self.surfaces.position(np.zeros(1), real_first(self.hub, 0).reshape(1, 1))[..., 0, 0, :]
        slope = self.surfaces.position(np.zeros(1), real_first(self.hub, 0).reshape(1, 1), 1)[..., 0, 0, :]
        axis = "x" if self.stacking.onwards == "equal-x" else "r"
        which = "xr".index(axis)
        carried = self.hub - real_first(self.hub, 0)
        return self._straight(axis, point[..., which] + carried * slope[..., which])

    @cached_property
    def path(self) -> OrthogonalTrajectory:
        """The line of least distance through the hub's point."""
        return orthogonal_trajectory(self.surfaces, self.hub)

    @cached_property
    def hub(self) -> Array:
        """t (...) of the hub's reference point."""
        at = np.zeros(1)
        if self.given == "hub_m":
            return self._by_length(at)
        line = self._straight(self.given[-1], self._value)
        position = partial(self.surfaces.position, at)
        return intersections(
            position, self.surfaces.extent, line, f"stacking.{self.given}", ["the stream line of the hub"]
        )[0][..., 0]

    @property
    def _value(self) -> Array:
        return np.asarray(self.metre * getattr(self.stacking, self.given))

    def _by_length(self, at: Reals) -> Array:
        low, high = self.surfaces.extent
        whole = blade_streamlines(
            self.surfaces, at, Cascade(), np.array([low]), np.array([high]), before=0.0, after=0.0
        )
        stated, hub_length = float(real_first(self._value, 0)), float(real_first(whole.lengths, 1)[0])
        if not 0.0 < stated < hub_length:
            raise DesignError(
                f"stacking.hub_m is {stated / self.metre:g}: the hub is {hub_length / self.metre:.6g} long from its "
                "start to its end, and the reference point must lie between; give a place on the hub, or lengthen it"
            )
        return whole.t(whole.u_at(self._value[..., None, None]))[..., 0, 0]

    def _straight(self, axis: str, value: Array) -> MeridionalCurve:
        """The line of one x, or one r, through the whole flow path."""
        real = self.surfaces.real()
        grid = real.grid(np.linspace(*real.extent, 33), np.linspace(0.0, 1.0, 17))[0].reshape(-1, 2)
        other = grid[:, 1 if axis == "x" else 0]
        margin = OVERHANG * (float(np.max(other)) - float(np.min(other)))
        across = np.array([np.min(other) - margin, np.max(other) + margin])
        constant = value[..., None] * np.ones(2)
        pair = (constant, np.broadcast_to(across, constant.shape))
        return spline_on(np.stack(pair if axis == "x" else pair[::-1], axis=-1), 1)


def _settled(
    on_lines: Callable[[Outline, Array], Placed],
    again: Callable[[BladeStreamlines], tuple[Outline, Array]],
    outline: Outline,
    stagger: Array,
) -> Placed:
    """Sections whose stagger depends on the stream lines between their edges, by the secant method."""
    weight: Any = -1.0
    before: tuple[Reals, Reals] | None = None
    for _ in range(ROUNDS):
        outline, found = again(on_lines(outline, stagger)[0])
        difference = found - stagger
        real, carried = np.real(difference), np.max(np.square(np.imag(found)), initial=0.0)
        if np.max(np.square(real)) < 1e-26 and np.max(np.square(np.imag(difference)), initial=0.0) <= 1e-24 * carried:
            return on_lines(outline, found)
        if before is not None:
            moved, turned = np.real(stagger) - before[0], real - before[1]
            with np.errstate(all="ignore"):
                weight = np.where(np.square(turned) > 1e-16, moved / turned, weight)
        before = np.real(stagger), real
        stagger = stagger - weight * difference
    raise DesignError(
        "stacking: the sections' chord lines turn with the place that their chord gives them, and do not settle: "
        "give leading_edge and trailing_edge, which say where the sections begin and end"
    )
