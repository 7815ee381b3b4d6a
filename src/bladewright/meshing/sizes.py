"""Element sizes: one in the open passage, smaller ones that grow away from the blade's edges and the tip gap."""

from dataclasses import dataclass, replace

import numpy as np

from bladewright.domain.passage import Passage
from bladewright.errors import MeshError
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import closest_on_surface
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.measure import arc_length
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

WALLS = ("hub", "shroud")
"""Beginnings of the names of the faces between which a tip gap may lie."""
DEFAULT_TETRAHEDRA = 150_000
"""Expected tetrahedra where no size is given: enough to look at a passage or to try a solver, and made in
9 to 69 s for every built-in example (design/meshes.md)."""
MAX_TETRAHEDRA = 5_000_000
"""Expected tetrahedra above which a size is refused: a mistyped size is then a message at once, and not a run of
hours."""
TETRAHEDRA_PER_CUBE = 3.6
"""Tetrahedra in a cube with the edge of the size asked for [-], the mean over the examples in design/meshes.py."""
GROWTH = 0.3
"""Increase of the element size over the distance from a source [-]. A smaller value makes smoother meshes with more
elements; 0.3 corresponds to neighbours about 1.3 times as large."""
SMALLEST_OF_SIZE = 0.1
"""Smallest size, in sizes of the open passage, where none is given. A lower value resolves tighter edges and narrower
gaps; the number of elements along them grows with its reciprocal."""
ELEMENTS_PER_TURN = 12.0
"""Elements on a full circle of an edge's radius where no number is given [-]: one for every 30 degrees of turning."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """A curve or face with small elements, from which the sizes grow."""

    face: str
    """name of the face; empty for a curve"""
    place: tuple[float, float, float]
    """a place on the face, or the middle of the curve [m]"""
    size: float
    """size of the elements there [m]"""
    extent: float
    """length [m] of the curve, or area [m^2] of the face"""


def size_sources(passage: Passage, curvature: float) -> tuple[Source, ...]:
    """The blade's edges and fillets, with `curvature` elements on a circle of their radius, and its tip.

    That has one element across the gap. The face of a blunt edge gets elements as small as a round edge of the same
    width.
    """
    upper, tip = passage.surfaces["blade_upper"], passage.surfaces.get("tip")
    sources = []
    for u, name in ((0.0, "blade_leading_edge"), (1.0, "blade_trailing_edge")):
        face = passage.surfaces.get(name)
        if isinstance(face, Surface):
            sources.append(_face_source(name, face, curvature))
        elif isinstance(upper, Surface):
            sources.append(_edge_source(upper, u, curvature))
    for name, face in passage.surfaces.items():
        if "fillet" in name and isinstance(face, Surface):
            sources.append(_fillet_source(name, face, curvature))
    if isinstance(tip, TrimmedSurface):
        sources.append(_tip_source(passage, tip))
    return tuple(sources)


def _edge_source(side: Surface, u: float, curvature: float) -> Source:
    line = Curve(control_points=side.control_points[-1 if u else 0].real, knots=side.knots_v, degree=side.degree_v)
    x, y, z = line(0.5).tolist()
    size = 2.0 * np.pi * _radius(side, u) / curvature
    return Source(face="", place=(x, y, z), size=size, extent=float(arc_length(line)))


def _face_source(name: str, face: Surface, curvature: float) -> Source:
    v = np.linspace(0.0, 1.0, 33)
    first, last = face(0.0, v).real, face(1.0, v).real
    widths, steps = length(last - first), length(np.diff(0.5 * (first + last), axis=0))
    x, y, z = (0.5 * (first + last))[len(v) // 2].tolist()
    area = float(np.sum(0.5 * (widths[1:] + widths[:-1]) * steps))
    return Source(face=name, place=(x, y, z), size=np.pi * float(np.median(widths)) / curvature, extent=area)


def _fillet_source(name: str, face: Surface, curvature: float) -> Source:
    """A fillet between wall and blade: u around the blade, v across, its radius that of a quarter of a circle."""
    u = np.linspace(0.0, 1.0, 65)
    first, last = face(u, 0.0).real, face(u, 1.0).real
    widths, steps = length(last - first), length(np.diff(0.5 * (first + last), axis=0))
    x, y, z = (0.5 * (first + last))[len(u) // 2].tolist()
    area = float(np.sum(0.5 * (widths[1:] + widths[:-1]) * steps))
    size = 2.0 * np.pi * float(np.median(widths)) / np.sqrt(2.0) / curvature
    return Source(face=name, place=(x, y, z), size=size, extent=area)


def _radius(side: Surface, u: float) -> float:
    """Median over the span of the radius of curvature of a side at an edge [m]; zero where the edge is sharp."""
    curvatures = []
    for v in np.linspace(0.05, 0.95, 10).tolist():
        first, second = (side.derivative(u, v, order, 0).real for order in (1, 2))
        speed = float(length(first))
        curvatures.append(float(length(np.cross(first, second))) / speed**3 if speed > 0.0 else np.inf)
    curvature = float(np.median(curvatures))
    return 1.0 / curvature if curvature > 0.0 else np.inf


def _tip_source(passage: Passage, tip: TrimmedSurface) -> Source:
    runs = [curve(np.linspace(*curve.domain, 17)).real for curve in tip.boundary]
    rim = np.concatenate([tip.surface(*run.T).real for run in runs])
    x, y, z = rim[0].tolist()
    return Source(face="tip", place=(x, y, z), size=_tip_gap(passage, rim), extent=_area(rim))


def _tip_gap(passage: Passage, rim: Reals) -> float:
    """Median distance of points (n, 3) on the rim of the tip from the nearer wall [m]."""
    trimmed = [face.surface for wall in WALLS if isinstance(face := passage.surfaces.get(wall), TrimmedSurface)]
    sides = [[face] for face in trimmed] or [
        [face for name, face in passage.surfaces.items() if name.startswith(wall) and isinstance(face, Surface)]
        for wall in WALLS
    ]

    def away(faces: list[Surface]) -> float:
        if trimmed:
            return float(closest_on_surface(faces[0], rim[:1], tolerance=1e-3).distances.real[0])
        return min(_distance_to_net(face, rim[0]) for face in faces)

    near = min(sides, key=away)
    distances = [closest_on_surface(face, rim, tolerance=1e-3).distances.real for face in near]
    return float(np.median(np.min(distances, axis=0)))


def _distance_to_net(face: Surface, point: Reals) -> float:
    """Distance of a point from the nearest control point [m], enough to tell which wall is the nearer one."""
    return float(length(face.control_points.real - point).min())


def _area(rim: Reals) -> float:
    """Area [m^2] within a closed polygon of points (n, 3)."""
    ahead = np.roll(rim, -1, axis=0)
    return 0.5 * float(length(np.cross(rim, ahead).sum(axis=0)))


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """Element sizes of the mesh of a passage."""

    chord: float
    """chord of the blade [m]"""
    largest: float
    """size in the open passage [m]"""
    smallest: float
    """smallest size [m]"""
    growth: float
    """increase of the size over the distance from a source [-]"""
    sources: tuple[Source, ...]
    expected: int
    """number of tetrahedra expected"""


@dataclass(frozen=True, kw_only=True)
class _SizeModel:
    """What the element sizes depend on besides the size in the open passage."""

    chord: float
    """chord of the blade [m]"""
    volume: float
    """volume of the passage [m^3]"""
    sources: tuple[Source, ...]
    smallest: float | None
    """smallest size asked for, in chords"""

    def sizes(self, size: float) -> Sizes:
        largest = size * self.chord
        smallest = (SMALLEST_OF_SIZE * size if self.smallest is None else self.smallest) * self.chord
        clipped = tuple(replace(each, size=float(np.clip(each.size, smallest, largest))) for each in self.sources)
        cubes = self.volume / largest**3 + sum(_cubes_near(each, largest) for each in clipped)
        return Sizes(
            chord=self.chord,
            largest=largest,
            smallest=smallest,
            growth=GROWTH,
            sources=clipped,
            expected=round(TETRAHEDRA_PER_CUBE * cubes),
        )

    def size_for(self, tetrahedra: int) -> float:
        """The size, in chords, for which so many tetrahedra are expected, by bisection in its logarithm."""
        low, high = np.log(max(1e-4, self.smallest or 0.0)), 0.0
        for _ in range(30):
            middle = 0.5 * (low + high)
            more = self.sizes(float(np.exp(middle))).expected > tetrahedra
            low, high = (middle, high) if more else (low, middle)
        return float(np.exp(high))


def sizes(
    passage: Passage,
    *,
    size: float | None = None,
    smallest: float | None = None,
    curvature: float = ELEMENTS_PER_TURN,
) -> Sizes:
    """The element sizes of a mesh: `size` in the open passage and `smallest` at the edges, both in chords.

    An edge of the blade gets `curvature` elements on a full circle of its radius, a tip gap one element across it, as
    far as `smallest` allows. Where no `size` is given, about `DEFAULT_TETRAHEDRA` are expected; `smallest` is
    `SMALLEST_OF_SIZE` of the size where it is not given. Raises MeshError for sizes that are not positive, above the
    chord, or so small that more than `MAX_TETRAHEDRA` are expected.
    """
    check_sizes(size=size, smallest=smallest, curvature=curvature)
    model = _SizeModel(
        chord=float(np.real(passage.blade.chord)),
        volume=float(np.real(passage.properties.volume)),
        sources=size_sources(passage, curvature),
        smallest=smallest,
    )
    used_size = model.size_for(DEFAULT_TETRAHEDRA) if size is None else size
    result = model.sizes(used_size)
    if result.expected > MAX_TETRAHEDRA:
        raise MeshError(
            f"size is {used_size:.3g} of the chord{'' if smallest is None else f', smallest {smallest:g}'}: about "
            f"{result.expected:,} tetrahedra are expected, and at most {MAX_TETRAHEDRA:,} are made; {_cure(model)}"
        )
    return result


def check_sizes(*, size: float | None, smallest: float | None, curvature: float) -> None:
    """Raise MeshError for sizes that no mesh can have."""
    for name, value in (("size", size), ("smallest", smallest)):
        if value is not None and not 0.0 < value <= 1.0:
            raise MeshError(f"{name} is {value:g} of the chord: it must be above 0 and at most 1, such as 0.05")
    if size is not None and smallest is not None and smallest > size:
        raise MeshError(
            f"smallest is {smallest:g} of the chord, above the size {size:g}: lower smallest, or raise size"
        )
    if not 1.0 <= curvature <= 1000.0:
        raise MeshError(f"curvature is {curvature:g} elements on a full circle: it must be between 1 and 1000")


def _cure(model: _SizeModel) -> str:
    """What the message about too many tetrahedra advises."""
    least = model.size_for(MAX_TETRAHEDRA)
    if model.sizes(least).expected > MAX_TETRAHEDRA:
        return "raise smallest"
    return f"raise size to {1.01 * least:.2g}" + ("" if model.smallest is None else ", or raise smallest")


def _cubes_near(source: Source, largest: float) -> float:
    """Integral of dV / size^3 around a curve, or on one side of a face, to where the size has grown to `largest`."""
    share = source.size / largest
    if source.face:
        return source.extent * (1.0 - share**2) / (2.0 * GROWTH * source.size**2)
    return float(np.pi) * source.extent * (1.0 - share) ** 2 / (GROWTH**2 * source.size)
