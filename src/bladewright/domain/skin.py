"""The wetted skin of one pitch: what passage, sector and wheel share.

The blade stands on exact walls, the duct's meridians turned about the axis. The middle surface goes through the blade
from inlet to outlet; turned by half a pitch either way it bounds the pitch. A wall between two places of its meridian
is one face, trimmed by the periodic lines and by circles across the pitch, with the blade's end as a hole.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
from scipy.spatial import cKDTree

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.cut_faces import DRAWN, inner_knots, nearest_on_meridian
from bladewright.blade.native.cut_lines import in_meridian
from bladewright.blade.native.end_faces import Near, WallSurface, followed, nearest_on_wall
from bladewright.blade.native.knots import DEGREE
from bladewright.blade.native.properties import MOMENTS, side_moments
from bladewright.domain.camber_lines import CamberLines
from bladewright.domain.cut_duct import between_walls
from bladewright.domain.duct import Duct
from bladewright.domain.knots import BLADE_AT, PassageKnots
from bladewright.domain.nets import middle_net, shifted
from bladewright.errors import DesignError, GeometryError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, angle, concatenated, length
from bladewright.numerics.roots import level_crossings
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import piece, split
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.refine import inserted
from bladewright.nurbs.revolution import LEFT_HANDED, arc, revolved, segment
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

SPAN_PLACES = 17
"""Points of each knot span of a curve whose parameters on a wall are found by search; between them they are
interpolated and polished."""
EDGE_PLACES = 101
"""Places along the leading edge, from hub to shroud, by which theta is followed: 3 deg apart where it winds a turn."""
MERIDIAN_POINTS = 2001
"""Points of a wall's meridian among which that search looks for the nearest, before Newton's method."""
OVERHANG = 0.02
"""How far walls reach past inlet and outlet, in mean meridional lengths of the blade: trimming needs a margin."""
ANGULAR_OVERHANG = 0.01
"""The same in theta (y in a cascade), in pitches."""
SAME_PLACE = 1e-9
"""Distance along a wall's meridian, of its length, within which a place is an end of the skin."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Skin(FrozenRecord):
    """The blade, the walls and the middle surface of one pitch, from inlet to outlet; metres and radians."""

    blade: Blade
    camber: CamberLines
    """continued camber lines from hub to shroud, at the sites of `knots.span`"""
    knots: PassageKnots
    half_pitch: Array
    """() in theta, or y in a cascade"""

    @property
    def duct(self) -> Duct:
        """The channel with its continuations."""
        return self.camber.duct

    @cached_property
    def middle(self) -> Surface:
        """The surface of the camber lines: u along the flow over [0, 1], the blade at BLADE_AT, v hub to shroud.

        Between the walls that cuts of the blade's ends have made, where there are some.
        """
        whole = self._surface(middle_net(self.camber, self.knots))
        cut = {wall: self.blade.walls[wall][0] for wall in ("hub", "shroud") if self.is_cut(wall)}
        return between_walls(whole, cut, revolved=self.duct.revolved) if cut else whole

    def is_cut(self, wall: str) -> bool:
        """Whether a cut of the blade is the `hub` or the `shroud`."""
        cut = self.blade.design.cut
        given = cut is not None and (cut.hub if wall == "hub" else cut.tip) is not None
        # a fillet states its wall too, which stays the duct's own
        return given and wall in self.blade.walls

    @cached_property
    def periodic(self) -> dict[str, Surface]:
        """`periodic_upper` and `periodic_lower`: the middle surface, half a pitch up and down."""
        signs = (("periodic_upper", 1.0), ("periodic_lower", -1.0))
        net = self.middle.control_points
        return {name: self._surface(shifted(self.camber, net, sign * self.half_pitch)) for name, sign in signs}

    @cached_property
    def ends(self) -> dict[str, Surface]:
        """`inlet` and `outlet`: the middle surface's ends swept over the pitch; u from lower to upper, v hub to shroud.

        Rational arcs about the axis, so that their edges on the walls are circles; straight lines in a cascade.
        """
        return {name: self._swept(end) for name, end in (("inlet", 0), ("outlet", -1))}

    @cached_property
    def walls(self) -> dict[str, WallSurface]:
        """The exact `hub` and `shroud`, a little larger than the pitch between inlet and outlet."""
        margin = OVERHANG * self.duct.unit
        longer = replace(self.duct, low=self.duct.low - margin, high=self.duct.high + margin)
        return {
            name: self._cut_wall(name) if self.is_cut(name) else self._wall(name, longer.wall(name))
            for name in ("hub", "shroud")
        }

    def places(self, wall: str) -> tuple[float, float]:
        """The parameters of a wall's meridian at which the skin begins and ends."""
        line = self._middle_line(wall)
        first, last = _near(self.walls[wall], line)[1][[0, -1]]
        return float(first), float(last)

    def periodic_line(self, wall: str, sign: int, start: float | None = None, end: float | None = None) -> Curve:
        """The upper (`sign` +1), lower (-1) or middle (0) line of the pitch on a wall, between places of its meridian.

        Raises DesignError where a place lies beyond the skin's ends.
        """
        surface = (self.middle, self.periodic["periodic_upper"], self.periodic["periodic_lower"])[sign]
        line = _row(surface, wall)
        ends = self._at(wall, start, 0), self._at(wall, end, 1)
        return line if ends == line.domain else piece(line, *ends)

    def rim(self, wall: str, place: float | None, end: int) -> Curve:
        """The circle (in a cascade, the line) across the pitch at a place of a wall's meridian, from lower to upper.

        `end` is 0 for the skin's inlet, 1 for its outlet, where the place is None.
        """
        return self._across(self._middle_line(wall)(self._at(wall, place, end)))

    @cached_property
    def wall_error(self) -> float:
        """Largest distance [m] of the edges of trimmed walls from the exact walls."""
        found = 0.0
        for name, wall in self.walls.items():
            outline = self.blade.end_outline(name) if name in self.blade.design.ends else ()
            for curve in (self._middle_line(name), *outline):
                places, u, _ = _near(wall, curve)
                points = np.real(curve(places))
                radius = length(points[:, 1:]) if wall.revolved else points[:, 2]
                off = np.stack([points[:, 0], radius], axis=-1) - np.real(wall.meridian(u))
                found = max(found, float(np.max(length(off))))
        return found

    def _surface(self, net: Array) -> Surface:
        own = self.knots
        return Surface(control_points=net, knots_u=own.u, knots_v=own.span, degree_u=DEGREE, degree_v=DEGREE)

    def _middle_line(self, wall: str) -> Curve:
        return _row(self.middle, wall)

    def _at(self, wall: str, place: float | None, end: int) -> float:
        """The middle line's parameter at a place of the wall's meridian."""
        if place is None or (place - self.places(wall)[end]) ** 2 < SAME_PLACE**2:
            return float(end)
        places, near, across = _near(self.walls[wall], self._middle_line(wall))
        if not near[0] < place < near[-1]:
            raise DesignError(
                f"{('upstream', 'downstream')[end]}: the {wall} is asked for up to {place:.4g} of its meridian, and "
                f"the skin reaches from {near[0]:.4g} to {near[-1]:.4g}: let it reach further"
            )
        line, surface = self._middle_line(wall), self.walls[wall]

        def at(s: Reals) -> Reals:
            return np.real(nearest_on_wall(surface, line, (places, near, across), s)[0])

        return float(level_crossings(at, places, near, [place])[0])

    def _across(self, point: Array) -> Curve:
        """The points of the pitch at a point's x and radius, from lower to upper."""
        half = float(np.real(self.half_pitch))
        if not self.duct.revolved:
            step = self.half_pitch * np.array([0.0, 1.0, 0.0])
            return segment(point - step, point + step)
        x, y, z = point
        radius, nothing = cast(complex, length(point[1:])), 0.0 * x
        outwards, along_theta = np.stack([nothing, y, z]) / radius, np.stack([nothing, z, -y]) / radius
        return arc(np.stack([x, nothing, nothing]), radius, -half, half, axes=(outwards, along_theta))

    def _swept(self, end: int) -> Surface:
        knots, line = self.knots, self.middle.control_points[end]
        rows = [self.periodic[name].control_points[end] for name in ("periodic_lower", "periodic_upper")]
        if not self.duct.revolved:
            across = np.array([0.0, 0.0, 1.0, 1.0])
            return Surface(
                control_points=np.stack(rows), knots_u=across, knots_v=knots.span, degree_u=1, degree_v=DEGREE
            )
        half = float(np.real(self.half_pitch))
        swept = revolved(Curve(control_points=line, knots=knots.span, degree=DEGREE), -half, half, axis=LEFT_HANDED)
        inner = np.swapaxes(swept.control_points, 0, 1)[1:-1]
        return Surface(
            control_points=concatenated([rows[0][None], inner, rows[1][None]], axis=0),
            weights=None if swept.weights is None else np.swapaxes(swept.weights, 0, 1),
            knots_u=swept.knots_v,
            knots_v=knots.span,
            degree_u=2,
            degree_v=DEGREE,
        )

    def _cut_wall(self, name: str) -> WallSurface:
        """The surface of a cut, a little past the ends of the middle surface on it."""
        meridian, inner = self.blade.walls[name]
        ends = in_meridian(np.real(self._middle_line(name).control_points[[0, -1]]), self.duct.revolved)
        first, last = nearest_on_meridian(meridian, ends)
        margin = OVERHANG * (last - first)
        start, end = max(float(first - margin), meridian.domain[0]), min(float(last + margin), meridian.domain[1])
        return self._wall(name, piece(meridian, start, end), inner[(inner > start) & (inner < end)])

    def _wall(self, name: str, meridian: Curve, joints: Reals | None = None) -> WallSurface:
        half, revolved_ = float(np.real(self.half_pitch).flat[0]), self.duct.revolved
        line = self._middle_line(name)
        points = np.real(line(_places(line)))
        across = points[:, 1]
        if revolved_:
            # by the same turn on both walls
            _, y, z = np.real(self.middle(0.0, 0.0))
            across = np.unwrap(np.append(angle(y, z), angle(points[:, 1], points[:, 2])))[1:]
        margin = (1.0 + 2.0 * ANGULAR_OVERHANG) * half
        low, high = float(across.min()) - margin, float(across.max()) + margin
        if revolved_ and high - low >= 2.0 * np.pi:
            raise DesignError(
                f"upstream or downstream: the passage winds {np.degrees(high - low):.0f} deg around the axis at the "
                f"{name}, and a trimmed wall is one face of less than a full turn: shorten them, or let the flow turn "
                "to a lower inlet_angle or outlet_angle"
            )
        if joints is None:
            inner, counts = np.unique(inner_knots(meridian), return_counts=True)
            joints = np.repeat(inner[counts > 1], counts[counts > 1])
        return WallSurface(meridian=meridian, inner=joints, revolved=revolved_, low=low, high=high)


