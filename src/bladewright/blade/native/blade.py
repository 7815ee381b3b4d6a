"""The native blade: named surfaces in metres, how they are built, and how well they hold what the design asks for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, cast
from warnings import warn

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.native.conformance import Conformance, conformance_of
from bladewright.blade.native.end_faces import EDGES, cap, end_row, parted, trimmed_ends
from bladewright.blade.native.flow_sense import FlowSense, flow_sense
from bladewright.blade.native.interpolation import edge_faces, native_sides
from bladewright.blade.native.knots import DEGREE, MOST_POLES, Knots
from bladewright.blade.native.mass import MetalBody
from bladewright.blade.native.properties import blade_properties
from bladewright.blade.native.refinement import (
    ApproximationError,
    approximation_error,
    mean_chord,
    refined_knots,
    wall_tolerance,
)
from bladewright.blade.native.station_table import BladeStations, station_table
from bladewright.display import Shown
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, knots_with_joints
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended, reparametrised
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.mass_properties import MassProperties, mass_properties
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.section.section import Section
from bladewright.section.smoothness import Smoothness

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

Faces = Mapping[str, Surface | TrimmedSurface]
"""faces of a body by name"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Blade(FrozenRecord, Shown, MetalBody):
    """A closed blade of native surfaces."""

    dimension: ClassVar[int] = 3
    shown_as: ClassVar[str] = "blade"

    design: RowDesign
    surfaces: Faces
    """`upper` and `lower` (u from leading to trailing edge, v from end to end), `leading_edge` and `trailing_edge`
    where they are blunt (u from the upper to the lower side), strips and fillets, and the two `design.ends`; metres"""
    knots: Knots
    """of both sides; give them to `design.build(knots=...)` to hold them"""
    chord: float
    """mean straight distance from leading to trailing edge [m]"""
    exact: ExactBlade
    """the blade that the design defines, which the surfaces interpolate"""
    moments: Callable[[], Array] | None = None
    """gives the moments of the volume, as `blade_moments` does, where they are known without quadrature"""
    before: Blade | None = None
    """the blade that this one was cut or filleted from"""
    outlines: Mapping[str, tuple[Curve, ...]] = field(default_factory=lambda: FrozenMapping({}))
    """closed chains of space curves [m] around end faces, where cuts or fillets have changed them"""
    walls: Mapping[str, tuple[Curve, Reals]] = field(default_factory=lambda: FrozenMapping({}))
    """meridians of the walls of ends that are cut, as `end_wall` gives them"""
    edges: tuple[Curve, ...] = ()
    """space curves [m] along which trimmed faces meet: arcs between the ends and the faces of edges that are cut"""

    def __repr__(self) -> str:
        faces, chord = ", ".join(self.surfaces), float(np.real(self.chord))
        return f"<Blade '{self.name}' of {type(self.design).__name__}: {faces}; chord {chord:.6g} m>"

    @property
    def name(self) -> str:
        """The design's name."""
        return self.design.name

    @property
    def description(self) -> str:
        """One line for the header of CAD files."""
        return self.design.description

    @property
    def author(self) -> str:
        """For the header of CAD files."""
        return self.design.author

    @property
    def organisation(self) -> str:
        """For the header of CAD files."""
        return self.design.organisation

    @property
    def orientations(self) -> Mapping[str, int]:
        """+1 for the faces whose dS/du x dS/dv points out of the blade, -1 for the others."""
        low, high = self.design.ends
        around = {"upper": -1, "lower": 1}
        for name, sign in zip(EDGES, (1, -1), strict=True):
            corners = (name, f"{name}_upper", f"{name}_lower")
            around |= {f"{corner}{part}": sign for corner in corners for part in ("", "_run")}
        kinds = ["", *(f"{wall}_{part}_" for wall in ("hub", "shroud") for part in ("strip", "fillet"))]
        sides = {f"{kind}{name}": sign for kind in kinds for name, sign in around.items()}
        return FrozenMapping(
            {**{name: sign for name, sign in sides.items() if name in self.surfaces}, low: -1, high: 1}
        )

    @property
    def tolerance(self) -> float:
        """The distance from the exact blade that was allowed, of the chord."""
        return self.design.tolerance

    @property
    def plain(self) -> Blade:
        """The blade before cuts and fillets, which laws speak of: itself, where there are none."""
        return self if self.before is None else self.before.plain

    @property
    def unfilleted(self) -> Blade:
        """The blade before fillets, whose sides reach its walls: itself, where there are none."""
        filleted = self.design.hub_fillet is not None or self.design.shroud_fillet is not None
        return self.before if filleted and self.before is not None else self

    @property
    def edge_kinds(self) -> tuple[str, str]:
        """How the sides meet at the leading and at the trailing edge: "round", "sharp" or "blunt", as a cut edge is."""
        kinds = zip(EDGES, self.plain.exact.survey.edge_kinds, strict=True)
        first, last = ("blunt" if edge in self.walls else kind for edge, kind in kinds)
        return first, last

    @property
    def back(self) -> float | None:
        """The u from which both sides are one straight back face, where they are and it is not cut off."""
        return None if EDGES[1] in self.walls else self.plain.exact.survey.back

    def end_outline(self, name: str) -> tuple[Curve, ...]:
        """The closed chain of space curves [m] around an end face, in the order and sense of its boundary."""
        if name in self.outlines:
            return self.outlines[name]
        row = -self.design.ends.index(name)
        leading, trailing = (
            [end_row(cast(Surface, self.surfaces[edge]), row)] if edge in self.surfaces else [] for edge in EDGES
        )
        upper, lower = (end_row(side, row) for side in self.sides)
        return (lower, *map(run_back, trailing), run_back(upper), *leading)

    def end_wall(self, name: str) -> tuple[Curve, Reals]:
        """The meridian (x, r) [m] of the wall that an end lies on, and its inner knots: of the cut where it is cut.

        The knots are those at which it loses derivatives, each as often as it occurs.
        """
        if name in self.walls:
            return self.walls[name]
        return self.plain.exact.end_wall(-self.design.ends.index(name))

    @property
    def sides(self) -> tuple[Surface, Surface]:
        """The upper and the lower side."""
        return cast(Surface, self.surfaces["upper"]), cast(Surface, self.surfaces["lower"])

    @cached_property
    def approximation_error(self) -> ApproximationError:
        """Where and how far the sides, before cuts and fillets, are from the exact blade between the sites."""
        return approximation_error(self.exact, *self.plain.sides)

    @property
    def misfit(self) -> ApproximationError:
        """The former name of `approximation_error`."""
        warn("Blade.misfit is called approximation_error now", DeprecationWarning, stacklevel=2)
        return self.approximation_error

    @property
    def error(self) -> float:
        """Largest distance of the sides from the exact blade, of the chord."""
        return self.approximation_error.distance / self.chord

    @property
    def wall_error(self) -> float:
        """Largest distance of the blade's ends from hub, shroud or clearance surface, of the chord."""
        return self.approximation_error.off_walls / self.chord

    @cached_property
    def properties(self) -> MassProperties:
        """Volume [m^3], area [m^2], centroid [m] and inertia [m^5], by quadrature on the native surfaces."""
        moments, revolved = self.moments, self.exact.mapping.revolved
        if moments or any(isinstance(self.surfaces[name], TrimmedSurface) for name in self.design.ends):
            return blade_properties(self.surfaces, self.orientations, revolved=revolved, moments=moments)
        return mass_properties([(self.surfaces[name], sign) for name, sign in self.orientations.items()])

    @property
    def metal(self) -> RowDesign:
        """The design that states the density."""
        return self.design

    @cached_property
    def conformance(self) -> Conformance:
        """What the built surfaces keep of what the design asks for: angles, radii, smooth edges, ends on the walls.

        Before cuts and fillets.
        """
        return conformance_of(self.plain)

    @property
    def promises(self) -> Conformance:
        """The former name of `conformance`."""
        warn("Blade.promises is called conformance now", DeprecationWarning, stacklevel=2)
        return self.conformance

    @cached_property
    def uncut(self) -> Blade:
        """The blade from wall to wall whose sections keep their span: itself, where no clearance cuts it off.

        At the knots along the sections that this one has. A unified blade with a clearance is not cut: its laws run
        between its own ends.
        """
        if self.before is not None:
            return self.plain.uncut
        exact = self.exact.uncut
        if exact is self.exact:
            return self
        levels, counts = np.unique(exact.breaks_along_v(), return_counts=True)
        joints = [(float(v), DEGREE - int(count)) for v, count in zip(levels, counts, strict=True)]
        return native_blade(exact, Knots(u=self.knots.u, v=knots_with_joints(self.knots.v, DEGREE, joints)))

    @cached_property
    def sections(self) -> tuple[Section, ...]:
        """Sections at hub, mid-span and shroud, and where a design gives more, from hub to shroud.

        Ruled blades have those at hub and shroud, developable ones that at the hub.
        """
        return tuple(self.section(v) for v in self.exact.section_spans)

    def sections_at(self, spans: Sequence[float]) -> list[Section]:
        """The exact sections at span fractions, as `section` counts them."""
        return [self.section(v) for v in spans]

    def section(self, v: float) -> Section:
        """The exact section at v in [0, 1], in its plane, with the properties it has on its stream surface.

        On blades from sections v is the span fraction of the flow path, from hub to shroud, also where a clearance cuts
        the blade; on unified ones it counts from the blade's one end to its other.

        Raises DesignError where v is outside.
        """
        return self.exact.section(v)

    def report(self, stations: Sequence[float] | None = None) -> BladeStations:
        """The station table: what is built at span fractions, where None at 0, 0.25, 0.5, 0.75 and 1.

        Metal angles, chord, thickness, throat, solidity, lean, sweep and more, each an attribute, (m,) in metres and
        radians; print it, or take `to_dict()` and `to_csv()`. Where a clearance cuts a blade from sections off,
        stations are those of the uncut blade, and areas those of what is left. Those of the design's `cut`, and
        fillets, are left out. Raises DesignError where a station is outside [0, 1].

        >>> import bladewright as bw
        >>> blade = bw.read_design("core-rotor.toml").build()  # doctest: +SKIP
        >>> blade.report([0.0, 0.5, 1.0]).solidity  # doctest: +SKIP
        """
        return station_table(self, stations)

    @cached_property
    def flow_sense(self) -> FlowSense:
        """Which way the row turns, which side is the suction side, and what that rests on."""
        return flow_sense(self.plain)

    @property
    def suction_side(self) -> str | None:
        """`upper` or `lower`, by camber and rotation; None where neither tells."""
        return self.flow_sense.suction_side

    def smoothness(self, v: float) -> Smoothness:
        """Curvature, its slope and their jumps along the exact section at v in [0, 1], in chords of its plane.

        Raises DesignError where v is outside.
        """
        return self.exact.smoothness(v)

    def extended(self, span: float) -> Blade:
        """The blade continued past hub and shroud by `span` of its own span at each end, for a later cut.

        Sides and the faces of blunt edges continue their own polynomials, and the part between is unchanged; caps close
        the ends. An end that stands off its wall stays as it is. Raises DesignError where span is not above 0 and at
        most 0.5.
        """
        if not 0.0 < span <= 0.5:
            raise DesignError(f"an extension by {span:g} of the span was asked: it must be above 0 and at most 0.5")
        if self.before is not None:
            raise DesignError(
                f"an extension by {span:g} of the span was asked of '{self.name}', which the design cuts or fillets: "
                "leave cut, hub_fillet and shroud_fillet out where the blade is to be cut or filleted elsewhere"
            )
        low, high = (0.0 if name == "tip" else span for name in self.design.ends)
        back = self.exact.survey.back
        sides = {name: parted(side, back) for name, side in zip(("upper", "lower"), self.sides, strict=True)}
        edges = {name: cast(Surface, self.surfaces[name]) for name in EDGES if name in self.surfaces}
        around = {
            name: reparametrised(extended(face, -low, 1.0 + high, "v"), 0.0, 1.0, "v")
            for name, face in {**sides, **edges}.items()
        }
        faces = {name: around[name] for name in edges}
        ends = {
            name: self.surfaces[name] if name == "tip" else cap(around["upper"], around["lower"], faces, back, row)
            for name, row in zip(self.design.ends, (0, -1), strict=True)
        }
        return Blade(
            design=self.design.changed("name", f"{self.name}-extended"),
            surfaces=FrozenMapping({**around, **ends}),
            knots=self.knots,
            chord=self.chord,
            exact=self.exact,
        )


