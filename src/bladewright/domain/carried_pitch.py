"""One pitch of a wall with what carries it: the wall's face between the outline's ends, and the outline."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.knots import DEGREE
from bladewright.domain.disc import KINDS, Carrier, Kind, carrier, shortfalls
from bladewright.domain.extents import MAX_EXTENT
from bladewright.domain.knot_selection import skin_extents, skin_knots
from bladewright.domain.knots import BLADE_AT, PassageKnots
from bladewright.domain.passage_spec import PassageSpec
from bladewright.domain.skin import Skin, trimmed_wall
from bladewright.domain.wall_line import WallLine
from bladewright.errors import DesignError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, frozen, length
from bladewright.nurbs.basis import Reals, breaks, greville, multiplicities
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.revolution import LEFT_HANDED
from bladewright.nurbs.transform import rotated
from bladewright.nurbs.trimmed import TrimmedSurface

FURTHER = 0.01
"""By how much more than needed the skin is made longer, in mean meridional lengths of the blade: what its wall is short
of is measured along it, and extents are means over the span."""
LENGTHENINGS = 12
"""How often it is: each time by what its wall is short of the outline's end."""
HALVED = 8
"""How often the length that is too much is halved, to say how far the wall can be continued."""
SURE = 0.95
"""Share of that length that is said: near the axis, where most end, lines wind ever more tightly."""
LINE_TOLERANCE = 1e-10
"""Largest error of the wall's line, of its length: 1e-8 mm on 100 mm."""
HALVINGS = 8
"""How often knot spans of the line are halved at most."""
OUTLINE_POINTS = 201
"""Points on each curve of the blade's end by which it is judged whether it lies between the outline's ends."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CarriedPitch(FrozenRecord):
    """One pitch of the wall that carries the blades, from one end of the outline to the other."""

    skin: Skin
    carrier: Carrier
    knots: Reals
    """of the wall's line over [0, 1]"""

    @property
    def kind(self) -> Kind:
        """Whether it is a disc or a shroud ring."""
        return self.carrier.kind

    @property
    def half_pitch(self) -> float:
        """[rad]."""
        return float(np.real(self.skin.half_pitch))

    @cached_property
    def line(self) -> Curve:
        """The middle line of the pitch in space over [0, 1], in proportion to meridional length."""
        return _line(self.carrier, self.knots)

    def periodic(self, sign: int) -> Curve:
        """The upper (+1) or lower (-1) line of the pitch."""
        return rotated(self.line, sign * self.half_pitch, axis=LEFT_HANDED)

    @cached_property
    def face(self) -> TrimmedSurface:
        """The wall between them, with the blade's end as a hole."""
        return trimmed_wall(self.skin, self.kind.wall, [self.periodic(-1)], [self.periodic(1)])


def carried_pitches(blade: Blade, known: PassageKnots | None, lines: Mapping[str, Reals] | None) -> list[CarriedPitch]:
    """The pitch of each wall that a disc or a ring lies on, at given knots or at their own.

    Raises DesignError where there is none, or it does not carry the whole blade.
    """
    design = blade.design
    wanted = [kind for kind in KINDS if getattr(design, kind.field) is not None]
    if design.blade_count is None:
        raise DesignError(f"arrangement is 'linear': '{design.name}' is a cascade, and sectors and wheels are annular")
    if not wanted:
        raise DesignError(
            f"neither disc nor shroud_ring is given: a sector or wheel of '{design.name}' needs what carries them; "
            "add a table [disc] with the thickness of a rim under the hub, or with an outline in (x, r)"
        )
    spec = PassageSpec(
        blade=blade,
        exact=blade.exact.without_clearance(),
        half_pitch=np.asarray(0.5 * design.spacing),
        turned=(None, None),
    )
    skin = _skin(spec, known) if known is not None else _long_enough(spec, wanted)
    found = []
    for kind in wanted:
        own = carrier(kind, getattr(design, kind.field), _wall_line(skin, kind), design.metre)
        _check_carried(skin, own)
        found.append(
            CarriedPitch(skin=skin, carrier=own, knots=_line_knots(own) if lines is None else lines[kind.field])
        )
    return found


