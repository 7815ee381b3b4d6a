"""A first blade from points in space."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from bladewright.blade.channel import Channel
from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Point
from bladewright.errors import DesignError, FitError
from bladewright.fitting.first.arrangement import found_arrangement
from bladewright.fitting.first.camber import first_laws
from bladewright.fitting.first.channel import EDGES, SPAN, Rough, curve_counts, rough_channel
from bladewright.fitting.first.inliers import thinned, usual
from bladewright.fitting.first.matching import Laid, Match, matched, nearest, numbers_at
from bladewright.fitting.first.outline import boundary, corner_sets
from bladewright.fitting.first.shape import (
    ANGLE_IN,
    ANGLE_OUT,
    EXTENT,
    FIRST_THICKNESS,
    PLACE,
    ROOT_IN,
    ROOT_OUT,
    STAGGER,
    START,
    TANGENT_IN,
    TANGENT_OUT,
    Shape,
)
from bladewright.fitting.first.taming import sharpened, tamed
from bladewright.fitting.structure import Structure
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import law_basis
from bladewright.section.limits import ANGLES, RADII, TANGENTS, THICKNESSES

Unit = Literal["m", "cm", "mm", "um", "in", "ft"]
Arrangement = Literal["annular", "linear"]
MOST = 1200
"""points that a first blade is drawn through"""
GOOD = 4e-3
"""of the chord: a mean distance with which no other outline is tried"""
FEW = 450
"""points that decide which of several outlines it is"""


LIMITS = {
    **dict.fromkeys(ANGLES, (-89.0, 89.0)),
    **dict.fromkeys(TANGENTS, (0.01, 1.0)),
    **dict.fromkeys(RADII, (1e-5, 0.95)),
    **dict.fromkeys(THICKNESSES, (1e-5, 9.0)),
}
"""of a first blade's laws"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """A channel, and sections on its stream surfaces."""

    channel: Rough
    shape: Shape
    laid: Laid
    match: Match


def first_blade(
    points: Reals,
    *,
    arrangement: Arrangement | None = None,
    structure: Structure | None = None,
    blade_count: int | None = None,
    pitch: float | None = None,
    name: str = "blade",
    length_unit: Unit = "mm",
) -> UnifiedBlade:
    """A blade of the unified family near points (n, 3) [m] in the machine's axes, found from them alone.

    `pitch` [m] of a linear cascade. Where blade_count or pitch is not given, one at which neighbours stand apart is
    taken. Raises FitError where no blade that can be built lies near the points.
    """
    points = thinned(usual(np.unique(np.asarray(points, dtype=np.float64), axis=0)), MOST)
    arrangement = arrangement or found_arrangement(points)
    structure = structure or Structure()
    machine, outlines = _sorted(coordinates(points, arrangement), revolved=arrangement == "annular")
    wide = float(np.ptp(machine[:, 2]))
    best: tuple[float, UnifiedBlade] | None = None
    refusal = FitError("no blade was found near the points")
    for outline in outlines[:3]:
        found = _refined(outline, machine, structure)
        apart = _apart(found, machine)
        if best is not None and apart > best[0]:
            continue
        try:
            design, tamings = built_blade(found, arrangement, structure, blade_count, pitch, wide, name, length_unit)
        except FitError as error:
            refusal = error
            continue
        # a design that had to be tamed lies further from the points than its sections did
        apart += 0.004 * tamings * found.laid.chord
        if best is None or apart < best[0]:
            best = apart, design
        if best[0] < GOOD * found.laid.chord:
            break
    if best is None:
        raise refusal
    return best[1]


def coordinates(points: Reals, arrangement: Arrangement) -> Reals:
    """Coordinates (n, 3): x, r and theta [rad] without a jump, or x, z and y of a cascade."""
    x, y, z = points.T
    if arrangement == "linear":
        return np.stack([x, z, y], axis=-1)
    theta = np.sort(np.arctan2(y, z))
    gaps = np.diff(np.concatenate([theta, theta[:1] + 2.0 * np.pi]))
    i = int(np.argmax(gaps))
    cut = theta[i] + gaps[i] / 2.0
    wrapped = (np.arctan2(y, z) - cut) % (2.0 * np.pi) + cut
    wrapped -= 2.0 * np.pi * np.round(np.median(wrapped) / (2.0 * np.pi))
    return np.stack([x, np.sqrt(y**2 + z**2), wrapped], axis=-1)


