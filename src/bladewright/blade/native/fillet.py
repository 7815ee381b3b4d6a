"""Blades with fillets: a ball rolls along the sides and a wall; between its contacts is the fillet, above it a strip.

Contacts are found at sites around the blade, cross-sections run from contact to contact, and splines around the blade
carry both the cross-sections and the strip above them, so that the joint is one row of control points for both. Above
the strip the sides are what they were, cut at one v.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import FACES, ClosedSection, SectionSplines
from bladewright.blade.native.contacts import Wall
from bladewright.blade.native.end_faces import EndKnots, Near, WallSurface, end_row, end_within, stretch_about
from bladewright.blade.native.fillet_knots import FilletKnots, chosen_knots, levels
from bladewright.blade.native.fillet_limits import check_folds
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.lazy_faces import Face, LazyFaces
from bladewright.blade.native.native_edges import with_native_edges
from bladewright.blade.native.pivot import Turning
from bladewright.blade.native.pivot import feet as foot_of
from bladewright.blade.native.rolling_ball import Rolled, Touch, balls_of, closed_section
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, basis
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended, piece, reparametrised
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign
    from bladewright.blade.native.stepped_fillet import SteppedTouch

REACH = 0.05
"""How far the meridian of a wall is continued past the foot of a fillet, as a share of the foot's length."""


def filleted(blade: Blade, design: RowDesign, knots: Knots | None = None, *, fine: bool = False) -> Blade:
    """The blade with the fillets that the design asks for, at its own knots where they are held.

    Raises DesignError where a fillet does not hold.
    """
    whole = with_native_edges(blade)
    section = closed_section(whole)
    balls = balls_of(whole, section, design)
    held = knots if isinstance(knots, FilletKnots) else None
    own = chosen_knots(whole, section, balls, fine=fine) if held is None else held
    rolled = Rolled.at(section, balls, cast(SectionSplines, own.splines).sites, own.near)
    if held is None:
        check_folds(whole, balls, rolled)
    faces, outlines, feet = cut_sides(section, own), dict(whole.outlines), {}
    for wall, touch in rolled.touches.items():
        pivots = own.turning(wall, touch)
        faces |= around_wall(wall, touch, own)
        faces |= about_corners(wall, own, pivots, faces)
        chain = foot_of(touch, pivots)
        feet[wall] = [
            (end_row(faces[f"{wall}_fillet_{foot.name}"], -design.ends.index(wall)), foot.near, foot.against)
            for foot in chain
        ]
        outlines[wall] = tuple(run_back(curve) if against else curve for curve, _, against in feet[wall])

    def ends() -> tuple[dict[str, Face], dict[str, EndKnots]]:
        found: dict[str, Face] = {}
        knots_of = {}
        for name in design.ends:
            if name in rolled.touches:
                inner, known = whole.end_wall(name)[1], None if held is None else held.ends[name]
                wall = rolled.touches[name].ball.wall
                found[name], knots_of[name] = _end(wall, name, feet[name], inner, whole.chord, known)
            else:
                found[name] = whole.surfaces[name]
        return found, knots_of

    if held is None:
        made, ends_held = ends()
        own = replace(own, ends=FrozenMapping(ends_held))
        surfaces: Mapping[str, Face] = FrozenMapping({**faces, **made})
    else:
        surfaces = LazyFaces(faces, (*faces, *design.ends), lambda: ends()[0])
    walls = {
        name: (extended(touch.ball.wall.meridian, *own.ends[name].domain), whole.end_wall(name)[1])
        for name, touch in rolled.touches.items()
    }
    return replace(
        whole,
        design=design,
        surfaces=surfaces,
        knots=own,
        before=blade,
        moments=None,
        outlines=FrozenMapping(outlines),
        walls=FrozenMapping({**whole.walls, **walls}),
    )


def cut_sides(section: ClosedSection, knots: FilletKnots) -> dict[str, Surface]:
    """What is left of the sides above the strips."""
    return {
        FACES[face]: reparametrised(piece(surface, *levels(knots.strips), "v"), 0.0, 1.0, "v")
        for face, surface in section.faces.items()
    }


