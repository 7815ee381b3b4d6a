"""Sizes of elements: one in the open passage, smaller ones that grow away from the blade's edges and its gap."""

from dataclasses import dataclass, replace

import numpy as np

from bladewright.domain.passage import Passage
from bladewright.errors import MeshError
from bladewright.meshing.sources import Source, sources

EXPECTED = 150_000
"""tetrahedra that a mesh gets where no size is asked for, as far as they can be told beforehand"""
MOST = 5_000_000
"""expected tetrahedra above which a size is refused"""
PER_CUBE = 3.6
"""tetrahedra in a cube as large as an element is asked to be, the mean over the examples: design/meshes.py"""
GROWTH = 0.3
"""how much larger elements are, over how much further they lie from a source"""
FINEST = 0.1
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
class _Wish:
    """What the sizes depend on beside the one in the open passage."""

    chord: float
    volume: float
    sources: tuple[Source, ...]
    smallest: float | None

    def sizes(self, size: float) -> Sizes:
        largest = size * self.chord
        finest = (FINEST * size if self.smallest is None else self.smallest) * self.chord
        limited = tuple(replace(each, size=float(np.clip(each.size, finest, largest))) for each in self.sources)
        cubes = self.volume / largest**3 + sum(_cubes_near(each, largest) for each in limited)
        return Sizes(
            chord=self.chord,
            largest=largest,
            smallest=finest,
            growth=GROWTH,
            sources=limited,
            expected=round(PER_CUBE * cubes),
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
    wish = _Wish(
        chord=float(np.real(passage.blade.chord)),
        volume=float(np.real(passage.properties.volume)),
        sources=sources(passage, curvature),
        smallest=smallest,
    )
    given = wish.size_for(EXPECTED) if size is None else size
    found = wish.sizes(given)
    if found.expected > MOST:
        raise MeshError(
            f"size is {given:.3g} of the chord{'' if smallest is None else f', smallest {smallest:g}'}: about "
            f"{found.expected:,} tetrahedra are expected, and at most {MOST:,} are made; {_cure(wish)}"
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


def _cure(wish: _Wish) -> str:
    least = wish.size_for(MOST)
    if wish.sizes(least).expected > MOST:
        return "raise smallest"
    return f"raise size to {1.01 * least:.2g}" + ("" if wish.smallest is None else ", or raise smallest")


def _cubes_near(source: Source, largest: float) -> float:
    """The integral of dV / size^3 all around a curve, or on one side of a face, until the size has grown to largest."""
    share = source.size / largest
    if source.face:
        return source.extent * (1.0 - share**2) / (2.0 * GROWTH * source.size**2)
    return float(np.pi) * source.extent * (1.0 - share) ** 2 / (GROWTH**2 * source.size)