def _skin(spec: PassageSpec, knots: PassageKnots) -> Skin:
    camber = spec.camber(knots, knots.sites("span"))
    return Skin(blade=spec.blade, camber=camber, knots=knots, half_pitch=spec.half_pitch)


def _long_enough(spec: PassageSpec, wanted: list[Kind]) -> Skin:
    """A skin that reaches past the outlines' ends."""
    skin = _skin(spec, skin_knots(spec, None, None, filled=False))
    for _ in range(LENGTHENINGS):
        short = np.max([_short(skin, kind) for kind in wanted], axis=0)
        if not short.any():
            return skin
        own = np.array([skin.knots.upstream, skin.knots.downstream])
        longer = np.minimum(own + np.where(short > 0.0, short / skin.knots.length + FURTHER, 0.0), MAX_EXTENT)
        if np.all(longer == own):
            _refuse(skin, wanted, f"that is {MAX_EXTENT:g} meridional lengths of the blade")
        try:
            skin = _reaching(spec, longer)
        except DesignError as error:
            _refuse(_longest(spec, skin, longer), wanted, str(error))
    return skin


def _reaching(spec: PassageSpec, extents: Reals) -> Skin:
    upstream, downstream = (float(each) for each in extents)
    skin = _skin(spec, skin_knots(spec, upstream, downstream, filled=False))
    _ = skin.walls  # they are made when asked for, and may be refused then
    return skin


def _short(skin: Skin, kind: Kind) -> tuple[float, float]:
    design = skin.blade.design
    return shortfalls(getattr(design, kind.field), _wall_line(skin, kind), design.metre)


def _longest(spec: PassageSpec, skin: Skin, extents: Reals) -> Skin:
    """About the longest skin between one that is possible and extents that are not, by halving."""
    low, high = np.array([skin.knots.upstream, skin.knots.downstream]), extents
    for _ in range(HALVED):
        middle = 0.5 * (low + high)
        try:
            skin_extents(spec, *(float(each) for each in middle), filled=False)
            low = middle
        except DesignError:
            high = middle
    return _reaching(spec, np.maximum(SURE * low, [skin.knots.upstream, skin.knots.downstream]))


def _refuse(skin: Skin, wanted: list[Kind], why: str) -> None:
    """Refuse the first outline end that the longest skin does not reach, and say how far that reaches."""
    design = skin.blade.design
    for kind in wanted:
        given, line = getattr(design, kind.field), _wall_line(skin, kind)
        for edge, short in enumerate(_short(skin, kind)):
            if short == 0.0:
                continue
            way = ("upstream", "downstream")[edge]
            x, r = np.real(line.at(np.asarray(line.curve.domain[edge]))) / design.metre
            if given.outline is None:
                name, value = f"{kind.field}.{way}", f"{np.real(getattr(given, way)):.6g}"
                first, last, whole = np.real(line.reached(np.array([*line.blade, line.curve.domain[1]])))
                most = f"{(first, whole - last)[edge] / design.metre:.4g}"
            else:
                point = given.outline.points[-edge]
                name = f"{kind.field}.outline.points[{edge and len(given.outline.points) - 1}]"
                value, most = f"({np.real(point.x):.6g}, {np.real(point.r):.6g})", "that"
            raise DesignError(
                f"{name} is {value}, and {way} of the blade the {kind.wall} can be continued to ({x:.6g}, {r:.6g}) "
                f"only: take {most} at most. What stops it: {why}"
            )


