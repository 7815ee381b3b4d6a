"""The same shape with other numbers of control points, as nearly as they allow, and with edges of a valid shape."""

from collections.abc import Collection
from dataclasses import replace
from functools import singledispatch
from typing import Any

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design, Law, Point, Points, Stations
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.model_selection.structure import (
    COMPARED_PLACES,
    MOST_SPAN,
    SPANWISE,
    SPARE_SAMPLES,
    Structure,
    law_field,
    resizable_laws,
    samples_of,
    structure_of,
    within_rows,
)
from bladewright.fitting.models.model import model_of
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.laws import Span, law_basis, law_points, sampled_at, stations_of, with_values
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES

LAW_LIMITS = {
    **dict.fromkeys(ANGLES, (-88.0, 88.0)),
    **dict.fromkeys(TANGENTS, (0.03, 0.99)),
    **dict.fromkeys(RADII, (1e-4, 0.9)),
}
"""within which a law is kept that another number of control points would carry past the family's own limits"""


@singledispatch
def reshaped(design: Design, structure: Any) -> Design:  # noqa: ARG001 - the contract's
    """A design of another structure whose laws and curves are nearest to those of `design`, by least squares."""
    raise FitError(
        f"a {type(design).__name__} has no laws that a fit knows: give a design of the unified family, or another"
    )


@reshaped.register
def _(design: UnifiedSection, structure: Structure) -> Design:
    thicknesses: dict[str, Any] = {
        name: tuple(float(row[0]) for row in grid_of(getattr(design, name), count, 1, structure))
        for name, count in zip(THICKNESSES, structure.chordwise, strict=True)
    }
    return replace(design, samples=structure.samples, clustering=structure.clustering, **thicknesses)


@reshaped.register
def _(design: UnifiedBlade, structure: Structure) -> Design:
    place = law_field(design, "place")
    changes: dict[str, Any] = {
        name: law_of(getattr(design, name), structure.span[name], LAW_LIMITS[name]) for name in SPANWISE
    }
    changes[place] = law_of(getattr(design, place), structure.span["place"])
    for name, count in zip(THICKNESSES, structure.chordwise, strict=True):
        stations = structure.stations.get(name)
        grid = grid_of(getattr(design, name), count, structure.span[name], structure, stations)
        changes[name] = tuple(_plain(row) if stations is None else with_values(stations, row) for row in grid)
    for name, stations in structure.stations.items():
        if name not in THICKNESSES:
            field = place if name == "place" else name
            changes[field] = sampled_at(getattr(design, field), stations)
    return replace(
        design,
        samples=structure.samples,
        clustering=structure.clustering,
        channel=_channel(design.channel, structure),
        **changes,
    )


def _values(law: Law) -> Reals:
    return np.asarray(Span(COMPARED_PLACES).values(law), dtype=float)


def law_of(law: Law, count: int, limits: tuple[float, float] = (-np.inf, np.inf)) -> Law:
    """The nearest law of so many control points, within limits."""
    if count == len(law_points(law)):
        return law
    found, *_ = np.linalg.lstsq(law_basis(count, COMPARED_PLACES), _values(law), rcond=None)
    return _plain(np.clip(np.asarray(found, dtype=np.float64), *limits))


def _plain(values: Reals) -> Law:
    return tuple(float(value) for value in values) if len(values) > 1 else float(values[0])


def grid_of(
    laws: tuple[Law, ...], count: int, span: int, structure: Structure, stations: Stations | None = None
) -> Reals:
    """Control points (count, span) of a thickness, or its values at stations, kept positive."""
    same = len(laws) == count
    if stations is not None:
        rows = np.stack([np.array(sampled_at(law, stations).values) for law in laws])
        if same:
            return rows
    elif same and all(len(law_points(law)) == span and stations_of(law) is None for law in laws):
        return np.array([law_points(law) for law in laws], dtype=float)
    else:
        across = law_basis(span, COMPARED_PLACES)
        rows = np.stack([np.linalg.lstsq(across, _values(law), rcond=None)[0] for law in laws])
    if len(laws) != count:
        # where the samples of the sides stand, the law matters most
        u = samples_of(structure)
        rows, *_ = np.linalg.lstsq(law_basis(count, u), law_basis(len(laws), u) @ rows, rcond=None)
    least = 0.02 * float(np.max(rows))
    return np.asarray(np.maximum(rows, least))


def _channel(channel: Channel, structure: Structure) -> Channel:
    corners = [channel.leading_edge[0], channel.leading_edge[-1], channel.trailing_edge[0], channel.trailing_edge[-1]]
    curves = {
        "leading_edge": channel.leading_edge,
        "trailing_edge": channel.trailing_edge,
        "hub": (corners[0], *channel.hub, corners[2]),
        "shroud": (corners[1], *channel.shroud, corners[3]),
    }
    found = {name: curve_of(points, structure.channel[name], channel.degree) for name, points in curves.items()}
    return replace(
        channel,
        leading_edge=found["leading_edge"],
        trailing_edge=found["trailing_edge"],
        hub=found["hub"][1:-1],
        shroud=found["shroud"][1:-1],
    )


def curve_of(points: Points, count: int, highest: int) -> Points:
    """The nearest curve of so many control points and at most the highest degree, between the same ends."""
    if count == len(points):
        return points
    old = np.array(points, dtype=float)
    before, after = (min(n - 1, highest) for n in (len(points), count))
    values = basis(uniform_knots(len(points), before), before, COMPARED_PLACES) @ old
    rows = basis(uniform_knots(count, after), after, COMPARED_PLACES)
    rhs = values - rows[:, [0, -1]] @ old[[0, -1]]
    inner, *_ = np.linalg.lstsq(rows[:, 1:-1], rhs, rcond=None)
    full = np.concatenate([old[:1], inner, old[-1:]])
    return tuple(Point(float(x), float(r)) for x, r in full)


