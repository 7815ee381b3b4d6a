"""Points of a cloud in the planes of their sections, and sections of the unified family around them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.camber import bernstein
from bladewright.section.laws import law_basis
from bladewright.section.unified_sides import DEGREE, sample_places


@dataclass(frozen=True, kw_only=True, eq=False)
class UnwrappedPoints:
    """Points of a cloud in the planes of their sections."""

    points: Reals
    """(n, 2) in the plane of the section at v"""
    v: Reals
    """(n,) place along the span"""
    size: Reals
    """(n,) size of one metre in the plane"""
    chord: float
    """typical one [m]"""
    ratio: float
    """typical chord, of the meridional length"""
    flat: bool = False
    """whether all points belong to one section"""
    upper: NDArray[np.bool_] | None = None
    """(n,) whether a point is on the upper side, where that was assigned"""
    sure: NDArray[np.bool_] | None = None
    """(n,) whether the side is certain"""


def numbers_at(laws: Reals, v: Reals) -> Reals:
    """Numbers (n, q) of the sections at v."""
    return law_basis(len(laws), v) @ laws


def section_stations(unwrapped: UnwrappedPoints) -> Reals:
    """Places along the span where sections are drawn."""
    return np.zeros(1) if unwrapped.flat else np.linspace(0.0, 1.0, 13)


START, PLACE, EXTENT, STAGGER, ANGLE_IN, ANGLE_OUT, TANGENT_IN, TANGENT_OUT, ROOT_IN, ROOT_OUT = range(10)
"""columns of a section's numbers: abscissa of the leading edge and extent, both of the stream line's extent; ordinate
of the leading edge; angles [rad]; tangents of the section's extent; square roots of the edge radii, of the meridional
length"""
FIRST_THICKNESS = 10
"""the first of the columns of half thicknesses of the upper and the lower side, of the meridional length"""

PlaneScale = Callable[[Reals, Reals], Reals]
"""size in the plane of one meridional length, by abscissa (n, k) and place along the span (n,)"""
SpanFunction = Callable[[Reals], Reals]
"""a quantity (n,) by place along the span (n,)"""


class SidePlaces(NamedTuple):
    """Places on sides, one for each point, and how they move with the numbers of their sections."""

    point: Reals
    """(n, 2) the places"""
    normal: Reals
    """(n, 2) unit normals of the sides"""
    slopes: Reals
    """(n, q) motion of the place along its normal by the numbers of its section"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionShape:
    """The family's sections for given numbers of control points."""

    chordwise: tuple[int, int]
    samples: int
    clustering: float
    scale: PlaneScale
    extent: SpanFunction
    """extent of the stream lines in the plane, by place along the span"""

    @property
    def columns(self) -> int:
        """Number of numbers of a section."""
        return FIRST_THICKNESS + sum(self.chordwise)

    @property
    def upper(self) -> slice:
        """Columns of the upper half thicknesses."""
        return slice(FIRST_THICKNESS, FIRST_THICKNESS + self.chordwise[0])

    @property
    def lower(self) -> slice:
        """Columns of the lower half thicknesses."""
        return slice(FIRST_THICKNESS + self.chordwise[0], self.columns)

    @property
    def places(self) -> Reals:
        """Camber parameters of a side's control points."""
        return sample_places(self.samples, self.clustering)

    def camber(self, numbers: Reals, v: Reals) -> Reals:
        """Control points (n, 4, 2) of the camber lines."""
        unit = self.extent(v)
        extent = unit * numbers[:, EXTENT]
        first = np.stack([unit * numbers[:, START], numbers[:, PLACE]], axis=-1)
        last = first + np.stack([extent, extent * np.tan(numbers[:, STAGGER])], axis=-1)
        second = first + (numbers[:, TANGENT_IN] * extent)[:, None] * _along(numbers[:, ANGLE_IN])
        third = last - (numbers[:, TANGENT_OUT] * extent)[:, None] * _along(numbers[:, ANGLE_OUT])
        return np.stack([first, second, third, last], axis=1)

    def heights(self, numbers: Reals, v: Reals, upper: bool) -> tuple[Reals, Reals, Reals, Reals]:
        """Heights (n, k) of a side's control points above the camber, heights at the edges for unit roots, and sizes.

        The sizes (n, k - 2) are those of one metre in the plane at the edges' and the inner control points.
        """
        line = self.camber(numbers, v)
        places = self.places
        inner = places[2:-2]
        on = bernstein(inner) @ line
        scale = self.scale(np.concatenate([line[:, [0, 3], 0], on[..., 0]], axis=1), v)
        rows = law_basis(self.chordwise[0 if upper else 1], inner)
        thickness = scale[:, 2:] * (numbers[:, self.upper if upper else self.lower] @ rows.T)
        tangents, _ = _tangents(line, np.array([0.0, inner[0], inner[-1], 1.0]))
        left = (1.0 if upper else -1.0) * _left(tangents)
        second = on[:, 0] + thickness[:, :1] * left[:, 1]
        last = on[:, -1] + thickness[:, -1:] * left[:, 2]
        advance_in = np.sum((second - line[:, 0]) * tangents[:, 0], axis=-1)
        advance_out = np.sum((line[:, 3] - last) * tangents[:, 3], axis=-1)
        share = (DEGREE - 1) / DEGREE * 0.5
        unit_in = np.sqrt(share * np.maximum(advance_in, 1e-12) * scale[:, 0])
        unit_out = np.sqrt(share * np.maximum(advance_out, 1e-12) * scale[:, 1])
        zero = np.zeros((len(numbers), 1))
        columns = [
            zero, (unit_in * numbers[:, ROOT_IN])[:, None], thickness,
            (unit_out * numbers[:, ROOT_OUT])[:, None], zero,
        ]  # fmt: skip
        return np.concatenate(columns, axis=1), unit_in, unit_out, scale

    def thickness_limits(self, numbers: Reals, v: Reals, upper: bool) -> tuple[Reals, Reals]:
        """Half thickness (n,) [m] beside both edges from which on a side leaves the edge sideways."""
        line = self.camber(numbers, v)
        at = self.places[[0, 2, -3, -1]]
        on, (tangents, _) = bernstein(at) @ line, _tangents(line, at)
        left = (1.0 if upper else -1.0) * _left(tangents)
        scale = self.scale(on[..., 0], v)
        result = []
        for edge, beside, sign in ((0, 1, 1.0), (3, 2, -1.0)):
            ahead = sign * np.sum((on[:, beside] - on[:, edge]) * tangents[:, edge], axis=-1)
            back = -sign * np.sum(left[:, beside] * tangents[:, edge], axis=-1) * scale[:, beside]
            result.append(np.where(back > 0.0, np.maximum(ahead, 0.0) / np.maximum(back, 1e-12), np.inf))
        return result[0], result[1]

    def polylines(self, numbers: Reals, v: Reals, s: Reals) -> tuple[Reals, Reals]:
        """Points (m, len(s), 2) of the upper and the lower sides of m sections."""
        line = self.camber(numbers, v)
        tangents, _ = _tangents(line, self.places)
        on, left = bernstein(self.places) @ line, _left(tangents)
        count = len(self.places)
        rows = basis(uniform_knots(count, DEGREE), DEGREE, s)
        upper, lower = (
            rows @ (on + sign * self.heights(numbers, v, sign > 0.0)[0][..., None] * left) for sign in (1.0, -1.0)
        )
        return upper, lower

    def footpoints(self, numbers: Reals, v: Reals, s: Reals, upper: np.ndarray) -> SidePlaces:
        """Places at s (n,) on the sides of n sections."""
        line = self.camber(numbers, v)
        places = self.places
        count = len(places)
        sign = np.where(upper, 1.0, -1.0)
        height, scale = np.empty((len(s), count)), np.empty((len(s), count - 2))
        unit_in, unit_out = np.empty(len(s)), np.empty(len(s))
        for name in (True, False):
            on = upper == name
            height[on], unit_in[on], unit_out[on], scale[on] = self.heights(numbers[on], v[on], name)
        weights = bernstein(places)
        tangents, speed = _tangents(line, places)
        left = _left(tangents)
        controls = weights @ line + (sign[:, None] * height)[..., None] * left
        knots = uniform_knots(count, DEGREE)
        rows, slopes = (np.asarray(basis(knots, DEGREE, s, order)) for order in (0, 1))
        point = np.einsum("nk,nkm->nm", rows, controls)
        along = np.einsum("nk,nkm->nm", slopes, controls)
        normal = sign[:, None] * _left(along) / (np.sqrt(np.sum(along**2, axis=-1)) + 1e-30)[:, None]
        across = np.einsum("nm,nkm->nk", normal, left)
        forward = np.einsum("nm,nkm->nk", normal, tangents)
        # a control point moves with the camber, and turns with its normal
        turn = sign[:, None] * rows * height * forward / speed
        by_line = normal[:, None, :] * (rows @ weights)[..., None]
        by_line = by_line - np.einsum("nk,nkm,kj->njm", turn, left, _bernstein_slopes(places))
        result = np.zeros((len(s), self.columns))
        result[:, :8] = _by_camber(numbers, self.extent(v), by_line)
        sides = sign[:, None] * rows * across
        for columns, mask, size in (
            (self.upper, upper, self.chordwise[0]),
            (self.lower, ~upper, self.chordwise[1]),
        ):
            result[mask, columns] = (sides[:, 2:-2] * scale[:, 2:])[mask] @ law_basis(size, places[2:-2])
        result[:, ROOT_IN] = sides[:, 1] * unit_in
        result[:, ROOT_OUT] = sides[:, -2] * unit_out
        return SidePlaces(point=point, normal=normal, slopes=result)


