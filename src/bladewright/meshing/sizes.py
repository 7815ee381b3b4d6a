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


@dataclass(frozen=True, kw_only=True)
class Source:
    """A curve or face that smaller elements grow away from."""

    face: str
    """name of the face; empty for a curve"""
    place: tuple[float, float, float]
    """on it, the middle of a curve [m]"""
    size: float
    """of the elements there [m]"""
    extent: float
    """length [m] of the curve, or area [m^2] of the face"""


def size_sources(passage: Passage, curvature: float) -> tuple[Source, ...]:
    """The blade's edges, with `curvature` elements on a circle as tight, and its tip, with one across the gap.

    The face of a blunt edge is as fine as a round edge of its width.
    """
    upper, tip = passage.surfaces["blade_upper"], passage.surfaces.get("tip")
    found = []
    for u, name in ((0.0, "blade_leading_edge"), (1.0, "blade_trailing_edge")):
        face = passage.surfaces.get(name)
        if isinstance(face, Surface):
            found.append(_face(name, face, curvature))
        elif isinstance(upper, Surface):
            found.append(_edge(upper, u, curvature))
    if isinstance(tip, TrimmedSurface):
        found.append(_tip(passage, tip))
    return tuple(found)


def _edge(side: Surface, u: float, curvature: float) -> Source:
    line = Curve(control_points=side.control_points[-1 if u else 0].real, knots=side.knots_v, degree=side.degree_v)
    x, y, z = line(0.5).tolist()
    size = 2.0 * np.pi * _radius(side, u) / curvature
    return Source(face="", place=(x, y, z), size=size, extent=float(arc_length(line)))


