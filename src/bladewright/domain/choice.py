"""Real choices for a passage: extents, the way of cross-lines, and knots; held while a design is differentiated."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bladewright.blade.knots import DEGREE, clamped
from bladewright.domain.abreast import kept_abreast
from bladewright.domain.asked import Asked
from bladewright.domain.checks import check_duct, check_folds
from bladewright.domain.crossing import CROSSINGS, GATHERED, Crossing
from bladewright.domain.extents import end_cambers, extents, openings
from bladewright.domain.fitness import knots_across, knots_along, knots_beside, knots_span
from bladewright.domain.folding import ROOMY, Least, least_share
from bladewright.domain.knots import PassageKnots
from bladewright.domain.wall import WallHalf
from bladewright.errors import DesignError


def knots_for(start: PassageKnots, walls: Mapping[str, WallHalf], tolerance: float) -> PassageKnots:
    """Knots with which each direction of the walls misses by at most a tolerance [m]; `start` has all others."""
    return replace(
        start,
        blade=knots_beside(walls, start.blade, tolerance),
        inlet=knots_along(walls, "inlet", tolerance),
        outlet=knots_along(walls, "outlet", tolerance),
        across=knots_across(walls, tolerance),
    )


def spanned(asked: Asked, start: PassageKnots, tolerance: float) -> PassageKnots:
    """The same with knots along the span, with which inlet and outlet miss by at most a tolerance [m]."""
    span = knots_span(lambda v: asked.camber(start, v), asked.full.breaks_along_v(), tolerance)
    return replace(start, span=span)


def crossed(
    asked: Asked, upstream: float | None, downstream: float | None
) -> tuple[PassageKnots, Mapping[str, WallHalf]]:
    """The first way for cross-lines in which no wall is near to folding, or else the best, and the walls.

    `upstream` and `downstream` are extents, where stated. What comes back has extents, but no knots yet.
    """
    full = asked.full
    tried: list[tuple[Least, PassageKnots, Mapping[str, WallHalf]]] = []
    for crossing in GATHERED if full.survey.gathered else CROSSINGS:
        try:
            start = _rough(asked, crossing, extents(full, asked.half, crossing, upstream, downstream))
            check_duct(asked.duct(start), full.course)
        except DesignError:
            if not tried:
                raise
            break
        walls = asked.plane(start, np.array([0.0, 1.0]))[1]
        tried.append((least_share(walls), start, walls))
        if tried[-1][0].share > ROOMY:
            break
    least, start, walls = max(tried, key=lambda each: each[0].share)
    check_folds({least.name: (least.share, least.u, least.v)})
    return start, walls


def _rough(asked: Asked, crossing: Crossing, reaches: tuple[float, float]) -> PassageKnots:
    rough = np.concatenate([np.zeros(DEGREE + 1), np.ones(DEGREE + 1)])
    course, ends = asked.full.course, end_cambers(asked.full)
    back = ends.stations.back
    whole, own = 1.0 if back is None else back, asked.blade.knots.u[DEGREE + 1 : -DEGREE - 1]
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
        opening=openings(ends, asked.real_half),
        crossing=crossing,
        abreast=kept_abreast(ends, crossing.quick),
        parted=ends.parted,
        back=back,
        blade=clamped(own[own < whole] / whole),
        tail=clamped(own[own > whole]),
        inlet=rough,
        outlet=rough,
        across=rough,
        span=rough,
    )
