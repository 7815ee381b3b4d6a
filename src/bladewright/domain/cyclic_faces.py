"""Cyclic faces of a sector: straight in (x, r) from the wall's line to the outline, at the line's theta.

At one theta a line that is straight in (x, r) is straight in space, so the face is ruled from the wall's line to a
curve on the faces of revolution. Along a line or an arc of the outline they advance in proportion to length on both.
Which part of the wall belongs to it is chosen so that they do not cross, else in proportion as well. The face ends in a
point where the outline meets the wall.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.native.knots import DEGREE
from bladewright.domain.carried_pitch import CarriedPitch
from bladewright.domain.disc import Carrier, OutlinePiece
from bladewright.errors import DesignError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, concatenated, cross2, dot, frozen, length, unit
from bladewright.nurbs.basis import Reals, breaks, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.refine import inserted
from bladewright.nurbs.surface import Surface

TOLERANCE = 1e-10
"""Largest error of the curve on the outline, of the outline's length: 1e-8 mm on 100 mm."""
HALVINGS = 8
"""How often its knot spans are halved at most."""
LEAST_SINE = 1e-3
"""Sine of the angle of a straight line to the wall, or to the outline, below which lines count as crossing."""
NEAR = 1e-4
"""Share of the length within which a corner is moved to a knot of the wall's line, which moves the lines a little."""
GRID = 81
"""Places of the wall's line among which the starts of the lines to the outline's corners are chosen."""
DENSE = 401
"""Points of that line between which it is taken as straight meanwhile."""
GOOD = 0.25
"""Sine of a line to wall and outline, 14 deg, that is good enough."""
CHECKED = 401
"""Lines that are checked for it."""
STEP = 1e-6
"""How far beside each of them the wall's and the outline's directions are taken, since they jump at corners."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CyclicKnots(FrozenRecord):
    """Knots of a cyclic face over [0, 1] along the wall, held while a design is differentiated."""

    corners: Reals
    """where the pieces of the outline begin and end"""
    along: Reals
    """all knots, of full multiplicity at inner corners"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", frozen(self.corners))
        object.__setattr__(self, "along", frozen(self.along))


@dataclass(frozen=True, kw_only=True, eq=False)
class CyclicFace(FrozenRecord):
    """The face through the middle of a pitch, and its edges on the outline."""

    carrier: Carrier
    line: Curve
    """the wall's line in space over [0, 1], in proportion to meridional length"""
    knots: CyclicKnots

    @cached_property
    def surface(self) -> Surface:
        """u along the wall, v from the wall to the outline."""
        rows = np.broadcast_arrays(self.on_wall.control_points, self.on_outline.control_points)
        return Surface(
            control_points=np.stack(rows, axis=1),
            knots_u=self.knots.along,
            knots_v=np.array([0.0, 0.0, 1.0, 1.0]),
            degree_u=DEGREE,
            degree_v=1,
        )

    @cached_property
    def on_wall(self) -> Curve:
        """The wall's line at the face's knots."""
        missing = list(self.knots.along)
        for knot in self.line.knots:
            missing.remove(knot)
        return inserted(self.line, np.array(missing)) if missing else self.line

    @cached_property
    def on_outline(self) -> Curve:
        """The curve in space where the face meets the faces of revolution."""
        knots, ends = self.knots.along, self.line.control_points[[0, -1]]
        sites = greville(knots, DEGREE)
        points = concatenated([ends[:1], self.exact(sites[1:-1]), ends[1:]], axis=-2)
        return interpolated(points, sites, degree=DEGREE, knots=knots)

    @property
    def edges(self) -> dict[str, Curve]:
        """That curve in its pieces, by the names of the faces of revolution: its own control points, to the bit."""
        points, knots, inner = self.on_outline.control_points, self.on_outline.knots, self.knots.corners[1:-1]
        ends = [0, *(np.searchsorted(knots, inner) - 1), len(points) - 1]
        parts = [
            Curve(
                control_points=points[first : last + 1],
                knots=np.concatenate([[start], knots[first + 1 : last + DEGREE + 1], [end]]),
                degree=DEGREE,
            )
            for (first, last), (start, end) in zip(pairwise(ends), pairwise(self.knots.corners), strict=True)
        ]
        return dict(zip(self.carrier.pieces, parts, strict=True))

    def outline(self, s: Reals) -> Array:
        """(x, r) (k, 2) on the outline where the lines end that begin at s (k,), increasing, on the wall."""
        corners = self.knots.corners
        index = np.clip(np.searchsorted(corners, s, side="right") - 1, 0, len(corners) - 2)
        shares = (s - corners[index]) / np.diff(corners)[index]
        return concatenated([piece.at(shares[index == i]) for i, piece in enumerate(self.carrier.pieces.values())], -2)

    def exact(self, s: Reals) -> Array:
        """Points (k, 3) in space of `outline`, at the line's theta."""
        place, outwards = self.outline(s), unit(self.line(s)[..., 1:])
        return concatenated([place[..., :1], place[..., 1:] * outwards], axis=-1)

    def check(self, metre: float) -> None:
        """Refuse straight lines that cross."""
        kind, wall = self.carrier.kind, partial(_meridional, self.line)
        ends = np.unique(np.round(np.concatenate([self.knots.corners, np.linspace(0.0, 1.0, CHECKED)]), 9))
        first, second = (
            (ends[:-1, None] + np.diff(ends)[:, None] * at).ravel()
            for at in ([STEP, 1.0 - 2.0 * STEP], [2.0 * STEP, 1.0 - STEP])
        )
        here, there = (np.real(place(first)) for place in (wall, self.outline))
        onwards = [np.real(place(second)) - start for place, start in ((wall, here), (self.outline, there))]
        sines = np.stack([cross2(unit(there - here), unit(along)) for along in onwards])
        least = np.min(-kind.side * sines, axis=0)
        worst = int(np.argmin(least))
        if least[worst] < LEAST_SINE:
            (x, r), (end_x, end_r) = here[worst] / metre, there[worst] / metre
            raise DesignError(
                f"{kind.field}: the cyclic faces of a sector run straight from the {kind.wall} to the outline, and "
                f"those lines cross near that from ({x:.6g}, {r:.6g}) to ({end_x:.6g}, {end_r:.6g}): take an outline "
                "without deep recesses, or build the wheel, which has no cyclic faces"
            )