def wall_face(
    skin: Skin, wall: str, start: float | None = None, end: float | None = None, *, hole: bool = True
) -> TrimmedSurface:
    """The face of `hub` or `shroud` over one pitch between two places of its meridian, None for inlet and outlet.

    On the exact wall: u along its meridian, v with theta, or y in a cascade. Its outer loop runs along the lower
    periodic line in its smooth pieces, the circle at the end, back along the upper line and the circle at the start.
    Where the blade stands on the wall, its end is a hole, unless that is not wanted. Raises DesignError where a place
    lies beyond the skin, or a line cannot be followed on the wall.
    """

    def along(sign: int) -> tuple[Curve, ...]:
        line = skin.periodic_line(wall, sign, start, end)
        cuts = [at for at in BLADE_AT if line.domain[0] < at < line.domain[1]]
        return split(line, cuts) if cuts else (line,)

    return trimmed_wall(skin, wall, along(-1), along(1), hole=hole)


def trimmed_wall(
    skin: Skin, wall: str, lower: Sequence[Curve], upper: Sequence[Curve], *, hole: bool = True
) -> TrimmedSurface:
    """The same between two chains of curves in space, both along the flow, and the circles across their ends."""
    surface, chord = skin.walls[wall], skin.blade.chord
    ahead = [_on_wall(surface, part, chord) for part in lower]
    back = [run_back(_on_wall(surface, part, chord)) for part in reversed(upper)]
    across = [
        _rim_in_plane(surface, one.control_points[-1], other.control_points[0])
        for one, other in ((ahead[-1], back[0]), (back[-1], ahead[0]))
    ]
    holes = (_hole(surface, skin.blade.end_outline(wall), chord),) if hole and wall in skin.blade.design.ends else ()
    try:
        return TrimmedSurface(
            surface=surface.surface,
            boundary=(*ahead, across[0], *back, across[1]),
            holes=holes,
            revolution=surface.revolution,
        )
    except GeometryError as error:
        raise DesignError(
            f"upstream, downstream or the pitch: the end of the blade, or the foot of its fillet, reaches out of its "
            f"passage on the {wall}: let the passage reach further, take fewer blades, or a smaller fillet"
        ) from error