THINNER_EDGES, MOST_THINNINGS = 0.7, 12
"""ratio by which the thickness beside the edges is reduced at a time, `MOST_THINNINGS` times at most."""


def with_feasible_edges(design: Design) -> Design:
    """The design, or one with thinner edges where given values leave it no shape; the last where none has.

    A camber that is turned away from the points may leave the third control points of the sides outside the edges.
    """
    if not isinstance(design, UnifiedSection | UnifiedBlade):
        return design
    for _ in range(MOST_THINNINGS):
        if _has_shape(design):
            break
        values = design.parameters()
        ends = tuple(f"{name}[{place}]" for name in THICKNESSES for place in (0, len(getattr(design, name)) - 1))
        design = design.changed(
            {path: THINNER_EDGES * value for path, value in values.items() if path.startswith(ends)}
        )
    return design


def widened_where_feasible(design: Design, structure: Any) -> Design:
    """The design of a wider structure, or where that has no shape, with those laws wider that leave it one.

    The nearest laws of other control points may fold stream surfaces, or part an edge from a wall; each is tried alone.
    """
    whole = with_feasible_edges(reshaped(design, structure))
    if _has_shape(whole):
        return whole
    own = structure_of(design)
    for law in resizable_laws(design):
        wider = law.resized(own, law.counts(structure)).with_samples(structure.samples)
        own = wider if _has_shape(reshaped(design, wider)) else own
    return reshaped(design, own)


def _has_shape(design: Design) -> bool:
    try:
        with np.errstate(all="ignore"):
            return model_of(design, EXACT).shape(design).finite
    except DesignError:
        return False


RICH_CHORDWISE = {2: 24, 3: 9}
"""control points along the chord of a rich structure, by dimension. Nine have six spans, whose knots include those of
one, two and three: cubic laws of 4, 5 and 6 control points are special cases of theirs (design/matching.md)."""
RICH_SPAN = {"thickness": 6, "radius": 4, "": 9}
"""control points along the span of its laws, by what their names say: six hold cubic laws of 4, nine of 4, 5 and 6."""
SHARES = (1.0, 0.8, 0.6, 0.4, 0.2, 0.0)
"""shares of the further control points of a rich structure that are tried where points are few
(design/matching_constants.md)."""
POINTS_PER_PARAMETER = 2
"""points for each parameter of a rich structure at least: published profiles have few points. Half and twice change
nothing measured (design/matching_constants.md)."""
RICH_CHANNEL = (9, 9, 6, 6)
"""control points of the edges, of hub and of shroud: six hold cubic curves of 4, nine of 4, 5 and 6."""


def rich_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, sampled: bool = False
) -> Any:
    """A structure with more control points in every law than a match of so many points is likely to need.

    Along the span it has no more of them than `rows` of points, and where it is to be `sampled`, along the chord no
    more than a design's own samples determine: further ones lie closer to the edges, where the thickness then has to
    bend like a nose (design/matching.md). Laws of which nothing is `free` keep theirs.
    """
    whole = richest(design)
    if sampled and isinstance(whole, Structure):
        own, determined = structure_of(design).chordwise, whole.samples - SPARE_SAMPLES
        upper, lower = (max(few, min(count, determined)) for few, count in zip(own, whole.chordwise, strict=True))
        whole = replace(whole, chordwise=(upper, lower))
    return _towards(whole, design, free, points, rows)


def wider_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, slim: bool = False
) -> Any:
    """A structure with a third as many control points again in every law of a design, and a rich one at least.

    Along the span it has no more of them than `rows` of points. Of a structure that is `slim`, which has lost what it
    does not need, half as many again and no more.
    """
    own = structure_of(design)
    wide, share = (own, 2) if slim else (richest(design), 3)
    for law in resizable_laws(design):
        counts = zip(law.counts(own), law.counts(wide), law.limits()[1], strict=True)
        more = (max(few, min(count + max(1, count // share), most)) for count, few, most in counts)
        wide = law.resized(wide, tuple(more))
    return _towards(wide, design, free, points, rows)


def _towards(whole: Any, design: Design, free: Collection[str], points: int, rows: int) -> Any:
    """A structure with more control points than a design's own, or as large a share of them as the points allow."""
    whole, own = (within_rows(each, design, rows) for each in (whole, structure_of(design)))
    laws = [law for law in resizable_laws(design) if not set(free).isdisjoint(law.paths(design) or free)]
    for share in SHARES:
        rich = own
        for law in laws:
            counts = zip(law.counts(own), law.counts(whole), strict=True)
            rich = law.resized(rich, tuple(count + round(share * (most - count)) for count, most in counts))
        rich = rich.with_samples(own.samples)
        if len(reshaped(design, rich).parameters()) * POINTS_PER_PARAMETER <= points:
            break
    return rich


@singledispatch
def richest(design: Design) -> Any:
    """The structure with all the control points that a match may begin with."""
    own = structure_of(design)
    least = RICH_CHORDWISE[3 if own.channel else 2]
    span = {
        name: max(count, 0 if name in own.stations else next(most for word, most in RICH_SPAN.items() if word in name))
        for name, count in own.span.items()
    }
    channel = {name: max(count, most) for (name, count), most in zip(own.channel.items(), RICH_CHANNEL, strict=False)}
    chordwise = max(own.chordwise[0], least), max(own.chordwise[1], least)
    return replace(own, chordwise=chordwise, span=span, channel=channel)
