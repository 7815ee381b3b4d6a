"""How far the faces of a CAD file lie from the native ones, in both directions."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from bladewright.cad.built import MM
from bladewright.cad.closest import SEEDS, Target
from bladewright.cad.patch import SplineCarrier, native_carrier
from bladewright.cad.region import Region, spread
from bladewright.numerics.elementary import Array
from bladewright.nurbs.domain import reversed as run_backwards
from bladewright.nurbs.domain import swapped
from bladewright.nurbs.measure import area
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

SAME_KNOT = 1e-9
"""Difference of knots below which a file, which rounds them, gave them back."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Deviation:
    """Distances between a native face and what a file made of it."""

    largest: float
    """[mm]"""
    mean: float
    """[mm]"""
    worst: tuple[float, float]
    """native parameters of the place where it is largest"""


@lru_cache(maxsize=16)
def meant_by(face: Surface | TrimmedSurface) -> "Meant":
    """A native face as the measure of others; kept for the next file of the same body."""
    return Meant(face)


class Meant:
    """A native face, prepared once for all that is compared with it."""

    def __init__(self, face: Surface | TrimmedSurface) -> None:
        surface = face if isinstance(face, Surface) else face.surface
        self.face = face
        self.region = Region(
            carrier=native_carrier(surface),
            chains=() if isinstance(face, Surface) else (face.boundary,),
            low=np.array([surface.knots_u[0], surface.knots_v[0]]),
            high=np.array([surface.knots_u[-1], surface.knots_v[-1]]),
        )

    @cached_property
    def target(self) -> Target:
        """The face as something that points are brought to."""
        return Target(self.region)

    @cached_property
    def area(self) -> float:
        """[m^2] by quadrature."""
        return float(area(self.face) if isinstance(self.face, Surface) else self.face.area())

    def pole_for_pole(self, region: Region) -> tuple[Surface, Surface] | None:
        """The native surface [m] and a region's [mm], where the latter is the whole of a surface with the same degrees,
        knots and number of control points; None otherwise.
        """  # noqa: D205
        if not isinstance(self.face, Surface) or not isinstance(region.carrier, SplineCarrier) or region.chains:
            return None
        mine = self.face
        found = [
            (np.max(np.abs(turned.control_points - MM * mine.control_points)), turned)
            for turned in _turned(region.carrier.surface)
            if _same_basis(mine, turned)
        ]
        return (mine, min(found, key=lambda each: float(each[0]))[1]) if found else None


def _same_basis(one: Surface, other: Surface) -> bool:
    return (
        (one.degree_u, one.degree_v) == (other.degree_u, other.degree_v)
        and one.control_points.shape == other.control_points.shape
        and bool(np.allclose(one.knots_u, other.knots_u, rtol=0.0, atol=SAME_KNOT))
        and bool(np.allclose(one.knots_v, other.knots_v, rtol=0.0, atol=SAME_KNOT))
    )


def _turned(surface: Surface) -> Iterator[Surface]:
    """A surface and itself run in other directions, as a program that turns a face round writes it."""
    for exchanged in (surface, swapped(surface)):
        for half in (exchanged, run_backwards(exchanged, "u")):
            yield half
            yield run_backwards(half, "v")


def deviation(meant: Meant, regions: list[Region], count: int, limit: float) -> Deviation:
    """Distances between a native face and the file's faces that stand for it, from `count` samples each way.

    Where the control points came back one for one, points at equal parameters are compared, which bounds the distance
    from above; where that bound is not below `limit`, and for all others, each sample is brought to the nearest point
    of the other side.
    """
    pair = meant.pole_for_pole(regions[0]) if len(regions) == 1 else None
    if pair is not None:
        found = _at_equal_parameters(*pair, count)
        if found.largest <= limit:
            return found
    uv = meant.region.sampled(count)
    points = meant.region.points(uv)
    away = np.full(len(points), np.inf)
    samples = [region.sampled(max(100, count // len(regions))) for region in regions]
    for region, seeds in zip(regions, samples, strict=True):
        away = np.minimum(away, Target(region, seeds[::2] if len(seeds) > SEEDS else seeds).closest(points, limit)[1])
    worst = int(np.argmax(away))
    largest, place, every = float(away[worst]), uv[worst], [away]
    for region, back in zip(regions, samples, strict=True):
        feet, away = meant.target.closest(region.points(back), limit)
        worst = int(np.argmax(away))
        every.append(away)
        if away[worst] > largest:
            largest, place = float(away[worst]), feet[worst]
    return Deviation(
        largest=largest, mean=float(np.mean(np.concatenate(every))), worst=(float(place[0]), float(place[1]))
    )


def _at_equal_parameters(surface: Surface, other: Surface, count: int) -> Deviation:
    lines = int(np.sqrt(count))
    u, v = (spread(surface.knots_u, surface.degree_u, lines), spread(surface.knots_v, surface.degree_v, lines))
    away = _length(MM * surface.grid(u, v) - other.grid(u, v))
    worst = np.unravel_index(np.argmax(away), away.shape)
    return Deviation(
        largest=float(away[worst]), mean=float(away.mean()), worst=(float(u[worst[0]]), float(v[worst[1]]))
    )


def _length(vectors: Array) -> Array:
    return np.sqrt(np.sum(vectors * vectors, axis=-1))
