"""Blades with fillets: a ball rolls along the sides and a wall; between its contacts is the fillet, above it a strip.

Contacts are found at sites around the blade, cross-sections run from contact to contact, and splines around the blade
carry both the cross-sections and the strip above them, so that the joint is one row of control points for both. Above
the strip the sides are what they were, cut at one v.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import FACES, LOWER, UPPER, ClosedSection, SectionSplines
from bladewright.blade.native.end_faces import EDGES, EndKnots, WallSurface, end_row, end_within, stretch_about
from bladewright.blade.native.fillet_knots import FilletKnots, chosen_knots, levels
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.lazy_faces import Face, LazyFaces
from bladewright.blade.native.rolling_ball import WALLS, Rolled, Touch, balls_of, closed_section
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended, piece, reparametrised
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign
    from bladewright.blade.native.stepped_fillet import SteppedTouch

SIDES = ("upper", "lower")
REACH = 0.05
"""How far the meridian of a wall is continued past the foot of a fillet, as a share of the foot's length."""


def filleted(blade: Blade, design: RowDesign, knots: Knots | None = None, *, fine: bool = False) -> Blade:
    """The blade with the fillets that the design asks for, at its own knots where they are held.

    Raises DesignError where a fillet does not hold.
    """
    _check_round(blade, design)
    section = closed_section(blade)
    balls = balls_of(blade, section, design)
    held = knots if isinstance(knots, FilletKnots) else None
    own = chosen_knots(blade, section, balls, fine=fine) if held is None else held
    rolled = Rolled.at(section, balls, cast(SectionSplines, own.splines).sites, own.near)
    faces = cut_sides(section, own)
    outlines = dict(blade.outlines)
    for wall, touch in rolled.touches.items():
        faces |= around_wall(wall, touch, own)
        upper, lower = (end_row(faces[f"{wall}_fillet_{name}"], -design.ends.index(wall)) for name in SIDES)
        outlines[wall] = (lower, run_back(upper))

    def ends() -> tuple[dict[str, Face], dict[str, EndKnots]]:
        found: dict[str, Face] = {}
        knots_of = {}
        for name in design.ends:
            if name in rolled.touches:
                feet = outlines[name][0], run_back(outlines[name][1])
                inner, known = blade.end_wall(name)[1], None if held is None else held.ends[name]
                found[name], knots_of[name] = _end(rolled.touches[name], name, feet, inner, blade.chord, known)
            else:
                found[name] = blade.surfaces[name]
        return found, knots_of

    if held is None:
        made, ends_held = ends()
        own = replace(own, ends=FrozenMapping(ends_held))
        surfaces: Mapping[str, Face] = FrozenMapping({**faces, **made})
    else:
        surfaces = LazyFaces(faces, (*faces, *design.ends), lambda: ends()[0])
    walls = {
        name: (extended(touch.ball.wall.meridian, *own.ends[name].domain), blade.end_wall(name)[1])
        for name, touch in rolled.touches.items()
    }
    return replace(
        blade,
        design=design,
        surfaces=surfaces,
        knots=own,
        before=blade,
        moments=None,
        outlines=FrozenMapping(outlines),
        walls=FrozenMapping({**blade.walls, **walls}),
    )


def cut_sides(section: ClosedSection, knots: FilletKnots) -> dict[str, Surface]:
    """What is left of the sides above the strips."""
    return {
        FACES[face]: reparametrised(piece(surface, *levels(knots.strips), "v"), 0.0, 1.0, "v")
        for face, surface in section.faces.items()
    }


def around_wall(wall: str, touch: Touch | SteppedTouch, knots: FilletKnots) -> dict[str, Surface]:
    """The strips and fillets at a wall."""
    around, strip, upwards = cast(SectionSplines, knots.splines), knots.strips[wall], wall == "hub"
    above = np.swapaxes(touch.above(strip, strip.sites), 0, 1)
    starts, insides = zip(*map(around.split, touch.start(strip)), strict=True), around.split(above)
    nets = around.split(np.swapaxes(touch.net(), 0, 1))
    found = {}
    for (face, side), start, inside, across in zip(touch.section.faces.items(), starts, insides, nets, strict=True):
        own = around.knots_of[face]
        rows = strip.net(start, np.swapaxes(inside, 0, 1), strip.side_end(side, own))
        # one row, to the bit
        across[:, 0] = rows[0]
        clamp = np.repeat([0.0, 1.0], across.shape[1])
        found[f"{wall}_strip_{FACES[face]}"] = _face(np.swapaxes(rows, 0, 1), own, strip.knots, upwards=upwards)
        found[f"{wall}_fillet_{FACES[face]}"] = _face(across, own, clamp, upwards=not upwards)
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
    touch: Touch, name: str, feet: tuple[Curve, Curve], inner: Reals, chord: float, held: EndKnots | None
) -> tuple[TrimmedSurface, EndKnots]:
    """The end face inside the feet (lower, upper) of the fillet."""
    found, own = touch.found, touch.ball.wall
    t, across = np.real(found.t), np.real(found.across)
    domain = _reach(own.meridian, t) if held is None else held.domain
    low, high = stretch_about(across, name, revolved=own.revolved) if held is None else (held.low, held.high)
    meridian = extended(own.meridian, *domain)
    wall = WallSurface(meridian=meridian, inner=inner, revolved=own.revolved, low=low, high=high)
    chain = []
    for index, foot in zip((LOWER, UPPER), feet, strict=True):
        which = np.flatnonzero(found.sites.side == index)
        which = which[np.argsort(found.sites.u[which])]
        near = found.sites.u[which], t[which], across[which]
        chain.append((foot, near, index == UPPER))
    return end_within(wall, chain, float(np.real(chord)), held)


def _reach(meridian: Curve, t: Reals) -> tuple[float, float]:
    """Between which parameters a meridian lies about all feet."""
    low, high = meridian.domain
    margin = REACH * float(np.ptp(t))
    first, last = float(np.min(t)), float(np.max(t))
    return low if first > low else first - margin, high if last < high else last + margin


def _check_round(blade: Blade, design: RowDesign) -> None:
    """Refuse corners along the blade, about which the ball would have to pivot."""
    name = next(f"{wall}_fillet" for wall in WALLS if getattr(design, f"{wall}_fillet") is not None)
    sections = blade.exact.survey
    edges = [
        ("cut" if edge in blade.surfaces and kind == "round" else kind, edge)
        for edge, kind in zip(EDGES, sections.edge_kinds, strict=True)
    ]
    corner = next((f"its {edge.replace('_', ' ')} is {kind}" for kind, edge in edges if kind != "round"), None)
    if corner is not None:
        raise DesignError(
            f"{name} is given, but the blade has corners, for {corner}: the ball rolls around round edges only; round "
            "the edges off, or leave the fillet out"
        )
