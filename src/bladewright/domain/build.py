"""From a native blade to its flow passage."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import cast

import numpy as np

from bladewright.blade.blade import Blade
from bladewright.blade.knots import DEGREE
from bladewright.blade.meant import Meant
from bladewright.domain.camber import CamberLines, camber_lines
from bladewright.domain.checks import check_duct, check_folds, check_pitch
from bladewright.domain.crossing import CROSSINGS, GATHERED, Crossing
from bladewright.domain.duct import Duct
from bladewright.domain.extents import end_cambers, extents, openings, shortest_duct
from bladewright.domain.fitness import RESERVE, TOLERANCE, knots_across, knots_along, knots_beside, knots_span
from bladewright.domain.folding import ROOMY, least_share
from bladewright.domain.knots import PassageKnots
from bladewright.domain.nets import BladeNets, native_nets
from bladewright.domain.passage import Passage
from bladewright.domain.strip import ACROSS, EDGE_FACES, STRIPS, WallStrip, strips
from bladewright.domain.wall import WallHalf, halves
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, radians
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.refine import inserted
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.section.checks import UNITS, number

Turned = tuple[Array | None, Array | None]
"""d theta / dm' at inlet and outlet, where stated"""
Asked = tuple[float | None, float | None]
"""extents up- and downstream, where stated"""


def passage(
    blade: Blade,
    *,
    upstream: float | None = None,
    downstream: float | None = None,
    inlet_angle: complex | None = None,
    outlet_angle: complex | None = None,
    knots: PassageKnots | None = None,
    split: bool = False,
) -> Passage:
    """The flow passage around a blade, as native patches that close up without trimming.

    `upstream` and `downstream` are how far the duct reaches past the edges, in mean meridional lengths of the blade;
    where not given, one half, or what the pitch needs. Camber lines go on at the slope of their ends; with
    `inlet_angle` or `outlet_angle` [deg] they turn to that angle from the meridional direction. `knots=passage.knots`
    holds another passage's knots and extents. Walls, periodic boundaries, inlet and outlet have creases where the
    blade's edges are; `split=True` cuts them there into faces without any.

    Raises DesignError where a patch would fold, the channel cannot be continued so far, or the blade does not keep
    within its pitch. Agromayor et al. 2021, section 4.
    """
    if hasattr(blade, "camber"):
        raise DesignError(
            "passage: a 2D section was given: use section_passage for its flow domain, or build prismatic(design) first"
        )
    full = blade.exact.whole()
    turned = _slope("inlet_angle", inlet_angle), _slope("outlet_angle", outlet_angle)
    half = _half_pitch(blade)
    held = knots is not None
    if knots is None:
        _check_within(blade, half)
        knots = _knots(blade, full, half, turned, (upstream, downstream))
    else:
        for name, given in (("upstream", upstream), ("downstream", downstream)):
            if given is not None and given != getattr(knots, name):
                raise DesignError(
                    f"{name} is {given!r}, but the knots given hold {getattr(knots, name):g}: leave one of them out"
                )
    camber, walls, between = _plane(blade, full, knots, half, turned, knots.sites("span"))
    upper, lower = (_with_knots(side, knots.blade) for side in blade.sides)
    own = BladeNets(
        upper.control_points,
        lower.control_points,
        [cast(Surface, blade.surfaces[name]).control_points if name in blade.surfaces else None for name in EDGE_FACES],
    )
    nets = native_nets(camber, walls, between, own, knots, half)
    surfaces: dict[str, Surface | TrimmedSurface] = {name: _surface(net, name, knots) for name, net in nets.items()}
    surfaces |= {"blade_upper": upper, "blade_lower": lower}
    surfaces |= {f"blade_{name}": blade.surfaces[name] for name in EDGE_FACES if name in blade.surfaces}
    surfaces |= {name: face for name, face in blade.surfaces.items() if name == "tip"}
    made = Passage(
        blade=blade,
        whole=MappingProxyType(surfaces),
        knots=knots,
        camber=camber,
        walls=walls,
        strips=between,
        split=split,
    )
    if not held:
        check_folds(made.folds)
        _check_reached(made)
    return made


def _slope(name: str, degrees: complex | None) -> Array | None:
    if degrees is None:
        return None
    angle = number(name, degrees)
    if not -89.0 < np.real(angle) < 89.0:
        raise DesignError(f"{name} is {np.real(angle):g} deg: it must lie between -89 and 89 deg, as flow goes onwards")
    return np.asarray(np.tan(radians(angle)))


def _half_pitch(blade: Blade) -> Array:
    design = blade.design
    if design.blade_count:
        return np.asarray(np.pi / design.blade_count)
    return np.asarray(0.5 * UNITS[design.length_unit] * np.asarray(design.pitch))


def _real_half(half: Array) -> float:
    return float(np.real(half).flat[0])


def _check_within(blade: Blade, half: Array) -> None:
    exact = blade.exact
    check_pitch(camber_lines(exact.survey, shortest_duct(exact)), blade, _real_half(half))


