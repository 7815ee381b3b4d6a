"""What a design builds while it carries a step: complex for a derivative, real for a difference, at held knots."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, TypeGuard

import numpy as np

from bladewright.blade.blade import Blade
from bladewright.blade.ends import trimmed_ends
from bladewright.blade.fitness import chord_of
from bladewright.blade.moments import moment_gradient
from bladewright.blade.native import native_sides
from bladewright.blade.properties import blade_moments, middle_of
from bladewright.blade.unified import UnifiedBlade
from bladewright.derivatives.tangents import AT_ONCE, STEP, Nets, side_tangents
from bladewright.designs import Design
from bladewright.numerics.elementary import Array
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

Face = Surface | TrimmedSurface


def built(design: Design, knots: Any = None) -> Any:
    """What the design builds, at given knots where there are some."""
    return design.build() if knots is None else design.build(knots=knots)  # type: ignore[call-arg]


def stepped(design: Design, base: Any, paths: Sequence[str]) -> Iterator[Any]:
    """What the design builds with an imaginary step on each parameter in turn, at the knots of `base`, its build.

    A blade of two sides is made from its nets and their derivatives, its ends when they are asked for.
    """
    values = design.parameters()
    if not two_sided(base):
        for path in paths:
            yield built(design.changed(path, values[path] + STEP * 1j), getattr(base, "knots", None))
        return
    rows, moments = iter(paths), _Moments(base)
    for tangents in side_tangents(base, paths):
        for pair in zip(*tangents, strict=True):
            path = next(rows)
            nets = [side.control_points + STEP * 1j * rate for side, rate in zip(base.sides, pair, strict=True)]
            blade = _blade(base, design.changed(path, values[path] + STEP * 1j), nets[0], nets[1])
            yield replace(blade, moments=partial(moments, pair))


def varied(design: Design, base: Any, changes: Sequence[Mapping[str, complex]]) -> Iterator[Any]:
    """What the design builds with each of several changes of its parameters, at the knots of `base`, its build.

    For small changes: also what a build chooses besides knots is that of `base`.
    """
    if not two_sided(base):
        for each in changes:
            yield built(design.changed(each), getattr(base, "knots", None))
        return
    for first in range(0, len(changes), AT_ONCE):
        chunk = changes[first : first + AT_ONCE]
        upper, lower = varied_nets(base, chunk)
        for place, each in enumerate(chunk):
            blade = _blade(base, design.changed(each), upper[place], lower[place])
            yield replace(blade, chord=chord_of(blade.exact))


def two_sided(built: Any) -> TypeGuard[Blade]:
    """Whether it is a blade whose faces are two sides and two ends: one without blunt edges."""
    return isinstance(built, Blade) and set(built.surfaces) == {"upper", "lower", *built.design.ends}


def varied_nets(blade: Blade, changes: Sequence[Mapping[str, complex]]) -> Nets:
    """Nets (k, n_u, n_v, 3) of the upper and lower side with each of k changes of parameters, at the blade's knots."""
    if len(changes) > 1 and any(_is_sought(blade, each) for each in changes):
        # where a clearance surface lies, or edges meet stream lines, is found for one real channel at a time
        alone = [varied_nets(blade, [each]) for each in changes]
        return np.concatenate([nets[0] for nets in alone]), np.concatenate([nets[1] for nets in alone])
    values = blade.design.parameters()
    paths = dict.fromkeys(path for each in changes for path in each)
    batch = {path: np.array([each.get(path, values[path]) for each in changes]) for path in paths}
    exact = blade.exact.moved_to(blade.design.changed(batch))
    upper, lower = native_sides(exact.stations(blade.knots.sites_v), blade.knots)
    shape = (len(changes), *upper.shape[-3:])
    return np.broadcast_to(upper, shape), np.broadcast_to(lower, shape)


def _is_sought(blade: Blade, change: Mapping[str, complex]) -> bool:
    """Whether the blade is found by a search that a real change leads to another place."""
    real = [path for path, value in change.items() if not np.iscomplexobj(value)]
    if isinstance(blade.design, UnifiedBlade):
        walls = any(path.startswith("channel.") or "clearance" in path for path in real)
        return walls and blade.exact.tip_knots is not None
    if blade.design.leading_edge is None or blade.design.skinning == "developable":
        # the edges follow from the sections
        return len(real) > 0
    return not all(path.startswith(("section.", "leading_edge_theta", "leading_edge_y", "pitch")) for path in real)


class _Moments:
    """The moments of blades that carry a step, from their nets' derivatives and the gradients of the sides' moments."""

    def __init__(self, base: Blade) -> None:
        self.base = base

    @cached_property
    def _value_and_gradients(self) -> tuple[Array, list[Array]]:
        outward, revolved = self.base.orientations, self.base.exact.mapping.revolved
        middle = middle_of(self.base.surfaces)
        gradients = [
            outward[name] * moment_gradient(side, middle, revolved=revolved)
            for name, side in zip(("upper", "lower"), self.base.sides, strict=True)
        ]
        return blade_moments(self.base.surfaces, outward, revolved=revolved), gradients

    def __call__(self, tangents: Nets) -> Array:
        value, gradients = self._value_and_gradients
        rates = [np.tensordot(gradient, rate, axes=3) for gradient, rate in zip(gradients, tangents, strict=True)]
        return value + STEP * 1j * (rates[0] + rates[1])


class _Faces(Mapping[str, Face]):
    """A blade's sides, and its ends, which are made when one is asked for."""

    def __init__(
        self, sides: Mapping[str, Surface], names: Sequence[str], ends: Callable[[], Mapping[str, Face]]
    ) -> None:
        self._found: dict[str, Face] = dict(sides)
        self._names, self._ends = tuple(names), ends

    def __getitem__(self, name: str) -> Face:
        if name not in self._found and name in self._names:
            self._found |= self._ends()
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _blade(base: Blade, design: Any, upper: Array, lower: Array) -> Blade:
    exact = base.exact.moved_to(design)
    sides = [replace(side, control_points=net) for side, net in zip(base.sides, (upper, lower), strict=True)]

    def ends() -> Mapping[str, Face]:
        like = {name: face for name, face in base.surfaces.items() if isinstance(face, TrimmedSurface)}
        return trimmed_ends(exact, sides[0], sides[1], base.chord, like)

    surfaces = _Faces({"upper": sides[0], "lower": sides[1]}, tuple(base.surfaces), ends)
    return replace(base, design=design, surfaces=surfaces, exact=exact)