def _face(name: str, face: Surface, curvature: float) -> Source:
    v = np.linspace(0.0, 1.0, 33)
    first, last = face(0.0, v).real, face(1.0, v).real
    widths, steps = length(last - first), length(np.diff(0.5 * (first + last), axis=0))
    x, y, z = (0.5 * (first + last))[len(v) // 2].tolist()
    area = float(np.sum(0.5 * (widths[1:] + widths[:-1]) * steps))
    return Source(face=name, place=(x, y, z), size=np.pi * float(np.median(widths)) / curvature, extent=area)


def _radius(side: Surface, u: float) -> float:
    """Median over the span of the radius of a side's section at an edge [m]; zero where it is sharp."""
    bends = []
    for v in np.linspace(0.05, 0.95, 10).tolist():
        first, second = (side.derivative(u, v, order, 0).real for order in (1, 2))
        speed = float(length(first))
        bends.append(float(length(np.cross(first, second))) / speed**3 if speed > 0.0 else np.inf)
    bend = float(np.median(bends))
    return 1.0 / bend if bend > 0.0 else np.inf


def _tip(passage: Passage, tip: TrimmedSurface) -> Source:
    runs = [curve(np.linspace(*curve.domain, 17)).real for curve in tip.boundary]
    rim = np.concatenate([tip.surface(*run.T).real for run in runs])
    x, y, z = rim[0].tolist()
    return Source(face="tip", place=(x, y, z), size=_gap(passage, rim), extent=_area(rim))


def _gap(passage: Passage, rim: Reals) -> float:
    """Median distance of points (n, 3) from the nearer wall [m]."""
    sides = [
        [face for name, face in passage.surfaces.items() if name.startswith(wall) and isinstance(face, Surface)]
        for wall in WALLS
    ]
    near = min(sides, key=lambda faces: min(_to_net(face, rim[0]) for face in faces))
    distances = [closest_on_surface(face, rim, tolerance=1e-3).distances.real for face in near]
    return float(np.median(np.min(distances, axis=0)))


def _to_net(face: Surface, point: Reals) -> float:
    return float(length(face.control_points.real - point).min())


def _area(rim: Reals) -> float:
    """Area [m^2] within a closed run of points (n, 3)."""
    ahead = np.roll(rim, -1, axis=0)
    return 0.5 * float(length(np.cross(rim, ahead).sum(axis=0)))


DEFAULT_TETRAHEDRA = 150_000
"""tetrahedra that a mesh gets where no size is asked for, as far as they can be told beforehand"""
MAX_TETRAHEDRA = 5_000_000
"""expected tetrahedra above which a size is refused"""
TETRAHEDRA_PER_CUBE = 3.6
"""tetrahedra in a cube as large as an element is asked to be, the mean over the examples: design/meshes.py"""
GROWTH = 0.3
"""how much larger elements are, over how much further they lie from a source"""
SMALLEST_OF_SIZE = 0.1
"""the smallest size where none is asked for, of the largest"""
ELEMENTS_PER_TURN = 12.0
"""elements on a full circle as tight as an edge"""


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """How large the elements of a passage's mesh are."""

    chord: float
    """of the blade [m]"""
    largest: float
    """[m]"""
    smallest: float
    """[m]"""
    growth: float
    """how much larger elements are, over how much further they lie from a source"""
    sources: tuple[Source, ...]
    expected: int
    """tetrahedra, as far as they can be told beforehand"""


@dataclass(frozen=True, kw_only=True)
class _SizeModel:
    """What the sizes depend on beside the one in the open passage."""

    chord: float
    volume: float
    sources: tuple[Source, ...]
    smallest: float | None

    def sizes(self, size: float) -> Sizes:
        largest = size * self.chord
        finest = (SMALLEST_OF_SIZE * size if self.smallest is None else self.smallest) * self.chord
        limited = tuple(replace(each, size=float(np.clip(each.size, finest, largest))) for each in self.sources)
        cubes = self.volume / largest**3 + sum(_cubes_near(each, largest) for each in limited)
        return Sizes(
            chord=self.chord,
            largest=largest,
            smallest=finest,
            growth=GROWTH,
            sources=limited,
            expected=round(TETRAHEDRA_PER_CUBE * cubes),
        )

    def size_for(self, tetrahedra: int) -> float:
        """The size, of the chord, for which so many tetrahedra are expected, by halving the range of its logarithm."""
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
    """The sizes of a mesh with elements of `size` in the open passage and of `smallest` at least, both of the chord.

    An edge of the blade gets `curvature` elements on a full circle as tight as the edge, a gap one across it, as far as
    `smallest` allows. Where no size is given, it is the one for which about `EXPECTED` tetrahedra are expected; without
    `smallest` it is `FINEST` of the size. Raises MeshError for sizes that are not positive, above the chord, or so
    small that more than `MOST` tetrahedra are expected.
    """
    check_sizes(size=size, smallest=smallest, curvature=curvature)
    wish = _SizeModel(
        chord=float(np.real(passage.blade.chord)),
        volume=float(np.real(passage.properties.volume)),
        sources=size_sources(passage, curvature),
        smallest=smallest,
    )
    given = wish.size_for(DEFAULT_TETRAHEDRA) if size is None else size
    found = wish.sizes(given)
    if found.expected > MAX_TETRAHEDRA:
        raise MeshError(
            f"size is {given:.3g} of the chord{'' if smallest is None else f', smallest {smallest:g}'}: about "
            f"{found.expected:,} tetrahedra are expected, and at most {MAX_TETRAHEDRA:,} are made; {_cure(wish)}"
        )
    return found


def check_sizes(*, size: float | None, smallest: float | None, curvature: float) -> None:
    """Raise MeshError for sizes that no mesh has."""
    for name, value in (("size", size), ("smallest", smallest)):
        if value is not None and not 0.0 < value <= 1.0:
            raise MeshError(f"{name} is {value:g} of the chord: it must be above 0 and at most 1, such as 0.05")
    if size is not None and smallest is not None and smallest > size:
        raise MeshError(
            f"smallest is {smallest:g} of the chord, above the size {size:g}: lower smallest, or raise size"
        )
    if not 1.0 <= curvature <= 1000.0:
        raise MeshError(f"curvature is {curvature:g} elements on a full circle: it must be between 1 and 1000")


def _cure(wish: _SizeModel) -> str:
    least = wish.size_for(MAX_TETRAHEDRA)
    if wish.sizes(least).expected > MAX_TETRAHEDRA:
        return "raise smallest"
    return f"raise size to {1.01 * least:.2g}" + ("" if wish.smallest is None else ", or raise smallest")


def _cubes_near(source: Source, largest: float) -> float:
    """The integral of dV / size^3 all around a curve, or on one side of a face, until the size has grown to largest."""
    share = source.size / largest
    if source.face:
        return source.extent * (1.0 - share**2) / (2.0 * GROWTH * source.size**2)
    return float(np.pi) * source.extent * (1.0 - share) ** 2 / (GROWTH**2 * source.size)