def cyclic_face(pitch: CarriedPitch, knots: CyclicKnots | None = None) -> CyclicFace:
    """The cyclic face through the middle of a pitch, at given knots or at its own."""
    own, line = pitch.carrier, pitch.line
    if knots is not None:
        return CyclicFace(carrier=own, line=line, knots=knots)
    corners = _corners(own, line)
    size = float(sum(np.real(piece.length) for piece in own.pieces.values()))
    # a knot of the line so near would make a sliver
    for i, corner in enumerate(corners[1:-1], 1):
        nearest = line.knots[np.argmin((line.knots - corner) ** 2)]
        corners[i] = nearest if 0.0 < nearest < 1.0 and (nearest - corner) ** 2 < NEAR**2 else corner
    added = [np.full(DEGREE - int(np.sum(line.knots == at)), at) for at in corners[1:-1]]
    along = np.sort(np.concatenate([line.knots, *added]))
    for _ in range(HALVINGS):
        made = CyclicFace(carrier=own, line=line, knots=CyclicKnots(corners=corners, along=along))
        spans = breaks(along)
        places = spans[:-1, None] + np.diff(spans)[:, None] * np.array([0.2, 0.5, 0.8])
        miss = length(np.real(made.on_outline(places.ravel()) - made.exact(places.ravel()))).reshape(-1, 3).max(axis=1)
        poor = miss > TOLERANCE * size
        if not poor.any():
            break
        along = np.sort(np.concatenate([along, places[poor, 1]]))
    return made


def _corners(own: Carrier, line: Curve) -> Reals:
    """Shares of the wall's length, 0 and 1 among them, from which the lines to the outline's corners start.

    Of all increasing choices among GRID places those are kept whose lines meet wall and outline at angles of no lower
    sine than GOOD, or than the best choice has; of these, that nearest to proportion to length is taken.
    """
    pieces = list(own.pieces.values())
    sizes = np.array([float(np.real(piece.length)) for piece in pieces])
    even = np.cumsum(sizes)[:-1] / np.sum(sizes)
    if len(pieces) == 1:
        return np.array([0.0, 1.0])
    places = np.linspace(0.0, 1.0, GRID)
    sines = np.stack([_sines(own, line, piece, places) for piece in pieces])
    best = _best_chain(sines, np.minimum, np.zeros((len(even), GRID)))[1]
    allowed = np.where(sines >= min(GOOD, best) - 1e-12, 0.0, -np.inf)
    chain, _ = _best_chain(allowed, np.add, -((places - even[:, None]) ** 2))
    return np.array([0.0, *places[chain], 1.0])


def _sines(own: Carrier, line: Curve, piece: OutlinePiece, places: Reals) -> Reals:
    """Least sines (GRID, GRID) of lines to a piece of the outline that start between two places; -inf backwards."""
    share = np.array([0.02, 0.25, 0.5, 0.75, 0.98])
    dense = np.linspace(0.0, 1.0, DENSE)
    wall, directions = np.real(_meridional(line, dense)), np.real(_meridional(line, dense, 1))
    start = places[:, None, None] + (places[:, None] - places[:, None, None]) * share
    here, along = (np.stack([np.interp(start, dense, each) for each in part.T], axis=-1) for part in (wall, directions))
    there, onwards = np.real(piece.at(share)), np.real(piece.at(share + STEP) - piece.at(share - STEP))
    across = unit(there - here)
    both = (
        np.minimum(cross2(across, unit(along)), cross2(across, unit(onwards)))
        if own.kind.side < 0
        else -np.maximum(cross2(across, unit(along)), cross2(across, unit(onwards)))
    )
    return np.where(places > places[:, None], both.min(axis=-1), -np.inf)


def _best_chain(steps: Reals, joined: Callable[[Reals, Reals], Reals], gains: Reals) -> tuple[NDArray[np.intp], float]:
    """The places (k,) between steps (k + 1, GRID, GRID) of the greatest joined value and gains (k, GRID), and that.

    By dynamic programming (Bellman 1957).
    """
    value, chosen = steps[0][0], []
    for step, gain in zip(steps[1:], gains, strict=True):
        reached = joined((value + gain)[:, None], step)
        chosen.append(np.argmax(reached, axis=0))
        value = np.max(reached, axis=0)
    chain = [GRID - 1]
    for best in reversed(chosen):
        chain.append(int(best[chain[-1]]))
    return np.array(chain[:0:-1]), float(value[-1])


def _meridional(line: Curve, s: Reals, order: int = 0) -> Array:
    """(x, r) (k, 2) of a line in space, or its derivative."""
    point = line(s)
    radius = length(point[..., 1:])
    if not order:
        return np.stack([point[..., 0], radius], axis=-1)
    slope = line.derivative(s)
    return np.stack([slope[..., 0], dot(point[..., 1:], slope[..., 1:]) / radius], axis=-1)