def _hole(wall: WallSurface, outline: Sequence[Curve], chord: float) -> tuple[Curve, ...]:
    """The outline of a blade's end as a hole: run backwards, arcs about the axis as straight lines."""
    drawn = [_on_wall(wall, edge, chord) if edge.degree >= DRAWN else None for edge in outline]
    chain = []
    for index, curve in enumerate(drawn):
        before, after = drawn[index - 1], drawn[(index + 1) % len(drawn)]
        if curve is not None:
            chain.append(curve)
        elif before is not None and after is not None:
            chain.append(_rim_in_plane(wall, before.control_points[-1], after.control_points[0]))
    return tuple(run_back(curve) for curve in reversed(chain))


def skin_moments(skin: Skin, faces: Mapping[str, Surface | TrimmedSurface], outward: Mapping[str, int]) -> Array:
    """The moments (10,) of what faces of a skin enclose, as `blade_moments` gives those of a blade.

    Faces are by name; those that begin with `blade` lie around the blade, all others at the middle surface's theta.
    """
    hub = skin.walls["hub"]
    middle = 0.5 * (hub.low + hub.high)
    low, high = BLADE_AT
    (at, _, on_hub), (beyond, _, on_shroud) = (
        _near(wall, _row(skin.middle, name)) for name, wall in skin.walls.items()
    )
    if skin.duct.revolved:
        # walls have their own turns: one may be a turn from where the middle surface goes from the other
        edge = np.real(skin.middle(low, np.linspace(0.0, 1.0, EDGE_PLACES)))
        across = np.unwrap(angle(edge[:, 1], edge[:, 2]))
        reached = np.interp(low, at, on_hub) + across[-1] - across[0]
        on_shroud = on_shroud + 2.0 * np.pi * np.round((reached - np.interp(low, beyond, on_shroud)) / (2.0 * np.pi))
    lines = (at, on_hub), (beyond, on_shroud)
    around = float(np.mean([theta[(at >= low) & (at <= high)].mean() for at, theta in lines]))
    whole = float(np.mean([theta.mean() for _, theta in lines]))
    total: Array = np.zeros(MOMENTS)
    for name, face in faces.items():
        if isinstance(face, Surface):
            near = around if name.startswith("blade") else whole
            total = total + outward[name] * side_moments(face, middle, revolved=skin.duct.revolved, near=near)
    return total


