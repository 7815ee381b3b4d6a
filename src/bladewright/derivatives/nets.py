"""Derivatives of the control nets of what a design builds, and gradients of what is known at points of them."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from bladewright.derivatives.jacobian import Bars, NetJacobian, Shape
from bladewright.derivatives.patterns import Patterns, chosen
from bladewright.derivatives.steps import built, stepped, two_sided
from bladewright.derivatives.tangents import STEP, side_tangents
from bladewright.designs import Design, unknown
from bladewright.errors import DerivativeError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.trimmed import TrimmedSurface

Part = Callable[..., Any]
"""what is made of a design's build, such as its passage; it has `surfaces` or `curves` by name"""


def net_jacobian(
    design: Design,
    *,
    names: Sequence[str] | None = None,
    free: Patterns = None,
    knots: Any = None,
    of: Part | None = None,
) -> NetJacobian:
    """Derivatives of the control points of what a design builds, by all its parameters or those that `free` matches.

    `names` are the surfaces wanted, where None all that are not trimmed; `knots` those to hold, where None the design's
    own; `of` makes of the build the body whose surfaces are meant, such as `bladewright.passage`, and takes that body's
    `knots` where it has some. Raises DerivativeError for an unknown name, DesignError where a pattern matches no
    parameter or the design cannot be built.
    """
    base = built(design, knots)
    paths = chosen(design, free)
    body = base if of is None else of(base)
    faces = faces_of(body)
    wanted = tuple(name for name, face in faces.items() if not isinstance(face, TrimmedSurface))
    for name in wanted if names is None else names:
        if name not in faces:
            raise DerivativeError(unknown(f"'{name}'", name, list(faces)))
    wanted = wanted if names is None else tuple(dict.fromkeys(names))
    shapes = {name: whole(faces[name]) for name in wanted}
    return NetJacobian(
        paths=paths,
        shapes=MappingProxyType(shapes),
        homogeneous=MappingProxyType(_rates(design, base, _held(of, body), paths, shapes)),
    )


def pullback(
    design: Design, bars: Bars, *, free: Patterns = None, knots: Any = None, of: Part | None = None
) -> dict[str, float]:
    """Sums over all points of bar * dS/dparameter, by path: the gradient of what a solver knows at points of surfaces.

    `bars` is {name: (u, v, bar)}, with bar of the shape of S(u, v) the derivative of a scalar by the points [1/m];
    (u, bar) for the curves of a 2D design. Other arguments and errors are those of `net_jacobian`, and of
    `NetJacobian.pulled_back`, which serves many gradients of one design.
    """
    return net_jacobian(design, names=list(bars), free=free, knots=knots, of=of).pulled_back(bars)


def _rates(
    design: Design, base: Any, of: Part | None, paths: tuple[str, ...], shapes: Mapping[str, Shape]
) -> dict[str, Array]:
    if of is None and two_sided(base) and set(shapes) <= {"upper", "lower"}:
        pairs = list(side_tangents(base, paths)) if paths else []
        sides = [np.concatenate([pair[side] for pair in pairs]) for side in (0, 1)]
        return {name: sides[("upper", "lower").index(name)] for name in shapes}
    rates = {name: np.empty((len(paths), *shape.homogeneous.shape)) for name, shape in shapes.items()}
    for place, carrying in enumerate(stepped(design, base, paths)):
        faces = faces_of(carrying if of is None else of(carrying))
        for name in shapes:
            rates[name][place] = np.imag(whole(faces[name]).homogeneous) / STEP
    return rates


def _held(of: Part | None, body: Any) -> Part | None:
    """The same part, at the knots of `body`, where it has some."""
    knots = getattr(body, "knots", None)
    return of if of is None or knots is None else partial(of, knots=knots)


def faces_of(body: Any) -> Mapping[str, Any]:
    """Surfaces or curves by name; raises DerivativeError where there are none."""
    faces: Mapping[str, Any] | None = getattr(body, "surfaces", None) or getattr(body, "curves", None)
    if faces is None:
        raise DerivativeError(f"a {type(body).__name__} has neither surfaces nor curves to differentiate")
    return faces


def whole(face: Any) -> Shape:
    """The surface below a trimmed one, or the shape itself."""
    found: Shape = face.surface if isinstance(face, TrimmedSurface) else face
    return found