def _sorted(machine: Reals, *, revolved: bool) -> tuple[Reals, list[Found]]:
    """The points that count, and the blades whose walls and edges are pieces of the outline, the closest first."""
    found = _likely(machine, revolved=revolved)
    best = found[0]
    distances = nearest(best.shape, _laid(machine, best.channel), best.match.laws)[2]
    kept = distances < 5.0 * np.median(distances) + 0.03 * best.laid.chord
    if np.mean(kept) < 0.995:
        machine = machine[kept]
        found = _likely(machine, revolved=revolved)
    return machine, found


def _likely(machine: Reals, *, revolved: bool) -> list[Found]:
    few = machine[np.random.default_rng(1).permutation(len(machine))[:FEW]]
    tried = []
    for pieces in corner_sets(boundary(machine[:, :2])):
        for turn in (0, 1):
            channel = rough_channel(_named(pieces, turn), dict.fromkeys(EDGES, 5), revolved=revolved)
            tried.append(_matched(few, channel, (4, 4), 3, turns=10))
    return sorted(tried, key=lambda found: _apart(found, few))


def _refined(rough: Found, machine: Reals, structure: Structure) -> Found:
    """The blade between the ends of its own camber lines, in the numbers of control points that are asked for."""
    count = 4 if len(machine) > 400 else 3
    found = rough
    for step in range(3):
        counts = dict.fromkeys(EDGES, 6) if step == 0 else dict(structure.channel) or curve_counts(found.channel)
        channel = _trimmed(found, counts, machine, 0.05 if step == 0 else 0.15)
        shape = _shape(channel, structure.chordwise, structure.samples, structure.clustering)
        found = _continued(machine, channel, found, shape, count, ends=step == 2)
    return found


def _apart(found: Found, machine: Reals) -> float:
    """Mean distance [m] of most points from the sections, and from the channel where they lie outside its walls."""
    u, v = found.channel.places(machine[:, :2])
    outside = machine[:, :2] - found.channel.position(u, np.clip(v, 0.0, 1.0))
    distances = np.sqrt(found.match.distances**2 + np.sum(outside**2, axis=-1))
    return float(np.mean(np.sort(distances)[: max(1, int(0.94 * len(distances)))]))


def _named(pieces: list[Reals], turn: int) -> dict[str, Reals]:
    """Four pieces of an anticlockwise boundary by their names, for one of the two ways to pair them.

    Anticlockwise in (x, r) come hub, trailing edge, shroud, leading edge; the flow goes on towards +x.
    """
    hub, trailing, shroud, leading = (pieces[(i + turn) % 4] for i in range(4))
    if np.mean(leading[:, 0]) > np.mean(trailing[:, 0]):
        hub, trailing, shroud, leading = shroud, leading, hub, trailing
    return {"hub": hub, "trailing_edge": trailing, "shroud": shroud[::-1], "leading_edge": leading[::-1]}


def _laid(machine: Reals, channel: Rough) -> Laid:
    u, v = channel.places(machine[:, :2])
    a = channel.abscissa(u, v)
    size = 1.0 / machine[:, 1] if channel.revolved else np.ones(len(machine))
    length = float(np.median(channel.extents()[1]))
    return Laid(
        points=np.stack([a, machine[:, 2]], axis=-1), v=np.clip(v, 0.0, 1.0), size=size, chord=length, ratio=1.0
    )


def _shape(channel: Rough, chordwise: tuple[int, int], samples: int, clustering: float) -> Shape:
    return Shape(chordwise=chordwise, samples=samples, clustering=clustering, scale=channel.size, extent=channel.extent)


def _matched(machine: Reals, channel: Rough, chordwise: tuple[int, int], count: int, *, turns: int) -> Found:
    laid = _laid(machine, channel)
    shape = _shape(channel, chordwise, 16, 1.0)
    turn, lean, chord = _direction(shape, laid)
    laid = replace(laid, chord=chord, ratio=chord / laid.chord)
    match = matched(shape, laid, first_laws(shape, laid, turn, lean, count), turns=turns)
    return Found(channel=channel, shape=shape, laid=laid, match=match)