def _wall_line(skin: Skin, kind: Kind) -> WallLine:
    """The wall's line, on which the blade begins and ends with its camber line, or where its edges are cut."""
    wall, blade = skin.walls[kind.wall], skin.blade
    first, last = (np.asarray(at) for at in BLADE_AT)
    line = WallLine(
        curve=skin.periodic_line(kind.wall, 0), blade=(first, last), meridian=wall.meridian, joints=wall.inner
    )
    corners = blade.unfilleted.sides[0].control_points[:, 0 if kind.wall == "hub" else -1]
    if "leading_edge" in blade.walls:
        first = line.beside(corners[0])
    if "trailing_edge" in blade.walls:
        last = line.beside(corners[-1])
    return replace(line, blade=(first, last))


def _line(own: Carrier, knots: Reals) -> Curve:
    sites = greville(knots, DEGREE)
    return interpolated(_on_line(own, sites), sites, degree=DEGREE, knots=knots)


def _on_line(own: Carrier, share: Reals) -> Array:
    """Points (k, 3) of the wall's line at shares of the meridional length between the outline's ends."""
    line = own.line
    first, last = line.reached(np.array(own.ends))
    inner = line.parameter(first + (last - first) * share[1:-1])
    return line.curve(np.concatenate([[own.ends[0]], inner, [own.ends[1]]]))


def _line_knots(own: Carrier) -> Reals:
    """Knots over [0, 1] with which the line is accurate; one continuous derivative is kept where the blade begins."""
    start, end = (float(np.real(each)) for each in own.ends)
    inner, counts = multiplicities(own.line.curve.knots)
    within = (inner > start) & (inner < end)
    first, *reached, last = np.real(own.line.reached(np.array([start, *inner[within], end])))
    shares = (np.array(reached) - first) / (last - first)
    inner = np.repeat(shares, np.minimum(counts[within], DEGREE - 1))
    knots = np.concatenate([np.zeros(DEGREE + 1), inner, np.ones(DEGREE + 1)])
    for _ in range(HALVINGS):
        spans = breaks(knots)
        places = (spans[:-1, None] + np.diff(spans)[:, None] * np.array([0.2, 0.5, 0.8])).ravel()
        # with the ends, which are known without a search
        miss = np.real(_line(own, knots)(places) - _on_line(own, np.array([0.0, *places, 1.0]))[1:-1])
        poor = length(miss).reshape(-1, 3).max(axis=1) > LINE_TOLERANCE * (last - first)
        if not poor.any():
            break
        knots = np.sort(np.concatenate([knots, (0.5 * (spans[1:] + spans[:-1]))[poor]]))
    return frozen(knots)


def _check_carried(skin: Skin, own: Carrier) -> None:
    """Refuse an outline between whose ends the blade's end, or its fillet's foot, does not lie."""
    design, kind = skin.blade.design, own.kind
    curves = skin.blade.end_outline(kind.wall)
    points = np.concatenate([np.real(curve(np.linspace(*curve.domain, OUTLINE_POINTS))) for curve in curves])
    places = np.stack([points[:, 0], length(points[:, 1:])], axis=-1)
    line = own.line
    ends = np.real(line.at(np.array([np.real(end) for end in own.ends])))
    along = np.real(line.at(np.array([np.real(end) for end in own.ends]), 1))
    for which, (end, slope, way) in enumerate(zip(ends, along, (1.0, -1.0), strict=True)):
        ahead = way * (places - end) @ slope
        nearest = int(np.argmin(ahead))
        if ahead[nearest] <= 0.0:
            (x, r), (at_x, at_r) = places[nearest] / design.metre, end / design.metre
            edge, where = ("leading", "upstream") if which == 0 else ("trailing", "downstream")
            cure = f"let the outline end further {where}"
            if getattr(design, kind.field).outline is None:
                stated, blade = np.real(line.reached(np.array([own.ends[which], line.blade[which]])))
                least = way * (blade - stated) - ahead[nearest] / np.sqrt(slope @ slope)
                cure = f"let {kind.field}.{where} be more than {least / design.metre:.4g}"
            raise DesignError(
                f"{kind.field}: its outline ends at ({at_x:.6g}, {at_r:.6g}) on the {kind.wall}, and the blade or its "
                f"fillet reaches to ({x:.6g}, {r:.6g}) at the {edge} edge: {cure}"
            )