def _by_camber(numbers: Reals, unit: Reals, by_line: Reals) -> Reals:
    """Slopes (n, 8) by the camber's numbers from those by its control points (n, 4, 2)."""
    into, out = _along(numbers[:, ANGLE_IN]), _along(numbers[:, ANGLE_OUT])
    tangent_in, tangent_out = numbers[:, TANGENT_IN], numbers[:, TANGENT_OUT]
    extent, slope = unit * numbers[:, EXTENT], np.tan(numbers[:, STAGGER])
    longer_in, longer_out = np.sum(by_line[:, 1] * into, axis=-1), -np.sum(by_line[:, 2] * out, axis=-1)
    all_four, last = np.sum(by_line, axis=1), by_line[:, 3] + by_line[:, 2]
    columns = [
        unit * all_four[:, 0],
        all_four[:, 1],
        unit * (last[:, 0] + slope * last[:, 1] + tangent_in * longer_in + tangent_out * longer_out),
        extent * (1.0 + slope**2) * last[:, 1],
        tangent_in * extent * np.sum(by_line[:, 1] * _left(into), axis=-1),
        -tangent_out * extent * np.sum(by_line[:, 2] * _left(out), axis=-1),
        extent * longer_in,
        extent * longer_out,
    ]
    return np.stack(columns, axis=1)


def _along(angle: Reals) -> Reals:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _left(vectors: Reals) -> Reals:
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def _tangents(line: Reals, places: Reals) -> tuple[Reals, Reals]:
    slope = _bernstein_slopes(places) @ line
    speed = np.sqrt(np.sum(slope**2, axis=-1)) + 1e-30
    return slope / speed[..., None], speed


def _bernstein_slopes(u: Reals) -> Reals:
    w = 1.0 - u
    return np.stack([-3 * w**2, 3 * w**2 - 6 * u * w, 6 * u * w - 3 * u**2, 3 * u**2], axis=-1)
