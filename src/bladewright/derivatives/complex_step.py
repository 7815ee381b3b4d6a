"""What a design builds while a parameter carries a complex step, or changes a little: nets, blades, any build.

A blade's control nets are linear in the points of its sections. Most laws of evolution act on the section at span
fraction v by their value there alone: a step of the whole law gives the derivative of the section, and the derivative
by its control point j, or its value at station j, is the weight of that number at v times it, so that one rebuild
serves all numbers of a law, and all inner control points of an edge of the channel. The other parameters are stepped
one by one; AT_ONCE steps go through one rebuild as a batch.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import islice
from typing import Any, TypeGuard, cast

import numpy as np

from bladewright.blade.design.row_design import RowDesign
from bladewright.blade.design.spanwise_steps import SpanwiseStep, step_alone
from bladewright.blade.native.blade import Blade
from bladewright.blade.native.end_faces import EDGES, trimmed_ends
from bladewright.blade.native.finishing import finished, stepped_finishes
from bladewright.blade.native.interpolation import (
    ACROSS_EDGE,
    InterpolationData,
    interpolation_data,
    native_sides,
    nets_through,
    sides_through,
)
from bladewright.blade.native.knots import Knots
from bladewright.blade.native.lazy_faces import Face, LazyFaces
from bladewright.blade.native.properties import blade_moments, middle_of, moment_gradient
from bladewright.blade.native.refinement import mean_chord
from bladewright.designs import Design
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, concatenated
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.section.outline import EdgeDerivatives

STEP = 1e-30
"""The complex step, in the unit of the parameter (Squire and Trapp 1998): nothing is subtracted, so it may be so small
that its square vanishes beside 1, and the derivative is exact to rounding."""
AT_ONCE = 16
"""Steps in one batched rebuild: larger batches share more work and take more memory. The derivatives of Rotor 67's nets
by 108 parameters take 0.3 s of processor time."""
MERIDIONAL = re.compile(r"(channel|flow_path|leading_edge|trailing_edge|stacking)\b")
"""paths of parameters that may move stream lines"""
Nets = tuple[Array, Array]
"""Control nets, or their derivatives, of the upper and the lower side."""


def face_tangents(blade: Blade, paths: Sequence[str]) -> Iterator[dict[str, Array]]:
    """Derivatives (k, n_u, n_v, 3) of the nets of sides and blunt edges by parameters, at most AT_ONCE at a time.

    By the name of the face, in metres per unit of the parameter's field, at the blade's knots.
    """
    steps, sources = steps_of(blade.design, paths)
    rates = _rates_of_steps(blade, steps)
    weights = [step.weights(blade.knots.sites_v) for step in steps]
    for first in range(0, len(paths), AT_ONCE):
        chunk = sources[first : first + AT_ONCE]
        factors = np.stack([weights[step][:, place] for step, place in chunk])
        rows = rates[[step for step, _ in chunk]] * factors[..., None]
        yield nets_through(data_from_rates(rows, blade), blade.knots)


def step_tangents(blade: Blade, steps: Sequence[SpanwiseStep]) -> Nets:
    """Derivatives (k, n_u, n_v, 3) of both nets by whole steps, each of all its parameters by the same amount."""
    return sides_through(data_from_rates(_rates_of_steps(blade, steps), blade), blade.knots)


def steps_of(design: RowDesign, paths: Sequence[str]) -> tuple[list[SpanwiseStep], list[tuple[int, int]]]:
    """The steps that serve the derivatives by parameters, and for each of these its step and its place in it."""
    places: dict[str, tuple[SpanwiseStep, int]] = {}
    for step in design.spanwise_steps():
        places |= {path: (step, place) for place, path in enumerate(step.paths)}
    found = [places.get(path) or (step_alone(path), 0) for path in paths]
    number: dict[SpanwiseStep, int] = {}
    sources = [(number.setdefault(step, len(number)), place) for step, place in found]
    return list(number), sources


def _rates_of_steps(blade: Blade, steps: Sequence[SpanwiseStep]) -> Array:
    """Derivatives (len(steps), m, k) of the interpolation data by steps, a row a section.

    Steps that move stream lines go through rebuilds of their own, so that these stay real for the others.
    """
    meridional = np.array([MERIDIONAL.match(step.paths[0]) is not None for step in steps])
    found: list[Array] = [np.empty(0)] * len(steps)
    for group in (np.flatnonzero(meridional), np.flatnonzero(~meridional)):
        for first in range(0, len(group), AT_ONCE):
            chunk = group[first : first + AT_ONCE]
            moved = blade.exact.moved_to(stepped_design(blade.design, [steps[i] for i in chunk]))
            rates = interpolation_rates(moved.sections(blade.knots.sites_v), blade.knots, len(chunk))
            for i, each in zip(chunk, rates, strict=True):
                found[i] = each
    return np.stack(found)


def stepped_design(design: RowDesign, steps: Sequence[SpanwiseStep]) -> Any:
    """A design with a batch (len(steps),) of complex steps, each of all its parameters."""
    values = design.parameters()
    changes: dict[str, Any] = {}
    for place, step in enumerate(steps):
        change = np.zeros(len(steps), dtype=np.complex128)
        change[place] = STEP * 1j
        changes |= {path: values[path] + change for path in step.paths}
    return design.stepped(changes)


def interpolation_rates(sections: Any, knots: Knots, count: int) -> Array:
    """Derivatives (count, m, k) of the interpolation data of sections that carry `count` steps, a row a section."""
    data = interpolation_data(sections, knots)
    points = [each.reshape(*each.shape[:-2], -1) for each in (*data.faces.values(), data.upper, data.lower)]
    edges = [data.leading_edge, data.trailing_edge, *data.lower_edges]
    rows = concatenated([part for edge in edges if edge is not None for part in edge] + points, axis=-1)
    return np.broadcast_to(np.imag(rows) / STEP, (count, *rows.shape[-2:]))


def data_from_rates(rows: Array, blade: Blade) -> InterpolationData:
    """Interpolation data of a blade from such rows."""
    mirrored = [edge is None for edge in blade.exact.survey.lower_edges()]
    # a model of a search has no surfaces
    blunt = list(blade.exact.survey.faces(ACROSS_EDGE))
    count, width = 2 + sum(not each for each in mirrored), 3 * len(ACROSS_EDGE)
    edges, faces, sides = np.split(rows, [9 * count, 9 * count + width * len(blunt)], axis=-1)
    parts = iter(np.split(edges, 3 * count, axis=-1))
    found = [EdgeDerivatives(*islice(parts, 3)) for _ in range(count)]
    own = iter(found[2:])
    first, last = (None if each else next(own) for each in mirrored)
    points = [*np.split(sides, 2, axis=-1), *(np.split(faces, len(blunt), axis=-1) if blunt else ())]
    upper, lower, *across = (each.reshape(*each.shape[:-1], -1, 3) for each in points)
    return InterpolationData(
        found[0], found[1], upper, lower, (first, last), FrozenMapping(dict(zip(blunt, across, strict=True)))
    )


def built(design: Design, knots: Any = None) -> Any:
    """What the design builds, at the given knots if any."""
    return design.build() if knots is None else design.build(knots=knots)  # type: ignore[call-arg]


def stepped(design: Design, base: Any, paths: Sequence[str]) -> Iterator[Any]:
    """What the design builds with a complex step on each parameter in turn, at the knots of `base`, its build.

    A blade is made from its nets and their derivatives, and its ends only when they are used. One that is
    cut or filleted is so made from the plain blade, its contacts with surfaces by one more of Newton's steps.
    """
    values = design.parameters()
    if is_finished(base):
        plain, own_moments, finish = base.plain, _SteppedMoments(base), stepped_finishes(base)
        own = plain.design.parameters()
        carrying = stepped(plain.design, plain, [path for path in paths if path in own])
        for first in range(0, len(paths), AT_ONCE):
            chunk = paths[first : first + AT_ONCE]
            blades = [next(carrying) if path in own else plain for path in chunk]
            for made in finish(blades, [base.design.stepped(path, values[path] + STEP * 1j) for path in chunk]):
                yield replace(made, moments=partial(own_moments, _rates_of(base, made)))
        return
    if not isinstance(base, Blade):
        for path in paths:
            yield built(design.stepped(path, values[path] + STEP * 1j), getattr(base, "knots", None))
        return
    rows, moments = iter(paths), _SteppedMoments(base)
    real = {
        name: cast(Surface, base.surfaces[name]).control_points
        for name in ("upper", "lower", *EDGES)
        if name in base.surfaces
    }
    for tangents in face_tangents(base, paths):
        for number in range(len(tangents["upper"])):
            path, rates = next(rows), {name: rate[number] for name, rate in tangents.items()}
            nets = {name: net + STEP * 1j * rates[name] for name, net in real.items()}
            blade = _blade(base, design.stepped(path, values[path] + STEP * 1j), nets)
            yield replace(blade, moments=partial(moments, rates))


def varied(design: Design, base: Any, changes: Sequence[Mapping[str, complex]]) -> Iterator[Any]:
    """What the design builds with each of several changes of its parameters, at the knots of `base`, its build.

    For small changes: what a build chooses besides knots is taken from `base` too.
    """
    if is_finished(base):
        plain = base.plain
        own = plain.design.parameters()
        kept = [{path: value for path, value in each.items() if path in own} for each in changes]
        for blade, each in zip(varied(plain.design, plain, kept), changes, strict=True):
            yield finished(blade, base.design.changed(each), base.knots)
        return
    if not two_sided(base):
        for each in changes:
            yield built(design.changed(each), getattr(base, "knots", None))
        return
    for first in range(0, len(changes), AT_ONCE):
        chunk = changes[first : first + AT_ONCE]
        upper, lower = varied_nets(base, chunk)
        for place, each in enumerate(chunk):
            blade = _blade(base, design.changed(each), {"upper": upper[place], "lower": lower[place]})
            yield replace(blade, chord=mean_chord(blade.exact))


def two_sided(built: Any) -> TypeGuard[Blade]:
    """Whether it is a blade whose faces are two sides and two ends, without faces of blunt edges."""
    return (
        isinstance(built, Blade)
        and built.before is None
        and set(built.surfaces) == {"upper", "lower", *built.design.ends}
    )


def is_finished(built: Any) -> TypeGuard[Blade]:
    """Whether it is a blade that is cut or filleted."""
    return isinstance(built, Blade) and built.before is not None


def varied_nets(blade: Blade, changes: Sequence[Mapping[str, complex]]) -> Nets:
    """Nets (k, n_u, n_v, 3) of the upper and the lower side after each of k changes, at the blade's knots."""
    if is_finished(blade):
        sides = [[side.control_points for side in each.sides] for each in varied(blade.design, blade, changes)]
        upper, lower = (np.stack(nets) for nets in zip(*sides, strict=True))
        return upper, lower
    if len(changes) > 1 and any(_needs_search(blade, each) for each in changes):
        # a clearance surface, and the edges' intersections with stream lines, are found for one real channel at a time
        single = [varied_nets(blade, [each]) for each in changes]
        return np.concatenate([nets[0] for nets in single]), np.concatenate([nets[1] for nets in single])
    values = blade.design.parameters()
    paths = dict.fromkeys(path for each in changes for path in each)
    batch = {path: np.array([each.get(path, values[path]) for each in changes]) for path in paths}
    exact = blade.exact.moved_to(blade.design.changed(batch))
    upper, lower = native_sides(exact.sections(blade.knots.sites_v), blade.knots)
    shape = (len(changes), *upper.shape[-3:])
    return np.broadcast_to(upper, shape), np.broadcast_to(lower, shape)