def _continued(
    machine: Reals,
    channel: Rough,
    before: Found,
    shape: Shape,
    count: int,
    *,
    ends: bool,
) -> Found:
    """What is found in another channel from the sections found in the one before."""
    old = numbers_at(before.match.laws, SPAN)
    numbers = np.zeros((len(SPAN), shape.columns))
    numbers[:, :FIRST_THICKNESS] = old[:, :FIRST_THICKNESS]
    numbers[:, START], numbers[:, EXTENT] = 0.0, 1.0
    lengths = before.channel.extents()[1] / channel.extents()[1]
    numbers[:, [ROOT_IN, ROOT_OUT]] *= np.sqrt(lengths)[:, None]
    u = np.linspace(0.0, 1.0, 15)
    for now, then in ((shape.upper, before.shape.upper), (shape.lower, before.shape.lower)):
        values = lengths[:, None] * (old[:, then] @ law_basis(then.stop - then.start, u).T)
        numbers[:, now] = np.linalg.lstsq(law_basis(now.stop - now.start, u), values.T, rcond=None)[0].T
    laws = np.linalg.lstsq(law_basis(count, SPAN), numbers, rcond=None)[0]
    laid = _laid(machine, channel)
    laid = replace(laid, chord=before.laid.chord, ratio=before.laid.chord / laid.chord)
    match = matched(shape, laid, laws, turns=10, stiff=0.3, ends=ends)
    return Found(channel=channel, shape=shape, laid=laid, match=match)


def _direction(shape: Shape, laid: Laid) -> tuple[Callable[[Reals], Reals], Reals, float]:
    """Angle of the chord by place along the span, law of the middle ordinate, and the typical chord [m]."""
    rows, unit = law_basis(3, laid.v), shape.extent(laid.v)
    a = laid.points[:, 0] / unit
    a = a - rows @ np.linalg.lstsq(rows, a, rcond=None)[0]
    lean = np.linalg.lstsq(rows, laid.points[:, 1], rcond=None)[0]
    b = (laid.points[:, 1] - rows @ lean) / unit
    moments = np.linalg.lstsq(rows, np.stack([a * a, a * b, b * b], axis=-1), rcond=None)[0]

    def turn(v: Reals) -> Reals:
        saa, sab, sbb = (law_basis(3, v) @ moments).T
        return np.clip(0.5 * np.arctan2(2.0 * sab, saa - sbb), -np.radians(86.0), np.radians(86.0))

    angle = turn(laid.v)
    along = (np.cos(angle) * a + np.sin(angle) * b) * unit / laid.size
    return turn, lean, float(np.percentile(along, 98.0) - np.percentile(along, 2.0))


def _trimmed(found: Found, counts: dict[str, int], machine: Reals, past: float) -> Rough:
    """The channel between the ends of the camber lines, and between the points furthest in and out."""
    numbers = numbers_at(found.match.laws, SPAN)
    extents = found.channel.extents()[0]
    first = extents * numbers[:, START]
    last = first + extents * numbers[:, EXTENT]
    starts, ends = (found.channel.u_at(a) for a in (first, last))
    ends = np.maximum(ends, starts + 0.05)
    low, high = _reached(found, machine)
    across = np.linspace(0.0, 1.0, 41)

    def edge(u: Reals) -> Reals:
        first, last = low(u[:1])[0], high(u[-1:])[0]
        v = first + (last - first) * across
        return found.channel.position(np.interp(v, SPAN, u), v)

    pieces = {"leading_edge": edge(starts), "trailing_edge": edge(ends)}
    for name, row, wall in (("hub", 0, low), ("shroud", -1, high)):
        u = np.linspace(starts[row], ends[row], 41)
        pieces[name] = found.channel.position(u, wall(u))
    return rough_channel(pieces, counts, revolved=found.channel.revolved, past=past)


def _reached(found: Found, machine: Reals) -> tuple[Callable[[Reals], Reals], Callable[[Reals], Reals]]:
    """Lowest and highest v of the points by u, as parabolas."""
    u, v = found.channel.places(machine[:, :2])
    distances = nearest(found.shape, _laid(machine, found.channel), found.match.laws)[2]
    good = distances < 4.0 * np.median(distances) + 0.02 * found.laid.chord
    u, v = u[good], v[good]
    walls = []
    for sign in (1.0, -1.0):
        parts = np.clip((u * 6.0).astype(int), 0, 5)
        index = [np.flatnonzero(parts == part) for part in range(6)]
        chosen = np.array([rows[np.argmin(sign * v[rows])] for rows in index if len(rows)])
        wall = 0.0 if sign > 0.0 else 1.0
        away = np.clip(v[chosen] - wall, -0.15, 0.15)
        tame = 0.3 * np.diff(np.eye(3), n=2, axis=0)
        matrix = np.concatenate([law_basis(3, np.clip(u[chosen], 0.0, 1.0)), tame])
        law = np.linalg.lstsq(matrix, np.concatenate([away, [0.0]]), rcond=None)[0]
        walls.append(lambda at, law=law, wall=wall: wall + law_basis(3, np.clip(at, 0.0, 1.0)) @ law)
    return walls[0], walls[1]


