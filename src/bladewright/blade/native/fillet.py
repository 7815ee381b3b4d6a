"""Blades with fillets: a ball rolls along the sides and a wall; what it touches is the fillet, the blade begins above.

Contacts are found at sites around the blade, cross-sections run from contact to contact, and splines around the blade
carry both the cross-sections and the blade above them, so that the joint is one row of control points for both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from bladewright.blade.native.above_fillet import SpanSplines
from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import LOWER, UPPER, SectionSplines
from bladewright.blade.native.end_faces import EndKnots, WallSurface, end_row, end_within, stretch_about
from bladewright.blade.native.fillet_knots import FilletKnots, chosen_knots
from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.blade.native.rolling_ball import Rolled, Touch, balls_of, closed_section, orders_of
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

SIDES = ("upper", "lower")
REACH = 0.05
"""How far the meridian of a wall is continued past the foot of a fillet, as a share of the foot's length."""


def filleted(blade: Blade, design: RowDesign, knots: Knots | None = None, *, fine: bool = False) -> Blade:
    """The blade with the fillets that the design asks for, at its own knots where they are held.

    Raises DesignError where a fillet does not hold.
    """
    _check_smooth(blade)
    section = closed_section(blade)
    balls = balls_of(blade, section, design)
    held = knots if isinstance(knots, FilletKnots) else chosen_knots(blade, section, balls, fine=fine)
    around = SectionSplines(knots=held.u, smooth=section.smooth)
    rolled = Rolled.at(section, balls, around.sites)
    along = SpanSplines(knots=held.v, orders=orders_of(balls))
    rows = along.net(rolled.above(held.joints, along.sites), rolled.derivatives(held.joints))
    faces: dict[str, Surface | TrimmedSurface] = {}
    for name, net in zip(SIDES, around.split(np.swapaxes(rows, 0, 1)), strict=True):
        faces[name] = Surface(control_points=net, knots_u=held.u, knots_v=held.v, degree_u=DEGREE, degree_v=DEGREE)
    ends, outlines, walls = dict(held.ends), dict(blade.outlines), dict(blade.walls)
    for wall, touch in rolled.touches.items():
        net = touch.sections.net()
        degree, net = len(net) - 1, np.swapaxes(net[::-1] if wall == "hub" else net, 0, 1)
        for name, part in zip(SIDES, around.split(net), strict=True):
            faces[f"{wall}_fillet_{name}"] = Surface(
                control_points=part,
                knots_u=held.u,
                knots_v=np.repeat([0.0, 1.0], degree + 1),
                degree_u=DEGREE,
                degree_v=degree,
            )
    for row, name in zip((0, -1), design.ends, strict=True):
        if name not in rolled.touches:
            faces[name] = blade.surfaces[name]
            continue
        feet = {side: end_row(cast(Surface, faces[f"{name}_fillet_{side}"]), row) for side in SIDES}
        touch, inner = rolled.touches[name], blade.end_wall(name)[1]
        faces[name], ends[name] = _end(touch, name, feet, inner, blade.chord, held.ends.get(name))
        outlines[name] = (feet["lower"], run_back(feet["upper"]))
        walls[name] = extended(touch.ball.wall.meridian, *ends[name].domain), inner
    return replace(
        blade,
        design=design,
        surfaces=FrozenMapping(faces),
        knots=replace(held, ends=FrozenMapping(ends)),
        before=blade,
        moments=None,
        outlines=FrozenMapping(outlines),
        walls=FrozenMapping(walls),
    )


def _end(
    touch: Touch, name: str, feet: Mapping[str, Curve], inner: Reals, chord: float, held: EndKnots | None
) -> tuple[TrimmedSurface, EndKnots]:
    """The end face inside the feet of the fillet."""
    found, own = touch.found, touch.ball.wall
    t, across = np.real(found.t), np.real(found.across)
    domain = _reach(own.meridian, t) if held is None else held.domain
    low, high = stretch_about(across, name, revolved=own.revolved) if held is None else (held.low, held.high)
    meridian = extended(own.meridian, *domain)
    wall = WallSurface(meridian=meridian, inner=inner, revolved=own.revolved, low=low, high=high)
    chain = []
    for index, side in ((LOWER, "lower"), (UPPER, "upper")):
        which = np.flatnonzero(found.sites.side == index)
        which = which[np.argsort(found.sites.u[which])]
        near = found.sites.u[which], t[which], across[which]
        chain.append((feet[side], near, index == UPPER))
    return end_within(wall, chain, float(np.real(chord)), held)


def _reach(meridian: Curve, t: Reals) -> tuple[float, float]:
    """Between which parameters a meridian lies about all feet."""
    low, high = meridian.domain
    margin = REACH * float(np.ptp(t))
    first, last = float(np.min(t)), float(np.max(t))
    return low if first > low else first - margin, high if last < high else last + margin


def _check_smooth(blade: Blade) -> None:
    if blade.edge_kinds != ("round", "round") or blade.back is not None:
        raise DesignError("a fillet was asked of a blade with a blunt or sharp edge: give it round edges")