def _needs_search(blade: Blade, change: Mapping[str, complex]) -> bool:
    """Whether a change moves something that is found by a search in real numbers: a root, a nearest point."""
    real = [path for path, value in change.items() if not np.iscomplexobj(value)]
    return blade.design.needs_own_search(real)


class _SteppedMoments:
    """The moments of blades that carry a step: by the chain rule from the gradients of the moments by the nets."""

    def __init__(self, base: Blade) -> None:
        self.base = base

    @cached_property
    def _value_and_gradients(self) -> tuple[Array, dict[str, Array]]:
        outward, revolved = self.base.orientations, self.base.exact.mapping.revolved
        middle = middle_of(self.base.surfaces)
        gradients = {
            name: outward[name] * moment_gradient(face, middle, revolved=revolved)
            for name, face in self.base.surfaces.items()
            if isinstance(face, Surface)
        }
        return blade_moments(self.base.surfaces, outward, revolved=revolved), gradients

    def __call__(self, tangents: Mapping[str, Array]) -> Array:
        value, gradients = self._value_and_gradients
        rates = [np.tensordot(gradient, tangents[name], axes=3) for name, gradient in gradients.items()]
        return np.asarray(value + STEP * 1j * sum(rates))


def _rates_of(base: Blade, made: Blade) -> dict[str, Array]:
    """Derivatives of the nets of a blade that carries a step."""
    faces = {name: made.surfaces[name] for name, face in base.surfaces.items() if isinstance(face, Surface)}
    return {name: np.imag(face.control_points) / STEP for name, face in faces.items() if isinstance(face, Surface)}


def _blade(base: Blade, design: Any, nets: Mapping[str, Array]) -> Blade:
    """The blade `base` with another design and nets of sides and blunt edges, its knots held."""
    exact = base.exact.moved_to(design)
    own = {name: replace(cast(Surface, base.surfaces[name]), control_points=net) for name, net in nets.items()}
    upper, lower, *edges = own

    def ends() -> Mapping[str, Face]:
        like = {name: face for name, face in base.surfaces.items() if isinstance(face, TrimmedSurface)}
        blunt = {name: own[name] for name in edges}
        return trimmed_ends(exact, own[upper], own[lower], base.chord, like, faces=blunt)

    return replace(base, design=design, surfaces=LazyFaces[Face](own, tuple(base.surfaces), ends), exact=exact)
