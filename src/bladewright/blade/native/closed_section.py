"""Both sides of a blade and the faces of its blunt edges as one closed section, and splines around it.

A site is a face and its u. Past a round edge a side goes on as the other one: u = -0.1 on the upper side is u = 0.1 on
the lower one, so that what leaves an edge obliquely may cross it. At sharp and blunt edges the section has corners.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from bladewright.blade.native.knots import DEGREE
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array, cross, dot, length, unit
from bladewright.nurbs.basis import Reals, basis, greville
from bladewright.nurbs.surface import Surface

UPPER, LOWER, LEADING, TRAILING = range(4)
"""The faces around the section: both sides, and those of blunt edges."""
FACES = ("upper", "lower", "leading_edge", "trailing_edge")
"""their names"""
OUTWARD = np.array([-1.0, 1.0, 1.0, -1.0])
"""+1 where dS/du x dS/dv points out of the blade; u of blunt edges runs from the upper to the lower side"""
ACROSS_EDGES = 1
"""Derivatives that splines around the section keep across round edges: the sides keep two, their normals one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sites(FrozenRecord):
    """Places around the section."""

    side: NDArray[np.intp]
    """(k,) the face: UPPER, LOWER, LEADING or TRAILING"""
    u: Array
    """(k,) its parameter"""

    def __len__(self) -> int:
        return len(self.side)

    def moved(self, u: Array) -> Sites:
        """The same sides at another u (..., k)."""
        return Sites(side=np.broadcast_to(self.side, u.shape), u=u)

    def picked(self, which: NDArray[np.intp]) -> Sites:
        """Some of them."""
        return Sites(side=self.side[which], u=self.u[which])

    def and_those(self, others: Sites) -> Sites:
        """These and others."""
        return Sites(side=np.concatenate([self.side, others.side]), u=np.concatenate([self.u, others.u]))


