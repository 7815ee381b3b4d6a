"""From a native blade to its flow passage."""

from __future__ import annotations

from typing import Literal, cast

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.knots import DEGREE
from bladewright.domain.camber_lines import camber_lines
from bladewright.domain.checks import check_folds, check_pitch
from bladewright.domain.extents import shortest_duct
from bladewright.domain.knot_selection import (
    WALL_TOLERANCE,
    skin_knots,
    unfolded_walls,
    with_span_knots,
    with_wall_knots,
)
from bladewright.domain.knots import PassageKnots
from bladewright.domain.nets import BladeNets, native_nets
from bladewright.domain.passage import Passage
from bladewright.domain.passage_spec import PassageSpec
from bladewright.domain.skin import Skin, wall_face
from bladewright.domain.walls import EDGE_FACES, STRIPS
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, concatenated, radians
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.refine import inserted
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.section.checks import UNITS, number

TOLERANCE_SHARES = (0.5, 0.2, 0.08, 0.025)
"""Shares of the walls' tolerance that the knots of each direction may use, tried in turn until all directions together
keep the whole of it: most passages need the first only."""
WALLS = ("auto", "patches", "trimmed")
"""What hub and shroud may be asked to be made of."""
STEEPEST = 89.0
"""Largest angle of the flow from the meridional direction at inlet and outlet [deg]: its tangent must stay finite."""


def passage(
    blade: Blade,
    *,
    upstream: float | None = None,
    downstream: float | None = None,
    inlet_angle: complex | None = None,
    outlet_angle: complex | None = None,
    knots: PassageKnots | None = None,
    split: bool = False,
    walls: Literal["auto", "patches", "trimmed"] = "auto",
) -> Passage:
    """The flow passage around a blade.

    `walls` "patches" makes hub and shroud of untrimmed halves, which close up without trimming, but fold beside some
    blades; "trimmed" makes each one face of its exact surface, with the blade's end as a hole; "auto" takes patches
    where they do not fold, and else trimmed walls.
    `upstream` and `downstream` are how far the duct reaches past the edges, in mean meridional lengths of the blade;
    where not given, to the ends of the flow path, or without one, one half or what the pitch needs. Camber lines go on
    at the slope of their ends; with `inlet_angle` or `outlet_angle` [deg] they turn to that angle from the meridional
    direction. `knots=passage.knots` holds another passage's knots and extents. Walls, periodic boundaries, inlet and
    outlet have creases where the blade's edges are; `split=True` cuts them there into faces without any.

    Raises DesignError where a patch asked for would fold, the channel cannot be continued so far, or the blade does not
    keep within its pitch. Agromayor et al. 2021, section 4.
    """
    if blade.dimension == 2:
        raise DesignError(
            "passage: a 2D section was given: use section_passage for its flow domain, or build prismatic(design) first"
        )
    if walls not in WALLS:
        raise DesignError(f"walls is {walls!r}: choose {', '.join(map(repr, WALLS))}")
    turned = _slope("inlet_angle", inlet_angle), _slope("outlet_angle", outlet_angle)
    spec = PassageSpec(blade=blade, exact=blade.exact.without_clearance(), half_pitch=_half_pitch(blade), turned=turned)
    if knots is not None:
        asked = (("upstream", upstream), ("downstream", downstream), ("walls", None if walls == "auto" else walls))
        for name, given in asked:
            if given is not None and given != getattr(knots, name):
                raise DesignError(
                    f"{name} is {given!r}, but the knots given hold {getattr(knots, name)!r}: leave one of them out"
                )
        return _passage(spec, knots, split) if knots.walls == "patches" else _trimmed(spec, knots, split)
    if blade.before is not None and walls == "patches":
        raise DesignError(
            "walls is 'patches', and the blade has a cut or fillets, around which walls are trimmed: take 'auto'"
        )
    if walls != "trimmed" and blade.before is None:
        try:
            return _patched(spec, upstream, downstream, split)
        except DesignError:
            if walls == "patches":
                raise
    made = _trimmed(spec, skin_knots(spec, upstream, downstream), split)
    _check_walls(made)
    return made


def _patched(spec: PassageSpec, upstream: float | None, downstream: float | None, split: bool) -> Passage:
    """The passage with untrimmed walls, at knots of its own."""
    _check_within_pitch(spec)
    chord = spec.blade.chord
    start, walls = unfolded_walls(spec, upstream, downstream)
    start = with_span_knots(spec, start, TOLERANCE_SHARES[0] * WALL_TOLERANCE * chord)
    for share in TOLERANCE_SHARES:
        made = _passage(spec, with_wall_knots(start, walls, share * WALL_TOLERANCE * chord), split)
        if made.wall_error <= WALL_TOLERANCE:
            break
    check_folds(made.folds)
    _check_walls(made)
    return made