def around_wall(wall: str, touch: Touch | SteppedTouch, knots: FilletKnots) -> dict[str, Surface]:
    """The strips and fillets at a wall, but for those about corners."""
    around, strip, upwards = cast(SectionSplines, knots.splines), knots.strips[wall], wall == "hub"
    above = np.swapaxes(touch.above(strip, strip.sites), 0, 1)
    starts, insides = zip(*map(around.split, touch.start(strip)), strict=True), around.split(above)
    nets = around.split(np.swapaxes(touch.net(), 0, 1))
    found = {}
    for (face, side), start, inside, across in zip(touch.section.faces.items(), starts, insides, nets, strict=True):
        own = around.knots_of[face]
        end = strip.side_end(side, own)
        if touch.section.has_corners(face):
            end[1:] = [around.split(each)[list(touch.section.faces).index(face)] for each in touch.end(strip)[1:]]
        rows = strip.net(start, np.swapaxes(inside, 0, 1), end)
        # one row, to the bit
        across[:, 0] = rows[0]
        clamp = np.repeat([0.0, 1.0], across.shape[1])
        found[f"{wall}_strip_{FACES[face]}"] = _face(np.swapaxes(rows, 0, 1), own, strip.knots, upwards=upwards)
        found[f"{wall}_fillet_{FACES[face]}"] = _face(across, own, clamp, upwards=not upwards)
    return found


def about_corners(
    wall: str, own: FilletKnots, pivots: Sequence[Turning], faces: Mapping[str, Surface]
) -> dict[str, Surface]:
    """The fillets about corners, between those of `faces`."""
    nets: list[Array] = []
    found, upwards = {}, wall == "shroud"

    def beside(pair: tuple[int, float]) -> Array:
        column = faces[f"{wall}_fillet_{FACES[pair[0]]}"].control_points[-1 if pair[1] else 0]
        return column if upwards else column[::-1]

    for (pivot, sites, ball), (_, knots) in zip(pivots, own.pivots[wall], strict=True):
        values = np.swapaxes(ball.sections.net(), 0, 1)
        net = np.tensordot(np.linalg.inv(basis(knots, DEGREE, sites)), values, axes=1)
        # the columns of the fillets beside it, to the bit
        net[0] = beside(pivot.corner.first) if pivot.first else nets[-1][-1]
        if pivot.last:
            net[-1] = beside(pivot.corner.second)
        if pivot.pole:
            net[:, 0] = net[0, 0] if pivot.first else net[-1, 0]
        nets.append(net)
        clamp = np.repeat([0.0, 1.0], net.shape[1])
        found[f"{wall}_fillet_{pivot.name}"] = _face(net, knots, clamp, upwards=upwards)
    return found


def _face(net: Array, knots_u: Reals, knots_v: Reals, *, upwards: bool) -> Surface:
    """A face from its net along u and away from the joint of fillet and strip; v runs along the span."""
    net, knots_v = (net, knots_v) if upwards else (net[:, ::-1], 1.0 - knots_v[::-1])
    return Surface(
        control_points=net,
        knots_u=knots_u,
        knots_v=knots_v,
        degree_u=DEGREE,
        degree_v=len(knots_v) - net.shape[1] - 1,
    )


def _end(
    own: Wall, name: str, feet: Sequence[tuple[Curve, Near, bool]], inner: Reals, chord: float, held: EndKnots | None
) -> tuple[TrimmedSurface, EndKnots]:
    """The end face inside the feet of the fillet."""
    t, across = (np.concatenate([near[i] for _, near, _ in feet]) for i in (1, 2))
    domain = _reach(own.meridian, t) if held is None else held.domain
    low, high = stretch_about(across, name, revolved=own.revolved) if held is None else (held.low, held.high)
    meridian = extended(own.meridian, *domain)
    wall = WallSurface(meridian=meridian, inner=inner, revolved=own.revolved, low=low, high=high)
    return end_within(wall, feet, float(np.real(chord)), held)


def _reach(meridian: Curve, t: Reals) -> tuple[float, float]:
    """Between which parameters a meridian lies about all feet."""
    low, high = meridian.domain
    margin = REACH * float(np.ptp(t))
    first, last = float(np.min(t)), float(np.max(t))
    return low if first > low else first - margin, high if last < high else last + margin