def _row(surface: Surface, wall: str) -> Curve:
    """The edge of a surface on the hub, at v = 0, or on the shroud."""
    row = 0 if wall == "hub" else -1
    return Curve(control_points=surface.control_points[:, row], knots=surface.knots_u, degree=surface.degree_u)


def _rim_in_plane(wall: WallSurface, start: Array, end: Array) -> Curve:
    """The straight line between two places (2,) of equal u, with knots on the seams of the rational arcs."""
    low, high = np.real(start[1]), np.real(end[1])
    seams = np.array([]) if wall.revolution is None else np.arange(1, wall.revolution.arcs) / wall.revolution.arcs
    passed = np.sort((seams - low) / (high - low))
    return inserted(segment(start, end), passed[(passed > 0.0) & (passed < 1.0)])


def _on_wall(wall: WallSurface, curve: Curve, chord: float) -> Curve:
    """The plane curve that the wall maps on a curve in space."""
    return followed(wall, curve, _near(wall, curve), chord)


def _near(wall: WallSurface, curve: Curve) -> Near:
    """Places of a curve, and the wall's parameters near it there, as `followed` takes them."""
    places = _places(curve)
    points, line = np.real(curve(places)), np.linspace(*wall.meridian.domain, MERIDIAN_POINTS)
    radius = length(points[:, 1:]) if wall.revolved else points[:, 2]
    target = np.stack([points[:, 0], radius], axis=-1)
    u = line[cKDTree(np.real(wall.meridian(line))).query(target)[1]]
    across = np.unwrap(angle(points[:, 1], points[:, 2])) if wall.revolved else points[:, 1]
    if wall.revolved:
        middle = 0.5 * (wall.low + wall.high)
        across = across + 2.0 * np.pi * np.round((middle - across.mean()) / (2.0 * np.pi))
    return places, np.real(nearest_on_wall(wall, curve, (places, u, across), places)[0]), across


def _places(curve: Curve) -> Reals:
    """Parameters of a curve, SPAN_PLACES in each of its knot spans."""
    spans = breaks(curve.knots)
    shares = np.linspace(0.0, 1.0, SPAN_PLACES)
    return np.unique(spans[:-1, None] + np.diff(spans)[:, None] * shares)