def built_blade(
    found: Found,
    arrangement: Arrangement,
    structure: Structure,
    blade_count: int | None,
    pitch: float | None,
    wide: float,
    name: str,
    length_unit: Unit,
) -> tuple[UnifiedBlade, int]:
    """The blade of what was found, with thickness raised or edges sharpened until it can be built, and how far that went."""
    metre = UNITS[length_unit]
    span = structure.span
    numbers = numbers_at(found.match.laws, SPAN)
    shape, channel = found.shape, found.channel
    lengths = channel.extents()[1]
    linear = arrangement == "linear"

    def law(values: Reals, field: str) -> float | tuple[float, ...]:
        count = span.get(field, 4)
        fitted = np.linalg.lstsq(law_basis(count, SPAN), values, rcond=None)[0]
        low, high = LIMITS.get(field, (-np.inf, np.inf))
        fitted = np.clip(fitted, low, high)
        return tuple(float(x) for x in fitted) if count > 1 else float(fitted[0])

    place = numbers[:, PLACE]
    most = float(np.max(lengths * np.max(numbers[:, FIRST_THICKNESS:], axis=1)))
    if linear:
        around = {"pitch": (pitch if pitch is not None else 2.0 * (wide + most)) / metre}
    else:
        count = blade_count if blade_count is not None else max(1, int(np.pi / max(wide, 1e-3)))
        around = {"blade_count": min(count, 10_000)}
    error: DesignError | None = None
    for attempt in range(10):
        roots = {ROOT_IN: numbers[:, ROOT_IN] ** 2, ROOT_OUT: numbers[:, ROOT_OUT] ** 2}
        fields: dict[str, Any] = {
            **around,
            "leading_edge_y" if linear else "leading_edge_theta": law(
                place / metre if linear else np.degrees(place), "place"
            ),
        }
        design = UnifiedBlade(
            name=name,
            length_unit=length_unit,
            arrangement=arrangement,
            **fields,
            stagger=law(np.degrees(numbers[:, STAGGER]), "stagger"),
            metal_angle_in=law(np.degrees(numbers[:, ANGLE_IN]), "metal_angle_in"),
            metal_angle_out=law(np.degrees(numbers[:, ANGLE_OUT]), "metal_angle_out"),
            tangent_in=law(numbers[:, TANGENT_IN], "tangent_in"),
            tangent_out=law(numbers[:, TANGENT_OUT], "tangent_out"),
            leading_edge_radius=law(np.clip(roots[ROOT_IN], 1e-5, 0.9), "leading_edge_radius"),
            trailing_edge_radius=law(np.clip(roots[ROOT_OUT], 1e-5, 0.9), "trailing_edge_radius"),
            thickness_upper=tuple(law(t, "thickness_upper") for t in numbers[:, shape.upper].T),
            thickness_lower=tuple(law(t, "thickness_lower") for t in numbers[:, shape.lower].T),
            channel=_as_channel(channel, metre),
            samples=shape.samples,
            clustering=shape.clustering,
        )
        try:
            design.build()
        except DesignError as refused:
            error = refused
            numbers = tamed(numbers, shape) if attempt > 3 else sharpened(numbers)
        else:
            return design, max(0, attempt - 3)
    raise FitError(f"no blade that can be built was found near the points: {error}")


def _as_channel(channel: Rough, metre: float) -> Channel:
    def points(name: str, inner: bool) -> tuple[Point, ...]:
        rows = channel.curves[name] / metre
        return tuple(Point(float(x), float(r)) for x, r in (rows[1:-1] if inner else rows))

    return Channel(
        leading_edge=points("leading_edge", False),
        trailing_edge=points("trailing_edge", False),
        hub=points("hub", True),
        shroud=points("shroud", True),
    )