def _trimmed(spec: PassageSpec, knots: PassageKnots, split: bool) -> Passage:
    """The passage at given knots, its walls trimmed faces."""
    blade = spec.blade
    skin = Skin(blade=blade, camber=spec.camber(knots, knots.sites("span")), knots=knots, half_pitch=spec.half_pitch)
    walls = {wall: wall_face(skin, wall) for wall in ("hub", "shroud")}
    own = {name: face for name, face in blade.surfaces.items() if name not in blade.design.ends}
    surfaces = walls | skin.ends | skin.periodic | {f"blade_{name}": face for name, face in own.items()}
    surfaces |= {name: blade.surfaces[name] for name in blade.design.ends if name == "tip"}
    return Passage(
        blade=blade,
        whole=FrozenMapping(surfaces),
        knots=knots,
        camber=skin.camber,
        half_pitch=spec.half_pitch,
        skin=skin,
        split=split,
    )


def _passage(spec: PassageSpec, knots: PassageKnots, split: bool) -> Passage:
    """The passage at given knots."""
    blade = spec.blade
    camber, walls, strips = spec.plane(knots, knots.sites("span"))
    upper, lower = (_with_knots(side, knots.side) for side in blade.sides)
    own = _blade_nets(spec, knots)
    nets = native_nets(camber, walls, strips, own, knots, spec.half_pitch)
    surfaces: dict[str, Surface | TrimmedSurface] = {name: _surface(net, name, knots) for name, net in nets.items()}
    surfaces |= {"blade_upper": upper, "blade_lower": lower}
    surfaces |= {f"blade_{name}": blade.surfaces[name] for name in EDGE_FACES if name in blade.surfaces}
    surfaces |= {name: blade.surfaces[name] for name in blade.design.ends if name == "tip"}
    surfaces |= {f"{wall}_gap": face for wall, face in spec.faces_at_walls().items()}
    return Passage(
        blade=blade,
        whole=FrozenMapping(surfaces),
        knots=knots,
        camber=camber,
        half_pitch=spec.half_pitch,
        walls=walls,
        strips=strips,
        split=split,
    )


def _blade_nets(spec: PassageSpec, knots: PassageKnots) -> BladeNets:
    """The nets of the sides and of the faces of blunt edges; where a gap's wall has a face, to that wall."""
    names = ("upper", "lower", *EDGE_FACES)
    faces = spec.faces_at_walls()

    def net(blade: Blade, name: str) -> Array | None:
        if name not in blade.surfaces:
            return None
        face = cast(Surface, blade.surfaces[name])
        return (face if name in EDGE_FACES else _with_knots(face, knots.side)).control_points

    def whole(name: str) -> Array | None:
        own = net(spec.blade, name)
        if own is None or not faces:
            return own
        other = cast(Array, net(spec.blade.uncut, name))
        ends = [(other if wall in faces else own)[:, [row]] for wall, row in (("hub", 0), ("shroud", -1))]
        return concatenated([ends[0], own[:, 1:-1], ends[1]], axis=1)

    upper, lower, *edges = (whole(name) for name in names)
    return BladeNets(cast(Array, upper), cast(Array, lower), edges)


def _slope(name: str, degrees: complex | None) -> Array | None:
    """d theta / dm' of a flow angle."""
    if degrees is None:
        return None
    angle = number(name, degrees)
    if not -STEEPEST < np.real(angle) < STEEPEST:
        raise DesignError(f"{name} is {np.real(angle):g} deg: it must lie between -89 and 89 deg, as flow goes onwards")
    return np.asarray(np.tan(radians(angle)))


def _half_pitch(blade: Blade) -> Array:
    design = blade.design
    if design.blade_count:
        return np.asarray(np.pi / design.blade_count)
    return np.asarray(0.5 * UNITS[design.length_unit] * np.asarray(design.pitch))


def _check_within_pitch(spec: PassageSpec) -> None:
    exact = spec.blade.exact
    check_pitch(camber_lines(exact.survey, shortest_duct(exact)), spec.blade, spec.real_half_pitch)


def _with_knots(side: Surface, knots: Reals) -> Surface:
    """A side with more knots along u, its shape unchanged."""
    if len(knots) == len(side.knots_u):
        return side
    missing = list(knots)
    for knot in side.knots_u:
        # beside a back face the knots were scaled and scaled back, so they may differ by rounding
        del missing[int(np.argmin(np.square(np.array(missing) - knot)))]
    return inserted(side, np.array(missing), "u")


def _surface(net: Array, name: str, knots: PassageKnots) -> Surface:
    if name in {"inlet", "outlet"}:
        along, across = knots.around(int(name == "outlet")), knots.span
    elif name.endswith(STRIPS):
        edge = int(name.endswith(STRIPS[1]))
        along, across = knots.outlet if edge else knots.inlet, knots.strip(edge)
    elif name.startswith("periodic"):
        along, across = knots.u, knots.span
    else:
        along, across = knots.u, knots.across
    return Surface(control_points=net, knots_u=along, knots_v=across, degree_u=DEGREE, degree_v=DEGREE)


def _check_walls(made: Passage) -> None:
    if made.wall_error <= WALL_TOLERANCE:
        return
    raise DesignError(
        f"passage: hub and shroud lie {made.wall_error:.2g} of the chord off their surfaces of revolution, at most "
        f"{WALL_TOLERANCE:g} is allowed: shorten upstream or downstream, let the flow turn to a lower angle there, or "
        "lower the blade's tolerance, so that it has more knots along the chord"
    )