def _duct(full: Meant, knots: PassageKnots) -> Duct:
    return Duct(
        channel=full.meridians,
        start=knots.start,
        end=knots.end,
        edges=knots.edges,
        length=knots.length,
        unit=knots.unit,
        low=knots.low,
        high=knots.high,
        revolved=full.mapping.revolved,
    )


def _plane(
    blade: Blade, full: Meant, knots: PassageKnots, half: Array, turned: Turned, v: Reals
) -> tuple[CamberLines, Mapping[str, WallHalf], Mapping[str, WallStrip]]:
    """Camber lines, walls' halves and strips with stations at v (m,), hub first and shroud last."""
    duct, joints = _duct(full, knots), np.unique(full.breaks_along_v())
    camber, ends = (
        camber_lines(full.stations(places), duct, turned, joints, knots.crossing.quick) for places in (v, v[[0, -1]])
    )
    touched = {wall: wall in blade.surfaces for wall in ("hub", "shroud")}
    return camber, halves(ends, touched, half, knots.opening, knots.crossing), strips(ends, touched)


def _knots(blade: Blade, full: Meant, half: Array, turned: Turned, asked: Asked) -> PassageKnots:
    start, walls = _crossed(blade, full, half, turned, asked)
    tolerance = RESERVE * TOLERANCE * blade.chord
    return replace(
        start,
        blade=knots_beside(walls, blade.knots.u, tolerance),
        inlet=knots_along(walls, "inlet", tolerance),
        outlet=knots_along(walls, "outlet", tolerance),
        across=knots_across(walls, tolerance),
        span=knots_span(lambda v: _plane(blade, full, start, half, turned, v)[0], full.breaks_along_v(), tolerance),
    )


def _crossed(
    blade: Blade, full: Meant, half: Array, turned: Turned, asked: Asked
) -> tuple[PassageKnots, Mapping[str, WallHalf]]:
    """The first way for cross-lines in which no wall is near to folding, or else the best, and the walls.

    What comes back has extents, but no knots yet.
    """
    tried: list[tuple[float, PassageKnots, Mapping[str, WallHalf]]] = []
    for crossing in GATHERED if full.survey.gathered else CROSSINGS:
        try:
            start = _rough(blade, full, half, crossing, extents(full, half, crossing, *asked))
            check_duct(_duct(full, start), full.course)
        except DesignError:
            if not tried:
                raise
            break
        walls = _plane(blade, full, start, half, turned, np.array([0.0, 1.0]))[1]
        tried.append((least_share(walls), start, walls))
        if tried[-1][0] > ROOMY:
            break
    _, start, walls = max(tried, key=lambda each: each[0])
    return start, walls


def _rough(blade: Blade, full: Meant, half: Array, crossing: Crossing, reaches: tuple[float, float]) -> PassageKnots:
    rough = np.concatenate([np.zeros(DEGREE + 1), np.ones(DEGREE + 1)])
    course = full.course
    return PassageKnots(
        length=course.length,
        unit=course.unit,
        edges=course.edges,
        upstream=reaches[0],
        downstream=reaches[1],
        low=course.place(0, reaches[0]),
        high=course.place(1, reaches[1]),
        start=course.start,
        end=course.end,
        opening=openings(end_cambers(full), _real_half(half)),
        crossing=crossing,
        blunt=(EDGE_FACES[0] in blade.surfaces, EDGE_FACES[1] in blade.surfaces),
        blade=blade.knots.u,
        inlet=rough,
        outlet=rough,
        across=rough,
        span=rough,
    )


def _with_knots(side: Surface, knots: Reals) -> Surface:
    """A side with more knots along u, its shape unchanged."""
    if len(knots) == len(side.knots_u):
        return side
    missing = list(knots)
    for knot in side.knots_u:
        missing.remove(knot)
    return inserted(side, np.array(missing), "u")


def _surface(net: Array, name: str, knots: PassageKnots) -> Surface:
    if name in {"inlet", "outlet"}:
        along, across = knots.around(int(name == "outlet")), knots.span
    elif name.endswith(STRIPS):
        along, across = knots.outlet if name.endswith(STRIPS[1]) else knots.inlet, ACROSS
    elif name.startswith("periodic"):
        along, across = knots.u, knots.span
    else:
        along, across = knots.u, knots.across
    return Surface(control_points=net, knots_u=along, knots_v=across, degree_u=DEGREE, degree_v=DEGREE)


def _check_reached(made: Passage) -> None:
    if made.wall_error <= TOLERANCE:
        return
    raise DesignError(
        f"passage: hub and shroud lie {made.wall_error:.2g} of the chord off their surfaces of revolution, at most "
        f"{TOLERANCE:g} is allowed: shorten upstream or downstream, let the flow turn to a lower angle there, or lower "
        "the blade's tolerance, so that it has more knots along the chord"
    )
