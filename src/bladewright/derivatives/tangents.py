"""Derivatives of a blade's control nets by its parameters, many in one rebuild.

A law of evolution of the unified family acts on the section at v by its value there alone, so a step of the whole law
gives the section's derivative, and that of control point j is N_j(v) times it. Nets are linear in the sections' points.
What is left, the channel above all, and every parameter of a blade from sections, is stepped leaf by leaf.
"""

import re
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from bladewright.blade.blade import Blade
from bladewright.blade.knots import Knots
from bladewright.blade.laid import EdgeRow
from bladewright.blade.native import Skeleton, sides_through, skeleton_of
from bladewright.blade.sectioned import SectionedBlade
from bladewright.blade.unified import UnifiedBlade
from bladewright.numerics.elementary import Array, joined
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis
from bladewright.section.limits import ANGLES, RADII, TANGENTS, THICKNESSES, WEIGHTS

STEP = 1e-30
"""imaginary step: its square vanishes beside 1, so that the derivative is exact to rounding"""
AT_ONCE = 16
"""parameters in one rebuild"""
LAWS = ("leading_edge_theta", "leading_edge_y", *ANGLES, *TANGENTS, *RADII)
CHORDWISE = (*THICKNESSES, *WEIGHTS)
Nets = tuple[Array, Array]


class Source(NamedTuple):
    """Where a parameter's derivative comes from."""

    step: str
    """the law, or the leaf, that is stepped"""
    place: int = 0
    """number of the control point in its law"""
    points: int = 0
    """control points of the law; 0 for a leaf that is no law"""


def side_tangents(blade: Blade, paths: Sequence[str]) -> Iterator[Nets]:
    """Derivatives (k, n_u, n_v, 3) of the upper and lower net by parameters, in chunks of at most `AT_ONCE` in order.

    Metres per unit of the parameter's field, at the blade's knots.
    """
    sources = [source_of(blade.design, path) for path in paths]
    steps = list(dict.fromkeys(source.step for source in sources))
    rates = np.concatenate([_rates(blade, steps[i : i + AT_ONCE]) for i in range(0, len(steps), AT_ONCE)])
    mirrored = [edge is None for edge in blade.exact.survey.lower_edges()]
    for first in range(0, len(paths), AT_ONCE):
        chunk = sources[first : first + AT_ONCE]
        shares = np.stack([_share(source, blade.knots.sites_v) for source in chunk])
        rows = rates[[steps.index(source.step) for source in chunk]] * shares[..., None]
        yield sides_through(parted(rows, mirrored), blade.knots)


def source_of(design: UnifiedBlade | SectionedBlade, path: str) -> Source:
    """Where the derivative of a design by one of its parameters comes from."""
    name, *places = re.findall(r"\w+", path)
    if not isinstance(design, UnifiedBlade) or name not in (*LAWS, *CHORDWISE):
        return Source(path)
    depth = 1 if name in CHORDWISE else 0
    if len(places) == depth:
        return Source(path, 0, 1)
    law = getattr(design, name)[int(places[0])] if depth else getattr(design, name)
    return Source(path.rpartition("[")[0], int(places[-1]), len(law))


def _share(source: Source, v: Reals) -> Reals:
    return law_basis(source.points, v)[:, source.place] if source.points else np.ones(len(v))


def _rates(blade: Blade, steps: Sequence[str]) -> Array:
    """Derivatives (len(steps), m, k) of the skeleton, in a row for each section, by laws as a whole and by leaves."""
    moved = blade.exact.moved_to(stepped(blade.design, steps))
    return skeleton_rates(moved.stations(blade.knots.sites_v), blade.knots, len(steps))


def stepped(design: UnifiedBlade | SectionedBlade, steps: Sequence[str]) -> Any:
    """A design with a batch (len(steps),) of imaginary steps, each of a law as a whole or of a leaf."""
    values = design.parameters()
    changes: dict[str, Any] = {}
    for place, step in enumerate(steps):
        kick = np.zeros(len(steps), dtype=np.complex128)
        kick[place] = STEP * 1j
        changes |= {path: value + kick for path, value in values.items() if path == step or path.startswith(f"{step}[")}
    return design.changed(changes)


def skeleton_rates(stations: Any, knots: Knots, count: int) -> Array:
    """Derivatives (count, m, k) of the skeleton of stations with as many imaginary steps, in a row for each section."""
    skeleton = skeleton_of(stations, knots)
    sides = [side.reshape(*side.shape[:-2], -1) for side in (skeleton.upper, skeleton.lower)]
    edges = [skeleton.leading_edge, skeleton.trailing_edge, *skeleton.lower_edges]
    rows = joined([part for edge in edges if edge is not None for part in edge] + sides, axis=-1)
    return np.broadcast_to(np.imag(rows) / STEP, (count, *rows.shape[-2:]))


def parted(rows: Array, mirrored: Sequence[bool]) -> Skeleton:
    """The skeleton in rows; `mirrored` says of which edges the lower side has no derivatives of its own."""
    count = 2 + sum(not each for each in mirrored)
    edges, upper, lower = np.split(rows, [9 * count, (9 * count + rows.shape[-1]) // 2], axis=-1)
    parts = iter(np.split(edges, 3 * count, axis=-1))
    found = [EdgeRow(*islice(parts, 3)) for _ in range(count)]
    own = iter(found[2:])
    first, last = (None if each else next(own) for each in mirrored)
    sides = [side.reshape(*side.shape[:-1], -1, 3) for side in (upper, lower)]
    return Skeleton(found[0], found[1], sides[0], sides[1], (first, last))