class Corner(NamedTuple):
    """A line of the span along which two faces of the section meet at an angle."""

    name: str
    """of its edge, and of the side where the edge is blunt"""
    first: tuple[int, float]
    """the face and its u there, nearer to the upper side"""
    second: tuple[int, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class ClosedSection(FrozenRecord):
    """The two sides, and at which of the edges, leading and trailing, they are one smooth surface."""

    upper: Surface
    lower: Surface
    smooth: tuple[bool, bool]
    blunt: Mapping[int, Surface] = field(default_factory=lambda: FrozenMapping({}))
    """the faces of blunt edges, LEADING or TRAILING"""

    @property
    def faces(self) -> dict[int, Surface]:
        """All faces."""
        return {UPPER: self.upper, LOWER: self.lower, **self.blunt}

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """The corners, from the upper to the lower side at each edge."""
        found: list[Corner] = []
        for face, at, smooth in zip((LEADING, TRAILING), (0.0, 1.0), self.smooth, strict=True):
            name = FACES[face]
            if face in self.blunt:
                found += [
                    Corner(f"{name}_upper", (UPPER, at), (face, 0.0)),
                    Corner(f"{name}_lower", (face, 1.0), (LOWER, at)),
                ]
            elif not smooth:
                found.append(Corner(name, (UPPER, at), (LOWER, at)))
        return tuple(found)

    @property
    def corner_sides(self) -> list[tuple[int, float]]:
        """Sides that end at corners, and u there."""
        pairs = zip(self.corner_sites.side.tolist(), self.corner_sites.u.tolist(), strict=True)
        return [(face, u) for face, u in pairs if face <= LOWER]

    def has_corners(self, face: int) -> bool:
        """Whether a face ends at a corner."""
        return bool(np.any(self.corner_sites.side == face))

    @cached_property
    def corner_sites(self) -> Sites:
        """Both faces of each corner in turn."""
        pairs = [pair for corner in self.corners for pair in (corner.first, corner.second)]
        return Sites(side=np.array([face for face, _ in pairs], dtype=np.intp), u=np.array([u for _, u in pairs]))

    def real(self) -> ClosedSection:
        """The same of real parts."""
        real = {at: replace(face, control_points=np.real(face.control_points)) for at, face in self.faces.items()}
        upper, lower = real.pop(UPPER), real.pop(LOWER)
        return replace(self, upper=upper, lower=lower, blunt=FrozenMapping(real))

    @property
    def stepped(self) -> bool:
        """Whether it carries a complex step."""
        return any(np.iscomplexobj(face.control_points) for face in self.faces.values())

    def derivative(self, sites: Sites, v: Array, du: int = 0, dv: int = 0) -> Array:
        """Points or derivatives (..., 3) at sites and v of one shape, by the u of each site's own side."""
        return self.derivatives(sites, v, (du, dv))[0]

    def derivatives(self, sites: Sites, v: Array, *orders: tuple[int, int]) -> list[Array]:
        """Several of the same, each `du` times by u and `dv` times by v."""
        side, u, v = np.broadcast_arrays(sites.side, sites.u, v)
        of_side = side <= LOWER
        before, after = (np.real(u) < 0.0) & self.smooth[0], (np.real(u) > 1.0) & self.smooth[1]
        other = (before | after) & of_side
        u = np.where(other, np.where(before, -u, 2.0 - u), u)
        side = np.where(other, UPPER + LOWER - side, side)
        kind = np.result_type(u, v, *(surface.control_points for surface in self.faces.values()))
        found = [np.empty((*u.shape, self.upper.control_points.shape[-1]), dtype=kind) for _ in orders]
        for face, surface in self.faces.items():
            mask = side == face
            if mask.any():
                own_u, own_v = u[mask], v[mask]
                for each, order in zip(found, orders, strict=True):
                    each[mask] = surface.derivative(own_u, own_v, *order)
        against = other[..., None]
        return [
            np.where(against, -each, each) if order[0] % 2 else each for each, order in zip(found, orders, strict=True)
        ]

    def normal(self, sites: Sites, v: Array) -> Array:
        """Unit normals (..., 3) out of the blade."""
        along, across = self.derivatives(sites, v, (1, 0), (0, 1))
        return unit(self._outward(sites, cross(along, across)))

    def rising(self, sites: Sites, v: Array) -> tuple[Array, Array, Array, Array]:
        """Points (..., 3), their derivatives by v, unit normals and their derivatives by v."""
        point, along, across, mixed, bend = self.derivatives(sites, v, (0, 0), (1, 0), (0, 1), (1, 1), (0, 2))
        normal, turn = self._turning(sites, cross(along, across), cross(mixed, across) + cross(along, bend))
        return point, across, normal, turn

    def running(self, sites: Sites, v: Array) -> tuple[Array, Array, Array]:
        """Derivatives (..., 3) of points by u, unit normals and their derivatives by u."""
        along, across, bend, mixed = self.derivatives(sites, v, (1, 0), (0, 1), (2, 0), (1, 1))
        normal, turn = self._turning(sites, cross(along, across), cross(bend, across) + cross(along, mixed))
        return along, normal, turn

    def _turning(self, sites: Sites, product: Array, change: Array) -> tuple[Array, Array]:
        """Unit normals from dS/du x dS/dv, with the derivative from that of the product."""
        size = length(product)[..., None]
        normal, turn = self._outward(sites, product / size), self._outward(sites, change / size)
        return normal, turn - normal * dot(normal, turn)[..., None]

    def _outward(self, sites: Sites, vectors: Array) -> Array:
        return OUTWARD[sites.side][..., None] * vectors


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionSplines(FrozenRecord):
    """Splines around the section on the same inner knots of both sides, cut into one of each face.

    Across round edges they keep `across` derivatives; at corners each face ends. Interpolation at the sites is
    linear in the values there, and its matrices are the same for every row of a net.
    """

    knots: Reals
    """of a side, clamped over [0, 1]"""
    smooth: tuple[bool, bool]
    blunt: Mapping[int, Reals] = field(default_factory=lambda: FrozenMapping({}))
    """the same of the faces of blunt edges"""
    across: int = ACROSS_EDGES
    """derivatives kept across round edges"""

    @property
    def knots_of(self) -> dict[int, Reals]:
        """Knots of each face."""
        return {UPPER: self.knots, LOWER: self.knots, **self.blunt}

    def with_knots(self, face: int, knots: Reals) -> SectionSplines:
        """The same with others on a face, or on both sides."""
        if face in self.blunt:
            return replace(self, blunt=FrozenMapping({**self.blunt, face: knots}))
        return replace(self, knots=knots)

    @cached_property
    def _lines(self) -> list[tuple[Reals, tuple[tuple[int, float, float], ...], bool]]:
        """Each line around the section: its knots, the (face, start, direction) of its stretches, and if it closes."""
        faces = [(knots, ((face, 0.0, 1.0),), False) for face, knots in self.blunt.items()]
        return [*self._side_lines, *faces]

    @property
    def _side_lines(self) -> list[tuple[Reals, tuple[tuple[int, float, float], ...], bool]]:
        inner = self.knots[DEGREE + 1 : -DEGREE - 1]
        at_edge = DEGREE - self.across
        leading, trailing = self.smooth
        up, down = (UPPER, 0.0, 1.0), (LOWER, 2.0, -1.0)
        clamp = DEGREE + 1
        if leading and trailing:
            own = np.concatenate([np.zeros(at_edge), inner, np.full(at_edge, 1.0), 2.0 - inner[::-1]])
            return [(own, (up, down), True)]
        if trailing:
            own = np.concatenate(
                [np.zeros(clamp), inner, np.full(at_edge, 1.0), 2.0 - inner[::-1], np.full(clamp, 2.0)]
            )
            return [(own, (up, down), False)]
        if leading:
            own = np.concatenate([np.full(clamp, -1.0), -inner[::-1], np.zeros(at_edge), inner, np.full(clamp, 1.0)])
            return [(own, (up, (LOWER, 0.0, -1.0)), False)]
        return [(self.knots, (up,), False), (self.knots, ((LOWER, 0.0, 1.0),), False)]

    @cached_property
    def _places(self) -> list[Reals]:
        """Greville's abscissae of each line."""
        return [
            greville(_tiled(knots), DEGREE)[: len(knots)] if closed else greville(knots, DEGREE)
            for knots, _, closed in self._lines
        ]

    @cached_property
    def sites(self) -> Sites:
        """Where splines are interpolated, one site for each degree of freedom."""
        side, u = [], []
        for (_, parts, closed), places in zip(self._lines, self._places, strict=True):
            p = np.mod(places, 2.0) if closed else places
            if len(parts) == 1:
                own, at = np.full(len(p), parts[0][0]), p
            else:
                _, start, _ = parts[1]
                on_lower = p > 1.0 if start else p < 0.0
                own, at = np.where(on_lower, LOWER, UPPER), np.where(on_lower, start - p, p)
            side.append(own.astype(np.intp))
            u.append(at)
        return Sites(side=np.concatenate(side), u=np.concatenate(u))

    @cached_property
    def nets(self) -> tuple[Reals, ...]:
        """Matrices (n, k) from values at the sites to the control points of each face."""
        found: dict[int, Reals] = {}
        own = {face: (knots, greville(knots, DEGREE)) for face, knots in self.knots_of.items()}
        total, first = len(self.sites), 0
        for (knots, parts, closed), places in zip(self._lines, self._places, strict=True):
            to_line = _solved(_matrix(knots, places, closed=closed), np.eye(len(places)))
            for face, start, direction in parts:
                mine, at = own[face]
                net = np.zeros((len(at), total))
                values = csr_array(_matrix(knots, start + direction * at, closed=closed)) @ to_line
                net[:, first : first + len(places)] = _solved(basis(mine, DEGREE, at), values)
                found[face] = net
            first += len(places)
        for row, smooth in zip((0, -1), self.smooth, strict=True):
            if smooth:
                # one row, to the bit
                found[LOWER][row] = found[UPPER][row]
        return tuple(found[face] for face in own)

    def split(self, values: Array) -> tuple[Array, ...]:
        """Control points (n, ...) of each face from values (k, ...) at the sites."""
        return tuple(np.tensordot(net, values, axes=1) for net in self.nets)


def _solved(matrix: Reals, right: Reals) -> Reals:
    """x (n, k) with A x = right, for a matrix of basis functions, of which few are not zero at a place."""
    return np.asarray(splu(csc_array(matrix)).solve(right))


def _tiled(knots: Reals) -> Reals:
    """Knots of a closed line over [0, 2), repeated before and after."""
    return np.concatenate([knots - 2.0, knots, knots + 2.0])[len(knots) - DEGREE - 1 :]


def _matrix(knots: Reals, places: Reals, *, closed: bool) -> Reals:
    """Values (m, n) of the basis functions of a line at places (m,)."""
    if not closed:
        return basis(knots, DEGREE, places)
    tiled, count = _tiled(knots), len(knots)
    start = tiled[DEGREE]
    full = BSpline.design_matrix(start + np.mod(places - start, 2.0), tiled, DEGREE).toarray()
    # a function and the one a turn later are the same
    return np.asarray(full[:, :count] + np.pad(full[:, count:], ((0, 0), (0, 2 * count - full.shape[1]))))