def native_blade(exact: ExactBlade, knots: Knots | None = None, *, fine: bool = False) -> Blade:
    """The native blade of an exact one, at given knots or at knots refined until the design's tolerance holds."""
    chord = mean_chord(exact)
    given = knots is not None
    knots = knots if knots is not None else refined_knots(exact, chord, fine=fine)
    sections = exact.sections(knots.sites_v)
    nets = native_sides(sections, knots)
    sides = side_surface(nets[0], knots, DEGREE), side_surface(nets[1], knots, DEGREE)
    edges = edge_faces(sections, *sides, knots)
    ends = trimmed_ends(exact, *sides, chord, faces=edges)
    surfaces: Faces = FrozenMapping({"upper": sides[0], "lower": sides[1], **edges, **ends})
    blade = Blade(design=exact.design, surfaces=surfaces, knots=knots, chord=chord, exact=exact)
    if not given:
        _check_reached(blade, fine=fine)
    return blade


def _check_reached(blade: Blade, *, fine: bool) -> None:
    tolerance, poles = blade.tolerance, blade.knots.poles
    wall = min(wall_tolerance(blade.chord, fine=fine) / blade.chord, tolerance)
    otherwise = ", or build it without fine" if fine else ""
    error, wall_error, worst = blade.error, blade.wall_error, blade.approximation_error
    if error <= tolerance and wall_error <= wall and poles[0] <= MOST_POLES[0] and poles[1] <= MOST_POLES[1]:
        return
    if error <= tolerance and wall_error <= wall:
        where = " and ".join(
            name for name, own, most in zip(("chord", "span"), poles, MOST_POLES, strict=True) if own > most
        )
        raise DesignError(
            f"tolerance is {tolerance:g} of the chord, which native surfaces hold with {poles[0]} x {poles[1]} poles a "
            f"side, and at most {MOST_POLES[0]} x {MOST_POLES[1]} are allowed: give the laws along the {where} fewer "
            f"control points, and curves in (x, r) fewer points{otherwise}"
        )
    raise DesignError(
        f"tolerance is {tolerance:g} of the chord: native surfaces reach {error:.2g} (ends {wall_error:.2g} off the "
        f"walls, {wall:g} allowed) with {poles[0]} x {poles[1]} poles a side, at most {MOST_POLES[0]} x "
        f"{MOST_POLES[1]} are allowed; the worst place is u = {worst.u:.3f}, v = {worst.v:.3f}: raise "
        f"the tolerance, raise a very small edge radius, or smooth the laws there{otherwise}"
    )


def side_surface(net: np.ndarray, knots: Knots, degree: int) -> Surface:
    """A side from its control net."""
    return Surface(control_points=net, knots_u=knots.u, knots_v=knots.v, degree_u=degree, degree_v=degree)
